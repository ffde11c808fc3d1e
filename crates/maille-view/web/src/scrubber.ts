// The way from the start to the limit.

import { h } from "./dom";
import type { ViewState } from "./state";

export class Scrubber {
  readonly node: HTMLElement;
  private play: HTMLButtonElement;
  private input: HTMLInputElement;
  private place = h("output", { class: "way" });

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
      step: 0.005,
      value: 0,
      "aria-label": "From the start to the limit",
      oninput: () => state.scrub(Number(this.input.value)),
    });
    const [start, limit] = [h("span", {}, "start"), h("span", {}, "limit")];
    this.node = h("div", { class: "scrubber" }, this.play, start, this.input, limit, this.place);
  }

  draw(): void {
    const { a, t } = this.state;
    const locked = a.locked !== null;
    this.input.value = String(t);
    this.input.disabled = !locked;
    this.play.disabled = !locked;
    this.play.textContent = t < 1 ? "▶" : "◀";
    this.play.setAttribute("aria-label", t < 1 ? "Play the pull" : "Play it back");
    const between = locked && t > 0 && t < 1;
    this.place.dataset["kind"] = between ? "between" : "state";
    if (between) this.place.textContent = "interpolated: shows the way, overlaps are possible";
    else this.place.textContent = locked && t === 1 ? "locked" : "starting state";
  }
}
