// What is shown: a plain object, and the link that restores it. A link is somebody's text: nothing
// of it is believed before it is compared with what the service says there is.

import { bestFromQuery, bestToQuery } from "./criterion.js";
import { QUESTIONS } from "./questions.js";
import { SETS } from "./sets.js";
import { withUnit } from "./words.js";

const MAX_CHARACTERS = 4000;

const MAX_RUNS = 50;
export const MAX_PINS = 4;
const KINDS = ["simulate", "sweep"];

/**
 * @typedef {{name: string, from: number, to: number}} Axis
 * @typedef {{name: string, share: number}} Band
 *
 * What is shown.
 * @typedef {object} View
 * @property {string} question
 * @property {string} kind `simulate` or `sweep`
 * @property {string} scene
 * @property {string} choice its method or variant; "" is that of the service
 * @property {string} [set] parameters in place of others, by name in `sets.js`
 * @property {string} output
 * @property {Axis} x
 * @property {Axis | null} y null where lines are drawn
 * @property {Record<string, number>} values of all parameters, in units of the service
 * @property {Record<string, number>} [begun] values that its question begins with
 * @property {Record<string, number>} [own] values that the service has by itself
 * @property {Band | null} [band] what is not known exactly
 * @property {string} [part] by its name in `parts.js`, as it is drawn
 * @property {string} [pair] of materials whose published friction was taken
 * @property {number[][]} [runs] of [value across, measured speed]
 * @property {Record<string, number>[]} [pins] designs
 * @property {{name: string, drive: object}} [recording] of a drive, which is in no link
 * @property {{name: string, place: number, part: object, wanted?: string}} [surface] of a part from a file, which is in no link
 * @property {string} [figure] of the thesis
 * @property {any} [best] as `criterion.js` has it
 */

// The same, which nothing can change: `setView` of the page alone makes another one.
export function frozen(value) {
  if (value !== null && typeof value === "object") Object.values(Object.freeze(value)).forEach(frozen);
  return value;
}

// What is drawn of a view, as text: two views with the same have the same picture.
/** @param {any} view */
export function pictureOf({ kind, scene, choice, set, recording, output, x, y, values, band, question }) {
  const fixed = Object.entries(values).filter(([name]) => name !== x.name && name !== y?.name);
  const told = toLink({ question: "", kind, scene, choice, set, output, x, y, values: Object.fromEntries(fixed), band: question === "uncertain" ? band : null });
  return recording ? `${told}&recording=${recording.name}:${recording.drive.data.length}` : told;
}

// What a design does, as text: two views with the same have the same answer.
export function designOf({ kind, scene, choice, set, recording, surface, output, values, band }) {
  if (surface) return `file ${surface.place}`;
  return pictureOf({ kind, scene, choice, set, recording, output, x: { name: "" }, y: null, values, band, question: "uncertain" });
}

/** @param {View} view */
export function toLink(view) {
  const query = new URLSearchParams({
    question: view.question,
    kind: view.kind,
    scene: view.scene,
    choice: view.choice,
    output: view.output,
  });
  for (const place of ["x", "y"]) {
    const axis = view[place];
    if (axis) query.set(place, [axis.name, axis.from, axis.to].join(":"));
  }
  for (const [name, value] of Object.entries(view.values)) query.set(`p.${name}`, String(value));
  for (const place of ["x", "y"]) if (view[place] === null) query.set(place, "");
  if (view.band) query.set("band", `${view.band.name}:${view.band.share}`);
  if (view.set) query.set("set", view.set);
  if (view.figure) query.set("figure", view.figure);
  for (const name of ["part", "pair"]) if (view[name]) query.set(name, view[name]);
  if (view.runs) query.set("runs", view.runs.map((run) => run.join(":")).join(","));
  for (const pin of view.pins ?? []) {
    query.append("pin", Object.entries(pin).map(([name, value]) => `${name}:${value}`).join(","));
  }
  if (view.question === "drive" && view.best) bestToQuery(view.best, query);
  return `#${query}`;
}

// What a link asks for, and a sentence about each part of it that makes no sense.
/** @param {string} hash @returns {{wanted: any, complaints: string[]}} */
export function fromLink(hash) {
  const complaints = [];
  const text = hash.replace(/^#/, "");
  if (!text) return { wanted: {}, complaints };
  if (text.length > MAX_CHARACTERS) {
    return { wanted: {}, complaints: ["The link is too long to be read: the page shows its defaults."] };
  }
  const query = new URLSearchParams(text);
  const wanted = { values: Object.create(null) }; // names may be any, also __proto__
  const names = { question: Object.keys(QUESTIONS), set: Object.keys(SETS), kind: KINDS, scene: null, choice: null, output: null, figure: null, part: null, pair: null };
  for (const [name, known] of Object.entries(names)) {
    const value = query.get(name);
    if (value === null) continue;
    if (known && !known.includes(value)) complaints.push(`The link names an unknown ${name}: the default is used.`);
    else wanted[name] = value;
  }
  // What stands there, as `read` makes it; what it makes nothing of is told.
  const take = (name, read, told) => {
    const given = query.get(name);
    if (given === null) return;
    const found = read(given);
    if (found === undefined) complaints.push(`The link gives ${told}: the default is used.`);
    else wanted[name] = found;
  };
  for (const place of ["x", "y"]) {
    const read = (given) => {
      if (given === "" && place === "y") return null;
      const [name, from, to] = given.split(":");
      return isNumber(from) && isNumber(to) && Number(from) < Number(to) ? { name, from: Number(from), to: Number(to) } : undefined;
    };
    take(place, read, `the ${place} axis no valid range`);
  }
  take("band", (given) => {
    const [name, share] = given.split(":");
    return Number(share) > 0 && Number(share) < 1 ? { name, share: Number(share) } : undefined;
  }, "an uncertainty that is not between 0 and 1");
  take("runs", (given) => {
    const runs = given.split(",").slice(0, MAX_RUNS).map((run) => run.split(":"));
    return runs.length > 1 && runs.every((run) => run.length === 2 && run.every(isNumber)) ? runs.map((run) => run.map(Number)) : undefined;
  }, "measured runs that are not pairs of numbers");
  for (const [name, value] of query) {
    if (!name.startsWith("p.")) continue;
    if (isNumber(value)) wanted.values[name.slice(2)] = Number(value);
    else complaints.push("The link gives a parameter a value that is not a number: the default is used.");
  }
  // Links of before had the values of the axes as a point.
  const point = query.get("point")?.split(":") ?? [];
  ["x", "y"].forEach((place, i) => {
    if (wanted[place] && isNumber(point[i])) wanted.values[wanted[place].name] ??= Number(point[i]);
  });
  const pins = query.getAll("pin").slice(0, MAX_PINS).map(pinOf);
  if (pins.includes(null)) complaints.push("The link holds a pinned design without valid numbers: the design is left out.");
  if (pins.length) wanted.pins = pins.filter((pin) => pin !== null);
  const best = bestFromQuery(query, complaints);
  if (best) wanted.best = best;
  return { wanted, complaints: [...new Set(complaints)] };
}

function isNumber(text) {
  return Boolean(text) && Number.isFinite(Number(text));
}

// A pinned design: its values by name, which may be any.
function pinOf(text) {
  const pin = Object.create(null);
  for (const part of text.split(",")) {
    const [name, value] = part.split(":");
    if (!name || !isNumber(value)) return null;
    pin[name] = Number(value);
  }
  return pin;
}

// What a parameter may be: within its bounds, and where it usually is.
export function usual(parameter) {
  if (parameter.usual) return parameter.usual;
  const typical = parameter.example ?? parameter.default ?? 1;
  const lower = parameter.lower ?? -Infinity;
  const upper = parameter.upper ?? Infinity;
  if (parameter.name === "gamma") return [-10, 10];
  if (parameter.unit === "degree") return [Math.max(lower, 0), Math.min(upper, 60)];
  if (typical === 0) return [Math.max(lower, 0), Math.min(upper, 1)];
  return [Math.max(lower, 0.2 * typical), Math.min(upper, 2 * typical)].sort((a, b) => a - b);
}

// A sentence about a value outside of what is usual, else "". What a parameter is by itself, or its question
// begins with, is no cause for a warning.
export function unusual(parameter, value, begun = undefined) {
  if (value === parameter.default || value === begun) return "";
  const [low, high] = usual(parameter);
  if (value >= low && value <= high) return "";
  const where = value < low ? "Below" : "Above";
  return `${where} the usual ${withUnit(low, parameter.unit)} to ${withUnit(high, parameter.unit)}.`;
}

export function typical(parameter) {
  return parameter.default ?? parameter.example ?? (usual(parameter)[0] + usual(parameter)[1]) / 2;
}

// The values that a study gives: what is as the service has it by itself is left out, since giving it
// may ask for more, as the speed of a part on a track asks for its radius.
export function givenValues(view) {
  const isOwn = ([name, value]) => view.own?.[name] === value;
  return Object.fromEntries(Object.entries(view.values).filter((one) => !isOwn(one)));
}

// The names that a view gives values, and those that these stand for.
export function givenNames(view, scene) {
  const names = new Set(Object.keys(view.values));
  for (const { name, instead_of: instead } of scene.parameters) {
    if (names.has(name)) for (const one of instead ?? []) names.add(one);
  }
  return names;
}

// Names that replace each other, such as one friction and two: those that are shown.
export function shownParameters(scene, output, given = {}) {
  const asked = scene.outputs.find((one) => one.name === output) ?? scene.outputs[0];
  const needed = new Set(asked?.asks ?? []);
  const required = new Set(asked?.required ?? []);
  const replaced = new Map(); // name -> what stands for it
  for (const parameter of scene.parameters) {
    for (const name of parameter.instead_of ?? []) {
      if (!replaced.has(name)) replaced.set(name, parameter.name);
    }
  }
  const chosen = new Set();
  for (const parameter of scene.parameters) {
    if (!needed.has(parameter.name)) continue;
    const stand = replaced.get(parameter.name);
    const together = stand && countOf(scene, stand, needed) > 1;
    chosen.add(together ? stand : parameter.name);
  }
  // What has no value by itself and need not be given is left out until somebody gives it.
  const isSet = ({ name, default: value, instead_of: names }) =>
    value !== null ||
    required.has(name) ||
    name in given ||
    (names ?? []).some((one) => required.has(one));
  return scene.parameters.filter((parameter) => chosen.has(parameter.name) && isSet(parameter));
}

// What comes with a parameter that is added, and goes with it.
export const COMPANIONS = { hold_down_force: ["mass"] };

// Parameters that may be given, too.
export function furtherParameters(scene, output, given) {
  const needOthers = new Set(Object.values(COMPANIONS).flat());
  const shown = new Set(shownParameters(scene, output, given).map(({ name }) => name));
  const asked = scene.outputs.find((one) => one.name === output);
  const replaced = new Set(
    scene.parameters.filter(({ name }) => shown.has(name)).flatMap((one) => one.instead_of ?? []),
  );
  return scene.parameters.filter(
    ({ name }) => asked?.asks.includes(name) && !shown.has(name) && !replaced.has(name) && !needOthers.has(name),
  );
}

function countOf(scene, stand, needed) {
  const found = scene.parameters.find((parameter) => parameter.name === stand);
  return (found?.instead_of ?? []).filter((name) => needed.has(name)).length;
}
