// Changes of a design: values by the program, one after the other, and back again.

import * as api from "./api";
import type { Side } from "./side";
import type { Change, Design } from "./types";

/** Steps back, at most. */
const MOST = 200;

interface Step {
  /** Steps of one key that wait are one step. */
  key: string;
  run: () => Promise<string>;
}

export class Draft {
  private waiting: Step[] = [];
  private past: string[] = [];
  private working = false;

  constructor(
    private side: Side,
    private refuse: (error: unknown) => void,
    /** Called when changes begin, and when all that was asked for has been done. */
    private onBusy: (busy: boolean) => void = () => {},
  ) {}

  /** Remembers the design as it is now. */
  remember(): void {
    if (this.past.at(-1) !== this.side.text) this.past.push(this.side.text);
    if (this.past.length > MOST) this.past.shift();
  }

  /** Whether changes are under way. */
  get busy(): boolean {
    return this.working;
  }

  get canUndo(): boolean {
    return this.past.some((text) => text !== this.side.text);
  }

  undo(): void {
    let text = this.past.pop();
    while (text === this.side.text) text = this.past.pop();
    if (text !== undefined) this.write(text);
  }

  /** Forgets what was before: another design was opened. */
  forget(): void {
    this.past = [];
  }

  /** Writes the whole text. */
  write(text: string, key = ""): void {
    this.add({ key, run: () => Promise.resolve(text) });
  }

  /**
   * Changes values, of the design as it is when its turn comes. Of changes with the same key that wait, as in a drag, the
   * last is made.
   */
  set(change: (design: Design) => Change[], key = ""): void {
    const run = () => {
      const { design, text } = this.side;
      return design ? api.edit(text, change(design)) : Promise.resolve(text);
    };
    this.add({ key, run });
  }

  private add(step: Step): void {
    if (step.key && this.waiting.at(-1)?.key === step.key) this.waiting.pop();
    this.waiting.push(step);
    if (!this.working) void this.work();
  }

  private async work(): Promise<void> {
    this.working = true;
    this.onBusy(true);
    for (let step = this.waiting.shift(); step; step = this.waiting.shift()) {
      try {
        await this.side.change({ text: await step.run(), minorRadius: null, spacing: null, parameters: {} });
      } catch (error) {
        this.refuse(error);
      }
    }
    this.working = false;
    this.onBusy(false);
  }
}
