// What the colours of the elements mean.

import { h, short } from "./dom";
import { pairsOf } from "./drawing";
import { loads, slack } from "./limits";
import type { ViewState } from "./state";

export class ColorLegend {
  readonly node = h("div", { class: "legend" });

  constructor(private state: ViewState) {}

  draw(): void {
    const { a, colorBy, start } = this.state;
    const drawn = a.drawn(this.state.t);
    this.node.hidden = !drawn || colorBy === "element";
    if (!drawn || colorBy === "element") return;
    const { sheet, limit } = drawn;
    const byLoad = colorBy === "load";
    const values = byLoad ? loads(sheet, limit) : slack(sheet, pairsOf(drawn));
    const most = Math.max(...values.filter(Number.isFinite), 0);
    const ramp = `background:linear-gradient(90deg, ${start.palette.loads.join(", ")})`;
    const [what, left, right] = byLoad
      ? ["load", "0", most ? short(most, 3) : "no load in this state"]
      : ["smallest gap", short(most, 3), "0"];
    this.node.replaceChildren(h("span", {}, what), h("span", {}, left), h("i", { style: ramp }), h("span", {}, right));
  }
}
