// The best drive: a criterion and its limits, what may be chosen, and where the best lies.

import { element, fill } from "./elements.js";
import { carryOut } from "./service.js";
import { capital, label, number, shown, withUnit, words } from "./words.js";

const CRITERIA = {
  maximise: "As large as possible",
  minimise: "As small as possible",
  weighted: "Large, little of another output (weighted)",
  limit: "Large, another output below a limit",
  pareto: "The whole trade-off with another output",
};
const NEEDS_OTHER = new Set(["weighted", "limit", "pareto"]);

// The study of the best choice of what runs across and up in a view.
export function optimumOf(view, criterion) {
  const variables = {};
  for (const axis of [view.x, view.y]) {
    if (axis) variables[axis.name] = { lower: axis.from, upper: axis.to };
  }
  const study = {
    kind: "optimise",
    scene: view.scene,
    criterion: { kind: criterion.kind, output: view.output },
    variables,
    parameters: { ...view.values },
  };
  if (view.kind === "sweep" && view.choice) study.variant = view.choice;
  if (NEEDS_OTHER.has(criterion.kind)) study.criterion.against = criterion.against;
  if (criterion.kind === "limit") study.criterion.limit = criterion.limit;
  if (criterion.kind === "weighted") study.criterion.weight = criterion.weight;
  if (criterion.kind === "pareto") study.criterion.points = 60;
  if (criterion.staysOnFloor) study.constraints = [{ output: "throw_number", upper: 1 }];
  return study;
}

export class Optimum {
  constructor(host, { onfound, tell }) {
    this.host = host;
    this.tellJob = tell;
    this.onfound = onfound;
    this.criterion = { kind: "maximise", against: "", limit: 1, weight: 1, staysOnFloor: false };
    this.said = element("div", { role: "status" });
    this.front = element("div", { class: "front" });
  }

  show(view, scene) {
    this.view = view;
    this.scene = scene;
    const { criterion } = this;
    const others = scene.outputs.filter(({ name }) => name !== view.output);
    if (!others.some(({ name }) => name === criterion.against)) {
      criterion.against =
        others.find(({ name }) => name === "acceleration_y")?.name ?? others[0]?.name ?? "";
    }
    const choose = (id, text, options, value, key) => {
      const made = element(
        "select",
        {
          id,
          onchange: () => {
            criterion[key] = made.value;
            this.show(view, scene);
          },
        },
        ...options.map(([name, title]) =>
          element("option", { value: name, selected: name === value }, title),
        ),
      );
      return element("div", { class: "field" }, element("label", { for: id }, text), made);
    };
    const isOther = NEEDS_OTHER.has(criterion.kind);
    const against = scene.outputs.find(({ name }) => name === criterion.against);
    const [factor, unit] = shown(criterion.kind === "weighted" ? "1" : (against?.unit ?? "1"));
    const key = criterion.kind === "weighted" ? "weight" : "limit";
    const figure = element("input", {
      id: "criterion-figure",
      type: "number",
      step: "any",
      min: "0",
      value: criterion[key] * factor,
      onchange: () => {
        criterion[key] = Number(figure.value) / factor;
      },
    });
    const hasThrow = scene.outputs.some(({ name }) => name === "throw_number");
    const stays = element("input", {
      id: "stays",
      type: "checkbox",
      checked: criterion.staysOnFloor,
      onchange: () => {
        criterion.staysOnFloor = stays.checked;
      },
    });
    fill(
      this.host,
      element("h2", {}, "The best of this picture"),
      choose("criterion", words(view.output), Object.entries(CRITERIA), criterion.kind, "kind"),
      isOther
        ? choose("against", "The other output", others.map((o) => [o.name, label(o.name, o.unit)]), criterion.against, "against")
        : null,
      criterion.kind === "limit" || criterion.kind === "weighted"
        ? element(
            "div",
            { class: "field" },
            element("label", { for: "criterion-figure" }, `${capital(key)}${unit ? ` (${unit})` : ""}`),
            figure,
          )
        : null,
      hasThrow
        ? element("p", {}, stays, element("label", { for: "stays" }, " The part has to stay on the track"))
        : null,
      element("button", { type: "button", onclick: () => this.find() }, "Find the best"),
      this.said,
      this.front,
    );
  }

  async find() {
    this.said.textContent = "Looking for the best ...";
    fill(this.front);
    try {
      const { dataset } = await carryOut("optimise", optimumOf(this.view, this.criterion), {
        tell: (job) => {
          this.tellJob(job);
          this.said.textContent = `${job.message} ${job.progress} %`;
        },
      });
      this.tell(dataset);
    } catch (error) {
      fill(this.said, element("p", { class: "wrong" }, error.message), ...(error.errors ?? []).map((e) =>
        element("p", { class: "wrong" }, `${capital(e.message)}. ${e.fix}.`)));
    }
  }

  tell(dataset) {
    const { variables } = dataset;
    const names = [this.view.x, this.view.y].filter(Boolean).map(({ name }) => name);
    const value = (name) => variables[name]?.data;
    const best = Object.fromEntries(names.map((name) => [name, value(`best_${name}`)]));
    if (Array.isArray(best[names[0]])) {
      this.tellFront(dataset, names);
      return;
    }
    const status = Object.entries(variables.optimum_status?.flags ?? {}).find(
      ([, number_]) => number_ === value("optimum_status"),
    )?.[0];
    if (best[names[0]] === null || best[names[0]] === undefined) {
      this.said.textContent = `There is no best: ${words(status ?? "no solution")}.`;
      return;
    }
    const outputs = Object.entries(variables).filter(
      ([name, variable]) => typeof variable.data === "number" && !variable.flags && !names.includes(name),
    );
    fill(
      this.said,
      element(
        "table",
        {},
        ...outputs.map(([name, variable]) =>
          element(
            "tr",
            {},
            element("th", { scope: "row" }, variable.long_name ?? capital(words(name))),
            element("td", {}, withUnit(variable.data, variable.units ?? "1")),
          ),
        ),
      ),
      element("p", {}, status ? `It is ${words(status)}.` : ""),
    );
    this.onfound([{ x: best[this.view.x.name], y: this.view.y ? best[this.view.y.name] : null, text: "best" }]);
  }

  // The trade-off as points of both outputs; one of them is shown in the map when it is chosen.
  tellFront(dataset, names) {
    const { variables } = dataset;
    const { output } = this.view;
    const { against } = this.criterion;
    const data = (name) => (variables[name] ?? variables[`best_${name}`])?.data ?? [];
    const points = data(output).map((value, i) => ({
      value,
      other: Math.abs(data(against)[i]),
      at: Object.fromEntries(names.map((name) => [name, variables[`best_${name}`].data[i]])),
    })).filter(({ value, other }) => value !== null && Number.isFinite(other));
    this.said.textContent = `${points.length} drives that nothing beats in both. Choose one.`;
    const unitOf = (name) => variables[name]?.units ?? "1";
    const table = element(
      "table",
      {},
      element(
        "tr",
        {},
        ...[output, against, ...names].map((name) =>
          element("th", { scope: "col" }, label(name, unitOf(names.includes(name) ? `best_${name}` : name))),
        ),
        element("th", {}),
      ),
      ...points.filter((_, i) => i % Math.ceil(points.length / 12) === 0).map((point) =>
        element(
          "tr",
          {},
          element("td", {}, number(point.value * shown(unitOf(output))[0])),
          element("td", {}, number(point.other * shown(unitOf(against))[0])),
          ...names.map((name) =>
            element("td", {}, number(point.at[name] * shown(unitOf(`best_${name}`))[0])),
          ),
          element(
            "td",
            {},
            element(
              "button",
              {
                type: "button",
                onclick: () =>
                  this.onfound([{ x: point.at[names[0]], y: names[1] ? point.at[names[1]] : null, text: "chosen" }]),
              },
              "Show",
            ),
          ),
        ),
      ),
    );
    fill(this.front, table);
  }
}
