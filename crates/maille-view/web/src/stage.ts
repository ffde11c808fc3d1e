// The sheet in 3D: instanced tori, forces, the binding chain, picking.

import {
  AmbientLight,
  BufferGeometry,
  Color,
  ConeGeometry,
  CylinderGeometry,
  DirectionalLight,
  DynamicDrawUsage,
  Group,
  HemisphereLight,
  InstancedMesh,
  Matrix4,
  MeshBasicMaterial,
  MeshPhongMaterial,
  PerspectiveCamera,
  Quaternion,
  Raycaster,
  Scene,
  SphereGeometry,
  TorusGeometry,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { mergeGeometries } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import { centre, copies, inLarger, posesAt, type Poses } from "./pose";
import type { Limit, Pair, Palette, Sheet } from "./types";

export type ColorBy = "element" | "load" | "slack";

/** A link that the design had and has no more: two rings, the second in a cell. */
export interface LostLink {
  a: number;
  b: number;
  shift: [number, number];
}

/** What is shown. */
export interface Shown {
  /** The design's own cell. */
  own: Sheet;
  /** The cell of the limit, if there is one. */
  sheet: Sheet;
  limit: Limit | null;
  tile: [number, number];
  t: number;
  colorBy: ColorBy;
  picked: number | null;
  forces: boolean;
  chain: boolean;
  lost: LostLink[];
}

interface Shape {
  mesh: InstancedMesh;
  rings: number[];
}

const Z = new Vector3(0, 0, 1);
const Y = new Vector3(0, 1, 0);
const WRONG = new Color("#d81b43");
const DIM = new Color("#e3e0da");
const MOST_ARROWS = 3000;

/** Loads of the elements: sums of the contact forces on them. */
export function loads(sheet: Sheet, limit: Limit | null): number[] {
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

export class Stage {
  readonly canvas: HTMLCanvasElement;
  /** Called when the user has turned the view. */
  onTurn: () => void = () => {};
  private renderer: WebGLRenderer;
  private scene = new Scene();
  private camera = new PerspectiveCamera(30, 1, 0.1, 5000);
  private controls: OrbitControls;
  private world = new Group();
  private shapes: Shape[] = [];
  private extras = new Group();
  private key = "";
  private fitted = "";
  private shown: Shown | null = null;
  private waiting = false;
  private turning = false;
  private cells: [number, number] = [1, 1];
  private raycaster = new Raycaster();

  constructor(
    box: HTMLElement,
    private palette: Palette,
    label: string,
    onPick: (element: number | null) => void,
  ) {
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: false });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.canvas = this.renderer.domElement;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", label);
    box.append(this.canvas);
    const key = new DirectionalLight("#fff7ea", 2.1);
    key.position.set(-4, -6, 9);
    const fill = new DirectionalLight("#dfe9ff", 0.7);
    fill.position.set(6, 3, 4);
    this.scene.add(new HemisphereLight("#ffffff", "#b9b2a6", 1.25), new AmbientLight("#ffffff", 0.25), key, fill, this.world);
    this.world.add(this.extras);
    this.camera.up.copy(Z);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener("change", () => {
      this.draw();
      if (this.turning) this.onTurn();
    });
    this.controls.addEventListener("start", () => (this.turning = true));
    this.controls.addEventListener("end", () => (this.turning = false));
    this.canvas.addEventListener("keydown", (event) => this.key_(event));
    let down = new Vector2();
    this.canvas.addEventListener("pointerdown", (e) => (down = new Vector2(e.clientX, e.clientY)));
    this.canvas.addEventListener("pointerup", (e) => {
      if (down.distanceTo(new Vector2(e.clientX, e.clientY)) < 4) onPick(this.pick(e));
    });
    new ResizeObserver(() => this.resize(box)).observe(box);
    this.resize(box);
  }

  private resize(box: HTMLElement): void {
    const { clientWidth: width, clientHeight: height } = box;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.shown) this.fit(this.shown);
    this.draw();
  }

  /** Arrows turn the view, plus and minus go nearer and away. */
  private key_(event: KeyboardEvent): void {
    const turn: Record<string, [number, number]> = {
      ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1],
    };
    const zoom: Record<string, number> = { "+": 0.9, "=": 0.9, "-": 1.11 };
    const [around, over] = turn[event.key] ?? [0, 0];
    const factor = zoom[event.key] ?? 1;
    if (!around && !over && factor === 1) return;
    event.preventDefault();
    const arm = this.camera.position.clone().sub(this.controls.target).multiplyScalar(factor);
    arm.applyAxisAngle(Z, around);
    const side = new Vector3().crossVectors(Z, arm).normalize();
    const angle = arm.angleTo(Z) + over;
    if (angle > 0.02 && angle < Math.PI - 0.02) arm.applyAxisAngle(side, over);
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
    this.draw();
    this.onTurn();
  }

  /** Shows something else; what has not changed is kept. */
  show(shown: Shown): void {
    const { shown: old } = this;
    const names = Object.keys(shown) as (keyof Shown)[];
    const alike = (name: keyof Shown) =>
      shown[name] === old?.[name] || ((name === "tile" || name === "lost") && JSON.stringify(shown[name]) === JSON.stringify(old?.[name]));
    if (old && names.every(alike)) return;
    const size = copies(shown.sheet.cell);
    this.cells = [Math.ceil(shown.tile[0] / size[0]), Math.ceil(shown.tile[1] / size[1])];
    const radii = shown.sheet.rings.map((r) => `${r.major_radius},${r.minor_radius}`);
    const key = `${radii.join(";")}|${this.cells}`;
    if (key !== this.key) this.build(shown, radii);
    this.key = key;
    this.shown = shown;
    this.place(shown);
    this.paint(shown);
    if (shown.limit && shown.limit !== old?.limit) this.makeRoom(shown);
    const fitted = `${shown.own.name}|${shown.tile}|${shown.own.a1.map((x) => x.toFixed(1))}`;
    if (fitted !== this.fitted) this.fit(shown);
    this.fitted = fitted;
    this.draw();
  }

  /** One mesh for each pair of radii; rings have fewer segments where there are many. */
  private build(shown: Shown, radii: string[]): void {
    for (const { mesh } of this.shapes) {
      this.world.remove(mesh);
      mesh.geometry.dispose();
      (mesh.material as MeshPhongMaterial).dispose();
      mesh.dispose();
    }
    const cells = this.cells[0] * this.cells[1];
    const count = shown.sheet.rings.length * cells;
    const [around, across] = count > 2500 ? [20, 5] : count > 800 ? [30, 7] : count > 100 ? [44, 9] : [72, 14];
    this.shapes = [...new Set(radii)].map((pair) => {
      const rings = radii.flatMap((other, ring) => (other === pair ? [ring] : []));
      const { major_radius, minor_radius } = shown.sheet.rings[rings[0]!]!;
      const geometry = new TorusGeometry(major_radius, minor_radius, across, around);
      const material = new MeshPhongMaterial({ shininess: 55, specular: "#4a4a4a" });
      const mesh = new InstancedMesh(geometry, material, rings.length * cells);
      mesh.instanceMatrix.setUsage(DynamicDrawUsage);
      mesh.frustumCulled = false;
      this.world.add(mesh);
      return { mesh, rings };
    });
  }

  private place(shown: Shown): void {
    const { sheet, own } = shown;
    const poses = posesAt(sheet, shown.limit, shown.t);
    const [m, n] = this.cells;
    const matrix = new Matrix4();
    const shift = new Vector3();
    for (const { mesh, rings } of this.shapes) {
      let k = 0;
      for (const ring of rings) {
        const { element, normal } = sheet.rings[ring]!;
        const turned = new Vector3(...normal).applyQuaternion(poses.rotation[element]!).normalize();
        matrix.makeRotationFromQuaternion(new Quaternion().setFromUnitVectors(Z, turned));
        const middle = centre(sheet, poses, ring, [0, 0]);
        for (let i = 0; i < m; i++) {
          for (let j = 0; j < n; j++) {
            shift.copy(middle).addScaledVector(poses.a1, i).addScaledVector(poses.a2, j);
            mesh.setMatrixAt(k++, matrix.setPosition(shift));
          }
        }
      }
      mesh.instanceMatrix.needsUpdate = true;
      mesh.boundingSphere = null;
    }
    const mean = poses.position.reduce((sum, p) => sum.add(p), new Vector3()).divideScalar(poses.position.length);
    mean.addScaledVector(poses.a1, (m - 1) / 2).addScaledVector(poses.a2, (n - 1) / 2);
    this.world.position.copy(mean.negate());
    this.decorate(shown, poses, own);
  }

  /** Forces, the chain, lost links: drawn through the rings. */
  private decorate(shown: Shown, poses: Poses, own: Sheet): void {
    for (const child of [...this.extras.children]) {
      this.extras.remove(child);
      if (child instanceof InstancedMesh) {
        child.geometry.dispose();
        (child.material as MeshBasicMaterial).dispose();
        child.dispose();
      }
    }
    const { sheet, limit } = shown;
    const R = sheet.reference_radius;
    const [m, n] = this.cells;
    const contacts = limit?.state.contacts ?? [];
    if (shown.forces && limit && shown.t === 1 && contacts.length) {
      const most = Math.max(...contacts.map((c) => c.force));
      const strong = contacts.filter((c) => c.force > 1e-3 * most);
      const fraction = Math.min(1, MOST_ARROWS / (2 * strong.length * m * n));
      const columns = Math.max(1, Math.floor(m * Math.sqrt(fraction)));
      const rows = Math.max(1, Math.floor(n * Math.sqrt(fraction)));
      const [first, second] = [Math.floor((m - columns) / 2), Math.floor((n - rows) / 2)];
      const places: Matrix4[] = [];
      const dots: Matrix4[] = [];
      for (const c of strong) {
        const normal = new Vector3(...c.normal);
        const [ra, rb] = [sheet.rings[c.ring_a]!.minor_radius, sheet.rings[c.ring_b]!.minor_radius];
        const on = new Vector3(...c.point_a).addScaledVector(normal, ra);
        on.add(new Vector3(...c.point_b).addScaledVector(normal, -rb)).multiplyScalar(0.5);
        const length = (R * 0.95 * c.force) / most;
        const inside = (k: 0 | 1, at: number, of: number) => at + c.shift[k] >= 0 && at + c.shift[k] < of;
        for (let i = first; i < first + columns; i++) {
          for (let j = second; j < second + rows; j++) {
            if (!inside(0, i, m) || !inside(1, j, n)) continue;
            const at = on.clone().addScaledVector(poses.a1, i).addScaledVector(poses.a2, j);
            const turn = (sign: number) => new Quaternion().setFromUnitVectors(Y, normal.clone().multiplyScalar(sign));
            const scale = new Vector3(R, length, R);
            places.push(new Matrix4().compose(at, turn(1), scale), new Matrix4().compose(at, turn(-1), scale));
            dots.push(new Matrix4().compose(at, new Quaternion(), new Vector3(R, R, R)));
          }
        }
      }
      const shaft = new CylinderGeometry(0.034, 0.034, 0.78, 8).translate(0, 0.39, 0);
      const head = new ConeGeometry(0.1, 0.28, 12).translate(0, 0.87, 0);
      this.many(mergeGeometries([shaft, head]), places, this.palette.force, 0.9);
      this.many(new SphereGeometry(0.1, 12, 8), dots, "#ffb703", 0.95);
    }
    const chain = limit?.state.chain;
    if (shown.chain && chain && limit) {
      const points: Vector3[] = [];
      const span = chain.vector.map((x, k) => (x ? Math.floor((shown.tile[k]! - 1) / Math.abs(x)) : Infinity));
      const repeats = Math.max(1, Math.min(6, ...span));
      // Around the middle of the tile.
      const from = chain.vector.map((x, k) => Math.floor(((shown.tile[k]! - 1) - repeats * x) / 2)) as [number, number];
      for (let k = 0; k < repeats; k++) {
        for (const [ring, cell] of k ? chain.rings.slice(1) : chain.rings) {
          const shift = [0, 1].map((d) => from[d]! + cell[d]! + k * chain.vector[d]!) as [number, number];
          points.push(centre(sheet, poses, ...inLarger(own, sheet, ring, shift)));
        }
      }
      this.line(points, 0.06 * R, "#14213d");
    }
    for (const { a, b, shift } of shown.lost) {
      const middle: [number, number] = [Math.floor((m - 1) / 2), Math.floor((n - 1) / 2)];
      if (!sheet.rings[a] || !sheet.rings[b]) continue;
      const to = middle.map((x, k) => x + shift[k]!) as [number, number];
      this.line([centre(sheet, poses, a, middle), centre(sheet, poses, b, to)], 0.05 * R, "#d81b43");
    }
  }

  private many(geometry: BufferGeometry, places: Matrix4[], color: string, opacity = 1): void {
    const material = new MeshBasicMaterial({ color, transparent: true, opacity, depthTest: false, toneMapped: false });
    const mesh = new InstancedMesh(geometry, material, places.length);
    places.forEach((place, k) => mesh.setMatrixAt(k, place));
    mesh.renderOrder = 2;
    mesh.frustumCulled = false;
    this.extras.add(mesh);
  }

  private line(points: Vector3[], width: number, color: string): void {
    const rods: Matrix4[] = [];
    for (let k = 0; k + 1 < points.length; k++) {
      const [from, to] = [points[k]!, points[k + 1]!];
      const along = to.clone().sub(from);
      const turn = new Quaternion().setFromUnitVectors(Y, along.clone().normalize());
      rods.push(new Matrix4().compose(from.clone().add(to).multiplyScalar(0.5), turn, new Vector3(width, along.length(), width)));
    }
    this.many(new CylinderGeometry(0.5, 0.5, 1, 8), rods, color, 0.9);
    const dot = new Vector3(width, width, width);
    this.many(new SphereGeometry(0.95, 12, 8), points.map((p) => new Matrix4().compose(p, new Quaternion(), dot)), color, 0.9);
  }

  private paint(shown: Shown): void {
    const { sheet, limit } = shown;
    const ramp = this.palette.loads.map((c) => new Color(c));
    const along = (x: number) => {
      const at = Math.max(0, Math.min(1, x)) * (ramp.length - 1);
      const k = Math.min(Math.floor(at), ramp.length - 2);
      return ramp[k]!.clone().lerp(ramp[k + 1]!, at - k);
    };
    const kinds = sheet.kinds.map((k) => new Color(this.palette.kinds[k % this.palette.kinds.length]));
    let colors = kinds;
    if (shown.colorBy === "load") {
      const of = loads(sheet, limit);
      const most = Math.max(...of, 1e-12);
      colors = of.map((load) => (load > 1e-3 * most ? along(load / most) : new Color(this.palette.unloaded)));
    } else if (shown.colorBy === "slack") {
      const of = slack(sheet, limit && shown.t === 1 ? limit.pairs : sheet.pairs);
      const most = Math.max(...of.filter(Number.isFinite), 1e-12);
      colors = of.map((gap) => (Number.isFinite(gap) ? along(1 - gap / most) : new Color(this.palette.unloaded)));
    }
    const wrong = new Set<number>();
    if (shown.t === 0) {
      for (const pair of sheet.pairs) if (pair.gap < -1e-9 * sheet.reference_radius) wrong.add(pair.ring_a).add(pair.ring_b);
    }
    // Of a picked element, its neighbours keep their colours where they are.
    const [m, n] = this.cells;
    const lit = new Set<string>();
    const middle = [Math.floor((m - 1) / 2), Math.floor((n - 1) / 2)] as const;
    if (shown.picked !== null) {
      lit.add(`${shown.picked},${middle[0]},${middle[1]}`);
      for (const { ring_a, ring_b, shift, number } of limit && shown.t === 1 ? limit.pairs : sheet.pairs) {
        const [a, b] = [sheet.rings[ring_a]!.element, sheet.rings[ring_b]!.element];
        if (!number) continue;
        if (a === shown.picked) lit.add(`${b},${middle[0] + shift[0]},${middle[1] + shift[1]}`);
        if (b === shown.picked) lit.add(`${a},${middle[0] - shift[0]},${middle[1] - shift[1]}`);
      }
    }
    for (const { mesh, rings } of this.shapes) {
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

  /** The whole tile in view, from the direction of the program's pictures. */
  private fit(shown: Shown): void {
    const distance = Math.max(this.distance(shown.own.a1, shown.own.a2, shown.tile, shown.own.reference_radius), this.room(shown));
    const [azimuth, elevation] = [(16 * Math.PI) / 180, (56 * Math.PI) / 180];
    const arm = new Vector3(-Math.sin(azimuth) * Math.cos(elevation), -Math.cos(azimuth) * Math.cos(elevation), Math.sin(elevation));
    this.controls.target.set(0, 0, 0);
    this.camera.position.copy(arm.multiplyScalar(distance));
    this.camera.near = distance / 100;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  /** How far the eye must be to have a tile in view. */
  private distance(a: number[], b: number[], [m, n]: [number, number], R: number): number {
    const [a1, a2] = [new Vector3(...a), new Vector3(...b)];
    const corners = [n, -n].map((k) => a1.clone().multiplyScalar(m).addScaledVector(a2, k).length());
    const fov = (this.camera.fov * Math.PI) / 180;
    return (0.92 * (Math.max(...corners) / 2 + R)) / Math.sin(fov / 2) / Math.min(1, this.camera.aspect);
  }

  /** The distance that a locked state needs. */
  private room({ limit, sheet }: Shown): number {
    return limit ? 0.9 * this.distance(limit.state.a1, limit.state.a2, this.cells, sheet.reference_radius) : 0;
  }

  /** Goes back as far as a locked state needs; nobody is brought nearer. */
  private makeRoom(shown: Shown): void {
    const arm = this.camera.position.clone().sub(this.controls.target);
    const needed = this.room(shown);
    if (arm.length() >= needed) return;
    this.camera.position.copy(this.controls.target).add(arm.setLength(needed));
    this.controls.update();
  }

  /** Looks from where `other` looks. */
  follow(other: Stage): void {
    this.camera.position.copy(other.camera.position);
    this.controls.target.copy(other.controls.target);
    this.controls.update();
    this.draw();
  }

  private pick(event: PointerEvent): number | null {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    this.raycaster.setFromCamera(at, this.camera);
    const hit = this.raycaster.intersectObjects(this.shapes.map((s) => s.mesh), false)[0];
    const shape = this.shapes.find((s) => s.mesh === hit?.object);
    if (!shape || hit?.instanceId === undefined || !this.shown) return null;
    const ring = shape.rings[Math.floor(hit.instanceId / (this.cells[0] * this.cells[1]))]!;
    return this.shown.sheet.rings[ring]!.element;
  }

  /** Rings that are drawn. */
  get ringCount(): number {
    return this.shapes.reduce((sum, s) => sum + s.mesh.count, 0);
  }

  /** The direction of view: for tests of turning. */
  get view(): number[] {
    return this.camera.position.toArray();
  }

  /** Time of `count` frames with all poses set anew, ms each on the CPU. */
  measure(count: number): number {
    if (!this.shown) return NaN;
    const begun = performance.now();
    for (let k = 0; k < count; k++) {
      this.place(this.shown);
      this.renderer.render(this.scene, this.camera);
    }
    return (performance.now() - begun) / count;
  }

  /** Draws at the next frame, once. */
  draw(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.renderer.render(this.scene, this.camera);
      if (this.shown && !performance.getEntriesByName("maille-first-picture").length) performance.mark("maille-first-picture");
    });
  }
}
