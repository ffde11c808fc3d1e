// From where the sheet is seen.

import { PerspectiveCamera, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Drawing } from "./drawing";

const Z = new Vector3(0, 0, 1);
/** Radians that a key turns the view by, around the sheet's normal and over it. */
const TURN: Record<string, [number, number]> = {
  ArrowLeft: [-0.12, 0],
  ArrowRight: [0.12, 0],
  ArrowUp: [0, -0.1],
  ArrowDown: [0, 0.1],
};
const ZOOM: Record<string, number> = { "+": 0.9, "=": 0.9, "-": 1.11 };
/** Where the pictures of the program are taken from. */
const AZIMUTH = (16 * Math.PI) / 180;
const ELEVATION = (56 * Math.PI) / 180;

export class Viewpoint {
  readonly camera = new PerspectiveCamera(30, 1, 0.1, 5000);
  private controls: OrbitControls;
  private turning = false;

  constructor(
    canvas: HTMLCanvasElement,
    private draw: () => void,
    /** The user has turned the view. */
    private turned: () => void,
  ) {
    this.camera.up.copy(Z);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => {
      draw();
      if (this.turning) turned();
    });
    this.controls.addEventListener("start", () => (this.turning = true));
    this.controls.addEventListener("end", () => (this.turning = false));
    canvas.addEventListener("keydown", (event) => this.press(event));
  }

  setAspect(aspect: number): void {
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
  }

  /** Arrows turn the view, plus and minus go nearer and away. */
  private press(event: KeyboardEvent): void {
    const [around, over] = TURN[event.key] ?? [0, 0];
    const factor = ZOOM[event.key] ?? 1;
    if (!around && !over && factor === 1) return;
    event.preventDefault();
    const arm = this.arm().multiplyScalar(factor);
    arm.applyAxisAngle(Z, around);
    const side = new Vector3().crossVectors(Z, arm).normalize();
    const angle = arm.angleTo(Z) + over;
    if (angle > 0.02 && angle < Math.PI - 0.02) arm.applyAxisAngle(side, over);
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
    this.draw();
    this.turned();
  }

  /** The whole tile in view, from the direction of the program's pictures. */
  fit(drawing: Drawing, cells: [number, number]): void {
    const distance = this.distanceOf(drawing, cells);
    const level = Math.cos(ELEVATION);
    const arm = new Vector3(-Math.sin(AZIMUTH) * level, -Math.cos(AZIMUTH) * level, Math.sin(ELEVATION));
    this.controls.target.set(0, 0, 0);
    this.camera.position.copy(arm.multiplyScalar(distance));
    this.camera.near = distance / 100;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  /** The whole tile in view, from where the user looks. */
  refit(drawing: Drawing, cells: [number, number]): void {
    this.controls.target.set(0, 0, 0);
    this.camera.position.copy(this.arm().setLength(this.distanceOf(drawing, cells)));
    this.controls.update();
  }

  private distanceOf(drawing: Drawing, cells: [number, number]): number {
    const { own, tile, reach } = drawing;
    if (reach !== null) return this.distanceOfRadius(reach);
    const whole = this.distance(own.a1, own.a2, tile, own.reference_radius);
    return Math.max(whole, this.distanceOfLimit(drawing, cells));
  }

  /** Goes back as far as a locked state needs; nobody is brought nearer. */
  makeRoom(drawing: Drawing, cells: [number, number]): void {
    const arm = this.arm();
    const needed = this.distanceOfLimit(drawing, cells);
    if (arm.length() >= needed) return;
    this.camera.position.copy(this.controls.target).add(arm.setLength(needed));
    this.controls.update();
  }

  /** Looks from where `other` looks. */
  follow(other: Viewpoint): void {
    this.camera.position.copy(other.camera.position);
    this.controls.target.copy(other.controls.target);
    this.controls.update();
    this.draw();
  }

  /** From what is looked at to the camera. */
  private arm(): Vector3 {
    return this.camera.position.clone().sub(this.controls.target);
  }

  /** How far the camera must be to have a tile in view. */
  private distance(a: number[], b: number[], [m, n]: [number, number], R: number): number {
    const [a1, a2] = [new Vector3(...a), new Vector3(...b)];
    const corners = [n, -n].map((k) => a1.clone().multiplyScalar(m).addScaledVector(a2, k).length());
    return this.distanceOfRadius(Math.max(...corners) / 2 + R);
  }

  private distanceOfRadius(radius: number): number {
    const fov = (this.camera.fov * Math.PI) / 180;
    return (0.92 * radius) / Math.sin(fov / 2) / Math.min(1, this.camera.aspect);
  }

  /** The distance that a locked state needs. */
  private distanceOfLimit({ limit, sheet }: Drawing, cells: [number, number]): number {
    return limit ? 0.9 * this.distance(limit.state.a1, limit.state.a2, cells, sheet.reference_radius) : 0;
  }
}
