// Borders between cells have no steps, and stay where they are.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { runInThisContext } from "node:vm";

for (const name of ["d3-array", "d3-contour"]) {
  const file = new URL(`../../../app/page/vendor/${name}.min.js`, import.meta.url);
  runInThisContext(readFileSync(file, "utf8"));
}
globalThis.window = globalThis;
const { ringsAround } = await import("../../../app/page/modules/layers.js");

test("a straight border has no steps, and is where the regimes change", () => {
  const values = Array.from({ length: 100 }, (_, i) => i);
  const at = (i, j) => Number(j > 20 + 0.1 * i); // it climbs a cell in ten
  const [[ring]] = ringsAround({ x: { values }, y: { values }, regime: { at } }, (value) => value === 1);
  // d3 has the middle of a cell at its number and a half; the ends of the grid are another matter
  const points = ring.map((point) => point.map((v) => v - 0.5)).filter((point) => point.every((v) => v > 10 && v < 90));
  const slopes = points.slice(1).map(([x, y], k) => (y - points[k][1]) / (x - points[k][0]));
  assert.ok(points.length > 50);
  assert.ok(Math.max(...slopes.map((slope) => Math.abs(slope - 0.1))) < 0.25, `${slopes}`);
  assert.ok(Math.max(...points.map(([x, y]) => Math.abs(y - 20 - 0.1 * x))) < 0.6, "of a cell");
});
