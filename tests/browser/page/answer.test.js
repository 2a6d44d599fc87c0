// A front has a knee where it bends.

import assert from "node:assert/strict";
import { test } from "node:test";

import { isBent } from "../../../app/page/modules/answer.js";

const front = (...points) => points.map(([speed, cost]) => ({ values: { speed: { value: speed }, cost: { value: cost } } }));

test("a straight front has no knee to be named", () => {
  assert.ok(!isBent(front([10, 4], [7.6, 3], [5, 2]), "speed", "cost"));
});

test("a bent one has, whatever the signs", () => {
  assert.ok(isBent(front([10, -4], [9, -2], [5, -1]), "speed", "cost"));
});

test("one of a single design, or without a range, has none", () => {
  assert.ok(!isBent(front([10, 4]), "speed", "cost"));
  assert.ok(!isBent(front([10, 4], [10, 4]), "speed", "cost"));
});
