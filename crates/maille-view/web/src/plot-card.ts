// The polar plot of the limits with its legend, and how far the solving is.

import { h, short } from "./dom";
import { widthColor, widths } from "./limits";
import { ForcePlot, type Course } from "./force-plot";
import { PolarPlot, type Family } from "./polar-plot";
import type { Side } from "./side";
import type { ViewState } from "./state";

const COLORS = { a: ["#1b4f8f", "#2f77b4", "#6aa9d8"], b: ["#b3541e", "#d4602a", "#eaa06a"] };

/** Limits of a sheet, and those from before a change until there are new ones. */
function families(side: Side, colors: string[]): Family[] {
  const out: Family[] = [];
  if (side.old.length && (side.running || side.problems.length || !side.limits.length)) {
    out.push({ colors, limits: side.old, old: true });
  }
  out.push({ colors, limits: side.limits, old: false });
  return out;
}

function key(color: string, words: string): HTMLElement {
  return h("span", { class: "key" }, h("i", { style: `background:${color}` }), words);
}

/** Only the limits of one width, where there are several. */
function atWidth(side: Side, all: Family[]): Family[] {
  const l2 = side.choice?.l2 ?? side.l2;
  const several = widths(side.limits).length > 1;
  return several ? all.map((f) => ({ ...f, limits: f.limits.filter((l) => l.row.l2 === l2) })) : all;
}

function named(side: Side, color: string, name: string | undefined): HTMLElement {
  const radius = side.own && short(Math.min(...side.own.rings.map((r) => r.minor_radius)), 4);
  return key(color, `${name}, r = ${radius}`);
}

export class PlotCard {
  readonly node: HTMLElement;
  private plot: PolarPlot;
  private forces: ForcePlot;
  private legend = h("div", { class: "map-legend" });
  private progress = h("div", { class: "progress" });

  constructor(private state: ViewState) {
    this.plot = new PolarPlot(
      (direction, l2) => state.choose(direction, l2),
      (degrees) => state.step(degrees),
    );
    this.forces = new ForcePlot((course, frame) => this.show(course, frame));
    const plots = [this.plot.node, this.forces.node, this.legend, this.plot.tip, this.forces.tip];
    this.node = h("div", { class: "map-box" }, ...plots, this.progress);
  }

  /** Shows frame `index` of the simulation that is drawn as `course`; another one stands at the same share then. */
  private show(course: number, index: number): void {
    const { state } = this;
    const side = this.simulated[course]!;
    const { frames } = side;
    if (!frames) return;
    const other = side === state.b && state.a.frames;
    state.scrub(other ? other.nearest(frames.simulation.frames[index]!.share) : frames.place(index));
  }

  private get sides(): Side[] {
    const { a, b, mode } = this.state;
    return mode === "compare" ? [a, b] : [a];
  }

  private get simulated(): Side[] {
    // Rolls follow no course.
    return this.sides.filter((side) => side.frames?.simulation.frames[0]?.roll === null);
  }

  draw(): void {
    const { a, b, mode } = this.state;
    const two = mode === "compare";
    const mapped = this.sides.filter((side) => !side.frames);
    const curves = (side: Side) => {
      const all = families(side, COLORS[side === a ? "a" : "b"]);
      return two ? atWidth(side, all) : all;
    };
    this.plot.node.toggleAttribute("hidden", !mapped.length);
    this.plot.tip.hidden = !mapped.length;
    if (mapped.length) this.plot.draw(mapped.flatMap(curves), mapped[0]!.choice);
    this.forces.draw(this.simulated.map((side) => this.course(side)));
    this.legend.replaceChildren(...this.keys());
    this.progress.replaceChildren(...this.done(a.running || !two ? a : b));
  }

  private course(side: Side): Course {
    const frames = side.frames!;
    const { a } = this.state;
    const shown = frames.index(this.state.placeOf(side));
    return { color: COLORS[side === a ? "a" : "b"][0]!, frames: frames.simulation.frames, shown };
  }

  private keys(): HTMLElement[] {
    const { a, b, mode } = this.state;
    if (a.frames && mode !== "compare") return [];
    if (mode === "compare") {
      return [named(a, COLORS.a[0]!, a.own?.name), named(b, COLORS.b[0]!, b.own?.name ?? "…")];
    }
    const l2s = widths(a.limits);
    if (l2s.length > 1) return l2s.map((l2, k) => key(widthColor(COLORS.a, k, l2s.length), `l₂ = ${short(l2)}`));
    return [h("span", { class: "key" }, "stretch 1 + l₁ along each direction of pull")];
  }

  private done(side: Side): HTMLElement[] {
    const found = side.limits.length;
    if (side.frames) {
      const { frames, total } = side.frames.simulation;
      const some = frames.length < total ? `${frames.length} of ` : "";
      return [h("span", {}, `${some}${total} states of ${side.source}`)];
    }
    if (side.running) {
      return [
        h("progress", { max: side.total, value: Math.min(found, side.total), "aria-label": "Limits found" }),
        h("span", {}, `${found} of ${side.total} limits`),
        h("button", { type: "button", onclick: () => this.state.cancel(side) }, "Cancel"),
      ];
    }
    if (side.source !== null) return [h("span", {}, `${found} limits of ${side.source}`)];
    if (found) return [h("span", {}, `${found} limits`)];
    return [h("span", {}, side.problems.length ? "not solved" : "…")];
  }
}
