// A link restores the view that made it, and nothing of it is believed.

import assert from "node:assert/strict";
import { test } from "node:test";

import { usualBest } from "../../../app/page/modules/criterion.js";
import { designOf, fromLink, pictureOf, toLink } from "../../../app/page/modules/link.js";
import { givenValues, typical, unusual, usual, widened } from "../../../app/page/modules/view.js";

const VIEW = {
  question: "drive",
  kind: "simulate",
  scene: "rectangle-on-plane",
  choice: "",
  output: "conveying_velocity",
  x: { name: "amplitude", from: 1e-4, to: 7e-4 },
  y: null,
  values: { amplitude: 0.0002, frequency: 50, friction: 0.1 + 0.2 },
  band: { name: "friction", share: 0.2 },
  set: "ellipse",
  runs: [[0.0001, 0.0035], [0.0002, 0.0076]],
  pins: [{ amplitude: 0.0001, friction: 0.2 }],
  best: { ...usualBest(), kind: "limit", against: "hop_height", limit: 0.25, given: { radius: 0.3 } },
};

test("a link restores its view to the last digit", () => {
  const { wanted, complaints } = fromLink(toLink(VIEW));
  assert.deepEqual(complaints, []);
  for (const name of ["question", "kind", "scene", "output", "x", "y", "band", "best", "set", "runs"]) {
    assert.deepEqual(wanted[name], VIEW[name], name);
  }
  assert.deepEqual({ ...wanted.values }, VIEW.values);
  assert.deepEqual(wanted.pins.map((pin) => ({ ...pin })), VIEW.pins);
  assert.equal(toLink({ ...VIEW, ...wanted }), toLink(VIEW));
});

test("pictures differ by what is no axis, designs by every value", () => {
  const other = { ...VIEW, values: { ...VIEW.values, amplitude: 0.0003 } };
  assert.equal(pictureOf(other), pictureOf(VIEW));
  assert.notEqual(designOf(other), designOf(VIEW));
});

test("a value that its question begins with is not unusual", () => {
  assert.equal(unusual({ name: "load", unit: "1", example: 1 }, 9, 9), "");
  assert.equal(unusual({ name: "load", unit: "1", example: 1 }, 20, 9), "");
  assert.match(unusual({ name: "load", unit: "1", example: 1 }, 30, 9), /^Above the usual/);
});

test("an axis reaches beyond a value that has left it, within the bounds", () => {
  const scene = { parameters: [{ name: "frequency", lower: 0, upper: null }, { name: "gamma", lower: -90, upper: 90 }] };
  const view = (frequency, gamma) => ({ x: { name: "frequency", from: 40, to: 60 }, y: { name: "gamma", from: -10, to: 10 }, values: { frequency, gamma } });
  const ends = ({ x, y }) => [x.from, x.to, y.from, y.to];
  assert.deepEqual(ends(widened(view(50, 0), scene)), [40, 60, -10, 10]);
  assert.deepEqual(ends(widened(view(100, 80), scene)), [40, 120, -10, 90]);
  assert.deepEqual(ends(widened(view(10, -20), scene)), [8, 60, -24, 10]);
});

test("each part of a link that makes no sense is said once", () => {
  for (const link of [
    "#question=why", "#x=beta", "#x=beta:5:5", "#x=beta:9:1", "#p.beta=", "#p.beta=1e999", "#band=beta:2",
    `#${"x".repeat(5000)}`, "#best=fastest", "#best=limit&limit=-1",
    "#set=none", "#runs=1:2", "#runs=1,2", "#pin=amplitude", "#pin=a:1&pin=b:x",
  ]) {
    assert.equal(fromLink(link).complaints.length, 1, link);
  }
});

test("names that every object has are names like others", () => {
  const { wanted } = fromLink("#p.__proto__=5&p.constructor=1");
  assert.equal({}.polluted, undefined);
  assert.deepEqual(Object.keys(wanted.values), ["__proto__", "constructor"]);
});

test("a value that a parameter has by itself is not unusual", () => {
  const restitution = { name: "restitution", unit: "1", default: 0, usual: [0.1, 1] };
  assert.equal(unusual(restitution, 0), "");
  assert.match(unusual(restitution, 0.05), /^Below the usual/);
});

test("what is usual lies within the bounds, in order", () => {
  for (const parameter of [
    { unit: "degree", lower: -90, upper: 30 },
    { unit: "m", lower: 0, example: 0.001 },
    { unit: "1", lower: -1, upper: 0, default: -0.5 },
    { unit: "1", default: 0 },
  ]) {
    const [low, high] = usual(parameter);
    assert.ok(low < high);
    assert.ok(low >= (parameter.lower ?? -Infinity) && high <= (parameter.upper ?? Infinity));
    assert.ok(Number.isFinite(typical(parameter)));
  }
});

test("a value that is the service's own is not given", () => {
  assert.deepEqual(givenValues({ values: { a: 1, b: 2 }, own: { a: 1, b: 3 } }), { b: 2 });
});

test("a value outside of what is usual is said, in the unit of the page", () => {
  const amplitude = { name: "amplitude", unit: "m", example: 0.0005 };
  assert.equal(unusual(amplitude, 0.0005), "");
  assert.equal(unusual(amplitude, 0.005), "Above the usual 0.1\u00a0mm to 1\u00a0mm.");
  assert.equal(unusual({ name: "friction", unit: "1", usual: [0.05, 0.6] }, 0.01), "Below the usual 0.05 to 0.6.");
});
