// Who can use it: contrast, names, keyboard; and pictures of it, for a person to look at.

import axe from "axe-core";
import { clickMap, expect, solved, test } from "./program";
import type { Page } from "@playwright/test";

async function accessible(page: Page, where: string): Promise<void> {
  await page.evaluate(axe.source);
  const found = await page.evaluate(async () => {
    const run = (window as unknown as { axe: typeof axe }).axe;
    const { violations, passes } = await run.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21aa"] });
    const words = violations.map(
      (v) => `${v.id}: ${v.nodes.map((n) => `${n.html.slice(0, 120)} ${n.failureSummary}`).join(" | ")}`,
    );
    return { words, contrast: passes.find((p) => p.id === "color-contrast")?.nodes.length ?? 0 };
  });
  expect(found.words, where).toEqual([]);
  expect(found.contrast, `${where}: contrast was judged`).toBeGreaterThan(5);
}

test("contrast and names pass WCAG AA", async ({ page, program }) => {
  await page.goto(await program.view("1.1"));
  await solved(page);
  await clickMap(page, 45, 0.6);
  await expect(page.locator("data.l1")).toBeVisible();
  await accessible(page, "explore");
  await page.getByLabel("Wire radius", { exact: true }).fill("0.3");
  await expect(page.locator(".notice")).toBeVisible();
  await page.getByRole("tab", { name: "Edit" }).click();
  await expect(page.locator(".problem")).not.toHaveCount(0);
  await accessible(page, "edit");
  await page.getByRole("tab", { name: "Draw" }).click();
  await accessible(page, "draw");
  await page.getByRole("tab", { name: "Compare" }).click();
  await accessible(page, "compare");
});

test("the keyboard reaches every control, and shows where it is", async ({ page, program }) => {
  await page.goto(await program.view("1.1"));
  await solved(page);
  await clickMap(page, 45, 0.6);
  for (const mode of ["Explore", "Draw", "Edit", "Compare"]) {
    await page.getByRole("tab", { name: mode }).click();
    await solved(page).catch(() => {});
    const wanted = await page.evaluate(() => {
      const all = [
        ...document.querySelectorAll<HTMLElement>("button, select, input, textarea, summary, svg.map, .stage canvas, .board svg"),
      ];
      const there = all.filter((e) => e.checkVisibility() && !(e as HTMLButtonElement).disabled);
      there.forEach((e, k) => (e.dataset["wanted"] = String(k)));
      (document.activeElement as HTMLElement).blur();
      return there.length;
    });
    const reached = new Set<string>();
    for (let k = 0; k < wanted + 10; k++) {
      await page.keyboard.press("Tab");
      const at = await page.evaluate(() => {
        const e = document.activeElement as HTMLElement;
        const style = getComputedStyle(e);
        return {
          id: e.dataset["wanted"] ?? "",
          seen: style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 2,
          tag: e.outerHTML.slice(0, 90),
        };
      });
      if (at.id) {
        expect(at.seen, `${mode}: ${at.tag} shows no focus`).toBe(true);
        reached.add(at.id);
      }
    }
    const missed = await page.evaluate(
      (ids) =>
        [...document.querySelectorAll<HTMLElement>("[data-wanted]")]
          .filter((e) => !ids.includes(e.dataset["wanted"]!))
          .map((e) => e.outerHTML.slice(0, 90)),
      [...reached],
    );
    expect(missed, mode).toEqual([]);
    await page.evaluate(() =>
      document.querySelectorAll<HTMLElement>("[data-wanted]").forEach((e) => delete e.dataset["wanted"]),
    );
  }
});

for (const width of [1440, 1024, 390]) {
  test(`pictures at ${width} pixels`, async ({ page, program }) => {
    await page.setViewportSize({ width, height: width === 390 ? 844 : 900 });
    await page.goto(await program.view("1.1"));
    await solved(page);
    await clickMap(page, 45, 0.6);
    await expect(page.locator("data.l1")).toBeVisible();
    await page.evaluate(() => scrollTo(0, 0));
    await page.mouse.move(1, 1); // no hint of what lies under the pointer
    const shot = (name: string) =>
      page.screenshot({ path: `test-results/${name}-${width}.png`, fullPage: width === 390 });
    await page.waitForTimeout(300);
    await shot("explore");
    // The picture of the guide's page on the viewer.
    if (width === 1440) await page.screenshot({ path: "test-results/guide-view.jpg", quality: 86 });
    // Nothing sticks out sideways.
    expect(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth)).toBeLessThanOrEqual(0);
    await page.getByRole("tab", { name: "Draw" }).click();
    await page.getByLabel("Ring", { exact: true }).selectOption("1");
    await page.waitForTimeout(300);
    await shot("draw");
    if (width === 1440) await page.screenshot({ path: "test-results/guide-draw.jpg", quality: 86 });
    expect(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth)).toBeLessThanOrEqual(0);
    await page.getByRole("tab", { name: "Edit" }).click();
    await page
      .getByLabel("Design file, TOML")
      .fill(
        (await page.getByLabel("Design file, TOML").inputValue()).replace("minor_radius = 0.1", "minor_radius = 0.3"),
      );
    await expect(page.locator(".problem")).not.toHaveCount(0);
    await page.waitForTimeout(300);
    await shot("edit");
    expect(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth)).toBeLessThanOrEqual(0);
    await page
      .getByLabel("Design file, TOML")
      .fill(
        (await page.getByLabel("Design file, TOML").inputValue()).replace("minor_radius = 0.3", "minor_radius = 0.1"),
      );
    await page.getByRole("tab", { name: "Compare" }).click();
    await page.getByLabel("Its wire radius").fill("0.05");
    await solved(page);
    await page.waitForTimeout(500);
    await shot("compare");
    expect(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth)).toBeLessThanOrEqual(0);
  });
}

for (const width of [1440, 390]) {
  test(`pictures of simulations at ${width} pixels`, async ({ page, program }) => {
    for (const [name, r] of [
      ["a", "0.1"],
      ["b", "0.05"],
    ] as const) {
      const pull = ["--tile", "3x3", "--fix", "left", "--pull", "right=6,0,0", "--steps", "6", "--minor-radius", r];
      program.run("simulate", "1.1", ...pull, "--out", `maille-out/${name}`, "--quiet");
    }
    await page.setViewportSize({ width, height: width === 390 ? 844 : 900 });
    await page.goto(await program.view("maille-out/a"));
    await page.locator(".scrubber input").fill("1");
    await expect(page.locator(".card")).toContainText("mean force");
    if (width === 1440) await accessible(page, "simulation");
    await page.getByRole("tab", { name: "Compare" }).click();
    await page.getByLabel("Second design").selectOption("record:maille-out/b");
    await expect(page.locator(".difference")).toBeVisible();
    await page.waitForTimeout(1000);
    await page.screenshot({ path: `test-results/simulations-${width}.png`, fullPage: width === 390 });
    expect(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth)).toBeLessThanOrEqual(0);
  });
}
