// Fields of forms: a choice, a number in the unit that is shown, a tick.

import { element } from "./elements.js";
import { shown } from "./words.js";

// `options` are [value, text]; `chosen(value)` hears.
export function choiceField(id, text, options, value, chosen) {
  const made = element(
    "select",
    { id, onchange: () => chosen(made.value) },
    ...options.map(([name, title]) => element("option", { value: name, selected: name === value }, title)),
  );
  return element("div", { class: "field" }, element("label", { for: id }, text), made);
}

// `set` hears the value in the unit of the service, or null where the field is empty.
export function numberInput(text, value, unit, set, more = {}) {
  const [factor] = shown(unit);
  const made = element("input", {
    type: "number",
    step: "any",
    "aria-label": text,
    value: value === null || value === undefined ? "" : Number((value * factor).toPrecision(6)),
    onchange: () => set(made.value === "" ? null : Number(made.value) / factor),
    ...more,
  });
  return made;
}

export function tick(id, text, isSet, set) {
  const made = element("input", { id, type: "checkbox", checked: isSet, onchange: () => set(made.checked) });
  return element("p", { class: "tick" }, made, element("label", { for: id }, ` ${text}`));
}

export function button(text, onclick, more = {}) {
  return element("button", { type: "button", onclick, ...more }, text);
}
