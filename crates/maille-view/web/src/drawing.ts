// What the stage is asked to draw.

import type { InstancedMesh } from "three";
import type { Limit, Pair, Sheet } from "./types";

export type ColorBy = "element" | "load" | "slack";

/** A link that the design had and has no more: two rings, the second in a cell. */
export interface LostLink {
  a: number;
  b: number;
  shift: [number, number];
}

export interface Drawing {
  /** The design's own cell. */
  own: Sheet;
  /** The cell of the limit, if there is one. */
  sheet: Sheet;
  limit: Limit | null;
  /** Cells of the design along a1 and a2. */
  tile: [number, number];
  /** Place between the start, 0, and the limit, 1. */
  t: number;
  colorBy: ColorBy;
  /** Element that is picked. */
  picked: number | null;
  forces: boolean;
  chain: boolean;
  lost: LostLink[];
}

/** Rings of one pair of radii: each of `rings` in all cells, then the next. */
export interface Shape {
  mesh: InstancedMesh;
  rings: number[];
}

/** The pairs with their gaps in the state that is drawn, or in the start while it moves. */
export function pairsOf({ sheet, limit, t }: Drawing): Pair[] {
  return limit && t === 1 ? limit.pairs : sheet.pairs;
}
