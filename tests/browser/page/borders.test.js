// Borders between cells: without steps, and never on the other side of a cell's middle.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { runInThisContext } from "node:vm";

for (const name of ["d3-array", "d3-contour"]) {
  const file = new URL(`../../../app/page/vendor/${name}.min.js`, import.meta.url);
  runInThisContext(readFileSync(file, "utf8"));
}
globalThis.window = globalThis;
const { ringsAround } = await import("../../../app/page/modules/borders.js");

const COUNT = 100;
const isRight = (x, y) => y > 20 + 0.1 * x; // a straight border that climbs a cell in ten

function ring(edges = null) {
  const at = (i, j) => Number(isRight(i, j));
  const [[found]] = ringsAround({ nx: COUNT, ny: COUNT, at }, (value) => value === 1, edges);
  // d3 has the middle of a cell at its number and a half
  const inside = (v) => v > 10 && v < COUNT - 10;
  return found.map((point) => point.map((v) => v - 0.5)).filter((point) => point.every(inside));
}

const farthest = (points) => Math.max(...points.map(([x, y]) => Math.abs(y - 20 - 0.1 * x)));

test("a straight border has no steps", () => {
  const points = ring();
  const slopes = points.slice(1).map(([x, y], k) => (y - points[k][1]) / (x - points[k][0]));
  assert.ok(points.length > 50);
  assert.ok(Math.max(...slopes.map((slope) => Math.abs(slope - 0.1))) < 0.1, "no part of it is flat, none is steep");
  assert.ok(farthest(points) < 0.3, "of a cell");
});

test("no cell comes to the other side", () => {
  for (const [x, y] of ring()) {
    // It lies between two neighbours, above each other or side by side.
    assert.ok(!isRight(Math.ceil(x), Math.floor(y)) && isRight(Math.floor(x), Math.ceil(y)));
  }
});

test("what is known between cells brings it nearer", () => {
  const times = 3;
  const across = (i, j) => Number(isRight(i / times, j));
  const up = (i, j) => Number(isRight(i, j / times));
  assert.ok(farthest(ring({ times, across, up })) < 0.1);
});
