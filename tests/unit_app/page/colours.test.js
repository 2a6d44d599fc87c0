// Colours change only as much as values do: no scale flips where values change their sign.

import assert from "node:assert/strict";
import { test } from "node:test";

import { scaleOf } from "../../../app/page/modules/colours.js";

function colourAt({ low, high, lut, steps }, value) {
  const at = 3 * Math.round(((value - low) / (high - low)) * (steps - 1));
  return [...lut.slice(at, at + 3)];
}

const apart = (one, other) => Math.max(...one.map((part, c) => Math.abs(part - other[c])));
// A step of the table, and the 2 % of the scale that the least value moves.
const CLOSE = 20;

test("the ends are those of the values", () => {
  const { low, high } = scaleOf([3, 1, 2, NaN]);
  assert.deepEqual([low, high], [1, 3]);
});

test("nothing to draw has no scale", () => assert.equal(scaleOf([NaN, Infinity]), null));

test("a constant has a colour", () => {
  const { low, high } = scaleOf([5, 5, 5]);
  assert.ok(low < 5 && high > 5);
});

test("a scale that reaches a little below 0 has the colours of one that does not", () => {
  const before = scaleOf([0, 100, 200, 300]);
  for (const least of [-1e-12, -1, -5]) {
    const after = scaleOf([least, 100, 200, 300]);
    for (const value of [0, 100, 200, 300]) {
      assert.ok(apart(colourAt(before, value), colourAt(after, value)) <= CLOSE, `${value} with ${least}`);
    }
  }
});

test("both sides of 0 have the same measure, and colours of their own", () => {
  const scale = scaleOf([-50, 0, 100]);
  assert.ok(apart(colourAt(scale, 0), [68, 1, 84]) <= CLOSE);
  assert.ok(colourAt(scale, 100)[1] > 200); // yellow
  const [red, , blue] = colourAt(scale, -50);
  assert.ok(red > blue); // warm
  assert.ok(apart(colourAt(scale, -50), colourAt(scale, 50)) > 60);
});

test("one value that sticks out far does not take the colours of all others", () => {
  const { high } = scaleOf([...Array.from({ length: 1000 }, (_, i) => i / 1000), 1e6]);
  assert.ok(high < 2);
});
