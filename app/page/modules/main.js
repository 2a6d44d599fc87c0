// The page: a question, the fields that answer it, the picture, and what can be taken away.

import { Accuracy } from "./accuracy.js";
import { Away as TakeAway } from "./away.js";
import { Source, courseAt } from "./computed.js";
import { Controls } from "./controls.js";
import { Course, courseOf } from "./course.js";
import { Curves } from "./curves.js";
import { byId, element, fill } from "./elements.js";
import { tellFigures, viewOf } from "./figures.js";
import { Jobs } from "./jobs.js";
import { HeatMap } from "./map.js";
import { Optimum } from "./optimum.js";
import { Away, Refusal, get, key } from "./service.js";
import { fromLink, shownParameters, toLink, typical, usual } from "./view.js";
import { capital, duration, learn, number, words } from "./words.js";

const TITLES = {
  speed: "How fast does my part travel?",
  drive: "Which drive is best?",
  thesis: "What did the thesis draw?",
  all: "Everything",
};
const MOTION = { kind: "simulate", scene: "rectangle-on-plane", output: "conveying_velocity" };
const BEGIN = {
  speed: MOTION,
  drive: MOTION,
  all: { kind: "sweep", scene: "rectangle-on-plane", output: "acceleration_x" },
};
const RETRY = 2000; // ms

class Page {
  constructor() {
    this.source = new Source();
    this.described = new Map();
    this.jobs = new Jobs(byId("jobs"));
    this.controls = new Controls(byId("controls"), (view, how) => this.changed(view, how));
    this.asked = 0;
    this.isComputing = false;
    this.waiting = null;
    window.addEventListener("hashchange", () => {
      if (location.hash !== this.link) this.restore();
    });
  }

  async start() {
    this.scenes = await this.persist(() => get("/scenes"));
    this.controls.frictions = (await this.persist(() => get("/friction"))).pairs;
    this.optimum = new Optimum(byId("optimum"), {
      onfound: (marks) => this.picture.mark?.(marks),
      tell: (job) => this.jobs.note(job),
    });
    this.away = new TakeAway(byId("away"), {
      study: () => this.source.study(this.view),
      picture: () => this.picture,
      tell: (job) => this.jobs.note(job),
    });
    this.accuracy = new Accuracy(byId("accuracy"), {
      study: () => this.source.study(this.view),
      tell: (job) => this.jobs.note(job),
    });
    await this.restore();
  }

  // Ask until the service answers, and say so meanwhile.
  async persist(task) {
    for (;;) {
      try {
        const found = await task();
        this.tell();
        return found;
      } catch (error) {
        if (error instanceof Away) this.tell(["The service does not answer. Asking again ..."]);
        else if (error instanceof Refusal && error.status === 401) await this.askForKey(error);
        else if (error instanceof Refusal && [429, 503].includes(error.status)) this.tell([error.message]);
        else throw error;
        if (!(error instanceof Refusal && error.status === 401)) {
          await new Promise((done) => setTimeout(done, RETRY));
        }
      }
    }
  }

  askForKey(error) {
    return new Promise((done) => {
      const field = element("input", { type: "password", id: "key", autocomplete: "off" });
      const form = element(
        "form",
        {
          onsubmit: (event) => {
            event.preventDefault();
            key.set(field.value.trim());
            done();
          },
        },
        element("p", {}, key.get() ? error.message : "The service asks for a key."),
        element("label", { for: "key" }, "Key, kept until this tab is closed "),
        field,
        element("button", {}, "Use it"),
      );
      fill(byId("notice"), form);
      field.focus();
    });
  }

  tell(sentences = []) {
    fill(byId("notice"), ...sentences.map((text) => element("p", {}, text)));
  }

  async describe(view) {
    const query = new URLSearchParams(
      view.kind === "sweep"
        ? view.choice && { variant: view.choice }
        : { method: view.choice || this.methodOf(view.scene) },
    );
    const path = `/scenes/${encodeURIComponent(view.scene)}?${query}`;
    if (!this.described.has(path)) {
      const scene = await this.persist(() => get(path));
      learn(scene);
      this.described.set(path, scene);
    }
    return this.described.get(path);
  }

  methodOf(name) {
    return this.scenes.find((scene) => scene.name === name)?.methods[0] ?? "events";
  }

  async restore() {
    const { wanted, complaints } = fromLink(location.hash);
    const question = wanted.question ?? "speed";
    if (question === "thesis" && !wanted.scene) {
      await this.openFigure(null, complaints);
      return;
    }
    const begin = BEGIN[question] ?? BEGIN.speed;
    const known = this.scenes.find((scene) => scene.name === wanted.scene);
    if (wanted.scene && !known) complaints.push("The link names a system that there is not.");
    const view = {
      ...begin,
      choice: "",
      values: {},
      ...wanted,
      question,
      scene: known ? wanted.scene : begin.scene,
    };
    if (view.kind === "simulate" && !(known ?? this.scene(view.scene)).methods.length) {
      view.kind = "sweep";
    }
    await this.open(view, complaints);
  }

  async openFigure(figure, complaints = []) {
    this.figures ??= await this.persist(() => get("/figures"));
    const chosen = figure ?? this.figures.find(({ name }) => name === "fig-5-1") ?? this.figures[0];
    await this.open(viewOf(chosen), complaints);
  }

  scene(name) {
    return this.scenes.find((scene) => scene.name === name);
  }

  // Make a view whole: what it lacks is set to what is usual, what makes no sense is told of.
  async open(view, complaints = []) {
    let scene;
    try {
      scene = await this.describe(view);
    } catch (error) {
      complaints.push(error.message);
      view.choice = "";
      scene = await this.describe(view);
    }
    const output = scene.outputs.find(({ name }) => name === view.output);
    if (view.output && !output) complaints.push(`There is no output ${words(view.output).slice(0, 60)} here.`);
    if (!output) {
      const first = ["conveying_velocity", "acceleration_x"].find((name) =>
        scene.outputs.some((one) => one.name === name),
      );
      view.output = first ?? scene.outputs[0].name;
    }
    const given = { ...view.values };
    for (const axis of [view.x, view.y]) if (axis) given[axis.name] = axis.from;
    const parameters = shownParameters(scene, view.output, given);
    const byName = Object.fromEntries(parameters.map((one) => [one.name, one]));
    const axisNames = ["amplitude", "beta", ...Object.keys(byName)].filter((name) => byName[name]);
    for (const place of ["x", "y"]) {
      const axis = view[place];
      if (axis && !byName[axis.name]) {
        complaints.push(`${capital(words(axis.name).slice(0, 60))} cannot be an axis here.`);
        view[place] = undefined;
      }
      if (view[place] === undefined || (place === "x" && !view.x)) {
        const other = place === "x" ? view.y?.name : view.x?.name;
        const name = axisNames.find((one) => one !== other);
        if (!name) {
          view[place] = null;
          continue;
        }
        const [from, to] = usual(byName[name]);
        view[place] = { name, from, to };
      }
    }
    for (const name of Object.keys(view.values)) {
      if (byName[name]) continue;
      if (!this.isSwitching) complaints.push(`${capital(words(name).slice(0, 60))} is not a parameter here.`);
      delete view.values[name];
    }
    for (const { name } of parameters) {
      if (name === view.x.name || name === view.y?.name) delete view.values[name];
      else view.values[name] ??= typical(byName[name]);
    }
    this.view = view;
    this.described_ = scene;
    this.tellQuestions();
    this.controls.show(view, this.scenes, scene);
    await this.tellQuestion();
    this.tell(complaints.slice(0, 1));
    byId("headline").textContent = capital(words(view.output));
    if (view.band && !(view.band.name in view.values)) view.band = null;
    byId("worst").hidden = true;
    this.hosted = null;
    const drawn = this.compute({ isFirst: true });
    if (view.point) await this.pick(view.point);
    else byId("detail").hidden = true;
    await drawn;
  }

  // What a question has besides the picture and its fields.
  async tellQuestion() {
    const { question, figure } = this.view;
    byId("figures").hidden = question !== "thesis";
    byId("optimum").hidden = question !== "drive";
    if (question === "drive") this.optimum.show(this.view, this.described_);
    if (question === "thesis") {
      this.figures ??= await this.persist(() => get("/figures"));
      tellFigures(byId("figures"), this.figures, figure, (chosen) => this.openFigure(chosen));
    }
  }

  tellQuestions() {
    fill(
      byId("questions"),
      ...Object.entries(TITLES).map(([question, title]) =>
        element(
          "button",
          {
            type: "button",
            "aria-current": question === this.view.question ? "true" : "false",
            onclick: () => this.ask(question),
          },
          title,
        ),
      ),
    );
  }

  async ask(question) {
    if (question === "thesis") {
      await this.openFigure(null);
      return;
    }
    const begin = BEGIN[question] ?? BEGIN.speed;
    await this.open({ ...begin, choice: "", values: {}, question });
  }

  async changed(view, { dragged, isNew = false }) {
    if (isNew) {
      this.isSwitching = true;
      await this.open({ ...view, point: null });
      this.isSwitching = false;
      return;
    }
    this.view = view;
    await this.compute({ dragged });
  }

  // One computation at a time; of the changes meanwhile only the last counts.
  async compute(how) {
    if (this.isComputing) {
      this.waiting = how;
      if (!how.dragged) this.abort?.abort();
      return;
    }
    this.isComputing = true;
    try {
      let next = how;
      while (next) {
        this.waiting = null;
        await this.computeOnce(next);
        next = this.waiting;
      }
    } finally {
      this.isComputing = false;
    }
  }

  async computeOnce({ dragged = null, isFirst = false }) {
    const { view } = this;
    this.abort = new AbortController();
    const { signal } = this.abort;
    const started = performance.now();
    try {
      if (isFirst && view.kind === "simulate" && view.y) {
        const tell = (job) => this.tellJob(job);
        this.draw(await this.persist(() => this.source.coarse(view, { signal, tell })));
      }
      const found = await this.persist(() =>
        this.source.compute(view, { dragged, signal, tell: (job) => this.tellJob(job) }),
      );
      this.draw(found);
      this.controls.clear();
      if (view.band && !dragged) this.drawBand(found, await this.source.band(view, { signal }));
      const seconds = (performance.now() - started) / 1000;
      byId("progress").textContent = dragged ? "" : `Shown after ${duration(seconds)}.`;
    } catch (error) {
      if (error.name === "AbortError") return;
      if (!(error instanceof Refusal)) throw error;
      const rest = this.controls.complain(error.errors);
      this.tell(error.errors.length ? rest : [error.message]);
    }
    if (!dragged) {
      this.link = toLink(view);
      history.replaceState(null, "", this.link);
    }
  }

  tellJob(job) {
    this.jobs.note(job);
    const left = job.secondsLeft ? `, ${duration(job.secondsLeft)} left` : "";
    byId("progress").textContent = `${job.message} ${job.progress} %${left}`;
  }

  draw(found) {
    const { view } = this;
    const kind = found.y ? "map" : "curves";
    if (this.hosted !== kind) {
      const host = byId("host");
      const options = { onpick: (point) => this.pick(point), title: words(view.output) };
      this.picture = kind === "map" ? new HeatMap(host, options) : new Curves(host, options);
      this.hosted = kind;
    }
    if (found.regime) {
      found.regime.meanings ??= Object.fromEntries(
        this.described_.regimes.map(({ name, description }) => [name, description]),
      );
    }
    if (kind === "map") this.picture.show(found);
    else {
      const values = Array.from(found.x.values, (_, i) => found.z.at(i));
      this.picture.show({
        x: found.x,
        lines: [{ name: found.z.name, unit: found.z.unit, values }],
        regime: found.regime,
      });
    }
    this.tellValidity(found);
  }

  // What is not known exactly: a band about each line, or a second map of the worst case.
  drawBand(found, { x, y, low, high }) {
    const host = byId("worst");
    const { name, share } = this.view.band;
    const told = `${words(name)} known within ${number(100 * share)} %`;
    host.hidden = false;
    if (found.y) {
      fill(host, element("h2", {}, `The least value, ${told}`), element("div", { id: "worst-host" }));
      const worst = new HeatMap(byId("worst-host"), { title: "Worst case" });
      worst.show({ x, y, z: { ...found.z, at: low }, regime: null });
      return;
    }
    fill(host, element("p", {}, `The band: ${told}.`));
    const along = (at) => Array.from(found.x.values, (_, i) => at(i));
    this.picture.show({
      x: found.x,
      lines: [{ ...found.z, values: along(found.z.at), low: along(low), high: along(high) }],
      regime: found.regime,
    });
  }

  // How much of the picture does not describe a real part.
  tellValidity(found) {
    const invalid = new Set(
      this.described_.regimes.filter(({ valid }) => !valid).map(({ value }) => value),
    );
    if (!found.regime || !invalid.size) {
      byId("note").textContent = "";
      return;
    }
    let beyond = 0;
    const nx = found.x.values.length;
    const ny = found.y?.values.length ?? 1;
    for (let j = 0; j < ny; j++) {
      for (let i = 0; i < nx; i++) beyond += invalid.has(found.regime.at(i, j));
    }
    byId("note").textContent = beyond
      ? `In ${number((100 * beyond) / (nx * ny), 3)} % of the picture these formulas do not ` +
        "describe a real part: it has left the track. Motion in time tells its true speed."
      : "";
  }

  async pick(point) {
    const { view } = this;
    if (!this.scene(view.scene)?.methods.length) return;
    view.point = point;
    this.link = toLink(view);
    history.replaceState(null, "", this.link);
    try {
      const dataset = await this.persist(() => courseAt(view, point));
      byId("detail").hidden = false;
      this.course ??= new Course(byId("course"));
      this.course.show(courseOf(dataset));
      this.picture?.mark?.(view.y ? [{ x: point.x, y: point.y, text: "" }] : []);
    } catch (error) {
      if (error instanceof Refusal) this.tell([error.message, ...error.errors.map((e) => e.message)]);
      else throw error;
    }
  }
}

const page = new Page();
page.start();
