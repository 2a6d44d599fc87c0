// The state of the page: one frozen view, and resources derived from it.

import { batch, computed, effect, signal, untracked } from "../vendor/signals-core.mjs";
import { Refusal } from "./service.js";
import { sentence } from "./words.js";

export { batch, computed, effect, signal, untracked };

// A value with fewer values, while something is held, is of the same view.
export const COARSE = "&held";
const isOfSame = (one, other) => one?.replace(COARSE, "") === other?.replace(COARSE, "");
const LATE = 100; // ms after which a value that is not of the view is dimmed

/** @typedef {import("./view.js").View} View */

export class Store {
  constructor() {
    this.view = signal(/** @type {View | null} */ (null));
    this.scene = signal(/** @type {any} */ (null)); // of the view, as the service describes it
    this.held = signal(/** @type {{name?: string, from?: number, to?: number} | null} */ (null)); // what is dragged
  }
}

const NOTHING = Object.freeze({ status: "none", of: null, value: null, reason: "", isLate: false, isPartial: false, job: null });

/**
 * A resource that the service computes of the view. Its state says of which view its value is:
 * {status, of, value, reason, isLate, isPartial, job}, the status `none`, `computing`, `ready`, `asking` or `failed`.
 * A reply of another view is dropped; while something is held, values of a moment ago are shown, and dimmed when
 * they are late.
 */
export class Derived {
  /**
   * @param {Store} store
   * @param {{key: (view: any, scene: any) => string | null, ask: (view: any, scene: any, how: any) => Promise<any>,
   *   persist: (task: () => Promise<any>) => Promise<any>}} options `key` is null where there is nothing to ask
   */
  constructor(store, { key, ask, persist }) {
    this.store = store;
    this.key = key;
    this.ask = ask;
    this.persist = persist;
    this.state = signal(/** @type {any} */ (NOTHING));
    this.running = null; // {key, abort, isJob}
    effect(() => this.follow(store.view.value, store.scene.value, store.held.value));
  }

  follow(view, scene, held) {
    const key = view && scene ? this.key(view, scene) : null;
    untracked(() => {
      this.wanted = key === null ? null : { key, view, scene, held };
      if (key === null) {
        this.stop();
        this.set(NOTHING);
      } else if (key === this.state.value.of && !this.state.value.isPartial && ["ready", "failed", "asking"].includes(this.state.value.status)) {
        this.stop();
      } else if (this.running?.key !== key) this.begin();
    });
  }

  // Ask again, also what was cancelled or was not begun without consent.
  again(more = {}) {
    if (!this.wanted) return;
    this.stop();
    this.wanted.more = more;
    this.begin();
  }

  // Stop asking; the value of before stays, dimmed.
  cancel(reason) {
    this.stop();
    this.set({ ...this.state.value, status: "failed", reason, isLate: true });
  }

  begin() {
    const { value: now } = this.state;
    const isOf = isOfSame(now.of, this.wanted.key);
    if (now.status !== "computing") this.set({ ...now, status: "computing", reason: "", job: null, isLate: now.isLate && !isOf });
    this.clock();
    if (this.running && this.wanted.held && !this.running.isJob) return; // it comes soon, and is shown meanwhile
    this.stop({ isTimed: true });
    this.run();
  }

  // Dim the value where it does not become that of the view soon.
  clock() {
    this.late ??= setTimeout(() => {
      this.late = null;
      const { value: now } = this.state;
      if (now.status === "computing" && now.value !== null && !isOfSame(now.of, this.wanted?.key)) this.set({ ...now, isLate: true });
    }, LATE);
  }

  stop({ isTimed = false } = {}) {
    this.running?.abort.abort();
    this.running = null;
    if (isTimed) return;
    clearTimeout(this.late);
    this.late = null;
  }

  set(state) {
    this.state.value = Object.freeze(state);
  }

  async run() {
    const { key, view, scene, held, more } = this.wanted;
    const abort = new AbortController();
    const running = { key, abort, isJob: false };
    this.running = running;
    const isWanted = () => this.running === running;
    const land = (value, state = {}) => {
      if (!isWanted()) return;
      const isOf = this.wanted.key === key;
      if (!isOf && !this.wanted.held) return;
      clearTimeout(this.late);
      this.late = null;
      this.set({ ...NOTHING, status: isOf && !state.isPartial ? "ready" : "computing", of: key, value, ...state });
      if (!isOf) this.clock();
    };
    const tell = (job) => {
      running.isJob = true;
      if (!isWanted()) return;
      if (this.wanted.key !== key) this.begin();
      else this.set({ ...this.state.value, job });
    };
    const show = (value) => land(value, { isPartial: true });
    const end = (state) => isWanted() && this.wanted.key === key && this.set({ ...NOTHING, of: key, ...state });
    try {
      const value = await this.persist(() => this.ask(view, scene, { signal: abort.signal, tell, show, held, ...more }));
      if (value?.asking) end({ status: "asking", value: value.found ?? null, reason: value.asking });
      else land(value);
    } catch (error) {
      if (error.name === "AbortError" || !isWanted()) return;
      const { errors = [], message } = error;
      if (error instanceof Refusal) end({ status: "failed", reason: errors[0] ? sentence(errors[0]) : message, errors });
      else {
        reportError(error); // a fault of this page
        end({ status: "failed", reason: "The page has an error. Change a value, or reload the page." });
      }
    } finally {
      if (isWanted()) {
        this.running = null;
        if (this.wanted && this.wanted.key !== key) this.begin();
      }
    }
  }
}
