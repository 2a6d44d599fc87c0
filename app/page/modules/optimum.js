// The best drive: chips of what may be meant by it, the flight of the design to it, and what holds it back.

import { designsOf, isBent } from "./answer.js";
import { bestStudy, variablesOf } from "./best.js";
import { carryOut } from "./service.js";
import { design, studyWith, valueOf } from "./computed.js";
import { element, fill } from "./elements.js";
import { Front } from "./front.js";
import { marginsTold, ratesTold, statusTold } from "./margin.js";
import { nameOf } from "./slider.js";
import { Derived, effect, untracked } from "./store.js";
import { givenValues } from "./view.js";
import { Wishes } from "./wishes.js";
import { capital, number, shown, withUnit, words } from "./words.js";

const FLIGHT = 900; // ms
const ASIDE = { degree: 2 }; // what a drive is set to within, else a share of it
const SHARE = 0.05;
const TOLD = ["conveying_velocity", "hop_height", "throw_number"];

const LIFT = "throw_number";
const withoutLevel = (limits) => limits.filter(({ output, upper }) => output !== LIFT || upper !== 1);

// What may be meant by the best: a chip each, that changes what is wished for.
const CHIPS = {
  fastest: { title: "Fastest", fits: () => true, wish: (best) => ({ ...best, isRobust: false, limits: withoutLevel(best.limits) }) },
  still: {
    title: "No hop",
    fits: (view, scene) => view.kind === "simulate" && scene.outputs.some(({ name, level }) => name === LIFT && level === 1),
    wish: (best) => ({ ...best, isRobust: false, limits: [...withoutLevel(best.limits), { output: LIFT, lower: null, upper: 1, absolute: false }] }),
  },
  robust: {
    title: "Robust",
    fits: (view) => Boolean(view.band) && view.best.kind === "maximise" && view.band.name in view.values,
    wish: (best) => ({ ...best, isRobust: true, limits: withoutLevel(best.limits) }),
  },
};

const SPEEDS = new Set(["conveying_velocity", "drift_velocity"]);

function titleOf(chip, view) {
  if (chip !== "fastest") return CHIPS[chip].title;
  if (view.best.kind === "pareto") return "Trade-off";
  if (view.best.kind === "minimise") return "Smallest";
  return SPEEDS.has(view.output) ? CHIPS[chip].title : "Largest";
}

function chipOf({ isRobust, limits }) {
  if (isRobust) return "robust";
  return withoutLevel(limits).length < limits.length ? "still" : "fastest";
}

export class Optimum {
  /**
   * `hosts` are {chips, told, wishes, front}; `setView(patch, how)` changes the view, `mark(marks, whose)` shows points in
   * the picture, `ring()` draws the design's where it is.
   * @param {import("./store.js").Store} store @param {any} hosts @param {any} how
   */
  constructor(store, hosts, { setView, mark, persist, tell, pin }) {
    this.store = store;
    this.hosts = hosts;
    this.setView = setView;
    this.mark = mark;
    this.pin = pin;
    this.frame = 0;
    this.wishes = new Wishes(hosts.wishes, (best) => setView({ best }));
    this.before = null; // the design that was there first
    this.applied = null; // the search whose design was taken
    const ofQuestion = (view) => view.question === "drive" && view.best;
    const found = (chip) =>
      new Derived(store, {
        key: (view, scene) => {
          if (!ofQuestion(view) || !view.best.isFound || !CHIPS[chip].fits(view, scene)) return null;
          const isChosen = chipOf(view.best) === chip;
          if (!isChosen && (this.chosen(view)?.value.status !== "ready" || view.best.kind !== "maximise")) return null;
          return JSON.stringify(bestStudy({ ...view, best: CHIPS[chip].wish(view.best) }, scene));
        },
        ask: async (view, scene, how) => {
          const wished = { ...view, best: CHIPS[chip].wish(view.best) };
          const told = (job) => {
            how.tell(job);
            tell(job, view);
          };
          const { dataset } = await carryOut("optimise", bestStudy(wished, scene), { signal: how.signal, tell: told });
          return designsOf(dataset, variablesOf(wished));
        },
        persist,
      });
    this.states = Object.fromEntries(Object.keys(CHIPS).map((chip) => [chip, found(chip)]));
    this.first = new Derived(store, {
      key: (view) => (ofQuestion(view) && this.before ? JSON.stringify([view.scene, view.choice, this.before]) : null),
      ask: (view, scene, how) => design(view, scene, how, { values: this.before }),
      persist,
    });
    this.around = new Derived(store, {
      key: (view, scene) => (ofQuestion(view) && this.isShown(view) ? JSON.stringify(this.neighbours(view, scene)) : null),
      ask: async (view, scene, { signal }) => {
        const { dataset } = await carryOut(view.kind, this.neighbours(view, scene), { signal });
        const values = [dataset.variables[view.output].data].flat(2).filter(Number.isFinite);
        return values.length ? Math.min(...values) : null;
      },
      persist,
    });
    effect(() => this.draw());
  }

  chosen(view) {
    return this.states?.[chipOf(view.best)]?.state;
  }

  // The best design that is chosen, or null.
  best(view) {
    const state = this.chosen(view)?.value;
    const designs = state?.status === "ready" ? state.value.filter(({ isThere }) => isThere) : [];
    return designs.length === 1 ? designs[0] : null;
  }

  // Whether the design of the view is the best one.
  isShown(view) {
    const best = this.best(view);
    return Boolean(best) && Object.entries(best.at).every(([name, value]) => Math.abs(view.values[name] - value) <= 1e-6 * Math.abs(value) + 1e-12);
  }

  neighbours(view, scene) {
    const { at } = this.best(view);
    const around = (name) => {
      const { unit } = scene.parameters.find((one) => one.name === name);
      const step = ASIDE[unit] ?? SHARE * Math.abs(at[name]);
      return [at[name] - step, at[name], at[name] + step];
    };
    const names = [view.x.name, view.y?.name].filter(Boolean);
    return studyWith(view, [view.output], { ...givenValues(view), ...view.best.given, ...Object.fromEntries(names.map((name) => [name, around(name)])) });
  }

  study() {
    return bestStudy(this.store.view.value, this.store.scene.value);
  }

  // A view of the question is opened; with `isKept` its design is somebody's, and stays.
  show(view, scene, isKept) {
    this.scene = scene;
    this.wishes.show(view, scene);
    const names = [...Object.keys(view.values)];
    if (!this.before || names.some((name) => !(name in this.before)) || this.sceneOf !== view.scene) this.before = { ...givenValues(view) };
    this.sceneOf = view.scene;
    this.isKept = isKept;
  }

  leave() {
    this.before = null;
    this.applied = null;
    this.front = null;
    this.hosts.front.hidden = true;
    cancelAnimationFrame(this.frame);
  }

  draw() {
    const { view: seen, scene: known } = this.store;
    const [view, scene] = [seen.value, known.value];
    if (view?.question !== "drive" || !scene) return;
    const states = Object.entries(this.states).filter(([chip]) => CHIPS[chip].fits(view, scene));
    const all = states.map(([chip, { state }]) => [chip, state.value]);
    const [first, around] = [this.first.state.value, this.around.state.value];
    untracked(() => {
      this.wishes.follow(view);
      this.tellChips(view, scene, all);
      this.take(view);
      this.tellBest(view, scene, first, around);
    });
  }

  tellChips(view, scene, all) {
    const unit = scene.outputs.find(({ name }) => name === view.output)?.unit ?? "1";
    const chosen = chipOf(view.best);
    const value = ({ status, value: found, job }) => {
      if (status === "computing") return job ? `${job.progress} %` : "searching";
      if (status !== "ready") return status === "failed" ? "no answer" : "";
      const there = found.filter(({ isThere }) => isThere);
      if (!there.length) return "nothing fits";
      return there.length > 1 ? `${there.length} drives` : withUnit(there[0].values[view.output].value, unit, 3);
    };
    fill(
      this.hosts.chips,
      ...all.map(([chip, state]) =>
        element(
          "button",
          { type: "button", class: "chip", id: `chip-${chip}`, "aria-pressed": String(chip === chosen), title: state.reason || null, onclick: () => this.choose(chip) },
          element("b", {}, titleOf(chip, view)),
          ` ${value(state)}`,
        ),
      ),
      view.best.isFound ? null : element("button", { type: "button", class: "chip", id: "find", onclick: () => this.find() }, element("b", {}, "Find the best")),
    );
  }

  choose(chip) {
    this.applied = null;
    this.isKept = false;
    const { view } = this.store;
    this.setView({ best: { ...CHIPS[chip].wish(view.value.best), isFound: true } });
  }

  find() {
    this.applied = null;
    this.isKept = false;
    this.setView({ best: { ...this.store.view.value.best, isFound: true } });
  }

  // Take the design that was found, once: the ring travels to it.
  take(view) {
    const state = this.chosen(view)?.value;
    if (state?.status !== "ready" || state.of === this.applied) return;
    this.applied = state.of;
    const best = this.best(view);
    const all = state.value.filter(({ isThere }) => isThere);
    if (all.length > 1) this.tellFront(view, all);
    else this.hosts.front.hidden = true;
    if (!best || this.isKept) return;
    const moved = Object.fromEntries(Object.entries(best.at).filter(([name]) => name in view.values));
    queueMicrotask(() => {
      const { value: now } = this.store.view;
      if (now.question !== "drive" || this.chosen(now).value.of !== this.applied) return;
      this.setView({ values: { ...now.values, ...moved } }, { isStep: false });
      this.fly(now.values, moved);
    });
  }

  // Let the ring travel from one design to another.
  fly(from, to) {
    const { x, y } = this.store.view.value;
    cancelAnimationFrame(this.frame);
    if (matchMedia("(prefers-reduced-motion: reduce)").matches || !y) return;
    const begun = performance.now();
    const step = (now) => {
      const share = Math.min(1, (now - begun) / FLIGHT);
      const ease = share * share * (3 - 2 * share);
      const at = (name) => from[name] + ease * ((to[name] ?? from[name]) - from[name]);
      if (share >= 1) return this.mark(null, "chosen");
      this.mark([{ x: at(x.name), y: at(y.name), text: "", isDragged: true }], "chosen");
      this.frame = requestAnimationFrame(step);
    };
    this.frame = requestAnimationFrame(step);
  }

  tellBest(view, scene, first, around) {
    const state = this.chosen(view).value;
    const best = this.best(view);
    const { before } = this;
    const unitOf = (name) => [...scene.parameters, ...scene.outputs].find((one) => one.name === name)?.unit ?? "1";
    if (!best) {
      const all = state.status === "ready" ? state.value : [];
      const text = all.length > 1 ? "" : all.length ? statusTold(all[0].status) : state.status === "failed" ? state.reason : view.best.isFound ? "Searching for the best drive." : "The values changed: search again.";
      if (state.status === "failed") this.wishes.complain(state.errors ?? []);
      const relax = all.length === 1 && view.best.limits.length ? element("button", { type: "button", onclick: () => this.setView({ best: { ...view.best, limits: [], isFound: true } }) }, "Search without the limits") : null;
      if (!this.front || all.length < 2) fill(this.hosts.told, element("p", { role: "status" }, text), relax);
      this.mark(this.front ? this.marks ?? [] : [], "best");
      return;
    }
    const mark = (values, text) => ({ x: values[view.x.name], y: view.y ? values[view.y.name] : null, text });
    const valueBefore = first.status === "ready" ? valueOf(first.value.dataset, view.output) : null;
    const told = (value, unit) => (Number.isFinite(value) ? number(value * shown(unit)[0], 3) : "–");
    const isAt = this.isShown(view);
    const marks = [];
    if (before && view.x.name in before) marks.push({ ...mark({ ...view.values, ...before }, `before ${told(valueBefore, unitOf(view.output))}`), isEnd: true, to: best.at });
    if (!isAt) marks.push(mark(best.at, `best ${told(best.values[view.output].value, unitOf(view.output))}`));
    this.mark(marks, "best");
    const names = [...new Set([...Object.keys(best.at), ...["frequency"].filter((name) => name in view.values)])];
    const [outputs, values] = [TOLD.filter((name) => name in best.values || name === view.output), { ...view.values, ...best.at }];
    const rows = [
      ...names.map((name) => [`${nameOf(name)}`, unitOf(name), before?.[name] ?? view.own?.[name], values[name]]),
      ...outputs.map((name) => [capital(words(name)), unitOf(name), first.status === "ready" ? valueOf(first.value.dataset, name) : NaN, best.values[name]?.value]),
    ];
    const held = [...best.ends.map(({ name }) => `${nameOf(name)} is at its bound of ${withUnit(best.at[name], unitOf(name), 3)}.`), ...marginsTold(best, scene)];
    const [axis, other] = [view.x, view.y].map((one) => one && (ASIDE[unitOf(one.name)] ? `${ASIDE[unitOf(one.name)]}° of ${nameOf(one.name).toLowerCase()}` : `5 % less or more ${words(one.name)}`));
    if (around.status === "ready" && Number.isFinite(around.value)) held.push(`With ${axis}${other ? `, or ${other}` : ""}, at least ${withUnit(around.value, unitOf(view.output), 3)} remain.`);
    const angles = before && [view.x, view.y].filter(Boolean).map(({ name }) => withUnit(before[name], unitOf(name), 3)).join(", ");
    fill(
      this.hosts.told,
      element(
        "table",
        { class: "before" },
        element("thead", {}, element("tr", {}, element("td"), element("th", { scope: "col" }, "before"), element("th", { scope: "col" }, "best"))),
        element("tbody", {}, ...rows.map(([name, unit, one, two]) => element("tr", {}, element("th", { scope: "row" }, `${name}${shown(unit)[1] ? `, ${shown(unit)[1]}` : ""}`), element("td", {}, told(one, unit)), element("td", {}, element("b", {}, told(two, unit)))))),
      ),
      element("h3", {}, "What holds it back?"),
      element("p", {}, `${statusTold(best.status)} ${held.join(" ")}`),
      ratesTold(best),
      element(
        "div",
        { class: "buttons" },
        before && isAt ? element("button", { type: "button", id: "back", onclick: () => this.setView({ values: { ...view.values, ...before } }) }, `Go back to ${angles}`) : null,
        isAt ? null : element("button", { type: "button", id: "show-best", onclick: () => this.setView({ values: { ...view.values, ...Object.fromEntries(Object.entries(best.at).filter(([name]) => name in view.values)) } }) }, "Show the best"),
        before ? element("button", { type: "button", id: "compare", onclick: () => this.pin([{ ...view.values, ...before }, { ...view.values, ...best.at }]) }, "Compare both") : null,
      ),
    );
  }

  // How much faster than before, for the answer; "" where that is not known.
  gain(view, value) {
    const first = this.first.state.value;
    const before = first.status === "ready" ? valueOf(first.value.dataset, view.output) : null;
    if (!(before > 0) || !(value > 0) || !this.isShown(view)) return "";
    const times = value / before;
    return times > 1.05 ? `, ${number(times, times < 10 ? 2 : 3)} times as fast` : "";
  }

  tellFront(view, designs) {
    const { scene } = this;
    const { against } = view.best;
    const names = variablesOf(view);
    const units = (name) => scene.parameters.find((one) => one.name === name)?.unit ?? "1";
    const host = element("div", {});
    const bent = isBent(designs, view.output, against);
    const take = (index) => this.setView({ values: { ...this.store.view.value.values, ...Object.fromEntries(Object.entries(designs[index].at).filter(([name]) => name in view.values)) } });
    const look = (index) => {
      if (this.front.at === index) return;
      this.front.highlight(index);
      this.marks = designs.map(({ at, regime }, i) => ({ x: at[view.x.name], y: view.y ? at[view.y.name] : null, text: i === index ? (designs[i].isKnee && bent ? "knee" : "chosen") : "", regime: regime.name, isSmall: i !== index }));
      this.mark(this.marks, "best");
      fill(this.hosts.told, element("h3", {}, "What holds it back?"), element("p", {}, marginsTold(designs[index], scene).join(" ")));
    };
    this.hosts.front.hidden = false;
    fill(this.hosts.front, element("h3", {}, "The trade-off"), element("p", { class: "pale" }, `${designs.length} drives: no other drive is better in both outputs. A click or Enter shows one.`), host);
    this.front = new Front(host, { onpoint: look, onpick: take });
    this.front.show(designs, { output: view.output, against, scene, names, units, isBent: bent });
    look(Math.max(0, designs.findIndex(({ isKnee }) => isKnee)));
  }
}
