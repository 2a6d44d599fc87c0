// Numbers as people type them: a point or a comma, a unit. What is no number
// stays none: it never becomes 0.

import { shown } from "./words.js";

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

// As it stands in a field: six digits, in the unit that is shown.
export function fieldText(value, unit) {
  const [factor] = shown(unit);
  return value === null || value === undefined ? "" : String(Number((value * factor).toPrecision(6)));
}
