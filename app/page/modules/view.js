// What is shown: a plain object, and what of it is usual.

import { withUnit } from "./words.js";

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

const ROOM = 0.2; // of a value, beyond it on its axis

// The same view, its axes as wide as its values ask for.
export function widened(view, { parameters }) {
  const wide = (axis) => {
    const value = view.values[axis?.name];
    if (!(value < axis?.from || value > axis?.to)) return axis;
    const { lower, upper } = parameters.find(({ name }) => name === axis.name);
    const room = ROOM * Math.abs(value);
    return { ...axis, from: Math.max(lower ?? -Infinity, Math.min(axis.from, value - room)), to: Math.min(upper ?? Infinity, Math.max(axis.to, value + room)) };
  };
  return { ...view, x: wide(view.x), y: wide(view.y) };
}

const MANY = 3; // times less or more than its question begins with is usual, too

// A sentence about a value outside of what is usual, else "". What a parameter is by itself is no cause for a warning.
export function unusual(parameter, value, begun = undefined) {
  if (value === parameter.default) return "";
  const ends = begun === undefined ? [] : [begun / MANY, MANY * begun];
  const [low, high] = [Math.min(...usual(parameter), ...ends), Math.max(...usual(parameter), ...ends)];
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
  const isSet = ({ name, default: value, instead_of: names }) => value !== null || name in given || [name, ...(names ?? [])].some((one) => required.has(one));
  return scene.parameters.filter((parameter) => chosen.has(parameter.name) && isSet(parameter));
}

// What comes with a parameter that is added, and goes with it.
export const COMPANIONS = { hold_down_force: ["mass"] };

// Parameters that may be given, too.
export function furtherParameters(scene, output, given) {
  const needOthers = new Set(Object.values(COMPANIONS).flat());
  const shown = new Set(shownParameters(scene, output, given).map(({ name }) => name));
  const asked = scene.outputs.find((one) => one.name === output);
  const replaced = new Set(scene.parameters.filter(({ name }) => shown.has(name)).flatMap((one) => one.instead_of ?? []));
  return scene.parameters.filter(({ name }) => asked?.asks.includes(name) && !shown.has(name) && !replaced.has(name) && !needOthers.has(name));
}

function countOf(scene, stand, needed) {
  const found = scene.parameters.find((parameter) => parameter.name === stand);
  return (found?.instead_of ?? []).filter((name) => needed.has(name)).length;
}
