// The program under test: a server for each test, in a folder of its own.

import { test as base, expect, type Page } from "@playwright/test";
import { execFileSync, spawn, type ChildProcess } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const PROGRAM = process.env["MAILLE"] ?? "";
if (!PROGRAM) throw new Error("MAILLE must name the program with the viewer; `cargo xtask test` sets it");

export interface Program {
  folder: string;
  /** Starts `maille view` with these arguments and gives its address. */
  view(...args: string[]): Promise<string>;
  /** Runs the program to its end. */
  run(...args: string[]): string;
}

export const test = base.extend<{ program: Program; problems: string[] }>({
  program: async ({}, use) => {
    const folder = mkdtempSync(join(tmpdir(), "maille-view-"));
    const children: ChildProcess[] = [];
    await use({
      folder,
      view: (...args) =>
        new Promise((resolve, reject) => {
          const child = spawn(PROGRAM, ["view", "--no-open", ...args], { cwd: folder });
          children.push(child);
          let said = "";
          const hear = (data: Buffer) => {
            said += data.toString();
            const address = /http:\/\/127\.0\.0\.1:\d+\//.exec(said);
            if (address) resolve(address[0]);
          };
          child.stdout.on("data", hear);
          child.stderr.on("data", hear);
          child.on("exit", (code) => reject(new Error(`the program ended with ${code}: ${said}`)));
        }),
      run: (...args) =>
        execFileSync(PROGRAM, args, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] }),
    });
    for (const child of children) {
      if (child.exitCode !== null) continue;
      const ended = new Promise<number | null>((resolve) => child.on("exit", resolve));
      child.kill("SIGINT");
      expect(await ended, "Ctrl-C ends it cleanly").toBe(0);
    }
    rmSync(folder, { recursive: true });
  },
  // No test may leave an error in the console. It needs the program, so that it is asked before the server ends: a page
  // may still be asking for something then.
  problems: [
    async ({ page, program: _ }, use) => {
      const problems: string[] = [];
      page.on("pageerror", (error) => problems.push(String(error)));
      page.on("console", (message) => {
        if (message.type() === "error" && !/status of 4\d\d|ERR_ABORTED/.test(message.text()))
          problems.push(message.text());
      });
      await use(problems);
      expect(problems).toEqual([]);
    },
    { auto: true },
  ],
});

/** Waits for the map to be complete. */
export async function solved(page: Page): Promise<void> {
  await expect(page.locator(".progress")).toHaveText(/^\d+ limits$/);
}

/** Clicks the map along a direction, as far out as `share` of its rim. */
export async function clickMap(page: Page, direction: number, share: number): Promise<void> {
  const map = page.locator("svg.map");
  await map.scrollIntoViewIfNeeded();
  const box = (await map.boundingBox())!;
  const [middle, rim] = [box.width / 2, box.width * (0.5 - 34 / 420)];
  const angle = (direction * Math.PI) / 180;
  await map.click({
    position: { x: middle + share * rim * Math.cos(angle), y: middle - share * rim * Math.sin(angle) },
  });
}

export { expect };
