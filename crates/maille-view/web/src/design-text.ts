// The text of a design file: numbers and tables as it has them. Values are changed by the program.

import type { Design, RingSpec } from "./types";

/** A number as TOML reads it, not as an integer. */
export function toml(x: number): string {
  return Number.isInteger(x) ? x.toFixed(1) : String(x);
}

export function tomlVector(v: readonly number[]): string {
  return `[${v.map(toml).join(", ")}]`;
}

/** A name without spaces, for designs and files. */
export function plainName(typed: string): string {
  return typed.trim().replace(/\s+/g, "-");
}

function ringTable({ major_radius, normal, offset, minor_radius }: RingSpec): string {
  const moved = offset.some(Boolean) ? `, offset = ${tomlVector(offset)}` : "";
  const wire = minor_radius == null ? "" : `, minor_radius = ${toml(minor_radius)}`;
  return `{ major_radius = ${toml(major_radius)}, normal = ${tomlVector(normal)}${moved}${wire} }`;
}

/** The text with another element, of one flat ring or of `rings`, and its name. */
export function withRing(
  text: string,
  design: Design | null,
  center: readonly number[],
  rings?: RingSpec[],
): [string, string] {
  const names = new Set(design?.elements.map((e) => e.name));
  let k = (design?.elements.length ?? 0) + 1;
  while (names.has(`ring-${k}`)) k += 1;
  const name = `ring-${k}`;
  const flat: RingSpec = { major_radius: design?.reference_radius ?? 1, normal: [0, 0, 1], offset: [0, 0, 0] };
  const list = (rings ?? [flat]).map(ringTable).join(", ");
  const table = `[[elements]]\nname = "${name}"\ncenter = ${tomlVector(center)}\nrings = [${list}]\n`;
  return [`${text.trimEnd()}\n\n${table}`, name];
}

/** The text without an element's lines; comments of others stay. None where the element is no table of its own. */
export function withoutElement(text: string, index: number): string | null {
  const lines = text.split("\n");
  const heads = lines.flatMap((line, at) => (/^\s*\[\[\s*elements\s*\]\]/.test(line) ? [at] : []));
  const from = heads[index];
  if (from === undefined) return null;
  let to = lines.findIndex((line, at) => at > from && /^\s*\[(?!\[\s*elements\s*\.)/.test(line));
  if (to < 0) to = lines.length;
  lines.splice(from, to - from);
  return lines.join("\n");
}
