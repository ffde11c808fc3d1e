// The page: what stands where. It shows and asks; limits and files come from the program.

import { CompareControls } from "./compare-controls";
import { Controls } from "./controls";
import { h } from "./dom";
import { DrawPanel } from "./draw-panel";
import { Editor } from "./editor";
import { ElementInfo } from "./element-info";
import { Header } from "./header";
import { ColorLegend } from "./legend";
import { LimitCard } from "./limit-card";
import { PlotCard } from "./plot-card";
import { Scrubber } from "./scrubber";
import { Stages } from "./stages";
import { ViewState } from "./state";
import type { Start } from "./types";

/** A part of the page that is drawn anew when the state has changed. */
interface Part {
  draw(): void;
}

export class Page {
  private state: ViewState;
  private title = h("h1", {});
  private subtitle = h("p", { class: "subtitle" });
  private notice = h("div", { class: "notice", role: "alert", hidden: true });
  private header: Header;
  private compare: CompareControls;
  private editor: Editor;
  private drawing: DrawPanel;
  private stages: Stages;
  /** What is drawn once there is a sheet, in this order. */
  private parts: Part[];

  constructor(root: HTMLElement, start: Start) {
    const state = new ViewState(start, () => this.draw());
    this.state = state;
    this.header = new Header(state);
    this.compare = new CompareControls(state);
    this.editor = new Editor(state.a, start.weaves);
    this.drawing = new DrawPanel(state.a, start.palette);
    const boxes = { a: h("div", { class: "stage" }), b: h("div", { class: "stage second", hidden: true }) };
    const board = start.bundle ? [] : [this.drawing.board.node];
    const info = new ElementInfo(state);
    const legend = new ColorLegend(state);
    const scrubber = new Scrubber(state);
    const plot = new PlotCard(state);
    const limit = new LimitCard(state);
    const controls = new Controls(state);
    root.append(
      this.header.node,
      h(
        "main",
        {},
        h(
          "section",
          { class: "view", "aria-label": "Sheet" },
          h("div", { class: "stages" }, ...board, boxes.a, boxes.b, info.node, legend.node, this.notice),
          scrubber.node,
        ),
        h(
          "aside",
          { class: "panel" },
          h("div", { class: "head" }, this.title, this.subtitle),
          h("div", { class: "explore" }, this.compare.node, plot.node, limit.node, controls.node),
          ...(start.bundle ? [] : [this.editor.node, this.drawing.node]),
        ),
      ),
    );
    // The stages measure their boxes, which must stand in the page by now.
    this.stages = new Stages(state, boxes);
    this.parts = [this.stages, this.header, plot, limit, controls, this.compare, scrubber, info, legend];
    state.setMode("explore");
    // For tests and measurements of the picture itself.
    Object.assign(window, { maille: { stage: this.stages.first, side: state.a } });
    void state.a.open(start.opened).then(() => this.draw());
  }

  private draw(): void {
    const { a, mode, start } = this.state;
    this.drawMode();
    if (a.own) {
      document.title = `${a.own.name} – maille`;
      this.title.textContent = a.own.name;
      this.subtitle.textContent = a.own.title;
      for (const part of this.parts) part.draw();
      if (!start.bundle && mode === "edit") this.editor.draw();
      if (!start.bundle && mode === "draw") this.drawing.draw();
    }
    this.drawNotice();
  }

  private drawMode(): void {
    const { mode } = this.state;
    document.body.dataset["mode"] = mode;
    this.header.drawMode();
    this.drawing.board.node.hidden = mode !== "draw";
    this.stages.drawMode();
    this.compare.node.hidden = mode !== "compare";
  }

  /** What went wrong; the editor shows problems of the design itself. */
  private drawNotice(): void {
    const { a, mode } = this.state;
    const shown = a.failure ?? (mode === "edit" || mode === "draw" ? undefined : a.problems[0]);
    this.notice.hidden = !shown;
    if (shown) this.notice.replaceChildren(h("b", {}, shown.problem), " ", shown.help ?? "");
  }
}
