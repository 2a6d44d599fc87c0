// From a view to numbers: slices of a sweep, or the motion of a grid of parts.

import { carryOut, put, slice } from "./service.js";
import { givenValues } from "./view.js";

/** @typedef {import("./view.js").View} View */
/** @typedef {import("./view.js").Point} Point */

const FINE = { sweep: 200, simulate: 100 }; // values of an axis
const COARSE = 30; // of motion, while something is dragged and first of all
const BETWEEN = 3; // parts between neighbours, at which regimes are asked for along borders
const PATIENCE = 3; // s for a fine map; what takes longer is drawn with fewer values
const LINE = 201;
const BAND = [-1, -0.5, 0, 0.5, 1]; // places within what is not known exactly
const DRAGGED = 101; // places of a slider
const MAX_KEPT = 32; // slices, of 0.4 MB
const MAX_UNDER_WAY = 2;
// What is asked for beside the course of a part, where the scene has it.
const AT_A_POINT = ["conveying_velocity", "throw_number", "hop_height", "platoons"];

function span(axis, num) {
  return { start: axis.from, stop: axis.to, num };
}

function parametersOf(view, num) {
  const parameters = givenValues(view);
  parameters[view.x.name] = span(view.x, view.y ? num : LINE);
  if (view.y) parameters[view.y.name] = span(view.y, num);
  return parameters;
}

function studyOf(view, num = FINE[view.kind]) {
  const choice = view.kind === "sweep" ? "variant" : "method";
  return {
    kind: view.kind,
    scene: view.scene,
    ...(view.choice ? { [choice]: view.choice } : {}),
    outputs: [view.output],
    ...recordedDrive(view),
    parameters: parametersOf(view, num),
  };
}

// The recording of a drive, as a study has it.
export function recordedDrive({ set, recording }) {
  return set === "recorded" && recording ? { drive: recording.drive } : {};
}

// One output over its axes, however the service laid it out: {x, y, z, regime}.
function fromDataset(dataset, view) {
  const axis = (name) => {
    const { data, units } = dataset.coordinates[name];
    return { name, unit: units, values: data };
  };
  const reader = (variable) => {
    const { dims, data } = variable;
    return (i, j) => {
      let found = data;
      for (const dim of dims) found = found[dim === view.x.name ? i : j];
      return found;
    };
  };
  const variable = dataset.variables[view.output];
  const regime = dataset.variables[variable.ancillary_variables ?? "regime"];
  return {
    x: axis(view.x.name),
    y: view.y ? axis(view.y.name) : null,
    z: { name: view.output, unit: variable.units, at: reader(variable), isJudged: "ancillary_variables" in variable },
    regime: regime
      ? {
          at: reader(regime),
          names: Object.fromEntries(Object.entries(regime.flags).map(([n, value]) => [value, n])),
        }
      : null,
    attributes: dataset.attributes,
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
    regime: found.regime
      ? {
          at: reader(found.regime, found.regimeDims),
          names: Object.fromEntries(regimes.map(([name, one]) => [one.value, name])),
        }
      : null,
  };
}

// The motion of a grid of parts with so many values of an axis; of a line there are as many as it has.
async function motion(view, num, how) {
  return (await carryOut("simulate", studyOf(view, num), how)).dataset;
}

// What a view shows. `dragged` is the name of a parameter whose slider is being moved: the service
// then has a sweep along it, too, and every place of the slider is a slice of one and the same.
export class Source {
  constructor() {
    this.sweeps = new Map(); // study as text -> promise of its identifier
    this.slices = new Map(); // study and place as text -> promise of the slice
    this.underWay = 0;
    this.fineness = FINE.simulate; // values of an axis of the map of motion that is shown
    this.next = FINE.simulate; // of the next one
  }

  // The study of what is shown, as fine as it is shown.
  study(view) {
    return studyOf(view, view.kind === "sweep" ? FINE.sweep : this.fineness);
  }

  /** @param {View} view @param {{dragged?: any, signal?: AbortSignal, tell?: (job: any) => void}} how */
  async compute(view, { dragged = null, signal, tell } = {}) {
    if (view.kind === "sweep") return this.sliced(view, dragged, signal);
    if (dragged) return fromDataset(await motion(view, COARSE, { signal, tell }), view);
    return this.moved(view, this.next, { signal, tell });
  }

  // A coarse picture to begin with, where a fine one may take long.
  /** @param {View} view @param {{dragged?: any, signal?: AbortSignal, tell?: (job: any) => void}} how */
  coarse(view, { signal, tell } = {}) {
    return this.moved(view, COARSE, { signal, tell });
  }

  async moved(view, num, how) {
    const { dataset, seconds } = await carryOut("simulate", studyOf(view, num), how);
    if (view.y) {
      const next = seconds ? Math.round(num * Math.sqrt(PATIENCE / seconds)) : num;
      this.next = Math.max(COARSE, Math.min(FINE.simulate, next));
      this.fineness = num;
    }
    return fromDataset(dataset, view);
  }

  // Regimes between the cells of a map of closed forms, along each axis: where borders lie. Null where there
  // are none, and of motion: its cells may take so long that the service makes a job of them.
  /** @param {View} view @param {any} found @param {{signal?: AbortSignal}} how */
  async between(view, found, { signal } = {}) {
    if (view.kind !== "sweep" || !found.regime || !found.y) return null;
    const counts = [found.x, found.y].map(({ values }) => values.length);
    const axes = [view.x.name, view.y.name];
    const asked = async (finer) => {
      const study = studyOf(view);
      [view.x, view.y].forEach((axis, k) => {
        study.parameters[axis.name] = span(axis, k === finer ? (counts[k] - 1) * BETWEEN + 1 : counts[k]);
      });
      const id = await this.posted(study, signal);
      return fromSlice(await slice(id, view.output, axes, {}, signal), view).regime.at;
    };
    return { times: BETWEEN, across: await asked(0), up: await asked(1) };
  }

  // Whether a finer map would be worth while: the first one may have waited for code to be loaded.
  isWorthMore(view) {
    return view.kind === "simulate" && Boolean(view.y) && this.next > 1.5 * this.fineness;
  }

  // The same at both ends, and between, of what is not known exactly: least and largest of each.
  /** @param {View} view @param {{dragged?: any, signal?: AbortSignal, tell?: (job: any) => void}} how */
  async band(view, { signal } = {}) {
    const { name, share } = view.band;
    const found = [];
    for (const step of BAND) {
      const values = { ...view.values, [name]: view.values[name] * (1 + step * share) };
      const one = { ...view, values, band: null };
      found.push(
        view.kind === "sweep"
          ? await this.sliced(one, null, signal)
          : fromDataset(await motion(one, COARSE, { signal }), one),
      );
    }
    const ends = (pick) => (i, j) => {
      const values = found.map(({ z }) => z.at(i, j)).filter(Number.isFinite);
      return values.length ? pick(...values) : NaN;
    };
    return { x: found[0].x, y: found[0].y, low: ends(Math.min), high: ends(Math.max) };
  }

  async sliced(view, dragged, signal) {
    const study = studyOf(view);
    const axes = view.y ? [view.x.name, view.y.name] : [view.x.name];
    if (dragged) {
      study.parameters[dragged.name] = { start: dragged.from, stop: dragged.to, num: DRAGGED };
      return fromSlice(await this.kept(study, view, axes, dragged), view);
    }
    return fromSlice(await slice(await this.posted(study, signal), view.output, axes, {}, signal), view);
  }

  // Ask for a place of a slider while another is being drawn: `compute` then finds it under way.
  ahead(view, dragged) {
    if (view.kind === "sweep" && this.underWay < MAX_UNDER_WAY) {
      this.sliced(view, dragged).catch(() => {}); // `compute` asks again, and tells
    }
  }

  // Slices of places where the slider has been, or that are under way.
  kept(study, view, axes, { name }) {
    const fixed = { [name]: view.values[name] };
    const text = JSON.stringify([study, fixed]);
    let found = this.slices.get(text);
    this.slices.delete(text);
    if (!found) {
      this.underWay += 1;
      found = this.posted(study)
        .then((id) => slice(id, view.output, axes, fixed))
        .finally(() => {
          this.underWay -= 1;
        });
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

// The values of the one design at a point of the view.
export function valuesAt(view, point) {
  const values = { ...givenValues(view), [view.x.name]: point.x };
  if (view.y && point.y !== null && point.y !== undefined) values[view.y.name] = point.y;
  return values;
}

// The motion of a design, as a study; `values` may have lists.
function motionStudy(view, scene, values) {
  const own = view.kind === "simulate" ? [view.output] : [];
  const outputs = [...new Set([...own, ...AT_A_POINT])].filter((name) => scene.outputs.some((one) => one.name === name));
  return {
    kind: "simulate",
    scene: view.scene,
    ...(view.kind === "simulate" && view.choice ? { method: view.choice } : {}),
    ...(outputs.length ? { outputs } : {}),
    ...recordedDrive(view),
    parameters: values,
  };
}

// The course of the one part at a point of the view.
/** @param {View} view @param {object} scene @param {Point} point @param {{signal?: AbortSignal, tell?: (job: any) => void}} how */
export async function courseAt(view, scene, point, { signal, tell } = {}) {
  const study = { ...motionStudy(view, scene, valuesAt(view, point)), ...(scene.trajectory ? { trajectory: 400 } : {}) };
  return (await carryOut("simulate", study, { signal, tell })).dataset;
}

// What a part does with these values: {name: value} of some outputs, and its regime.
export async function designAt(view, scene, values) {
  const own = Object.entries(values).filter(([name, value]) => view.own?.[name] !== value);
  const { variables } = (await carryOut("simulate", motionStudy(view, scene, Object.fromEntries(own)))).dataset;
  const { data, flags = {} } = variables.regime ?? {};
  const found = Object.fromEntries(Object.entries(variables).map(([name, one]) => [name, one.data]));
  return { ...found, regime: Object.keys(flags).find((name) => flags[name] === data) ?? "" };
}

// The least and the largest speed at the point of the view within its band, or null.
export async function speedBand(view, scene) {
  const { band, point } = view;
  const values = valuesAt(view, point);
  const list = BAND.map((step) => values[band.name] * (1 + step * band.share));
  const study = motionStudy(view, scene, { ...values, [band.name]: list });
  const found = (await carryOut("simulate", study)).dataset.variables.conveying_velocity;
  const speeds = (found?.data ?? []).filter((one) => Number.isFinite(one));
  return speeds.length ? { least: Math.min(...speeds), largest: Math.max(...speeds) } : null;
}
