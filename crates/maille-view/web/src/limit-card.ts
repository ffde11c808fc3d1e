// The limit that is chosen, in numbers.

import { h, short } from "./dom";
import { reached } from "./limits";
import type { Side } from "./side";
import type { ViewState } from "./state";
import type { Frames } from "./frames";
import type { End, Frame, Limit } from "./types";

export class LimitCard {
  readonly node = h("div", { class: "card", "aria-live": "polite" });
  private drawn = "";

  constructor(private state: ViewState) {}

  draw(): void {
    const { a, b, mode } = this.state;
    const two = mode === "compare";
    const shown = (side: Side) => side.frames?.index(this.state.placeOf(side));
    const second = two && [b.chosen?.row, b.choice, b.own?.name, b.source, shown(b)];
    // What stands there already is not read out again.
    const key = JSON.stringify([a.chosen?.row, a.choice, a.problems.length, a.source, shown(a), second]);
    if (key === this.drawn) return;
    this.drawn = key;
    this.node.replaceChildren(...(two ? this.compared() : [this.entry("", a)]));
  }

  private compared(): HTMLElement[] {
    const { a, b } = this.state;
    const entries = [this.entry(`${nameOf(a)}: `, a), this.entry(`${nameOf(b)}: `, b)];
    const between = a.frames && b.frames ? differenceOfFrames(...this.frames(a, b)) : differenceOfLimits(a, b);
    return [...entries, ...(between.length ? [card("difference, second − first", between, "difference")] : [])];
  }

  private frames(...sides: [Side, Side]): [Frame, Frame] {
    return sides.map((side) => side.frames!.at(this.state.placeOf(side))) as [Frame, Frame];
  }

  private entry(name: string, side: Side): HTMLElement {
    return side.frames ? frameEntry(name, side.frames, this.state.placeOf(side)) : entry(name, side);
  }
}

/** What tells one of two sheets from the other. */
function nameOf(side: Side): string {
  return side.source ?? side.own?.name ?? "";
}

function card(title: string, facts: [string, string][], kind = ""): HTMLElement {
  const list = facts.flatMap(([term, said]) => [h("dt", {}, term), h("dd", {}, said)]);
  return h("div", { class: kind }, h("p", { class: "where" }, title), h("dl", {}, ...list));
}

const signed = (x: number, digits: number) => (x > 0 ? "+" : "") + short(x, digits);

function differenceOfLimits(a: Side, b: Side): [string, string][] {
  const [first, second] = [a, b].map((side) => side.chosen && reached(side.chosen));
  if (first == null || second == null) return [];
  const part = (100 * (second - first)) / (1 + first);
  const out: [string, string][] = [
    ["l₁", signed(second - first, 9)],
    ["length of the sheet", `${signed(part, 4)} %`],
  ];
  const [l2, other] = [a.chosen!.row.l2, b.chosen!.row.l2];
  if (l2 !== other) out.push(["l₂, which is held", signed(other - l2, 6)]);
  return out;
}

function differenceOfFrames(first: Frame, second: Frame): [string, string][] {
  const both = (x: number | null, y: number | null) => (x === null || y === null ? "–" : signed(y - x, 6));
  if (first.roll !== null || second.roll !== null) return [["stretch", both(first.stretch, second.stretch)]];
  const out: [string, string][] = [["share of the pull", `${signed(100 * (second.share - first.share), 2)} %`]];
  out.push(["stretch", both(first.stretch, second.stretch)]);
  out.push(["mean force", both(first.mean_force, second.mean_force)]);
  out.push(["energy, β R²", both(first.energy, second.energy)]);
  return out;
}

const ENDS: Record<End, string> = {
  reached: "the pull was done",
  locked: "the sheet locked",
  "not-converged": "a step did not converge",
  interrupted: "it was interrupted",
};

function frameEntry(name: string, frames: Frames, t: number): HTMLElement {
  const { share, stretch, mean_force, energy, roll } = frames.at(t);
  const { end, note } = frames.simulation;
  const value = (x: number | null, digits: number) => (x === null ? "–" : short(x, digits));
  if (roll !== null) return card(`${name}${roll}`, [["stretch along the direction", value(stretch, 6)]]);
  const facts: [string, string][] = [
    ["stretch between the pulled places", value(stretch, 6)],
    ["mean force on a pulled element", value(mean_force, 6)],
    ["energy, β R²", value(energy, 6)],
    ["how it ended", ENDS[end]],
  ];
  const out = card(`${name}${short(100 * share, 2)} % of the pull`, facts);
  if (note) out.append(h("p", { class: "note" }, note));
  return out;
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
