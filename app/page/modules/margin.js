// What the service found, in words: the drive, how far it is from each limit, what a little more would do.

import { element } from "./elements.js";
import { capital, number, withUnit, words } from "./words.js";

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

function row(head, text) {
  return element("tr", {}, element("th", { scope: "row" }, head), element("td", {}, text));
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

// What one per cent more of each parameter does to the criterion.
export function ratesTold(design) {
  const rows = design.rates.map(({ name, value }) => {
    const isNone = Math.abs(value) < 1e-6;
    const change = isNone ? "no change" : `${value > 0 ? "+" : ""}${number(value, 2)} %`;
    const told = Number.isFinite(value) ? change : "no rate of change: the criterion jumps or has a kink at the optimum";
    return row(capital(words(name)), told);
  });
  if (!rows.length) return null;
  return element("details", {}, element("summary", {}, "Effect of 1 % more of a parameter on the optimum"), element("table", {}, ...rows));
}
