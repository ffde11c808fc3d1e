// The plan as a picture: rings that pass over and under each other, links, overlaps.

import { CHANGED } from "./overlays";
import { circle, toScreen, type View } from "./plan";
import type { ChangedLink } from "./links";
import type { Design, Palette, Sheet } from "./types";

/** Straight parts of a ring. */
const PARTS = 64;
/** Cells on each side of the one that is drawn. */
const AROUND = 1;
const OVERLAP = "#d81b43";
const SELECTED = "#23211d";
const PAPER = "#f8f6f1";

/** What the picture is of. */
export interface Plan {
  design: Design;
  /** The start as the program has it, if the design can be used. */
  sheet: Sheet | null;
  changed: ChangedLink[];
  selected: number | null;
  /** Elements that problems are about. */
  wrongElements: Set<number>;
}

interface Part {
  z: number;
  from: [number, number];
  to: [number, number];
  width: number;
  color: string;
}

export function drawPlan(context: CanvasRenderingContext2D, view: View, plan: Plan, palette: Palette): void {
  context.fillStyle = PAPER;
  context.fillRect(0, 0, view.size[0], view.size[1]);
  cell(context, view, plan.design);
  const all = parts(view, plan, palette).sort((a, b) => a.z - b.z);
  for (const { from, to, width, color } of all) {
    // What lies below is cut away on both sides, so that the crossing can be read; not the parts before and behind.
    stroke(context, [from, to], width + 3, PAPER);
    stroke(context, longer(from, to, 0.7 + 0.06 * width), width, color);
  }
  links(context, view, plan);
}

/** The line, longer by so much at both ends. */
function longer(from: [number, number], to: [number, number], by: number): [number, number][] {
  const [x, y] = [to[0] - from[0], to[1] - from[1]];
  const part = by / Math.max(Math.hypot(x, y), 1e-9);
  // Seen from the side, a part can be a point.
  if (part > 1e3) return [from, to];
  return [
    [from[0] - part * x, from[1] - part * y],
    [to[0] + part * x, to[1] + part * y],
  ];
}

/** The colour of a copy in another cell. */
function faded(color: string): string {
  const of = (text: string) => [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16));
  const paper = of(PAPER);
  return `rgb(${of(color).map((x, k) => Math.round(0.3 * x + 0.7 * paper[k]!))})`;
}

function stroke(context: CanvasRenderingContext2D, points: [number, number][], width: number, color: string): void {
  context.beginPath();
  points.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.lineWidth = width;
  context.strokeStyle = color;
  context.stroke();
}

/** The unit cell, from the origin. */
function cell(context: CanvasRenderingContext2D, view: View, { lattice: { a1, a2 } }: Design): void {
  const corners = [[0, 0], a1, [a1[0] + a2[0], a1[1] + a2[1]], a2].map((p) => toScreen(view, p));
  context.setLineDash([5, 5]);
  stroke(context, [...corners, corners[0]!], 1.2, "#8d877b");
  context.setLineDash([]);
}

function parts(view: View, { design, sheet, selected, wrongElements }: Plan, palette: Palette): Part[] {
  const overlaps = new Set<number>();
  const deep = -1e-9 * design.reference_radius;
  for (const { ring_a, ring_b, gap } of sheet?.pairs ?? []) if (gap < deep) overlaps.add(ring_a).add(ring_b);
  const faint = palette.kinds.map(faded);
  const { a1, a2 } = design.lattice;
  const out: Part[] = [];
  let ring = 0;
  design.elements.forEach((element, index) => {
    const kind = (sheet?.kinds[index] ?? index) % palette.kinds.length;
    element.rings.forEach(({ minor_radius }, k) => {
      const wrong = overlaps.has(ring) || wrongElements.has(index);
      const color = wrong ? OVERLAP : selected === index ? SELECTED : palette.kinds[kind]!;
      ring += 1;
      const width = Math.max(2.5, 2 * (minor_radius ?? design.minor_radius ?? 0) * view.scale);
      const points = circle(element, k, PARTS);
      for (let i = -AROUND; i <= AROUND; i++) {
        for (let j = -AROUND; j <= AROUND; j++) {
          const shift = [i * a1[0] + j * a2[0], i * a1[1] + j * a2[1]] as const;
          const at = points.map((p) => toScreen(view, [p.x + shift[0], p.y + shift[1]]));
          const past = (p: [number, number]) => outside(p, view);
          points.forEach((p, n) => {
            const [next, from, to] = [points[(n + 1) % PARTS]!, at[n]!, at[(n + 1) % PARTS]!];
            if (past(from) && past(to)) return;
            out.push({ z: (p.z + next.z) / 2, from, to, width, color: i || j ? faint[kind]! : color });
          });
        }
      }
    });
  });
  return out;
}

function outside([x, y]: [number, number], { size }: View): boolean {
  return x < 0 || y < 0 || x > size[0] || y > size[1];
}

/** Links as lines between the centres of their rings; those that have changed in their colours. */
function links(context: CanvasRenderingContext2D, view: View, { design, sheet, changed }: Plan): void {
  if (!sheet) return;
  const { a1, a2 } = design.lattice;
  const centre = (ring: number, [i, j]: [number, number]) => {
    const { element, offset } = sheet.rings[ring]!;
    const { position } = sheet.poses[element]!;
    const at = [0, 1].map((k) => position[k]! + offset[k]! + i * a1[k]! + j * a2[k]!);
    return toScreen(view, at);
  };
  const line = (a: number, b: number, shift: [number, number], width: number, color: string) => {
    const ends: [number, number][] = [centre(a, [0, 0]), centre(b, shift)];
    stroke(context, ends, width, color);
    context.fillStyle = color;
    for (const [x, y] of ends) {
      context.beginPath();
      context.arc(x, y, width + 1.2, 0, 2 * Math.PI);
      context.fill();
    }
  };
  for (const { ring_a, ring_b, shift, number } of sheet.pairs) if (number) line(ring_a, ring_b, shift, 1.3, "#23211d99");
  for (const { a, b, shift, kind } of changed) line(a, b, shift, 3, CHANGED[kind]);
}
