// The page: a question, its answer, the pictures and fields of it, and what can be taken away.

import { HOP, answerTo, liesTold } from "./answers.js";
import { tellAspects } from "./aspects.js";
import { Away } from "./away.js";
import { completeBest } from "./best.js";
import { Catalogue } from "./catalogue.js";
import { Source, bandAt, bandOver, design, sineOf, valueOf } from "./computed.js";
import { Controls } from "./controls.js";
import { courseOf, modeAt, MODES, platoonsAt } from "./course.js";
import { Curves } from "./curves.js";
import { byId } from "./elements.js";
import { Headline } from "./headline.js";
import { tellDevices, tellFigures, tellMeaning, tellValues, viewOf } from "./lists.js";
import { mattersOf, mattersStudy, tellMatters } from "./matters.js";
import { Measured, fitTold } from "./measured.js";
import { designOf, fromLink, pictureOf, toLink } from "./link.js";
import { Notice } from "./notice.js";
import { complete } from "./opening.js";
import { Optimum } from "./optimum.js";
import { Panels } from "./panels.js";
import { Picture, ringOf } from "./picture.js";
import { LETTERS, Pins } from "./pins.js";
import { tellMoves } from "./plate.js";
import { Player } from "./player.js";
import { QUESTIONS, begun } from "./questions.js";
import { STROKE, isSet, takes, takesBoth, withSet } from "./sets.js";
import { Refusal, abandon, get } from "./service.js";
import { tellSheet } from "./sheet.js";
import { Stage } from "./stage.js";
import { COARSE, Derived, Store, batch, effect, untracked } from "./store.js";
import { Surface, surfaceStudy } from "./surface.js";
import { frozen, unusual, widened } from "./view.js";
import { tellWaves } from "./waves.js";
import { capital, duration, learn, number, valuesTold, words } from "./words.js";

// What of a view asks for other fields, or another picture.
const OPENED_ANEW = ["kind", "scene", "choice", "set", "recording", "output", "x", "y", "band"];
const TABS = ["stage", "picture", "detail"];
const LISTED = new Set(["thesis", "all"]);

class Page {
  constructor() {
    this.store = new Store();
    this.notice = new Notice(byId("notice"));
    this.catalogue = new Catalogue((path) => this.notice.persist(() => get(path)));
    this.source = new Source();
    this.isStepped = false; // a step of this page can be undone by going back
    this.opening = null; // what is being opened
    this.drawn = null; // the values that are drawn
    this.isDrawnHeld = false; // while something was dragged
    this.curve = null;
    this.derive();
    this.compose();
    this.render();
  }

  // What the service computes of the view.
  derive() {
    const { store, source } = this;
    const persist = (task) => this.notice.persist(task);
    const derived = (key, ask) => new Derived(store, { key, ask, persist });
    this.answer = derived(
      (view) => designOf({ ...view, band: null }) + LISTED.has(view.question),
      (view, scene, how) => design(view, scene, how, { isList: LISTED.has(view.question), hasPath: true }),
    );
    const isBanded = (view) => view.kind === "simulate" && Boolean(view.band) && view.band.name in view.values;
    this.band = derived((view) => (isBanded(view) ? designOf(view) : null), bandAt);
    const hasSine = (view) => view.question === "waves" && view.set === "ellipse" && view.output === "conveying_velocity" && store.held.value === null;
    this.sine = derived((view) => (hasSine(view) ? designOf({ ...view, band: null }) : null), sineOf);
    const isCoarse = (view) => store.held.value !== null && view.kind === "simulate";
    this.map = derived(
      (view) => pictureOf({ ...view, band: view.y || !isBanded(view) ? null : view.band }) + (isCoarse(view) ? COARSE : ""),
      async (view, scene, how) => {
        const found = await source.map(view, scene, how);
        if (view.y || how.held || !isBanded(view) || found.asking) return found;
        how.show(found);
        return { ...found, ...(await bandOver(view, scene, how)) };
      },
    );
    this.matters = derived((view, scene) => (store.held.value === null && mattersStudy(view, scene) ? JSON.stringify(mattersStudy(view, scene)) : null), mattersOf);
    this.measured = new Measured(byId("measured"), (runs) => this.setView({ runs }));
    this.fit = derived(
      (view) => {
        const study = store.held.value === null ? this.measured.study(view) : null;
        return study && JSON.stringify(study);
      },
      (view, scene, how) =>
        view.choice && view.choice !== scene.methods[0] && !how.isAgreed
          ? { asking: "This method takes long to compare with what was measured." }
          : this.measured.fit(view, scene, how),
    );
    const around = (view) => [view.x, view.y].find((axis) => axis?.name === "frequency") ?? { name: "frequency", from: 20, to: 100 };
    const isResonant = ({ question, output }, scene) => question === "springs" && scene.outputs.find(({ name }) => name === output).asks.includes("frequency");
    this.resonance = derived(
      (view, scene) => (isResonant(view, scene) ? pictureOf({ ...view, x: around(view), y: null, band: null }) : null),
      (view, _, how) => source.line(view, around(view), how),
    );
  }

  // The parts of the page, and what they do.
  compose() {
    const setView = (patch, how) => this.setView(patch, how);
    const move = (values, { isOver }) => this.setView({ values: { ...this.view.values, ...values } }, { held: isOver ? null : {} });
    const point = ({ x, y }) => {
      const { view } = this;
      return { [view.x.name]: x, ...(view.y && y !== undefined && y !== null ? { [view.y.name]: y } : {}) };
    };
    this.headline = new Headline();
    this.controls = new Controls(setView);
    this.picture = new Picture({
      onpick: (at) => move(point(at), { isOver: true }),
      ondrag: (at, how) => move(point(at), how),
    });
    this.stage = new Stage(byId("stage-host"), move);
    this.panels = new Panels();
    byId("panels-host").prepend(this.panels.svg);
    this.player = new Player((time, turns) => this.moment(time, turns));
    new ResizeObserver(() => requestAnimationFrame(() => this.drawPanels())).observe(byId("panels-host"));
    this.surface = new Surface((surface) => this.setView({ surface }));
    this.pins = new Pins(byId("pins"), { persist: (task) => this.notice.persist(task), onpins: (pins) => this.setView({ pins }), onshow: (values) => this.setView({ values: { ...this.view.values, ...values } }) });
    byId("keep").addEventListener("click", () => this.pins.pin(this.view));
    this.optimum = new Optimum(
      this.store,
      { chips: byId("chips"), told: byId("best-told"), wishes: byId("wishes"), front: byId("front") },
      {
        setView,
        mark: (marks, whose) => (marks === null ? this.ring() : this.picture.mark(marks, whose)),
        persist: (task) => this.notice.persist(task),
        pin: (designs) => this.pins.pin(this.view, designs),
      },
    );
    this.away = new Away({
      study: (what) => (what === "best" ? this.optimum.study() : this.view.surface ? surfaceStudy(this.view) : this.source.study(this.view)),
      picture: () => (this.view.question === "drive" && this.optimum.front) || this.picture.drawing,
      told: () => ({ title: `${byId("headline").textContent} ${capital(words(this.view.output))}`, lines: [valuesTold(this.view, this.store.scene.value)], link: location.href }),
    });
    byId("skip").addEventListener("click", (event) => {
      event.preventDefault(); // the address is that of the view
      byId("headline").focus();
    });
    byId("limits").addEventListener("click", () => {
      byId("expert").open = true;
      document.getElementById("add-limit")?.click();
    });
    for (const id of TABS) {
      byId(`tab-${id}`).addEventListener("click", () => {
        this.tab = id;
        this.tabs();
      });
    }
    const choice = byId("choose-question");
    choice.addEventListener("change", () => this.ask(choice.value));
    for (const one of byId("questions").querySelectorAll("button")) one.addEventListener("click", () => this.ask(one.id.replace("question-", "")));
  }

  get view() {
    return this.store.view.peek();
  }

  // Every picture of the page follows the state.
  render() {
    const seen = (draw) =>
      effect(() => {
        const [view, scene] = [this.store.view.value, this.store.scene.value];
        if (view && scene) draw(view, scene);
      });
    seen((view, scene) => this.renderAnswer(view, scene));
    seen((view) => this.renderMap(view));
    seen((view, scene) => this.renderDesign(view, scene));
    seen((view) => {
      const { state } = this.matters;
      if (view.question === "uncertain") tellMatters(byId("matters"), view, state.value);
    });
    seen((view, scene) => this.renderResonance(view, scene));
    seen((view, scene) => {
      const isHeld = this.store.held.value !== null;
      untracked(() => {
        if (!isHeld) this.pins.show(view, scene);
        this.tellPins(view);
      });
    });
  }

  renderAnswer(view, scene) {
    const state = this.answer.state.value;
    const { value: found } = state;
    const fit = view.question === "measured" ? this.fit.state.value : null;
    const band = this.band.state.value;
    const isBand = band.status === "ready" || band.isLate === false;
    const matters = this.matters.state.value.value;
    const map = this.map.state.value;
    const field = map.status === "ready" && map.value.field ? map.value : null;
    const waiting = this.notice.away.value;
    const { status, value } = this.sine.state.value;
    const sine = status === "ready" ? value : null;
    const search = view.question === "drive" ? this.optimum.searching(view) : null;
    let answer = null;
    let shown = state;
    if (fit && fit.status !== "none") {
      shown = fit;
      answer = fit.value ? fitTold(fit.value, scene) : null;
    } else if (found) answer = answerTo({ view, scene, dataset: found.dataset, band: isBand ? band.value : null, matters, sine, field });
    if (view.question === "drive" && answer) answer = { ...answer, strip: null, unit: `${answer.unit}${this.optimum.gain(view, valueOf(found.dataset, view.output))}` };
    untracked(() => {
      this.headline.show(shown, answer, { odd: this.oddity(view, scene), actions: this.actionsFor(view, shown, { fit, waiting, search }), waiting });
      if (["failed", "ready"].includes(state.status)) this.controls.complain(state.errors ?? []);
    });
  }

  // One click that helps, where there is no answer.
  actionsFor(view, state, { fit, waiting, search }) {
    if (waiting) return [{ text: "Ask now", onclick: () => this.notice.now() }];
    if (search) return [{ text: "Cancel the search", onclick: () => search.cancel("Cancelled.") }];
    if (state.status === "computing" && state.job) return [{ text: "Cancel", onclick: () => (fit ? this.fit : this.answer).cancel("Cancelled.") }];
    if (fit?.value && Math.abs(view.values[fit.value.name] - fit.value.value) > 5e-4 * fit.value.value) {
      return [{ text: `Use ${Number(fit.value.value.toPrecision(3))} as the ${words(fit.value.name)}`, onclick: () => this.controls.set(fit.value.name, Number(fit.value.value.toPrecision(4))) }];
    }
    if (state.status === "asking") return [{ text: "Compute it", onclick: () => this.fit.again({ isAgreed: true }) }];
    if (state.status !== "failed") return [];
    if (view.surface) return [{ text: "Show a plain shape", onclick: () => this.setView({ surface: null }) }];
    if (state.reason === "Cancelled.") return [{ text: "Compute", onclick: () => (fit ? this.fit : this.answer).again() }];
    return [this.isStepped ? { text: "Go back", onclick: () => history.back() } : { text: "Begin anew", onclick: () => this.ask(view.question) }];
  }

  // A sentence about the first value outside of what is usual.
  oddity(view, scene) {
    for (const [name, value] of Object.entries(view.values)) {
      const parameter = scene.parameters.find((one) => one.name === name);
      const told = parameter && unusual(parameter, value, view.begun?.[name]);
      if (told) return `${capital(words(name))}: ${told.slice(0, 1).toLowerCase()}${told.slice(1)}`;
    }
    return "";
  }

  renderMap(view) {
    const state = this.map.state.value;
    const waiting = this.notice.away.value;
    const answer = this.answer.state.value;
    untracked(() => {
      const isHeld = this.store.held.peek() !== null;
      const unit = this.store.scene.peek().outputs.find(({ name }) => name === view.output)?.unit;
      if (state.value && unit) state.value.z.unit = unit; // shares are told in per cent
      if (state.value && (this.drawn !== state.value || this.isDrawnHeld !== isHeld)) {
        this.picture.show(state.value, view, { isMoving: isHeld, isRough: state.isPartial || (state.status === "asking" && Boolean(state.value)) });
        [this.drawn, this.isDrawnHeld] = [state.value, isHeld];
      }
      this.tellMap(state, waiting);
      this.ring(answer.status === "ready" && !answer.isLate ? answer.value : null);
    });
  }

  tellMap(state, waiting) {
    const host = byId("picture");
    host.setAttribute("aria-busy", String(state.status === "computing" || this.opening !== null));
    const again = { text: "Compute", onclick: () => this.map.again() };
    const agree = { text: "Compute it", onclick: () => this.map.again({ isAgreed: true }) };
    const cancel = { text: "Cancel", onclick: () => this.map.cancel("Cancelled.") };
    const { job } = state;
    const told = job ? `${job.message} ${job.progress} %${job.secondsLeft ? `, ${duration(job.secondsLeft)} left` : ""}` : "";
    const isCancelled = state.reason === "Cancelled.";
    if (state.status === "asking") this.picture.dim(false, state.reason, agree);
    else if (state.status === "failed") this.picture.dim(true, isCancelled ? state.reason : `Not drawn. ${state.reason}`, isCancelled ? again : null);
    else if (waiting && state.isLate) this.picture.dim(true, `Old values. ${waiting}`, { text: "Ask now", onclick: () => this.notice.now() });
    else if (state.status === "computing") this.picture.dim(state.isLate && Boolean(state.value), told || (state.isLate ? "Old values" : ""), told ? cancel : null);
    else this.picture.dim(false);
    byId("progress").textContent = state.status === "ready" ? "Shown." : state.status === "computing" ? told : "";
  }

  // The design in the map, and its value.
  ring(found = this.answer.state.peek().value) {
    const { view } = this;
    const unit = this.store.scene.peek().outputs.find(({ name }) => name === view.output)?.unit ?? "1";
    const ring = ringOf(view, found ? valueOf(found.dataset, view.output) : null, unit);
    if (view.question === "drive" && ring.text && this.optimum.isShown(view)) ring.text = `best ${ring.text}`;
    this.picture.mark([ring], "chosen");
  }

  // Stage, curves in time and lists follow the design.
  renderDesign(view, scene) {
    const state = this.answer.state.value;
    const isHeld = this.store.held.value !== null;
    untracked(() => {
      const dataset = state.value?.dataset ?? null;
      const course = this.courseOf(dataset);
      const isOf = state.status === "ready";
      byId("detail").setAttribute("aria-busy", String(state.status === "computing"));
      for (const id of ["stage", "detail", "resonance"]) byId(id).classList.toggle("stale", state.isLate);
      const hop = valueOf(dataset, "hop_height");
      byId("stage").classList.toggle("row", Boolean(course?.row));
      this.stage.show({ view, course, hop: hop > HOP ? hop : 0, scene });
      byId("at-rest").textContent = course || !dataset ? "" : "This method gives means only: the part is drawn at rest.";
      this.player.show(course, state.isLate || (isHeld && !isOf));
      this.drawPanels();
      byId("frame").classList.toggle("surfaced", Boolean(view.surface));
      this.controls.lift(isOf && view.kind === "simulate" ? valueOf(dataset, "throw_number") : null);
      if (view.question === "resting") {
        const want = (name) => this.setView(view.surface ? { surface: { ...view.surface, wanted: name } } : { output: `let_down_share_${name}` });
        tellAspects(byId("aspects"), view, dataset, state.isLate, want);
        this.surface.show(view);
        this.tellOnward(view, isOf ? valueOf(dataset, view.output) : null);
      }
      if (view.question === "plate") tellMoves(byId("moves"), view, (values) => this.setView({ values: { ...this.view.values, ...values } }));
      if (LISTED.has(view.question)) tellValues(byId("values"), scene, dataset, state.isLate);
      if (view.question === "orienting") {
        tellDevices(byId("devices"), view, scene, { onadd: (name) => this.controls.add(name), onremove: (name) => this.controls.remove(name) });
      }
      tellSheet(byId("sheet"), { view, scene, dataset, version: byId("version").textContent });
    });
  }

  // What a line would make of the part.
  tellOnward(view, share) {
    const { length, width, height } = view.values;
    const [told, open] = byId("onward").children;
    byId("onward").hidden = !(share >= 0) || view.choice !== "box" || !view.output.includes("_share_");
    told.textContent = `One part a second arrives: ${Math.round(60 * share)} a minute ${liesTold(view.output.replace(/^.*_share_/, ""))}.`;
    const line = begun("orienting");
    open.onclick = () => this.open({ ...line, values: { ...line.values, length, width, height } }, { isStep: true });
  }

  courseOf(dataset) {
    if (this.courseIn?.dataset !== dataset) this.courseIn = { dataset, course: courseOf(dataset) };
    return this.courseIn.course;
  }

  drawPanels() {
    const course = this.courseIn?.course ?? null;
    byId("detail").hidden = !course;
    this.tabs();
    if (!course || !byId("panels-host").clientWidth) return;
    this.panels.draw(course);
    this.spoken = null;
    this.moment(this.player.time, this.player.turns);
  }

  moment(time, turns) {
    const { course } = this.player;
    this.stage.moment(time, turns);
    if (!course || this.panels.course !== course) return;
    this.panels.at(time);
    const mode = course.row ? null : MODES[modeAt(course, time + course.times[0])] ?? MODES.unknown;
    const told = course.row ? platoonsTold(platoonsAt(course, time + course.times[0])) : `The part ${mode[1] === "in the air" ? "is in the air" : mode[1]}`;
    if (!this.player.isRunning || this.spoken !== told) byId("now").setAttribute("aria-valuetext", `${number(1000 * time, 3)} ms, ${told.slice(0, 1).toLowerCase()}${told.slice(1)}`); // not each frame
    this.spoken = told;
    byId("moment").textContent = course.row ? `${told}.` : "";
  }

  renderResonance(view, scene) {
    const state = this.resonance.state.value;
    const answer = this.answer.state.value;
    untracked(() => {
      byId("resonance").hidden = state.status === "none";
      if (!state.value || view.question !== "springs") return;
      this.curve ??= new Curves(byId("resonance-host"), { onpick: ({ x }) => this.setView({ values: { ...this.view.values, frequency: x } }) });
      byId("resonance").classList.toggle("stale", state.isLate);
      if (this.curveOf !== state.value) {
        this.curveOf = state.value;
        this.curve.show({ ...state.value, regime: null });
      }
      const natural = answer.value ? valueOf(answer.value.dataset, "natural_frequency") : null;
      this.curve.mark([{ x: view.values.frequency, text: "the drive" }, ...(Number.isFinite(natural) ? [{ x: natural, text: "the springs" }] : [])], "drive");
    });
  }

  async start() {
    this.tellQuestions(fromLink(location.hash).wanted.question ?? "speed");
    const [friction] = await Promise.all([this.catalogue.ask("/friction"), this.catalogue.load()]);
    this.controls.frictions = friction.pairs;
    window.addEventListener("hashchange", () => {
      if (location.hash !== this.link) this.restore();
    });
    get("/healthz").then(({ version }) => (byId("version").textContent = version), () => {});
    addEventListener("pagehide", abandon);
    await this.restore();
  }

  // Open what a question begins with: as its link does, once the scenes are known.
  ask(question) {
    this.isStepped = true;
    location.hash = `#question=${question}`;
  }

  async restore() {
    const { wanted, complaints } = fromLink(location.hash);
    const question = wanted.question ?? "speed";
    if (question === "thesis" && !wanted.scene) {
      await this.openFigure("fig-5-1", { complaints, isStep: false });
      return;
    }
    const known = this.catalogue.scene(wanted.scene);
    if (wanted.scene && !known) complaints.push("The link names an unknown system: the default is shown.");
    const begin = begun(question);
    // What a question begins with need not be there in another system, or the other way to look.
    const isOther = ["scene", "kind"].some((name) => name in wanted && wanted[name] !== begin[name]);
    if (isOther) Object.assign(begin, { output: "", choice: "", values: {}, x: undefined, y: undefined, set: undefined, band: null });
    const isOwn = Object.keys(wanted.values ?? {}).length > 0;
    if (isOwn && begin.band && !wanted.band) begin.band = null; // a link says what is not known
    const values = { ...begin.values, ...wanted.values };
    const named = new Set([...Object.keys(wanted), ...Object.keys(wanted.values ?? {})]);
    await this.open({ ...begin, ...wanted, values, question, scene: known ? wanted.scene : begin.scene }, { complaints, named });
  }

  async openFigure(name, { complaints = [], isStep = true } = {}) {
    const figures = await this.catalogue.figures();
    const chosen = figures.find((one) => one.name === name) ?? figures[0];
    await this.open(viewOf(chosen), { complaints, isStep });
  }

  // The one way in which a view changes: the address, the fields and every picture follow. `held` while a slider or a
  // handle is: the address has the value where it is let go.
  setView(patch, { held = null, isStep = true } = {}) {
    const before = this.view;
    // The axes of a search are its bounds: they stay.
    const isWide = patch.values && held === null && before.question !== "drive";
    const view = isWide ? widened({ ...before, ...patch }, this.store.scene.peek()) : { ...before, ...patch };
    const isSame = OPENED_ANEW.every((name) => JSON.stringify(view[name]) === JSON.stringify(before[name]));
    const names = (one) => Object.keys(one.values).sort().join() + JSON.stringify(one.best?.vary);
    if (!isSame || names(view) !== names(before)) {
      if ("kind" in patch || "scene" in patch) {
        view.set = before.set === STROKE ? STROKE : null;
        view.runs = view.recording = view.surface = null;
      }
      const isBand = isSame || OPENED_ANEW.every((name) => name === "band" || JSON.stringify(view[name]) === JSON.stringify(before[name]));
      const best = view.best && !isBand && !("best" in patch) ? { ...view.best, isFound: view.question === "drive" } : view.best;
      return this.open({ ...view, best }, { isSwitching: true, isStep: true, named: new Set(Object.keys(patch)) });
    }
    if (patch.best) view.best = completeBest(view, this.store.scene.peek()).best;
    this.put(view, held);
    if (patch.runs) this.measured.show(this.view, this.store.scene.peek());
    if (held === null) this.keep({ isStep: isStep && JSON.stringify(view) !== JSON.stringify(this.keptView) });
    return null;
  }

  put(view, held) {
    batch(() => {
      this.store.view.value = frozen(view);
      this.store.held.value = held;
    });
    this.controls.follow(this.view);
  }

  // Open a view with a picture of its own; `isStep` where going back undoes it. What makes no sense is told of what a
  // link or a change has `named`: else the question begins with it, or a user leaves it behind.
  async open(wanted, { complaints = [], isSwitching = false, isStep = false, named = new Set() } = {}) {
    const opening = {};
    this.opening = opening;
    byId("picture").setAttribute("aria-busy", "true");
    const isLeft = () => this.opening !== opening;
    if (wanted.kind === "simulate" && !this.catalogue.scene(wanted.scene).methods.length) {
      wanted = { ...wanted, kind: "sweep", choice: "" }; // nothing is followed in time there
    }
    if (wanted.choice === "mesh") {
      complaints.push("A link does not hold the file of a part: drop the file again.");
      wanted = { ...wanted, choice: "" };
    }
    let scene;
    try {
      scene = await this.catalogue.describe(wanted);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      complaints.push(`There is no ${wanted.kind === "sweep" ? "variant" : "method"} of that name for this system: the default is used.`);
      wanted = { ...wanted, choice: "" };
      scene = await this.catalogue.describe(wanted);
    }
    if (isLeft()) return;
    if (wanted.set === "recorded" && !wanted.recording) {
      complaints.push("A link does not hold the recording: choose its file again.");
      wanted = { ...wanted, set: "ellipse", x: undefined, y: undefined };
    }
    const isTaken = (set) => isSet(set) && (set === STROKE ? takesBoth(scene) : wanted.kind !== "sweep" && takes(scene, set));
    if (wanted.set && !isTaken(wanted.set)) wanted = { ...wanted, set: null };
    scene = withSet(scene, wanted.set);
    learn(scene);
    const made = complete(wanted, scene);
    complaints.push(...made.complaints.filter(({ of }) => named.has(of)).map(({ text }) => text));
    const { view } = made;
    const figures = LISTED.has(view.question) ? await this.catalogue.figures() : null;
    if (isLeft()) return;
    if (view.question === "drive") {
      const whole = completeBest(view, scene);
      view.best = whole.best;
      if (!isSwitching) complaints.push(...whole.complaints);
    }
    this.opening = null;
    this.show(view, scene, { figures, isKept: named.has(view.x.name), isSwitching });
    this.keep({ isStep });
    this.notice.tell(complaints.slice(0, 1));
  }

  // Lay the page out for a view, and have everything follow it.
  show(view, scene, { figures, isKept, isSwitching }) {
    const before = this.view;
    const record = QUESTIONS[view.question];
    if (before?.question !== view.question) this.place(view.question);
    if (view.question !== "drive") this.optimum.leave();
    byId("wishes").hidden = view.question !== "drive";
    byId("limits").hidden = view.question !== "drive";
    byId("away-menu").classList.toggle("of-best", view.question === "drive");
    this.tellQuestions(view.question);
    byId("headline").textContent = byId("choose-question").selectedOptions[0].text;
    this.drawn = null;
    this.picture.begin(scene);
    byId("picture").classList.toggle("stale", Boolean(before));
    this.controls.show(view, this.catalogue.scenes, scene);
    if (view.question === "drive") this.optimum.show(view, scene, isKept || (isSwitching && this.optimum.isKept));
    if (view.question === "waves") tellWaves(byId("waves"), view, (patch) => this.setView(patch));
    const isMeasured = view.question === "measured" && view.kind === "simulate" && Boolean(view.runs);
    byId("measured").hidden = !isMeasured;
    if (isMeasured) this.measured.show(view, scene);
    byId("matters").hidden = view.question !== "uncertain";
    if (figures) tellFigures(byId("figures"), figures, view.figure, (one) => (one ? this.openFigure(one.name) : this.ask("all")));
    byId("stage").hidden = view.kind !== "simulate";
    byId("map-title").hidden = view.question === "drive";
    byId("map-title").textContent = record.map ?? (record.main.includes("picture") ? capital(words(view.output)) : "Where else could I be?");
    tellMeaning(byId("meaning").lastElementChild, view, scene);
    document.querySelector("main").classList.remove("opening");
    for (const id of ["keep", "take-away"]) byId(id).disabled = false;
    batch(() => {
      this.store.scene.value = scene;
      this.store.view.value = frozen(view);
      this.store.held.value = null;
    });
  }

  // The sections of a question, in its order.
  place(question) {
    const { main, side } = QUESTIONS[question];
    byId("frame").dataset.question = question;
    const at = { main: byId("pictures"), side: byId("side-pictures") };
    byId("pool").append(...at.main.children, ...at.side.children);
    at.main.append(...main.map(byId));
    at.side.append(...side.map(byId));
    this.tab = [...main, ...side].find((id) => TABS.includes(id));
    this.tabs();
  }

  // On a phone one picture at a time.
  tabs() {
    const there = TABS.filter((id) => !byId("pool").contains(byId(id)) && !byId(id).hidden);
    const tab = there.includes(this.tab) ? this.tab : there[0];
    byId("frame").dataset.tab = tab ?? "";
    byId("tabs").hidden = there.length < 2;
    for (const id of TABS) {
      byId(`tab-${id}`).hidden = !there.includes(id);
      byId(`tab-${id}`).setAttribute("aria-pressed", String(id === tab));
    }
  }

  // Marks of pins and runs in the picture.
  tellPins(view) {
    const within = (axis, value) => !axis || (value >= axis.from && value <= axis.to);
    const pins = (view.pins ?? []).map((pin, i) => ({ x: pin[view.x.name], y: view.y ? pin[view.y.name] : null, text: LETTERS[i] }));
    this.picture.mark(pins.filter(({ x, y }) => within(view.x, x) && within(view.y, y ?? view.y?.from)), "pins");
    this.picture.points(view.question === "measured" && !view.y ? view.runs : null);
  }

  tellQuestions(current) {
    const isShown = (one) => one.id === `question-${current === "all" ? "thesis" : current}`;
    for (const one of byId("questions").querySelectorAll("button")) one.setAttribute("aria-current", String(isShown(one)));
    byId("choose-question").value = current;
  }

  // The address restores the view, also where its picture takes long; a step is undone by going back.
  keep({ isStep }) {
    this.link = toLink(this.view);
    this.keptView = this.view;
    if (this.link === location.hash) return;
    this.isStepped ||= isStep;
    if (isStep) history.pushState(null, "", this.link);
    else history.replaceState(null, "", this.link);
  }
}

// Which parts of a row touch, in a sentence: those of each platoon by the numbers of its ends.
function platoonsTold(platoons) {
  const joined = platoons.filter(({ length }) => length > 1).map((one) => `${one[0]} to ${one[one.length - 1]}`);
  return joined.length ? `Parts ${joined.join(", and ")} touch` : "No parts touch";
}

const page = new Page();
page.start();
