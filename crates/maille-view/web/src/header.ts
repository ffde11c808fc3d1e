// The head of the page: the design that is open, the modes, exports.

import { h } from "./dom";
import { ExportMenu } from "./export-menu";
import type { Mode, ViewState } from "./state";

export class Header {
  readonly node: HTMLElement;
  private designs: HTMLSelectElement;
  /** What was opened and is no built-in design. */
  private other: HTMLOptionElement;
  private tabs: HTMLButtonElement[];

  constructor(private state: ViewState) {
    const { start } = state;
    this.other = h("option", { value: "" }, start.opened.name);
    this.designs = h(
      "select",
      { "aria-label": "Design", class: "design", onchange: () => void state.open(this.designs.value) },
      this.other,
      ...start.designs.map((d) => h("option", { value: d.name }, `${d.name}  ${d.title}`)),
    );
    this.tabs = [this.tab("explore", "Explore"), this.tab("edit", "Edit"), this.tab("compare", "Compare")];
    const asked = [
      this.designs,
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
    const { a, start } = this.state;
    const builtin = (name: string) => start.designs.some((d) => d.name === name);
    const known = builtin(a.name);
    if (!known) this.other.textContent = a.name;
    this.other.hidden = known && builtin(start.opened.name);
    this.designs.value = known ? a.name : "";
  }
}
