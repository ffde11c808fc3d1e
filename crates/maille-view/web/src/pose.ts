// Poses of a cell between its start and a state, and where a ring is in them.

import { Quaternion, Vector3 } from "three";
import type { Posed } from "./drawing";
import type { PoseRecord, Sheet } from "./types";

/** Poses of a cell's elements and its lattice, in the file's unit. */
export interface Poses {
  position: Vector3[];
  rotation: Quaternion[];
  a1: Vector3;
  a2: Vector3;
}

function of(poses: PoseRecord[], a1: number[], a2: number[]): Poses {
  return {
    position: poses.map((p) => new Vector3(...p.position)),
    rotation: poses.map(({ rotation: [w, x, y, z] }) => new Quaternion(x, y, z, w)),
    a1: new Vector3(...a1),
    a2: new Vector3(...a2),
  };
}

/** A part `t` of the way from the start to the state `limit`: straight lines, rotations at a constant rate. */
export function posesAt(sheet: Sheet, limit: Posed | null, t: number): Poses {
  const start = of(sheet.poses, sheet.a1, sheet.a2);
  if (!limit || t === 0) return start;
  const end = of(limit.state.poses, limit.state.a1, limit.state.a2);
  if (t === 1) return end;
  return {
    position: start.position.map((p, k) => p.lerp(end.position[k]!, t)),
    rotation: start.rotation.map((q, k) => q.slerp(end.rotation[k]!, t)),
    a1: start.a1.lerp(end.a1, t),
    a2: start.a2.lerp(end.a2, t),
  };
}

/** Centre of a ring in the cell `shift`. */
export function centre(sheet: Sheet, poses: Poses, ring: number, [i, j]: [number, number]): Vector3 {
  const { element, offset } = sheet.rings[ring]!;
  return new Vector3(...offset)
    .applyQuaternion(poses.rotation[element]!)
    .add(poses.position[element]!)
    .addScaledVector(poses.a1, i)
    .addScaledVector(poses.a2, j);
}

/** Copies of the design's cell along a1 and a2 in a cell such as `2x1`. */
export function copies(cell: string): [number, number] {
  const [, m, n] = /^(\d+)x(\d+)$/.exec(cell) ?? [];
  return [Number(m ?? 1), Number(n ?? 1)];
}

/** The ring of a larger cell that is `ring` of the design's cell in the cell `shift`, with the larger cell's shift. */
export function inLarger(
  small: Sheet,
  large: Sheet,
  ring: number,
  shift: [number, number],
): [number, [number, number]] {
  if (large.cell === small.cell) return [ring, shift];
  const size = copies(large.cell);
  const up = shift.map((x, k) => Math.floor(x / size[k]!)) as [number, number];
  const rest = shift.map((x, k) => x - up[k]! * size[k]!);
  const element = small.rings[ring]!.element;
  const name = `${small.poses[element]!.element}@${rest[0]},${rest[1]}`;
  const found = large.poses.findIndex((p) => p.element === name);
  return [found < 0 ? ring : large.first_ring[found]! + ring - small.first_ring[element]!, up];
}
