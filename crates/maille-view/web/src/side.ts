// One sheet with its limits: what was opened, what the sliders say, what is solved.

import * as api from "./api";
import { calm } from "./dom";
import { halfTurn, reached, sameDirection, type Choice } from "./limits";
import type { Design, Limit, ListedProblem, Refused, Sheet, Shown, Subject } from "./types";

const SESSION = Math.random().toString(36).slice(2);
const COARSE = 15;
const FINE = 5;

/** Directions of the map: coarse ones first, so that its shape is soon known. */
function directions(step: number, without: number): number[] {
  const out: number[] = [];
  for (let d = 0; d < 180; d += step) if (!without || d % without) out.push(d);
  return out;
}

export class Side {
  name = "";
  file: string | null = null;
  text = "";
  /** What the sliders change. */
  minorRadius: number | null = null;
  spacing: number | null = null;
  l2 = 0;
  free = false;
  /** The design as the file says, and its start as the sliders say. */
  design: Design | null = null;
  own: Sheet | null = null;
  problems: ListedProblem[] = [];
  /** Start of the design when it was opened: its links are to be kept. */
  base: Sheet | null = null;
  limits: Limit[] = [];
  old: Limit[] = [];
  sheets = new Map<string, Sheet>();
  /** Name of the record that the limits are of, if nothing was solved. */
  source: string | null = null;
  total = 0;
  running = false;
  failure: Refused | null = null;
  choice: Choice | null = null;

  private judging: AbortController | null = null;
  private solving: AbortController | null = null;
  private asking: AbortController | null = null;
  private later = calm(140, () => void this.solve());

  constructor(
    readonly id: string,
    /** Whether there is no server. */
    private alone: boolean,
    private changed: () => void,
  ) {}

  /** Opens a design, with the limits of its record if it has one. */
  async open(shown: Shown): Promise<void> {
    this.cancel();
    Object.assign(this, { name: shown.name, file: shown.file, text: shown.text, minorRadius: null, spacing: null });
    Object.assign(this, {
      base: null,
      own: null,
      limits: [],
      old: [],
      failure: null,
      problems: [],
      source: null,
      choice: null,
      total: 0,
    });
    this.sheets.clear();
    if (shown.map) {
      this.take(shown.map.source, shown.map.sheets, shown.map.limits);
      this.changed();
      // What the sliders start from; a bundle has none.
      if (!this.alone) await this.judge();
      return;
    }
    if (await this.judge()) this.later();
  }

  private take(source: string, sheets: Sheet[], limits: Limit[]): void {
    this.source = source;
    for (const sheet of sheets) this.sheets.set(sheet.cell, sheet);
    this.own = this.base = sheets[0] ?? null;
    this.limits = limits;
    this.total = limits.length;
    this.free = limits[0]?.row.lateral === "free";
    const l2s = [...new Set(limits.map((l) => l.row.l2))];
    this.l2 = l2s.includes(0) ? 0 : (l2s[0] ?? 0);
  }

  get subject(): Subject {
    return { name: this.name, text: this.text, minor_radius: this.minorRadius, spacing: this.spacing };
  }

  /** Asks what is wrong with the design, and what it looks like. False if it cannot be solved, or this is old. */
  async judge(): Promise<boolean> {
    this.judging?.abort();
    const mine = new AbortController();
    this.judging = mine;
    try {
      const judged = await api.judge(this.subject, mine.signal);
      if (mine.signal.aborted) return false;
      this.problems = judged.problems;
      this.design = judged.design ?? this.design;
      this.own = judged.sheet ?? this.own;
      this.base ??= judged.sheet;
      this.failure = null;
      this.changed();
      return !judged.problems.length && judged.sheet !== null;
    } catch (error) {
      if (!mine.signal.aborted) this.fail(error);
      return false;
    }
  }

  /** Something was dragged: the start is shown at once, the limits follow. Whatever was under way is dropped. */
  async change(what: Partial<Pick<Side, "minorRadius" | "spacing" | "l2" | "free" | "text">>): Promise<void> {
    Object.assign(this, what);
    this.cancel();
    this.source = null;
    const geometry = "minorRadius" in what || "spacing" in what || "text" in what;
    if (this.limits.length) this.old = this.limits;
    this.limits = [];
    if (geometry) this.sheets.clear();
    this.total = 0;
    if (this.choice) this.choice = { ...this.choice, l2: this.free ? 0 : this.l2 };
    this.changed();
    if (geometry ? await this.judge() : !this.problems.length) this.later();
  }

  private fail(error: unknown): void {
    this.failure = error instanceof api.Refusal ? error.refused : { problem: String(error), help: "", problems: [] };
    this.running = false;
    this.changed();
  }

  /** Ends what is being solved. */
  cancel(): void {
    this.solving?.abort();
    this.asking?.abort();
    this.running = false;
  }

  /** The map: what is chosen and every 15 degrees first, then every 5. */
  async solve(): Promise<void> {
    this.cancel();
    const mine = new AbortController();
    this.solving = mine;
    this.running = true;
    this.limits = [];
    const first = directions(COARSE, 0);
    const chosen = this.choice?.direction;
    if (chosen !== undefined && chosen % FINE) first.unshift(chosen);
    const parts = [first, directions(FINE, COARSE)];
    this.total = first.length + parts[1]!.length;
    this.changed();
    try {
      for (const part of parts) await this.stream(this.id, part, mine.signal);
      if (mine.signal.aborted) return;
      this.running = false;
      this.old = [];
      this.changed();
    } catch (error) {
      if (!mine.signal.aborted) this.fail(error);
    }
  }

  private stream(slot: string, list: number[], signal: AbortSignal): Promise<void> {
    const l2 = [this.free ? 0 : this.l2];
    const request = {
      slot: `${SESSION}-${slot}`,
      subject: this.subject,
      directions_deg: list,
      l2,
      lateral_free: this.free,
    };
    return api.solve(request, signal, (event) => {
      if ("begun" in event) return;
      if ("sheet" in event) this.sheets.set(event.sheet.cell, event.sheet);
      if ("limit" in event) this.add(event.limit);
      if ("failed" in event) this.failure = event.failed;
      this.changed();
    });
  }

  private add(limit: Limit): void {
    const { direction_deg, l2 } = limit.row;
    this.limits = this.limits.filter((l) => l.row.direction_deg !== direction_deg || l.row.l2 !== l2);
    this.limits.push(limit);
  }

  /** Chooses a direction; a limit that is not known is asked for. */
  async choose(direction: number, l2: number | null): Promise<void> {
    direction = halfTurn(direction);
    this.choice = { direction, l2: l2 ?? this.choice?.l2 ?? (this.free ? 0 : this.l2) };
    this.changed();
    if (this.chosen || this.source !== null || this.problems.length) return;
    this.asking?.abort();
    const mine = new AbortController();
    this.asking = mine;
    try {
      await this.stream(`${this.id}-one`, [direction], mine.signal);
    } catch (error) {
      if (!mine.signal.aborted) this.fail(error);
    }
  }

  /** The limit that is chosen, if it is there and has a state. */
  get chosen(): Limit | null {
    const choice = this.choice;
    if (!choice) return null;
    const fits = (l: Limit) => sameDirection(l.row.direction_deg, choice.direction) && l.row.l2 === choice.l2;
    return this.limits.find(fits) ?? null;
  }

  /** The chosen limit, if its state can be shown in a cell that is known. */
  get locked(): { limit: Limit; sheet: Sheet } | null {
    const limit = this.chosen;
    const sheet = limit && this.sheets.get(limit.row.cell);
    return limit && sheet && reached(limit) !== null && limit.state.poses.length ? { limit, sheet } : null;
  }

  /** Links that the design had when it was opened, and has no more. */
  get lost(): { a: number; b: number; shift: [number, number]; words: string }[] {
    const { base, own } = this;
    if (!base || !own || base === own) return [];
    const ringName = (sheet: Sheet, ring: number) => {
      const { element } = sheet.rings[ring]!;
      return `${sheet.poses[element]!.element}/${ring - sheet.first_ring[element]!}`;
    };
    const key = (sheet: Sheet, a: number, b: number, [i, j]: [number, number]) => {
      const [from, to] = [ringName(sheet, a), ringName(sheet, b)];
      // Of the two ways to write a pair, one.
      return from < to || (from === to && (i > 0 || (i === 0 && j > 0)))
        ? `${from} ${to} ${i},${j}`
        : `${to} ${from} ${-i || 0},${-j || 0}`;
    };
    const kept = new Set(own.pairs.filter((p) => p.number).map((p) => key(own, p.ring_a, p.ring_b, p.shift)));
    const find = (name: string) => own.rings.findIndex((_, ring) => ringName(own, ring) === name);
    return base.pairs.flatMap((p) => {
      if (!p.number || kept.has(key(base, p.ring_a, p.ring_b, p.shift))) return [];
      const [from, to] = [ringName(base, p.ring_a), ringName(base, p.ring_b)];
      const [a, b] = [find(from), find(to)];
      const cell = p.shift.some(Boolean) ? ` in cell (${p.shift.join(", ")})` : "";
      const words = `${from.replace("/0", "")} – ${to.replace("/0", "")}${cell}`;
      return a < 0 || b < 0 ? [] : [{ a, b, shift: p.shift, words }];
    });
  }

  /** The command that gives the chosen number. */
  get command(): string {
    const quoted = (text: string) => (/[^\w./+-]/.test(text) ? `'${text}'` : text);
    const direction = this.choice ? this.choice.direction : "0:180:5";
    const l2 = this.choice?.l2 ?? this.l2;
    const radius = this.minorRadius === null ? "" : ` --minor-radius ${this.minorRadius}`;
    const width = this.free ? "--lateral free" : `--l2 ${l2}`;
    return `maille characterize ${quoted(this.name)}${radius} --directions ${direction} ${width}`;
  }
}
