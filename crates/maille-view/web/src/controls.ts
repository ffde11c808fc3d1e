// What is asked, and how it is drawn.

import { h, short } from "./dom";
import { widths } from "./limits";
import { ParameterSliders } from "./parameter-sliders";
import type { Side } from "./side";
import { Slider } from "./slider";
import type { ColorBy } from "./drawing";
import type { ViewState } from "./state";

const TILES = ["4", "6", "8", "12", "16", "24", "41"];

function select<T extends string>(label: string, options: [T, string][], chosen: T, set: (value: T) => void) {
  const node = h(
    "select",
    { "aria-label": label, onchange: () => set(node.value as T) },
    ...options.map(([value, words]) => h("option", { value }, words)),
  );
  node.value = chosen;
  return h("label", { class: "field" }, label, node);
}

function check(label: string, set: (on: boolean) => void): HTMLElement {
  const input = h("input", { type: "checkbox", checked: true, onchange: () => set(input.checked) });
  return h("label", { class: "check" }, input, label);
}

export function unitOf(side: Side): string {
  return side.own?.unit ? ` ${side.own.unit}` : "";
}

export class Controls {
  readonly node: HTMLElement;
  private direction: Slider;
  private l2: Slider;
  private wire: Slider;
  private spacing: Slider;
  private parameters: ParameterSliders;
  private free: HTMLInputElement;
  private widths = h("div", { class: "chips", role: "group", "aria-label": "Width of the record" });
  private elements: HTMLSelectElement;
  private command = h("code", { class: "command" });
  private solved: HTMLElement;
  private overlays: HTMLElement;
  private tiles: HTMLElement;

  constructor(private state: ViewState) {
    const { a, start } = state;
    const all = (change: Parameters<Side["change"]>[0]) => void state.each((side) => side.change(change));
    this.direction = new Slider("Direction of pull", [0, 179, 1], (x) => state.choose(x, null));
    this.l2 = new Slider("Width held, l₂", [-0.25, 0.25, 0.025], (l2) => all({ l2, free: false }));
    this.wire = new Slider("Wire radius", [0, 1, 0.001], (minorRadius) => void a.change({ minorRadius }));
    this.spacing = new Slider("Spacing", [0.8, 1.25, 0.005], (x) => void a.change({ spacing: x === 1 ? null : x }));
    this.parameters = new ParameterSliders(a, (name, x) => void a.setParameter(name, x));
    this.free = h("input", { type: "checkbox", onchange: () => all({ free: this.free.checked }) });
    this.elements = h("select", {
      "aria-label": "Element",
      onchange: () => state.pick(this.elements.value === "" ? null : Number(this.elements.value)),
    });
    this.solved = h(
      "div",
      { class: "solved" },
      this.l2.node,
      h("label", { class: "check" }, this.free, "width free, as in a pull test"),
      this.wire.node,
      this.spacing.node,
      this.parameters.node,
    );
    const tiles = TILES.map((n): [string, string] => [n, `${n} × ${n}`]);
    this.tiles = select("Cells", tiles, "8", (n) => state.set({ tile: [Number(n), Number(n)] }));
    this.overlays = h(
      "div",
      { class: "row" },
      check("forces", (forces) => state.set({ forces })),
      check("binding chain", (chain) => state.set({ chain })),
    );
    this.node = h(
      "div",
      { class: "controls" },
      this.direction.node,
      this.widths,
      this.solved,
      this.looks(),
      this.overlays,
      start.bundle ? null : this.commandRow(),
    );
  }

  private looks(): HTMLElement {
    const { state } = this;
    const colors: [ColorBy, string][] = [
      ["element", "element"],
      ["load", "load"],
      ["slack", "slack"],
    ];
    return h(
      "div",
      { class: "row" },
      this.tiles,
      select("Colour by", colors, "element", (colorBy) => state.set({ colorBy })),
      h("label", { class: "field" }, "Element", this.elements),
    );
  }

  private commandRow(): HTMLElement {
    const copy = () => void navigator.clipboard?.writeText(this.state.a.command);
    return h("div", { class: "row command-row" }, this.command, h("button", { type: "button", onclick: copy }, "Copy"));
  }

  draw(): void {
    const { a, b, mode, start } = this.state;
    // A simulation has no direction and no width, and nothing of it is solved anew.
    const simulated = a.frames !== null && (mode !== "compare" || b.frames !== null);
    this.direction.node.hidden = this.overlays.hidden = this.tiles.hidden = simulated;
    this.solved.hidden = start.bundle || a.frames !== null;
    this.direction.set(a.choice?.direction ?? 0, a.choice ? `${short(a.choice.direction)}°` : "–");
    this.l2.set(a.l2, a.free ? "free" : short(a.l2, 3));
    this.free.checked = a.free;
    this.wire.setWire(a, unitOf(a));
    this.spacing.set(a.spacing ?? 1, `× ${short(a.spacing ?? 1, 3)}`);
    this.parameters.draw();
    this.drawWidths();
    this.drawElements();
    this.command.textContent = a.command;
  }

  private drawWidths(): void {
    const { state } = this;
    const { a } = state;
    const l2s = widths(a.limits);
    const chip = (l2: number) => {
      const onclick = () => state.choose(a.choice?.direction ?? 0, l2);
      return h("button", { type: "button", onclick }, `l₂ ${short(l2)}`);
    };
    this.widths.hidden = l2s.length < 2;
    if (this.widths.dataset["key"] !== l2s.join()) {
      this.widths.dataset["key"] = l2s.join();
      this.widths.replaceChildren(...l2s.map(chip));
    }
    const chosen = a.choice?.l2 ?? a.l2;
    [...this.widths.children].forEach((node, k) => node.setAttribute("aria-pressed", String(l2s[k] === chosen)));
  }

  private drawElements(): void {
    const { a, picked } = this.state;
    const names = a.own?.poses.map((p) => p.element) ?? [];
    if (this.elements.dataset["key"] !== names.join()) {
      this.elements.dataset["key"] = names.join();
      const options = names.map((name, k) => h("option", { value: k }, name));
      this.elements.replaceChildren(h("option", { value: "" }, "all"), ...options);
    }
    this.elements.value = picked === null || picked >= names.length ? "" : String(picked);
  }
}
