// A slider for each parameter of a design that is free.

import { toml } from "./design-text";
import { h, short } from "./dom";
import { changedList } from "./problems";
import type { Side } from "./side";
import { Slider } from "./slider";
import type { Change, Parameter } from "./types";

/** Steps between the ends, at least. */
const STEPS = 100;

/** Where there is no bound: half the value to each side, of 0 the size of a ring. */
function ends({ value, min, max }: Parameter, R: number): [number, number] {
  const half = Math.abs(value) / 2 || R;
  return [min ?? Math.min(value, max ?? value) - half, max ?? Math.max(value, min ?? value) + half];
}

/** The changes of a design file that give its parameters these values. */
export function written(parameters: Record<string, number>): Change[] {
  return Object.entries(parameters).map(([name, x]) => ({ field: `parameters.${name}`, value: toml(x) }));
}

export class ParameterSliders {
  readonly node = h("div", { class: "parameters", role: "group", "aria-label": "Parameters", hidden: true });
  private sliders: [string, Slider][] = [];
  private links = h("div", { class: "problems", role: "status", "aria-live": "polite" });
  private key = "";

  constructor(
    private side: Side,
    private set: (name: string, value: number) => void,
    /** Whether changed links are named, too. */
    private named = true,
  ) {}

  draw(): void {
    const { side } = this;
    const free = side.design?.parameters?.filter((p) => p.formula == null) ?? [];
    this.node.hidden = !free.length;
    // The ends stay while a value moves.
    const key = JSON.stringify([side.base?.name, free.map(({ name, min, max }) => [name, min, max])]);
    if (key !== this.key) {
      this.key = key;
      this.sliders = free.map((p) => [p.name, this.slider(p)]);
      this.node.replaceChildren(...this.sliders.map(([, slider]) => slider.node), this.links);
    }
    for (const [name, slider] of this.sliders) {
      const value = side.parameters[name] ?? free.find((p) => p.name === name)?.value ?? 0;
      slider.set(value, short(value, 4));
    }
    this.links.replaceChildren(...(this.named && free.length ? changedList(side) : []));
  }

  private slider(parameter: Parameter): Slider {
    const { name } = parameter;
    const R = this.side.design?.reference_radius ?? 1;
    const shown = { ...parameter, value: this.side.parameters[name] ?? parameter.value };
    const [min, max] = ends(shown, R);
    const step = 10 ** Math.floor(Math.log10((max - min) / STEPS));
    return new Slider(name, [min, max, step], (x) => this.set(name, x));
  }
}
