// What the stage is asked to draw.

import type { InstancedMesh } from "three";
import type { ChangedLink } from "./links";
import type { Pair, Sheet, StateRecord } from "./types";

export type ColorBy = "element" | "load" | "slack";

/** A state of a sheet: of a limit, or of a simulation. */
export interface Posed {
  state: Pick<StateRecord, "a1" | "a2" | "poses" | "contacts" | "chain">;
  /** Pairs of rings that are linked or near each other in it, if they are known. */
  pairs: Pair[] | null;
}

export interface Drawing {
  /** The design's own cell. */
  own: Sheet;
  /** The cell of the state, if there is one. */
  sheet: Sheet;
  limit: Posed | null;
  /** Cells of the design along a1 and a2. */
  tile: [number, number];
  /** Place between the start, 0, and the state, 1. */
  t: number;
  /** Of a finite sheet: how far its elements come from its middle. */
  reach: number | null;
  colorBy: ColorBy;
  /** Element that is picked. */
  picked: number | null;
  forces: boolean;
  chain: boolean;
  changed: ChangedLink[];
}

/** Rings of one pair of radii: each of `rings` in all cells, then the next. */
export interface Shape {
  mesh: InstancedMesh;
  rings: number[];
}

/** The pairs with their gaps in the state that is drawn, or in the start while it moves. */
export function pairsOf({ sheet, limit, t }: Pick<Drawing, "sheet" | "limit" | "t">): Pair[] {
  return limit && t === 1 ? (limit.pairs ?? []) : sheet.pairs;
}
