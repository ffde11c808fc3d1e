// What is drawn through the rings: forces, the binding chain, links that changed.

import {
  BufferGeometry,
  ConeGeometry,
  CylinderGeometry,
  Group,
  InstancedMesh,
  Matrix4,
  MeshBasicMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from "three";
import { mergeGeometries } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import type { Drawing, Posed } from "./drawing";
import { centre, inLarger, type Poses } from "./pose";
import type { ContactRecord, Palette, Sheet } from "./types";

const Y = new Vector3(0, 1, 0);
const MOST_ARROWS = 3000;
const DOT = "#ffb703";
const CHAIN = "#14213d";
export const CHANGED = { broken: "#d81b43", new: "#6a35b0" };

export class Overlays {
  readonly group = new Group();

  constructor(private palette: Palette) {}

  draw(drawing: Drawing, poses: Poses, cells: [number, number]): void {
    this.clear();
    const { sheet, limit, t } = drawing;
    if (drawing.forces && limit && t === 1) this.forces(sheet, limit, poses, cells);
    if (drawing.chain && limit) this.chain(drawing, limit, poses);
    const middle = cells.map((count) => Math.floor((count - 1) / 2)) as [number, number];
    for (const { a, b, shift, kind } of drawing.changed) {
      if (!sheet.rings[a] || !sheet.rings[b]) continue;
      const to = middle.map((x, k) => x + shift[k]!) as [number, number];
      const ends = [centre(sheet, poses, a, middle), centre(sheet, poses, b, to)];
      this.line(ends, 0.05 * sheet.reference_radius, CHANGED[kind]);
    }
  }

  private clear(): void {
    for (const child of [...this.group.children]) {
      this.group.remove(child);
      if (child instanceof InstancedMesh) {
        child.geometry.dispose();
        (child.material as MeshBasicMaterial).dispose();
        child.dispose();
      }
    }
  }

  /** Arrows on both sides of each contact that carries force, in as many cells as can be drawn. */
  private forces(sheet: Sheet, limit: Posed, poses: Poses, [m, n]: [number, number]): void {
    const contacts = limit.state.contacts ?? [];
    if (!contacts.length) return;
    const R = sheet.reference_radius;
    const most = Math.max(...contacts.map((c) => c.force));
    const strong = contacts.filter((c) => c.force > 1e-3 * most);
    const fraction = Math.min(1, MOST_ARROWS / (2 * strong.length * m * n));
    const columns = Math.max(1, Math.floor(m * Math.sqrt(fraction)));
    const rows = Math.max(1, Math.floor(n * Math.sqrt(fraction)));
    const [first, second] = [Math.floor((m - columns) / 2), Math.floor((n - rows) / 2)];
    const arrows: Matrix4[] = [];
    const dots: Matrix4[] = [];
    for (const c of strong) {
      const normal = new Vector3(...c.normal);
      const on = contactPoint(sheet, c);
      const scale = new Vector3(R, (R * 0.95 * c.force) / most, R);
      const turns = [1, -1].map((sign) => new Quaternion().setFromUnitVectors(Y, normal.clone().multiplyScalar(sign)));
      const inside = (k: 0 | 1, at: number, of: number) => at + c.shift[k] >= 0 && at + c.shift[k] < of;
      for (let i = first; i < first + columns; i++) {
        for (let j = second; j < second + rows; j++) {
          if (!inside(0, i, m) || !inside(1, j, n)) continue;
          const at = on.clone().addScaledVector(poses.a1, i).addScaledVector(poses.a2, j);
          arrows.push(...turns.map((turn) => new Matrix4().compose(at, turn, scale)));
          dots.push(new Matrix4().compose(at, new Quaternion(), new Vector3(R, R, R)));
        }
      }
    }
    const shaft = new CylinderGeometry(0.034, 0.034, 0.78, 8).translate(0, 0.39, 0);
    const head = new ConeGeometry(0.1, 0.28, 12).translate(0, 0.87, 0);
    this.many(mergeGeometries([shaft, head]), arrows, this.palette.force, 0.9);
    this.many(new SphereGeometry(0.1, 12, 8), dots, DOT, 0.95);
  }

  /** The binding chain, repeated along the tile. */
  private chain({ own, sheet, tile }: Drawing, limit: Posed, poses: Poses): void {
    const { chain } = limit.state;
    if (!chain) return;
    const points: Vector3[] = [];
    const span = chain.vector.map((x, k) => (x ? Math.floor((tile[k]! - 1) / Math.abs(x)) : Infinity));
    const repeats = Math.max(1, Math.min(6, ...span));
    // Around the middle of the tile.
    const from = chain.vector.map((x, k) => Math.floor((tile[k]! - 1 - repeats * x) / 2));
    for (let k = 0; k < repeats; k++) {
      for (const [ring, cell] of k ? chain.rings.slice(1) : chain.rings) {
        const shift = [0, 1].map((d) => from[d]! + cell[d]! + k * chain.vector[d]!) as [number, number];
        points.push(centre(sheet, poses, ...inLarger(own, sheet, ring, shift)));
      }
    }
    this.line(points, 0.06 * sheet.reference_radius, CHAIN);
  }

  private many(geometry: BufferGeometry, places: Matrix4[], color: string, opacity: number): void {
    const material = new MeshBasicMaterial({ color, transparent: true, opacity, depthTest: false, toneMapped: false });
    const mesh = new InstancedMesh(geometry, material, places.length);
    places.forEach((place, k) => mesh.setMatrixAt(k, place));
    mesh.renderOrder = 2;
    mesh.frustumCulled = false;
    this.group.add(mesh);
  }

  /** Rods between `points`, and a dot on each. */
  private line(points: Vector3[], width: number, color: string): void {
    const rods: Matrix4[] = [];
    for (let k = 0; k + 1 < points.length; k++) {
      const [from, to] = [points[k]!, points[k + 1]!];
      const along = to.clone().sub(from);
      const turn = new Quaternion().setFromUnitVectors(Y, along.clone().normalize());
      const middle = from.clone().add(to).multiplyScalar(0.5);
      rods.push(new Matrix4().compose(middle, turn, new Vector3(width, along.length(), width)));
    }
    this.many(new CylinderGeometry(0.5, 0.5, 1, 8), rods, color, 0.9);
    const scale = new Vector3(width, width, width);
    const dots = points.map((p) => new Matrix4().compose(p, new Quaternion(), scale));
    this.many(new SphereGeometry(0.95, 12, 8), dots, color, 0.9);
  }
}

/** Middle between the surfaces of two rings that touch. */
function contactPoint(sheet: Sheet, c: ContactRecord): Vector3 {
  const normal = new Vector3(...c.normal);
  const [ra, rb] = [sheet.rings[c.ring_a]!.minor_radius, sheet.rings[c.ring_b]!.minor_radius];
  const on = new Vector3(...c.point_a).addScaledVector(normal, ra);
  return on.add(new Vector3(...c.point_b).addScaledVector(normal, -rb)).multiplyScalar(0.5);
}
