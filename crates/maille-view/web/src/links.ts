// Links that an edit has changed: those of the design as it was opened, and those that it has now.

import type { Pair, Sheet } from "./types";

/** A link that was lost, or is new: two rings of the sheet that is shown, the second in a cell. */
export interface ChangedLink {
  kind: "broken" | "new";
  a: number;
  b: number;
  shift: [number, number];
  /** Its two rings by name, and the cell of the second. */
  words: string;
}

function ringName(sheet: Sheet, ring: number): string {
  const { element } = sheet.rings[ring]!;
  return `${sheet.poses[element]!.element}/${ring - sheet.first_ring[element]!}`;
}

/** Of the two ways to write a pair, one. */
function keyOf(sheet: Sheet, { ring_a, ring_b, shift: [i, j] }: Pair): string {
  const [from, to] = [ringName(sheet, ring_a), ringName(sheet, ring_b)];
  return from < to || (from === to && (i > 0 || (i === 0 && j > 0)))
    ? `${from} ${to} ${i},${j}`
    : `${to} ${from} ${-i || 0},${-j || 0}`;
}

/** Links of `base` that `own` has no more, then those that only `own` has. Rings that are gone have none. */
export function changedLinks(base: Sheet | null, own: Sheet | null): ChangedLink[] {
  if (!base || !own || base === own) return [];
  const linked = (sheet: Sheet) => sheet.pairs.filter((pair) => pair.number);
  const names = new Map(own.rings.map((_, ring) => [ringName(own, ring), ring]));
  const change = (kind: ChangedLink["kind"], of: Sheet, pair: Pair): ChangedLink[] => {
    const [from, to] = [ringName(of, pair.ring_a), ringName(of, pair.ring_b)];
    const [a, b] = [names.get(from), names.get(to)];
    if (a === undefined || b === undefined) return [];
    const cell = pair.shift.some(Boolean) ? ` in cell (${pair.shift.join(", ")})` : "";
    return [{ kind, a, b, shift: pair.shift, words: `${from.replace("/0", "")} – ${to.replace("/0", "")}${cell}` }];
  };
  const [before, now] = [base, own].map((sheet) => new Set(linked(sheet).map((pair) => keyOf(sheet, pair))));
  return [
    ...linked(base).flatMap((pair) => (now!.has(keyOf(base, pair)) ? [] : change("broken", base, pair))),
    ...linked(own).flatMap((pair) => (before!.has(keyOf(own, pair)) ? [] : change("new", own, pair))),
  ];
}
