// What happens next to the best: one step of the picture in each direction, and the ends of what is not
// known exactly. The service computes it, as it computes the picture.

import { NEEDS_OTHER } from "./criterion.js";
import { carryOut } from "./service.js";
import { givenValues } from "./view.js";

const BAND = [-1, -0.5, 0, 0.5, 1]; // places within what is not known exactly

// Values one step below, at and above; where the range ends there is none.
function steps(at, step, axis) {
  const slack = 1e-9 * Math.abs(axis.to - axis.from);
  return [at - step, at, at + step].filter((value) => value >= axis.from - slack && value <= axis.to + slack);
}

// What is asked of each place: the criterion's outputs and those that are limited.
function outputsOf(view) {
  const { best } = view;
  const others = NEEDS_OTHER.has(best.kind) ? [best.against] : [];
  return [...new Set([view.output, ...others, ...best.limits.map(({ output }) => output)])];
}

async function computed(view, parameters, options) {
  const choice = view.kind === "sweep" ? "variant" : "method";
  const study = {
    kind: view.kind,
    scene: view.scene,
    ...(view.choice ? { [choice]: view.choice } : {}),
    outputs: outputsOf(view),
    parameters,
  };
  const { dataset } = await carryOut(view.kind, study, options);
  return dataset;
}

function reader(dataset, name) {
  const variable = dataset.variables[name];
  return (places) => (variable ? variable.dims.reduce((found, dim) => found[places[dim]], variable.data) : null);
}

// What the criterion makes of a place, and which limits it breaks.
function judged(view, dataset, places) {
  const { best } = view;
  const at = (name) => reader(dataset, name)(places);
  const value = at(view.output);
  const size = NEEDS_OTHER.has(best.kind) ? Math.abs(at(best.against)) : 0;
  const objective = best.kind === "weighted" && value !== null ? value - best.weight * size : value;
  const broken = best.limits
    .filter(({ output, lower, upper, absolute }) => {
      const one = absolute ? Math.abs(at(output)) : at(output);
      const slack = 1e-6 * Math.max(Math.abs(lower ?? 0), Math.abs(upper ?? 0));
      return (lower !== null && one < lower - slack) || (upper !== null && one > upper + slack);
    })
    .map(({ output }) => output);
  if (best.kind === "limit" && size > best.limit * (1 + 1e-6)) broken.push(best.against);
  const regimes = Object.entries(dataset.variables.regime?.flags ?? {});
  const regime = regimes.find(([, number_]) => number_ === at("regime"))?.[0] ?? "";
  return { objective: objective ?? NaN, broken, regime };
}

// How much worse it is than at the best, as a share of it.
function fall(view, best, one) {
  const sign = view.best.kind === "minimise" ? -1 : 1;
  return (sign * (best.objective - one.objective)) / Math.abs(best.objective || 1);
}

// The neighbours of a design: {x, y: values, cells: [[{fall, broken, regime, isBest}]], row by row}.
export async function neighboursOf(view, at, step, options) {
  const x = steps(at[view.x.name], step.x, view.x);
  const y = view.y ? steps(at[view.y.name], step.y, view.y) : [];
  const parameters = { ...givenValues(view), ...view.best.given, ...at, [view.x.name]: x };
  if (view.y) parameters[view.y.name] = y;
  const dataset = await computed(view, parameters, options);
  const middle = { i: x.indexOf(at[view.x.name]), j: y.indexOf(at[view.y?.name]) };
  const judge = (i, j) => judged(view, dataset, { [view.x.name]: i, [view.y?.name]: j });
  const best = judge(middle.i, middle.j);
  const rows = (y.length ? y : [null]).map((_, j) =>
    x.map((__, i) => {
      const one = judge(i, j);
      const isBest = i === middle.i && (!y.length || j === middle.j);
      return { ...one, fall: fall(view, best, one), isBest };
    }),
  );
  return { x, y, cells: rows, step, middle };
}

// The best along what is not known exactly: {name, places: [{share, fall, broken, regime}]}.
export async function bandOf(view, at, options) {
  const { name, share } = view.band;
  const middle = view.values[name];
  const values = BAND.map((place) => middle * (1 + place * share)).sort((a, b) => a - b);
  const dataset = await computed(view, { ...givenValues(view), ...view.best.given, ...at, [name]: values }, options);
  const all = values.map((_, place) => judged(view, dataset, { [name]: place }));
  const best = all[(values.length - 1) / 2];
  return { name, values, places: all.map((one) => ({ ...one, fall: fall(view, best, one) })) };
}
