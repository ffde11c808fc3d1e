// The Khronos validator on GLB files: `node check_gltf.mjs FILE…`. No error and no warning is accepted.
import { createRequire } from "node:module";
import { readFileSync } from "node:fs";

// The packages lie beside the working directory, not beside this file.
const require = createRequire(process.cwd() + "/");
const validator = require("gltf-validator");

let failed = false;
for (const file of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), { maxIssues: 0 });
  const { numErrors, numWarnings, numInfos, messages } = report.issues;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos; ` +
    `${report.info.drawCallCount} draw calls, ${report.info.totalTriangleCount} triangles`);
  for (const m of messages.filter((m) => m.severity < 2).slice(0, 10)) console.log(`  ${m.code} ${m.pointer}: ${m.message}`);
  for (const code of new Set(messages.map((m) => m.code))) console.log(`  says ${code}`);
  failed ||= numErrors + numWarnings > 0;
}
process.exit(failed ? 1 : 0);
