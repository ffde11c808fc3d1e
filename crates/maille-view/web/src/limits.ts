// Limits: what is chosen among them, and what they say of single elements.

import type { Posed } from "./drawing";
import type { Limit, Pair, Sheet } from "./types";

export interface Choice {
  direction: number;
  l2: number;
}

/** The value that the plot shows: l1, or what was reached without a certificate. */
export function reached(limit: Limit): number | null {
  return limit.row.l1 ?? limit.row.l1_uncertified;
}

/** A direction of pull from 0 to 180 degrees. */
export function halfTurn(degrees: number): number {
  return ((degrees % 180) + 180) % 180;
}

/** Whether two directions pull alike: D and −D do. */
export function sameDirection(a: number, b: number): boolean {
  const apart = halfTurn(a - b);
  return apart < 1e-9 || 180 - apart < 1e-9;
}

/** The widths that limits were found for, ascending. */
export function widths(limits: Limit[]): number[] {
  return [...new Set(limits.map((l) => l.row.l2))].sort((a, b) => a - b);
}

/** One of `colors` for width `k` of `count`, from the first to the last. */
export function widthColor(colors: string[], k: number, count: number): string {
  return colors[Math.round((k / Math.max(1, count - 1)) * (colors.length - 1))]!;
}

/** Loads of the elements: sums of the contact forces on them. */
export function loads(sheet: Sheet, limit: Posed | null): number[] {
  const out = sheet.poses.map(() => 0);
  for (const c of limit?.state.contacts ?? []) {
    for (const ring of [c.ring_a, c.ring_b]) out[sheet.rings[ring]!.element]! += c.force;
  }
  return out;
}

/** Smallest gap of each element. */
export function slack(sheet: Sheet, pairs: Pair[]): number[] {
  const out = sheet.poses.map(() => Infinity);
  for (const pair of pairs) {
    for (const ring of [pair.ring_a, pair.ring_b]) {
      const element = sheet.rings[ring]!.element;
      out[element] = Math.min(out[element]!, pair.gap);
    }
  }
  return out;
}
