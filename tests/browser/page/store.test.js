// What the service says of one view never stands for another.

import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.document = /** @type {any} */ ({ baseURI: "http://127.0.0.1/" });
globalThis.sessionStorage = /** @type {any} */ ({ getItem: () => null });
const { Refusal } = await import("../../../app/page/modules/service.js");
const { Derived, Store } = await import("../../../app/page/modules/store.js");

const tick = () => new Promise((done) => setTimeout(done, 0));

function derived() {
  const store = new Store();
  store.scene.value = {};
  const asked = [];
  const found = new Derived(store, {
    key: (view) => view.name,
    ask: (view, _, how) =>
      new Promise((done, fail) => {
        asked.push({ name: view.name, done, fail, how });
        how.signal.addEventListener("abort", () => fail(how.signal.reason));
      }),
    persist: (task) => task(),
  });
  const see = (name, held = null) => {
    store.held.value = held;
    store.view.value = { name };
  };
  return { found, asked, see };
}

test("a value is of the view that was asked for", async () => {
  const { found, asked, see } = derived();
  assert.equal(found.state.value.status, "none");
  see("a");
  assert.equal(found.state.value.status, "computing");
  asked[0].done(1);
  await tick();
  const { status, of, value, isLate } = found.state.value;
  assert.deepEqual([status, of, value, isLate], ["ready", "a", 1, false]);
});

test("a reply of another view cannot land", async () => {
  const { found, asked, see } = derived();
  see("a");
  see("b");
  asked[0].done("of a");
  asked[1].done("of b");
  await tick();
  assert.deepEqual([found.state.value.of, found.state.value.value], ["b", "of b"]);
  assert.ok(asked[0].how.signal.aborted);
});

test("a value that does not follow soon is late, and no longer so when it has followed", async () => {
  const { found, asked, see } = derived();
  see("a");
  asked[0].done(1);
  await tick();
  see("b");
  assert.deepEqual([found.state.value.value, found.state.value.isLate], [1, false]);
  await new Promise((done) => setTimeout(done, 150));
  assert.deepEqual([found.state.value.value, found.state.value.of, found.state.value.isLate], [1, "a", true]);
  asked[1].done(2);
  await tick();
  assert.deepEqual([found.state.value.value, found.state.value.isLate], [2, false]);
});

test("while a slider is held values of a moment ago are shown, and the last one comes", async () => {
  const { found, asked, see } = derived();
  see("a", {});
  see("b", {});
  see("c", {});
  assert.equal(asked.length, 1);
  asked[0].done("of a");
  await tick();
  assert.deepEqual([found.state.value.value, found.state.value.status], ["of a", "computing"]);
  assert.equal(asked[1].name, "c");
  see("c");
  asked.at(-1).done("of c");
  await tick();
  assert.deepEqual([found.state.value.value, found.state.value.status], ["of c", "ready"]);
});

test("a refusal is of its view as well, and leaves no number", async () => {
  const { found, asked, see } = derived();
  see("a");
  asked[0].done(1);
  await tick();
  see("b");
  asked[1].fail(new Refusal(422, { detail: "No." }));
  await tick();
  assert.deepEqual([found.state.value.status, found.state.value.value, found.state.value.reason], ["failed", null, "No."]);
});
