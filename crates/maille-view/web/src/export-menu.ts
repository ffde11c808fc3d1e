// Files of what is shown, written by the program.

import * as api from "./api";
import { h } from "./dom";
import type { ViewState } from "./state";
import type { Export, LimitRow } from "./types";

const FORMATS: [format: string, label: string][] = [
  ["3mf", "3MF, to print"],
  ["stl", "STL"],
  ["glb", "GLB, to show"],
  ["obj", "OBJ"],
  ["ply", "PLY"],
  ["png", "PNG, a picture"],
  ["csv", "CSV, the limits"],
  ["svg", "SVG, the map"],
];

/** How long a download may take to begin. */
const KEEP_MS = 10_000;

export class ExportMenu {
  readonly node: HTMLElement;
  private said = h("span", { class: "said", role: "status" });

  constructor(private state: ViewState) {
    const item = (format: string, label: string) =>
      h("button", { type: "button", onclick: () => void this.export(format) }, label);
    this.node = h(
      "details",
      { class: "menu" },
      h("summary", {}, "Export"),
      h("div", { class: "items" }, ...FORMATS.map(([format, label]) => item(format, label)), this.said),
    );
  }

  private async export(format: string): Promise<void> {
    const { a, t, tile } = this.state;
    const limit = t === 1 ? (a.locked?.limit ?? null) : null;
    const request: Export = {
      format,
      subject: a.subject,
      tile,
      state: limit?.state ?? null,
      cell: limit?.row.cell ?? null,
      rows: format === "csv" || format === "svg" ? this.rows() : [],
    };
    const place = limit ? `_dir${limit.row.direction_deg}_l2_${limit.row.l2}` : "";
    const name = (a.own?.name ?? "sheet").replace(/[^\w.-]/g, "_");
    this.said.textContent = "writing …";
    try {
      const url = URL.createObjectURL(await api.exported(request));
      h("a", { href: url, download: `${name}${place}.${format}` }).click();
      setTimeout(() => URL.revokeObjectURL(url), KEEP_MS);
      this.said.textContent = limit ? "the locked state is written" : "the start is written";
    } catch (error) {
      const refused = error instanceof api.Refusal ? error.refused : { problem: String(error), help: "" };
      this.said.textContent = `${refused.problem}. ${refused.help}`;
    }
  }

  private rows(): LimitRow[] {
    const rows = this.state.a.limits.map((l) => l.row);
    return rows.sort((x, y) => x.l2 - y.l2 || x.direction_deg - y.direction_deg);
  }
}
