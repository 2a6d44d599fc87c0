// A job that nobody waits for any more is ended, also where the service is away at first.

import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.document = { baseURI: "http://127.0.0.1/" };
globalThis.sessionStorage = { getItem: () => null };
const { carryOut } = await import("../../../app/page/modules/service.js");

test("a job that is left is dismissed as soon as the service answers", async (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  const job = { jobID: "1", status: "accepted" };
  const abort = new AbortController();
  let refusals = 2;
  globalThis.fetch = async (address, { method = "GET", signal }) => {
    if (method === "POST") return new Response(JSON.stringify(job), { status: 201 });
    if (method === "DELETE") {
      if (refusals-- > 0) throw new TypeError("the service is away");
      return new Response("{}");
    }
    abort.abort(); // while its state is asked for
    signal.throwIfAborted();
  };
  const done = carryOut("simulate", {}, { signal: abort.signal });
  const rejected = assert.rejects(done, { name: "AbortError" });
  const soon = () => new Promise((turn) => setImmediate(turn));
  for (let k = 0; k < 4; k++) {
    await soon();
    context.mock.timers.tick(1000);
  }
  await rejected;
  assert.equal(refusals, -1);
});

test("a job whose reply is on its way as it is left is dismissed, too", async () => {
  const job = { jobID: "2", status: "accepted" };
  const abort = new AbortController();
  const asked = [];
  let answer;
  globalThis.fetch = (address, { method = "GET" }) => {
    asked.push(method);
    return method === "POST" ? new Promise((done) => (answer = done)) : Promise.resolve(new Response("{}"));
  };
  const leaving = carryOut("simulate", {}, { signal: abort.signal });
  abort.abort();
  await assert.rejects(leaving, { name: "AbortError" });
  answer(new Response(JSON.stringify(job), { status: 201 }));
  await new Promise((turn) => setImmediate(turn));
  assert.deepEqual(asked, ["POST", "DELETE"]);
});
