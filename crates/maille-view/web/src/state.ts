// What the page shows: one or two sheets, how far they are pulled, and what the controls set.

import * as api from "./api";
import { halfTurn } from "./limits";
import { Side } from "./side";
import type { ColorBy } from "./drawing";
import type { Start } from "./types";

export type Mode = "explore" | "edit" | "compare";

const MOVE_MS = 900;
const calmly = window.matchMedia("(prefers-reduced-motion: reduce)").matches;

export class ViewState {
  readonly a: Side;
  readonly b: Side;
  mode: Mode = "explore";
  /** Place between the start, 0, and the limit, 1. */
  t = 0;
  tile: [number, number] = [8, 8];
  colorBy: ColorBy = "element";
  forces = true;
  chain = true;
  /** Element that is picked. */
  picked: number | null = null;
  private compared = false;
  private moving = 0;
  private waiting = false;

  constructor(
    readonly start: Start,
    private draw: () => void,
  ) {
    this.a = new Side("a", start.bundle, () => this.drawLater());
    this.b = new Side("b", start.bundle, () => this.drawLater());
  }

  /** The limit that is shown, unless the start is. */
  get locked(): Side["locked"] {
    return this.t > 0 ? this.a.locked : null;
  }

  /** Draws at the next frame, once. */
  private drawLater(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  /** Changes what needs nothing else. */
  set(change: Partial<Pick<ViewState, "tile" | "colorBy" | "forces" | "chain">>): void {
    Object.assign(this, change);
    this.draw();
  }

  setMode(mode: Mode): void {
    this.mode = mode;
    if (mode === "compare" && !this.compared) {
      this.compared = true;
      void this.compareSame();
    }
    this.move(mode !== "edit" && this.a.locked ? 1 : 0, false);
  }

  /** Opens a built-in design, or again what was opened first. */
  async open(name: string): Promise<void> {
    this.picked = null;
    this.t = 0;
    await this.a.open(name === "" ? this.start.opened : { ...(await api.builtin(name)), file: null, map: null });
    this.draw();
  }

  /** Compares with a built-in design. */
  async compareWith(name: string): Promise<void> {
    await this.b.open({ ...(await api.builtin(name)), file: null, map: null });
  }

  /** Compares with the first design itself, to change its wire. */
  async compareSame(): Promise<void> {
    const { name, file, text } = this.a;
    await this.b.open({ name, file, text, map: null });
    if (this.a.choice) await this.b.choose(this.a.choice.direction, null);
  }

  /** Does the same with every sheet that is shown. */
  each(work: (side: Side) => Promise<void>): Promise<unknown> {
    return Promise.all([this.a, ...(this.mode === "compare" ? [this.b] : [])].map(work));
  }

  /** Ends what is being solved of a sheet. */
  cancel(side: Side): void {
    side.cancel();
    this.draw();
  }

  choose(direction: number, l2: number | null): void {
    const whole = halfTurn(direction);
    void this.each((side) => side.choose(whole, side === this.a ? l2 : null));
    this.move(1, this.t < 1);
  }

  /** Chooses the direction that is `degrees` away from the one that is chosen. */
  step(degrees: number): void {
    this.choose((this.a.choice?.direction ?? 0) + degrees, null);
  }

  /** Picks an element, or lets go of the one that is picked. */
  pick(element: number | null): void {
    this.picked = element === this.picked ? null : element;
    this.draw();
  }

  /** Goes to a place between the start and the limit at once. */
  scrub(t: number): void {
    cancelAnimationFrame(this.moving);
    this.t = t;
    this.draw();
  }

  /** Plays the pull, or back from the limit. */
  play(): void {
    this.move(this.t < 1 ? 1 : 0, true);
  }

  /** Moves to the start or to the limit. */
  private move(to: number, slowly: boolean): void {
    if (!slowly || calmly) return this.scrub(to);
    cancelAnimationFrame(this.moving);
    const from = this.t;
    const begun = performance.now();
    const step = (now: number) => {
      // The limit is waited for.
      const x = Math.min(1, (now - begun) / (MOVE_MS * Math.max(0.2, Math.abs(to - from))));
      this.t = x === 1 ? to : from + (to - from) * x * x * (3 - 2 * x);
      this.draw();
      if (x < 1) this.moving = requestAnimationFrame(step);
    };
    this.moving = requestAnimationFrame(step);
  }
}
