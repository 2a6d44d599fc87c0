// Names of regimes stand beside marked points, and go back where they were.

import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.window = { d3: {} };
const { giveWay } = await import("../../../app/page/modules/marks.js");

function name(x, y) {
  const given = { x: String(x), y: String(y) };
  const text = { textContent: "Hopping", dataset: {}, getAttribute: (key) => given[key] };
  text.setAttribute = (key, value) => (given[key] = String(value));
  return text;
}

test("a name gives way to a ring on it, and comes back", () => {
  const [near, far] = [name(100, 100), name(300, 100)];
  const group = { children: [near, far] };
  giveWay(group, [[90, 99]]);
  assert.ok(Math.abs(Number(near.getAttribute("y")) - 4 - 99) >= 20);
  assert.equal(far.getAttribute("y"), "100");
  giveWay(group, [[90, 200]]);
  assert.equal(near.getAttribute("y"), "100");
});
