// Fields of forms: a choice, a number in the unit that is shown; and numbers as people type them, with a point or a
// comma, and a unit. What is no number stays none: it never becomes 0.

import { element } from "./elements.js";
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
  return made;
}

export function button(text, onclick, more = {}) {
  return element("button", { type: "button", onclick, ...more }, text);
}

const MAX_CHARACTERS = 60;

// Units that may be typed, by the unit of the service: what one of them is in it.
const TYPED = {
  1: { "%": 0.01 },
  m: { m: 1, cm: 1e-2, mm: 1e-3, µm: 1e-6, um: 1e-6, in: 0.0254 },
  "m s-1": { "m/s": 1, "cm/s": 1e-2, "mm/s": 1e-3, "m/min": 1 / 60 },
  "m s-2": { "m/s²": 1, "m/s2": 1, "m/s^2": 1, g: 9.80665 },
  degree: { "°": 1, deg: 1, degree: 1, degrees: 1, rad: 180 / Math.PI },
  Hz: { Hz: 1, kHz: 1e3, rpm: 1 / 60, vpm: 1 / 60, "1/min": 1 / 60 },
  kg: { kg: 1, g: 1e-3, mg: 1e-6 },
  s: { s: 1, ms: 1e-3, min: 60 },
  "%": { "%": 1 },
  N: { N: 1, mN: 1e-3, kN: 1e3 },
};

// The value in the unit of the service: {value}, or {problem}, a sentence on what is wrong.
export function readNumber(text, unit) {
  const typed = text.trim().replaceAll("\u2212", "-");
  if (typed === "") return { problem: "No number is given" };
  if (typed.length > MAX_CHARACTERS) return { problem: "The text is too long to be a number: shorten it" };
  if (/^[-+]?[1-9]\d{0,2}(,\d{3})+(?![\d.])/.test(typed)) {
    return { problem: `"${typed}" may mean two numbers: remove the comma, or write a decimal point` };
  }
  const [perUnit] = shown(unit);
  const bare = plain(typed);
  const value = bare === null ? withUnitTyped(typed, unit) : bare / perUnit;
  if (value === null) {
    const known = Object.keys(TYPED[unit] ?? {}).join(", ");
    return { problem: `"${typed}" is not a number${known ? `, alone or with ${known}` : ""}` };
  }
  return Number.isFinite(value) ? { value } : { problem: `"${typed}" is too large: give a smaller number` };
}

// The value of a number and a unit that fits, in the unit of the service; else null.
function withUnitTyped(text, unit) {
  const known = TYPED[unit] ?? {};
  const endings = (fold) => Object.keys(known).filter((one) => fold(text).endsWith(fold(one)));
  const exact = endings((one) => one);
  const [name] = (exact.length ? exact : endings((one) => one.toLowerCase())).sort((one, other) => other.length - one.length);
  if (name === undefined) return null;
  const value = plain(text.slice(0, -name.length).trim());
  const [perUnit, nameShown] = shown(unit);
  if (value === null) return null;
  return name === nameShown ? value / perUnit : value * known[name];
}

// The value of a number with a point or a comma; null of anything else.
function plain(text) {
  return /^[-+]?(\d+[.,]?\d*|[.,]\d+)(e[-+]?\d+)?$/i.test(text) ? Number(text.replace(",", ".")) : null;
}

// As it stands in a field, in the unit that is shown: six digits, four of what has more, as what was computed has.
export function fieldText(value, unit) {
  if (value === null || value === undefined) return "";
  const [exact, short] = [6, 4].map((digits) => Number((value * shown(unit)[0]).toPrecision(digits)));
  return String(Math.abs(exact - value * shown(unit)[0]) > 1e-9 * Math.abs(exact) ? short : exact);
}

// Outputs in groups: what a designer asks for most in front, then by what they are about.
const MOST_ASKED = [
  "conveying_velocity", "feed_rate", "hop_height", "throw_number", "landing_speed", "flight_fraction", "acceleration_x", "track_amplitude",
];
const FEW = 10; // need no groups

// The first that fits counts; by name, or by unit.
/** @type {{title: string, isIn: (output: {name: string, unit: string}) => boolean}[]} */
const GROUPS = [
  { title: "Most asked", isIn: ({ name }) => MOST_ASKED.includes(name) },
  { title: "Power and work", isIn: ({ name }) => /_(power|work)$|^efficiency$/.test(name) },
  { title: "Speed and rate", isIn: ({ name, unit }) => ["m s-1", "min-1"].includes(unit) || /velocity|speed|fastest|direction/.test(name) },
  { title: "What the part does", isIn: ({ name }) => /fraction|impacts|period|status|share/.test(name) },
  { title: "Accelerations, forces and strokes", isIn: ({ name, unit }) => !/_scale$/.test(name) && unit !== "1" },
  { title: "Dimensionless numbers and scales", isIn: () => true },
];

// Options of a choice, by `option(output)`; where there are many, as [title, options] of groups.
export function grouped(outputs, option) {
  if (outputs.length <= FEW) return outputs.map(option);
  const left = [...outputs];
  const taken = (isIn) => left.filter(isIn).map((one) => left.splice(left.indexOf(one), 1)[0]);
  return GROUPS.map(({ title, isIn }) => [title, taken(isIn).map(option)]).filter(([, list]) => list.length);
}
