// Fields of forms: a choice, a number in the unit that is shown, a tick.

import { element } from "./elements.js";
import { fieldText, readNumber } from "./numbers.js";
import { shown } from "./words.js";

// `options` are [value, text], or groups of them, [title, options]; `chosen(value)` hears.
export function choiceField(id, text, options, value, chosen) {
  const option = ([name, told]) =>
    Array.isArray(told)
      ? element("optgroup", { label: name }, ...told.map(option))
      : element("option", { value: name, selected: name === value }, told);
  const made = element("select", { id, onchange: () => chosen(made.value) }, ...options.map(option));
  return element("div", { class: "field" }, element("label", { for: id }, text), made);
}

// A number, typed with or without its unit; `set` hears the value in the unit of the service. What is
// no number, or what `check` objects to with a sentence, changes nothing: the last value holds, the text stays
// to be corrected, and the reason is said beside the field. An `isOptional` field may be emptied: `set` then hears null.
/**
 * @param {string | null} text its name, where no label has it
 * @param {number | null | undefined} value
 * @param {string} unit of the service
 * @param {(value: number | null) => void} set
 * @param {{isOptional?: boolean, check?: (value: number) => string, [attribute: string]: any}} options
 */
export function numberInput(text, value, unit, set, { isOptional = false, check = () => "", ...more } = {}) {
  let last = value;
  const said = element("span", { class: "wrong", role: "alert" });
  const made = element("input", {
    type: "text",
    inputmode: "decimal",
    autocomplete: "off",
    "aria-label": text,
    value: fieldText(value, unit),
    onchange: () => take(),
    onkeydown: (event) => step(event),
    ...more,
  });
  // Another value, as if it had been typed.
  made.show = (other) => {
    last = other;
    made.value = fieldText(other, unit);
    made.removeAttribute("aria-invalid");
    said.remove();
  };
  function take() {
    const isEmptied = isOptional && made.value.trim() === "";
    const read = isEmptied ? { value: null } : readNumber(made.value, unit);
    const problem = read.problem ?? (isEmptied ? "" : check(read.value));
    if (!problem) {
      made.show(read.value);
      set(read.value);
      return;
    }
    const [, unitShown] = shown(unit);
    const kept = last === null || last === undefined ? "" : `; ${fieldText(last, unit)} ${unitShown}`.trimEnd() + " holds until it is corrected";
    said.textContent = `${problem}${kept}.`;
    made.setAttribute("aria-invalid", "true");
    (made.closest(".slot") ?? made).after(said);
  }
  // The arrow keys change the last digit.
  function step(event) {
    const sign = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (!sign || readNumber(made.value, unit).problem) return;
    const decimals = made.value.match(/^-?\d+[.,](\d+)$/)?.[1].length ?? 0;
    made.value = (Number(made.value.replace(",", ".")) + sign * 10 ** -decimals).toFixed(decimals);
    event.preventDefault();
    take();
  }
  return made;
}

export function tick(id, text, isSet, set) {
  const made = element("input", { id, type: "checkbox", checked: isSet, onchange: () => set(made.checked) });
  return element("p", { class: "tick" }, made, element("label", { for: id }, ` ${text}`));
}

export function button(text, onclick, more = {}) {
  return element("button", { type: "button", onclick, ...more }, text);
}
