// Numbers, units and sentences as a person reads them.

import assert from "node:assert/strict";
import { test } from "node:test";

import * as words from "../../../app/page/modules/words.js";

words.learn({ parameters: [{ name: "beta", label: "Drive elevation" }], outputs: [] });

test("values with their units", () => {
  assert.equal(words.withUnit(0.35e-3, "m"), "0.35\u00a0mm");
  assert.equal(words.withUnit(-0.01, "m s-1"), "\u221210\u00a0mm/s");
  assert.equal(words.withUnit(25, "degree"), "25°");
  assert.equal(words.withUnit(NaN, "m"), "no value");
});

test("what is nothing but rounding is 0", () => assert.equal(words.number(1e-17, 4, 1), "0"));

test("sentences of the service have the names and units of the page", () => {
  const told = words.sentence({ message: "gravity is -1 m s-2", fix: "It must be at least 0 m s-2" });
  assert.equal(told, "Gravity is -1 m/s². It must be at least 0 m/s².");
  const other = words.sentence({ message: "beta is 500 degree", fix: "It must be at most 90 degree." });
  assert.equal(other, "Angle of vibration is 500°. It must be at most 90°.");
});

test("the fixed values of a view in one line", () => {
  const view = { values: { beta: 20 }, choice: "thesis" };
  const scene = { parameters: [{ name: "beta", unit: "degree" }, { name: "alpha", unit: "degree" }] };
  assert.equal(words.valuesTold(view, scene), "Angle of vibration 20°, thesis");
});

test("durations", () => {
  assert.equal(words.duration(3), "3 s");
  assert.equal(words.duration(300), "5 minutes");
  assert.equal(words.duration(9000), "2.5 hours");
});
