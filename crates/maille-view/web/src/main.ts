// The page starts here.

import "./style.css";
import * as api from "./api";
import { h } from "./dom";
import { Page } from "./page";

const root = document.getElementById("app")!;

void api.start().then(
  (start) => new Page(root, start),
  (error: unknown) => {
    const reason = error instanceof Error ? error.message : String(error);
    root.append(h("p", { class: "broken" }, `The viewer cannot start: ${reason}`));
  },
);
