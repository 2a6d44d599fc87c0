// A view by its amplitude, or by its stroke from peak to peak, has the same designs.

import assert from "node:assert/strict";
import { test } from "node:test";

import { usualBest } from "../../../app/page/modules/criterion.js";
import { hasChoice, restated } from "../../../app/page/modules/sets.js";

const VIEW = {
  question: "speed",
  kind: "simulate",
  scene: "rectangle-on-plane",
  choice: "",
  output: "conveying_velocity",
  x: { name: "beta", from: 5, to: 60 },
  y: { name: "amplitude", from: 0.0001, to: 0.001 },
  values: { frequency: 50, beta: 20, amplitude: 0.0005 },
  pins: [{ amplitude: 0.00025, beta: 10 }],
  best: { ...usualBest(), vary: [{ name: "amplitude", from: 0.0001, to: 0.0004 }] },
};
const scene = { parameters: [{ name: "amplitude" }, { name: "peak_to_peak" }, { name: "beta" }] };

test("each amplitude is doubled, and all else is as it was", () => {
  const patch = restated(VIEW, "stroke");
  assert.deepEqual(patch.y, { name: "peak_to_peak", from: 0.0002, to: 0.002 });
  assert.deepEqual(patch.x, VIEW.x);
  assert.deepEqual(patch.values, { frequency: 50, beta: 20, peak_to_peak: 0.001 });
  assert.deepEqual(patch.pins, [{ peak_to_peak: 0.0005, beta: 10 }]);
  assert.deepEqual(patch.best.vary, [{ name: "peak_to_peak", from: 0.0002, to: 0.0008 }]);
  const back = restated({ ...VIEW, ...patch }, null);
  for (const [name, value] of Object.entries(back)) assert.deepEqual(value, VIEW[name] ?? null, name);
});

test("the choice is there for a sine of a scene that takes both", () => {
  assert.ok(hasChoice(VIEW, scene));
  assert.ok(!hasChoice({ ...VIEW, set: "ellipse" }, scene));
  assert.ok(!hasChoice(VIEW, { parameters: [{ name: "amplitude" }] }));
  assert.ok(!hasChoice({ ...VIEW, y: null, values: {} }, scene));
});
