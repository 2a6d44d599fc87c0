// The best drive: chips of what may be meant by it, the flight of the design to it, and what holds it back.

import { bestStudy, nearestTo, searched, variablesOf } from "./best.js";
import { carryOut } from "./service.js";
import { design, studyWith, valueOf } from "./computed.js";
import { element, fill } from "./elements.js";
import { button } from "./fields.js";
import { Front } from "./curves.js";
import { marginsTold, statusTold } from "./optima.js";
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
    fits: (view) => Boolean(view.band) && !["pareto", "reach"].includes(view.best.kind) && view.band.name in view.values,
    wish: (best) => ({ ...best, isRobust: true, limits: withoutLevel(best.limits) }),
  },
};

const SPEEDS = new Set(["conveying_velocity", "drift_velocity"]);

function titleOf(chip, view) {
  if (chip !== "fastest") return CHIPS[chip].title;
  if (view.best.kind === "pareto") return "Trade-off";
  if (view.best.kind === "minimise") return "Smallest";
  if (view.best.kind === "reach") return "Nearest";
  return SPEEDS.has(view.output) ? CHIPS[chip].title : "Largest";
}

function chipOf({ isRobust, limits }) {
  if (isRobust) return "robust";
  return withoutLevel(limits).length < limits.length ? "still" : "fastest";
}

function unitIn(scene, name) {
  return [...scene.parameters, ...scene.outputs].find((one) => one.name === name)?.unit ?? "1";
}

export class Optimum {
  /**
   * `hosts` are {chips, told, wishes, front}; `setView(patch, how)` changes the view, `mark(marks, whose)` shows points in
   * the picture, `ring()` draws the design's where it is.
   * @param {import("./store.js").Store} store @param {any} hosts @param {any} how
   */
  constructor(store, hosts, { setView, mark, persist, pin }) {
    this.store = store;
    this.hosts = hosts;
    this.setView = setView;
    this.mark = mark;
    this.pin = pin;
    this.frame = 0;
    this.wishes = new Wishes(hosts.wishes, (best) => setView({ best }));
    this.before = null; // the design that was there first
    this.applied = null; // the search whose design was taken
    const derived = (key, ask) =>
      new Derived(store, {
        key: (view, scene) => (view.question === "drive" && view.best ? key(view, scene) : null),
        ask,
        persist,
      });
    const wished = (view, chip) => ({ ...view, best: CHIPS[chip].wish(view.best) });
    const found = (chip) =>
      derived(
        (view, scene) => {
          if (!view.best.isFound || !CHIPS[chip].fits(view, scene)) return null;
          if (chipOf(view.best) !== chip && (this.chosen(view)?.value.status !== "ready" || view.best.kind !== "maximise")) return null;
          return JSON.stringify(bestStudy(wished(view, chip), scene));
        },
        (view, scene, how) => searched(wished(view, chip), scene, how),
      );
    this.states = Object.fromEntries(Object.keys(CHIPS).map((chip) => [chip, found(chip)]));
    this.first = derived(
      (view) => (this.before ? JSON.stringify([view.scene, view.choice, this.begun(view)]) : null),
      (view, scene, how) => design(view, scene, how, { values: this.begun(view) }),
    );
    this.around = derived(
      (view, scene) => (this.isShown(view) ? JSON.stringify(this.neighbours(view, scene)) : null),
      async (view, scene, { signal }) => {
        const { dataset } = await carryOut(view.kind, this.neighbours(view, scene), { signal });
        const values = [dataset.variables[view.output].data].flat(2).filter(Number.isFinite);
        return values.length ? Math.min(...values) : null;
      },
    );
    this.near = derived(
      (view, scene) => {
        const { status, value } = this.chosen(view)?.value ?? {};
        return status === "ready" && value.length === 1 && value[0].status === "infeasible" ? JSON.stringify(bestStudy(view, scene)) : null;
      },
      nearestTo,
    );
    effect(() => this.draw());
  }

  chosen(view) {
    return this.states?.[chipOf(view.best)]?.state;
  }

  // The search for the best while it runs as a job, else null.
  searching(view) {
    const search = this.states[chipOf(view.best)];
    return search.state.value.status === "computing" && search.state.value.job ? search : null;
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

  // The design before the search: what is not searched for is as it is now.
  begun(view) {
    return { ...givenValues(view), ...Object.fromEntries(variablesOf(view).filter((name) => name in this.before).map((name) => [name, this.before[name]])) };
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
    if (!this.before || names.some((name) => !(name in this.before)) || this.sceneOf !== view.scene) this.before = { ...view.values };
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
    const [first, around, near] = [this.first, this.around, this.near].map(({ state }) => state.value);
    untracked(() => {
      this.wishes.follow(view);
      this.tellChips(view, scene, all);
      this.take(view);
      if (this.best(view)) this.tellBest(view, scene, first, around);
      else this.tellNone(view, scene, near);
    });
  }

  tellChips(view, scene, all) {
    const unit = unitIn(scene, view.output);
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
          { type: "button", class: "chip", id: `chip-${chip}`, "aria-pressed": String(chip === chosen), title: state.reason || null, onclick: () => this.search(CHIPS[chip].wish(this.store.view.value.best)) },
          element("b", {}, titleOf(chip, view)),
          ` ${value(state)}`,
        ),
      ),
      view.best.isFound ? null : element("button", { type: "button", class: "chip", id: "find", onclick: () => this.search(this.store.view.value.best) }, element("b", {}, "Find the best")),
    );
  }

  search(best) {
    this.applied = null;
    this.isKept = false;
    this.setView({ best: { ...best, isFound: true } });
    const search = this.states[chipOf(best)];
    if (search.state.value.status === "failed") search.again();
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
    queueMicrotask(() => {
      const { value: now } = this.store.view;
      if (now.question !== "drive" || this.chosen(now).value.of !== this.applied) return;
      this.go(best.at, { isStep: false });
      this.fly(now.values, best.at);
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

  // Why there is no best drive, the drives that come nearest, and what would make one.
  tellNone(view, scene, near) {
    this.mark(this.front ? (this.marks ?? []) : [], "best");
    const { status, value, reason, errors } = this.chosen(view).value;
    if (status === "failed") this.wishes.complain(errors ?? []);
    const all = status === "ready" ? value : [];
    if (this.front && all.length > 1) return;
    const text = { ready: statusTold(all[0]?.status), failed: reason, computing: "Searching for the best drive." }[status] ?? "The values changed: search again.";
    const told = (name, one) => withUnit(one, unitIn(scene, name), 3);
    const line = (said, at) => element("li", {}, `${said} `, button("Show", () => this.go(at), { class: "link", "aria-label": `Show the drive: ${said}` }));
    const choice = (at) => Object.entries(at).map(([name, one]) => `${words(name)} ${told(name, one)}`).join(", ");
    const lists = {
      "The nearest drives": near.value?.near.map(({ output, end, bound, at, value: one }) => line(`${capital(words(output))} ${told(output, one)}, where ${end === "lower" ? "at least" : "at most"} ${told(output, bound)} is asked, at ${choice(at)}.`, at)),
      "What would do it?": near.value?.ways.map(({ name, at, value: one }) => line(`Another ${words(name)}, ${told(name, at[name])}, keeps all limits: ${words(view.output)} ${told(view.output, one)}, at ${choice(at)}.`, at)),
    };
    const there = near.status === "ready" || near.isPartial ? Object.entries(lists).filter(([, lines]) => lines.length) : [];
    fill(
      this.hosts.told,
      element("p", { role: "status" }, text, near.status === "computing" ? " Searching for the nearest drives." : ""),
      ...there.flatMap(([title, lines]) => [element("h3", {}, title), element("ul", { class: "near" }, ...lines)]),
      all.length && view.best.limits.length ? button("Search without the limits", () => this.setView({ best: { ...view.best, limits: [], isFound: true } })) : null,
    );
  }

  // The values of a design that are fields of the view, taken by the view.
  go(at, how) {
    const { values } = this.store.view.value;
    this.setView({ values: { ...values, ...Object.fromEntries(Object.entries(at).filter(([name]) => name in values)) } }, how);
  }

  tellBest(view, scene, first, around) {
    const best = this.best(view);
    const before = this.before && this.begun(view);
    const unitOf = (name) => unitIn(scene, name);
    const mark = (values, text) => ({ x: values[view.x.name], y: view.y ? values[view.y.name] : null, text });
    const valueBefore = first.status === "ready" ? valueOf(first.value.dataset, view.output) : null;
    const told = (value, unit) => (Number.isFinite(value) ? number(value * shown(unit)[0], 3) : "–");
    const isAt = this.isShown(view);
    const marks = [];
    // The map is of the frequency that is set: a drive of another one has no place in it.
    const isOnMap = (values) => view.best.vary.every(({ name }) => values[name] === view.values[name]);
    if (before && view.x.name in before && isOnMap(before)) marks.push({ ...mark({ ...view.values, ...before }, `before ${told(valueBefore, unitOf(view.output))}`), isEnd: true, to: best.at });
    if (!isAt && isOnMap(best.at)) marks.push(mark(best.at, `best ${told(best.values[view.output].value, unitOf(view.output))}`));
    const still = this.states.still.state.value;
    const [quiet] = still.status === "ready" && chipOf(view.best) !== "still" ? still.value : [];
    if (quiet?.isThere && isOnMap(quiet.at)) marks.push({ ...mark({ ...view.values, ...quiet.at }, `no hop ${told(quiet.values[view.output].value, unitOf(view.output))}`), isEnd: true });
    this.mark(marks, "best");
    const names = [...new Set([...Object.keys(best.at), ...["frequency"].filter((name) => name in view.values)])];
    const [outputs, values] = [TOLD.filter((name) => name in best.values || name === view.output), { ...view.values, ...best.at }];
    const rows = [
      ...names.map((name) => [capital(words(name)), unitOf(name), before?.[name] ?? view.own?.[name], values[name]]),
      ...outputs.map((name) => [capital(words(name)), unitOf(name), first.status === "ready" ? valueOf(first.value.dataset, name) : NaN, best.values[name]?.value]),
    ];
    const held = [...best.ends.map(({ name }) => `${capital(words(name))} is at its bound of ${withUnit(best.at[name], unitOf(name), 3)}.`), ...marginsTold(best, scene)];
    const [axis, other] = [view.x, view.y].map((one) => one && (ASIDE[unitOf(one.name)] ? `${ASIDE[unitOf(one.name)]}° of ${words(one.name)}` : `5 % less or more ${words(one.name)}`));
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
      element(
        "div",
        { class: "buttons" },
        before && isAt ? button(`Go back to ${angles}`, () => this.go(before), { id: "back" }) : null,
        isAt ? null : button("Show the best", () => this.go(best.at), { id: "show-best" }),
        before ? button("Compare both", () => this.pin([{ ...view.values, ...before }, { ...view.values, ...best.at }]), { id: "compare" }) : null,
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

  // All best trade-offs as a line beside the map; the one at its cursor is marked in the map.
  tellFront(view, found) {
    const { scene } = this;
    const { output, best } = view;
    const { against } = best;
    const size = ({ values }) => Math.abs(values[against].value);
    const designs = [...found].sort((one, other) => size(one) - size(other));
    const host = element("div", {});
    const tell = (index) => {
      const { values, regime, at } = designs[index];
      const chosen = variablesOf(view).map((name) => `${words(name)} ${withUnit(at[name], unitIn(scene, name))}`);
      return [...[output, against].map((name) => `${words(name)} ${withUnit(values[name].value, values[name].unit)}`), ...chosen, words(regime.name)];
    };
    const look = (index) => {
      this.marks = designs.map(({ at, regime }, i) => ({ x: at[view.x.name], y: view.y ? at[view.y.name] : null, text: i === index ? "chosen" : "", regime: regime.name, isSmall: i !== index }));
      this.mark(this.marks, "best");
      fill(this.hosts.told, element("h3", {}, "What holds it back?"), element("p", {}, marginsTold(designs[index], scene).join(" ")));
    };
    this.hosts.front.hidden = false;
    fill(this.hosts.front, element("h3", {}, "The trade-off"), element("p", { class: "pale" }, `${designs.length} drives: no other drive is better in both outputs. A click or Enter shows one.`), host);
    const first = Math.max(0, designs.findIndex(({ isKnee }) => isKnee));
    this.front = new Front(host, { designs, output, against, first, tell, onpoint: look, onpick: (index) => this.go(designs[index].at) });
    look(first);
  }
}
