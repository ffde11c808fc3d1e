// The course of a simulation: force against stretch, or energy against the share of the pull.

import { h, s, short } from "./dom";
import type { Frame } from "./types";

/** One simulation. */
export interface Course {
  color: string;
  frames: Frame[];
  /** Index of the frame that is shown. */
  shown: number;
}

/** What the axes are, by what all frames have. */
interface Axes {
  x: { words: string; of: (frame: Frame) => number };
  y: { words: string; of: (frame: Frame) => number };
}

const [WIDTH, HEIGHT] = [420, 300];
const [LEFT, RIGHT, TOP, BOTTOM] = [62, 14, 14, 46];
const TICKS = 4;

function axes(courses: Course[]): Axes {
  const all = (has: (frame: Frame) => boolean) => courses.every((course) => course.frames.every(has));
  return {
    x: all((f) => f.stretch !== null)
      ? { words: "stretch between the pulled places", of: (f) => f.stretch! }
      : { words: "share of the pull", of: (f) => f.share },
    y: all((f) => f.mean_force !== null)
      ? { words: "mean force on a pulled element", of: (f) => f.mean_force! }
      : { words: "energy, β R²", of: (f) => f.energy },
  };
}

/** Round numbers from `low` to `high`. */
function ticks(low: number, high: number): number[] {
  const rough = (high - low) / TICKS;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((x) => x >= rough) ?? rough;
  const first = Math.ceil(low / step - 1e-9);
  return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, k) => (first + k) * step);
}

function range(values: number[]): [number, number] {
  const [low, high] = [Math.min(...values), Math.max(...values)];
  return high > low ? [low, high] : [low - 0.5, high + 0.5];
}

export class ForcePlot {
  readonly node: SVGSVGElement;
  readonly tip = h("p", { class: "tip" }, "Click a state to see it.");
  /** Where each frame is drawn. */
  private dots: { x: number; y: number; course: number; frame: number }[] = [];

  constructor(private onChoose: (course: number, frame: number) => void) {
    this.node = s("svg", {
      viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
      class: "force-map",
      role: "img",
      onclick: (event) => this.click(event as MouseEvent),
    });
  }

  private click(event: MouseEvent): void {
    const box = this.node.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * WIDTH;
    const y = ((event.clientY - box.top) / box.height) * HEIGHT;
    const far = this.dots.map((dot) => Math.hypot(dot.x - x, dot.y - y));
    const nearest = this.dots[far.indexOf(Math.min(...far))];
    if (nearest) this.onChoose(nearest.course, nearest.frame);
  }

  draw(courses: Course[]): void {
    this.node.toggleAttribute("hidden", !courses.length);
    this.tip.hidden = !courses.length;
    if (!courses.length) return;
    const { x, y } = axes(courses);
    const frames = courses.flatMap((course) => course.frames);
    const [x0, x1] = range(frames.map(x.of));
    const [y0, y1] = range([0, ...frames.map(y.of)]);
    const px = (value: number) => LEFT + ((value - x0) / (x1 - x0)) * (WIDTH - LEFT - RIGHT);
    const py = (value: number) => HEIGHT - BOTTOM - ((value - y0) / (y1 - y0)) * (HEIGHT - TOP - BOTTOM);
    this.node.setAttribute("aria-label", `${y.words} against ${x.words}; a click shows the nearest state`);
    this.dots = courses.flatMap((course, c) =>
      course.frames.map((frame, k) => ({ x: px(x.of(frame)), y: py(y.of(frame)), course: c, frame: k })),
    );
    this.node.replaceChildren(
      ...ticks(x0, x1).flatMap((value) => [
        s("line", { x1: px(value), x2: px(value), y1: TOP, y2: HEIGHT - BOTTOM, class: "grid" }),
        s("text", { x: px(value), y: HEIGHT - BOTTOM + 16, class: "degrees" }, short(value, 4)),
      ]),
      ...ticks(y0, y1).flatMap((value) => [
        s("line", { x1: LEFT, x2: WIDTH - RIGHT, y1: py(value), y2: py(value), class: "grid" }),
        s("text", { x: LEFT - 6, y: py(value) + 4, class: "degrees end" }, short(value, 4)),
      ]),
      s("text", { x: (LEFT + WIDTH - RIGHT) / 2, y: HEIGHT - 10, class: "degrees" }, x.words),
      s("text", { class: "degrees", transform: `translate(14 ${(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)` }, y.words),
      ...courses.flatMap((course, c) => this.course(course, c)),
    );
  }

  private course({ color, shown }: Course, c: number): Node[] {
    const dots = this.dots.filter((dot) => dot.course === c);
    const d = dots.map(({ x, y }, k) => `${k ? "L" : "M"}${x.toFixed(2)} ${y.toFixed(2)}`).join("");
    const at = dots[shown]!;
    return [
      s("path", { d, class: "curve", stroke: color, fill: "none" }),
      ...dots.map(({ x, y }) => s("circle", { cx: x, cy: y, r: 2.6, class: "limit", stroke: color, fill: color })),
      s("circle", { cx: at.x, cy: at.y, r: 6, class: "chosen" }),
    ];
  }
}
