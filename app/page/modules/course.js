// The motion of one part, or of a row of them, over a cycle: its numbers, and what it is at a moment.

// Of the way that is shown: gaps that are no larger are those of parts that touch.
const TOUCHES = 1e-9;

// Of the parts of a row.
export const PARTS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

// What a part does: the class of its colour, and words.
export const MODES = {
  stick: ["stick", "sticks"],
  forward: ["forward", "slides forwards"],
  backward: ["backward", "slides back"],
  slide: ["forward", "slides"],
  flight: ["flight", "in the air"],
  unknown: ["stick", "moves"],
};

// A course out of a dataset of a simulation with `trajectory`; null without one.
export function courseOf(dataset) {
  if (!dataset?.coordinates.cycle_time) return null;
  const all = { ...dataset.coordinates, ...dataset.variables };
  const values = (name) => all[name]?.data;
  const flags = all.motion_mode?.flags ?? {};
  const names = Object.fromEntries(Object.entries(flags).map(([name, value]) => [value, name]));
  const times = values("cycle_time");
  const zeros = () => times.map(() => 0);
  const trackAlong = values("track_along") ?? zeros();
  return {
    times,
    along: values("position_along") ?? values("path_along") ?? zeros(),
    height: values("height_above_floor") ?? values("path_gap") ?? zeros(),
    pitch: values("path_pitch") ?? null,
    wall: values("distance_from_wall"),
    trackAlong,
    trackNormal: values("track_normal") ?? zeros(),
    row: rowOf(all, times),
    modes: (values("motion_mode") ?? zeros()).map((value) => names[value] ?? "unknown"),
    unit: all.position_along?.units ?? "m",
  };
}

// The parts of a row from the rear to the front: {positions: [[m]], ahead: [[m]], length, closed}; null
// of a single part. `ahead` is what each is ahead of the mean travel, `closed[i][k]` whether part i
// touches the one in front of it at time k.
function rowOf(all, times) {
  const positions = [];
  for (let part = 1; all[`part_position_${part}`]; part++) positions.push(all[`part_position_${part}`].data);
  if (!positions.length) return null;
  const [rear] = positions;
  const travel = (rear[rear.length - 1] - rear[0]) / (times[times.length - 1] - times[0] || 1);
  const ahead = positions.map((values) => values.map((value, i) => value - values[0] - travel * (times[i] - times[0])));
  const length = all.length?.data ?? 0;
  const every = positions.flat();
  const room = TOUCHES * (Math.max(...every) - Math.min(...every));
  const closed = positions.slice(1).map((front, i) => front.map((value, k) => value - positions[i][k] - length <= room));
  return { positions, ahead, length, closed };
}

// The platoons of a row at a time: numbers of parts that touch, from the rear; [[1, 2], [3]].
export function platoonsAt({ times, row }, time) {
  const place = placeAt(times, time);
  const found = [[1]];
  row.closed.forEach((closed, i) => {
    if (closed[place]) found[found.length - 1].push(i + 2);
    else found.push([i + 2]);
  });
  return found;
}

// Where equal neighbours of a list begin and end, [from, to]: one begins where the other ends.
export function stretches(list) {
  const begins = [...list.keys()].filter((i) => i === 0 || list[i] !== list[i - 1]);
  return begins.map((from, k) => [from, begins[k + 1] ?? list.length - 1]);
}

// The last of the times that is not after one.
function placeAt(times, time) {
  const after = times.findIndex((one) => one > time);
  return Math.max(0, (after < 0 ? times.length : after) - 1);
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
  return modes[placeAt(times, time)];
}
