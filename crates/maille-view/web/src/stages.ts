// The one or two sheets in 3D, seen from one side.

import { Stage } from "./stage";
import type { Side } from "./side";
import type { ViewState } from "./state";

/** Cells of a design that is drawn: few, so that its rings are large. */
const DRAWN: [number, number] = [3, 3];

export class Stages {
  readonly first: Stage;
  private second: Stage | null = null;

  constructor(
    private state: ViewState,
    private boxes: { a: HTMLElement; b: HTMLElement },
  ) {
    const label = "The sheet in 3D. Arrow keys turn it, plus and minus zoom.";
    this.first = new Stage(boxes.a, state.start.palette, label, (element) => state.pick(element));
  }

  /** The second stage is there when two sheets are compared. */
  drawMode(): void {
    const { mode, both } = this.state;
    const two = mode === "compare";
    const { a, b } = this.boxes;
    const shown = [!two || both !== "b", two && both !== "a"];
    // A sheet that comes into sight is seen from where the other was.
    const [comes, from] = b.hidden && this.second ? [this.second, this.first] : [this.first, this.second];
    const changes = a.hidden === shown[0] || b.hidden === shown[1];
    [a.hidden, b.hidden] = shown.map((x) => !x) as [boolean, boolean];
    if (changes && two && from) comes.follow(from);
    if (!two || this.second) return;
    const { first } = this;
    const second = new Stage(this.boxes.b, this.state.start.palette, "The second sheet in 3D", () => {});
    first.onTurn = () => second.follow(first);
    second.onTurn = () => first.follow(second);
    this.second = second;
  }

  draw(): void {
    const { a, b, mode, picked } = this.state;
    this.boxes.a.classList.toggle("stale", !a.readable);
    this.show(this.first, a, picked);
    if (this.second && mode === "compare") this.show(this.second, b, null);
  }

  private show(stage: Stage, side: Side, picked: number | null): void {
    const { a, mode, tile, colorBy, forces, chain } = this.state;
    const { own, frames } = side;
    const drawn = side.drawn(this.state.placeOf(side));
    if (!own || !drawn) return;
    stage.show({
      own,
      ...drawn,
      tile: frames ? [1, 1] : mode === "draw" ? DRAWN : side.cells(tile),
      reach: frames?.reach ?? null,
      colorBy,
      picked,
      forces,
      chain: chain && drawn.t > 0,
      changed: side === a ? side.changedLinks : [],
    });
  }
}
