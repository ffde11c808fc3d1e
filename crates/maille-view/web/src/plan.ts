// The plan of a design: rings seen from above, and what a drag makes of them.

import { Quaternion, Vector3 } from "three";
import { toml, tomlVector } from "./design-text";
import type { Change, Design, ElementSpec } from "./types";

export type Point = [number, number];

/** Degrees: how far a ring is tilted out of the plane, and the direction that its normal leans to. */
export interface Attitude {
  tilt: number;
  turn: number;
}

/** Which part of the plane is shown: pixels per unit of length, and the middle. */
export interface View {
  scale: number;
  middle: Point;
  size: Point;
}

const RAD = Math.PI / 180;
const Y = new Vector3(0, 1, 0);
const Z = new Vector3(0, 0, 1);
/** The handle of the tilt comes this near to the centre, in radii, where the ring stands: there the ring is moved. */
const NEAREST = 0.4;
/** Digits of normals. */
const FINE = 1e-6;

export function toScreen({ scale, middle, size }: View, [x, y]: readonly number[]): Point {
  return [size[0] / 2 + (x! - middle[0]) * scale, size[1] / 2 - (y! - middle[1]) * scale];
}

export function toPlane({ scale, middle, size }: View, [x, y]: Point): Point {
  return [middle[0] + (x - size[0] / 2) / scale, middle[1] - (y - size[1] / 2) / scale];
}

/** What lengths are rounded to, so that the file can be read: about a thousandth of R. */
export function lengthStep(design: Design): number {
  return 10 ** Math.floor(Math.log10(design.reference_radius / 500));
}

export function rounded(x: number, step: number): number {
  // Divided by a whole number where there is one: 0.3, not 0.30000000000000004.
  const whole = step < 1 ? Math.round(x * Math.round(1 / step)) / Math.round(1 / step) : Math.round(x / step) * step;
  return whole + 0;
}

/** The attitude of a normal; `turn` is that of one that stands upright, which leans to no side. */
export function attitude(normal: readonly number[], turn: number): Attitude {
  const n = new Vector3(...(normal as [number, number, number])).normalize();
  const across = Math.hypot(n.x, n.y);
  return { tilt: Math.atan2(across, n.z) / RAD, turn: across < FINE ? turn : Math.atan2(n.y, n.x) / RAD };
}

function rotation({ tilt, turn }: Attitude): Quaternion {
  const lean = new Quaternion().setFromAxisAngle(Y, tilt * RAD);
  return new Quaternion().setFromAxisAngle(Z, turn * RAD).multiply(lean);
}

/** Points on the core circle of ring `k` of an element, which begin where the ring is lowest. */
export function circle({ center, rings }: ElementSpec, k: number, count: number): Vector3[] {
  const { normal, offset, major_radius } = rings[k]!;
  const turn = rotation(attitude(normal, 0));
  return Array.from({ length: count }, (_, i) => {
    const angle = (2 * Math.PI * i) / count;
    const arm = new Vector3(Math.cos(angle), Math.sin(angle), 0).multiplyScalar(major_radius).applyQuaternion(turn);
    return arm.add(new Vector3(...center)).add(new Vector3(...offset));
  });
}

/** Moves the element to a place. */
export function moved(index: number, center: readonly number[]): Change[] {
  return [{ field: `elements[${index}].center`, value: tomlVector(center) }];
}

/** Turns the element with all its rings, so that the first has another attitude. */
export function turned(design: Design, index: number, from: Attitude, to: Attitude): Change[] {
  const by = rotation(to).multiply(rotation(from).invert());
  const of = (v: readonly number[], step: number) =>
    new Vector3(...(v as [number, number, number]))
      .applyQuaternion(by)
      .toArray()
      .map((x) => rounded(x, step));
  return design.elements[index]!.rings.flatMap(({ normal, offset }, k) => {
    const ring = `elements[${index}].rings[${k}]`;
    const changes = [{ field: `${ring}.normal`, value: tomlVector(of(normal, FINE)) }];
    if (!offset.some(Boolean)) return changes;
    return [...changes, { field: `${ring}.offset`, value: tomlVector(of(offset, FINE * lengthStep(design))) }];
  });
}

/** Gives the first ring of the element another radius; the element keeps its proportions. */
export function resized(design: Design, index: number, radius: number): Change[] {
  const { rings } = design.elements[index]!;
  const step = lengthStep(design);
  const factor = radius / rings[0]!.major_radius;
  return rings.flatMap(({ major_radius, offset }, k) => {
    const ring = `elements[${index}].rings[${k}]`;
    const changes = [{ field: `${ring}.major_radius`, value: toml(rounded(major_radius * factor, step)) }];
    if (!offset.some(Boolean)) return changes;
    const apart = offset.map((x) => rounded(x * factor, step));
    return [...changes, { field: `${ring}.offset`, value: tomlVector(apart) }];
  });
}

/** The first ring of an element, as its handles stand on it. */
export function handles(element: ElementSpec, turn: number): Record<"turn" | "tilt" | "radius", Point> {
  const { normal, major_radius: R } = element.rings[0]!;
  const at = attitude(normal, turn);
  const [c, s] = [Math.cos(at.turn * RAD), Math.sin(at.turn * RAD)];
  const from = (along: number, across: number): Point => [
    element.center[0] + along * c - across * s,
    element.center[1] + along * s + across * c,
  ];
  const lean = -R * (NEAREST + (1 - NEAREST) * Math.cos(at.tilt * RAD));
  return { turn: from(1.5 * R, 0), tilt: from(lean, 0), radius: from(0, R) };
}

/** The direction, in whole degrees, of an arm. */
export function directionOf([x, y]: Point): number {
  return rounded(Math.atan2(y, x) / RAD, 1);
}

/** The tilt, in whole degrees, that puts the handle at the end of an arm, in the ring's radii. */
export function tiltOf(turn: number, [x, y]: Point): number {
  const along = -(x * Math.cos(turn * RAD) + y * Math.sin(turn * RAD));
  const cosine = (along - NEAREST) / (1 - NEAREST);
  return rounded(Math.acos(Math.max(-1, Math.min(1, cosine))) / RAD, 1);
}
