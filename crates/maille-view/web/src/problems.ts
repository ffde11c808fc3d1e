// What is wrong with a design, and which of its links have changed.

import { h } from "./dom";
import { CHANGED } from "./overlays";
import type { Side } from "./side";
import type { ListedProblem } from "./types";

/** Links that are named, at most. */
const MOST = 12;

/** The lines of a list; `go` is called for a problem that is clicked. */
export function problemList(side: Side, go: (problem: ListedProblem) => void): HTMLElement[] {
  const problems = side.problems.map((p, k) =>
    h(
      "button",
      { type: "button", class: "problem", onclick: () => go(p) },
      h("b", {}, p.line === null ? "" : `line ${p.line}: `),
      `${p.field ? `${p.field}: ` : ""}${p.problem}`,
      // What helps several is said once.
      p.help === side.problems[k + 1]?.help ? null : h("span", { class: "help" }, p.help ?? ""),
    ),
  );
  const count = side.own?.pairs.filter((p) => p.number).length ?? 0;
  const fine = h("p", { class: "fine" }, `no problems; ${count} links in a cell`);
  return [...(problems.length ? problems : [fine]), ...changedList(side)];
}

/** The links that are broken and those that are new, in the colours of the picture. */
export function changedList(side: Side): HTMLElement[] {
  const all = side.changedLinks;
  return (["broken", "new"] as const).flatMap((kind) => {
    const links = all.filter((link) => link.kind === kind);
    if (!links.length) return [];
    const count = `${links.length} ${kind} ${links.length === 1 ? "link" : "links"}: `;
    const more = links.length > MOST ? `; and ${links.length - MOST} more` : "";
    const names = links.slice(0, MOST).map((link) => link.words);
    const swatch = h("i", { style: `background:${CHANGED[kind]}`, "aria-hidden": "true" });
    return [h("p", { class: `changed ${kind}` }, swatch, h("b", {}, count), names.join("; ") + more)];
  });
}
