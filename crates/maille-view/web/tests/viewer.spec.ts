// What a user does.

import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { clickMap, expect, solved, test } from "./program";

interface Handle {
  maille: { stage: { view: number[]; ringCount: number; measure(count: number): number } };
}

test("the first picture, and turning it", async ({ page, program }) => {
  await page.goto(await program.view("1.1"));
  await page.waitForFunction(() => performance.getEntriesByName("maille-first-picture").length > 0);
  const ms = await page.evaluate(() => performance.getEntriesByName("maille-first-picture")[0]!.startTime);
  console.log(`first picture of 1.1, 8 x 8: ${ms.toFixed(0)} ms after the page's start`);
  const rings = await page.evaluate(() => (window as unknown as Handle).maille.stage.ringCount);
  expect(rings).toBe(8 * 8 * 3);
  const view = () => page.evaluate(() => (window as unknown as Handle).maille.stage.view);
  const before = await view();
  const box = (await page.locator(".stage canvas").first().boundingBox())!;
  await page.mouse.move(box.x + 300, box.y + 300);
  await page.mouse.down();
  await page.mouse.move(box.x + 420, box.y + 340, { steps: 5 });
  await page.mouse.up();
  const dragged = await view();
  expect(Math.hypot(...dragged.map((x, k) => x - before[k]!))).toBeGreaterThan(1);
  await page.locator(".stage canvas").first().focus();
  await page.keyboard.press("ArrowLeft");
  const turned = await view();
  expect(Math.hypot(...turned.map((x, k) => x - dragged[k]!))).toBeGreaterThan(0.5);
});

test("a chain is one cell wide", async ({ page, program }) => {
  await page.goto(await program.view("cable"));
  await page.waitForFunction(() => performance.getEntriesByName("maille-first-picture").length > 0);
  const rings = await page.evaluate(() => (window as unknown as Handle).maille.stage.ringCount);
  expect(rings).toBe(8 * 2);
});

test("a click at 45 degrees shows the number of the program", async ({ page, program }) => {
  await page.goto(await program.view("1.1"));
  await solved(page);
  await clickMap(page, 45, 0.6);
  await expect(page.locator(".where")).toHaveText(/45°/);
  const shown = await page.locator("data.l1").getAttribute("value");
  program.run("characterize", "1.1", "--directions", "45", "--l2", "0", "--out", "record", "--quiet");
  const table = program.run("table", "record", "--format", "csv", "--columns", "l1,status").trim().split("\n");
  const [l1, status] = table.at(-1)!.split(",");
  expect(shown).toBe(l1);
  await expect(page.locator(".card dd").first()).toHaveText(status!);
  await expect(page.locator(".way")).toHaveText("locked");
  await page.locator(".scrubber input").fill("0.5");
  await expect(page.locator(".way")).toHaveText("interpolated: shows the way, overlaps are possible");
  await expect(page.locator(".command")).toHaveText("maille characterize 1.1 --directions 45 --l2 0");
});

test("a record is shown as it is", async ({ page, program }) => {
  program.run("characterize", "1.1", "--directions", "0:180:45", "--l2", "-0.125,0", "--out", "record", "--quiet");
  await page.goto(await program.view("record"));
  await expect(page.locator(".progress")).toHaveText("10 limits of record");
  await expect(page.getByLabel("Wire radius", { exact: true })).toBeEnabled();
  await page.getByRole("button", { name: "l₂ −0.125" }).click();
  await page.getByLabel("Direction of pull").fill("45");
  const row = program.run(
    "table",
    "record",
    "--format",
    "csv",
    "--columns",
    "l1",
    "--where",
    "direction_deg=45",
    "--where",
    "l2=-0.125",
  );
  await expect(page.locator("data.l1")).toHaveAttribute("value", row.trim().split("\n").at(-1)!);
});

test("the wire radius changes the map, and drags leave nothing behind", async ({ page, program }) => {
  const address = await program.view("1.1");
  await page.goto(address);
  await solved(page);
  await page.getByLabel("Direction of pull").fill("0");
  await expect(page.locator("data.l1")).toBeVisible();
  const value = async () => Number(await page.locator("data.l1").getAttribute("value"));
  expect(await value()).toBeCloseTo(0.44, 9);
  const before = await page.locator(".map .curve").first().getAttribute("d");
  const wire = page.getByLabel("Wire radius", { exact: true });
  for (let k = 0; k < 12; k++) await wire.fill(String(0.1 + 0.004 * k));
  await wire.fill("0.15");
  await solved(page);
  await expect.poll(value).toBeCloseTo((4 * (1 - 0.15)) / 2.5 - 1, 9);
  // Other curves can follow after the number that is shown.
  await expect(page.locator(".map .curve").first()).not.toHaveAttribute("d", before!);
  await expect.poll(async () => (await (await page.request.get(`${address}api/activity`)).json()).solves).toBe(0);
  // Too thick: the error of the program, the overlap in the picture, and no solve.
  await wire.fill("0.3");
  await expect(page.locator(".notice")).toContainText("overlap by");
  await expect(page.locator(".progress")).toHaveText("not solved");
  await wire.fill("0.1");
  await solved(page);
  await page.getByLabel("width free").check();
  await expect(page.locator(".where")).toHaveText(/width free/);
  // These take longer: they are cancelled, and what was found stays.
  await page.getByRole("button", { name: "Cancel" }).click();
  await expect(page.locator(".progress")).toHaveText(/^\d+ limits$/);
  await expect.poll(async () => (await (await page.request.get(`${address}api/activity`)).json()).solves).toBe(0);
});

test("a broken design says what is wrong, at its line", async ({ page, program }) => {
  writeFileSync(
    join(program.folder, "mine.toml"),
    program.run("new", "mine", "--weave", "european-4-in-1", "--major", "5", "--minor", "0.6", "-o", "-"),
  );
  await page.goto(await program.view("mine.toml"));
  await page.getByRole("tab", { name: "Edit" }).click();
  const area = page.getByLabel("Design file, TOML");
  const text = await area.inputValue();
  const wrong = text.replace("minor_radius = 0.6", "minor_radius = -0.6");
  await area.fill(wrong);
  const line = wrong.split("\n").findIndex((l) => l.startsWith("minor_radius")) + 1;
  await expect(page.locator(".problem")).toContainText(`line ${line}: minor_radius: -0.6 is not a positive length`);
  writeFileSync(join(program.folder, "wrong.toml"), wrong);
  let said = "";
  try {
    program.run("check", "wrong.toml", "--json");
  } catch (error) {
    said = String((error as { stdout: string }).stdout);
  }
  const [problem] = JSON.parse(said).files[0].problems;
  await expect(page.locator(".problem")).toContainText(problem.problem);
  await expect(page.locator(".problem .help")).toHaveText(problem.help);
  await expect(page.locator(".gutter .wrong")).toHaveText(String(line));
  // Links that break are named; the table changes the text and keeps its comments.
  await area.fill(text);
  await expect(page.locator(".fine")).toBeVisible();
  const first = page.locator(".table-box input").nth(2);
  await first.fill("40");
  await first.press("Enter");
  await expect(page.locator(".editor .changed.broken")).toContainText("broken links");
  expect(await area.inputValue()).toMatch(/^#/);
  await area.fill(text.replace('name = "mine"', 'name = "yours"'));
  await page.getByRole("button", { name: "Save" }).click();
  await expect(page.locator(".editor .said")).toContainText("saved");
  expect(readFileSync(join(program.folder, "mine.toml"), "utf8")).toContain('name = "yours"');
});

test("a design from a weave, saved under its name", async ({ page, program }) => {
  await page.goto(await program.view("1.1"));
  await page.getByRole("tab", { name: "Edit" }).click();
  await page.getByText("New from a weave").click();
  await page.getByLabel("Weave", { exact: true }).selectOption("kings-mail");
  await page.getByLabel("Name", { exact: true }).fill("cuff");
  await page.getByRole("button", { name: "Make the design" }).click();
  await expect(page.locator("h1")).toHaveText("cuff");
  await page.getByRole("button", { name: "Save" }).click();
  await expect(page.locator(".editor .said")).toContainText("saved");
  expect(program.run("check", "cuff.toml")).toContain("cuff.toml: OK; 4 rings, 16 links");
  await page.getByRole("button", { name: "Save" }).click();
  await expect(page.getByRole("button", { name: "Replace it" })).toBeVisible();
});

test("a 3MF is that of the program", async ({ page, program }) => {
  await page.goto(await program.view("1.1"));
  await page.getByLabel("Cells", { exact: true }).selectOption("4");
  await page.getByText("Export", { exact: true }).click();
  const waiting = page.waitForEvent("download");
  await page.getByRole("button", { name: "3MF" }).click();
  const download = await waiting;
  expect(download.suggestedFilename()).toBe("1.1.3mf");
  const bytes = readFileSync((await download.path())!);
  program.run("export", "1.1", "--tile", "4x4", "--out", "program.3mf", "--quiet");
  expect(bytes.equals(readFileSync(join(program.folder, "program.3mf")))).toBe(true);
  // A zip whose model is there, read back by its directory.
  const end = bytes.lastIndexOf(Buffer.from([0x50, 0x4b, 5, 6]));
  expect(end).toBeGreaterThan(0);
  expect(bytes.includes("3D/3dmodel.model")).toBe(true);
});

test("two radii side by side", async ({ page, program }) => {
  await page.goto(await program.view("1.1"));
  await solved(page);
  await page.getByLabel("Direction of pull").fill("0");
  await page.getByRole("tab", { name: "Compare" }).click();
  await expect(page.locator(".stage canvas")).toHaveCount(2);
  await page.getByLabel("Its wire radius").fill("0.15");
  await expect(page.locator("data.l1")).toHaveCount(2);
  await expect
    .poll(async () => Number(await page.locator("data.l1").nth(1).getAttribute("value")))
    .toBeCloseTo(0.36, 9);
  await solved(page);
  await expect(page.locator(".map .curve:not(.old)")).toHaveCount(2);
  await expect(page.locator(".map-legend")).toContainText("r = 0.15");
});

test("an element's neighbours", async ({ page, program }) => {
  await page.goto(await program.view("1.1"));
  await page.getByLabel("Element", { exact: true }).selectOption({ label: "flat" });
  await expect(page.locator(".info tbody td").filter({ hasText: /^[+−]1$/ })).toHaveCount(4);
  await expect(page.locator(".info")).toContainText("smallest gap");
  await page.getByLabel("Colour by").selectOption("slack");
  await expect(page.locator(".legend")).toContainText("smallest gap");
});

test("a bundle opens from the disk, without a server", async ({ page, program }) => {
  program.run("view", "1.1", "--bundle", "out.html", "--directions", "0:180:45", "--l2", "-0.125,0");
  const requests: string[] = [];
  page.on("request", (r) => requests.push(r.url()));
  await page.goto(`file://${join(program.folder, "out.html")}`);
  await expect(page.locator("h1")).toHaveText("1.1");
  await clickMap(page, 0, 0.55);
  await expect(page.locator("data.l1")).toBeVisible();
  await page.getByLabel("Direction of pull").fill("0");
  await page.getByRole("button", { name: "l₂ 0" }).click();
  expect(Number(await page.locator("data.l1").getAttribute("value"))).toBeCloseTo(0.44, 9);
  expect(
    requests.filter((url) => !url.startsWith("file:") && !url.startsWith("data:") && !url.startsWith("blob:")),
  ).toEqual([]);
});

test("the time of a frame with five thousand rings", async ({ page, program }) => {
  await page.goto(await program.view("1.1"));
  await page.getByLabel("Cells", { exact: true }).selectOption("41");
  const stage = () => page.evaluate(() => (window as unknown as Handle).maille.stage.ringCount);
  await expect.poll(stage).toBe(41 * 41 * 3);
  const ms = await page.evaluate(() => (window as unknown as Handle).maille.stage.measure(10));
  console.log(`frame of 5043 rings, all poses set anew: ${ms.toFixed(1)} ms on the CPU`);
  expect(ms).toBeGreaterThan(0);
});
