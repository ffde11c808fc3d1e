// A design is drawn: rings are dragged, and what it does to links and overlaps is seen at once.

import { readFileSync } from "node:fs";
import { join } from "node:path";
import { expect, solved, test } from "./program";
import type { Page } from "@playwright/test";

/** The middle of a handle. Handles are made anew with the frame after a change: the changes and that frame are awaited. */
async function handle(page: Page, name: string): Promise<[number, number]> {
  await expect(page.locator('.draw[aria-busy="true"]')).toHaveCount(0);
  await expect(page.locator(`.board [data-handle="${name}"]`)).toHaveCount(1);
  return page.evaluate(async (wanted) => {
    const frame = () => new Promise((drawn) => requestAnimationFrame(drawn));
    await frame();
    await frame();
    const box = document.querySelector(`.board [data-handle="${wanted}"]`)!.getBoundingClientRect();
    return [box.x + box.width / 2, box.y + box.height / 2];
  }, name);
}

/** Drags a handle of the board by so many pixels. */
async function drag(page: Page, name: string, dx: number, dy: number): Promise<void> {
  const [x, y] = await handle(page, name);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + dx, y + dy, { steps: 6 });
  await page.mouse.up();
}

async function type(page: Page, field: string, value: string): Promise<void> {
  const input = page.locator(".draw").getByLabel(field, { exact: true });
  await input.fill(value);
  await input.press("Enter");
  await input.blur();
}

const value = (page: Page, field: string) =>
  page.locator(".draw").getByLabel(field, { exact: true }).inputValue().then(Number);

test("a weave is drawn from nothing, saved, and right", async ({ page, program }) => {
  await page.goto(await program.view("1.1"));
  await page.getByRole("tab", { name: "Draw" }).click();
  await page.getByRole("button", { name: "New design" }).click();
  await expect(page.locator("h1")).toHaveText("my-weave");
  await expect(page.locator(".draw .fine")).toHaveText("no problems; 0 links in a cell");
  // A second ring, tilted upright by its handle and dragged through the first and its image.
  await page.getByRole("button", { name: "Add ring" }).click();
  await expect(page.getByLabel("Ring", { exact: true })).toHaveValue("1");
  await type(page, "z", "0");
  await type(page, "y", "0");
  await type(page, "tilt °", "90");
  await type(page, "turn °", "90");
  await expect.poll(() => value(page, "tilt °")).toBe(90);
  await drag(page, "move", 60, 0);
  await expect.poll(() => value(page, "x")).toBeGreaterThan(0.7);
  await type(page, "x", "1.25");
  await expect(page.locator(".draw .changed.new")).toContainText("2 new links: ring-1 – ring-2");
  await expect(page.locator(".draw .links")).toContainText("ring-2 is linked with ring-1 (1, 0), ring-1");
  // Dragged beyond the wire, it overlaps; undone, it does not.
  await drag(page, "move", 0, -86);
  await expect(page.locator(".draw .problem").first()).toContainText("ring-2");
  await page.locator(".board svg").press("Control+z");
  await expect(page.locator(".draw .fine")).toBeVisible();
  await page.getByLabel("Name of the design").fill("my first weave");
  await page.getByLabel("Name of the design").press("Enter");
  await page.getByLabel("Name of the design").blur();
  await expect(page.locator("h1")).toHaveText("my-first-weave");
  await page.locator(".draw").getByLabel("File name").fill("my first weave.toml");
  await page.locator(".draw").getByRole("button", { name: "Save" }).click();
  await expect(page.locator(".draw .said")).toContainText("my-first-weave.toml");
  expect(program.run("check", "my-first-weave.toml")).toContain("2 rings, 2 links");
  expect(readFileSync(join(program.folder, "my-first-weave.toml"), "utf8")).toContain('name = "my-first-weave"');
  // What was saved is what is to be kept: a link that breaks now is named.
  await expect(page.locator(".draw .changed")).toHaveCount(0);
  await type(page, "x", "0.4");
  await expect(page.locator(".draw .changed.broken")).toContainText("1 broken link: ring-1 – ring-2 in cell (-1, 0)");
});

test("handles and keys turn, tilt, resize and move, and the lattice is pulled", async ({ page, program }) => {
  await page.goto(await program.view("1.1"));
  await page.getByRole("tab", { name: "Draw" }).click();
  await page.getByRole("button", { name: "Copy design" }).click();
  await expect(page.locator("h1")).toHaveText("1.1-copy");
  await page.getByLabel("Ring", { exact: true }).selectOption({ label: "flat" });
  await drag(page, "radius", 0, 20);
  await expect.poll(() => value(page, "R")).toBeLessThan(0.95);
  await page.getByRole("button", { name: "Undo" }).click();
  await expect.poll(() => value(page, "R")).toBe(1);
  await drag(page, "tilt", 30, 0);
  await expect.poll(() => value(page, "tilt °")).toBeGreaterThan(20);
  await drag(page, "turn", -60, -60);
  await expect.poll(() => value(page, "turn °")).toBeGreaterThan(10);
  await page.getByRole("button", { name: "Undo" }).click();
  await page.getByRole("button", { name: "Undo" }).click();
  await expect.poll(() => value(page, "tilt °")).toBe(0);
  const board = page.locator(".board svg");
  for (const key of ["ArrowRight", "ArrowUp", "PageUp"]) await board.press(key);
  await expect.poll(() => value(page, "x")).toBe(0.05);
  await expect.poll(() => value(page, "y")).toBe(0.05);
  await expect.poll(() => value(page, "z")).toBe(0.05);
  for (const key of [".", "["]) await board.press(key);
  await expect.poll(() => value(page, "tilt °")).toBe(5);
  await expect.poll(() => value(page, "turn °")).toBe(5);
  await board.press("+");
  await expect.poll(() => value(page, "R")).toBe(1.05);
  await drag(page, "a1", 40, 0);
  await expect.poll(() => value(page, "a₁ x")).toBeGreaterThan(2.7);
  expect(await value(page, "a₂ x")).toBe(0);
  await page.getByLabel("Ring", { exact: true }).selectOption({ label: "standing-90" });
  await board.press("Delete");
  await expect(page.getByLabel("Ring", { exact: true }).locator("option")).toHaveCount(3);
  // A ring is picked where it lies, the copy of a ring in another cell too.
  await page.getByLabel("Ring", { exact: true }).selectOption("");
  const [[right], [left, top], [, bottom]] = [
    await handle(page, "a1"),
    await handle(page, "a2"),
    await handle(page, "a1"),
  ];
  await page.mouse.click((left + right) / 2, top);
  await expect(page.getByLabel("Ring", { exact: true })).toHaveValue("1");
  await page.mouse.click((left + right) / 2, bottom);
  await expect(page.getByLabel("Ring", { exact: true })).toHaveValue("1");
});

test("offsets and minor radii of single rings are edited", async ({ page, program }) => {
  await page.goto(await program.view("1.1"));
  await solved(page);
  await page.getByRole("tab", { name: "Edit" }).click();
  let solves = 0;
  page.on("request", (request) => (solves += Number(request.url().endsWith("/api/solve"))));
  const area = page.getByLabel("Design file, TOML");
  await expect(page.locator(".table-box thead th")).toHaveText(
    ["element", "x", "y", "z", "R", "r", "nx", "ny", "nz", "ox", "oy", "oz", ""],
  );
  const set = async (label: string, typed: string) => {
    const input = page.getByLabel(label, { exact: true });
    await input.fill(typed);
    await input.press("Enter");
    await input.blur();
  };
  await expect(page.getByLabel("flat, ring 0, r", { exact: true })).toHaveAttribute("placeholder", "0.1");
  await set("flat, ring 0, r", "0.05");
  await expect.poll(() => area.inputValue()).toContain("normal = [0.0, 0.0, 1.0], minor_radius = 0.05 }");
  await set("standing-0, ring 0, offset z", "0.2");
  await expect.poll(() => area.inputValue()).toContain("normal = [0.0, 1.0, 0.0], offset = [0.0, 0.0, 0.2] }");
  await set("standing-0, ring 0, offset x", "0.1");
  await expect.poll(() => area.inputValue()).toContain("offset = [0.1, 0.0, 0.2]");
  await expect(page.locator(".fine")).toBeVisible();
  // Links stay, and change where a ring is lifted off; both are named while the design is edited.
  await set("standing-0, ring 0, offset z", "1.5");
  await expect(page.locator(".editor .changed.broken")).toContainText("2 broken links: flat – standing-0");
  // Nothing is solved meanwhile; then it is.
  await page.waitForTimeout(400);
  expect(solves).toBe(0);
  await set("standing-0, ring 0, offset z", "0.2");
  await page.getByRole("tab", { name: "Explore" }).click();
  await solved(page);
  expect(solves).toBeGreaterThan(0);
});
