import { defineConfig } from "@playwright/test";
import viewer from "../playwright.config";

// The static site, opened from the disk. `cargo xtask site` sets SITE, its folder.
export default defineConfig({ ...viewer, testDir: ".", outputDir: "../test-results/site" });
