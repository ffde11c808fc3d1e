// The way from the start to the limit, or through the states of a simulation.

import { h, short } from "./dom";
import type { Frames } from "./frames";
import type { ViewState } from "./state";

/** Steps between the start and a limit. */
const STEP = 0.005;

export class Scrubber {
  readonly node: HTMLElement;
  private play: HTMLButtonElement;
  private input: HTMLInputElement;
  private place = h("output", { class: "way" });
  private start = h("span", {}, "start");
  private end = h("span", {}, "limit");

  constructor(private state: ViewState) {
    this.play = h(
      "button",
      { type: "button", class: "play", "aria-label": "Play the pull", onclick: () => state.play() },
      "▶",
    );
    this.input = h("input", {
      type: "range",
      min: 0,
      max: 1,
      step: STEP,
      value: 0,
      oninput: () => state.scrub(Number(this.input.value)),
    });
    this.node = h("div", { class: "scrubber" }, this.play, this.start, this.input, this.end, this.place);
  }

  draw(): void {
    const { a, b, mode, t } = this.state;
    this.node.hidden = mode === "draw";
    const frames = a.frames ?? (mode === "compare" ? b.frames : null);
    const moves = frames !== null || a.locked !== null || (mode === "compare" && b.locked !== null);
    // The browser rounds a value to the steps: those of the frames come first.
    this.input.step = String(frames?.step ?? STEP);
    this.input.setAttribute("aria-label", frames ? "State of the simulation" : "From the start to the limit");
    this.input.value = String(t);
    this.input.disabled = !moves;
    this.play.disabled = !moves;
    this.play.textContent = t < 1 ? "▶" : "◀";
    this.play.setAttribute("aria-label", t < 1 ? "Play the pull" : "Play it back");
    this.end.textContent = frames ? "end" : "limit";
    const between = !frames && moves && t > 0 && t < 1;
    this.place.dataset["kind"] = between ? "between" : "state";
    if (frames) this.place.textContent = frameWords(frames, t);
    else if (between) this.place.textContent = "interpolated: shows the way, overlaps are possible";
    else this.place.textContent = moves && t === 1 ? "locked" : "starting state";
  }
}

function frameWords(frames: Frames, t: number): string {
  const { number, share, roll } = frames.at(t);
  if (roll !== null) return `${number + 1} of ${frames.simulation.total}: ${roll}`;
  return `frame ${number} (the last is ${frames.simulation.total - 1}), ${short(100 * share, 1)} % of the pull`;
}
