// One sheet in 3D: instanced tori, what is drawn through them, picking.

import {
  CatmullRomCurve3,
  AmbientLight,
  type BufferGeometry,
  DirectionalLight,
  DynamicDrawUsage,
  Group,
  HemisphereLight,
  InstancedMesh,
  Matrix4,
  MeshPhongMaterial,
  Quaternion,
  Raycaster,
  Scene,
  SphereGeometry,
  TorusGeometry,
  TubeGeometry,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { mergeGeometries } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import { paint } from "./colors";
import type { Drawing, Shape } from "./drawing";
import { Overlays } from "./overlays";
import { centre, copies, posesAt } from "./pose";
import type { Palette } from "./types";
import { Viewpoint } from "./viewpoint";

const Z = new Vector3(0, 0, 1);
/** Pixels that the pointer may move in a click. */
const CLICK = 4;

/** The tube round a curve through points; an open one has balls at its ends. */
function tube(points: readonly (readonly number[])[], open: boolean, radius: number, across: number): BufferGeometry {
  const along = points.map((p) => new Vector3(...(p as [number, number, number])));
  const line = new CatmullRomCurve3(along, !open, "centripetal");
  const parts: BufferGeometry[] = [new TubeGeometry(line, 2 * points.length, radius, across, !open)];
  for (const end of open ? [along[0]!, along[along.length - 1]!] : []) {
    parts.push(new SphereGeometry(radius, across, across).translate(end.x, end.y, end.z));
  }
  return mergeGeometries(parts);
}

export class Stage {
  readonly canvas: HTMLCanvasElement;
  /** Called when the user has turned the view. */
  onTurn: () => void = () => {};
  private renderer: WebGLRenderer;
  private scene = new Scene();
  private viewpoint: Viewpoint;
  private world = new Group();
  private shapes: Shape[] = [];
  private overlays: Overlays;
  private key = "";
  private fitted = "";
  private size = "";
  private shown: Drawing | null = null;
  private waiting = false;
  /** Copies of the sheet along a1 and a2. */
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
    this.overlays = new Overlays(palette);
    this.world.add(this.overlays.group);
    this.scene.add(...lights(), this.world);
    this.viewpoint = new Viewpoint(
      this.canvas,
      () => this.draw(),
      () => this.onTurn(),
    );
    let down = new Vector2();
    this.canvas.addEventListener("pointerdown", (e) => (down = new Vector2(e.clientX, e.clientY)));
    this.canvas.addEventListener("pointerup", (e) => {
      if (down.distanceTo(new Vector2(e.clientX, e.clientY)) < CLICK) onPick(this.pick(e));
    });
    new ResizeObserver(() => this.resize(box)).observe(box);
    this.resize(box);
  }

  private resize(box: HTMLElement): void {
    const { clientWidth: width, clientHeight: height } = box;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.viewpoint.setAspect(width / height);
    if (this.shown) this.viewpoint.refit(this.shown, this.cells);
    this.draw();
  }

  /** Shows something else; what has not changed is kept. */
  show(shown: Drawing): void {
    const { shown: old } = this;
    if (old && alike(shown, old)) return;
    const [columns, rows] = copies(shown.sheet.cell);
    this.cells = [Math.ceil(shown.tile[0] / columns), Math.ceil(shown.tile[1] / rows)];
    const radii = shown.sheet.rings.map((r) => `${r.major_radius},${r.minor_radius},${r.curve?.join() ?? ""},${r.open}`);
    const key = `${radii.join(";")}|${this.cells}`;
    if (key !== this.key) this.build(shown, radii);
    this.key = key;
    this.shown = shown;
    this.place(shown);
    paint(this.shapes, shown, this.cells, this.palette);
    if (shown.limit && shown.limit !== old?.limit && shown.reach === null) this.viewpoint.makeRoom(shown, this.cells);
    const fitted = `${shown.own.name}|${shown.tile}|${shown.reach}`;
    const size = [...shown.own.a1, ...shown.own.a2].map((x) => x.toFixed(1)).join();
    if (fitted !== this.fitted) this.viewpoint.fit(shown, this.cells);
    else if (size !== this.size) this.viewpoint.refit(shown, this.cells);
    [this.fitted, this.size] = [fitted, size];
    this.draw();
  }

  /** One mesh for each pair of radii and each other curve; rings have fewer segments where there are many. */
  private build(shown: Drawing, radii: string[]): void {
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
      const { major_radius, minor_radius, curve, open } = shown.sheet.rings[rings[0]!]!;
      const geometry = curve
        ? tube(curve, open, minor_radius, across)
        : new TorusGeometry(major_radius, minor_radius, across, around);
      const material = new MeshPhongMaterial({ shininess: 55, specular: "#4a4a4a" });
      const mesh = new InstancedMesh(geometry, material, rings.length * cells);
      mesh.instanceMatrix.setUsage(DynamicDrawUsage);
      mesh.frustumCulled = false;
      this.world.add(mesh);
      return { mesh, rings };
    });
  }

  private place(shown: Drawing): void {
    const { sheet } = shown;
    const poses = posesAt(sheet, shown.limit, shown.t);
    const [m, n] = this.cells;
    const matrix = new Matrix4();
    const shift = new Vector3();
    for (const { mesh, rings } of this.shapes) {
      let k = 0;
      for (const ring of rings) {
        const { element, normal, curve } = sheet.rings[ring]!;
        const turned = new Vector3(...normal).applyQuaternion(poses.rotation[element]!).normalize();
        const turn = curve ? poses.rotation[element]! : new Quaternion().setFromUnitVectors(Z, turned);
        matrix.makeRotationFromQuaternion(turn);
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
    // A finite sheet is seen from where it began, so that what is held stays in its place.
    const seen = shown.reach === null ? poses : posesAt(sheet, null, 0);
    const mean = seen.position.reduce((sum, p) => sum.add(p), new Vector3()).divideScalar(seen.position.length);
    mean.addScaledVector(poses.a1, (m - 1) / 2).addScaledVector(poses.a2, (n - 1) / 2);
    this.world.position.copy(mean.negate());
    this.overlays.draw(shown, poses, this.cells);
  }

  /** Looks from where `other` looks. */
  follow(other: Stage): void {
    this.viewpoint.follow(other.viewpoint);
  }

  private pick(event: PointerEvent): number | null {
    const box = this.canvas.getBoundingClientRect();
    const [x, y] = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
    this.raycaster.setFromCamera(new Vector2(2 * x - 1, 1 - 2 * y), this.viewpoint.camera);
    const meshes = this.shapes.map((s) => s.mesh);
    const hit = this.raycaster.intersectObjects(meshes, false)[0];
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
    return this.viewpoint.camera.position.toArray();
  }

  /** Time of `count` frames with all poses set anew, ms each on the CPU. */
  measure(count: number): number {
    if (!this.shown) return NaN;
    const begun = performance.now();
    for (let k = 0; k < count; k++) {
      this.place(this.shown);
      this.render();
    }
    return (performance.now() - begun) / count;
  }

  /** Draws at the next frame, once. */
  draw(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.render();
      const marked = performance.getEntriesByName("maille-first-picture").length > 0;
      if (this.shown && !marked) performance.mark("maille-first-picture");
    });
  }

  private render(): void {
    this.renderer.render(this.scene, this.viewpoint.camera);
  }
}

function lights(): [HemisphereLight, AmbientLight, DirectionalLight, DirectionalLight] {
  const key = new DirectionalLight("#fff7ea", 2.1);
  key.position.set(-4, -6, 9);
  const fill = new DirectionalLight("#dfe9ff", 0.7);
  fill.position.set(6, 3, 4);
  return [new HemisphereLight("#ffffff", "#b9b2a6", 1.25), new AmbientLight("#ffffff", 0.25), key, fill];
}

/** Whether two drawings are the same: objects are, lists that are made anew each time have to look it. */
function alike(a: Drawing, b: Drawing): boolean {
  const names = Object.keys(a) as (keyof Drawing)[];
  const listed = (name: keyof Drawing) => name === "tile" || name === "changed";
  return names.every((n) => a[n] === b[n] || (listed(n) && JSON.stringify(a[n]) === JSON.stringify(b[n])));
}
