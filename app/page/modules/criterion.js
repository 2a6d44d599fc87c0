// What "best" means: a criterion, limits of outputs, what may be chosen.

export const CRITERIA = {
  maximise: "As large as possible",
  minimise: "As small as possible",
  weighted: "Output large, another output small (weighted)",
  limit: "Output large, another output below a limit",
  pareto: "All best trade-offs with another output",
  reach: "As near as possible to a target",
};
export const NEEDS_OTHER = new Set(["weighted", "limit", "pareto"]);
// The figure that a criterion asks for.
export const FIGURES = { limit: "limit", weighted: "weight", pareto: "points", reach: "target" };
const POINTS = 20; // of a trade-off: a point of motion takes a second

export function usualBest() {
  return {
    kind: "maximise",
    against: "",
    limit: 1,
    weight: 1,
    points: POINTS,
    target: 0,
    limits: [], // of {output, lower, upper, absolute}; null where there is no bound
    vary: [], // of {name, from, to}: what may be chosen besides the axes
    given: {}, // values of what other outputs need besides those of the view
    isInContact: true, // whether a snapshot keeps its contacts with floor and wall
    isRobust: false, // whether the worst case counts of what is not known exactly
    isFound: false,
  };
}
