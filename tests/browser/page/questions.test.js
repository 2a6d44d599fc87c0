// Each question is a record that a link can name; a set of parameters stands in place of others.

import assert from "node:assert/strict";
import { test } from "node:test";

import { QUESTIONS, begun } from "../../../app/page/modules/questions.js";
import { SETS, withSet } from "../../../app/page/modules/sets.js";
import { fromLink, toLink } from "../../../app/page/modules/link.js";
import { typical, usual } from "../../../app/page/modules/view.js";

test("a link names each question, and what it begins with comes back", () => {
  for (const question of Object.keys(QUESTIONS)) {
    const view = begun(question);
    const { wanted, complaints } = fromLink(toLink(view));
    assert.deepEqual(complaints, []);
    assert.equal(wanted.question, question);
    for (const name of ["kind", "scene", "output", "runs", "band", "set"]) {
      assert.deepEqual(wanted[name], view[name], `${question}: ${name}`);
    }
  }
});

test("what is begun is nobody else's", () => {
  begun("measured").values.frequency = 1;
  assert.equal(begun("measured").values.frequency, 50);
  assert.equal(begun("__proto__").scene, "rectangle-on-plane");
});

test("a set takes the place of what it stands for, in all outputs that ask for that", () => {
  const parameter = (name) => ({ name, unit: "1", default: null, example: 1, instead_of: [] });
  const scene = {
    parameters: ["frequency", "amplitude", "beta", "friction"].map(parameter),
    outputs: [{ name: "speed", asks: ["amplitude", "friction"], required: ["amplitude"] }, { name: "g", asks: ["friction"], required: [] }],
  };
  const other = withSet(scene, "ellipse");
  const names = Object.keys(SETS.ellipse.parameters);
  assert.deepEqual(other.parameters.map(({ name }) => name), ["frequency", ...names, "friction"]);
  assert.deepEqual(other.outputs[0], { name: "speed", asks: [...names, "friction"], required: names });
  assert.deepEqual(other.outputs[1], scene.outputs[1]);
  for (const one of other.parameters) {
    const [low, high] = usual(one);
    assert.ok(typical(one) >= low && typical(one) <= high, one.name);
  }
  assert.equal(withSet(scene, "nothing"), scene);
});
