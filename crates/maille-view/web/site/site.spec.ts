// The static site as a reader sees it, from the disk: every link leads somewhere, no page complains, is wider than a
// telephone, or has letters that are hard to read.

import { expect, test, type Page } from "@playwright/test";
import axe from "axe-core";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { join, relative } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const site = process.env["SITE"] ?? "";
const telephone = { width: 390, height: 844 };
const desk = { width: 1440, height: 900 };

const all = readdirSync(site, { recursive: true, encoding: "utf8" }).filter((file) => file.endsWith(".html"));
/** Pages of documents; the others are made by rustdoc and pdoc, or are viewers. */
const pages = all.filter((file) => !/^(rust|python|viewer)\/|^(toc|404|print)\.html$/.test(file)).sort();
const viewers = all.filter((file) => file.startsWith("viewer/")).sort();

/** What a page writes into the console as an error, or fails to load. */
function complaints(page: Page): string[] {
  const out: string[] = [];
  page.on("console", (message) => message.type() === "error" && out.push(message.text()));
  page.on("pageerror", (error) => out.push(error.message));
  page.on("requestfailed", (request) => out.push(`cannot load ${request.url()}`));
  return out;
}

const open = (page: Page, file: string) => page.goto(pathToFileURL(join(site, file)).href);

const ids = new Map<string, Set<string>>();
/** The names in a file that an address can end with. */
function idsOf(file: string): Set<string> {
  const known = ids.get(file) ?? new Set([...readFileSync(file, "utf8").matchAll(/\bid="([^"]+)"/g)].map((m) => m[1]!));
  ids.set(file, known);
  return known;
}

/** What is wrong with a link of a page to another place of the site. */
function broken(href: string): string | undefined {
  const url = new URL(href);
  if (url.protocol !== "file:") return undefined;
  const anchor = decodeURIComponent(url.hash.slice(1));
  url.hash = "";
  url.search = "";
  const file = fileURLToPath(url);
  if (relative(site, file).startsWith("..")) return "leads out of the site";
  if (!existsSync(file) || !/\.[a-z]+$/.test(file)) return "is not there";
  return anchor && file.endsWith(".html") && !idsOf(file).has(anchor) ? `has no #${anchor}` : undefined;
}

test("every page has sound links, says nothing in the console, fits a telephone, and can be read", async ({ page }) => {
  test.setTimeout(1_200_000);
  expect(pages.length).toBeGreaterThan(60);
  const said = complaints(page);
  const wrong: string[] = [];
  for (const file of pages) {
    await page.setViewportSize(telephone);
    await open(page, file);
    wrong.push(...said.splice(0).map((text) => `${file}: ${text}`));
    const links = await page.locator("a[href]").evaluateAll((all) => all.map((a) => (a as HTMLAnchorElement).href));
    for (const href of new Set(links)) {
      const problem = broken(href);
      if (problem) wrong.push(`${file}: ${decodeURI(href).replace(site, "")} ${problem}`);
    }
    const width = await page.evaluate(() => document.documentElement.scrollWidth);
    if (width > telephone.width) wrong.push(`${file}: ${width} px wide on a screen of ${telephone.width}`);
    await page.setViewportSize(desk);
    await page.evaluate(axe.source);
    const found = await page.evaluate(async () => {
      const run = (window as unknown as { axe: typeof axe }).axe;
      const rules = ["color-contrast", "image-alt", "link-name", "document-title", "html-has-lang", "duplicate-id"];
      const { violations } = await run.run(document.querySelector("main") ?? document, { runOnly: rules });
      return violations.flatMap((v) => v.nodes.map((node) => `${v.id}: ${node.html.slice(0, 120)}`));
    });
    wrong.push(...found.map((text) => `${file}: ${text}`));
  }
  expect(wrong).toEqual([]);
});

test("the search finds a page", async ({ page }) => {
  await page.setViewportSize(desk);
  await open(page, "index.html");
  await page.locator("#mdbook-search-toggle").click();
  await page.locator("#mdbook-searchbar").pressSequentially("aspect ratio");
  await expect(page.locator("#mdbook-searchresults li").first()).toBeVisible();
});

test("the atlas shows its designs, and one of them by its address", async ({ page }) => {
  const said = complaints(page);
  await page.setViewportSize(desk);
  await open(page, "site/atlas.html");
  const shown = page.getByText(/^\d+ of \d+ designs\.$/);
  await expect(shown).toBeVisible();
  const all = await shown.textContent();
  await page.getByLabel("Weave:").selectOption("1.1");
  await expect(shown).not.toHaveText(all!);
  await page.goto(`${page.url()}#1.1/0.1/1`);
  await expect(page.getByRole("heading", { name: "1.1, minor radius 0.1, spacing 1" })).toBeVisible();
  await expect(page.getByText("l1 from 0.44 along 0° to 0.77403; 13 of 13 limits proved")).toBeVisible();
  expect(said).toEqual([]);
});

test("every viewer opens from the disk and shows a sheet", async ({ page }) => {
  test.setTimeout(1_200_000);
  expect(viewers.length).toBeGreaterThan(30);
  const said = complaints(page);
  const wrong: string[] = [];
  for (const file of viewers) {
    await open(page, file);
    await expect(page.locator("canvas").first()).toBeVisible();
    wrong.push(...said.splice(0).map((text) => `${file}: ${text}`));
  }
  expect(wrong).toEqual([]);
});

test("the reference pages are there", async ({ page }) => {
  const said = complaints(page);
  for (const [file, title] of [["rust/maille_geometry/index.html", "maille_geometry"], ["python/maille.html", "maille"]]) {
    await open(page, file!);
    await expect(page).toHaveTitle(new RegExp(title!));
  }
  expect(said).toEqual([]);
});
