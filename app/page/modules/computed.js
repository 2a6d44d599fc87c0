// From a view to numbers: slices of a sweep, the motion of a grid of parts, or one design.

import { carryOut, put, slice } from "./service.js";
import { surfaceStudy } from "./surface.js";
import { givenNames, givenValues } from "./view.js";
import { duration } from "./words.js";

/** @typedef {import("./view.js").View} View */
/** @typedef {{held?: any, signal?: AbortSignal, tell?: (job: any) => void, show?: (found: any) => void, isAgreed?: boolean}} How */

const FINE = { sweep: 200, simulate: 100 }; // values of an axis
const COARSE = 30; // of motion, while something is dragged and first of all
const ROUGH = 10; // of methods that take long
const FIELD = 15; // of arrows over a plate, along which velocities change little by little
const PATIENCE = 3; // s for a fine map; what takes longer is drawn with fewer values
const CONSENT = 60; // s of computing that are not begun without being asked for
const LINE = 201;
const BAND = [-1, -0.5, 0, 0.5, 1]; // places within what is not known exactly
const DRAGGED = 101; // places of a slider
const MAX_KEPT = 32; // slices, of 0.4 MB
const MAX_SWEPT = 64; // outputs of one design
// The outputs whose least and largest value over a range the service finds, wherever they lie.
const RANGED = ["conveying_velocity", "feed_rate", "velocity_x", "velocity_y", "travel_speed", "velocity_towards"];
// What is asked for of one design, where the scene has it.
const AT_A_POINT = [
  "conveying_velocity", "drift_velocity", "throw_number", "hop_height", "flight_fraction", "platoons",
  "platoon_size_1", "platoon_velocity_1", "natural_frequency", "oriented_feed_rate_lower", "oriented_feed_rate_upper",
  "line_feed_rate", "return_rate", "purity", "travel_direction",
];
const SHARES = /_share_/;

function span(axis, num) {
  return { start: axis.from, stop: axis.to, num };
}

// The recording of a drive, as a study has it.
export function recordedDrive({ set, recording }) {
  return set === "recorded" && recording ? { drive: recording.drive } : {};
}

// A study of the outputs of a view with some parameters.
export function studyWith(view, outputs, parameters) {
  const choice = view.kind === "sweep" ? "variant" : "method";
  return {
    kind: view.kind,
    scene: view.scene,
    ...(view.choice ? { [choice]: view.choice } : {}),
    outputs,
    ...recordedDrive(view),
    parameters,
  };
}

// The components of the velocity over the places of a plate, which arrows are drawn of.
const COMPONENTS = ["velocity_x", "velocity_y"];
function fieldOf({ kind, x, y }) {
  return kind === "simulate" && x.name === "position_x" && y?.name === "position_y" ? COMPONENTS : [];
}

function mapStudy(view, num = FINE[view.kind]) {
  const parameters = givenValues(view);
  parameters[view.x.name] = span(view.x, view.y ? num : LINE);
  if (view.y) parameters[view.y.name] = span(view.y, num);
  return studyWith(view, [...new Set([view.output, ...fieldOf(view)])], parameters);
}

// The outputs of one design: that of the view, what its answer tells, and of a list all that can be computed.
function outputsOf(view, scene, isList) {
  const known = givenNames(view, scene);
  const isKnown = ({ required }) => required.every((name) => known.has(name));
  const isTold = ({ name }) => AT_A_POINT.includes(name) || (SHARES.test(name) && view.scene === "resting-part");
  const found = scene.outputs.filter((one) => isKnown(one) && (isList || isTold(one))).map(({ name }) => name);
  return [...new Set([view.output, ...found])].slice(0, MAX_SWEPT);
}

function designStudy(view, scene, { isList = false, values = null, hasPath = false } = {}) {
  const parameters = values ?? givenValues(view);
  return { ...studyWith(view, outputsOf(view, scene, isList), parameters), ...(hasPath && scene.trajectory ? { trajectory: 400 } : {}) };
}

// One design: {dataset, seconds}; with the path of its part where the system has one.
/** @param {View} view @param {any} scene @param {How} how */
export async function design(view, scene, { signal, tell } = {}, more = {}) {
  const study = view.surface && !more.values ? surfaceStudy(view) : designStudy(view, scene, more);
  return carryOut(study.kind, study, { signal, tell });
}

// The same speed with a sine of the amplitudes of an ellipse; null of other drives.
/** @param {View} view @param {any} scene @param {How} how */
export async function sineOf(view, scene, { signal } = {}) {
  const { amplitude_along_1: along, amplitude_normal_1: normal, phase_normal_1: _, ...others } = givenValues(view);
  const parameters = { ...others, amplitude: Math.hypot(along, normal), beta: (Math.atan2(normal, along) * 180) / Math.PI };
  return valueOf((await carryOut(view.kind, studyWith(view, [view.output], parameters), { signal })).dataset, view.output);
}

export function valueOf(dataset, name) {
  return dataset?.variables[name]?.data ?? null;
}

export function flagOf(dataset) {
  const { data, flags = {} } = dataset?.variables.regime ?? {};
  return Object.keys(flags).find((one) => flags[one] === data) ?? "";
}

// What is not known exactly, as a study gives it: a range, of which the service finds the extremes of speeds, else some
// values of it.
/** @param {any} view @param {any} scene */
function rangeOf({ band: { name, share }, values, output, choice }, scene) {
  const list = BAND.map((step) => values[name] * (1 + step * share)).sort((a, b) => a - b);
  const [low, high] = [list[0], list.at(-1)];
  const isRange = RANGED.includes(output) && (!choice || choice === scene.methods[0]);
  return { name, low, high, isRange, given: isRange ? { low, high } : list };
}

// The least and the largest value of the output of a design within its band, or null.
/** @param {View} view @param {any} scene @param {How} how */
export async function bandAt(view, scene, { signal } = {}) {
  const { name, low, high, isRange, given } = rangeOf(view, scene);
  const { dataset } = await carryOut(view.kind, studyWith(view, [view.output], { ...givenValues(view), [name]: given }), { signal });
  const found = isRange ? ["least", "most"].map((end) => valueOf(dataset, `${view.output}_${end}`)) : (valueOf(dataset, view.output) ?? []);
  const known = found.filter((one) => Number.isFinite(one));
  return known.length ? { name, low: Math.min(...known), high: Math.max(...known), from: low, to: high } : null;
}

// The same along a line: {low, high} of lists; null over the band's own parameter.
/** @param {View} view @param {any} scene @param {How} how */
export async function bandOver(view, scene, { signal } = {}) {
  const { name, isRange, given } = rangeOf(view, scene);
  if (view.x.name === name) return null;
  const study = mapStudy(view);
  study.parameters[name] = given;
  const { dataset } = await carryOut(view.kind, study, { signal });
  if (isRange) return { low: valueOf(dataset, `${view.output}_least`), high: valueOf(dataset, `${view.output}_most`) };
  const { dims, data } = dataset.variables[view.output];
  const lists = dims[0] === name ? data[0].map((_, i) => data.map((row) => row[i])) : data;
  const known = lists.map((list) => list.filter(Number.isFinite));
  return { low: known.map((list) => Math.min(...list)), high: known.map((list) => Math.max(...list)) };
}

// One output over its axes, however the service laid it out: {x, y, z, regime, field}.
function fromDataset(dataset, view) {
  const axis = (name) => {
    const { data, units } = dataset.coordinates[name];
    return { name, unit: units, values: data };
  };
  const reader = ({ dims, data }) => (i, j) => {
    let found = data;
    for (const dim of dims) found = found[dim === view.x.name ? i : j];
    return found;
  };
  const variable = dataset.variables[view.output];
  const regime = dataset.variables[variable.ancillary_variables ?? "regime"];
  const [vx, vy] = fieldOf(view).map((name) => reader(dataset.variables[name]));
  return {
    field: vx && { x: vx, y: vy },
    x: axis(view.x.name),
    y: view.y ? axis(view.y.name) : null,
    z: { name: view.output, unit: variable.units, at: reader(variable), isJudged: "ancillary_variables" in variable },
    regime: regime && { at: reader(regime), names: Object.fromEntries(Object.entries(regime.flags).map(([n, value]) => [value, n])) },
  };
}

function fromSlice(found, view) {
  const axes = Object.fromEntries(found.axes.map((axis) => [axis.name, axis]));
  // How far apart neighbours along each axis lie among the values; 0 where they do not depend on it.
  const reader = (values, dims) => {
    const step = { [view.x.name]: 0, ...(view.y ? { [view.y.name]: 0 } : {}) };
    let apart = 1;
    for (const dim of [...dims].reverse()) {
      step[dim] = apart;
      apart *= axes[dim].values.length;
    }
    const across = step[view.x.name];
    const up = view.y ? step[view.y.name] : 0;
    return (i, j = 0) => values[i * across + j * up];
  };
  const axis = (name) => ({ name, unit: axes[name].unit, values: axes[name].values });
  const regimes = Object.entries(found.header.regimes ?? {});
  return {
    x: axis(view.x.name),
    y: view.y ? axis(view.y.name) : null,
    z: { name: view.output, unit: found.header.unit, at: reader(found.values, found.dims), isJudged: found.header.judged },
    regime: found.regime && {
      at: reader(found.regime, found.regimeDims),
      names: Object.fromEntries(regimes.map(([name, one]) => [one.value, name])),
    },
  };
}

// Maps and lines. While a slider is held the service has a sweep along it, too, and every place of the slider
// is a slice of one and the same.
export class Source {
  constructor() {
    this.sweeps = new Map(); // study as text -> promise of its identifier
    this.slices = new Map(); // study and place as text -> promise of the slice
    this.fineness = FINE.simulate; // values of an axis of the map of motion that is shown
    this.next = FINE.simulate; // of the next one
  }

  // The study of what is shown, as fine as it is shown.
  study(view) {
    return mapStudy(view, view.kind === "sweep" ? FINE.sweep : this.fineness);
  }

  /** @param {View} view @param {any} scene @param {How} how */
  async map(view, scene, { held, signal, tell, show, isAgreed = false } = {}) {
    if (view.kind === "sweep") return this.sliced(view, held?.name ? held : null, signal);
    const isSlow = scene.methods.length > 1 && view.choice !== "" && view.choice !== scene.methods[0];
    if (isSlow) return this.slow(view, { signal, tell, show, isAgreed, isHeld: Boolean(held) });
    if (fieldOf(view).length) return this.moved(view, FIELD, { signal, tell });
    if (held) return fromDataset((await carryOut("simulate", mapStudy(view, COARSE), { signal, tell })).dataset, view);
    if (!this.isWarm && view.y) {
      show?.(await this.moved(view, COARSE, { signal, tell }));
      this.isWarm = true;
    }
    for (;;) {
      const found = await this.moved(view, this.next, { signal, tell });
      if (!view.y || this.next <= 1.5 * this.fineness) return found; // the first may have waited for code to load
      show?.(found);
    }
  }

  // A method that may take long: few values first, more when somebody says so.
  async slow(view, { signal, tell, show, isAgreed, isHeld }) {
    const cells = FINE.simulate ** 2;
    const { seconds } = await carryOut("simulate", studyWith(view, [view.output], givenValues(view)), { signal });
    const per = Math.max(seconds ?? 0, 1e-4);
    const needed = per * (view.y ? cells : LINE);
    if (isHeld || (needed > CONSENT && !isAgreed)) {
      const rough = per * ROUGH ** 2;
      const found = view.y && rough < CONSENT ? await this.moved(view, ROUGH, { signal, tell }) : null;
      return { found, asking: `${found ? `Only ${ROUGH} × ${ROUGH} values. ` : ""}The method is slow: the whole picture takes about ${duration(needed)}.` };
    }
    if (view.y) show?.(await this.moved(view, ROUGH, { signal, tell }));
    return this.moved(view, FINE.simulate, { signal, tell });
  }

  async moved(view, num, how) {
    const { dataset, seconds } = await carryOut("simulate", mapStudy(view, num), how);
    if (view.y) {
      const next = seconds ? Math.round(num * Math.sqrt(PATIENCE / seconds)) : num;
      this.next = Math.max(COARSE, Math.min(FINE.simulate, next));
      this.fineness = num;
    }
    return fromDataset(dataset, view);
  }

  // A line over one parameter, the others as they are in the view.
  /** @param {View} view @param {import("./view.js").Axis} x @param {How} how */
  async line(view, x, { signal } = {}) {
    const one = { ...view, x, y: null };
    return fromDataset((await carryOut(view.kind, mapStudy(one), { signal })).dataset, one);
  }

  async sliced(view, held, signal) {
    const study = mapStudy(view);
    const axes = view.y ? [view.x.name, view.y.name] : [view.x.name];
    if (!held) return fromSlice(await slice(await this.posted(study, signal), view.output, axes, {}, signal), view);
    if (axes.includes(held.name)) return fromSlice(await this.kept(study, view, axes, {}), view);
    study.parameters[held.name] = { start: held.from, stop: held.to, num: DRAGGED };
    return fromSlice(await this.kept(study, view, axes, { [held.name]: view.values[held.name] }), view);
  }

  // Slices of places where the slider has been, or that are under way.
  kept(study, view, axes, fixed) {
    const text = JSON.stringify([study, fixed]);
    let found = this.slices.get(text);
    this.slices.delete(text);
    if (!found) {
      found = this.posted(study).then((id) => slice(id, view.output, axes, fixed));
      found.catch(() => this.slices.delete(text));
    }
    this.slices.set(text, found); // the last one used is the last one dropped
    if (this.slices.size > MAX_KEPT) this.slices.delete(this.slices.keys().next().value);
    return found;
  }

  // The identifier of a sweep that the service has been told of.
  posted(study, signal) {
    const text = JSON.stringify(study);
    if (!this.sweeps.has(text)) {
      const id = put("/sweeps", study, { signal }).then(({ content }) => content.id);
      this.sweeps.set(text, id);
      id.catch(() => this.sweeps.delete(text));
    }
    return this.sweeps.get(text);
  }
}

// The places of a slider, which are values of the axis that the service has along it.
export function places(low, high) {
  return { from: low, to: high, num: DRAGGED, at: (k) => low + (k / (DRAGGED - 1)) * (high - low) };
}
