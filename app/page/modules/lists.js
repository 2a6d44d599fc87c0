// Lists: every output of a design, the devices of a line in their order, the figures of the thesis, and the words of a
// picture.

import { element, fill } from "./elements.js";
import { grouped } from "./fields.js";
import { capital, label, withUnit, words } from "./words.js";

// All outputs that were computed of the design, in groups.
export function tellValues(host, scene, dataset, isStale) {
  host.classList.toggle("stale", isStale);
  const known = scene.outputs.filter(({ name }) => typeof dataset?.variables[name]?.data === "number");
  const row = ({ name, unit, equation }) => element("tr", { title: equation || null }, element("th", { scope: "row" }, capital(words(name))), element("td", {}, withUnit(dataset.variables[name].data, unit, 4)));
  const groups = grouped(known, (one) => one);
  const isPlain = groups.length && !Array.isArray(groups[0]);
  fill(
    host,
    element("h3", {}, "Every output of this design"),
    ...(isPlain ? [["", groups]] : groups).map(([title, list]) => element("table", {}, title ? element("caption", {}, title) : null, element("tbody", {}, ...list.map(row)))),
  );
}

const DEVICE = /^(?!turn_|drop_count_).*_(\d)$/; // what gives a device of a line, with its place

// The devices of a line as they are passed, each with its own value.
export function tellDevices(host, view, scene, { onadd, onremove }) {
  const all = scene.parameters.filter(({ name }) => DEVICE.test(name)).map((one) => ({ ...one, place: Number(one.name.match(DEVICE)[1]) }));
  const present = all.filter(({ name }) => name in view.values).sort((one, other) => one.place - other.place);
  const free = all.filter(({ place }) => !present.some((one) => one.place === place));
  const next = free.filter(({ place }) => place === Math.min(...free.map((one) => one.place)));
  const title = ({ name }) => capital(words(name)).replace(/, place \d$/, "");
  const choice = element(
    "select",
    { id: "add-device", "aria-label": "Add a device", onchange: () => choice.value && onadd(choice.value) },
    element("option", { value: "" }, "Add a device ..."),
    ...next.map((one) => element("option", { value: one.name }, title(one))),
  );
  fill(
    host,
    element(
      "ol",
      { class: "devices" },
      ...present.map((one) =>
        element(
          "li",
          {},
          element("b", {}, `${title(one)}, ${withUnit(view.values[one.name], one.unit, 3)}`),
          element("span", { class: "pale" }, ` ${one.description}`),
          element("button", { type: "button", class: "remove", "aria-label": `Remove the device ${words(one.name)}`, onclick: () => onremove(one.name) }, "×"),
        ),
      ),
    ),
    next.length ? choice : null,
  );
}

// The figures of the thesis as views.
export function viewOf(figure) {
  const { study } = figure;
  const { kind, scene, variant: choice = "", outputs: [output] } = study;
  const view = { question: "thesis", figure: figure.name, kind, scene, choice, output, values: {}, x: null, y: null };
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

// What the words of a picture mean: its equation, and each parameter that it depends on.
export function tellMeaning(host, { output, values, x, y }, scene) {
  const shown = scene.outputs.find(({ name }) => name === output);
  const names = new Set([x?.name, y?.name, ...Object.keys(values)]);
  const line = ({ name, symbol, unit, description }) => [
    element("dt", {}, label(name, unit), symbol ? ` ${symbol}` : null),
    element("dd", {}, description),
  ];
  fill(
    host,
    element("p", {}, capital(shown.equation || shown.description), " ", element("small", {}, shown.source ?? "")),
    element("dl", {}, ...[shown, ...scene.parameters.filter(({ name }) => names.has(name))].flatMap(line)),
  );
}
