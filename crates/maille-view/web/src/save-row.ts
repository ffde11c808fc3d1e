// The name of the design file, and the button that writes it.

import * as api from "./api";
import { plainName } from "./design-text";
import { h } from "./dom";
import type { Side } from "./side";

export class SaveRow {
  readonly node: HTMLElement;
  private fileName: HTMLInputElement;
  private said = h("span", { class: "said", role: "status" });
  private drawn = "";
  /** The text that what is said is about. */
  private saidOf = "";

  constructor(
    private side: Side,
    ...before: HTMLElement[]
  ) {
    this.fileName = h("input", { type: "text", "aria-label": "File name", class: "file" });
    const save = h("button", { type: "button", class: "primary", onclick: () => void this.save(false) }, "Save");
    this.node = h("div", { class: "row" }, ...before, this.fileName, save, this.said);
  }

  say(text: string, ...more: Node[]): void {
    this.saidOf = this.side.text;
    this.said.replaceChildren(text, ...more);
  }

  refuse(error: unknown): void {
    const refused = error instanceof api.Refusal ? error.refused : { problem: String(error), help: "" };
    this.say(`${refused.problem}${refused.help ? ` — ${refused.help}` : ""}`);
  }

  private async save(overwrite: boolean): Promise<void> {
    const { side } = this;
    // The path that was opened stays as it is.
    if (this.fileName.value !== side.file) this.fileName.value = plainName(this.fileName.value);
    try {
      const saved = await api.save({ file: this.fileName.value, text: side.text, overwrite });
      side.keepLinks();
      const wrong = side.problems.length ? ", though it has problems" : "";
      this.say(`saved ${saved.name}${wrong}`);
    } catch (error) {
      this.refuse(error);
      if (error instanceof api.Refusal && error.status === 409) {
        this.said.append(" ", h("button", { type: "button", onclick: () => void this.save(true) }, "Replace it"));
      }
    }
  }

  draw(): void {
    const { side } = this;
    if (!this.fileName.value || this.drawn !== side.name) {
      const plain = plainName(side.name.split("/").at(-1) ?? side.name);
      this.fileName.value = side.file ?? (plain.endsWith(".toml") ? plain : `${plain}.toml`);
    }
    this.drawn = side.name;
    if (this.saidOf !== side.text) this.said.replaceChildren();
  }
}
