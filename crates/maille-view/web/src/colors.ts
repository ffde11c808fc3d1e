// Colours of the rings.

import { Color } from "three";
import { pairsOf, type Drawing, type Shape } from "./drawing";
import { loads, slack } from "./limits";
import type { Palette } from "./types";

const WRONG = new Color("#d81b43");
const DIM = new Color("#e3e0da");

/** Colours the rings of `cells` copies of the sheet. */
export function paint(shapes: Shape[], drawing: Drawing, [m, n]: [number, number], palette: Palette): void {
  const { sheet } = drawing;
  const colors = elementColors(drawing, palette);
  const wrong = overlapping(drawing);
  const lit = litElements(drawing, [m, n]);
  for (const { mesh, rings } of shapes) {
    let k = 0;
    for (const ring of rings) {
      const element = sheet.rings[ring]!.element;
      const color = wrong.has(ring) ? WRONG : colors[element]!;
      for (let i = 0; i < m; i++) {
        for (let j = 0; j < n; j++) {
          mesh.setColorAt(k++, lit.size && !lit.has(`${element},${i},${j}`) ? DIM : color);
        }
      }
    }
    if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
  }
}

function elementColors(drawing: Drawing, palette: Palette): Color[] {
  const { sheet, limit, colorBy } = drawing;
  if (colorBy === "element") return sheet.kinds.map((k) => new Color(palette.kinds[k % palette.kinds.length]));
  const ramp = palette.loads.map((c) => new Color(c));
  const along = (x: number) => {
    const at = Math.max(0, Math.min(1, x)) * (ramp.length - 1);
    const k = Math.min(Math.floor(at), ramp.length - 2);
    return ramp[k]!.clone().lerp(ramp[k + 1]!, at - k);
  };
  if (colorBy === "load") {
    const of = loads(sheet, limit);
    const most = Math.max(...of, 1e-12);
    return of.map((load) => (load > 1e-3 * most ? along(load / most) : new Color(palette.unloaded)));
  }
  const of = slack(sheet, pairsOf(drawing));
  const most = Math.max(...of.filter(Number.isFinite), 1e-12);
  return of.map((gap) => (Number.isFinite(gap) ? along(1 - gap / most) : new Color(palette.unloaded)));
}

/** Rings that overlap at the start. */
function overlapping({ sheet, t }: Drawing): Set<number> {
  const out = new Set<number>();
  if (t !== 0) return out;
  for (const pair of sheet.pairs) {
    if (pair.gap < -1e-9 * sheet.reference_radius) out.add(pair.ring_a).add(pair.ring_b);
  }
  return out;
}

/** The picked element in the middle cell and those linked to it, each as `element,i,j`; empty if none is picked. */
function litElements(drawing: Drawing, cells: [number, number]): Set<string> {
  const { sheet, picked } = drawing;
  const lit = new Set<string>();
  if (picked === null) return lit;
  const [i, j] = cells.map((count) => Math.floor((count - 1) / 2)) as [number, number];
  lit.add(`${picked},${i},${j}`);
  for (const { ring_a, ring_b, shift, number } of pairsOf(drawing)) {
    const [a, b] = [sheet.rings[ring_a]!.element, sheet.rings[ring_b]!.element];
    if (!number) continue;
    if (a === picked) lit.add(`${b},${i + shift[0]},${j + shift[1]}`);
    if (b === picked) lit.add(`${a},${i - shift[0]},${j - shift[1]}`);
  }
  return lit;
}
