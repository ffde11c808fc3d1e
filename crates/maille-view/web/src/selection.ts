// The element that is drawn on.

export class Selection {
  index: number | null = null;
  /** Direction, degrees, that a flat ring will lean to when it is tilted. */
  turn = 0;

  constructor(private changed: () => void) {}

  pick(index: number | null): void {
    if (index === this.index) return;
    this.index = index;
    this.turn = 0;
    this.changed();
  }
}
