// The limit that is chosen, in numbers.

import { h, short } from "./dom";
import { reached } from "./limits";
import type { Side } from "./side";
import type { ViewState } from "./state";
import type { Limit } from "./types";

export class LimitCard {
  readonly node = h("div", { class: "card", "aria-live": "polite" });
  private drawn = "";

  constructor(private state: ViewState) {}

  draw(): void {
    const { a, b, mode } = this.state;
    const two = mode === "compare";
    const second = two && [b.chosen?.row, b.choice, b.own?.name];
    // What stands there already is not read out again.
    const key = JSON.stringify([a.chosen?.row, a.choice, a.problems.length, a.source, second]);
    if (key === this.drawn) return;
    this.drawn = key;
    const entries = two ? [entry(`${a.own?.name}: `, a), entry(`${b.own?.name ?? ""}: `, b)] : [entry("", a)];
    this.node.replaceChildren(...entries);
  }
}

function entry(name: string, side: Side): HTMLElement {
  const { choice, chosen: limit } = side;
  if (!choice) return hint("Click the map, or choose a direction, to see the sheet lock.");
  const width = side.free || limit?.row.lateral === "free" ? "width free" : `l₂ = ${short(choice.l2)}`;
  const where = `${short(choice.direction)}°, ${width}`;
  if (limit) return numbers(name, where, limit);
  if (side.source !== null) return hint(`no limit at ${where} in this record`);
  return hint(`${where}: ${side.problems.length ? "the design cannot be solved" : "solving …"}`);
}

function hint(words: string): HTMLElement {
  return h("p", { class: "hint" }, words);
}

function numbers(name: string, where: string, limit: Limit): HTMLElement {
  const { row, state } = limit;
  const value = reached(limit);
  const big = value === null ? ["no limit", row.status] : [`× ${short(1 + value, 4)}`, "of its length"];
  return h(
    "div",
    {},
    h("p", { class: "where" }, name, where),
    h("p", { class: "big" }, big[0], h("span", {}, big[1])),
    value === null ? null : exact(value),
    h("dl", {}, ...facts(limit).flatMap(([term, said]) => [h("dt", {}, term), h("dd", {}, said)])),
    state.note ? h("p", { class: "note" }, state.note) : null,
  );
}

function exact(value: number): HTMLElement {
  const digits = String(value);
  return h("p", { class: "exact" }, "l₁ = ", h("data", { class: "l1", value: digits }, digits.replace("-", "−")));
}

function facts({ row, state }: Limit): [string, string][] {
  const kind = row.bound_kind ? ` (${row.bound_kind})` : "";
  const out: [string, string][] = [
    ["status", row.status],
    ["proven bound", row.bound_l1 === null ? "none" : `${short(row.bound_l1, 9)}${kind}`],
    ["cell", row.cell],
    ["contacts that carry force", String(state.contacts?.length ?? 0)],
  ];
  if (row.lateral === "free" && row.l2_min !== null) {
    out.push(["l₂ found", `${short(row.l2_min)} to ${short(row.l2_max ?? row.l2_min)}`]);
  }
  return out;
}
