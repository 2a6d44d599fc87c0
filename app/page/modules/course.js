// The motion of one part, or of a row of them, over a cycle: its numbers, and what it is at a moment.

// Of the parts of a row.
export const PARTS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

export const MODES = {
  stick: ["#0072b2", "sticks"],
  forward: ["#009e73", "slides forwards"],
  backward: ["#cc79a7", "slides backwards"],
  slide: ["#009e73", "slides"],
  flight: ["#e69f00", "hops"],
  unknown: ["#888888", "moves"],
};

// A course out of a dataset of a simulation with `trajectory`.
export function courseOf(dataset) {
  const all = { ...dataset.coordinates, ...dataset.variables };
  const values = (name) => all[name]?.data;
  const flags = all.motion_mode?.flags ?? {};
  const names = Object.fromEntries(Object.entries(flags).map(([name, value]) => [value, name]));
  const times = values("cycle_time");
  const zeros = () => times.map(() => 0);
  const trackAlong = values("track_along") ?? zeros();
  const relative = values("relative_velocity_along");
  const trackVelocity = slopes(times, trackAlong);
  return {
    times,
    along: values("position_along") ?? zeros(),
    height: values("height_above_floor") ?? zeros(),
    wall: values("distance_from_wall"),
    trackAlong,
    trackNormal: values("track_normal") ?? zeros(),
    trackVelocity,
    partVelocity: relative ? relative.map((one, i) => one + trackVelocity[i]) : null,
    row: rowOf(all, times),
    modes: (values("motion_mode") ?? zeros()).map((value) => names[value] ?? "unknown"),
    radius: values("radius") ?? null,
    climb: values("gamma") ?? 0,
    lean: values("delta") ?? null,
    unit: all.position_along?.units ?? "m",
    velocity: values("conveying_velocity"),
    throwNumber: values("throw_number") ?? null,
    hopHeight: values("hop_height") ?? null,
    platoons: values("platoons") ?? null,
    feedRate: values("feed_rate") ?? null,
    amplitude: values("amplitude") ?? null,
    regime: nameOf(all.regime),
  };
}

// The name of the one value of a flag.
function nameOf(variable) {
  const { data, flags = {} } = variable ?? {};
  return Object.keys(flags).find((name) => flags[name] === data) ?? "";
}

// The parts of a row from the rear to the front: {positions: [[m]], length}; null of a single part.
// Each part has what it is ahead of the mean travel, too.
function rowOf(all, times) {
  const positions = [];
  for (let part = 1; all[`part_position_${part}`]; part++) positions.push(all[`part_position_${part}`].data);
  if (!positions.length) return null;
  const [rear] = positions;
  const travel = (rear[rear.length - 1] - rear[0]) / (times[times.length - 1] - times[0] || 1);
  const ahead = positions.map((values) => values.map((value, i) => value - values[0] - travel * (times[i] - times[0])));
  return { positions, ahead, length: all.length?.data ?? 0 };
}

// The slope of values over times, between their neighbours.
function slopes(times, values) {
  const last = times.length - 1;
  return values.map((_, i) => {
    const [before, after] = [Math.max(0, i - 1), Math.min(last, i + 1)];
    return (values[after] - values[before]) / (times[after] - times[before] || 1);
  });
}

export function cycleOf({ times }) {
  return times[times.length - 1] - times[0];
}

// The value at a time, between its neighbours.
export function between({ times }, values, time) {
  let i = times.findIndex((one) => one > time);
  if (i < 0) i = times.length - 1;
  i = Math.max(1, i);
  const share = (time - times[i - 1]) / (times[i] - times[i - 1] || 1);
  return values[i - 1] + share * (values[i] - values[i - 1]);
}

// What the part does at a time: its mode.
export function modeAt({ times, modes }, time) {
  const place = times.findIndex((one) => one > time);
  return modes[Math.max(0, (place < 0 ? times.length : place) - 1)];
}
