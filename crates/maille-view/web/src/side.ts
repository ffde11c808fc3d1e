// One sheet with its limits: what was opened, what the sliders say, what is solved.

import * as api from "./api";
import { calm } from "./dom";
import type { Drawing } from "./drawing";
import { Frames } from "./frames";
import { halfTurn, reached, sameDirection, widths, type Choice } from "./limits";
import { changedLinks, type ChangedLink } from "./links";
import type { Design, Limit, ListedProblem, Refused, Sheet, Shown, Subject } from "./types";

const SESSION = Math.random().toString(36).slice(2);
/** What changes the start. */
const GEOMETRY = ["minorRadius", "spacing", "parameters", "text"] as const;
type Geometry = (typeof GEOMETRY)[number];
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
  /** Values of parameters in place of the file's. */
  parameters: Record<string, number> = {};
  l2 = 0;
  free = false;
  /** The design as the file says, and its start as the sliders say. */
  design: Design | null = null;
  own: Sheet | null = null;
  problems: ListedProblem[] = [];
  /** Start of the design when it was opened or saved: its links are to be kept. */
  base: Sheet | null = null;
  limits: Limit[] = [];
  old: Limit[] = [];
  sheets = new Map<string, Sheet>();
  /** Name of the record that the limits are of, if nothing was solved. */
  source: string | null = null;
  /** The states of a simulation, if one was opened. */
  frames: Frames | null = null;
  /** Whether `own` is the sheet of the text as it is now. */
  readable = true;
  total = 0;
  running = false;
  failure: Refused | null = null;
  choice: Choice | null = null;

  private judging: AbortController | null = null;
  private solving: AbortController | null = null;
  private asking: AbortController | null = null;
  // By then a record may have been opened, of which nothing is solved.
  private later = calm(140, () => void (this.source === null && this.solve()));
  /** While a design is drawn or edited, nothing is solved. */
  private resting = false;
  private unsolved = false;

  constructor(
    readonly id: string,
    /** Whether there is no server. */
    private alone: boolean,
    private changed: () => void,
  ) {}

  /** Opens a design, with what its record holds if it has one. A choice that the record has, too, is kept. */
  async open(shown: Shown): Promise<void> {
    this.cancel();
    const { choice } = this;
    Object.assign(this, { name: shown.name, file: shown.file, text: shown.text, minorRadius: null, spacing: null });
    this.parameters = { ...shown.parameters };
    Object.assign(this, {
      base: null,
      own: null,
      limits: [],
      old: [],
      failure: null,
      problems: [],
      source: null,
      frames: null,
      readable: true,
      choice: null,
      total: 0,
      unsolved: false,
    });
    this.sheets.clear();
    if (shown.simulation) {
      this.frames = new Frames(shown.simulation, this.subject);
      this.source = shown.simulation.source;
      this.own = this.base = shown.simulation.sheet;
      return this.changed();
    }
    if (shown.map) {
      this.take(shown.map.source, shown.map.sheets, shown.map.limits);
      this.choice = choice;
      if (!this.chosen) this.choice = null;
      this.changed();
      // What the sliders start from; a bundle has none.
      if (!this.alone) await this.judge();
      return;
    }
    if (await this.judge()) this.solveLater();
  }

  /** Solves nothing until `resting` is false. */
  rest(resting: boolean): void {
    this.resting = resting;
    if (!resting && this.unsolved) this.solveLater();
  }

  private solveLater(): void {
    this.unsolved = this.resting;
    if (!this.resting) this.later();
  }

  private take(source: string, sheets: Sheet[], limits: Limit[]): void {
    this.source = source;
    for (const sheet of sheets) this.sheets.set(sheet.cell, sheet);
    this.own = this.base = sheets[0] ?? null;
    this.limits = limits;
    this.total = limits.length;
    this.free = limits[0]?.row.lateral === "free";
    const l2s = widths(limits);
    this.l2 = l2s.includes(0) ? 0 : (l2s[0] ?? 0);
  }

  get subject(): Subject {
    const { name, text, minorRadius: minor_radius, spacing, parameters } = this;
    return { name, text, minor_radius, spacing, parameters };
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
      this.readable = judged.sheet !== null;
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
  async change(what: Partial<Pick<Side, Geometry | "l2" | "free">>): Promise<void> {
    if (this.frames) return; // nothing of a simulation is solved anew
    Object.assign(this, what);
    this.cancel();
    this.source = null;
    const geometry = GEOMETRY.some((field) => field in what);
    if (this.limits.length) this.old = this.limits;
    this.limits = [];
    if (geometry) this.sheets.clear();
    this.total = 0;
    if (this.choice) this.choice = { ...this.choice, l2: this.free ? 0 : this.l2 };
    this.changed();
    if (geometry ? await this.judge() : !this.problems.length) this.solveLater();
  }

  /** A parameter was dragged; one that has the file's value again is left to the file. */
  setParameter(name: string, value: number): Promise<void> {
    const { [name]: _, ...others } = this.parameters;
    const usual = this.design?.parameters?.find((p) => p.name === name)?.value;
    return this.change({ parameters: value === usual ? others : { ...others, [name]: value } });
  }

  fail(error: unknown): void {
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
    if (this.chosen || this.source !== null || this.problems.length || this.resting) return;
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

  /** The cells to draw of those that are asked for: a chain is one cell wide. */
  cells(tile: [number, number]): [number, number] {
    return this.design?.lattice.single ? [tile[0], 1] : tile;
  }

  /** What is drawn at `t`, between the start and the limit, or between the first state of a simulation and the last. */
  drawn(t: number): Pick<Drawing, "sheet" | "limit" | "t"> | null {
    if (this.frames) return { sheet: this.frames.simulation.sheet, limit: this.frames.posed(t), t: 1 };
    if (this.locked && t > 0) return { ...this.locked, t };
    return this.own && { sheet: this.own, limit: null, t: 0 };
  }

  /** Asks for the gaps of the state of a simulation that is drawn, if they are not known. */
  measure(t: number): void {
    if (!this.frames || this.alone) return;
    this.frames.measure(t).then(this.changed, (error: unknown) => this.fail(error));
  }

  /** The wire of the rings that give none of their own, as it is drawn. */
  get wire(): number | null {
    const common = this.design?.minor_radius ?? null;
    if (this.minorRadius !== null || common === null) return this.minorRadius;
    const ring = this.design?.elements.flatMap((e) => e.rings).findIndex((r) => r.minor_radius == null) ?? -1;
    return this.own?.rings[ring]?.minor_radius ?? common;
  }

  /** The links that the design has now are those to keep. */
  keepLinks(): void {
    this.base = this.own;
    this.changed();
  }

  /** Links that the design had when it was opened and has no more, and new ones. */
  get changedLinks(): ChangedLink[] {
    return this.frames || !this.readable ? [] : changedLinks(this.base, this.own);
  }

  /** The command that gives the chosen number. */
  get command(): string {
    const quoted = (text: string) => (/[^\w./+-]/.test(text) ? `'${text}'` : text);
    if (this.frames) {
      const pulled = this.frames.simulation.frames[0]?.roll === null;
      return pulled ? `maille plot ${quoted(this.name)} --kind force` : `maille table ${quoted(this.name)}`;
    }
    if (this.source !== null) {
      const place = this.choice ? ` --where 'direction_deg=${this.choice.direction},l2=${this.choice.l2}'` : "";
      return `maille table ${quoted(this.source)}${place}`;
    }
    const direction = this.choice ? this.choice.direction : "0:180:5";
    const l2 = this.choice?.l2 ?? this.l2;
    const set = Object.entries(this.parameters).map(([name, value]) => ` --set ${name}=${value}`);
    const radius = this.minorRadius === null ? "" : ` --minor-radius ${this.minorRadius}`;
    const width = this.free ? "--lateral free" : `--l2 ${l2}`;
    return `maille characterize ${quoted(this.name)}${set.join("")}${radius} --directions ${direction} ${width}`;
  }
}
