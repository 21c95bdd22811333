// Writes the type of the templates' elements by their ids: `node elements.mjs TEMPLATES OUTPUT`.
// An id that stands in several templates has the type of all of them; ids with template expressions are left out.

import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const [, , folder, output] = process.argv;
const TAG = /<([a-z][a-z0-9]*)\b[^>]*?\sid="([^"{}]+)"/g;
const SVG = new Set(["svg", "title", "desc"]);

/** Type of an element by its tag; within an `svg`, titles and descriptions are the drawing's. */
const typeOf = (tag, id) =>
  SVG.has(tag) && (tag === "svg" || id.includes("drawing")) ? `SVGElementTagNameMap["${tag}"]` : `HTMLElementTagNameMap["${tag}"]`;

const types = new Map();
for (const name of readdirSync(folder).filter((name) => name.endsWith(".html")).sort()) {
  for (const [, tag, id] of readFileSync(join(folder, name), "utf8").matchAll(TAG)) {
    types.set(id, (types.get(id) ?? new Set()).add(typeOf(tag, id)));
  }
}
if (types.size === 0) throw new Error(`no element with an id in ${folder}`);
const lines = [...types].sort().map(([id, of]) => `  ${JSON.stringify(id)}: ${[...of].join(" | ")};`);
writeFileSync(output, `interface TemplateElements {\n${lines.join("\n")}\n}\n`);
