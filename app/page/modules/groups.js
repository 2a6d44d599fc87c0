// Outputs in groups: what a designer asks for most in front, then by what they are about.

const MOST_ASKED = [
  "conveying_velocity", "feed_rate", "hop_height", "throw_number", "landing_speed", "flight_fraction", "acceleration_x", "track_amplitude",
];
const FEW = 10; // need no groups

// The first that fits counts; by name, or by unit.
/** @type {{title: string, isIn: (output: {name: string, unit: string}) => boolean}[]} */
const GROUPS = [
  { title: "Most asked", isIn: ({ name }) => MOST_ASKED.includes(name) },
  { title: "Power and work", isIn: ({ name }) => /_(power|work)$|^efficiency$/.test(name) },
  { title: "Speed and rate", isIn: ({ name, unit }) => ["m s-1", "min-1"].includes(unit) || /velocity|speed|fastest|direction/.test(name) },
  { title: "What the part does", isIn: ({ name }) => /fraction|impacts|period|status|share/.test(name) },
  { title: "Accelerations, forces and strokes", isIn: ({ name, unit }) => !/_scale$/.test(name) && unit !== "1" },
  { title: "Dimensionless numbers and scales", isIn: () => true },
];

// Options of a choice, by `option(output)`; where there are many, as [title, options] of groups.
export function grouped(outputs, option) {
  if (outputs.length <= FEW) return outputs.map(option);
  const left = [...outputs];
  const taken = (isIn) => left.filter(isIn).map((one) => left.splice(left.indexOf(one), 1)[0]);
  return GROUPS.map(({ title, isIn }) => [title, taken(isIn).map(option)]).filter(([, list]) => list.length);
}
