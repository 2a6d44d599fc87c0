// A view made whole: what it lacks is set to what is usual, what makes no sense is told of.

import { SETS, isSet } from "./sets.js";
import { shownParameters, typical, usual } from "./view.js";
import { capital, words } from "./words.js";

const FIRST_OUTPUTS = ["conveying_velocity", "drift_velocity", "acceleration_x", "track_amplitude"];
const FIRST_AXES = ["amplitude", "beta"];

// What is said of a part of a view by a name that may be anybody's.
export function misfit(name) {
  return `${capital(words(name).slice(0, 60))} does not fit this system: it is left out.`;
}

// A view of a scene made whole, and {of, text} about each part of it that made no sense.
/** @param {any} wanted @param {any} scene @returns {{view: any, complaints: {of: string, text: string}[]}} */
export function complete(wanted, scene) {
  const view = { ...wanted, values: { ...wanted.values } };
  const complaints = [];
  const leave = (of, name) => complaints.push({ of, text: misfit(name) });
  chooseOutput(view, scene, leave);
  const given = { ...view.values };
  for (const axis of [view.x, view.y]) if (axis) given[axis.name] = axis.from;
  const parameters = shownParameters(scene, view.output, given);
  // A link may name anything, also what every object of JavaScript has.
  const byName = Object.assign(Object.create(null), ...parameters.map((one) => ({ [one.name]: one })));
  chooseAxes(view, byName, leave);
  const foreign = Object.keys(view.values).filter((name) => !byName[name]);
  for (const name of foreign) {
    delete view.values[name];
    leave(name, name);
  }
  for (const { name } of parameters) view.values[name] ??= begunWith(view, byName[name]);
  view.begun = Object.fromEntries(Object.entries(view.begun ?? {}).filter(([name]) => byName[name]));
  view.own = Object.fromEntries(parameters.map((one) => [one.name, one.default]));
  if (view.pins) {
    const isOfScene = (pin) => Object.keys(pin).every((name) => scene.parameters.some((one) => one.name === name));
    const pins = view.pins.filter(isOfScene);
    if (pins.length < view.pins.length) leave("pins", "a kept design");
    view.pins = pins;
  }
  if (view.band && !Object.hasOwn(view.values, view.band.name)) {
    leave("band", view.band.name);
    view.band = null;
  }
  return { view, complaints };
}

// What is typical, for an axis within its ends.
function begunWith({ x, y }, parameter) {
  const value = typical(parameter);
  const axis = [x, y].find((one) => one?.name === parameter.name);
  return axis && (value <= axis.from || value >= axis.to) ? (axis.from + axis.to) / 2 : value;
}

function chooseOutput(view, scene, leave) {
  const known = pictured(scene).map(({ name }) => name);
  if (known.includes(view.output)) return;
  if (view.output) leave("output", view.output);
  view.output = FIRST_OUTPUTS.find((name) => known.includes(name)) ?? known[0];
}

// The outputs that depend on a parameter at least.
export function pictured(scene) {
  return scene.outputs.filter(({ asks }) => asks.length);
}

function chooseAxes(view, byName, leave) {
  if (Object.keys(byName).length === 1 && view.y) Object.assign(view, { x: view.y, y: null });
  const names = [...FIRST_AXES, ...Object.keys(byName)];
  const ofSet = isSet(view.set) ? SETS[view.set] : {}; // those that show most of a drive or a row
  for (const place of ["x", "y"]) {
    const axis = view[place];
    if (axis && (!byName[axis.name] || (place === "y" && axis.name === view.x?.name))) {
      leave(place, axis.name);
      view[place] = undefined;
    }
    if (view[place] || (place === "y" && view.y === null)) continue;
    const other = place === "x" ? view.y?.name : view.x?.name;
    const name = [ofSet[place], ...names].find((one) => byName[one] && one !== other);
    const [from, to] = name ? usual(byName[name]) : [];
    view[place] = name ? { name, from, to } : null;
  }
}
