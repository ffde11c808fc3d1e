import { defineConfig } from "vite";

// The atlas's script, in one file that a page opened from the disk can run.
export default defineConfig({
  define: { "process.env.NODE_ENV": JSON.stringify("production") },
  build: {
    target: "es2022",
    outDir: process.env["OUT"] ?? "../test-results/atlas",
    emptyOutDir: false,
    chunkSizeWarningLimit: 1200,
    lib: { entry: "site/atlas.ts", formats: ["iife"], name: "atlasPage", fileName: () => "atlas.js" },
  },
});
