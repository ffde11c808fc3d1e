// Files of what is shown, written by the program.

import * as api from "./api";
import { h } from "./dom";
import type { ViewState } from "./state";
import type { Export, LimitRow, StateRecord } from "./types";

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

/** A state of which the poses alone are known. */
const NO_STATE: Pick<StateRecord, "direction_deg" | "l2" | "status" | "deformation_gradient" | "residual"> = {
  direction_deg: 0,
  l2: 0,
  status: "not-converged",
  deformation_gradient: [
    [1, 0],
    [0, 1],
  ],
  residual: null,
};

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
    const { frames } = a;
    const request: Export = {
      format,
      subject: a.subject,
      tile: frames ? [1, 1] : a.cells(tile),
      state: frames ? { ...NO_STATE, ...frames.posed(t).state } : (limit?.state ?? null),
      cell: frames ? frames.simulation.sheet.cell : (limit?.row.cell ?? null),
      finite: frames !== null,
      rows: format === "csv" || format === "svg" ? this.rows() : [],
    };
    const of = limit ? `_dir${limit.row.direction_deg}_l2_${limit.row.l2}` : "";
    const shown = frames?.at(t);
    const rolled = shown && shown.roll !== null;
    const place = shown ? (rolled ? `-roll_${shown.number + 1}` : `-simulate_frame${shown.number}`) : of;
    const name = (a.own?.name ?? "sheet").replace(/[^\w.-]/g, "_");
    this.said.textContent = "writing …";
    try {
      const url = URL.createObjectURL(await api.exported(request));
      h("a", { href: url, download: `${name}${place}.${format}` }).click();
      setTimeout(() => URL.revokeObjectURL(url), KEEP_MS);
      const what = rolled ? "the roll is" : shown ? `frame ${shown.number} is` : limit ? "the locked state is" : "the start is";
      this.said.textContent = format === "csv" || format === "svg" ? "the limits are written" : `${what} written`;
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
