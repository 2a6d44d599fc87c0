// A view made whole: what it lacks is set to what is usual, what makes no sense is told of.

import { SETS, isSet } from "./sets.js";
import { shownParameters, typical, usual } from "./view.js";
import { capital, words } from "./words.js";

const FIRST_OUTPUTS = ["conveying_velocity", "drift_velocity", "acceleration_x", "track_amplitude"];
const FIRST_AXES = ["amplitude", "beta"];

// A name that may be anybody's, as it is told.
const told = (name) => words(name).slice(0, 60);

// A view of a scene made whole, and {of, text} about each part of it that made no sense.
/** @param {any} wanted @param {any} scene @returns {{view: any, complaints: {of: string, text: string}[]}} */
export function complete(wanted, scene) {
  const view = { ...wanted, values: { ...wanted.values } };
  const complaints = [...chooseOutput(view, scene)];
  const given = { ...view.values };
  for (const axis of [view.x, view.y]) if (axis) given[axis.name] = axis.from;
  const parameters = shownParameters(scene, view.output, given);
  // A link may name anything, also what every object of JavaScript has.
  const byName = Object.assign(Object.create(null), ...parameters.map((one) => ({ [one.name]: one })));
  complaints.push(...chooseAxes(view, byName));
  const foreign = Object.keys(view.values).filter((name) => !byName[name]);
  const leave = (of, text) => complaints.push({ of, text });
  const notThere = (name) => `${capital(told(name))} is not a parameter of this system.`;
  for (const name of foreign) {
    delete view.values[name];
    leave(name, notThere(name));
  }
  for (const { name } of parameters) view.values[name] ??= begunWith(view, byName[name]);
  view.begun = Object.fromEntries(Object.entries(view.begun ?? {}).filter(([name]) => byName[name]));
  view.own = Object.fromEntries(parameters.map((one) => [one.name, one.default]));
  if (view.pins) {
    const isOfScene = (pin) => Object.keys(pin).every((name) => scene.parameters.some((one) => one.name === name));
    const pins = view.pins.filter(isOfScene);
    if (pins.length < view.pins.length) leave("pins", "A kept design is not of this system: the design is left out.");
    view.pins = pins;
  }
  if (view.band && !Object.hasOwn(view.values, view.band.name)) {
    leave("band", notThere(view.band.name));
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

function chooseOutput(view, scene) {
  const known = pictured(scene).map(({ name }) => name);
  if (known.includes(view.output)) return [];
  const asked = view.output;
  view.output = FIRST_OUTPUTS.find((name) => known.includes(name)) ?? known[0];
  if (!asked) return [];
  const isConstant = scene.outputs.some(({ name }) => name === asked);
  const text = isConstant
    ? `${capital(words(asked))} depends on no parameter, so it cannot be drawn: choose another output.`
    : `This system has no output ${told(asked)}.`;
  return [{ of: "output", text }];
}

// The outputs that depend on a parameter at least.
export function pictured(scene) {
  return scene.outputs.filter(({ asks }) => asks.length);
}

function chooseAxes(view, byName) {
  const complaints = [];
  if (Object.keys(byName).length === 1 && view.y) Object.assign(view, { x: view.y, y: null });
  const names = [...FIRST_AXES, ...Object.keys(byName)];
  const ofSet = isSet(view.set) ? SETS[view.set] : {}; // those that show most of a drive or a row
  for (const place of ["x", "y"]) {
    const axis = view[place];
    if (axis && !byName[axis.name]) {
      complaints.push({ of: place, text: `${capital(told(axis.name))} is not a parameter of this system, so it cannot be an axis.` });
      view[place] = undefined;
    } else if (axis && place === "y" && axis.name === view.x.name) {
      complaints.push({ of: place, text: `${capital(told(axis.name))} cannot be both the horizontal and the vertical axis.` });
      view.y = undefined;
    }
    if (view[place] === undefined || (place === "x" && !view.x)) {
      const other = place === "x" ? view.y?.name : view.x?.name;
      const name = [ofSet[place], ...names].find((one) => byName[one] && one !== other);
      if (!name) {
        view[place] = null;
        continue;
      }
      const [from, to] = usual(byName[name]);
      view[place] = { name, from, to };
    }
  }
  return complaints;
}
