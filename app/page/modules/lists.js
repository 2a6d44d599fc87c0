// Values of a design as lists: every output, and the devices of a line in their order.

import { element, fill } from "./elements.js";
import { grouped } from "./groups.js";
import { capital, withUnit, words } from "./words.js";

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

const DEVICES = {
  wiper_height: ["Wiper", "parts that are higher fall back"],
  ledge_width: ["Narrow ledge", "parts that reach too far beyond it fall back"],
  gap_length: ["Gap", "parts that it does not carry fall back"],
  passed_aspect: ["Cut-out", "one way to lie passes"],
  outlet_capacity: ["Outlet", "takes so many parts a minute"],
  turned_share: ["Step", "turns parts over"],
};
const PLACES = 6;

// The devices of a line as they are passed, each with its own value.
export function tellDevices(host, view, scene, { onadd, onremove }) {
  const parameter = (name) => scene.parameters.find((one) => one.name === name);
  const present = [];
  for (let place = 1; place <= PLACES; place++) {
    for (const [stem, [title, does]] of Object.entries(DEVICES)) {
      const name = `${stem}_${place}`;
      if (name in view.values) present.push({ name, place, title, does });
    }
  }
  const free = Array.from({ length: PLACES }, (_, k) => k + 1).find((place) => !present.some((one) => one.place === place));
  const choice = free && element(
    "select",
    { id: "add-device", "aria-label": "Add a device", onchange: () => choice.value && onadd(`${choice.value}_${free}`) },
    element("option", { value: "" }, "Add a device ..."),
    ...Object.entries(DEVICES).filter(([stem]) => parameter(`${stem}_${free}`)).map(([stem, [title, does]]) => element("option", { value: stem }, `${title}: ${does}`)),
  );
  fill(
    host,
    element(
      "ol",
      { class: "devices" },
      ...present.map(({ name, title, does }) =>
        element(
          "li",
          {},
          element("b", {}, `${title}, ${withUnit(view.values[name], parameter(name).unit, 3)}`),
          element("span", { class: "pale" }, ` ${does}`),
          element("button", { type: "button", class: "remove", "aria-label": `Remove the device ${words(name)}`, onclick: () => onremove(name) }, "×"),
        ),
      ),
    ),
    choice || null,
  );
}
