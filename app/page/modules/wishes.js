// The fields of the best: criterion, limits of outputs, what may be chosen.

import { furtherOf } from "./best.js";
import { CRITERIA, FIGURES, NEEDS_OTHER } from "./criterion.js";
import { element, fill } from "./elements.js";
import { button, choiceField, numberInput, tick } from "./fields.js";
import { grouped } from "./groups.js";
import { usual } from "./view.js";
import { capital, label, number, sentence, shown, words } from "./words.js";

const MAX_LIMITS = 20;
const MAX_POINTS = 200;

export class Wishes {
  // `onchange(best)` hears of what is wished for otherwise.
  constructor(host, onchange) {
    this.host = host;
    this.onchange = onchange;
  }

  show(view, scene) {
    this.scene = scene;
    const best = structuredClone(view.best); // a draft: the view has its own
    this.view = { ...view, best };
    fill(
      this.host,
      this.criterion(best),
      this.limits(best),
      this.choices(best),
      ...this.further(best),
    );
  }

  // What is typed here stands here already.
  follow(view) {
    const told = ({ best }) => JSON.stringify({ ...best, isFound: false });
    if (told(view) !== told(this.view)) this.show(view, this.scene);
    else this.view = { ...view, best: this.view.best };
  }

  // Something changed that other fields depend on.
  changed(id = null) {
    this.onchange({ ...this.view.best, isFound: false });
    this.show(this.view, this.scene);
    if (id) document.getElementById(id)?.focus();
  }

  figure(text, value, unit, set, more = {}) {
    const heard = (typed) => {
      set(typed);
      this.onchange({ ...this.view.best, isFound: false });
    };
    return numberInput(text, value, unit, heard, more);
  }

  complaint(place) {
    return element("span", { class: "wrong", "data-place": place });
  }

  criterion(best) {
    const { view, scene } = this;
    const others = scene.outputs.filter(({ name }) => name !== view.output);
    const name = FIGURES[best.kind];
    const against = scene.outputs.find((one) => one.name === best.against);
    const unit = name === "limit" ? (against?.unit ?? "1") : "1";
    const told = { limit: "Limit of the magnitude", weight: "Weight", points: "Number of points of the trade-off" }[name];
    const [, unitShown] = shown(unit);
    const isPoints = name === "points";
    return element(
      "fieldset",
      {},
      element("legend", {}, "What is best"),
      choiceField("criterion", capital(words(view.output)), Object.entries(CRITERIA), best.kind, (kind) => {
        best.kind = kind;
        this.changed("criterion");
      }),
      NEEDS_OTHER.has(best.kind)
        ? choiceField("against", "The other output", grouped(others, (one) => [one.name, label(one.name, one.unit)]), best.against, (chosen) => {
            best.against = chosen;
            this.changed("against");
          })
        : null,
      name
        ? element(
            "div",
            { class: "field" },
            element("label", { for: "criterion-figure" }, `${told}${unitShown ? ` (${unitShown})` : ""}`),
            this.figure(
              told,
              best[name],
              unit,
              (value) => (best[name] = value),
              {
                id: "criterion-figure",
                "aria-label": null,
                check: (value) => {
                  if (!isPoints) return value >= 0 ? "" : "The limit or weight of the second output has to be at least 0";
                  const isFit = Number.isInteger(value) && value >= 2 && value <= MAX_POINTS;
                  return isFit ? "" : `The number of points of the trade-off has to be a whole number from 2 to ${MAX_POINTS}`;
                },
              },
            ),
          )
        : null,
      this.complaint("criterion"),
      view.band && best.kind !== "pareto" ? this.robust(best) : null,
    );
  }

  robust(best) {
    const { name } = this.view.band;
    return tick("robust", `Optimise the worst case of the ${words(name)} within its uncertainty`, best.isRobust, (isSet) => {
      best.isRobust = isSet;
      this.changed("robust");
    });
  }

  addLimit() {
    document.getElementById("add-limit")?.click();
  }

  // Bounds that outputs have to keep: a row each.
  limits(best) {
    const { view, scene } = this;
    const add = (row, id) => {
      best.limits.push({ lower: null, upper: null, absolute: false, ...row });
      this.changed(id);
    };
    const next = `limit-${best.limits.length}`;
    const outputs = grouped(scene.outputs, (one) => [one.name, label(one.name, one.unit)]);
    const levels = scene.outputs.filter(
      ({ name, level }) =>
        Number.isFinite(level) && !best.limits.some(({ output, upper }) => output === name && upper === level),
    );
    return element(
      "fieldset",
      {},
      element("legend", {}, "Within these limits"),
      ...best.limits.map((row, place) => this.limit(row, place, outputs)),
      element(
        "div",
        { class: "buttons" },
        best.limits.length < MAX_LIMITS
          ? button("Add a limit", () => add({ output: view.output }, next), { id: "add-limit" })
          : null,
        ...levels.map(({ name, level, begins }) =>
          button(`No ${begins}: ${words(name)} at most ${number(level)}`, () => add({ output: name, upper: level }, next)),
        ),
      ),
      view.kind === "sweep"
        ? tick("contact", "Require that the part keeps its contacts with floor and wall", best.isInContact, (isSet) => {
            best.isInContact = isSet;
            this.changed("contact");
          })
        : null,
    );
  }

  limit(row, place, outputs) {
    const { best } = this.view;
    const { unit } = this.scene.outputs.find(({ name }) => name === row.output);
    const [, unitShown] = shown(unit);
    const told = words(row.output);
    const field = choiceField(`limit-${place}`, `Limit ${place + 1}`, outputs, row.output, (name) => {
      Object.assign(row, { output: name, lower: null, upper: null });
      this.changed(`limit-${place}`);
    });
    field.append(
      element(
        "div",
        { class: "ends" },
        "from",
        this.figure(`Least ${told}`, row.lower, unit, (value) => (row.lower = value), { isOptional: true }),
        "to",
        this.figure(`Largest ${told}`, row.upper, unit, (value) => (row.upper = value), { isOptional: true }),
        unitShown,
      ),
      element(
        "div",
        { class: "ends" },
        tick(`size-${place}`, "Apply the bounds to the size of the output, whatever its sign", row.absolute, (isSet) => {
          row.absolute = isSet;
          this.changed(`size-${place}`);
        }),
        button(
          "Remove",
          () => {
            best.limits.splice(place, 1);
            this.changed("add-limit");
          },
          { "aria-label": `Remove limit ${place + 1}` },
        ),
      ),
      this.complaint(`constraints.${place}`),
    );
    return field;
  }

  // Variables and their bounds: the axes of the picture, and more.
  choices(best) {
    const { view, scene } = this;
    const axes = [view.x, view.y].filter(Boolean);
    const parameter = (name) => scene.parameters.find((one) => one.name === name);
    const left = Object.keys(view.values).filter((name) => !best.vary.some((row) => row.name === name));
    return element(
      "fieldset",
      {},
      element("legend", {}, "Variables and their bounds"),
      element("p", { class: "unit" }, `${capital(axes.map(({ name }) => words(name)).join(" and "))}, are varied within the axes of the picture.`),
      ...best.vary.map((row, place) => {
        const { unit } = parameter(row.name);
        const [, unitShown] = shown(unit);
        return element(
          "div",
          { class: "field" },
          element("span", {}, label(row.name, unit)),
          button(
            "Remove",
            () => {
              best.vary.splice(place, 1);
              this.changed("vary");
            },
            { "aria-label": `Remove ${words(row.name)}` },
          ),
          element(
            "div",
            { class: "ends" },
            this.figure(`Least ${words(row.name)}`, row.from, unit, (value) => (row.from = value)),
            "to",
            this.figure(`Largest ${words(row.name)}`, row.to, unit, (value) => (row.to = value)),
            unitShown,
          ),
          this.complaint(`variables.${row.name}`),
        );
      }),
      left.length
        ? choiceField(
            "vary",
            "Add a parameter",
            [["", "Choose ..."], ...left.map((name) => [name, label(name, parameter(name).unit)])],
            "",
            (name) => {
              if (!name) return;
              const [from, to] = usual(parameter(name));
              best.vary.push({ name, from, to });
              this.changed("vary");
            },
          )
        : null,
    );
  }

  // Values that the other outputs need.
  further(best) {
    return furtherOf(this.view, this.scene).map(({ name, unit, description }) => {
      const id = `given-${name}`;
      return element(
        "div",
        { class: "field", title: description },
        element("label", { for: id }, label(name, unit)),
        this.figure("", best.given[name], unit, (value) => (best.given[name] = value), { id, "aria-label": null }),
        this.complaint(`parameters.${name}`),
      );
    });
  }

  // Sentences of the service beside the fields that they concern; returns those that concern none.
  complain(errors) {
    this.clear();
    const rest = [];
    for (const error of errors) {
      const { place } = error;
      const text = sentence(error);
      const slot = [...this.host.querySelectorAll(".wrong")].find(({ dataset }) =>
        `${place}.`.startsWith(`${dataset.place}.`),
      );
      if (slot) slot.textContent = text;
      else rest.push(text);
    }
    return rest;
  }

  clear() {
    for (const slot of this.host.querySelectorAll(".wrong")) slot.textContent = "";
  }
}
