// Colours change only as much as values do, in steps at round values, both signs on one scale.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { runInThisContext } from "node:vm";

const file = new URL("../../../app/page/vendor/d3-array.min.js", import.meta.url);
runInThisContext(readFileSync(file, "utf8"));
globalThis.window = globalThis;
const { bandOf, scaleOf } = await import("../../../app/page/modules/colours.js");

const colourAt = (scale, value) => scale.bands[bandOf(scale, value)];
const light = (colour) => colour.reduce((sum, part) => sum + part, 0);

test("steps are round, and hold all values", () => {
  const { low, high, step, bands } = scaleOf([13, 287, 120, NaN]);
  assert.deepEqual([low, high, step], [0, 300, 20]);
  assert.equal(bands.length, 15);
  assert.deepEqual([scaleOf([41, 59]).low, scaleOf([41, 59]).high], [41, 59]);
});

test("nothing to draw has no scale", () => assert.equal(scaleOf([NaN, Infinity]), null));

test("a constant has a colour", () => {
  for (const value of [5, 0, -3]) {
    const scale = scaleOf([value, value]);
    assert.ok(scale.low <= value && scale.high > value && colourAt(scale, value));
  }
});

test("both sides of zero get darker alike, each in a colour of its own", () => {
  const scale = scaleOf([-300, -50, 0, 300]);
  for (const value of [60, 130, 290]) {
    const [forwards, backwards] = [colourAt(scale, value), colourAt(scale, -value)];
    assert.ok(forwards[2] > forwards[0], "blue");
    assert.ok(backwards[0] > backwards[2], "orange");
    assert.ok(light(forwards) < light(colourAt(scale, value - 60)));
    assert.ok(light(backwards) < light(colourAt(scale, 60 - value)));
  }
  assert.ok(light(colourAt(scale, 0)) > 680, "zero is light");
});

test("values of one sign begin at zero where that is near", () => {
  assert.equal(scaleOf([20, 100]).low, 0);
  assert.equal(scaleOf([-100, -20]).high, 0);
});

test("what sticks out far is cut", () => {
  const values = Array.from({ length: 1000 }, (_, i) => i / 1000);
  values.push(1e6);
  const scale = scaleOf(values);
  assert.ok(scale.high < 2);
  assert.deepEqual(colourAt(scale, 1e6), scale.bands.at(-1));
});
