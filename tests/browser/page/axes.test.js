// Places on an axis are numbers that a picture takes, whatever was typed.

import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.window = { d3: { ticks: () => [] } };
const { axisOf } = await import("../../../app/page/modules/axes.js");

test("a value far away has a place far away", () => {
  const axis = axisOf({ name: "beta", unit: "degree", values: [0, 30, 60] }, 62, 462);
  assert.equal(axis.place(30), 262);
  assert.ok(axis.place(-1e308) < -1e5 && Number.isFinite(axis.place(-1e308)));
  assert.ok(axis.place(1e308) > 1e5 && Number.isFinite(axis.place(1e308)));
  assert.equal(axis.value(262), 30);
});
