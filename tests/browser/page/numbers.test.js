// Typed numbers: such as people type, and such as are none.

import assert from "node:assert/strict";
import { test } from "node:test";

import { fieldText, readNumber } from "../../../app/page/modules/fields.js";

const NUMBERS = [
  ["0.3", "1", 0.3],
  ["0,3", "1", 0.3],
  ["25 %", "1", 0.25],
  ["0.35", "m", 0.35e-3], // fields of lengths are in mm
  ["0,350 mm", "m", 0.35e-3],
  ["350 µm", "m", 0.35e-3],
  ["3000 rpm", "Hz", 50],
  ["3000 1/min", "Hz", 50],
  ["1e-3", "1", 1e-3],
  ["\u22125°", "degree", -5],
  ["2 g", "m s-2", 19.6133],
  ["1.2", "kg", 1.2e-3], // fields of masses are in g
];
const NONSENSE = [
  ["", "1"], ["abc", "1"], ["1e400", "1"], ["1/0", "1"], ["0.06k", "Hz"],
  ["3 mm", "Hz"], ["1,000", "Hz"], ["1 2", "1"], ["((((", "1"], ["__proto__", "1"],
  ["5 constructor", "1"], ["9".repeat(100), "1"],
];

// Factors of units are rounded, and so is each product with them.
const near = (value, wanted) => Math.abs(value - wanted) <= 1e-15 * Math.abs(wanted);

for (const [text, unit, value] of NUMBERS) {
  test(`"${text}" in ${unit}`, () => {
    const read = readNumber(text, unit);
    assert.deepEqual(Object.keys(read), ["value"]);
    assert.ok(near(read.value, value), `${read.value} is not ${value}`);
  });
}

for (const [text, unit] of NONSENSE) {
  test(`"${text}" in ${unit} is none`, () => {
    assert.deepEqual(Object.keys(readNumber(text, unit)), ["problem"]);
  });
}

test("what a field shows is read as what it shows", () => {
  for (const [, unit, value] of NUMBERS) {
    const read = readNumber(fieldText(value, unit), unit);
    assert.ok(Math.abs(read.value - value) <= 1e-6 * Math.abs(value)); // six digits
  }
});
