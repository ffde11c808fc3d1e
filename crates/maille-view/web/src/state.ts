// What the page shows: one or two sheets, how far they are pulled, and what the controls set.

import * as api from "./api";
import { halfTurn, widths } from "./limits";
import { Side } from "./side";
import type { ColorBy } from "./drawing";
import type { Shown, Start } from "./types";

export type Mode = "explore" | "draw" | "edit" | "compare";
/** Which of two sheets that are compared are shown. */
export type Both = "both" | "a" | "b";
/** Before the folder of a record, where a name may also be that of a built-in design. */
export const RECORD = "record:";

const MOVE_MS = 900;
/** Time of one state of a simulation that is played. */
const FRAME_MS = 80;
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
  both: Both = "both";
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
      this.show();
    });
  }

  /** Draws; gaps of a simulation are asked for where they are shown. */
  private show(): void {
    const gaps = this.picked !== null || this.colorBy === "slack";
    if (gaps) for (const side of this.sides) side.measure(this.placeOf(side));
    this.draw();
  }

  /** The sheets that are shown. */
  private get sides(): Side[] {
    return this.mode === "compare" ? [this.a, this.b] : [this.a];
  }

  /** Where a sheet stands between its start and its end: two simulations stand at the same share of the pull. */
  placeOf(side: Side): number {
    const [first, second] = [this.a.frames, this.b.frames];
    return side === this.b && first && second ? second.nearest(first.at(this.t).share) : this.t;
  }

  /** Changes what needs nothing else. */
  set(change: Partial<Pick<ViewState, "tile" | "colorBy" | "forces" | "chain" | "both">>): void {
    Object.assign(this, change);
    this.show();
  }

  setMode(mode: Mode): void {
    if (mode === "draw") this.picked = null;
    this.mode = mode;
    const writes = this.writes;
    this.a.rest(writes);
    if (writes) void this.openDesign();
    if (mode === "compare" && !this.compared) {
      this.compared = true;
      void this.compareSame();
    }
    const end = this.a.frames ? this.t : Number(this.a.locked !== null);
    this.move(writes ? 0 : end, false);
  }

  /** Whether the design is being changed. */
  private get writes(): boolean {
    return this.mode === "edit" || this.mode === "draw";
  }

  /** Of a simulation, opens the design: that can be changed. The simulation stays in the list. */
  private async openDesign(): Promise<void> {
    const { frames, own, text } = this.a;
    if (!frames) return;
    await this.a.open({ ...api.PLAIN, name: `${own?.name ?? "sheet"}.toml`, text });
  }

  /** Opens a built-in design, a record, or again what was opened first. */
  async open(name: string): Promise<void> {
    this.picked = null;
    try {
      await this.a.open(await this.find(name));
    } catch (error) {
      this.a.fail(error);
    }
    if (this.writes) await this.openDesign();
    if (!this.a.locked || this.writes) this.t = 0;
    this.show();
  }

  private async find(name: string): Promise<Shown> {
    if (name === "") return this.start.opened;
    return name.startsWith(RECORD) ? api.record(name.slice(RECORD.length)) : api.builtin(name);
  }

  /** Compares with a built-in design, a record, or what was opened first. */
  async compareWith(name: string): Promise<void> {
    try {
      await this.b.open(await this.find(name));
    } catch (error) {
      this.a.fail(error);
    }
    await this.chooseSecond();
  }

  /** Compares with the first design itself, to change its wire; a simulation with itself. */
  async compareSame(): Promise<void> {
    const { name, file, text, frames } = this.a;
    await this.b.open({ ...api.PLAIN, name, file, text, simulation: frames?.simulation ?? null });
    await this.chooseSecond();
  }

  /** The second sheet has the direction of the first, and its width where it can. */
  private async chooseSecond(): Promise<void> {
    const { a, b } = this;
    if (!a.choice || b.frames) return;
    const { direction, l2 } = a.choice;
    const there = b.source === null ? b.l2 === l2 : widths(b.limits).includes(l2);
    await b.choose(direction, there ? l2 : null);
  }

  /** Does the same with every sheet that is shown. */
  each(work: (side: Side) => Promise<void>): Promise<unknown> {
    return Promise.all(this.sides.map(work));
  }

  /** Ends what is being solved of a sheet. */
  cancel(side: Side): void {
    side.cancel();
    this.draw();
  }

  choose(direction: number, l2: number | null): void {
    const whole = halfTurn(direction);
    if (!this.a.frames) void this.a.choose(whole, l2);
    else if (!this.b.frames) void this.b.choose(whole, l2);
    if (this.mode === "compare") void this.chooseSecond();
    this.move(1, this.t < 1);
  }

  /** Chooses the direction that is `degrees` away from the one that is chosen. */
  step(degrees: number): void {
    this.choose((this.a.choice?.direction ?? 0) + degrees, null);
  }

  /** Picks an element, or lets go of the one that is picked. */
  pick(element: number | null): void {
    this.picked = element === this.picked ? null : element;
    this.show();
  }

  /** Goes to a place between the start and the limit at once. */
  scrub(t: number): void {
    cancelAnimationFrame(this.moving);
    this.t = t;
    this.show();
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
    const frames = this.a.frames?.simulation.frames.length ?? 0;
    const whole = Math.max(MOVE_MS, FRAME_MS * frames);
    const begun = performance.now();
    const step = (now: number) => {
      // The limit is waited for.
      const x = Math.min(1, (now - begun) / (whole * Math.max(0.2, Math.abs(to - from))));
      this.t = x === 1 ? to : from + (to - from) * x * x * (3 - 2 * x);
      this.show();
      if (x < 1) this.moving = requestAnimationFrame(step);
    };
    this.moving = requestAnimationFrame(step);
  }
}
