// Outputs in groups: each stands in one, what is asked most in front; a few need none.

import assert from "node:assert/strict";
import { test } from "node:test";

import { grouped } from "../../../app/page/modules/fields.js";

const NAMES = ["drive_power", "conveying_velocity", "hop_height", "stick_fraction", "length_scale", "drive_number"];
const outputs = [...NAMES, ..."abcdefg"].map((name) => ({ name, unit: name === "hop_height" ? "m" : "1" }));

test("each of many outputs stands in one group, what is asked most in front", () => {
  const groups = grouped(outputs, ({ name }) => name);
  assert.equal(groups[0][0], "Most asked");
  assert.deepEqual(groups[0][1], ["conveying_velocity", "hop_height"]);
  assert.deepEqual(groups.flatMap(([, list]) => list).sort(), outputs.map(({ name }) => name).sort());
});

test("a few outputs need no groups", () => {
  assert.deepEqual(grouped(outputs.slice(0, 3), ({ name }) => name), NAMES.slice(0, 3));
});
