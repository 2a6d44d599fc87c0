// The best drive: wishes, the study, what was found, and the pictures of it, linked to each other.

import { designsOf, isBent } from "./answer.js";
import { bandOf, neighboursOf } from "./around.js";
import { bestStudy, variablesOf } from "./best.js";
import { element, fill, refill } from "./elements.js";
import { Front } from "./front.js";
import { designTold, marginsTold, ratesTold, statusTold } from "./margin.js";
import { bandTold, neighboursDrawn, neighboursTold } from "./neighbours.js";
import { Parallel } from "./parallel.js";
import { carryOut, left } from "./service.js";
import { Wishes } from "./wishes.js";
import { withUnit, words } from "./words.js";

const NEAR = 0.06; // of an axis of the picture

export class Optimum {
  // `onmark(marks)` shows points in the picture, `onchoose(at)` a drive as a whole, `onwish(best)` hears
  // of what is wished for, or found, `steps()` gives how far the values of the picture lie apart,
  // `persist(task)` asks until the service answers.
  // A trade-off is drawn in `beside`, next to the picture; what is asked for first stands in `first`.
  constructor(host, { first, beside, onmark, onchoose, onwish, steps, persist, tell }) {
    this.host = host;
    this.first = first;
    this.beside = beside;
    this.onmark = onmark;
    this.onchoose = onchoose;
    this.onwish = onwish;
    this.steps = steps;
    this.persist = persist;
    this.tellJob = tell;
    this.form = element("div", { class: "wishes" });
    this.wishes = new Wishes(this.form, (best) => this.onwish(best));
    this.said = element("div", { role: "status", class: "finding" });
    this.answer = element("div", { class: "answer" });
    fill(host, element("h2", { tabindex: "-1" }, "Which drive is best, and how certain is that?"), this.form, this.answer);
    this.designs = [];
  }

  // Show what is wished for of another picture.
  show(view, scene) {
    this.scene = scene;
    this.view = view;
    this.wishes.show(view, scene);
    this.tellFirst();
    this.forget();
    this.abort?.abort(left());
  }

  // The button that finds the best, and each level that it may keep below.
  tellFirst() {
    const levels = this.scene.outputs.filter(({ name, level }) => Number.isFinite(level) && name !== this.view.output);
    const button = (text, onclick, more = {}) => element("button", { type: "button", onclick, ...more }, text);
    refill(
      this.first,
      element(
        "div",
        { class: "buttons" },
        button("Find the best", () => this.find(), { id: "find", class: "main" }),
        ...levels.map(({ name, level, begins }) =>
          button(`Without ${begins}`, () => this.keepBelow(name, level), { id: `below-${name}` }),
        ),
        button("Limits", () => {
          this.host.scrollIntoView();
          this.host.querySelector("h2").focus({ preventScroll: true });
        }),
      ),
      this.said,
    );
    this.tellKept();
  }

  // Which levels it keeps below. The buttons stay: one of them may just be pressed.
  tellKept() {
    for (const { name } of this.scene.outputs) {
      const isKept = this.view.best.limits.some(({ output }) => output === name);
      this.first.querySelector(`#below-${name}`)?.setAttribute("aria-pressed", String(isKept));
    }
  }

  keepBelow(name, upper) {
    const { best } = this.view;
    const others = best.limits.filter(({ output }) => output !== name);
    const isNew = others.length === best.limits.length;
    const limits = isNew ? [...others, { output: name, lower: null, upper, absolute: false }] : others;
    this.onwish({ ...best, limits, isFound: false });
    return this.find();
  }

  // The view has changed, and its picture is the same or is being drawn.
  follow(view) {
    this.view = view;
    this.wishes.follow(view);
    this.tellKept();
    this.grown();
  }

  units(name) {
    return this.scene.parameters.find((one) => one.name === name)?.unit ?? "1";
  }

  study() {
    return bestStudy(this.view, this.scene);
  }

  forget() {
    this.abort?.abort(left()); // a search that is left has nothing to say
    this.designs = [];
    this.found = null;
    if (this.front) this.beside.hidden = true;
    this.front = null;
    this.onmark([]);
    fill(this.said);
    fill(this.answer);
  }

  // What was found is of other values than those that are shown now.
  grown() {
    if (!this.found || this.found === JSON.stringify(this.study())) return;
    this.forget();
    if (this.view.best.isFound) this.onwish({ ...this.view.best, isFound: false });
    this.said.textContent = "The values changed after the best drive was found: search again.";
  }

  // `isShown` where the drive that is found becomes the design.
  async find({ isShown = true } = {}) {
    const study = this.study();
    this.forget();
    this.abort = new AbortController();
    const { signal } = this.abort;
    this.wishes.clear();
    this.said.textContent = "Searching for the best drive ...";
    try {
      const tell = (job) => {
        this.tellJob(job);
        this.said.textContent = `${job.message} ${job.progress} %`;
      };
      const { dataset } = await this.persist(() => carryOut("optimise", study, { tell, signal }));
      this.found = JSON.stringify(study);
      this.grown(); // meanwhile
      if (!this.found) return;
      this.onwish({ ...this.view.best, isFound: true });
      await this.tell(dataset, signal, isShown);
    } catch (error) {
      if (error.name === "AbortError") return;
      if (!error.errors) throw error;
      const rest = this.wishes.complain(error.errors);
      const told = error.errors.length ? rest : [error.message];
      fill(this.said, ...told.map((text) => element("p", { class: "wrong" }, text)));
      if (!told.length) this.said.textContent = "Some inputs are invalid: correct those marked above.";
    }
  }

  async tell(dataset, signal, isShown) {
    const names = variablesOf(this.view);
    const all = designsOf(dataset, names);
    this.designs = all.filter(({ isThere }) => isThere);
    if (!this.designs.length) {
      this.said.textContent = `No best drive was found. ${statusTold(all[0]?.status)}`;
      return;
    }
    if (this.designs.length > 1) this.tellFront(names);
    else await this.tellOne(this.designs[0], signal, isShown);
  }

  markOf({ at }, text, more = {}) {
    return { x: at[this.view.x.name], y: this.view.y ? at[this.view.y.name] : null, text, ...more };
  }

  async tellOne(design, signal, isShown) {
    const { view, scene } = this;
    const units = (name) => this.units(name);
    const at = Object.entries(design.at).map(([name, value]) => `${words(name)} ${withUnit(value, units(name))}`);
    const { value, unit } = design.values[view.output];
    fill(
      this.said,
      element("strong", {}, `Best: ${at.join(", ")}`),
      ` with ${words(view.output)} ${withUnit(value, unit)}. ${statusTold(design.status)}`,
      view.best.kind === "pareto" ? ` There is no trade-off: the ${words(view.best.against)} is least here, too.` : "",
    );
    if (isShown && view.kind === "simulate") this.onchoose(design.at, { isStep: false });
    const around = element("div", {}, element("p", { class: "unit" }, "Comparing neighbouring designs ..."));
    fill(
      this.answer,
      designTold(design, scene, units, view.output),
      element("button", { type: "button", onclick: () => this.onchoose(design.at) }, "Show this drive"),
      element("h3", {}, "Distance from the limits"),
      element("ul", {}, ...marginsTold(design, scene).map((text) => element("li", {}, text))),
      ratesTold(design),
      element("h3", {}, "Next to it"),
      around,
    );
    this.onmark([this.markOf(design, "best")]);
    const found = await this.persist(() => neighboursOf(view, design.at, this.steps(), { signal }));
    fill(
      around,
      ...neighboursTold(view, found, units).map((text) => element("p", {}, text)),
      neighboursDrawn(view, scene, found),
    );
    if (!view.band || view.band.name in design.at) return;
    const band = await this.persist(() => bandOf(view, design.at, { signal }));
    around.append(...bandTold(band, units(band.name)));
  }

  tellFront(names) {
    const { view, scene, designs } = this;
    const { against } = view.best;
    const units = (name) => this.units(name);
    const others = view.best.vary.map(({ name }) => words(name)).join(" and ");
    this.said.textContent =
      `${designs.length} drives: no other drive is better in both outputs. Point at a drive to see where it lies in the ` +
      "picture; a click or Enter shows it." +
      (others ? ` The picture holds for one value of ${others}: it is drawn again for the drive that you select.` : "");
    const plots = [element("div", {}), element("div", {})];
    this.beside.hidden = false;
    fill(this.beside, element("h3", {}, "The trade-off"), plots[0]);
    this.details = element("div", { class: "details" });
    fill(
      this.answer,
      element("h3", {}, "All drives of the trade-off, side by side"),
      element("p", { class: "unit" }, "Drag along an axis, or move its handles, to select the drives within that range."),
      plots[1],
      this.details,
    );
    const onpoint = (index) => this.look(index);
    const onpick = (index) => this.onchoose(designs[index].at);
    this.front = new Front(plots[0], { onpoint, onpick });
    this.isBent = isBent(designs, view.output, against);
    this.front.show(designs, { output: view.output, against, scene, names, units, isBent: this.isBent });
    this.parallel = new Parallel(plots[1], { onpoint, onpick, onbrush: (out) => this.front.dim(out) });
    const columns = [
      ...names.map((name) => ({ name, unit: units(name), values: designs.map(({ at }) => at[name]) })),
      ...[view.output, against].map((name) => ({
        name,
        unit: designs[0].values[name].unit,
        values: designs.map(({ values }) => values[name].value),
      })),
    ];
    this.parallel.show(designs, columns, scene);
    this.look(Math.max(0, designs.findIndex(({ isKnee }) => isKnee)));
  }

  // One drive of the trade-off is looked at: in all pictures.
  look(index) {
    if (!this.front || this.front.at === index) return;
    const { designs } = this;
    this.front.highlight(index);
    this.parallel.highlight(index);
    fill(
      this.details,
      element("h3", {}, "Distance from the limits"),
      element("ul", {}, ...marginsTold(designs[index], this.scene).map((text) => element("li", {}, text))),
    );
    this.onmark([
      ...designs.map((design) => this.markOf(design, "", { regime: design.regime.name, isSmall: true })),
      this.markOf(designs[index], designs[index].isKnee && this.isBent ? "knee" : "chosen"),
    ]);
  }

  // A point of the picture is looked at: the drive of the trade-off that lies near it.
  pointed({ x, y }) {
    const { view, designs } = this;
    if (!this.front || this.host.hidden) return;
    const axes = [[view.x, x], [view.y, y]].filter(([axis]) => axis);
    const distances = designs.map(({ at }) =>
      Math.hypot(...axes.map(([axis, value]) => (at[axis.name] - value) / (axis.to - axis.from))),
    );
    const least = Math.min(...distances);
    if (least < NEAR) this.look(distances.indexOf(least));
  }
}
