// The page: a question, the fields that answer it, the picture, and what can be taken away.

import { Accuracy } from "./accuracy.js";
import { Away as TakeAway } from "./away.js";
import { Catalogue } from "./catalogue.js";
import { Source } from "./computed.js";
import { Controls } from "./controls.js";
import { byId, reveal } from "./elements.js";
import { tellFigures, viewOf } from "./figures.js";
import { Jobs } from "./jobs.js";
import { tellMeaning } from "./meaning.js";
import { MotionAtPoint } from "./motion.js";
import { Notice } from "./notice.js";
import { begun, complete } from "./opening.js";
import { Optimum } from "./optimum.js";
import { PartHere } from "./part.js";
import { Picture } from "./picture.js";
import { tellQuestions } from "./questions.js";
import { Refusal, get } from "./service.js";
import { fromLink, toLink } from "./view.js";
import { duration, valuesTold } from "./words.js";

const DIMMED_AFTER = 100; // ms without the picture of the fields

// For screen readers, and whoever waits for the picture.
function busy(isBusy) {
  byId("picture").setAttribute("aria-busy", String(isBusy));
}

class Page {
  constructor() {
    this.source = new Source();
    this.notice = new Notice(byId("notice"));
    this.catalogue = new Catalogue((path) => this.notice.persist(() => get(path)));
    this.jobs = new Jobs(byId("jobs"));
    this.controls = new Controls(byId("controls"), (view, how) => this.changed(view, how));
    this.picture = new Picture({
      onpick: (point) => this.pick(point, { isSeen: true }),
      onpoint: (point) => this.optimum.pointed(point),
    });
    this.motion = new MotionAtPoint(byId("detail"), byId("course"), {
      notice: this.notice,
      onshown: (point, course) => {
        this.picture.mark([{ ...point, text: "" }], "chosen");
        this.part.tell(point, course);
      },
    });
    this.part = new PartHere(byId("part"), (point) => {
      this.isChosen = true;
      return this.pick(point);
    });
    this.isComputing = false;
    this.waiting = null; // what is to be computed next
    this.isChosen = false; // whether the next address is a step that can be undone
    this.turn = 0; // of views that were opened: the last one counts
    byId("skip").addEventListener("click", (event) => {
      event.preventDefault(); // the address is that of the view
      byId("headline").focus();
    });
  }

  async start() {
    this.tellQuestions(fromLink(location.hash).wanted.question ?? "speed");
    const [friction] = await Promise.all([this.catalogue.ask("/friction"), this.catalogue.load()]);
    this.controls.frictions = friction.pairs;
    const study = () => this.source.study(this.view);
    const tell = (job) => this.jobs.note(job);
    this.optimum = new Optimum(byId("optimum"), {
      beside: byId("beside"),
      onmark: (marks) => this.picture.mark(marks, "best"),
      onchoose: (at) => this.choose(at),
      onwish: () => this.keep(this.view),
      steps: () => this.picture.steps(),
      persist: (task) => this.notice.persist(task),
      tell,
    });
    const best = () => this.optimum.study();
    const picture = (what) => (what === "best" && this.optimum.front) || this.picture.drawing;
    const told = () => ({
      title: byId("headline").textContent,
      lines: [valuesTold(this.view, this.seen)],
      link: location.href,
    });
    this.away = new TakeAway(byId("away"), { study, best, picture, told, tell });
    this.accuracy = new Accuracy(byId("accuracy"), { study, tell });
    window.addEventListener("hashchange", () => {
      if (location.hash !== this.link) this.restore();
    });
    get("/healthz").then(({ version }) => (byId("version").textContent = version), () => {});
    await this.restore();
  }

  async restore() {
    this.isChosen = false;
    busy(true);
    const { wanted, complaints } = fromLink(location.hash);
    const question = wanted.question ?? "speed";
    if (question === "thesis" && !wanted.scene) {
      await this.openFigure(null, complaints);
      return;
    }
    const known = this.catalogue.scene(wanted.scene);
    if (wanted.scene && !known) complaints.push("The link names a system that there is not.");
    const begin = begun(question);
    // What a question begins with need not be there in another system, or the other way to look.
    const isOther = ["scene", "kind"].some((name) => name in wanted && wanted[name] !== begin[name]);
    if (isOther) begin.output = "";
    const view = { ...begin, ...wanted, question, scene: known ? wanted.scene : begin.scene };
    if (view.kind === "simulate" && !this.catalogue.scene(view.scene).methods.length) view.kind = "sweep";
    await this.open(view, { complaints });
  }

  async openFigure(figure, complaints = []) {
    const figures = await this.catalogue.figures();
    const chosen = figure ?? figures.find(({ name }) => name === "fig-5-1") ?? figures[0];
    await this.open(viewOf(chosen), { complaints });
  }

  // Show another view. What an `isSwitching` user leaves behind needs no word.
  async open(view, { complaints = [], isSwitching = false } = {}) {
    const turn = (this.turn += 1);
    const isLeft = () => turn !== this.turn;
    busy(true);
    let scene;
    try {
      scene = await this.catalogue.describe(view);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      complaints.push(`There is no ${view.kind === "sweep" ? "variant" : "method"} of that name here.`);
      view.choice = "";
      scene = await this.catalogue.describe(view);
    }
    if (isLeft()) return;
    const made = complete(view, scene);
    complaints.push(...made.complaints, ...(isSwitching ? [] : made.foreign));
    this.view = view;
    this.seen = scene;
    this.tellQuestions(view.question);
    this.controls.show(view, this.catalogue.scenes, scene);
    this.picture.begin(view, scene);
    tellMeaning(byId("meaning").lastElementChild, view, scene);
    document.querySelector("main").classList.remove("opening");
    this.part.show(view, scene);
    if (isSwitching && view.best) view.best.isFound = false;
    const left = await this.tellWhatElse();
    if (isLeft()) return;
    if (!isSwitching) complaints.push(...left);
    this.notice.tell(complaints.slice(0, 1));
    const drawn = this.compute({ isFirst: true });
    if (view.point) await this.pick(view.point);
    else byId("detail").hidden = true;
    await drawn;
    if (!isLeft() && view.question === "drive" && view.best.isFound) await this.optimum.find();
  }

  tellQuestions(current) {
    tellQuestions(byId("questions"), current, (question) => {
      this.isChosen = true;
      return question === "thesis" ? this.openFigure(null) : this.open(begun(question));
    });
  }

  // What a question has besides the picture and its fields. Returns what makes no sense in it.
  async tellWhatElse() {
    const { question, figure } = this.view;
    byId("figures").hidden = question !== "thesis";
    byId("optimum").hidden = question !== "drive";
    this.away.offer(question === "drive");
    if (question === "drive") return this.optimum.show(this.view, this.seen);
    this.optimum.forget();
    if (question === "thesis") {
      const figures = await this.catalogue.figures();
      tellFigures(byId("figures"), figures, figure, (chosen) => {
        this.isChosen = true;
        return this.openFigure(chosen);
      });
    }
    return [];
  }

  async changed(view, { dragged, isNew = false }) {
    if (!dragged) this.isChosen = true;
    if (isNew) {
      await this.open({ ...view, point: null }, { isSwitching: true });
      return;
    }
    this.view = view;
    const drawn = this.compute({ dragged });
    if (view.point) this.motion.follow(view, this.seen);
    await drawn;
  }

  // One computation at a time; of the changes meanwhile only the last counts.
  async compute(how) {
    if (this.isComputing) {
      this.waiting = how;
      if (how.dragged) this.source.ahead(this.view, how.dragged);
      else this.abort?.abort();
      return;
    }
    this.isComputing = true;
    busy(true);
    try {
      let next = how;
      while (next) {
        this.waiting = null;
        try {
          await this.computeOnce(next);
        } catch (error) {
          reportError(error); // a fault of this page: the next view is drawn all the same
          this.picture.dim("Not drawn: the page has met a fault of its own. Change a value, or load it anew.");
        }
        next = this.waiting;
      }
    } finally {
      this.isComputing = false;
      busy(false);
    }
  }

  async computeOnce({ dragged = null, isFirst = false }) {
    const { view } = this;
    this.abort = new AbortController();
    const { signal } = this.abort;
    const tell = (job) => this.tellJob(job);
    const started = performance.now();
    if (!dragged) this.keep(view); // also where the picture takes long: the address is of the fields
    const dimming = setTimeout(() => this.picture.dim("Computing ..."), DIMMED_AFTER);
    try {
      if (isFirst && view.kind === "simulate" && view.y) {
        const coarse = await this.notice.persist(() => this.source.coarse(view, { signal, tell }));
        signal.throwIfAborted();
        clearTimeout(dimming);
        this.picture.show(coarse);
      }
      let found;
      do {
        found = await this.notice.persist(() => this.source.compute(view, { dragged, signal, tell }));
        signal.throwIfAborted();
        clearTimeout(dimming);
        this.picture.show(found, { isMoving: dragged !== null });
      } while (!dragged && this.source.isWorthMore(view));
      this.controls.clear();
      if (!isFirst) this.notice.tell(); // a word about a link stays
      if (view.band && !dragged) {
        const band = await this.notice.persist(() => this.source.band(view, { signal }));
        signal.throwIfAborted();
        this.picture.showBand(found, band, view.band);
      }
      const seconds = (performance.now() - started) / 1000;
      byId("progress").textContent = dragged ? "" : `Shown after ${duration(seconds)}.`;
    } catch (error) {
      if (error.name === "AbortError") return;
      byId("progress").textContent = "";
      if (!(error instanceof Refusal)) throw error;
      reveal();
      this.picture.dim("Not drawn: this picture shows other values.");
      this.controls.clear();
      const rest = this.controls.complain(error.errors);
      this.notice.tell(error.errors.length ? rest.slice(0, 1) : [error.message]);
      const wrong = this.controls.wrong();
      if (wrong.length) byId("progress").textContent = `Not drawn. ${wrong.join(" ")}`;
    } finally {
      clearTimeout(dimming);
    }
    if (view.question === "drive") this.optimum.grown();
    if (!dragged) this.keep(view);
  }

  // The address restores the view; what somebody chose can be undone by going back.
  keep(view) {
    this.link = toLink(view);
    const isStep = this.isChosen && this.link !== location.hash;
    this.isChosen = false;
    if (isStep) history.pushState(null, "", this.link);
    else history.replaceState(null, "", this.link);
  }

  tellJob(job) {
    this.jobs.note(job);
    reveal();
    const left = job.secondsLeft ? `, ${duration(job.secondsLeft)} left` : "";
    byId("progress").textContent = `${job.message} ${job.progress} %${left}`;
  }

  // Show a drive as a whole: its point, and the values that are no axes.
  async choose(at) {
    const { view } = this;
    const moved = Object.keys(at).filter((name) => name in view.values && view.values[name] !== at[name]);
    for (const name of moved) view.values[name] = at[name];
    if (moved.length) {
      this.controls.show(view, this.catalogue.scenes, this.seen);
      await this.compute({});
    }
    await this.pick({ x: at[view.x.name], y: view.y ? at[view.y.name] : null });
  }

  // `isSeen` where the motion is to be brought into sight.
  async pick(point, { isSeen = false } = {}) {
    const { view } = this;
    if (!this.catalogue.scene(view.scene)?.methods.length) return;
    view.point = point;
    this.keep(view);
    await this.motion.follow(this.view, this.seen);
    if (isSeen) byId("course").scrollIntoView({ block: "nearest" });
  }
}

const page = new Page();
page.start();
