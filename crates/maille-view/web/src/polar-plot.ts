// A polar plot of the limits: l1 against the direction of the pull.

import { h, s, short } from "./dom";
import { halfTurn, reached, sameDirection, widthColor, widths, type Choice } from "./limits";
import type { Limit } from "./types";

/** Limits that are drawn alike: one curve for each l2. */
export interface Family {
  colors: string[];
  limits: Limit[];
  /** Of inputs that are no longer asked for. */
  old: boolean;
}

const SIZE = 420;
const MIDDLE = SIZE / 2;
const RIM = MIDDLE - 34;
const OLD = "#c9c4ba";
/** Distances between the rings of the grid. */
const STEPS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.25, 0.5, 1, 2, 5, 10];

/** Degrees that a key turns the direction by. */
const KEYS: Record<string, number> = { ArrowLeft: 5, ArrowUp: 5, ArrowRight: -5, ArrowDown: -5 };

export class PolarPlot {
  readonly node: SVGSVGElement;
  readonly tip: HTMLElement;
  private families: Family[] = [];
  private scale = 1;

  constructor(onChoose: (direction: number, l2: number | null) => void, onStep: (degrees: number) => void) {
    this.tip = h("p", { class: "tip", "aria-live": "polite" });
    this.node = s("svg", {
      viewBox: `0 0 ${SIZE} ${SIZE}`,
      class: "map",
      tabindex: 0,
      role: "img",
      "aria-label": "Limit map: the largest stretch each way. Arrow keys choose one.",
      onclick: (e) => {
        const at = this.at(e as MouseEvent);
        const near = this.nearest(at);
        if (near && near.far < 14) onChoose(near.limit.row.direction_deg, near.limit.row.l2);
        else onChoose(Math.round(at.direction / 5) * 5, null);
      },
      onmousemove: (e) => this.hover(e as MouseEvent),
      onmouseleave: () => this.say(null),
      onkeydown: (e) => {
        const step = KEYS[(e as KeyboardEvent).key];
        if (!step) return;
        e.preventDefault();
        onStep(step);
      },
    });
  }

  private at(event: MouseEvent): { x: number; y: number; direction: number } {
    const box = this.node.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * SIZE - MIDDLE;
    const y = MIDDLE - ((event.clientY - box.top) / box.height) * SIZE;
    return { x, y, direction: ((Math.atan2(y, x) * 180) / Math.PI + 360) % 360 };
  }

  private point(direction: number, value: number): [number, number] {
    const angle = (direction * Math.PI) / 180;
    const r = Math.max(0, value) * this.scale;
    return [MIDDLE + r * Math.cos(angle), MIDDLE - r * Math.sin(angle)];
  }

  private nearest(at: { x: number; y: number }): { limit: Limit; far: number } | null {
    let best: { limit: Limit; far: number } | null = null;
    for (const family of this.families.filter((f) => !f.old)) {
      for (const limit of family.limits) {
        const value = reached(limit);
        if (value === null) continue;
        for (const half of [0, 180]) {
          const [x, y] = this.point(limit.row.direction_deg + half, value);
          const far = Math.hypot(x - MIDDLE - at.x, MIDDLE - y - at.y);
          if (!best || far < best.far) best = { limit, far };
        }
      }
    }
    return best;
  }

  private hover(event: MouseEvent): void {
    const near = this.nearest(this.at(event));
    this.say(near && near.far < 40 ? near.limit : null);
  }

  private say(limit: Limit | null): void {
    if (!limit) {
      this.tip.textContent = "Hover for limits; click one to see it lock.";
      return;
    }
    const { direction_deg, l2, l1, status, lateral, bound_l1 } = limit.row;
    const width = lateral === "free" ? "width free" : `l₂ = ${short(l2)}`;
    const value = l1 === null ? "no limit" : `l₁ = ${short(l1)}`;
    const bound = bound_l1 === null ? "" : `, bound ${short(bound_l1)}`;
    this.tip.textContent = `${short(direction_deg)}°, ${width}: ${value}${bound} (${status})`;
  }

  draw(families: Family[], choice: Choice | null): void {
    this.families = families;
    const values = families.flatMap((f) => f.limits.flatMap((l) => reached(l) ?? []));
    const most = Math.max(0.05, ...values);
    const step = STEPS.find((x) => most / x <= 4.2) ?? most / 4;
    const count = Math.ceil(most / step - 1e-9);
    const rim = count * step;
    this.scale = RIM / rim;
    const rings = Array.from({ length: count }, (_, k) => (k + 1) * step);
    this.node.replaceChildren(
      ...this.grid(rings, rim),
      ...families.flatMap((family) => this.curves(family)),
      ...rings.map((value) => this.label(value)),
      ...(choice ? this.chosen(families, choice, rim) : []),
    );
    if (!this.tip.textContent) this.say(null);
  }

  private grid(rings: number[], rim: number): Node[] {
    const circles = rings.map((x) => s("circle", { cx: MIDDLE, cy: MIDDLE, r: x * this.scale, class: "grid" }));
    const angles = Array.from({ length: 12 }, (_, k) => 30 * k);
    const words = angles.map((degrees) => {
      const [x, y] = this.point(degrees, rim * 1.09);
      return s("text", { x, y: y + 4, class: "degrees" }, `${degrees}°`);
    });
    return [...circles, ...angles.slice(0, 6).map((degrees) => this.line(degrees, rim, "grid")), ...words];
  }

  /** A line through the middle, from rim to rim. */
  private line(degrees: number, rim: number, name: string): Node {
    const [x, y] = this.point(degrees, rim);
    return s("line", { x1: x, y1: y, x2: SIZE - x, y2: SIZE - y, class: name });
  }

  /** The length that a ring of the grid stands for. */
  private label(value: number): Node {
    const [x, y] = this.point(75, value);
    return s("text", { x, y: y - 3, class: "value" }, short(1 + value, 3));
  }

  private curves(family: Family): Node[] {
    const l2s = widths(family.limits);
    return l2s.flatMap((l2, k) => {
      const color = family.old ? OLD : widthColor(family.colors, k, l2s.length);
      const asked = family.limits.filter((l) => l.row.l2 === l2);
      asked.sort((a, b) => halfTurn(a.row.direction_deg) - halfTurn(b.row.direction_deg));
      const limits = asked.filter((l) => reached(l) !== null);
      const filled = limits.length === asked.length && l2s.length === 1 && !family.old;
      const curve = limits.length > 2 ? [this.curve(asked, color, family.old, filled)] : [];
      return family.old ? curve : [...curve, ...limits.flatMap((limit) => this.dots(limit, color))];
    });
  }

  /** Through the limits and their opposites: closed, or broken where a direction that was asked has no limit. */
  private curve(asked: Limit[], color: string, old: boolean, filled: boolean): Node {
    const around = [0, 180].flatMap((half) => asked.map((l) => (reached(l) === null ? null : this.place(l, half))));
    const gap = Math.max(0, around.indexOf(null));
    let pen = "M";
    const parts = [...around.slice(gap), ...around.slice(0, gap)].map((point) => {
      const part = point && `${pen}${point[0].toFixed(2)} ${point[1].toFixed(2)}`;
      pen = point ? "L" : "M";
      return part ?? "";
    });
    const d = parts.join("") + (around.includes(null) ? "" : "Z");
    return s("path", { d, class: old ? "curve old" : "curve", stroke: color, fill: filled ? color : "none" });
  }

  private dots(limit: Limit, color: string): Node[] {
    const sure = limit.row.status === "global" || limit.row.status === "local";
    return [0, 180].map((half) => {
      const [cx, cy] = this.place(limit, half);
      return s("circle", { cx, cy, r: 2.6, class: "limit", stroke: color, fill: sure ? color : "#fff" });
    });
  }

  private chosen(families: Family[], { direction, l2 }: Choice, rim: number): Node[] {
    const parts = [this.line(direction, rim, "ray")];
    for (const family of families.filter((f) => !f.old)) {
      const limit = family.limits.find((l) => sameDirection(l.row.direction_deg, direction) && l.row.l2 === l2);
      const value = limit && reached(limit);
      if (value == null) continue;
      for (const half of [0, 180]) {
        const [cx, cy] = this.point(direction + half, value);
        parts.push(s("circle", { cx, cy, r: 6, class: "chosen" }));
      }
    }
    return parts;
  }

  /** Where a limit is drawn that has a value. */
  private place(limit: Limit, half: number): [number, number] {
    return this.point(halfTurn(limit.row.direction_deg) + half, reached(limit)!);
  }
}
