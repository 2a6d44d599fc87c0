// The answers in numbers, units and sentences.

import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.document = /** @type {any} */ ({ baseURI: "http://127.0.0.1/" });
globalThis.sessionStorage = /** @type {any} */ ({ getItem: () => null });
const { answerTo, aspectsOf, liftOff } = await import("../../../app/page/modules/answers.js");

const SCENE = {
  name: "rectangle-on-plane",
  outputs: [{ name: "conveying_velocity", unit: "m s-1" }, { name: "hop_height", unit: "m" }],
  parameters: [{ name: "friction", unit: "1" }, { name: "amplitude", unit: "m" }],
  regimes: [{ name: "neutral", description: "nothing conveys the part" }],
};
const values = { amplitude: 0.0005, beta: 20, frequency: 50, friction: 0.3 };

function answered(view, data, more = {}) {
  const variables = Object.fromEntries(Object.entries(data).map(([name, one]) => [name, { data: one }]));
  if (data.regime) variables.regime = { data: 1, flags: { [data.regime]: 1 } };
  return answerTo({ view: { values, question: "speed", output: "conveying_velocity", scene: SCENE.name, ...view }, scene: SCENE, dataset: { variables }, ...more });
}

test("a speed has its band, and tells of the hop", () => {
  const band = { name: "friction", low: 0.0414, high: 0.0578, from: 0.2, to: 0.4 };
  const { number, unit, sentence, strip } = answered({}, { conveying_velocity: 0.0499216, hop_height: 0.0001486, regime: "hopping" }, { band });
  assert.deepEqual([number, unit], ["49.9", "mm/s"]);
  assert.equal(sentence, "41 to 58 mm/s for friction 0.2 to 0.4; hops 0.15\u00a0mm.");
  assert.deepEqual([strip.low, strip.high], [0.0414, 0.0578]);
});

test("what does not hop says what it does", () => {
  assert.equal(answered({}, { conveying_velocity: 0, hop_height: 0, regime: "stick" }).sentence, "Friction holds it.");
  assert.equal(answered({}, { conveying_velocity: 0, regime: "neutral" }).sentence, "Nothing conveys the part.");
});

test("a part lifts off where the throw number is 1", () => {
  assert.equal(liftOff("amplitude", values, 2), 0.00025);
  assert.equal(liftOff("frequency", values, 4), 25);
  assert.ok(Math.abs(Math.sin((liftOff("beta", values, 2) * Math.PI) / 180) - Math.sin(Math.PI / 9) / 2) < 1e-12);
  assert.equal(liftOff("beta", values, 0.2), null);
  assert.equal(liftOff("friction", values, 2), null);
});

test("aspects are brackets, the most frequent first", () => {
  const variables = { let_down_share_flat: { data: 0.65 }, thrown_share_flat: { data: 0.8 }, let_down_share_on_end: { data: 0.05 }, thrown_share_on_end: { data: 0.02 } };
  const [flat, end] = aspectsOf({ variables });
  assert.deepEqual([flat.name, flat.low, flat.high, end.low, end.high], ["flat", 0.65, 0.8, 0.02, 0.05]);
});
