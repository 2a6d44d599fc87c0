// What "best" means: a criterion, limits of outputs, what may be chosen; and how a link says so.

export const CRITERIA = {
  maximise: "As large as possible",
  minimise: "As small as possible",
  weighted: "Output large, another output small (weighted)",
  limit: "Output large, another output below a limit",
  pareto: "All best trade-offs with another output",
};
export const NEEDS_OTHER = new Set(["weighted", "limit", "pareto"]);
// The figure that a criterion asks for.
export const FIGURES = { limit: "limit", weighted: "weight", pareto: "points" };
const POINTS = 20; // of a trade-off: a point of motion takes a second

export function usualBest() {
  return {
    kind: "maximise",
    against: "",
    limit: 1,
    weight: 1,
    points: POINTS,
    limits: [], // of {output, lower, upper, absolute}; null where there is no bound
    vary: [], // of {name, from, to}: what may be chosen besides the axes
    given: {}, // values of what other outputs need besides those of the view
    isInContact: true, // whether a snapshot keeps its contacts with floor and wall
    isRobust: false, // whether the worst case counts of what is not known exactly
    isFound: false,
  };
}

// Write the best of a view into the query of a link.
export function bestToQuery(best, query) {
  query.set("best", best.kind);
  if (NEEDS_OTHER.has(best.kind)) query.set("against", best.against);
  const figure = FIGURES[best.kind];
  if (figure) query.set(figure, String(best[figure]));
  for (const { output, lower, upper, absolute } of best.limits) {
    query.append("keep", [output, lower ?? "", upper ?? "", absolute ? "size" : ""].join(":"));
  }
  for (const { name, from, to } of best.vary) query.append("vary", [name, from, to].join(":"));
  for (const [name, value] of Object.entries(best.given)) query.append("given", `${name}:${value}`);
  if (!best.isInContact) query.set("contact", "0");
  if (best.isRobust) query.set("robust", "1");
  if (best.isFound) query.set("found", "1");
}

// The best that a link asks for, or null. What makes no sense goes into `complaints`.
export function bestFromQuery(query, complaints) {
  const kind = query.get("best");
  if (kind === null) return null;
  const best = usualBest();
  if (Object.hasOwn(CRITERIA, kind)) best.kind = kind;
  else complaints.push("The link names an unknown criterion: the output is maximised.");
  best.against = query.get("against") ?? "";
  for (const name of Object.values(FIGURES)) {
    const given = query.get(name);
    if (given === null) continue;
    if (given !== "" && Number.isFinite(Number(given)) && Number(given) >= 0) best[name] = Number(given);
    else complaints.push(`The link gives a ${name} that is not a number of 0 or more: the default is used.`);
  }
  best.points = Math.max(2, Math.round(best.points));
  const numeric = (text) => (text === "" || text === undefined ? null : Number(text));
  for (const text of query.getAll("keep").slice(0, 20)) {
    const [output, lower, upper, size] = text.split(":");
    const ends = [numeric(lower), numeric(upper)];
    if (ends.every((end) => end === null || Number.isFinite(end))) {
      best.limits.push({ output, lower: ends[0], upper: ends[1], absolute: size === "size" });
    } else complaints.push("The link limits an output by a value that is not a number: the limit is ignored.");
  }
  for (const text of query.getAll("vary").slice(0, 8)) {
    const [name, from, to] = text.split(":");
    const ends = [numeric(from), numeric(to)];
    if (ends.every(Number.isFinite) && ends[0] < ends[1]) best.vary.push({ name, from: ends[0], to: ends[1] });
    else complaints.push("The link gives a variable of the search without a range: the variable is ignored.");
  }
  for (const text of query.getAll("given")) {
    const [name, value] = text.split(":");
    if (value && Number.isFinite(Number(value))) best.given[name] = Number(value);
    else complaints.push("The link gives a parameter of the search a value that is not a number: the default is used.");
  }
  best.isInContact = query.get("contact") !== "0";
  best.isRobust = query.get("robust") === "1";
  best.isFound = query.get("found") === "1";
  return best;
}
