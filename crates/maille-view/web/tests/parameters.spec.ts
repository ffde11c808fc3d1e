// Named numbers of a design, and what their sliders do.

import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { expect, solved, test } from "./program";

test("parameters of the file have sliders", async ({ page, program }) => {
  const square = readFileSync(join(import.meta.dirname, "../../../../examples/parameters/square.toml"), "utf8");
  // The last one has no bounds: half of it to each side.
  const text = square.replace("tilt = 0.0", "tilt = 10.0");
  writeFileSync(join(program.folder, "square.toml"), text);
  await page.goto(await program.view("square.toml", "--set", "play=1.1"));
  await solved(page);
  const slider = (name: string) => page.getByLabel(name, { exact: true }).locator("visible=true");
  await expect(slider("play")).toHaveValue("1.1");
  await expect(slider("play")).toHaveAttribute("min", "0.92");
  await expect(slider("play")).toHaveAttribute("max", "1.2");
  await expect(slider("tilt")).toHaveAttribute("min", "5");
  await expect(slider("tilt")).toHaveAttribute("max", "15");
  // A computed one is not free.
  await expect(slider("pitch")).toHaveCount(0);
  // The number is that of the program.
  await slider("tilt").fill("5");
  await page.getByLabel("Direction of pull").fill("45");
  await solved(page);
  await expect(page.locator(".command")).toHaveText(
    "maille characterize square.toml --set play=1.1 --set tilt=5 --directions 45 --l2 0",
  );
  const command = ["--set", "play=1.1,tilt=5", "--directions", "45", "--l2", "0", "--out", "record", "--quiet"];
  program.run("characterize", "square.toml", ...command);
  const table = program.run("table", "record", "--format", "csv", "--columns", "l1").trim().split("\n");
  await expect(page.locator("data.l1")).toHaveAttribute("value", table.at(-1)!);
  // A computed wire follows, and so does its slider.
  await slider("wire").fill("1.6");
  await expect(page.locator(".controls .slider").filter({ hasText: "Wire radius" }).locator("output")).toHaveText("0.8 mm");
  await page.screenshot({ path: "test-results/parameters.jpg", quality: 86 });
  // Too near: the overlap is named and nothing is solved.
  await slider("play").fill("0.92");
  await slider("wire").fill("2");
  await slider("radius").fill("4");
  await expect(page.locator(".notice")).toContainText("overlap by");
  await expect(page.locator(".progress")).toHaveText("not solved");
  // In the editor a slider writes into the file, with what the others have changed; comments and bounds stay.
  await page.getByRole("tab", { name: "Edit" }).click();
  await slider("radius").fill("8");
  const area = page.getByLabel("Design file, TOML");
  await expect(area).toHaveValue(/radius = \{ value = 8\.0, min = 4\.0, max = 8\.0 \}/);
  await expect(area).toHaveValue(/wire = \{ value = 2\.0, min = 0\.4, max = 2\.0 \} # its diameter/);
  await expect(area).toHaveValue(/tilt = 5\.0 # of the upright rings/);
});

test("links that a parameter breaks are named as it moves", async ({ page, program }) => {
  const square = readFileSync(join(import.meta.dirname, "../../../../examples/parameters/square.toml"), "utf8");
  writeFileSync(join(program.folder, "square.toml"), square.replace("max = 1.2 }", "max = 2.0 }"));
  await page.goto(await program.view("square.toml"));
  await solved(page);
  await page.getByLabel("play", { exact: true }).locator("visible=true").fill("1.9");
  await expect(page.locator(".parameters .changed.broken").locator("visible=true")).toContainText("broken links");
});
