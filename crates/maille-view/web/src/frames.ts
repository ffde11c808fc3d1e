// The states of a simulated sheet: which is shown, and the gaps in it.

import * as api from "./api";
import type { Posed } from "./drawing";
import type { Frame, PoseRecord, ShownSimulation, Subject } from "./types";

export class Frames {
  /** How far elements come from the middle of the sheet, in any state. */
  readonly reach: number;
  private states: Posed[];
  private asked = new Set<number>();

  constructor(
    readonly simulation: ShownSimulation,
    private subject: Subject,
  ) {
    const { a1, a2 } = simulation.sheet;
    this.states = simulation.frames.map(({ poses }) => ({ state: { a1, a2, poses }, pairs: null }));
    this.reach = reach(simulation);
  }

  private get last(): number {
    return this.states.length - 1;
  }

  /** Index of the frame at `t` between the first, 0, and the last, 1. */
  index(t: number): number {
    return Math.round(t * this.last);
  }

  at(t: number): Frame {
    return this.simulation.frames[this.index(t)]!;
  }

  posed(t: number): Posed {
    return this.states[this.index(t)]!;
  }

  /** Where frame `index` stands between 0 and 1. */
  place(index: number): number {
    return this.last ? index / this.last : 0;
  }

  /** Frames as steps of a slider from 0 to 1. */
  get step(): number {
    return this.last ? 1 / this.last : 1;
  }

  /** The place of the frame whose share of the pull is nearest to `share`. */
  nearest(share: number): number {
    const far = this.simulation.frames.map((frame) => Math.abs(frame.share - share));
    return this.place(far.indexOf(Math.min(...far)));
  }

  /** Asks once for the gaps of the state at `t`. */
  async measure(t: number): Promise<void> {
    const index = this.index(t);
    if (this.asked.has(index)) return;
    this.asked.add(index);
    const { state } = this.states[index]!;
    const { a1, a2, poses } = state;
    const { subject } = this;
    const pairs = await api.measure({ subject, cell: this.simulation.sheet.cell, finite: true, a1, a2, poses });
    this.states[index] = { state, pairs };
  }
}

function reach({ sheet, frames }: ShownSimulation): number {
  const middle = [0, 1, 2].map((k) => sheet.poses.reduce((sum, p) => sum + p.position[k]!, 0) / sheet.poses.length);
  const far = (poses: PoseRecord[]) =>
    poses.reduce((most, { position: p }) => Math.max(most, Math.hypot(...p.map((x, k) => x - middle[k]!))), 0);
  return Math.max(...frames.map((frame) => far(frame.poses))) + 2 * sheet.reference_radius;
}
