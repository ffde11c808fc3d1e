// The design's text and its elements side by side, with what is wrong at its line.

import * as api from "./api";
import { h } from "./dom";
import type { Side } from "./side";
import type { ElementSpec } from "./types";

const number = (x: number) => (Number.isInteger(x) ? x.toFixed(1) : String(x));

export class Editor {
  readonly node: HTMLElement;
  private area: HTMLTextAreaElement;
  private gutter: HTMLElement;
  private problems: HTMLElement;
  private table: HTMLElement;
  private fileName: HTMLInputElement;
  private said: HTMLElement;
  private drawn = "";

  constructor(
    private side: Side,
    weaves: string[],
  ) {
    this.area = h("textarea", {
      class: "toml",
      "aria-label": "Design file, TOML",
      spellcheck: "false",
      wrap: "off",
      oninput: () => void this.write(this.area.value),
      onscroll: () => (this.gutter.scrollTop = this.area.scrollTop),
    });
    this.gutter = h("div", { class: "gutter", "aria-hidden": "true" });
    this.problems = h("div", { class: "problems", role: "status", "aria-live": "polite" });
    this.table = h("div", { class: "table-box" });
    this.fileName = h("input", { type: "text", "aria-label": "File name", class: "file" });
    this.said = h("span", { class: "said", role: "status" });
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
      const request = {
        name: name.value,
        weave: weave.value,
        major: Number(major.value),
        minor: Number(minor.value),
        unit: unit.value,
      };
      try {
        const made = await api.weave(request);
        this.fileName.value = `${name.value}.toml`;
        this.say("");
        await this.side.open({ name: `${made.name}.toml`, file: null, text: made.text, map: null });
      } catch (error) {
        this.refuse(error);
      }
    };
    this.node = h(
      "section",
      { class: "editor", "aria-label": "Design editor" },
      h("div", { class: "text-box" }, this.gutter, this.area),
      this.problems,
      this.table,
      h(
        "div",
        { class: "row" },
        h("button", { type: "button", onclick: () => this.add() }, "Add element"),
        this.fileName,
        h("button", { type: "button", class: "primary", onclick: () => void this.save(false) }, "Save"),
        this.said,
      ),
      h(
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
      ),
    );
  }

  private say(text: string, ...more: Node[]): void {
    this.said.replaceChildren(text, ...more);
  }

  private refuse(error: unknown): void {
    const refused = error instanceof api.Refusal ? error.refused : { problem: String(error), help: "" };
    this.say(`${refused.problem}${refused.help ? ` — ${refused.help}` : ""}`);
  }

  private write(text: string): Promise<void> {
    this.say("");
    return this.side.change({ text, minorRadius: null, spacing: null });
  }

  private async save(overwrite: boolean): Promise<void> {
    try {
      const saved = await api.save({ file: this.fileName.value, text: this.side.text, overwrite });
      this.say(`saved ${saved.name}`);
    } catch (error) {
      this.refuse(error);
      if (error instanceof api.Refusal && error.status === 409) {
        this.said.append(" ", h("button", { type: "button", onclick: () => void this.save(true) }, "Replace it"));
      }
    }
  }

  private async set(field: string, value: string): Promise<void> {
    try {
      await this.write((await api.edit({ text: this.side.text, field, value })).text);
    } catch (error) {
      this.refuse(error);
    }
  }

  /** A ring beside the last element. */
  private add(): void {
    const design = this.side.design;
    const last = design?.elements.at(-1);
    const names = new Set(design?.elements.map((e) => e.name));
    let k = (design?.elements.length ?? 0) + 1;
    while (names.has(`element-${k}`)) k += 1;
    const [x, y, z] = last?.center ?? [0, 0, 0];
    const R = design?.reference_radius ?? 1;
    const ring = `{ major_radius = ${number(R)}, normal = [0.0, 0.0, 1.0] }`;
    const center = `[${number(x)}, ${number(y)}, ${number(z + R)}]`;
    const table = `[[elements]]\nname = "element-${k}"\ncenter = ${center}\nrings = [${ring}]\n`;
    void this.write(`${this.side.text.trimEnd()}\n\n${table}`);
  }

  /** Takes an element's lines out of the text; comments of others stay. */
  private remove(index: number): void {
    const lines = this.side.text.split("\n");
    const heads = lines.flatMap((line, at) => (/^\s*\[\[\s*elements\s*\]\]/.test(line) ? [at] : []));
    const from = heads[index];
    if (from === undefined) return this.say("the element is not a table of its own: change the text");
    let to = lines.findIndex((line, at) => at > from && /^\s*\[(?!\[\s*elements\s*\.)/.test(line));
    if (to < 0) to = lines.length;
    lines.splice(from, to - from);
    void this.write(lines.join("\n"));
  }

  draw(): void {
    const { side } = this;
    if (this.area.value !== side.text) this.area.value = side.text;
    if (!this.fileName.value || this.drawn !== side.name) {
      const plain = side.name.split("/").at(-1) ?? side.name;
      this.fileName.value = side.file ?? (plain.endsWith(".toml") ? plain : `${plain}.toml`);
    }
    this.drawn = side.name;
    const wrong = new Map(side.problems.map((p) => [p.line, p]));
    const count = side.text.split("\n").length;
    this.gutter.replaceChildren(
      ...Array.from({ length: count }, (_, k) => h("span", { class: wrong.has(k + 1) ? "wrong" : "" }, String(k + 1))),
    );
    const list = side.problems.map((p, k) =>
      h(
        "button",
        { type: "button", class: "problem", onclick: () => this.go(p.line, p.column) },
        h("b", {}, p.line === null ? "" : `line ${p.line}: `),
        `${p.field ? `${p.field}: ` : ""}${p.problem}`,
        // What helps several is said once.
        p.help === side.problems[k + 1]?.help ? null : h("span", { class: "help" }, p.help ?? ""),
      ),
    );
    const lost = side.problems.length ? [] : side.lost;
    const words = lost.length
      ? h("p", { class: "lost" }, h("b", {}, `${lost.length} links are broken: `), lost.map((l) => l.words).join("; "))
      : null;
    const fine = h(
      "p",
      { class: "fine" },
      `no problems; ${side.own?.pairs.filter((p) => p.number).length ?? 0} links a cell`,
    );
    this.problems.replaceChildren(...(list.length ? list : [words ?? fine]));
    if (!this.table.contains(document.activeElement)) this.drawTable();
  }

  private go(line: number | null, column: number | null): void {
    if (line === null) return;
    const before = this.side.text.split("\n").slice(0, line - 1);
    const at = before.reduce((sum, text) => sum + text.length + 1, 0) + (column ?? 1) - 1;
    this.area.focus();
    this.area.setSelectionRange(at, at);
    this.area.scrollTop = Math.max(0, (line - 5) * 18);
  }

  private drawTable(): void {
    const design = this.side.design;
    if (!design) return this.table.replaceChildren();
    const rows = design.elements.flatMap((element, i) => element.rings.map((_, k) => this.row(element, i, k)));
    const head = ["element", "x", "y", "z", "R", "nx", "ny", "nz", ""];
    this.table.replaceChildren(
      h(
        "table",
        {},
        h("thead", {}, h("tr", {}, ...head.map((t) => h("th", { scope: "col" }, t)))),
        h("tbody", {}, ...rows),
      ),
    );
  }

  /** Ring `k` of element `i`; its first ring has the element's name and centre. */
  private row({ name, center, rings }: ElementSpec, i: number, k: number): HTMLElement {
    const { major_radius, normal } = rings[k]!;
    const place = center.map((x, axis) => this.cell(`[${i}].center[${axis}]`, x, `${name}, centre ${"xyz"[axis]}`));
    const ring = `${name}, ring ${k}`;
    const remove = { type: "button", "aria-label": `Remove ${name}`, title: "Remove", onclick: () => this.remove(i) };
    return h(
      "tr",
      {},
      h("th", { scope: "row" }, k ? `ring ${k}` : name),
      ...(k ? [h("td", { colspan: 3 })] : place),
      this.cell(`[${i}].rings[${k}].major_radius`, major_radius, `${ring}, R`),
      ...normal.map((x, axis) => this.cell(`[${i}].rings[${k}].normal[${axis}]`, x, `${ring}, normal ${"xyz"[axis]}`)),
      h("td", {}, k ? null : h("button", remove, "×")),
    );
  }

  /** A number of the elements that can be typed anew. */
  private cell(field: string, value: number, label: string): HTMLElement {
    const onchange = () => {
      const typed = Number(input.value);
      if (input.value.trim() === "" || !Number.isFinite(typed)) input.value = String(value);
      else void this.set(`elements${field}`, number(typed));
    };
    const input = h("input", {
      type: "text",
      inputmode: "decimal",
      value: String(value),
      "aria-label": label,
      onchange,
    });
    return h("td", {}, input);
  }
}
