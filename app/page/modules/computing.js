// Computing the picture of a view: one computation at a time, what it waits for said over the picture,
// and what was cancelled or is wrong, too.

import { byId, reveal } from "./elements.js";
import { LETTERS } from "./pins.js";
import { Refusal, cancelled, isPassing, left } from "./service.js";
import { duration } from "./words.js";

const DIMMED_AFTER = 100; // ms without the picture of the fields
const CALM = 300; // ms in which nothing is changed, before borders are looked for

// For screen readers, and whoever waits for the picture.
export function busy(isBusy) {
  byId("picture").setAttribute("aria-busy", String(isBusy));
}

export class Computing {
  // `view()` is the one that is shown now, `isOpen()` whether no other is being opened; `note(job,
  // view)` hears how the job of a view stands.
  constructor({ view, isOpen, source, picture, controls, notice, note }) {
    this.view = view;
    this.isOpen = isOpen;
    this.source = source;
    this.picture = picture;
    this.controls = controls;
    this.notice = notice;
    this.note = note;
    this.isComputing = false;
    this.waiting = null; // what is to be computed next
  }

  // One computation at a time; of the changes meanwhile only the last counts.
  async compute(how) {
    this.sharpening?.abort(left());
    if (this.isComputing) {
      this.waiting = how;
      if (how.dragged) this.source.ahead(this.view(), how.dragged);
      else this.abort?.abort(left());
      return;
    }
    this.isComputing = true;
    busy(true);
    try {
      let next = how;
      while (next) {
        this.waiting = null;
        try {
          const { view, found } = (await this.computeOnce(next)) ?? {};
          if (found?.y && !next.dragged && !this.waiting) this.sharpen(view, found);
        } catch (error) {
          reportError(error); // a fault of this page: the next view is drawn all the same
          this.picture.dim("Not drawn: the page has an error. Change a value, or reload the page.");
        }
        next = this.waiting;
      }
    } finally {
      this.isComputing = false;
      if (this.isOpen()) busy(false); // else another view is being opened
    }
  }

  async computeOnce({ dragged = null, isFirst = false }) {
    const view = this.view();
    const abort = new AbortController();
    this.abort = abort;
    const { signal } = abort;
    const again = { text: "Compute", onclick: () => this.compute({}) };
    let isShown = false; // a picture of this view
    let isCancelled = false;
    const cancel = {
      text: "Cancel",
      onclick: () => {
        isCancelled = true;
        abort.abort(cancelled());
      },
    };
    const tell = (job) => {
      this.note(job, view);
      if (signal.aborted) return;
      reveal();
      const more = job.secondsLeft ? `, ${duration(job.secondsLeft)} left` : "";
      const told = `${job.message} ${job.progress} %${more}`;
      if (isShown) this.picture.tell(told, cancel);
      else this.picture.dim(told, cancel);
    };
    const show = (found, how) => {
      signal.throwIfAborted();
      clearTimeout(dimming);
      isShown = true;
      this.picture.show(found, view, how);
    };
    const started = performance.now();
    const dimming = setTimeout(() => this.picture.dim("Computing ...", cancel), DIMMED_AFTER);
    try {
      const found = await this.draw(view, { dragged, isFirst, signal, tell, show });
      this.controls.clear();
      if (!isFirst) this.notice.tell(); // a word about a link stays
      const seconds = (performance.now() - started) / 1000;
      byId("progress").textContent = dragged ? "" : `Shown after ${duration(seconds)}.`;
      return { view, found };
    } catch (error) {
      if (error.name === "AbortError") {
        if (!isCancelled || this.waiting) return null;
        if (isShown) this.picture.undim();
        else this.picture.dim("Cancelled.", again);
        byId("progress").textContent = isShown ? "Cancelled: the picture is a preview with fewer values." : "";
        reveal();
        return null;
      }
      byId("progress").textContent = "";
      if (!(error instanceof Refusal)) throw error;
      reveal();
      this.refuse(error, again);
      return null;
    } finally {
      clearTimeout(dimming);
    }
  }

  // The picture, coarse before fine, with lines of pinned designs and what is not known exactly.
  async draw(view, { dragged, isFirst, signal, tell, show }) {
    const persist = (task) => this.notice.persist(task);
    if (isFirst && view.kind === "simulate" && view.y) {
      show(await persist(() => this.source.coarse(view, { signal, tell })));
    }
    let found;
    do {
      found = await persist(() => this.source.compute(view, { dragged, signal, tell }));
      show(found, { isMoving: dragged !== null });
    } while (!dragged && this.source.isWorthMore(view));
    if (view.pins?.length && !view.y && !dragged) {
      const others = await Promise.all(
        view.pins.map(async (pin, i) => {
          const one = { ...view, values: { ...view.values, ...pin }, band: null };
          delete one.values[view.x.name];
          return { text: `design ${LETTERS[i]}`, found: await this.source.compute(one, { signal }) };
        }),
      );
      signal.throwIfAborted();
      this.picture.showOthers(found, others);
    }
    if (view.band && !dragged && view.question !== "drive") {
      const band = await persist(() => this.source.band(view, { signal }));
      signal.throwIfAborted();
      this.picture.showBand(found, band, view.band);
    }
    return found;
  }

  // Where the borders in a map lie between its cells: asked for once the map stands and nothing changes.
  async sharpen(view, found) {
    this.sharpening = new AbortController();
    const { signal } = this.sharpening;
    await new Promise((done) => setTimeout(done, CALM));
    if (signal.aborted) return;
    try {
      const edges = await this.source.between(view, found, { signal });
      if (edges && !signal.aborted) this.picture.sharpen(found, edges);
    } catch (error) {
      // The map stands without them.
      if (error.name !== "AbortError" && !(error instanceof Refusal) && !isPassing(error)) reportError(error);
    }
  }

  // What the service objects to: beside the fields that it concerns, and over the picture.
  refuse(error, again) {
    this.controls.clear();
    const rest = this.controls.complain(error.errors);
    this.notice.tell(error.errors.length ? rest.slice(0, 1) : []);
    const wrong = [...this.controls.wrong(), ...rest];
    if (wrong.length) this.picture.dim(`Not drawn. ${wrong.join(" ")}`);
    else this.picture.dim(`Not drawn. ${error.message}`, again);
  }
}
