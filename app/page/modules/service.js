// The public REST interface, as any client would use it.

const KEY = "vibrafeed-key"; // kept for the session of this tab only

export class Refusal extends Error {
  // What the service refused: its own sentences, and the fields that they concern.
  constructor(status, problem) {
    super(problem.detail || problem.title || `The service answered with status ${status}.`);
    this.status = status;
    this.errors = problem.errors ?? [];
    this.type = problem.type ?? "";
  }
}

export class Away extends Error {
  constructor() {
    super("The service does not answer.");
  }
}

// Whether to ask again: the service is away, busy or starting, or a proxy says so.
export function isPassing(error) {
  return error instanceof Away || [429, 502, 503, 504].includes(error.status);
}

export const key = {
  get: () => sessionStorage.getItem(KEY) ?? "",
  set: (text) => sessionStorage.setItem(KEY, text),
};

// The page lies at the root of the service, or under the path where a proxy shows it.
const BASE = new URL(".", document.baseURI).href.replace(/\/$/, "");

export function address(path) {
  return `${BASE}${path}`;
}

/**
 * @typedef {{method?: string, body?: object, headers?: Record<string, string>, signal?: AbortSignal}} Options
 * @param {string} path
 * @param {Options} options
 */
async function ask(path, { method = "GET", body, headers = {}, signal } = {}) {
  /** @type {Record<string, string>} */
  const sent = { ...headers };
  if (key.get()) sent.Authorization = `Bearer ${key.get()}`;
  if (body !== undefined) sent["Content-Type"] = "application/json";
  let reply;
  try {
    reply = await fetch(address(path), { method, headers: sent, body: body === undefined ? undefined : JSON.stringify(body), signal });
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Away();
  }
  if (!reply.ok) {
    let problem = {};
    try {
      problem = await reply.json();
    } catch {
      // a proxy's page, perhaps
    }
    throw new Refusal(reply.status, problem);
  }
  return reply;
}

/** @param {string} path @param {Options} [options] */
export async function get(path, options) {
  return (await ask(path, { headers: { Accept: "application/json" }, ...options })).json();
}

/** @param {string} path @param {object} body @param {Options} options */
export async function put(path, body, options = {}) {
  const reply = await ask(path, { method: "POST", body, ...options });
  return { status: reply.status, content: await reply.json() };
}

// The text that a body is answered with.
export async function text(path, body) {
  return (await ask(path, { method: "POST", body, headers: { Accept: "text/plain" } })).text();
}

export async function remove(path) {
  await ask(path, { method: "DELETE" });
}

// End the jobs that are followed as the page goes away, when nobody waits for a reply.
export function abandon() {
  const headers = key.get() ? { Authorization: `Bearer ${key.get()}` } : {};
  for (const id of followed) fetch(address(`/jobs/${id}`), { method: "DELETE", headers, keepalive: true }).catch(() => {});
}

export async function file(path, accept) {
  const reply = await ask(path, { headers: accept ? { Accept: accept } : {} });
  return reply.blob();
}

// A slice of a sweep: {header, values: Float64Array, regime: Int8Array or null}.
export async function slice(id, output, axes, fixed, signal) {
  const query = new URLSearchParams({ output, axes: axes.join(","), format: "binary" });
  for (const [name, value] of Object.entries(fixed)) query.set(name, String(value));
  const reply = await ask(`/sweeps/${id}/slice?${query}`, { signal });
  const bytes = await reply.arrayBuffer();
  const start = 8 + Number(new DataView(bytes).getBigUint64(0, true));
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 8, start - 8)));
  const array = ({ dtype, offset, shape }) => {
    const size = shape.reduce((n, m) => n * m, 1);
    return dtype === "<f8"
      ? new Float64Array(bytes, start + offset, size)
      : new Int8Array(bytes, start + offset, size);
  };
  return {
    header,
    axes: header.axes.map((axis) => ({ ...axis, values: array(axis.values) })),
    values: array(header.values.data),
    dims: header.values.dims,
    regime: header.regime ? array(header.regime.data) : null,
    regimeDims: header.regime ? header.regime.dims : [],
  };
}

// Carry out a study: at once if the service does so, else as a job whose state `tell` hears.
// Returns the dataset as JSON, and the seconds that it took, or null if it was there before.
/**
 * @param {string} process
 * @param {object} study
 * @param {{tell?: (job: any) => void, signal?: AbortSignal}} options
 */
export async function carryOut(process, study, { tell, signal } = {}) {
  const { status, content } = await posted(`/processes/${process}/execution`, study, signal);
  if (status !== 201) return { dataset: content, seconds: content.attributes.elapsed_seconds ?? null };
  try {
    const job = await follow(content, tell, signal);
    const dataset = await get(`/jobs/${job.jobID}/results/dataset`, { signal });
    const seconds = (Date.parse(job.finished) - Date.parse(job.started)) / 1000;
    return { dataset, seconds: seconds > 0 ? seconds : null };
  } catch (error) {
    if (error.name === "AbortError") leave(content);
    throw error;
  }
}

// A reply that may be a job. One that is on its way as nobody waits for it any more still comes: else its job
// would have nobody who ends it.
async function posted(path, study, signal) {
  signal?.throwIfAborted();
  const abort = new AbortController();
  const reply = put(path, study, { signal: abort.signal });
  if (!signal) return reply;
  const leaving = new Promise((_, fail) => signal.addEventListener("abort", () => fail(signal.reason)));
  try {
    return await Promise.race([reply, leaving]);
  } catch (error) {
    if (signal.aborted) {
      setTimeout(() => abort.abort(), ON_ITS_WAY);
      reply.then(({ status, content }) => status === 201 && leave(content), () => {});
    }
    throw error;
  }
}

// Have the service end a job that nobody waits for any more, so that others have their turn; where it is
// away, as soon as it answers.
async function leave(job) {
  for (;;) {
    try {
      return await remove(`/jobs/${job.jobID}`);
    } catch (error) {
      if (!isPassing(error)) return null; // it may be over
    }
    await pause();
  }
}

// Ask for a job until it is over; `tell` hears of each change.
/** @param {any} job @param {(job: any) => void} [tell] @param {AbortSignal} [signal] */
export async function follow(job, tell, signal) {
  followed.add(job.jobID);
  try {
    let before = "";
    for (;;) {
      const now = `${job.message} ${job.progress}`;
      if (now !== before) tell?.(job);
      before = now;
      if (OVER.has(job.status)) break;
      await pause();
      signal?.throwIfAborted();
      job = await get(`/jobs/${job.jobID}`, { signal }).catch((error) => {
        if (!isPassing(error)) throw error;
        return { ...job, message: "The service does not answer; the page asks again." };
      });
    }
  } finally {
    followed.delete(job.jobID);
  }
  if (job.status !== "successful") throw new Refusal(200, { detail: job.message });
  return job;
}

const OVER = new Set(["successful", "failed", "dismissed"]);
const PAUSE = 250; // ms
const ON_ITS_WAY = 300; // ms
const followed = new Set(); // the jobs that are waited for
const pause = () => new Promise((done) => setTimeout(done, PAUSE));
