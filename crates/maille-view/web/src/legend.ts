// What the colours of the elements mean.

import { h, short } from "./dom";
import { loads, slack } from "./limits";
import type { ViewState } from "./state";

export class ColorLegend {
  readonly node = h("div", { class: "legend" });

  constructor(private state: ViewState) {}

  draw(): void {
    const { a, colorBy, locked, t, start } = this.state;
    this.node.hidden = !a.own || colorBy === "element";
    if (!a.own || colorBy === "element") return;
    const sheet = locked?.sheet ?? a.own;
    const limit = locked?.limit ?? null;
    const byLoad = colorBy === "load";
    const values = byLoad ? loads(sheet, limit) : slack(sheet, limit && t === 1 ? limit.pairs : sheet.pairs);
    const most = Math.max(...values.filter(Number.isFinite), 0);
    const ramp = `background:linear-gradient(90deg, ${start.palette.loads.join(", ")})`;
    const [what, left, right] = byLoad
      ? ["load", "0", most ? short(most, 3) : "no load in this state"]
      : ["smallest gap", short(most, 3), "0"];
    this.node.replaceChildren(h("span", {}, what), h("span", {}, left), h("i", { style: ramp }), h("span", {}, right));
  }
}
