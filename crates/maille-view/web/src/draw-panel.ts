// A design is drawn: the board, the numbers of the ring that is selected, the lattice, what is wrong, and the file.

import * as api from "./api";
import { Board } from "./board";
import { plainName, toml, tomlVector, withRing, withoutElement } from "./design-text";
import { h, short } from "./dom";
import { Draft } from "./draft";
import { attitude, lengthStep, moved, resized, rounded, turned, type Attitude } from "./plan";
import { problemList } from "./problems";
import { SaveRow } from "./save-row";
import { Selection } from "./selection";
import type { Side } from "./side";
import type { Change, Design, ElementSpec, Palette } from "./types";

/** Degrees that a key turns a ring by. */
const TURN = 5;
/** Moves by a key, in reference radii. */
const MOVE = 0.05;

/** Numbers of the ring that is selected, and of the sheet. */
const RING_FIELDS = ["x", "y", "z", "turn °", "tilt °", "R", "r"] as const;
const SHEET_FIELDS = ["r of all rings", "a₁ x", "a₁ y", "a₂ x", "a₂ y"] as const;
type Field = (typeof RING_FIELDS)[number] | (typeof SHEET_FIELDS)[number];

export class DrawPanel {
  readonly node: HTMLElement;
  readonly board: Board;
  private selection = new Selection(() => this.draw());
  private draft: Draft;
  private saving: SaveRow;
  private inputs = new Map<Field, HTMLInputElement>();
  private select: HTMLSelectElement;
  private designName: HTMLInputElement;
  private problems = h("div", { class: "problems", role: "status", "aria-live": "polite" });
  private undo: HTMLButtonElement;
  private remove: HTMLButtonElement;
  private copy: HTMLButtonElement;
  private drawn = "";

  constructor(
    private side: Side,
    palette: Palette,
  ) {
    this.draft = new Draft(
      side,
      (error) => this.saving.refuse(error),
      (busy) => {
        this.node.ariaBusy = String(busy);
        if (!busy) this.draw();
      },
    );
    this.saving = new SaveRow(side);
    this.board = new Board(side, palette, this.selection, this.draft, (event) => this.press(event));
    const choose = () => this.selection.pick(this.select.value === "" ? null : Number(this.select.value));
    this.select = h("select", { "aria-label": "Ring", onchange: choose });
    this.designName = h("input", { type: "text", "aria-label": "Name of the design", onchange: () => this.rename() });
    const button = (words: string, work: () => void) => h("button", { type: "button", onclick: work }, words);
    this.undo = button("Undo", () => this.goBack());
    this.copy = button("Copy ring", () => this.add(true));
    this.remove = button("Remove ring", () => this.removeSelected());
    const legend = (words: string, ...inside: HTMLElement[]) => h("fieldset", {}, h("legend", {}, words), ...inside);
    const fields = (names: readonly Field[]) => h("div", { class: "numbers" }, ...names.map((name) => this.field(name)));
    this.node = h(
      "section",
      { class: "draw", "aria-label": "Drawing of a design" },
      h(
        "div",
        { class: "row" },
        h("label", { class: "field" }, "Name of the design", this.designName),
        button("New design", () => void this.begin()),
        button("Copy design", () => void this.copyDesign()),
        this.undo,
      ),
      legend(
        "Ring",
        h("div", { class: "row" }, this.select, button("Add ring", () => this.add(false)), this.copy, this.remove),
        fields(RING_FIELDS),
      ),
      legend("Sheet", fields(SHEET_FIELDS)),
      this.problems,
      this.saving.node,
    );
  }

  private field(name: Field): HTMLElement {
    const input = h("input", {
      type: "number",
      step: "any",
      "aria-label": name,
      onchange: () => {
        const typed = Number(input.value);
        if (input.value !== "" && Number.isFinite(typed)) this.set(name, typed);
        else this.draw();
      },
    });
    this.inputs.set(name, input);
    return h("label", { class: "field" }, name, input);
  }

  private get element(): { design: Design; index: number; element: ElementSpec } | null {
    const { design } = this.side;
    const { index } = this.selection;
    const element = index === null ? undefined : design?.elements[index];
    return design && index !== null && element ? { design, index, element } : null;
  }

  /** Changes the selected element of the design as it is by then. */
  private change(of: (design: Design, index: number, element: ElementSpec) => Change[]): void {
    const { index } = this.selection;
    if (index === null) return;
    this.draft.remember();
    this.draft.set((design) => {
      const element = design.elements[index];
      return element ? of(design, index, element) : [];
    });
  }

  /** Changes a number of the ring or of the sheet. */
  private set(name: Field, value: number): void {
    const place = (["x", "y", "z"] as Field[]).indexOf(name);
    if ((SHEET_FIELDS as readonly Field[]).includes(name)) return this.setSheet(name, value);
    if (place >= 0) return this.move((center) => center.map((x, k) => (k === place ? value : x)));
    if (name === "R") return this.change((design, index) => resized(design, index, value));
    if (name === "tilt °") return this.turn(() => ({ tilt: value }));
    if (name === "turn °") return this.turn(() => ({ turn: value }));
    this.change((_, index, { rings }) =>
      rings.map((_ring, k) => ({ field: `elements[${index}].rings[${k}].minor_radius`, value: toml(value) })),
    );
  }

  private setSheet(name: Field, value: number): void {
    this.draft.remember();
    if (name === "r of all rings") return this.draft.set(() => [{ field: "minor_radius", value: toml(value) }]);
    const [vector, axis] = [name.startsWith("a₁") ? "a1" : "a2", name.endsWith("y") ? 1 : 0] as const;
    this.draft.set(({ lattice }) => {
      const changed = lattice[vector].map((x, k) => (k === axis ? value : x));
      return [{ field: `lattice.${vector}`, value: tomlVector(changed) }];
    });
  }

  private move(to: (center: number[], step: number) => number[]): void {
    this.change((design, index, { center }) => moved(index, to(center, lengthStep(design))));
  }

  private turn(to: (now: Attitude) => Partial<Attitude>): void {
    this.change((design, index, { rings }) => {
      const from = attitude(rings[0]!.normal, this.selection.turn);
      const next = { ...from, ...to(from) };
      this.selection.turn = next.turn;
      return turned(design, index, from, next);
    });
  }

  private goBack(): void {
    this.selection.turn = 0;
    this.draft.undo();
  }

  /** What the keys do on the board. */
  private press(event: KeyboardEvent): void {
    if ((event.ctrlKey || event.metaKey) && event.key === "z") {
      event.preventDefault();
      return this.goBack();
    }
    const { design } = this.side;
    if (!design || !this.element || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = Math.max(lengthStep(design), (event.shiftKey ? 0.2 : 1) * MOVE * design.reference_radius);
    const by = (x: number, y: number, z: number) => () =>
      this.move((center, fine) => center.map((at, k) => rounded(at + [x, y, z][k]!, fine)));
    const lean = (degrees: number) => () =>
      this.turn(({ tilt }) => ({ tilt: rounded(Math.max(0, Math.min(180, tilt + degrees)), 1) }));
    const spin = (degrees: number) => () => this.turn(({ turn }) => ({ turn: rounded(turn + degrees, 1) }));
    const grow = (more: number) => () =>
      this.change((now, index, { rings }) => resized(now, index, Math.max(step, rings[0]!.major_radius + more)));
    const work: Record<string, () => void> = {
      ArrowLeft: by(-step, 0, 0),
      ArrowRight: by(step, 0, 0),
      ArrowUp: by(0, step, 0),
      ArrowDown: by(0, -step, 0),
      PageUp: by(0, 0, step),
      PageDown: by(0, 0, -step),
      "[": spin(TURN),
      "]": spin(-TURN),
      ",": lean(-TURN),
      ".": lean(TURN),
      "+": grow(step),
      "=": grow(step),
      "-": grow(-step),
      Delete: () => this.removeSelected(),
    };
    const todo = work[event.key];
    if (!todo) return;
    event.preventDefault();
    todo();
  }

  /** Adds a ring above the one that is selected, flat or as that one is. */
  private add(alike: boolean): void {
    const { design, text } = this.side;
    if (!design) return;
    const model = this.element ?? { element: design.elements.at(-1)! };
    const [x, y] = model.element.center;
    // Above the others: rings that lie flat in one plane would meet.
    const top = Math.max(...design.elements.map((e) => e.center[2])) + 4 * (design.minor_radius ?? 0);
    const place = [x + 0.5 * design.reference_radius, y, top].map((value) => rounded(value, lengthStep(design)));
    const [longer, name] = withRing(text, design, place, alike ? model.element.rings : undefined);
    this.draft.remember();
    this.draft.write(longer);
    this.saving.say(`${name} is added`);
    this.selection.pick(design.elements.length);
  }

  private removeSelected(): void {
    const at = this.element;
    if (!at) return;
    if (at.design.elements.length === 1) return this.saving.say("a design needs a ring: this is the last one");
    const shorter = withoutElement(this.side.text, at.index);
    if (shorter === null) return this.saving.say("the element is not a table of its own: change the text");
    this.draft.remember();
    this.selection.pick(null);
    this.draft.write(shorter);
  }

  private rename(): void {
    const name = plainName(this.designName.value);
    this.designName.value = name;
    if (name) this.draft.set(() => [{ field: "name", value: JSON.stringify(name) }]);
  }

  /** A new design: one ring in a square cell. */
  private async begin(): Promise<void> {
    const request = { name: "my-weave", weave: null, major: 1, minor: 0.1, unit: "" };
    try {
      await this.open(await api.newDesign(request));
      this.selection.pick(0);
    } catch (error) {
      this.saving.refuse(error);
    }
  }

  /** The design that is open, under another name. */
  private async copyDesign(): Promise<void> {
    const { design, text } = this.side;
    if (!design) return;
    const name = `${plainName(design.name)}-copy`;
    try {
      const copied = await api.edit(text, [{ field: "name", value: JSON.stringify(name) }]);
      await this.open({ ...api.PLAIN, name: `${name}.toml`, text: copied });
    } catch (error) {
      this.saving.refuse(error);
    }
  }

  private async open(shown: Parameters<Side["open"]>[0]): Promise<void> {
    this.draft.forget();
    this.selection.pick(null);
    await this.side.open(shown);
  }

  draw(): void {
    const { side, selection } = this;
    const { design } = side;
    if (!design) return;
    if (this.drawn !== side.name) this.draft.forget();
    this.drawn = side.name;
    const names = design.elements.map((e) => e.name);
    // A ring that is being added is selected before it is there.
    if (selection.index !== null && selection.index >= names.length && !this.draft.busy) selection.index = null;
    if (this.select.dataset["key"] !== names.join()) {
      this.select.dataset["key"] = names.join();
      const options = names.map((name, k) => h("option", { value: k }, name));
      this.select.replaceChildren(h("option", { value: "" }, "none selected"), ...options);
    }
    this.select.value = selection.index === null ? "" : String(selection.index);
    if (document.activeElement !== this.designName) this.designName.value = design.name;
    this.undo.disabled = !this.draft.canUndo;
    this.remove.disabled = this.copy.disabled = this.element === null;
    this.drawNumbers(design);
    this.problems.replaceChildren(...problemList(side, () => {}), ...this.links());
    this.saving.draw();
    this.board.draw();
  }

  private drawNumbers(design: Design): void {
    const at = this.element;
    const { a1, a2 } = design.lattice;
    const values = new Map<Field, number | null>([
      ["r of all rings", design.minor_radius ?? null],
      ["a₁ x", a1[0]],
      ["a₁ y", a1[1]],
      ["a₂ x", a2[0]],
      ["a₂ y", a2[1]],
    ]);
    if (at) {
      const { center, rings } = at.element;
      const { tilt, turn } = attitude(rings[0]!.normal, this.selection.turn);
      const angles = [turn, tilt].map((x) => rounded(x, 0.01));
      const shown = [...center, ...angles, rings[0]!.major_radius, rings[0]!.minor_radius ?? design.minor_radius];
      RING_FIELDS.forEach((name, k) => values.set(name, shown[k] ?? null));
    }
    for (const [name, input] of this.inputs) {
      const value = values.get(name) ?? null;
      input.disabled = value === null && name !== "r";
      if (name === "r") input.disabled = !at;
      if (document.activeElement !== input) input.value = value === null ? "" : short(value).replace("−", "-");
    }
  }

  /** The links of the ring that is selected. */
  private links(): HTMLElement[] {
    const at = this.element;
    const sheet = this.side.own;
    if (!at || !sheet || !this.side.readable) return [];
    const of = sheet.pairs.flatMap(({ ring_a, ring_b, shift, number }) => {
      const [a, b] = [sheet.rings[ring_a]!.element, sheet.rings[ring_b]!.element];
      const seen = (other: number, sign: number) => {
        const cell = shift.some(Boolean) ? ` (${shift.map((x) => sign * x || 0).join(", ")})` : "";
        return `${sheet.poses[other]?.element}${cell}`;
      };
      return number ? [...(a === at.index ? [seen(b, 1)] : []), ...(b === at.index ? [seen(a, -1)] : [])] : [];
    });
    const words = of.length ? `${at.element.name} is linked with ${of.join(", ")}` : `${at.element.name} has no links`;
    return [h("p", { class: "links" }, words)];
  }
}
