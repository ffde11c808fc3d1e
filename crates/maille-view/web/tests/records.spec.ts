// Records, simulations and sweeps are opened and compared.

import { readFileSync } from "node:fs";
import { join } from "node:path";
import { clickMap, expect, solved, test, type Program } from "./program";

const PULLED = ["--tile", "2x2", "--fix", "left", "--pull", "right=4,0,0", "--steps", "6", "--quiet"];

interface Row {
  share: string;
  stretch: string;
  mean_force: string;
}

/** The rows of `forces.csv`, as the program wrote them. */
function forces(program: Program, folder: string): Row[] {
  const lines = readFileSync(join(program.folder, folder, "forces.csv"), "utf8").trim().split("\n");
  const head = lines[0]!.split(",");
  const row = (line: string) => Object.fromEntries(line.split(",").map((x, k) => [head[k]!, x]));
  return lines.slice(1).map((line) => row(line) as unknown as Row);
}

test("a simulation is played, its states have their forces and gaps", async ({ page, program }) => {
  program.run("simulate", "1.1", ...PULLED, "--out", "pulled");
  const rows = forces(program, "pulled");
  expect(rows.length).toBeGreaterThan(4);
  await page.goto(await program.view("pulled"));
  await expect(page.locator(".progress")).toHaveText(`${rows.length} states of pulled`);
  await expect(page.locator(".force-map circle.limit")).toHaveCount(rows.length);
  // The last dot of the plot is the last state: a click shows its numbers.
  await page.locator(".force-map circle.limit").last().click({ force: true });
  const facts = page.locator(".card dd");
  const last = rows.at(-1)!;
  await expect.poll(async () => Number(await facts.nth(0).textContent())).toBeCloseTo(Number(last.stretch), 5);
  expect(Number(await facts.nth(1).textContent())).toBeCloseTo(Number(last.mean_force), 5);
  await expect(facts.nth(3)).toHaveText("the sheet locked");
  await expect(page.locator(".way")).toContainText(`frame ${rows.length - 1}`);
  // The slider goes from state to state; the gaps of the one that is shown are asked for.
  await page.locator(".scrubber input").fill("0");
  await expect(facts.nth(0)).toHaveText("1");
  await page.getByLabel("Element", { exact: true }).selectOption({ index: 1 });
  await expect(page.locator(".info")).toContainText("smallest gap 0.3");
  await page.locator(".scrubber input").fill("1");
  await expect(page.locator(".info")).toContainText("smallest gap −0.0000");
  // Its picture is that of the program.
  await page.getByText("Export", { exact: true }).click();
  const waiting = page.waitForEvent("download");
  await page.getByRole("button", { name: "STL" }).click();
  const download = await waiting;
  expect(download.suggestedFilename()).toBe(`1.1-simulate_frame${rows.length - 1}.stl`);
  program.run("export", "--from", "pulled", "--format", "stl", "--out", "program.stl", "--quiet");
  const written = readFileSync((await download.path())!);
  expect(written.length).toBe(readFileSync(join(program.folder, "program.stl")).length);
});

test("a curve is broken where a direction has no limit", async ({ page, program }) => {
  const asked = ["--directions", "0:180:15", "--l2=-0.1,0", "--cell", "1x1", "--effort", "low", "--allow-incomplete"];
  program.run("characterize", "european-4-in-1", ...asked, "--quiet", "--out", "narrow");
  await page.goto(await program.view("narrow"));
  const curves = page.locator(".map .curve");
  await expect(curves).toHaveCount(2);
  // With l2 = -0.1 only 0, 15, 45 degrees and their images have a limit.
  const pieces = await curves.evaluateAll((all) => all.map((path) => path.getAttribute("d")!.match(/[MZ]/g)!.join("")));
  expect(pieces.sort()).toEqual(["MMMMMM", "MZ"]);
});

test("rolls are looked through, a piece of the sheet in each", async ({ page, program }) => {
  program.run("roll", "european-4-in-1", "--directions", "0,90", "--quiet", "--out", "rolls");
  await page.goto(await program.view("rolls"));
  await expect(page.locator(".progress")).toHaveText("4 states of rolls");
  await expect(page.locator(".force-map circle.limit")).toHaveCount(0);
  await page.locator(".scrubber input").fill("0");
  await expect(page.locator(".way")).toHaveText("1 of 4: along 0°, axis below, radius 9.0175 mm: local");
  await expect(page.locator(".card dd").nth(0)).toHaveText(/^0\.9633/);
  await page.locator(".scrubber input").fill("1");
  await expect(page.locator(".way")).toHaveText("4 of 4: along 90°, axis above, radius 23.0437 mm: local");
  // Rings of a certified roll touch.
  await page.getByLabel("Element", { exact: true }).selectOption({ index: 6 });
  await expect(page.locator(".info")).toContainText(/smallest gap (−?0\.0000|0neighbour)/);
  const waiting = page.waitForEvent("download");
  await page.getByText("Export", { exact: true }).click();
  await page.getByRole("button", { name: "STL" }).click();
  expect((await waiting).suggestedFilename()).toBe("european-4-in-1-roll_4.stl");
});

test("a sweep is looked through, and two of its records compared", async ({ page, program }) => {
  program.run("characterize", "1.1", "--directions", "0:180:45", "--l2", "-0.125,0", "--quiet");
  for (const r of ["0.05", "0.12"]) {
    const out = `study/records/1.1-r${r}`;
    program.run("characterize", "1.1", "--minor-radius", r, "--directions", "0:180:45", "--out", out, "--quiet");
  }
  await page.goto(await program.view("study"));
  await expect(page.locator(".progress")).toHaveText(/limits of study\/records\/1.1-r0.05/);
  await clickMap(page, 0, 0.6);
  const l1 = () => page.locator("data.l1").first().getAttribute("value").then(Number);
  // The chain along 0 degrees is straight: 2 (2 R - 2 r) on a period of 2.5.
  const straight = (r: number) => (4 * (1 - r)) / 2.5 - 1;
  await expect.poll(l1).toBeCloseTo(straight(0.05), 9);
  // The direction stays when the next record is opened.
  await page.getByLabel("Design", { exact: true }).selectOption("record:study/records/1.1-r0.12");
  await expect.poll(l1).toBeCloseTo(straight(0.12), 9);
  await expect(page.locator(".command")).toContainText("maille table study/records/1.1-r0.12 --where");

  await page.getByRole("tab", { name: "Compare" }).click();
  await page.getByLabel("Second design").selectOption("record:study/records/1.1-r0.05");
  await expect(page.locator("data.l1")).toHaveCount(2);
  await expect(page.locator(".difference dd").first()).toHaveText("+0.112");
  await expect(page.locator(".map .curve")).toHaveCount(2);
  // One after the other.
  const stages = page.locator(".stage");
  await page.getByRole("button", { name: "Second", exact: true }).click();
  await expect(stages.nth(0)).toBeHidden();
  await expect(stages.nth(1)).toBeVisible();
  await page.getByRole("button", { name: "First", exact: true }).click();
  await expect(stages.nth(0)).toBeVisible();
  await expect(stages.nth(1)).toBeHidden();
  // A record of several widths: the same width of it is shown, and the difference of two widths says so.
  await page.getByLabel("Second design").selectOption("record:maille-out/1.1");
  await expect(page.locator(".map .curve")).toHaveCount(2);
  await expect(page.locator(".difference dd").first()).toHaveText("+0.032");
  // Nothing was solved.
  await page.waitForTimeout(400);
  await expect(page.locator(".progress")).toHaveText("10 limits of maille-out/1.1");
});

test("two simulations are compared at the same share of the pull", async ({ page, program }) => {
  program.run("simulate", "1.1", ...PULLED, "--out", "maille-out/thick");
  program.run("simulate", "1.1", ...PULLED, "--minor-radius", "0.05", "--out", "maille-out/thin");
  await page.goto(await program.view("1.1"));
  await solved(page);
  await page.getByLabel("Design", { exact: true }).selectOption("record:maille-out/thick");
  await page.getByRole("tab", { name: "Compare" }).click();
  await page.getByLabel("Second design").selectOption("record:maille-out/thin");
  await expect(page.locator(".force-map .curve")).toHaveCount(2);
  await page.locator(".scrubber input").fill("1");
  const [thick, thin] = [forces(program, "maille-out/thick").at(-1)!, forces(program, "maille-out/thin")];
  const near = thin.reduce((best, row) =>
    Math.abs(Number(row.share) - Number(thick.share)) < Math.abs(Number(best.share) - Number(thick.share)) ? row : best,
  );
  const difference = page.locator(".difference dd");
  const value = async (k: number) => Number((await difference.nth(k).textContent())!.replace("−", "-"));
  await expect.poll(() => value(1)).toBeCloseTo(Number(near.stretch) - Number(thick.stretch), 5);
  expect(await value(2)).toBeCloseTo(Number(near.mean_force) - Number(thick.mean_force), 5);
  // A simulation beside limits: each has its own plot.
  await page.getByLabel("Second design").selectOption("1.1");
  await expect(page.locator(".map")).toBeVisible();
  await expect(page.locator(".force-map")).toBeVisible();
});
