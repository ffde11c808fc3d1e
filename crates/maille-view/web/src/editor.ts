// The design's text and its elements side by side, with what is wrong at its line.

import * as api from "./api";
import { plainName, withoutElement, withRing } from "./design-text";
import { h } from "./dom";
import { Draft } from "./draft";
import { ElementTable } from "./element-table";
import { ParameterSliders, written } from "./parameter-sliders";
import { problemList } from "./problems";
import { SaveRow } from "./save-row";
import type { Side } from "./side";

/** Height of a line of text, in pixels. */
const LINE = 18;

export class Editor {
  readonly node: HTMLElement;
  private area: HTMLTextAreaElement;
  private gutter = h("div", { class: "gutter", "aria-hidden": "true" });
  private problems = h("div", { class: "problems", role: "status", "aria-live": "polite" });
  private draft: Draft;
  private parameters: ParameterSliders;
  private table: ElementTable;
  private saving: SaveRow;

  constructor(
    private side: Side,
    weaves: string[],
  ) {
    this.area = h("textarea", {
      class: "toml",
      "aria-label": "Design file, TOML",
      spellcheck: "false",
      wrap: "off",
      oninput: () => this.draft.write(this.area.value, "text"),
      onscroll: () => (this.gutter.scrollTop = this.area.scrollTop),
    });
    this.draft = new Draft(
      side,
      (error) => this.saving.refuse(error),
      () => this.draw(),
    );
    // What the sliders of the map have changed is written with it.
    const write = (name: string, x: number) =>
      this.draft.set(() => written({ ...side.parameters, [name]: x }), `parameters.${name}`);
    this.parameters = new ParameterSliders(side, write, false);
    this.table = new ElementTable(this.draft, (index) => this.remove(index));
    const add = h("button", { type: "button", onclick: () => this.add() }, "Add element");
    this.saving = new SaveRow(side, add);
    this.node = h(
      "section",
      { class: "editor", "aria-label": "Design editor" },
      h("div", { class: "text-box" }, this.gutter, this.area),
      this.problems,
      this.parameters.node,
      this.table.node,
      this.saving.node,
      this.weaves(weaves),
    );
  }

  private weaves(weaves: string[]): HTMLElement {
    const field = (label: string, input: HTMLElement) => {
      input.setAttribute("aria-label", label);
      return h("label", { class: "field" }, label, input);
    };
    const [name, major, minor, unit] = [
      h("input", { type: "text", value: "my-weave" }),
      h("input", { type: "number", value: "5", step: "any", min: "0" }),
      h("input", { type: "number", value: "0.8", step: "any", min: "0" }),
      h("input", { type: "text", value: "mm" }),
    ];
    const weave = h("select", {}, ...weaves.map((w) => h("option", { value: w }, w)));
    const make = async () => {
      const sizes = { major: Number(major.value), minor: Number(minor.value), unit: unit.value };
      try {
        const made = await api.newDesign({ name: plainName(name.value), weave: weave.value, ...sizes });
        this.saving.say("");
        await this.side.open(made);
      } catch (error) {
        this.saving.refuse(error);
      }
    };
    return h(
      "details",
      { class: "new" },
      h("summary", {}, "New from a weave"),
      h(
        "div",
        { class: "grid" },
        field("Weave", weave),
        field("Name", name),
        field("R", major),
        field("r", minor),
        field("Unit", unit),
      ),
      h("button", { type: "button", onclick: () => void make() }, "Make the design"),
    );
  }

  /** A ring above the last element. */
  private add(): void {
    const { design, text } = this.side;
    const [x, y, z] = design?.elements.at(-1)?.center ?? [0, 0, 0];
    this.draft.write(withRing(text, design, [x, y, z + (design?.reference_radius ?? 1)])[0]);
  }

  private remove(index: number): void {
    const text = withoutElement(this.side.text, index);
    if (text === null) this.saving.say("the element is not a table of its own: change the text");
    else this.draft.write(text);
  }

  draw(): void {
    const { side } = this;
    if (this.area.value !== side.text && !this.draft.busy) this.area.value = side.text;
    this.saving.draw();
    const wrong = new Set(side.problems.map((p) => p.line));
    const count = this.area.value.split("\n").length;
    const number = (_: unknown, k: number) => h("span", { class: wrong.has(k + 1) ? "wrong" : "" }, String(k + 1));
    this.gutter.replaceChildren(...Array.from({ length: count }, number));
    this.problems.replaceChildren(...problemList(side, ({ line, column }) => this.go(line, column)));
    this.parameters.draw();
    this.table.draw(side.design);
  }

  private go(line: number | null, column: number | null): void {
    if (line === null) return;
    const before = this.side.text.split("\n").slice(0, line - 1);
    const at = before.reduce((sum, text) => sum + text.length + 1, 0) + (column ?? 1) - 1;
    this.area.focus();
    this.area.setSelectionRange(at, at);
    this.area.scrollTop = Math.max(0, (line - 5) * LINE);
  }
}
