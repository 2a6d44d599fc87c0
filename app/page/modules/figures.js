// The figures of the thesis as views.

import { element, fill } from "./elements.js";

export function viewOf(figure) {
  const { study } = figure;
  const view = {
    question: "thesis",
    figure: figure.name,
    kind: study.kind,
    scene: study.scene,
    choice: study.variant ?? "",
    output: study.outputs[0],
    values: {},
    x: null,
    y: null,
  };
  const ranged = [];
  for (const [name, value] of Object.entries(study.parameters)) {
    if (typeof value === "number") view.values[name] = value;
    else if (Array.isArray(value)) ranged.push({ name, from: value[0], to: value.at(-1) });
    else ranged.push({ name, from: value.start, to: value.stop });
  }
  // Longest first, as its pictures have them; a third axis is held at its middle, as the design is.
  const [x, y] = ranged;
  view.x = x;
  view.y = y ?? null;
  for (const { name, from, to } of ranged) view.values[name] = (from + to) / 2;
  return { ...view, begun: { ...view.values } };
}

// Its lines are broken where a page of text ends them.
const unbroken = (notes) => notes.replace(/\n(?=[a-z(])/g, " ");

// `onchange(figure)` hears of a figure, null of every output in place of one.
export function tellFigures(host, figures, chosen, onchange) {
  const choice = element(
    "select",
    { id: "choose-figure", onchange: () => onchange(figures.find(({ name }) => name === choice.value) ?? null) },
    element("option", { value: "", selected: !chosen }, "No figure: every output of any system"),
    ...figures.map(({ name, title }) => element("option", { value: name, selected: name === chosen }, title)),
  );
  const figure = figures.find(({ name }) => name === chosen);
  fill(
    host,
    element("div", { class: "field" }, element("label", { for: "choose-figure" }, "Figure of the thesis"), choice),
    figure ? element("p", { class: "notes" }, unbroken(figure.notes)) : null,
  );
}
