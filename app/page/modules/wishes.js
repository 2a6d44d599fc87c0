// The fields of the best: criterion, limits of outputs, what may be chosen.

import { furtherOf } from "./best.js";
import { CRITERIA, FIGURES, NEEDS_OTHER } from "./criterion.js";
import { element, fill } from "./elements.js";
import { button, choiceField, grouped, numberInput } from "./fields.js";
import { usual } from "./view.js";
import { capital, label, sentence, shown, words } from "./words.js";

const MAX_LIMITS = 20;

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
    fill(this.host, this.criterion(best), this.limits(best), this.variables(best), ...this.further(best));
  }

  // What is typed here stands here already.
  follow(view) {
    const told = ({ best }) => JSON.stringify({ ...best, isFound: false });
    if (told(view) !== told(this.view)) this.show(view, this.scene);
    else this.view = { ...view, best: this.view.best };
  }

  change() {
    this.onchange({ ...structuredClone(this.view.best), isFound: false });
  }

  // Something changed that other fields depend on.
  changed(id = null) {
    this.change();
    this.show(this.view, this.scene);
    if (id) document.getElementById(id)?.focus();
  }

  // The field of a value of a row, or of the criterion.
  figure(text, row, name, unit, more = {}) {
    const set = (value) => {
      row[name] = value;
      this.change();
    };
    return numberInput(text, row[name], unit, set, more);
  }

  // Two ends of a range.
  ends(row, [from, to], text, unit, more = {}) {
    return element("div", { class: "ends" }, this.figure(`Least ${text}`, row, from, unit, more), "to", this.figure(`Largest ${text}`, row, to, unit, more), shown(unit)[1]);
  }

  tick(id, text, row, name) {
    const set = () => {
      row[name] = made.checked;
      this.changed(id);
    };
    const made = element("input", { id, type: "checkbox", checked: row[name], onchange: set });
    return element("p", { class: "tick" }, made, element("label", { for: id }, ` ${text}`));
  }

  removal(rows, place, next, text) {
    const remove = () => {
      rows.splice(place, 1);
      this.changed(next);
    };
    return button("Remove", remove, { "aria-label": `Remove ${text}` });
  }

  group(title, ...children) {
    return element("fieldset", {}, element("legend", {}, title), ...children);
  }

  complaint(place) {
    return element("span", { class: "wrong", "data-place": place });
  }

  criterion(best) {
    const { view, scene } = this;
    const others = scene.outputs.filter(({ name }) => name !== view.output);
    const name = FIGURES[best.kind];
    const of = { limit: best.against, target: view.output }[name];
    const unit = scene.outputs.find((one) => one.name === of)?.unit ?? "1";
    const told = { limit: "Limit of the magnitude", weight: "Weight", points: "Number of points of the trade-off", target: "Target" }[name];
    const [, unitShown] = shown(unit);
    const figure = name && this.figure(null, best, name, unit, { id: "criterion-figure" });
    return this.group(
      "What is best",
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
      figure ? element("div", { class: "field" }, element("label", { for: "criterion-figure" }, `${told}${unitShown ? ` (${unitShown})` : ""}`), figure) : null,
      this.complaint("criterion"),
    );
  }

  // Bounds that outputs have to keep: a row each.
  limits(best) {
    const { view, scene } = this;
    const add = () => {
      best.limits.push({ output: view.output, lower: null, upper: null, absolute: false });
      this.changed(`limit-${best.limits.length - 1}`);
    };
    const outputs = grouped(scene.outputs, (one) => [one.name, label(one.name, one.unit)]);
    return this.group(
      "Within these limits",
      ...best.limits.map((row, place) => this.limit(row, place, outputs)),
      best.limits.length < MAX_LIMITS ? button("Add a limit", add, { id: "add-limit" }) : null,
      view.kind === "sweep" ? this.tick("contact", "Require that the part keeps its contacts with floor and wall", best, "isInContact") : null,
    );
  }

  limit(row, place, outputs) {
    const { unit } = this.scene.outputs.find(({ name }) => name === row.output);
    const field = choiceField(`limit-${place}`, `Limit ${place + 1}`, outputs, row.output, (name) => {
      Object.assign(row, { output: name, lower: null, upper: null });
      this.changed(`limit-${place}`);
    });
    field.append(
      this.ends(row, ["lower", "upper"], words(row.output), unit, { isOptional: true }),
      this.tick(`size-${place}`, "Apply the bounds to the size of the output, whatever its sign", row, "absolute"),
      this.removal(this.view.best.limits, place, "add-limit", `limit ${place + 1}`),
      this.complaint(`constraints.${place}`),
    );
    return field;
  }

  // Variables and their bounds: the axes of the picture, and more.
  variables(best) {
    const { view, scene } = this;
    const axes = [view.x, view.y].filter(Boolean).map(({ name }) => name);
    const parameter = (name) => scene.parameters.find((one) => one.name === name);
    const left = Object.keys(view.values).filter((name) => !axes.includes(name) && !best.vary.some((row) => row.name === name));
    return this.group(
      "Variables and their bounds",
      element("p", { class: "pale" }, `${capital([...axes, ...best.vary.map(({ name }) => name)].map(words).join(", "))}: their bounds stand below the picture.`),
      this.complaint("variables"),
      left.length
        ? choiceField("vary", "Add a parameter", [["", "Choose ..."], ...left.map((name) => [name, label(name, parameter(name).unit)])], "", (name) => {
            if (!name) return;
            const [from, to] = usual(parameter(name));
            best.vary.push({ name, from, to });
            this.changed("vary");
          })
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
        this.figure(null, best.given, name, unit, { id }),
        this.complaint(`parameters.${name}`),
      );
    });
  }

  // Sentences of the service beside the fields that they concern.
  complain(errors) {
    for (const slot of this.host.querySelectorAll(".wrong[data-place]")) {
      const found = errors.find(({ place }) => `${place}.`.startsWith(`${slot.dataset.place}.`));
      slot.textContent = found ? sentence(found) : "";
    }
  }
}
