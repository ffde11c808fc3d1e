// The head of the page: the design that is open, the modes, exports.

import { DesignSelect } from "./design-select";
import { h } from "./dom";
import { ExportMenu } from "./export-menu";
import type { Mode, ViewState } from "./state";

export class Header {
  readonly node: HTMLElement;
  private designs: DesignSelect;
  private tabs: HTMLButtonElement[];

  constructor(private state: ViewState) {
    const { start } = state;
    this.designs = new DesignSelect(start, { "aria-label": "Design", class: "design" }, (name) => void state.open(name));
    const modes: [Mode, string][] = [
      ["explore", "Explore"],
      ["draw", "Draw"],
      ["edit", "Edit"],
      ["compare", "Compare"],
    ];
    this.tabs = modes.map(([mode, label]) => this.tab(mode, label));
    const asked = [
      this.designs.node,
      h("div", { class: "tabs", role: "tablist" }, ...this.tabs),
      new ExportMenu(state).node,
    ];
    this.node = h(
      "header",
      {},
      h("span", { class: "mark", "aria-hidden": "true" }),
      h("span", { class: "name" }, "maille"),
      // A bundle has no program to ask.
      ...(start.bundle ? [] : asked),
    );
  }

  private tab(mode: Mode, label: string): HTMLButtonElement {
    const button = h("button", { type: "button", role: "tab", onclick: () => this.state.setMode(mode) }, label);
    button.dataset["mode"] = mode;
    return button;
  }

  drawMode(): void {
    for (const tab of this.tabs) tab.setAttribute("aria-selected", String(tab.dataset["mode"] === this.state.mode));
  }

  draw(): void {
    this.designs.draw(this.state.a);
  }
}
