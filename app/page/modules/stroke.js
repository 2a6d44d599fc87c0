// The amplitude of a sine, or its stroke from peak to peak: which of them a view is stated in.

/** @typedef {import("./view.js").View} View */

export const STROKE = "stroke"; // the set of `sets.js`
/** @type {Record<string, [string, number]>} */
const TWO = { amplitude: ["peak_to_peak", 2], peak_to_peak: ["amplitude", 0.5] };

// Whether a scene takes the one in place of the other.
export function takesBoth({ parameters }) {
  return Object.keys(TWO).every((name) => parameters.some((one) => one.name === name));
}

// Whether a view may be stated either way: it has one of both, and its scene takes both.
export function hasChoice(view, scene) {
  const isFree = view.set === STROKE || (!view.set && takesBoth(scene));
  const has = (name) => name in view.values || [view.x, view.y].some((axis) => axis?.name === name);
  return isFree && Object.keys(TWO).some(has);
}

// What changes of a view that is to be stated the other way: the same designs, by another name.
/** @param {View} view @param {string | null} set */
export function restated(view, set) {
  const from = set === STROKE ? "amplitude" : "peak_to_peak";
  const [to, factor] = TWO[from];
  const named = (values) =>
    Object.fromEntries(Object.entries(values).map(([name, value]) => (name === from ? [to, factor * value] : [name, value])));
  const ranged = (axis) => (axis?.name === from ? { ...axis, name: to, from: factor * axis.from, to: factor * axis.to } : axis);
  const across = view.x.name === from ? factor : 1;
  const { band, pins, runs, best, begun } = view;
  return {
    set,
    values: named(view.values),
    x: ranged(view.x),
    y: ranged(view.y),
    ...(begun ? { begun: named(begun) } : {}),
    ...(band ? { band: { ...band, name: band.name === from ? to : band.name } } : {}),
    ...(pins ? { pins: pins.map(named) } : {}),
    ...(runs ? { runs: runs.map(([value, speed]) => [across * value, speed]) } : {}),
    ...(best ? { best: { ...best, vary: best.vary.map(ranged), given: named(best.given) } } : {}),
  };
}
