// The fields of a view: parameters with sliders, which of them run across and up, what is shown.

import { element, refill } from "./elements.js";
import { choiceField, numberInput } from "./fields.js";
import { grouped } from "./groups.js";
import { knob } from "./knob.js";
import { capital, label, sentence, shown, words } from "./words.js";
import { pictured } from "./opening.js";
import { STROKE, hasChoice, restated } from "./stroke.js";
import { furtherParameters, shownParameters, typical, unusual, usual } from "./view.js";

const SELDOM = "gravity"; // turned by hardly anybody: it stands last
const KINDS_OF_FRICTION = {
  friction: "kinetic",
  friction_kinetic: "kinetic",
  friction_static: "static",
  wall_friction: "kinetic",
};

export class Controls {
  // `onchange(patch, {dragged})` hears of each change; `dragged` while a slider is held.
  constructor(host, onchange) {
    this.host = host;
    this.onchange = onchange;
    this.frictions = []; // rows of published coefficients
    this.ends = Object.create(null); // of sliders, that were typed, by name
  }

  show(view, scenes, scene) {
    this.view = view;
    this.scene = scene;
    const given = { ...view.values };
    for (const axis of [view.x, view.y]) if (axis) given[axis.name] = axis.from;
    const parameters = shownParameters(scene, view.output, given);
    const further = furtherParameters(scene, view.output, given);
    this.parameters = parameters;
    this.shown = {}; // by name: what has a field show another value
    refill(
      this.host,
      this.what(scenes),
      element(
        "fieldset",
        {},
        element("legend", {}, "Axes of the picture"),
        this.axis("x", "Across", parameters),
        this.axis("y", "Up", parameters),
      ),
      element(
        "fieldset",
        {},
        element("legend", {}, "Part, track and drive"),
        this.stroke(),
        ...parameters
          .filter(({ name }) => name !== view.x.name && name !== view.y?.name)
          .sort((one, other) => Number(one.name === SELDOM) - Number(other.name === SELDOM))
          .map((parameter) => this.field(parameter)),
        further.length
          ? this.select(
              "Add a parameter",
              [["", "Choose ..."], ...further.map(({ name, unit }) => [name, label(name, unit)])],
              "",
              (name) => this.add(further.find((one) => one.name === name)),
            )
          : null,
        this.uncertain(parameters),
      ),
    );
  }

  // Another view with the same fields: each shows its value.
  follow(view) {
    this.view = view;
    for (const [name, show] of Object.entries(this.shown)) show(view.values[name]);
  }

  what(scenes) {
    const { view, scene } = this;
    const choice = view.kind === "sweep" ? "variants" : "methods";
    const system = scenes.find((one) => one.name === view.scene);
    const choices = system?.[choice] ?? [];
    const byDefault = view.kind === "sweep" ? system?.default_variant : choices[0];
    return element(
      "fieldset",
      {},
      element("legend", {}, "System and output"),
      this.select(
        "System",
        scenes
          .filter((one) => view.kind === "sweep" || one.methods.length)
          .map((one) => [one.name, one.title]),
        view.scene,
        (name) => this.change({ scene: name, choice: "", output: "" }),
      ),
      system?.methods.length
        ? this.select(
            "Model",
            [
              ["simulate", "Motion in time: mean speed"],
              ["sweep", "Closed-form equations: one instant"],
            ],
            view.kind,
            (kind) => this.change({ kind, choice: "", output: "" }),
          )
        : null,
      choices.length > 1
        ? this.select(
            view.kind === "sweep" ? "Variant" : "Method",
            choices.map((name) => [name, capital(words(name))]),
            view.choice || byDefault,
            (name) => this.change({ choice: name }),
          )
        : null,
      this.select(
        "Output",
        grouped(pictured(scene), ({ name, unit }) => [name, label(name, unit)]),
        view.output,
        (name) => this.change({ output: name }),
      ),
    );
  }

  // Half of the stroke, as the theory has it, or the whole of it, as a shop measures it.
  stroke() {
    if (!hasChoice(this.view, this.scene)) return null;
    return this.select(
      "Amplitude",
      [
        ["", "From the middle to a peak"],
        [STROKE, "From peak to peak"],
      ],
      this.view.set ?? "",
      (set) => this.change(restated(this.view, set || null)),
    );
  }

  select(text, options, value, chosen) {
    return choiceField(`choose-${text.toLowerCase().replaceAll(" ", "-")}`, text, options, value, chosen);
  }

  axis(place, text, parameters) {
    const axis = this.view[place];
    const other = this.view[place === "x" ? "y" : "x"];
    const options = parameters
      .filter(({ name }) => name !== other?.name)
      .map(({ name, unit }) => [name, label(name, unit)]);
    if (place === "y") options.push(["", "Nothing: lines"]);
    const field = this.select(text, options, axis?.name ?? "", (name) => this.changeAxis(place, name));
    if (!axis) return field;
    const parameter = parameters.find(({ name }) => name === axis.name);
    const [, unit] = shown(parameter.unit);
    const isOrdered = { from: (value) => value < axis.to, to: (value) => value > axis.from };
    const end = (which) =>
      numberInput(
        `${text} ${which}${unit ? ` in ${unit}` : ""}`,
        axis[which],
        parameter.unit,
        (value) => this.change({ [place]: { ...axis, [which]: value } }),
        { check: (value) => (isOrdered[which](value) ? "" : "The lower end of the axis has to be below the upper end") },
      );
    field.append(
      element("div", { class: "ends" }, end("from"), "to", end("to")),
      element("span", { class: "unusual" }, unusual(parameter, axis.from) || unusual(parameter, axis.to)),
      this.complaint(axis.name),
    );
    return field;
  }

  complaint(name) {
    return element("span", { class: "wrong", id: `wrong-${name}` });
  }

  field(parameter) {
    const { name } = parameter;
    const { field, show } = knob(
      parameter,
      this.view.values[name],
      {
        ends: this.ends[name],
        onmove: (value, { from, to }) =>
          this.onchange({ values: { ...this.view.values, [name]: value } }, { dragged: { name, from, to } }),
        ontake: (value) => this.set(name, value),
        onends: (ends) => (this.ends[name] = ends),
      },
      this.published(parameter),
      this.complaint(name),
    );
    this.shown[name] = show;
    return field;
  }

  // Published values beside a coefficient of friction; the band is that of their range.
  published(parameter) {
    const kind = KINDS_OF_FRICTION[parameter.name];
    if (!kind || !this.frictions.length) return null;
    const rows = this.frictions
      .map((row) => ({ row, range: row[kind] ?? row.kinetic ?? row.coefficient ?? row.static }))
      .filter(({ range }) => range);
    const choice = element(
      "select",
      {
        "aria-label": `Published values of the ${words(parameter.name)}`,
        onchange: () => {
          const { range } = rows[Number(choice.value)];
          const middle = (range[0] + range[1]) / 2;
          const share = middle ? (range[1] - range[0]) / 2 / middle : 0;
          this.change({
            values: { ...this.view.values, [parameter.name]: Number(middle.toPrecision(4)) },
            band: share ? { name: parameter.name, share: Math.min(0.9, share) } : null,
          });
        },
      },
      element("option", { value: "" }, "Published values ..."),
      ...rows.map(({ row, range }, place) => {
        const told = range[0] === range[1] ? range[0] : `${range[0]} to ${range[1]}`;
        return element("option", { value: place }, `${row.part} on ${row.track}, ${row.surface}: ${told}`);
      }),
    );
    return choice;
  }

  add(parameter) {
    if (!parameter) return;
    this.change({ values: { ...this.view.values, [parameter.name]: typical(parameter) } });
  }

  // One parameter may be known to a share only.
  uncertain(parameters) {
    const { view } = this;
    const fixed = parameters.filter(({ name }) => name in view.values);
    const field = this.select(
      "Not known exactly",
      [["", "Nothing"], ...fixed.map(({ name }) => [name, capital(words(name))])],
      view.band?.name ?? "",
      (name) => this.change({ band: name ? { name, share: view.band?.share ?? 0.2 } : null }),
    );
    if (view.band) {
      const share = numberInput(
        "Uncertain parameter known within, in per cent",
        100 * view.band.share,
        "%",
        (value) => this.change({ band: { ...view.band, share: value / 100 } }),
        { check: (value) => (value > 0 && value <= 90 ? "" : "The uncertainty has to be more than 0 % and at most 90 %") },
      );
      field.append(element("div", { class: "ends" }, "within ±", share, "%"));
    }
    return field;
  }

  set(name, value) {
    this.change({ values: { ...this.view.values, [name]: value } });
  }

  change(patch) {
    this.onchange(patch, { dragged: null });
  }

  changeAxis(place, name) {
    const parameter = this.parameters.find((one) => one.name === name);
    const [from, to] = parameter ? usual(parameter) : [];
    this.change({ [place]: parameter ? { name, from, to } : null });
  }

  // Sentences of the service beside the fields that they concern; returns those that concern none.
  complain(errors) {
    const rest = [];
    for (const error of errors) {
      const { place } = error;
      const name = String(place).split(".").find((part) => this.parameters.some((p) => p.name === part));
      const text = sentence(error);
      const slot = name && document.getElementById(`wrong-${name}`);
      if (slot) slot.textContent = text;
      else rest.push(text);
    }
    return rest;
  }

  // What stands beside the fields.
  wrong() {
    return [...this.host.querySelectorAll(".wrong")].map((slot) => slot.textContent).filter(Boolean);
  }

  clear() {
    for (const slot of this.host.querySelectorAll(".wrong:not([role=alert])")) slot.textContent = ""; // not what was typed
  }
}

