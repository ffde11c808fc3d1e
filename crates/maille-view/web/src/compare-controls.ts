// The second sheet: which design or record, with which wire, and which of the two is shown.

import { unitOf } from "./controls";
import { DesignSelect } from "./design-select";
import { h } from "./dom";
import { Slider } from "./slider";
import type { Both, ViewState } from "./state";

const SHOWN: [Both, string][] = [
  ["both", "Both"],
  ["a", "First"],
  ["b", "Second"],
];

export class CompareControls {
  readonly node: HTMLElement;
  private select: DesignSelect;
  private wire: Slider;
  private shown: HTMLElement;

  constructor(private state: ViewState) {
    const { b, start } = state;
    this.wire = new Slider("Its wire radius", [0, 1, 0.001], (minorRadius) => void b.change({ minorRadius }));
    this.select = new DesignSelect(start, { "aria-label": "Second design" }, (name) => void state.compareWith(name));
    const same = h("button", { type: "button", onclick: () => void state.compareSame() }, "Same design");
    const show = ([both, label]: [Both, string]) =>
      h("button", { type: "button", "data-both": both, onclick: () => state.set({ both }) }, label);
    this.shown = h("div", { class: "chips", role: "group", "aria-label": "Sheets that are shown" }, ...SHOWN.map(show));
    this.node = h(
      "div",
      { class: "compared", hidden: true },
      h("p", { class: "second-head" }, "With"),
      h("div", { class: "row" }, h("label", { class: "field" }, "Second design", this.select.node), same),
      this.wire.node,
      this.shown,
    );
  }

  draw(): void {
    const { b, both } = this.state;
    this.select.draw(b);
    this.wire.node.hidden = b.frames !== null;
    this.wire.setWire(b, unitOf(b));
    for (const node of this.shown.children) {
      node.setAttribute("aria-pressed", String((node as HTMLElement).dataset["both"] === both));
    }
  }
}
