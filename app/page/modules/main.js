// The page: a question, the fields that answer it, the picture, and what can be taken away.

import { Accuracy } from "./accuracy.js";
import { Away as TakeAway } from "./away.js";
import { completeBest } from "./best.js";
import { Catalogue } from "./catalogue.js";
import { Source } from "./computed.js";
import { Computing, busy } from "./computing.js";
import { Controls } from "./controls.js";
import { byId } from "./elements.js";
import { tellFigures, viewOf } from "./figures.js";
import { Jobs } from "./jobs.js";
import { Matters } from "./matters.js";
import { Measured } from "./measured.js";
import { tellMeaning } from "./meaning.js";
import { MotionAtPoint } from "./motion.js";
import { Notice } from "./notice.js";
import { complete } from "./opening.js";
import { Optimum } from "./optimum.js";
import { PartHere } from "./part.js";
import { Picture } from "./picture.js";
import { tellQuestions } from "./nav.js";
import { LETTERS, Pins } from "./pins.js";
import { QUESTIONS, begun } from "./questions.js";
import { isSet, withSet } from "./sets.js";
import { Refusal, get } from "./service.js";
import { STROKE, takesBoth } from "./stroke.js";
import { fromLink, frozen, toLink } from "./view.js";
import { Waves } from "./waves.js";
import { learn, valuesTold, words } from "./words.js";

// What of a view asks for other fields, or another picture.
const OPENED_ANEW = ["kind", "scene", "choice", "set", "recording", "output", "x", "y", "band"];

class Page {
  constructor() {
    this.source = new Source();
    this.notice = new Notice(byId("notice"));
    this.catalogue = new Catalogue((path) => this.notice.persist(() => get(path)));
    this.jobs = new Jobs(byId("jobs"), (link) => {
      location.hash = link;
      byId("headline").focus();
    });
    this.controls = new Controls(byId("controls"), (patch, how) => this.setView(patch, how));
    this.picture = new Picture({
      onpick: (point) => this.setView({ point }),
      onpoint: (point) => this.optimum.pointed(point),
      ondrag: (point, { isOver }) => this.setView({ point }, { isHeld: !isOver }),
    });
    this.motion = new MotionAtPoint(byId("detail"), {
      notice: this.notice,
      onshown: (view, course) => {
        this.part.tell(view, course);
        if (this.extra && this.hasExtra()) this.extra.follow?.(view);
        if (view.pins?.length) this.pins.show(view, this.seen);
      },
    });
    this.pins = new Pins(byId("pins"), {
      onpins: (pins) => this.setView({ pins }),
      onshow: (values) => this.choose(values),
    });
    this.part = new PartHere(byId("part"), {
      onpoint: (point) => this.setView({ point }),
      onpin: () => this.pins.pin(this.view),
    });
    const { source, picture, controls, notice, jobs } = this;
    const view = () => this.view;
    const isOpen = () => this.opened === this.turn;
    const note = (job, ofView) => jobs.note(job, this.told(ofView));
    this.computing = new Computing({ view, isOpen, source, picture, controls, notice, note });
    this.isReady = false; // the service has said what scenes there are
    this.asked = null; // a question that was chosen before
    this.turn = 0; // of views that were opened: the last one counts
    this.opened = 0; // the last of them that is open
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
    const tell = (job) => this.jobs.note(job, this.told(this.view));
    const extra = byId("extra");
    this.optimum = new Optimum(byId("optimum"), {
      first: extra,
      beside: byId("beside"),
      onmark: (marks) => this.view.question === "drive" && this.picture.mark(marks, "best"),
      onchoose: (at, how) => this.view.question === "drive" && this.choose(at, how),
      // A search that ends after its question was left has nothing to say.
      onwish: (best) => this.view.question === "drive" && this.setView({ best }),
      steps: () => this.picture.steps(),
      persist: (task) => this.notice.persist(task),
      tell,
    });
    // What a question has beside picture, fields and motion, by its record.
    this.extras = {
      matters: new Matters(extra),
      measured: new Measured(extra, {
        onruns: (runs) => this.setView({ runs }),
        onvalue: (name, value) => this.setView({ values: { ...this.view.values, [name]: value } }),
        tell,
      }),
      waves: new Waves(extra, (patch) => this.setView(patch)),
    };
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
    this.isReady = true;
    await (this.asked ? this.ask(this.asked) : this.restore());
  }

  // Open what a question begins with; one that is chosen while the page opens waits for the scenes.
  async ask(question) {
    if (!this.isReady) this.asked = question;
    else if (question === "thesis") await this.openFigure(null);
    else await this.open(begun(question), { isStep: true });
  }

  async restore() {
    this.turn += 1; // what is still being opened is left
    busy(true);
    const { wanted, complaints } = fromLink(location.hash);
    const question = wanted.question ?? "speed";
    if (question === "thesis" && !wanted.scene) {
      await this.openFigure(null, { complaints, isStep: false });
      return;
    }
    const known = this.catalogue.scene(wanted.scene);
    if (wanted.scene && !known) complaints.push("The link names an unknown system: the default is shown.");
    const begin = begun(question);
    // What a question begins with need not be there in another system, or the other way to look.
    const isOther = ["scene", "kind"].some((name) => name in wanted && wanted[name] !== begin[name]);
    if (isOther) Object.assign(begin, { output: "", choice: "", values: {}, x: undefined, y: undefined, set: undefined, point: undefined });
    const values = { ...begin.values, ...wanted.values };
    const view = { ...begin, ...wanted, values, question, scene: known ? wanted.scene : begin.scene };
    await this.open(view, { complaints });
  }

  async openFigure(figure, { complaints = [], isStep = true } = {}) {
    const figures = await this.catalogue.figures();
    const chosen = figure ?? figures.find(({ name }) => name === "fig-5-1") ?? figures[0];
    await this.open(viewOf(chosen), { complaints, isStep });
  }

  // A view in the list of jobs: what it shows, its values, and the link that opens it.
  told(view) {
    const axes = [view.x, view.y].filter(Boolean).map(({ name }) => words(name));
    return {
      title: `${words(view.output)} over ${axes.join(" and ")}`,
      told: valuesTold(view, this.seen),
      link: toLink(view),
    };
  }

  // The one way in which a view changes: the address, the fields, the picture and the motion follow.
  // `dragged` while a slider is held, `isHeld` while a point is: the address has the value where it is
  // let go.
  setView(patch, { dragged = null, isHeld = dragged !== null, isStep = true } = {}) {
    const before = this.view;
    const view = { ...before, ...patch };
    const isSame = OPENED_ANEW.every((name) => view[name] === before[name]);
    const names = (one) => Object.keys(one.values).join();
    if (!isSame || names(view) !== names(before)) {
      const isOfAxes = ["x", "y"].every((place) => view[place]?.name === before[place]?.name);
      const isOther = ["kind", "scene", "output"].some((name) => name in patch);
      if ("kind" in patch || "scene" in patch) {
        view.set = before.set === STROKE ? STROKE : null;
        view.runs = view.recording = null;
      }
      const best = view.best && { ...view.best, isFound: false };
      if (patch.point) return this.open({ ...view, best }, { isSwitching: true, isStep: true });
      const point = isOfAxes && !isOther && !patch.y && !patch.x ? view.point : null;
      return this.open({ ...view, best, point }, { isSwitching: true, isStep: true });
    }
    if (patch.best) view.best = completeBest(view, this.seen).best;
    this.view = frozen(view);
    this.controls.follow(view);
    if (this.optimum.view && view.question === "drive") this.optimum.follow(this.view);
    if (!isHeld) this.keep({ isStep: isStep && (!patch.best || patch.best.isFound === before.best.isFound) });
    if (patch.runs || patch.pins) this.tellBeside();
    if (patch.point) this.part.place(view.point);
    if (view.point && (patch.point || patch.values)) this.follow();
    const isOfPins = patch.pins && !view.y;
    return patch.values || isOfPins ? this.compute({ dragged }) : null;
  }

  // Open a view with a picture of its own; `isStep` where going back undoes it. What an `isSwitching`
  // user leaves behind needs no word.
  async open(wanted, { complaints = [], isSwitching = false, isStep = false } = {}) {
    const turn = (this.turn += 1);
    const isLeft = () => turn !== this.turn;
    busy(true);
    if (wanted.kind === "simulate" && !this.catalogue.scene(wanted.scene).methods.length) {
      wanted = { ...wanted, kind: "sweep", choice: "" }; // nothing is followed in time there
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
    const takes = (set) => isSet(set) && (set === STROKE ? takesBoth(scene) : wanted.kind !== "sweep");
    if (wanted.set && !takes(wanted.set)) wanted = { ...wanted, set: null };
    scene = withSet(scene, wanted.set);
    learn(scene);
    const made = complete(wanted, scene);
    complaints.push(...made.complaints, ...(isSwitching ? [] : made.foreign));
    const view = made.view;
    if (view.question === "drive") {
      const whole = completeBest(view, scene);
      view.best = whole.best;
      if (!isSwitching) complaints.push(...whole.complaints);
    }
    if (!scene.methods.length) view.point = null;
    this.view = frozen(view);
    this.seen = scene;
    this.keep({ isStep });
    this.tellQuestions(view.question);
    this.controls.show(view, this.catalogue.scenes, scene);
    this.picture.begin(view, scene);
    tellMeaning(byId("meaning").lastElementChild, view, scene);
    document.querySelector("main").classList.remove("opening");
    this.part.show(view, scene);
    this.motion.begin(view);
    await this.tellWhatElse();
    if (isLeft()) return;
    this.notice.tell(complaints.slice(0, 1));
    this.opened = turn;
    const drawn = this.compute({ isFirst: true });
    if (view.point) this.follow();
    this.tellBeside();
    await drawn;
    if (isLeft() || view.question !== "drive" || !this.view.best.isFound) return;
    await this.optimum.find({ isShown: !wanted.point });
  }

  // What is told beside the picture of the view: marks of pins and runs, and pinned designs.
  tellBeside() {
    const { view } = this;
    const within = (axis, value) => !axis || (value >= axis.from && value <= axis.to);
    const pins = (view.pins ?? []).map((pin, i) => ({ x: pin[view.x.name], y: view.y ? pin[view.y.name] : null, text: LETTERS[i] }));
    this.picture.mark(pins.filter(({ x, y }) => within(view.x, x) && within(view.y, y ?? view.y?.from)), "pins");
    this.picture.points(view.question === "measured" && !view.y ? view.runs : null);
    this.pins.show(view, this.seen);
  }

  tellQuestions(current) {
    tellQuestions(byId("questions"), current, (question) => this.ask(question));
  }

  // What a question has besides the picture and its fields.
  async tellWhatElse() {
    const { question, figure } = this.view;
    byId("figures").hidden = question !== "thesis";
    byId("optimum").hidden = question !== "drive";
    this.away.offer(question === "drive");
    this.extra = this.extras[QUESTIONS[question].extra] ?? null;
    byId("extra").hidden = !QUESTIONS[question].extra || question === "thesis";
    byId("extra").className = QUESTIONS[question].extra ?? "";
    if (this.extra && this.hasExtra()) this.extra.show(this.view, this.seen);
    else if (question !== "drive") byId("extra").hidden = true;
    if (question === "drive") {
      this.optimum.show(this.view, this.seen);
      return;
    }
    this.optimum.forget();
    if (question === "thesis") {
      const figures = await this.catalogue.figures();
      tellFigures(byId("figures"), figures, figure, (chosen) => this.openFigure(chosen));
    }
  }

  compute(how) {
    return this.computing.compute(how);
  }

  // The address restores the view, also where its picture takes long; a step is undone by going back.
  keep({ isStep }) {
    this.link = toLink(this.view);
    if (this.link === location.hash) return;
    if (isStep) history.pushState(null, "", this.link);
    else history.replaceState(null, "", this.link);
  }

  // Show a drive as a whole: its point, and the values that are no axes.
  choose(at, { isStep = true } = {}) {
    const { values, x, y } = this.view;
    const moved = Object.fromEntries(Object.entries(at).filter(([name]) => name in values));
    const isOther = Object.keys(moved).some((name) => moved[name] !== values[name]);
    const point = { x: at[x.name], y: y ? at[y.name] : null };
    return this.setView(isOther ? { values: { ...values, ...moved }, point } : { point }, { isStep });
  }

  // The motion at the point of the view.
  async follow() {
    if (!this.catalogue.scene(this.view.scene)?.methods.length) return;
    this.picture.mark([{ ...this.view.point, text: "", isDragged: true }], "chosen");
    await this.motion.follow(this.view, this.seen);
  }

  // Whether what a question has beside its picture makes sense of the view.
  hasExtra() {
    const { kind, point, y, runs } = this.view;
    if (kind !== "simulate" || !point || !this.seen.outputs.some(({ name }) => name === "conveying_velocity")) return false;
    return this.extra !== this.extras.measured || (!y && Boolean(runs));
  }
}

const page = new Page();
page.start();
