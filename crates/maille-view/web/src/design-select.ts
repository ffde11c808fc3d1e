// The list of what can be opened: what the program was started with, built-in designs, records.

import { h } from "./dom";
import { RECORD } from "./state";
import type { Side } from "./side";
import type { Start } from "./types";

export class DesignSelect {
  readonly node: HTMLSelectElement;
  /** What is open and stands in no list. */
  private other: HTMLOptionElement;

  constructor(
    private start: Start,
    attributes: Record<string, string>,
    onChoose: (name: string) => void,
  ) {
    this.other = h("option", { value: "" }, start.opened.name);
    const group = (label: string, options: HTMLOptionElement[]) =>
      options.length ? h("optgroup", { label }, ...options) : null;
    this.node = h(
      "select",
      { ...attributes, onchange: () => onChoose(this.node.value) },
      this.other,
      group(
        "Built-in designs",
        start.designs.map((d) => h("option", { value: d.name }, `${d.name}  ${d.title}`)),
      ),
      group(
        "Records",
        start.records.map((r) => h("option", { value: RECORD + r.name }, `${r.name}  ${r.title}`)),
      ),
    );
  }

  draw(side: Side): void {
    const { start } = this;
    const listed = (name: string) =>
      (side.source !== null && start.records.some((r) => r.name === name) && RECORD + name) ||
      (start.designs.some((d) => d.name === name) && name) ||
      "";
    const value = listed(side.source ?? side.name);
    if (!value) this.other.textContent = side.name || start.opened.name;
    this.other.hidden = value !== "" && start.designs.some((d) => d.name === start.opened.name);
    this.node.value = value;
  }
}
