// The drawing board: rings are picked, dragged, turned and resized, and the lattice is pulled.

import { drawPlan } from "./board-picture";
import { tomlVector } from "./design-text";
import { h, s, short } from "./dom";
import type { Draft } from "./draft";
import {
  attitude,
  circle,
  directionOf,
  handles,
  lengthStep,
  moved,
  resized,
  rounded,
  toPlane,
  toScreen,
  turned,
  tiltOf,
  type Point,
  type View,
} from "./plan";
import type { Selection } from "./selection";
import type { Side } from "./side";
import type { Change, Design, Palette } from "./types";

type Handle = "move" | "turn" | "tilt" | "radius" | "a1" | "a2";
type Drag = { handle: Handle; grip: Point } | { handle: "pan"; grip: Point };

/** Pixels from the wire at which a ring is picked. */
const NEAR = 9;
/** Cells that fit into the board. */
const FIT = 2.1;

export class Board {
  readonly node: HTMLElement;
  private canvas = h("canvas", { "aria-hidden": "true" });
  private svg: SVGSVGElement;
  private said = h("p", { class: "board-said", role: "status" });
  private view: View = { scale: 1, middle: [0, 0], size: [1, 1] };
  private fitted = "";
  private drag: Drag | null = null;

  constructor(
    private side: Side,
    private palette: Palette,
    private selection: Selection,
    private draft: Draft,
    onKey: (event: KeyboardEvent) => void,
  ) {
    this.svg = s("svg", {
      tabindex: 0,
      role: "application",
      "aria-label":
        "Drawing board. Arrow keys move the ring that is selected, Page Up and Page Down lift and lower it, " +
        "brackets turn it, comma and full stop tilt it, plus and minus change its radius, Delete removes it.",
      onpointerdown: (e) => this.down(e as PointerEvent),
      onpointermove: (e) => this.move(e as PointerEvent),
      onpointerup: () => (this.drag = null),
      onpointercancel: () => (this.drag = null),
      onkeydown: (e) => onKey(e as KeyboardEvent),
    });
    this.svg.addEventListener("wheel", (e) => this.wheel(e), { passive: false });
    const zoom = (label: string, words: string, work: () => void) =>
      h("button", { type: "button", "aria-label": words, title: words, onclick: work }, label);
    const buttons = h(
      "div",
      { class: "board-zoom" },
      zoom("+", "Zoom in", () => this.zoom(1.25, null)),
      zoom("−", "Zoom out", () => this.zoom(0.8, null)),
      zoom("□", "Show the whole cell", () => this.refit()),
    );
    this.node = h("div", { class: "board", hidden: true }, this.canvas, this.svg, buttons, this.said);
    new ResizeObserver(() => this.resize()).observe(this.node);
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.node;
    if (!width || !height) return;
    const ratio = Math.min(devicePixelRatio, 2);
    Object.assign(this.canvas, { width: width * ratio, height: height * ratio });
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.view.size = [width, height];
    this.refit();
  }

  private refit(): void {
    const { design } = this.side;
    if (!design) return;
    const { a1, a2 } = design.lattice;
    const [width, height] = [0, 1].map((k) => Math.abs(a1[k]!) + Math.abs(a2[k]!)) as [number, number];
    const least = 2 * design.reference_radius;
    const [w, h] = this.view.size;
    this.view.scale = Math.min(w / Math.max(width, least), h / Math.max(height, least)) / FIT;
    this.view.middle = [(a1[0] + a2[0]) / 2, (a1[1] + a2[1]) / 2];
    this.draw();
  }

  private zoom(factor: number, at: Point | null): void {
    const { view } = this;
    const screen: Point = at ?? [view.size[0] / 2, view.size[1] / 2];
    const before = toPlane(view, screen);
    view.scale *= factor;
    const after = toPlane(view, screen);
    view.middle = [view.middle[0] + before[0] - after[0], view.middle[1] + before[1] - after[1]];
    this.draw();
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    this.zoom(Math.exp(-event.deltaY / 500), this.at(event));
  }

  private at(event: MouseEvent): Point {
    const box = this.svg.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  /** The element whose wire is nearest, with the cell of the copy that is. */
  private nearest(at: Point): { element: number; shift: Point } | null {
    const { design } = this.side;
    if (!design) return null;
    const { a1, a2 } = design.lattice;
    let best: { element: number; shift: Point; far: number } | null = null;
    for (const [i, j] of [0, 1, -1].flatMap((i) => [0, 1, -1].map((j): Point => [i, j]))) {
      const shift: Point = [i * a1[0] + j * a2[0], i * a1[1] + j * a2[1]];
      design.elements.forEach((element, index) => {
        element.rings.forEach(({ minor_radius }, k) => {
          const wire = (minor_radius ?? design.minor_radius ?? 0) * this.view.scale;
          for (const p of circle(element, k, 72)) {
            const [x, y] = toScreen(this.view, [p.x + shift[0], p.y + shift[1]]);
            const far = Math.hypot(x - at[0], y - at[1]) - wire;
            if (far < NEAR && (!best || far < best.far - 1e-6)) best = { element: index, shift, far };
          }
        });
      });
    }
    return best;
  }

  private down(event: PointerEvent): void {
    const { design } = this.side;
    if (!design || event.button) return;
    const at = this.at(event);
    const place = toPlane(this.view, at);
    const named = (event.target as Element).getAttribute("data-handle") as Handle | null;
    this.svg.setPointerCapture(event.pointerId);
    this.draft.remember();
    if (named && named !== "move") return void (this.drag = { handle: named, grip: [0, 0] });
    const hit = named ? { element: this.selection.index, shift: [0, 0] as Point } : this.nearest(at);
    const element = hit?.element == null ? undefined : design.elements[hit.element];
    if (!hit || !element) return void (this.drag = { handle: "pan", grip: place });
    this.selection.pick(hit.element);
    // From the pointer to the centre of the element: the ring does not jump. A copy moves with its element.
    this.drag = { handle: "move", grip: [element.center[0] - place[0], element.center[1] - place[1]] };
    this.draw();
  }

  private move(event: PointerEvent): void {
    const { drag, side } = this;
    const { design } = side;
    if (!drag || !design) return;
    const place = toPlane(this.view, this.at(event));
    if (drag.handle === "pan") {
      this.view.middle = [
        this.view.middle[0] + drag.grip[0] - place[0],
        this.view.middle[1] + drag.grip[1] - place[1],
      ];
      return this.draw();
    }
    this.draft.set((now) => this.dragged(now, drag, place), `drag ${drag.handle}`);
  }

  /** What a drag to a place makes of the design. */
  private dragged(design: Design, { handle, grip }: Drag, [x, y]: Point): Change[] {
    const step = lengthStep(design);
    const unit = design.unit ? ` ${design.unit}` : "";
    if (handle === "a1" || handle === "a2") {
      const vector = [rounded(x, step), rounded(y, step), 0];
      this.said.textContent = `${handle} = (${short(vector[0]!)}, ${short(vector[1]!)})${unit}`;
      return [{ field: `lattice.${handle}`, value: tomlVector(vector) }];
    }
    const { index } = this.selection;
    const element = index === null ? undefined : design.elements[index];
    if (index === null || !element) return [];
    if (handle === "move") {
      const center = [rounded(x + grip[0], step), rounded(y + grip[1], step), element.center[2]];
      this.said.textContent = `${element.name}: x ${short(center[0]!)}, y ${short(center[1]!)}${unit}`;
      return moved(index, center);
    }
    const [dx, dy] = [x - element.center[0], y - element.center[1]];
    const { normal, major_radius: R } = element.rings[0]!;
    if (handle === "radius") {
      const radius = Math.max(step, rounded(Math.hypot(dx, dy), step));
      this.said.textContent = `${element.name}: R ${short(radius)}${unit}`;
      return resized(design, index, radius);
    }
    const from = attitude(normal, this.selection.turn);
    const to = { ...from };
    if (handle === "turn") to.turn = directionOf([dx, dy]);
    else to.tilt = tiltOf(from.turn, [dx / R, dy / R]);
    this.selection.turn = to.turn;
    this.said.textContent = `${element.name}: turn ${short(to.turn, 2)}°, tilt ${short(to.tilt, 2)}°`;
    return turned(design, index, from, to);
  }

  draw(): void {
    const { design, own, readable, changedLinks } = this.side;
    const context = this.canvas.getContext("2d");
    if (!design || !context || this.view.size[0] < 2) return;
    if (this.fitted !== this.side.name) {
      this.fitted = this.side.name;
      return this.refit();
    }
    const ratio = this.canvas.width / this.view.size[0];
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const same = readable && own !== null && own.poses.length === design.elements.length;
    const named = this.side.problems.flatMap(({ field }) => /^elements\[(\d+)\]/.exec(field ?? "")?.[1] ?? []);
    const wrongElements = new Set(named.map(Number));
    const selected = this.selection.index;
    const plan = { design, sheet: same ? own : null, changed: changedLinks, selected, wrongElements };
    drawPlan(context, this.view, plan, this.palette);
    this.svg.replaceChildren(...this.lattice(design), ...this.handles(design));
  }

  private lattice({ lattice }: Design): Node[] {
    const [ox, oy] = toScreen(this.view, [0, 0]);
    return (["a1", "a2"] as const).flatMap((name) => {
      const [x, y] = toScreen(this.view, lattice[name]);
      return [
        s("line", { x1: ox, y1: oy, x2: x, y2: y, class: "vector" }),
        s("circle", { cx: x, cy: y, r: 8, class: "handle vector-end", "data-handle": name }),
        s("text", { x: x + 12, y: y - 8, class: "vector-name" }, name === "a1" ? "a₁" : "a₂"),
      ];
    });
  }

  private handles(design: Design): Node[] {
    const { index, turn } = this.selection;
    const element = index === null ? undefined : design.elements[index];
    if (!element) return [];
    const at = handles(element, turn);
    const [cx, cy] = toScreen(this.view, at.tilt);
    const [tx, ty] = toScreen(this.view, at.turn);
    const dot = (name: Handle, place: Point, words: string) => {
      const [x, y] = toScreen(this.view, place);
      const node = s("circle", { cx: x, cy: y, r: 7, class: `handle ${name}`, "data-handle": name });
      node.append(s("title", {}, words));
      return node;
    };
    return [
      s("line", { x1: cx, y1: cy, x2: tx, y2: ty, class: "arm" }),
      dot("move", [element.center[0], element.center[1]], "Move"),
      dot("turn", at.turn, "Turn"),
      dot("radius", at.radius, "Radius"),
      dot("tilt", at.tilt, "Tilt"),
    ];
  }
}
