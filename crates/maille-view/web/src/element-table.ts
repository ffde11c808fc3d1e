// The elements of a design as a table in which every number can be typed anew.

import { toml, tomlVector } from "./design-text";
import type { Draft } from "./draft";
import { h } from "./dom";
import type { Design, ElementSpec } from "./types";

const HEAD: [string, string][] = [
  ["element", ""],
  ...["x", "y", "z"].map((t): [string, string] => [t, "centre of the element"]),
  ["R", "major radius"],
  ["r", "minor radius; empty: that of the design"],
  ...["nx", "ny", "nz"].map((t): [string, string] => [t, "normal of the ring"]),
  ...["ox", "oy", "oz"].map((t): [string, string] => [t, "offset of the ring from the centre of its element"]),
  ["", ""],
];

export class ElementTable {
  readonly node = h("div", { class: "table-box", role: "region", "aria-label": "Elements", tabindex: 0 });

  constructor(
    private draft: Draft,
    private remove: (index: number) => void,
  ) {}

  draw(design: Design | null): void {
    if (this.node.contains(document.activeElement) && document.activeElement !== this.node) return;
    if (!design) return this.node.replaceChildren();
    const rows = design.elements.flatMap((element, i) =>
      element.rings.map((_, k) => this.row(element, i, k, design.minor_radius ?? null)),
    );
    const head = HEAD.map(([words, title]) => h("th", { scope: "col", title: title || null }, words));
    this.node.replaceChildren(h("table", {}, h("thead", {}, h("tr", {}, ...head)), h("tbody", {}, ...rows)));
  }

  /** Ring `k` of element `i`; its first ring has the element's name and centre. */
  private row({ name, center, rings }: ElementSpec, i: number, k: number, common: number | null): HTMLElement {
    const { major_radius, minor_radius, normal, offset } = rings[k]!;
    const [at, ring] = [`elements[${i}].rings[${k}]`, `${name}, ring ${k}`];
    const number = (field: string, value: number, label: string) =>
      cell(value, label, (x) => this.set(field, () => toml(x)));
    const place = center.map((x, axis) => number(`elements[${i}].center[${axis}]`, x, `${name}, centre ${"xyz"[axis]}`));
    const moved = (axis: number, x: number) => (design: Design) =>
      tomlVector(design.elements[i]!.rings[k]!.offset.map((old, other) => (other === axis ? x : old)));
    const remove = { type: "button", "aria-label": `Remove ${name}`, title: "Remove", onclick: () => this.remove(i) };
    return h(
      "tr",
      {},
      h("th", { scope: "row" }, k ? `ring ${k}` : name),
      ...(k ? [h("td", { colspan: 3 })] : place),
      number(`${at}.major_radius`, major_radius, `${ring}, R`),
      cell(minor_radius ?? null, `${ring}, r`, (x) => this.set(`${at}.minor_radius`, () => toml(x)), common),
      ...normal.map((x, axis) => number(`${at}.normal[${axis}]`, x, `${ring}, normal ${"xyz"[axis]}`)),
      ...offset.map((x, axis) =>
        cell(x, `${ring}, offset ${"xyz"[axis]}`, (typed) => this.set(`${at}.offset`, moved(axis, typed))),
      ),
      h("td", {}, k ? null : h("button", remove, "×")),
    );
  }

  private set(field: string, value: (design: Design) => string): void {
    this.draft.remember();
    this.draft.set((design) => [{ field, value: value(design) }]);
  }
}

/** A number that can be typed anew; `usual` is shown where there is none. */
function cell(value: number | null, label: string, set: (x: number) => void, usual: number | null = null): HTMLElement {
  const onchange = () => {
    const typed = Number(input.value.replace("−", "-"));
    if (input.value.trim() === "" || !Number.isFinite(typed)) input.value = value === null ? "" : String(value);
    else if (typed !== value) set(typed);
  };
  const input = h("input", {
    type: "text",
    inputmode: "decimal",
    value: value === null ? "" : String(value),
    placeholder: usual === null ? null : String(usual),
    "aria-label": label,
    onchange,
  });
  return h("td", {}, input);
}
