// The best of a view: made whole, as a study, and searched for.

import { FIGURES, NEEDS_OTHER, usualBest } from "./criterion.js";
import { misfit } from "./opening.js";
import { designsOf } from "./optima.js";
import { carryOut } from "./service.js";
import { givenNames, givenValues, shownParameters, typical } from "./view.js";

const WIDER = 4; // times the frequency, either way, among which another one is looked for
const RUBBER = 0.8; // friction of a lined track

// The best of a view made whole, and a sentence about each part of it that made no sense.
export function completeBest(view, scene) {
  const best = { ...usualBest(), ...view.best };
  const complaints = [];
  const outputs = new Set(scene.outputs.map(({ name }) => name));
  const parameters = new Set(scene.parameters.map(({ name }) => name));
  const axes = [view.x.name, view.y?.name];
  const isKnown = (one, isThere) => {
    if (!isThere) complaints.push(misfit(one));
    return isThere;
  };
  const others = scene.outputs.filter(({ name }) => name !== view.output);
  if (!others.some(({ name }) => name === best.against)) {
    if (best.against) complaints.push(misfit(best.against));
    best.against = others.find(({ name }) => name === "acceleration_y")?.name ?? others[0]?.name ?? "";
  }
  best.limits = best.limits.filter(({ output }) => isKnown(output, outputs.has(output)));
  best.vary = best.vary.filter(({ name }) => isKnown(name, parameters.has(name) && (axes.includes(name) || name in view.values)) && !axes.includes(name));
  const further = furtherOf({ ...view, best }, scene);
  best.given = Object.fromEntries(further.map((one) => [one.name, best.given[one.name] ?? typical(one)]));
  return { best, complaints };
}

// The outputs that a study tells besides its criterion: those where something begins at a level.
function levelled(view, scene) {
  const known = givenNames(view, scene);
  return scene.outputs.filter(
    ({ name, level, required }) =>
      Number.isFinite(level) && name !== view.output && required.every((one) => known.has(one)),
  );
}

// Parameters that the other outputs need, and the view has not.
export function furtherOf(view, scene) {
  const { best } = view;
  const named = [...(NEEDS_OTHER.has(best.kind) ? [best.against] : []), ...best.limits.map(({ output }) => output)];
  const known = givenNames(view, scene);
  const found = new Map();
  for (const output of named) {
    const required = scene.outputs.find(({ name }) => name === output)?.required ?? [];
    const missing = new Set(required.filter((name) => !known.has(name)));
    for (const parameter of shownParameters(scene, output)) {
      const { name, instead_of: instead } = parameter;
      if ([name, ...(instead ?? [])].some((one) => missing.has(one))) found.set(name, parameter);
    }
  }
  return [...found.values()];
}

// The names of what is chosen, those of the axes first.
export function variablesOf(view) {
  return [view.x.name, view.y?.name, ...view.best.vary.map(({ name }) => name)].filter(Boolean);
}

// The study of the best of a view.
export function bestStudy(view, scene) {
  const { best } = view;
  const variables = {};
  for (const axis of [view.x, view.y, ...best.vary]) {
    if (axis) variables[axis.name] = { lower: axis.from, upper: axis.to };
  }
  const study = {
    kind: "optimise",
    scene: view.scene,
    criterion: { kind: best.kind, output: view.output },
    variables,
    parameters: {},
  };
  for (const [name, value] of Object.entries({ ...givenValues(view), ...best.given })) {
    if (!(name in variables)) study.parameters[name] = value;
  }
  if (view.kind === "sweep" && view.choice) study.variant = view.choice;
  if (NEEDS_OTHER.has(best.kind)) study.criterion.against = best.against;
  const figure = FIGURES[best.kind];
  if (figure) study.criterion[figure] = best[figure];
  const told = scene.outputs.filter(({ name }) => name === "hop_height" && name !== view.output);
  const outputs = [...levelled(view, scene), ...told].map(({ name }) => name).filter((name) => name !== study.criterion.against);
  if (outputs.length) study.outputs = outputs;
  if (view.kind === "sweep" && !best.isInContact) {
    study.floor_contact = false;
    study.wall_contact = false;
  }
  const limits = best.limits.filter(({ lower, upper }) => lower !== null || upper !== null);
  if (limits.length) {
    study.constraints = limits.map(({ output, lower, upper, absolute }) => ({
      output,
      ...(lower === null ? {} : { lower }),
      ...(upper === null ? {} : { upper }),
      ...(absolute ? { absolute } : {}),
    }));
  }
  if (best.isRobust && view.band && !(view.band.name in variables)) {
    const { name, share } = view.band;
    const middle = view.values[name];
    const ends = [middle * (1 - share), middle * (1 + share)].sort((a, b) => a - b);
    study.uncertain = { [name]: { lower: ends[0], upper: ends[1] } };
    study.robust = "worst";
    delete study.parameters[name];
  }
  return study;
}

/** @param {any} view @param {any} scene @param {import("./computed.js").How} how */
export async function searched(view, scene, { signal, tell }) {
  return designsOf((await carryOut("optimise", bestStudy(view, scene), { signal, tell })).dataset, variablesOf(view));
}

/**
 * Where no design keeps all limits: how near each limit comes while the others are kept, {output, end, bound, at, value};
 * and what would have them kept, {name, at, value} of a parameter that is freed.
 * What is found first is shown first.
 * @param {any} view @param {any} scene @param {import("./computed.js").How} how
 */
export async function nearestTo(view, scene, how) {
  const { best } = view;
  const first = async (other) => (await searched({ ...view, ...other }, scene, how))[0];
  const [near, ways] = [[], []];
  const bounds = best.limits.flatMap((limit) => ["lower", "upper"].filter((end) => limit[end] !== null).map((end) => ({ limit, end })));
  for (const { limit, end } of bounds) {
    const limits = best.limits.map((one) => (one === limit ? { ...one, [end]: null } : one));
    const found = await first({ output: limit.output, best: { ...best, kind: end === "lower" ? "maximise" : "minimise", limits } });
    const value = found.values[limit.output]?.value;
    if (found.isThere && (end === "lower" ? value < limit.lower : value > limit.upper)) near.push({ output: limit.output, end, bound: limit[end], at: found.at, value });
  }
  how.show({ near, ways });
  const { frequency, friction } = view.values;
  const wider = { frequency: [frequency / WIDER, WIDER * frequency], friction: [friction, RUBBER] };
  for (const [name, [from, to]] of Object.entries(wider)) {
    if (!(from < to) || variablesOf(view).includes(name) || (best.isRobust && view.band?.name === name)) continue;
    const found = await first({ best: { ...best, vary: [...best.vary, { name, from, to }] } });
    if (found.isThere) ways.push({ name, at: found.at, value: found.values[view.output].value });
  }
  return { near, ways };
}
