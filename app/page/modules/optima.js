// The optima that the service found: the designs of a dataset, and in words how far they are from each limit.

import { capital, number, withUnit, words } from "./words.js";

// The designs of a dataset: {at, values, margins, ends, regime, status, isKnee}, of
// `at` {name: value} of what was chosen, `values` {name: {value, unit}} of outputs,
// `margins` [{name, value, unit, binds}] to contacts and limits, and
// `ends` [{name, end}] of ranges that were reached. A front without a trade-off is one design.
export function designsOf(dataset, names) {
  const { variables } = dataset;
  const isFront = variables[`best_${names[0]}`].dims.includes("front");
  const isOne = variables.front_points?.data[0] === 1;
  const count = isFront && !isOne ? variables[`best_${names[0]}`].data.length : 1;
  return Array.from({ length: count }, (_, i) => designOf(variables, names, (one) => (one.dims.includes("front") ? one.data[i] : one.data)));
}

function designOf(variables, names, at) {
  const value = (name) => (variables[name] ? at(variables[name]) : null);
  const flag = (name) => {
    const found = Object.entries(variables[name]?.flags ?? {}).find(([, number]) => number === value(name));
    return found?.[0] ?? "";
  };
  const design = {
    at: Object.fromEntries(names.map((name) => [name, value(`best_${name}`)])),
    values: {},
    margins: [],
    ends: [],
    regime: { name: flag("regime"), value: value("regime") },
    status: flag("optimum_status"),
    isKnee: flag("knee") === "knee",
  };
  design.isThere = names.every((name) => Number.isFinite(design.at[name]));
  for (const [name, variable] of Object.entries(variables)) {
    const [first] = name.split("_");
    const rest = name.slice(first.length + 1);
    const known = { value: at(variable), unit: variable.units ?? "1" };
    if (first === "margin") design.margins.push({ name: rest, ...known, binds: value(`binds_${rest}`) === 1 });
    else if (!variable.flags && !["best", "binds"].includes(first)) design.values[name] = known;
  }
  for (const name of names) {
    for (const end of ["lower", "upper"]) {
      if (value(`binds_${name}_${end}`) === 1) design.ends.push({ name, end });
    }
  }
  return design;
}

const STATUSES = {
  optimal: "The search found nothing better within the bounds.",
  flat: "The output is the same for all drives within the bounds.",
  no_motion: "No drive within the bounds moves the part forwards.",
  only_backward: "Every drive within the bounds moves the part backwards.",
  not_attained: "At the optimum itself, static friction still holds the part; just beside it, the output jumps to this value.",
  target_missed: "No drive within the bounds reaches the target; this is the nearest.",
  infeasible: "No drive within the bounds keeps all limits and contacts.",
  suboptimal: "The search missed a better drive, which a check on a grid found: search again within narrower bounds.",
  no_value: "The output has no value anywhere within the bounds.",
};

export function statusTold(status) {
  return STATUSES[status] ?? (status ? `${capital(words(status))}.` : "");
}

// How far the part is from leaving floor or wall, and from each limit.
export function marginsTold(design, scene) {
  const found = [];
  for (const { name, level, begins } of scene.outputs) {
    const value = design.values[name]?.value;
    if (!Number.isFinite(level) || !Number.isFinite(value)) continue;
    const share = Math.abs(value - level) / Math.abs(level || 1);
    const told = `${capital(words(name))} is ${number(value)}`;
    if (share < 1e-6) found.push(`${told}, exactly at the threshold of ${begins}.`);
    else found.push(`${told}: ${number(100 * share, 3)} % ${value > level ? "beyond" : "below"} ${begins}, which comes at ${number(level)}.`);
  }
  for (const { name, value, unit, binds } of design.margins) {
    if (!Number.isFinite(value)) continue;
    const told = capital(limitTold(name, scene));
    found.push(
      binds ? `${told} has no room left: this limit determines the best drive.` : `${told} has ${withUnit(value, unit)} of room.`,
    );
  }
  return found;
}

// A limit by its name in the dataset: that of an output, of the criterion, or a contact.
function limitTold(name, scene) {
  const [, output, end] = name.match(/^(.*)_(lower|upper)$/) ?? [];
  if (scene.outputs.some((one) => one.name === output)) return `the ${end} limit of the ${words(output)}`;
  return name === "limit" ? "the limit of the second output" : `the ${words(name)}`;
}
