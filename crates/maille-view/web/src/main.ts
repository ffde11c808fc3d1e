// The page: stages, map, controls. It shows and asks; limits and files come from the program.

import "./style.css";
import * as api from "./api";
import { h, short } from "./dom";
import { Editor } from "./editor";
import { LimitMap, reached, type Family } from "./map";
import { Side } from "./side";
import { loads, slack, Stage, type ColorBy } from "./stage";
import type { Export, Listed, Start } from "./types";

type Mode = "explore" | "edit" | "compare";

const COLORS = { a: ["#1b4f8f", "#2f77b4", "#6aa9d8"], b: ["#b3541e", "#d4602a", "#eaa06a"] };
const MOVE_MS = 900;
const calmly = window.matchMedia("(prefers-reduced-motion: reduce)").matches;

class Page {
  private a: Side;
  private b: Side;
  private mode: Mode = "explore";
  private t = 0;
  private tile: [number, number] = [8, 8];
  private colorBy: ColorBy = "element";
  private forces = true;
  private chain = true;
  private picked: number | null = null;
  private moving = 0;
  private waiting = false;
  private seen = "";

  private map = new LimitMap(
    (direction, l2) => this.choose(direction, l2),
    (step) => this.choose((this.a.choice?.direction ?? 0) + step, null),
  );
  private editor: Editor;
  private stages: { a: Stage; b: Stage | null };
  private boxes = { a: h("div", { class: "stage" }), b: h("div", { class: "stage second", hidden: true }) };

  // What is shown of the choice.
  private title = h("h1", {});
  private subtitle = h("p", { class: "subtitle" });
  private card = h("div", { class: "card", "aria-live": "polite" });
  private progress = h("div", { class: "progress" });
  private legend = h("div", { class: "legend" });
  private mapLegend = h("div", { class: "map-legend" });
  private notice = h("div", { class: "notice", role: "alert", hidden: true });
  private info = h("div", { class: "info", hidden: true });
  private way = h("output", { class: "way" });
  private scrub = h("input", {
    type: "range", min: 0, max: 1, step: 0.005, value: 0, "aria-label": "From the start to the limit",
    oninput: () => {
      cancelAnimationFrame(this.moving);
      this.t = Number(this.scrub.value);
      this.draw();
    },
  });
  private play = h("button", { type: "button", class: "play", "aria-label": "Play the pull", onclick: () => this.move(this.t < 1 ? 1 : 0, true) }, "▶");
  private sliders = new Map<string, { input: HTMLInputElement; output: HTMLOutputElement }>();
  private free = h("input", { type: "checkbox", onchange: () => void this.each((side) => side.change({ free: this.free.checked })) });
  private widths = h("div", { class: "chips", role: "group", "aria-label": "Width of the record" });
  private elements = h("select", { "aria-label": "Element", onchange: () => this.pick(this.elements.value === "" ? null : Number(this.elements.value)) });
  private command = h("code", { class: "command" });
  private exporting = h("span", { class: "said", role: "status" });
  private panel = h("aside", { class: "panel" });
  private tabs: HTMLButtonElement[] = [];
  private designs = h("select", { "aria-label": "Design", class: "design" });
  /** What was opened and is no built-in design. */
  private other = h("option", { value: "" });
  private compared: HTMLElement;

  constructor(private start: Start) {
    this.a = new Side("a", start.bundle, () => this.later());
    this.b = new Side("b", start.bundle, () => this.later());
    this.editor = new Editor(this.a, start.weaves);
    this.compared = this.compareControls();
    const root = document.getElementById("app")!;
    root.append(
      this.header(),
      h(
        "main",
        {},
        h(
          "section",
          { class: "view", "aria-label": "Sheet" },
          h("div", { class: "stages" }, this.boxes.a, this.boxes.b, this.info, this.legend, this.notice),
          h("div", { class: "scrubber" }, this.play, h("span", {}, "start"), this.scrub, h("span", {}, "limit"), this.way),
        ),
        this.panel,
      ),
    );
    this.panel.append(
      h("div", { class: "head" }, this.title, this.subtitle),
      h(
        "div",
        { class: "explore" },
        this.compared,
        h("div", { class: "map-box" }, this.map.node, this.mapLegend, this.map.tip, this.progress),
        this.card,
        this.controls(),
      ),
      start.bundle ? h("span") : this.editor.node,
    );
    this.stages = { a: new Stage(this.boxes.a, start.palette, "The sheet in 3D. Arrow keys turn it, plus and minus zoom.", (e) => this.pick(e)), b: null };
    this.setMode("explore");
    // For tests and measurements of the picture itself.
    Object.assign(window, { maille: { stage: this.stages.a, side: this.a } });
    void this.a.open(start.opened).then(() => this.draw());
  }

  private header(): HTMLElement {
    const { start } = this;
    const names: Listed[] = start.designs;
    const opened = start.opened;
    const options = names.map((d) => h("option", { value: d.name }, `${d.name}  ${d.title}`));
    this.other.textContent = opened.name;
    const select = this.designs;
    select.append(this.other, ...options);
    select.addEventListener("change", () => void this.open(select.value));
    const tab = (mode: Mode, label: string) => {
      const button = h("button", { type: "button", role: "tab", onclick: () => this.setMode(mode) }, label);
      button.dataset["mode"] = mode;
      this.tabs.push(button);
      return button;
    };
    const formats = ["3mf", "stl", "glb", "obj", "ply", "png", "csv", "svg"];
    const words: Record<string, string> = { "3mf": "3MF, to print", glb: "GLB, to show", png: "PNG, a picture", csv: "CSV, the limits", svg: "SVG, the map" };
    const exports = h(
      "details",
      { class: "menu" },
      h("summary", {}, "Export"),
      h("div", { class: "items" }, ...formats.map((f) => h("button", { type: "button", onclick: () => void this.export(f) }, words[f] ?? f.toUpperCase())), this.exporting),
    );
    return h(
      "header",
      {},
      h("span", { class: "mark", "aria-hidden": "true" }),
      h("span", { class: "name" }, "maille"),
      start.bundle ? null : select,
      start.bundle ? null : h("div", { class: "tabs", role: "tablist" }, tab("explore", "Explore"), tab("edit", "Edit"), tab("compare", "Compare")),
      start.bundle ? null : exports,
    );
  }

  private slider(name: string, label: string, min: number, max: number, step: number, onInput: (x: number) => void): HTMLElement {
    const output = h("output", {});
    const input = h("input", { type: "range", "aria-label": label, min, max, step, oninput: () => onInput(Number(input.value)) });
    this.sliders.set(name, { input, output });
    return h("label", { class: "slider" }, h("span", {}, label), input, output);
  }

  private controls(): HTMLElement {
    const choice = <T extends string>(label: string, values: [T, string][], set: (value: T) => void) => {
      const select = h("select", { "aria-label": label, onchange: () => set(select.value as T) }, ...values.map(([v, words]) => h("option", { value: v }, words)));
      return h("label", { class: "field" }, label, select);
    };
    const check = (label: string, set: (on: boolean) => void) => {
      const input = h("input", { type: "checkbox", checked: true, onchange: () => set(input.checked) });
      return h("label", { class: "check" }, input, label);
    };
    const bundle = this.start.bundle;
    const tiles: [string, string][] = ["4", "6", "8", "12", "16", "24", "41"].map((n) => [n, `${n} × ${n}`]);
    const tile = choice("Cells", tiles, (n) => {
      this.tile = [Number(n), Number(n)];
      this.draw();
    });
    tile.querySelector("select")!.value = "8";
    return h(
      "div",
      { class: "controls" },
      this.slider("direction", "Direction of pull", 0, 179, 1, (x) => this.choose(x, null)),
      this.widths,
      h(
        "div",
        { class: "solved", hidden: bundle },
        this.slider("l2", "Width held, l₂", -0.25, 0.25, 0.025, (x) => void this.each((side) => side.change({ l2: x, free: false }))),
        h("label", { class: "check" }, this.free, "width free, as in a pull test"),
        this.slider("wire", "Wire radius", 0, 1, 0.001, (x) => void this.a.change({ minorRadius: x })),
        this.slider("spacing", "Spacing", 0.8, 1.25, 0.005, (x) => void this.a.change({ spacing: x === 1 ? null : x })),
      ),
      h(
        "div",
        { class: "row" },
        tile,
        choice<ColorBy>("Colour by", [["element", "element"], ["load", "load"], ["slack", "slack"]], (v) => {
          this.colorBy = v;
          this.draw();
        }),
        h("label", { class: "field" }, "Element", this.elements),
      ),
      h("div", { class: "row" }, check("forces", (on) => this.draw((this.forces = on))), check("binding chain", (on) => this.draw((this.chain = on)))),
      bundle ? null : h("div", { class: "row command-row" }, this.command, h("button", { type: "button", onclick: () => void navigator.clipboard?.writeText(this.a.command) }, "Copy")),
    );
  }

  private compareControls(): HTMLElement {
    const select = h(
      "select",
      { "aria-label": "Second design", onchange: () => void api.builtin(select.value).then((text) => this.b.open({ ...text, file: null, map: null })) },
      ...this.start.designs.map((d) => h("option", { value: d.name }, `${d.name}  ${d.title}`)),
      this.start.designs.some((d) => d.name === this.start.opened.name) ? null : h("option", { value: "" }, this.start.opened.name),
    );
    const same = h("button", { type: "button", onclick: () => void this.same() }, "Same design");
    return h(
      "div",
      { class: "compared", hidden: true },
      h("p", { class: "second-head" }, "With"),
      h("div", { class: "row" }, h("label", { class: "field" }, "Second design", select), same),
      this.slider("wire-b", "Its wire radius", 0, 1, 0.001, (x) => void this.b.change({ minorRadius: x })),
    );
  }

  /** The first design once more, to change its wire. */
  private async same(): Promise<void> {
    const { name, file, text } = this.a;
    await this.b.open({ name, file, text, map: null });
    if (this.a.choice) await this.b.choose(this.a.choice.direction, null);
  }

  private async open(name: string): Promise<void> {
    this.picked = null;
    this.t = 0;
    await this.a.open(name === "" ? this.start.opened : { ...(await api.builtin(name)), file: null, map: null });
    this.draw();
  }

  private each(work: (side: Side) => Promise<void>): Promise<unknown> {
    return Promise.all([this.a, ...(this.mode === "compare" ? [this.b] : [])].map(work));
  }

  private setMode(mode: Mode): void {
    this.mode = mode;
    document.body.dataset["mode"] = mode;
    for (const tab of this.tabs) tab.setAttribute("aria-selected", String(tab.dataset["mode"] === mode));
    const two = mode === "compare";
    this.boxes.b.hidden = !two;
    this.compared.hidden = !two;
    if (two && !this.stages.b) {
      const { a } = this.stages;
      const b = (this.stages.b = new Stage(this.boxes.b, this.start.palette, "The second sheet in 3D", () => {}));
      // Both are seen from one side.
      a.onTurn = () => b.follow(a);
      b.onTurn = () => a.follow(b);
      void this.same();
    }
    this.move(mode !== "edit" && this.a.locked ? 1 : 0, false);
  }

  private choose(direction: number, l2: number | null): void {
    const whole = ((direction % 180) + 180) % 180;
    void this.each((side) => side.choose(whole, side === this.a ? l2 : null));
    this.move(1, this.t < 1);
  }

  private pick(element: number | null): void {
    this.picked = element === this.picked ? null : element;
    this.draw();
  }

  /** Moves to the start or to the limit. */
  private move(to: number, slowly: boolean): void {
    cancelAnimationFrame(this.moving);
    const from = this.t;
    if (!slowly || calmly) {
      this.t = to;
      return this.draw();
    }
    const begun = performance.now();
    const step = (now: number) => {
      // The limit is waited for.
      const x = Math.min(1, (now - begun) / (MOVE_MS * Math.max(0.2, Math.abs(to - from))));
      this.t = x === 1 ? to : from + (to - from) * x * x * (3 - 2 * x);
      this.draw();
      if (x < 1) this.moving = requestAnimationFrame(step);
    };
    this.moving = requestAnimationFrame(step);
  }

  private later(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  private async export(format: string): Promise<void> {
    const { a } = this;
    const locked = this.t === 1 ? a.locked : null;
    const request: Export = {
      format, subject: a.subject, tile: this.tile,
      state: locked?.limit.state ?? null, cell: locked?.limit.row.cell ?? null,
      rows: format === "csv" || format === "svg" ? [...a.limits].sort((x, y) => x.row.l2 - y.row.l2 || x.row.direction_deg - y.row.direction_deg).map((l) => l.row) : [],
    };
    const place = locked ? `_dir${locked.limit.row.direction_deg}_l2_${locked.limit.row.l2}` : "";
    this.exporting.textContent = "writing …";
    try {
      const url = URL.createObjectURL(await api.exported(request));
      h("a", { href: url, download: `${(a.own?.name ?? "sheet").replace(/[^\w.-]/g, "_")}${place}.${format}` }).click();
      setTimeout(() => URL.revokeObjectURL(url), 10_000);
      this.exporting.textContent = locked ? "the locked state is written" : "the start is written";
    } catch (error) {
      const refused = error instanceof api.Refusal ? error.refused : { problem: String(error), help: "" };
      this.exporting.textContent = `${refused.problem}. ${refused.help}`;
    }
  }

  private draw(_?: unknown): void {
    const { a } = this;
    if (!a.own) return this.notices();
    const second = this.mode === "compare" ? this.stages.b : null;
    for (const [side, stage] of [[a, this.stages.a], [this.b, second]] as const) {
      if (!stage || !side.own) continue;
      const locked = side.locked;
      const t = locked ? this.t : 0;
      stage.show({
        own: side.own, sheet: locked?.sheet ?? side.own, limit: locked?.limit ?? null, tile: this.tile, t,
        colorBy: this.colorBy, picked: side === a ? this.picked : null, forces: this.forces, chain: this.chain && t > 0,
        lost: side === a ? side.lost : [],
      });
    }
    document.title = `${a.own.name} – maille`;
    const known = this.start.designs.some((d) => d.name === a.name);
    if (!known) this.other.textContent = a.name;
    this.other.hidden = known && this.start.designs.some((d) => d.name === this.start.opened.name);
    this.designs.value = known ? a.name : "";
    this.title.textContent = a.own.name;
    this.subtitle.textContent = a.own.title;
    this.drawMap();
    this.drawCard();
    this.drawControls();
    this.drawInfo();
    this.drawLegend();
    if (!this.start.bundle && this.mode === "edit") this.editor.draw();
    this.notices();
  }

  private notices(): void {
    const { failure, problems } = this.a;
    const words = failure ? [failure.problem, failure.help] : this.mode !== "edit" && problems[0] ? [problems[0].problem, problems[0].help ?? ""] : null;
    this.notice.hidden = !words;
    if (words) this.notice.replaceChildren(h("b", {}, words[0] ?? ""), " ", words[1] ?? "");
  }

  private drawMap(): void {
    const families: Family[] = [];
    const add = (side: Side, colors: string[]) => {
      if (side.old.length && (side.running || side.problems.length || !side.limits.length)) families.push({ label: "", colors, limits: side.old, old: true });
      families.push({ label: side.own?.name ?? "", colors, limits: side.limits, old: false });
    };
    add(this.a, COLORS.a);
    if (this.mode === "compare") add(this.b, COLORS.b);
    this.map.draw(families, this.a.choice);
    const radius = (side: Side) => side.own && short(Math.min(...side.own.rings.map((r) => r.minor_radius)), 4);
    const key = (color: string, words: string) => h("span", { class: "key" }, h("i", { style: `background:${color}` }), words);
    const l2s = [...new Set(this.a.limits.map((l) => l.row.l2))].sort((x, y) => x - y);
    const pick = (k: number) => COLORS.a[Math.round((k / Math.max(1, l2s.length - 1)) * 2)]!;
    this.mapLegend.replaceChildren(
      ...(this.mode === "compare"
        ? [key(COLORS.a[0]!, `${this.a.own?.name}, r = ${radius(this.a)}`), key(COLORS.b[0]!, `${this.b.own?.name ?? "…"}, r = ${radius(this.b)}`)]
        : l2s.length > 1 ? l2s.map((l2, k) => key(pick(k), `l₂ = ${short(l2)}`)) : [h("span", { class: "key" }, "stretch 1 + l₁ along each direction of pull")]),
    );
    const side = this.a.running || this.mode !== "compare" ? this.a : this.b;
    this.progress.replaceChildren(
      ...(side.running
        ? [
            h("progress", { max: side.total, value: Math.min(side.limits.length, side.total), "aria-label": "Limits found" }),
            h("span", {}, `${side.limits.length} of ${side.total} limits`),
            h("button", { type: "button", onclick: () => { side.cancel(); this.draw(); } }, "Cancel"),
          ]
        : [h("span", {}, side.source !== null ? `${side.limits.length} limits of ${side.source}` : side.limits.length ? `${side.limits.length} limits` : side.problems.length ? "not solved" : "…")]),
    );
  }

  private drawCard(): void {
    const entry = (name: string, side: Side) => {
      const { choice, chosen: limit } = side;
      if (!choice) return h("p", { class: "hint" }, "Click the map, or choose a direction, to see the sheet lock.");
      const width = side.free || limit?.row.lateral === "free" ? "width free" : `l₂ = ${short(choice.l2)}`;
      const where = `${short(choice.direction)}°, ${width}`;
      if (!limit) return h("p", { class: "hint" }, side.source !== null ? `no limit at ${where} in this record` : `${where}: ${side.problems.length ? "the design cannot be solved" : "solving …"}`);
      const { row } = limit;
      const value = reached(limit);
      const facts: [string, string][] = [
        ["status", row.status],
        ["proven bound", row.bound_l1 === null ? "none" : `${short(row.bound_l1, 9)}${row.bound_kind ? ` (${row.bound_kind})` : ""}`],
        ["cell", row.cell],
        ["contacts that carry force", String(limit.state.contacts?.length ?? 0)],
      ];
      if (row.lateral === "free" && row.l2_min !== null) facts.push(["l₂ found", `${short(row.l2_min)} to ${short(row.l2_max ?? row.l2_min)}`]);
      return h(
        "div",
        {},
        h("p", { class: "where" }, name, where),
        h("p", { class: "big" }, value === null ? "no limit" : `× ${short(1 + value, 4)}`, h("span", {}, value === null ? row.status : "of its length")),
        value === null ? null : h("p", { class: "exact" }, "l₁ = ", h("data", { class: "l1", value: String(value) }, String(value).replace("-", "−"))),
        h("dl", {}, ...facts.flatMap(([k, v]) => [h("dt", {}, k), h("dd", {}, v)])),
        limit.state.note ? h("p", { class: "note" }, limit.state.note) : null,
      );
    };
    const two = this.mode === "compare";
    const key = JSON.stringify([this.a.chosen?.row, this.a.choice, this.a.problems.length, this.a.source, two && [this.b.chosen?.row, this.b.choice, this.b.own?.name]]);
    if (key === this.seen) return;
    this.seen = key;
    this.card.replaceChildren(entry(two ? `${this.a.own?.name}: ` : "", this.a), ...(two ? [entry(`${this.b.own?.name ?? ""}: `, this.b)] : []));
  }

  private drawControls(): void {
    const { a } = this;
    const set = (name: string, value: number, words: string, range?: [number, number, number]) => {
      const slider = this.sliders.get(name);
      if (!slider) return;
      const { input, output } = slider;
      if (range) Object.assign(input, { min: range[0], max: range[1], step: range[2] });
      if (document.activeElement !== input || Number(input.value) !== value) input.value = String(value);
      output.textContent = words;
    };
    set("direction", a.choice?.direction ?? 0, a.choice ? `${short(a.choice.direction)}°` : "–");
    set("l2", a.l2, a.free ? "free" : short(a.l2, 3));
    this.free.checked = a.free;
    const unit = a.own?.unit ? ` ${a.own.unit}` : "";
    for (const [name, side] of [["wire", a], ["wire-b", this.b]] as const) {
      const R = side.own?.reference_radius ?? 1;
      const r = side.minorRadius ?? side.design?.minor_radius ?? null;
      const slider = this.sliders.get(name);
      if (slider) slider.input.disabled = r === null;
      const step = 10 ** Math.floor(Math.log10(R / 100));
      const of = side.design?.minor_radius ?? 0;
      set(name, r ?? 0, r === null ? "by ring" : `${short(r, 4)}${unit}`, [step, Math.max(0.35 * R, 1.3 * of), step / 2]);
    }
    set("spacing", a.spacing ?? 1, `× ${short(a.spacing ?? 1, 3)}`);
    const l2s = [...new Set(a.limits.map((l) => l.row.l2))].sort((x, y) => x - y);
    this.widths.hidden = l2s.length < 2;
    const now = a.choice?.l2 ?? a.l2;
    const key = l2s.join();
    if (this.widths.dataset["key"] !== key) {
      this.widths.dataset["key"] = key;
      this.widths.replaceChildren(...l2s.map((l2) => h("button", { type: "button", onclick: () => this.choose(this.a.choice?.direction ?? 0, l2) }, `l₂ ${short(l2)}`)));
    }
    [...this.widths.children].forEach((chip, k) => chip.setAttribute("aria-pressed", String(l2s[k] === now)));
    const names = a.own?.poses.map((p) => p.element) ?? [];
    if (this.elements.dataset["key"] !== names.join()) {
      this.elements.dataset["key"] = names.join();
      this.elements.replaceChildren(h("option", { value: "" }, "all"), ...names.map((name, k) => h("option", { value: k }, name)));
    }
    this.elements.value = this.picked === null || this.picked >= names.length ? "" : String(this.picked);
    this.command.textContent = a.command;
    this.scrub.value = String(this.t);
    const locked = a.locked;
    this.scrub.disabled = this.play.disabled = !locked;
    this.play.textContent = this.t < 1 ? "▶" : "◀";
    this.play.setAttribute("aria-label", this.t < 1 ? "Play the pull" : "Play it back");
    const between = locked !== null && this.t > 0 && this.t < 1;
    this.way.textContent = !locked || this.t === 0 ? "starting state" : between ? "interpolated: shows the way, overlaps are possible" : "locked";
    this.way.dataset["kind"] = between ? "between" : "state";
  }

  private drawInfo(): void {
    const { a, picked } = this;
    const locked = this.t > 0 ? a.locked : null;
    const sheet = locked?.sheet ?? a.own;
    this.info.hidden = picked === null || !sheet?.poses[picked];
    if (picked === null || !sheet?.poses[picked]) return;
    const between = locked && this.t < 1;
    const pairs = locked ? locked.limit.pairs : sheet.pairs;
    const found = new Map<string, { numbers: number[]; gap: number }>();
    for (const { ring_a, ring_b, shift, number, gap } of pairs) {
      const [ea, eb] = [sheet.rings[ring_a]!.element, sheet.rings[ring_b]!.element];
      for (const [own, other, sign] of [[ea, eb, 1], [eb, ea, -1]] as const) {
        if (own !== picked) continue;
        const cell = shift.some(Boolean) ? ` (${shift.map((x) => short(sign * x || 0)).join(", ")})` : "";
        const name = `${sheet.poses[other]!.element}${cell}`;
        const entry = found.get(name) ?? { numbers: [], gap: Infinity };
        if (number) entry.numbers.push(number);
        entry.gap = Math.min(entry.gap, gap);
        found.set(name, entry);
      }
    }
    const rows = [...found].sort((x, y) => y[1].numbers.length - x[1].numbers.length || x[1].gap - y[1].gap).slice(0, 14);
    const load = loads(sheet, locked?.limit ?? null)[picked]!;
    const room = slack(sheet, pairs)[picked]!;
    this.info.replaceChildren(
      h("b", {}, sheet.poses[picked]!.element),
      h("p", {}, between ? "interpolated: no gaps are known here" : `smallest gap ${Number.isFinite(room) ? short(room) : "–"}${locked ? `; load ${short(load, 4)}` : ""}`),
      between ? null! : h("table", {}, h("thead", {}, h("tr", {}, ...["neighbour", "linking", "gap"].map((t) => h("th", { scope: "col" }, t)))),
        h("tbody", {}, ...rows.map(([name, { numbers, gap }]) => h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, numbers.length ? numbers.map((n) => (n > 0 ? `+${n}` : `−${-n}`)).join(", ") : "–"), h("td", {}, short(gap, 5)))))),
      h("button", { type: "button", onclick: () => this.pick(null) }, "Close"),
    );
  }

  private drawLegend(): void {
    const { a } = this;
    if (!a.own || this.colorBy === "element") {
      this.legend.hidden = true;
      return;
    }
    const locked = this.t > 0 ? a.locked : null;
    const sheet = locked?.sheet ?? a.own;
    const values = this.colorBy === "load" ? loads(sheet, locked?.limit ?? null) : slack(sheet, locked && this.t === 1 ? locked.limit.pairs : sheet.pairs);
    const most = Math.max(...values.filter(Number.isFinite), 0);
    const ramp = `linear-gradient(90deg, ${this.start.palette.loads.join(", ")})`;
    this.legend.hidden = false;
    const [left, right] = this.colorBy === "load" ? ["0", most ? short(most, 3) : "no load in this state"] : [short(most, 3), "0"];
    this.legend.replaceChildren(h("span", {}, this.colorBy === "load" ? "load" : "smallest gap"), h("span", {}, left), h("i", { style: `background:${ramp}` }), h("span", {}, right));
  }
}

void api.start().then(
  (start) => new Page(start),
  (error: unknown) => document.getElementById("app")!.append(h("p", { class: "broken" }, `The viewer cannot start: ${error instanceof Error ? error.message : String(error)}`)),
);
