// A slider with its label and its value in words.

import { h, short } from "./dom";
import type { Side } from "./side";

export class Slider {
  readonly node: HTMLElement;
  private input: HTMLInputElement;
  private output = h("output", {});

  constructor(label: string, [min, max, step]: [number, number, number], onInput: (x: number) => void) {
    const oninput = () => onInput(Number(this.input.value));
    this.input = h("input", { type: "range", "aria-label": label, min, max, step, oninput });
    this.node = h("label", { class: "slider" }, h("span", {}, label), this.input, this.output);
  }

  set(value: number, words: string): void {
    const { input } = this;
    // Not under the hand that drags it.
    if (document.activeElement !== input || Number(input.value) !== value) input.value = String(value);
    this.output.textContent = words;
  }

  /** The wire radius of `side`: up to where its rings no longer fit. */
  setWire(side: Side, unit: string): void {
    const R = side.own?.reference_radius ?? 1;
    const r = side.wire;
    const step = 10 ** Math.floor(Math.log10(R / 100));
    this.input.disabled = r === null;
    Object.assign(this.input, {
      min: step,
      max: Math.max(0.35 * R, 1.3 * (side.design?.minor_radius ?? 0), r ?? 0),
      step: step / 2,
    });
    this.set(r ?? 0, r === null ? "by ring" : `${short(r, 4)}${unit}`);
  }
}
