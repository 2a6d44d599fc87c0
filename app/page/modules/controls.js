// The fields of a view: the sliders of its question, part and friction in one menu, all else under Expert.

import { byId, element, fill, refill } from "./elements.js";
import { button, choiceField, grouped, numberInput, readNumber } from "./fields.js";
import { liftOff } from "./answers.js";
import { pictured } from "./opening.js";
import { FIRST_PART, PARTS, partDrawn, partOf } from "./parts.js";
import { QUESTIONS } from "./questions.js";
import { SETS, STROKE, hasChoice, restated } from "./sets.js";
import { rangeField, sliderField } from "./slider.js";
import { COMPANIONS, furtherParameters, shownParameters, typical, usual } from "./view.js";
import { capital, label, number, sentence, words } from "./words.js";

const SELDOM = "gravity"; // turned by hardly anybody: it stands last
const KINDS_OF_FRICTION = {
  friction: "kinetic",
  friction_kinetic: "kinetic",
  friction_static: "static",
  wall_friction: "kinetic",
};

export class Controls {
  // `onchange(patch, {held})` hears of each change; `held` while a slider is.
  constructor(onchange) {
    this.onchange = onchange;
    this.frictions = []; // rows of published coefficients
  }

  show(view, scenes, scene) {
    this.view = view;
    this.scene = scene;
    const parameters = shownParameters(scene, view.output, view.values);
    this.parameters = parameters;
    this.sliders = new Map();
    const record = QUESTIONS[view.question];
    const ofSet = view.set && view.set !== STROKE ? Object.keys(SETS[view.set].parameters) : [];
    const named = record.sliders.some((name) => ofSet.includes(name)) ? record.sliders : [...ofSet, ...record.sliders];
    const varied = view.question === "drive" ? view.best.vary : [];
    const isVaried = (name) => varied.some((one) => one.name === name);
    let first = named.map((name) => parameters.find((one) => one.name === name && !isVaried(name))).filter(Boolean);
    if (!first.length && record.sliders.length && !varied.length) first = parameters.filter(({ name }) => name !== SELDOM).slice(0, 3);
    this.first = new Set(first.map(({ name }) => name));
    const isSearch = view.question === "drive";
    const bounds = isSearch ? [view.x, view.y, ...varied].filter(Boolean).map((axis) => this.bounds(axis, " may be")) : [];
    refill(byId("first"), ...bounds, ...first.map((one) => this.slider(one, isSearch ? this.freeing(one) : null)));
    this.partMenu();
    // A place of a line without a device has no turn.
    const isEmpty = (name) => /^turn_\d$/.test(name) && !Object.keys(view.values).some((one) => !/^(turn|drop_count)/.test(one) && one.endsWith(name.slice(4)));
    this.tellExpert(scenes, parameters.filter(({ name }) => !this.sliders.has(name) && !isVaried(name) && !isEmpty(name)));
  }

  // What the search may choose, too.
  vary(rows) {
    this.change({ best: { ...this.view.best, vary: rows, isFound: true } });
  }

  freeing(parameter) {
    const { name } = parameter;
    const [from, to] = usual(parameter);
    return element("div", { class: "within" }, button(`Search for the best ${words(name)}`, () => this.vary([...this.view.best.vary, { name, from, to }]), { class: "link", id: `vary-${name}` }));
  }

  bounds(axis, more = "") {
    const { view } = this;
    const place = ["x", "y"].find((one) => view[one] === axis);
    const parameter = this.parameters.find(({ name }) => name === axis.name);
    const text = capital(words(axis.name)).replace(" of vibration", "") + more;
    if (place) return rangeField(text, axis, parameter, (from, to) => this.change({ [place]: { ...axis, from, to } }));
    const others = view.best.vary.filter((one) => one !== axis);
    const fixing = button("×", () => this.vary(others), { class: "remove", "aria-label": `Search no ${words(axis.name)}` });
    return rangeField(text, axis, parameter, (from, to) => this.vary(view.best.vary.map((one) => (one === axis ? { ...axis, from, to } : one))), fixing);
  }

  slider(parameter, ...more) {
    const { name } = parameter;
    const required = this.scene.outputs.find((one) => one.name === this.view.output)?.required ?? [];
    const isAdded = parameter.default === null && ![name, ...(parameter.instead_of ?? [])].some((one) => required.includes(one));
    const made = sliderField(
      this.view,
      parameter,
      {
        onmove: (value, { from, to }) => this.onchange({ values: { ...this.view.values, [name]: value } }, { held: { name, from, to } }),
        ontake: (value) => this.set(name, value),
        onremove: isAdded ? () => this.remove(name) : null,
      },
      ...more,
      this.isUncertain(name) ? this.share(parameter) : null,
    );
    this.sliders.set(name, made);
    return made.field;
  }

  isUncertain(name) {
    return this.view.band?.name === name;
  }

  // How far what is not known exactly may lie from its value, or the range of it.
  share({ name, unit }) {
    const { band } = this.view;
    const check = (value) => (value > 0 && value <= 90 ? "" : "The uncertainty has to be more than 0 % and at most 90 %");
    const field = numberInput("Known within, in per cent", Number((100 * band.share).toPrecision(3)), "%", (value) => this.change({ band: { ...this.view.band, share: value / 100 } }), { id: "band-share", check, title: "A share, or a range such as 0.2 to 0.3" });
    const take = (event) => {
      const [low, high] = field.value.split(/ to |\u2013/).map((one) => readNumber(one, unit).value);
      if (!(low > 0 && low < high)) return;
      event.stopImmediatePropagation();
      this.range(name, [low, high]);
    };
    field.addEventListener("change", take, { capture: true });
    return element("div", { class: "within" }, "within ±", element("span", { class: "slot" }, field, element("span", { class: "unit" }, "%")), "or a range");
  }

  // What is known as a range: its middle, and how far its ends are away.
  range(name, [low, high], pair = "") {
    const middle = (low + high) / 2;
    const share = middle ? Math.min(0.9, (high - low) / 2 / middle) : 0;
    this.change({ values: { ...this.view.values, [name]: Number(middle.toPrecision(4)) }, band: share ? { name, share } : null, pair });
  }

  // Another view with the same fields: each shows its value.
  follow(view) {
    this.view = view;
    for (const one of this.sliders.values()) one.follow(view);
    this.tellPart();
  }

  // Where the part lifts off, on the sliders of the drive.
  lift(throwNumber) {
    for (const [name, one] of this.sliders) one.mark(throwNumber === null ? null : liftOff(name, this.view.values, throwNumber));
  }

  // The part and its friction, in one menu.
  partMenu() {
    const { view } = this;
    const friction = this.parameters.find(({ name }) => name === "friction");
    this.hasMenu = Boolean(friction) && !this.first.has("friction") && this.scene.methods.length > 0 && view.kind === "simulate";
    byId("part").hidden = !this.hasMenu;
    if (!this.hasMenu) return fill(byId("part-fields"));
    const isDrawn = partOf({ ...view, part: "" }).title === PARTS[FIRST_PART].title;
    const choice = isDrawn
      ? choiceField("choose-part", "Part, as it is drawn", Object.entries(PARTS).map(([name, { title }]) => [name, title]), view.part || FIRST_PART, (part) => this.change({ part }))
      : null;
    refill(byId("part-fields"), choice, this.slider(friction), this.published(friction));
    this.tellPart();
  }

  tellPart() {
    if (!this.hasMenu) return;
    const { view } = this;
    const part = partOf(view);
    const scale = Math.min(40 / part.length, 22 / part.height);
    fill(byId("part-icon"), partDrawn(part, part.length * scale, part.height * scale, { class: "part" }));
    byId("part-title").textContent = `${part.title}${view.pair ? `, ${view.pair}` : ""}`;
    const { friction } = view.values;
    const ends = this.isUncertain("friction") ? [1 - view.band.share, 1 + view.band.share].map((one) => number(friction * one, 2)) : null;
    fill(byId("part-known"), "friction ", element("b", {}, number(friction, 3)), ends ? `, known as ${ends.join(" to ")}` : "");
  }

  // Published values of a coefficient of friction: their middle is taken, their range is the band.
  published(parameter) {
    const kind = KINDS_OF_FRICTION[parameter.name];
    if (!kind || !this.frictions.length) return null;
    const rows = this.frictions
      .map((row) => ({ row, range: row[kind] ?? row.kinetic ?? row.coefficient ?? row.static }))
      .filter(({ range }) => range);
    const chosen = (place) => {
      if (place === "") return;
      const { row, range } = rows[Number(place)];
      this.range(parameter.name, range, `${row.part} on ${row.track}`);
    };
    const told = (range) => (range[0] === range[1] ? range[0] : `${range[0]} to ${range[1]}`);
    const options = rows.map(({ row, range }, place) => [String(place), `${row.part} on ${row.track}, ${row.surface}: ${told(range)}`]);
    return choiceField(`published-${parameter.name}`, `Published values of the ${words(parameter.name)}`, [["", "Choose ..."], ...options], "", chosen);
  }

  // What stands under Expert: system, model, method, output, axes, and every other parameter.
  tellExpert(scenes, others) {
    const { view, scene } = this;
    const further = furtherParameters(scene, view.output, view.values);
    const system = scenes.find((one) => one.name === view.scene);
    const choice = view.kind === "sweep" ? "variants" : "methods";
    const choices = system?.[choice] ?? [];
    const byDefault = view.kind === "sweep" ? system?.default_variant : choices[0];
    const chosen = view.choice || byDefault;
    const told = [scene.title.toLowerCase(), `${view.kind === "sweep" ? "variant" : "method"} ${words(chosen ?? "")}`];
    fill(byId("expert-told"), told.join(", "));
    const { choice: name } = QUESTIONS[view.question];
    const options = choices.map((one) => [one, capital(words(one))]);
    const selected = choices.length > 1 && this.select(name ?? (view.kind === "sweep" ? "Variant" : "Method"), options, chosen, (one) => this.change({ choice: one }));
    if (selected && name) byId("first").append(selected);
    refill(
      byId("expert-fields"),
      element(
        "div",
        { class: "columns" },
        this.select("System", scenes.map((one) => [one.name, one.title]), view.scene, (name) => this.change(this.ofSystem(scenes, name))),
        system?.methods.length
          ? this.select("Model", [["simulate", "Motion in time: mean speed"], ["sweep", "Closed-form equations: one instant"]], view.kind, (kind) => this.change({ kind, choice: "", output: "" }))
          : null,
        name || !selected ? null : selected,
        this.select("Output", grouped(pictured(scene), ({ name, unit }) => [name, label(name, unit)]), view.output, (name) => this.change({ output: name })),
        this.stroke(),
        this.axis("x", "Across"),
        this.axis("y", "Up"),
        this.uncertain(),
      ),
      element(
        "div",
        { class: "sliders" },
        ...[...others].sort((one, other) => Number(one.name === SELDOM) - Number(other.name === SELDOM)).map((one) => this.slider(one, this.published(one))),
        further.length
          ? this.select("Add a parameter", [["", "Choose ..."], ...further.map(({ name, unit }) => [name, label(name, unit)])], "", (name) => this.add(name))
          : null,
      ),
    );
  }

  // The same question of another system, as its motion in time where it has one.
  ofSystem(scenes, name) {
    const { methods } = scenes.find((one) => one.name === name);
    return { scene: name, choice: "", output: "", kind: methods.length && this.view.kind === "simulate" ? "simulate" : "sweep" };
  }

  // Half of the stroke, as the theory has it, or the whole of it, as a shop measures it.
  stroke() {
    if (!hasChoice(this.view, this.scene)) return null;
    const options = [["", "From the middle to a peak"], [STROKE, "From peak to peak"]];
    return this.select("Amplitude", options, this.view.set ?? "", (set) => this.change(restated(this.view, set || null)));
  }

  select(text, options, value, chosen) {
    return choiceField(`choose-${text.toLowerCase().replaceAll(" ", "-")}`, text, options, value, chosen);
  }

  axis(place, text) {
    const { view, parameters } = this;
    const axis = view[place];
    const other = view[place === "x" ? "y" : "x"];
    const options = parameters.filter(({ name }) => name !== other?.name).map(({ name, unit }) => [name, label(name, unit)]);
    if (place === "y") options.push(["", "Nothing: lines"]);
    const field = this.select(text, options, axis?.name ?? "", (name) => this.changeAxis(place, name));
    if (axis && view.question !== "drive") field.append(this.bounds(axis));
    return field;
  }

  // One parameter may be known to a share only.
  uncertain() {
    const { view } = this;
    const fixed = this.parameters.filter(({ name }) => name in view.values);
    const options = [["", "Nothing"], ...fixed.map(({ name }) => [name, capital(words(name))])];
    return this.select("Not known exactly", options, view.band?.name ?? "", (name) => this.change({ band: name ? { name, share: view.band?.share ?? 0.2 } : null }));
  }

  add(name) {
    if (!name) return;
    const names = [name, ...(COMPANIONS[name] ?? [])];
    const begin = (one) => typical(this.scene.parameters.find((parameter) => parameter.name === one));
    const values = { ...this.view.values, ...Object.fromEntries(names.map((one) => [one, this.view.values[one] ?? begin(one)])) };
    this.change({ values });
  }

  remove(name) {
    const gone = new Set([name, ...(COMPANIONS[name] ?? []), ...Object.keys(COMPANIONS).filter((one) => COMPANIONS[one].includes(name))]);
    const values = Object.fromEntries(Object.entries(this.view.values).filter(([one]) => !gone.has(one)));
    const axis = (one) => (one && gone.has(one.name) ? undefined : one);
    this.change({ values, x: axis(this.view.x), y: axis(this.view.y) });
  }

  set(name, value) {
    const pair = name === "friction" ? { pair: "" } : {};
    this.change({ values: { ...this.view.values, [name]: value }, ...pair });
  }

  change(patch) {
    this.onchange(patch, { held: null });
  }

  changeAxis(place, name) {
    const parameter = this.parameters.find((one) => one.name === name);
    const [from, to] = parameter ? usual(parameter) : [];
    this.change({ [place]: parameter ? { name, from, to } : null });
  }

  // Sentences of the service beside the fields that they concern.
  complain(errors) {
    for (const name of this.sliders.keys()) {
      const found = errors.find(({ place }) => String(place).split(".").includes(name));
      byId(`wrong-${name}`).textContent = found ? sentence(found) : "";
    }
  }
}
