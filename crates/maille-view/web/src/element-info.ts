// The element that is picked: its load, its neighbours, their gaps.

import { h, short } from "./dom";
import { pairsOf } from "./drawing";
import { loads, slack } from "./limits";
import type { ViewState } from "./state";
import type { Pair, Sheet } from "./types";

/** Most neighbours that are listed. */
const MOST = 14;

interface Neighbour {
  name: string;
  /** Linking numbers of the links to it. */
  numbers: number[];
  /** Smallest gap to it. */
  gap: number;
}

export class ElementInfo {
  readonly node = h("div", { class: "info", hidden: true });

  constructor(private state: ViewState) {}

  draw(): void {
    const { a, picked, t: place, mode } = this.state;
    const drawn = a.drawn(place);
    const pose = picked === null ? undefined : drawn?.sheet.poses[picked];
    this.node.hidden = !pose || mode === "draw";
    if (picked === null || !drawn || !pose) return;
    const { sheet, limit, t } = drawn;
    const pairs = pairsOf(drawn);
    const close = h("button", { type: "button", onclick: () => this.state.pick(null) }, "Close");
    const unknown = limit && t < 1 ? "interpolated: no gaps are known here" : "the gaps of this state are not known";
    if (limit && (t < 1 || !limit.pairs)) {
      return this.node.replaceChildren(h("b", {}, pose.element), h("p", {}, unknown), close);
    }
    const room = slack(sheet, pairs)[picked]!;
    const load = limit?.state.contacts ? `; load ${short(loads(sheet, limit)[picked]!, 4)}` : "";
    const words = h("p", {}, `smallest gap ${Number.isFinite(room) ? short(room) : "–"}${load}`);
    this.node.replaceChildren(h("b", {}, pose.element), words, table(neighbours(sheet, pairs, picked)), close);
  }
}

/** Neighbours of an element in all cells, those with most links first, then the nearest. */
function neighbours(sheet: Sheet, pairs: Pair[], picked: number): Neighbour[] {
  const found = new Map<string, Neighbour>();
  for (const { ring_a, ring_b, shift, number, gap } of pairs) {
    const [a, b] = [sheet.rings[ring_a]!.element, sheet.rings[ring_b]!.element];
    for (const [own, other, sign] of [
      [a, b, 1],
      [b, a, -1],
    ] as const) {
      if (own !== picked) continue;
      const cell = shift.some(Boolean) ? ` (${shift.map((x) => short(sign * x || 0)).join(", ")})` : "";
      const name = `${sheet.poses[other]!.element}${cell}`;
      const entry = found.get(name) ?? { name, numbers: [], gap: Infinity };
      if (number) entry.numbers.push(number);
      entry.gap = Math.min(entry.gap, gap);
      found.set(name, entry);
    }
  }
  return [...found.values()].sort((x, y) => y.numbers.length - x.numbers.length || x.gap - y.gap).slice(0, MOST);
}

function table(rows: Neighbour[]): HTMLElement {
  const head = ["neighbour", "linking", "gap"].map((words) => h("th", { scope: "col" }, words));
  const signed = (n: number) => (n > 0 ? `+${n}` : `−${-n}`);
  const row = ({ name, numbers, gap }: Neighbour) => {
    const linking = numbers.length ? numbers.map(signed).join(", ") : "–";
    return h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, linking), h("td", {}, short(gap, 5)));
  };
  return h("table", {}, h("thead", {}, h("tr", {}, ...head)), h("tbody", {}, ...rows.map(row)));
}
