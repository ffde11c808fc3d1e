// The one or two sheets in 3D, seen from one side.

import { Stage } from "./stage";
import type { Side } from "./side";
import type { ViewState } from "./state";

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
    const two = this.state.mode === "compare";
    this.boxes.b.hidden = !two;
    if (!two || this.second) return;
    const { first } = this;
    const second = new Stage(this.boxes.b, this.state.start.palette, "The second sheet in 3D", () => {});
    first.onTurn = () => second.follow(first);
    second.onTurn = () => first.follow(second);
    this.second = second;
  }

  draw(): void {
    const { a, b, mode, picked } = this.state;
    this.show(this.first, a, picked);
    if (this.second && mode === "compare") this.show(this.second, b, null);
  }

  private show(stage: Stage, side: Side, picked: number | null): void {
    const { a, tile, colorBy, forces, chain } = this.state;
    const { own, locked } = side;
    if (!own) return;
    const t = locked ? this.state.t : 0;
    stage.show({
      own,
      sheet: locked?.sheet ?? own,
      limit: locked?.limit ?? null,
      tile,
      t,
      colorBy,
      picked,
      forces,
      chain: chain && t > 0,
      lost: side === a ? side.lost : [],
    });
  }
}
