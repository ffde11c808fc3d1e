// The limit map: a polar plot of l1 against the direction of the pull.

import { h, s, short } from "./dom";
import type { Limit } from "./types";

/** Limits that are drawn as one family: one curve for each l2. */
export interface Family {
  label: string;
  colors: string[];
  limits: Limit[];
  /** Of inputs that are no longer asked for. */
  old: boolean;
}

export interface Choice {
  direction: number;
  l2: number;
}

const SIZE = 420;
const MIDDLE = SIZE / 2;
const RIM = MIDDLE - 34;

/** The value that the map shows: l1, or what was reached without a certificate. */
export function reached(limit: Limit): number | null {
  return limit.row.l1 ?? limit.row.l1_uncertified;
}

/** Whether two directions pull alike: D and −D do. */
export function same(a: number, b: number): boolean {
  const apart = (((a - b) % 180) + 180) % 180;
  return apart < 1e-9 || 180 - apart < 1e-9;
}

export class LimitMap {
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
        const step = ({ ArrowLeft: 5, ArrowUp: 5, ArrowRight: -5, ArrowDown: -5 } as Record<string, number>)[(e as KeyboardEvent).key];
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
    const step = [0.01, 0.02, 0.05, 0.1, 0.2, 0.25, 0.5, 1, 2, 5, 10].find((x) => most / x <= 4.2) ?? most / 4;
    const rim = Math.ceil(most / step - 1e-9) * step;
    this.scale = RIM / rim;
    const parts: Node[] = [];
    for (let k = 1; k * step <= rim * 1.0001; k++) {
      parts.push(s("circle", { cx: MIDDLE, cy: MIDDLE, r: k * step * this.scale, class: "grid" }));
    }
    for (let d = 0; d < 180; d += 30) {
      const [x, y] = this.point(d, rim);
      parts.push(s("line", { x1: x, y1: y, x2: SIZE - x, y2: SIZE - y, class: "grid" }));
    }
    for (let d = 0; d < 360; d += 30) {
      const [x, y] = this.point(d, rim * 1.09);
      parts.push(s("text", { x, y: y + 4, class: "degrees" }, `${d}°`));
    }
    for (const family of families) {
      const l2s = [...new Set(family.limits.map((l) => l.row.l2))].sort((a, b) => a - b);
      l2s.forEach((l2, k) => {
        const color = family.old ? "#c9c4ba" : family.colors[Math.round((k / Math.max(1, l2s.length - 1)) * (family.colors.length - 1))]!;
        const all = family.limits.filter((l) => l.row.l2 === l2).sort((a, b) => turn(a) - turn(b));
        const line = all.filter((l) => reached(l) !== null);
        const round = [...line.map((l) => this.point(turn(l), reached(l)!)), ...line.map((l) => this.point(turn(l) + 180, reached(l)!))];
        const closed = line.length > 2;
        const d = round.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(2)} ${y.toFixed(2)}`).join("") + (closed ? "Z" : "");
        if (closed) parts.push(s("path", { d, class: family.old ? "curve old" : "curve", stroke: color, fill: l2s.length === 1 && !family.old ? color : "none" }));
        if (family.old) return;
        for (const limit of line) {
          for (const half of [0, 180]) {
            const [x, y] = this.point(turn(limit) + half, reached(limit)!);
            const sure = limit.row.status === "global" || limit.row.status === "local";
            parts.push(s("circle", { cx: x, cy: y, r: 2.6, class: "limit", stroke: color, fill: sure ? color : "#fff" }));
          }
        }
      });
    }
    for (let k = 1; k * step <= rim * 1.0001; k++) {
      const [x, y] = this.point(75, k * step);
      parts.push(s("text", { x, y: y - 3, class: "value" }, short(1 + k * step, 3)));
    }
    if (choice) {
      const [x, y] = this.point(choice.direction, rim);
      parts.push(s("line", { x1: x, y1: y, x2: SIZE - x, y2: SIZE - y, class: "ray" }));
      for (const family of families.filter((f) => !f.old)) {
        const limit = family.limits.find((l) => same(l.row.direction_deg, choice.direction) && l.row.l2 === choice.l2);
        if (!limit || reached(limit) === null) continue;
        for (const half of [0, 180]) {
          const [cx, cy] = this.point(choice.direction + half, reached(limit)!);
          parts.push(s("circle", { cx, cy, r: 6, class: "chosen" }));
        }
      }
    }
    this.node.replaceChildren(...parts);
    if (!this.tip.textContent) this.say(null);
  }
}

const turn = (limit: Limit) => ((limit.row.direction_deg % 180) + 180) % 180;
