import { defineConfig } from "@playwright/test";

// Debian's Chromium, drawing in software. `cargo xtask test` sets MAILLE, the program with the viewer. SMOOTH=1 smooths edges, as
// pictures of the guide need: without it the tests take less time.
export default defineConfig({
  testDir: "tests",
  outputDir: "test-results",
  timeout: 120_000,
  expect: { timeout: 60_000 },
  workers: 1,
  reporter: [["list"]],
  use: {
    browserName: "chromium",
    viewport: { width: 1440, height: 900 },
    acceptDownloads: true,
    contextOptions: { reducedMotion: "reduce" },
    launchOptions: {
      executablePath: process.env["CHROMIUM"] ?? "/usr/bin/chromium",
      // The page itself is not drawn by WebGL's software. With edges that are not smoothed that halves the processor time.
      args: [
        "--no-sandbox",
        "--use-gl=angle",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        "--disable-gpu-compositing",
        ...(process.env["SMOOTH"] ? [] : ["--webgl-antialiasing-mode=none"]),
      ],
    },
  },
});
