// Parameters that a scene takes in place of others: those of a drive that is no sine, and of a row of
// unequal parts. The service lists their names; here are those of them that the page has fields for.

const LENGTH = { unit: "m", lower: 0 };
const ANGLE = { unit: "degree", lower: -180, upper: 180, usual: [-180, 180] };
const LEVEL = { unit: "m s-2" };
const SHARE = { unit: "1", lower: 0, usual: [0.5, 10] };
const FRICTION = { unit: "1", lower: 0, usual: [0.05, 0.6] };
const OF_SINE = ["amplitude", "peak_to_peak", "alpha", "beta"];

const PLACE = { unit: "m", usual: [-0.12, 0.12] };
const TURN = { unit: "degree", lower: 0, usual: [0, 0.05], begin: 0 };

// By name: a title, what it stands for, its parameters with what they begin as, the axes, and the system that has it.
export const SETS = {
  stroke: {
    title: "A sine, by its stroke from peak to peak",
    instead: ["amplitude", "peak_to_peak"],
    parameters: { peak_to_peak: { ...LENGTH, label: "Peak-to-peak stroke", begin: 0.001, usual: [0.0002, 0.002] } },
  },
  ellipse: {
    title: "An ellipse: along and off the floor, out of phase",
    instead: OF_SINE,
    parameters: {
      amplitude_along_1: { ...LENGTH, label: "Amplitude along", begin: 0.0003, usual: [0.00005, 0.0008] },
      amplitude_normal_1: { ...LENGTH, label: "Amplitude off the floor", begin: 0.00008, usual: [0, 0.0002] },
      phase_normal_1: { ...ANGLE, label: "Phase off the floor", begin: -70 },
    },
    x: "phase_normal_1",
    y: "amplitude_normal_1",
  },
  harmonics: {
    title: "Two frequencies along the track",
    instead: OF_SINE,
    parameters: {
      amplitude_along_1: { ...LENGTH, label: "Amplitude along", begin: 0.0003, usual: [0.00005, 0.0008] },
      amplitude_along_2: { ...LENGTH, label: "Amplitude along, twice the frequency", begin: 0.000075, usual: [0, 0.0002] },
      phase_along_2: { ...ANGLE, label: "Phase of the motion along the track, at twice the frequency", begin: 180 },
    },
    x: "phase_along_2",
    y: "amplitude_along_2",
  },
  steps: {
    title: "Steps: gently forward, sharply back",
    instead: OF_SINE,
    parameters: {
      acceleration_along_1: { ...LEVEL, label: "Acceleration of step 1", begin: 2.5, usual: [0.5, 10] },
      acceleration_along_3: { ...LEVEL, label: "Acceleration of step 3", begin: 2.5, usual: [0.5, 10] },
      duration_1: { ...SHARE, label: "Duration of step 1", begin: 5 },
      duration_2: { ...SHARE, label: "Duration of step 2, whose acceleration balances the others", begin: 2 },
      duration_3: { ...SHARE, label: "Duration of step 3", begin: 5 },
    },
    x: "acceleration_along_1",
    y: "duration_2",
  },
  recorded: {
    title: "What an accelerometer recorded",
    instead: [...OF_SINE, "frequency"],
    parameters: { drive_factor: { unit: "1", lower: 0, label: "Factor of the drive", begin: 1, usual: [0.5, 1.5] } },
    x: "drive_factor",
    y: "friction",
  },
  plate: {
    title: "A plate that circles, bounces and tilts",
    of: "part-on-plate",
    instead: OF_SINE,
    parameters: {
      amplitude_along_1: { ...LENGTH, label: "Amplitude along x", begin: 0.0001, usual: [0, 0.0003] },
      phase_along_1: { ...ANGLE, label: "Phase along x", begin: 90 },
      amplitude_across_1: { ...LENGTH, label: "Amplitude along y", begin: 0.0001, usual: [0, 0.0003] },
      phase_across_1: { ...ANGLE, label: "Phase along y", begin: 0 },
      amplitude_normal_1: { ...LENGTH, label: "Bounce", begin: 0.00004, usual: [0, 0.0001] },
      phase_normal_1: { ...ANGLE, label: "Phase of the bounce", begin: -17 },
      amplitude_tilt_x_1: { ...TURN, label: "Tilt about x" },
      phase_tilt_x_1: { ...ANGLE, label: "Phase of the tilt about x", begin: 119 },
      amplitude_tilt_y_1: { ...TURN, label: "Tilt about y" },
      phase_tilt_y_1: { ...ANGLE, label: "Phase of the tilt about y", begin: 29 },
      amplitude_yaw_1: { ...TURN, label: "Turn about the vertical" },
      phase_yaw_1: { ...ANGLE, label: "Phase of the turn about the vertical", begin: 0 },
      position_x: { ...PLACE, label: "Place along x", begin: 0.06 },
      position_y: { ...PLACE, label: "Place along y", begin: 0.03 },
    },
    x: "position_x",
    y: "position_y",
  },
  row: {
    of: "row-on-plane",
    title: "Four parts of unequal friction",
    instead: ["parts", "friction", "friction_static", "friction_kinetic"],
    parameters: Object.fromEntries(
      [0.3, 0.36, 0.26, 0.34].map((value, i) => [
        `part_friction_${i + 1}`,
        { ...FRICTION, label: `Friction of part ${i + 1}${i ? "" : ", the rearmost"}`, begin: value },
      ]),
    ),
  },
};

// Whether a system, as the service describes it, takes a set.
export function takes({ name, other_drives: others }, set) {
  const { of } = SETS[set];
  return of ? name === of : Boolean(others);
}

export function isSet(name) {
  return Object.hasOwn(SETS, name);
}

// A scene with the parameters of a set in place of those that they stand for.
export function withSet(scene, name) {
  if (!isSet(name)) return scene;
  const { instead, parameters } = SETS[name];
  const added = Object.entries(parameters).map(([parameter, one]) => ({
    symbol: "",
    description: one.label,
    lower: null,
    upper: null,
    example: one.begin,
    default: null,
    instead_of: [],
    ...one,
    name: parameter,
  }));
  const names = added.map((one) => one.name);
  const others = (list) => (list.some((one) => instead.includes(one)) ? names : []);
  const exchanged = (list) => [...others(list), ...list.filter((one) => !instead.includes(one))];
  const [frequency, ...rest] = scene.parameters.filter((one) => !instead.includes(one.name));
  return {
    ...scene,
    parameters: [frequency, ...added, ...rest].filter(Boolean),
    outputs: scene.outputs.map((one) => ({ ...one, asks: exchanged(one.asks), required: exchanged(one.required) })),
  };
}

// The amplitude of a sine, or its stroke from peak to peak: which of them a view is stated in.
export const STROKE = "stroke"; // the set of this name
/** @type {Record<string, [string, number]>} */
const TWO = { amplitude: ["peak_to_peak", 2], peak_to_peak: ["amplitude", 0.5] };

// Whether a scene takes the one in place of the other.
export function takesBoth({ parameters }) {
  return Object.keys(TWO).every((name) => parameters.some((one) => one.name === name));
}

// Whether a view may be stated either way: it has one of both, and its scene takes both.
export function hasChoice(view, scene) {
  const isFree = view.set === STROKE || (!view.set && takesBoth(scene));
  const has = (name) => name in view.values || [view.x, view.y].some((axis) => axis?.name === name);
  return isFree && Object.keys(TWO).some(has);
}

// What changes of a view that is to be stated the other way: the same designs, by another name.
/** @param {import("./view.js").View} view @param {string | null} set */
export function restated(view, set) {
  const from = set === STROKE ? "amplitude" : "peak_to_peak";
  const [to, factor] = TWO[from];
  const named = (values) =>
    Object.fromEntries(Object.entries(values).map(([name, value]) => (name === from ? [to, factor * value] : [name, value])));
  const ranged = (axis) => (axis?.name === from ? { ...axis, name: to, from: factor * axis.from, to: factor * axis.to } : axis);
  const across = view.x.name === from ? factor : 1;
  const { band, pins, runs, best, begun } = view;
  return {
    set,
    values: named(view.values),
    x: ranged(view.x),
    y: ranged(view.y),
    ...(begun ? { begun: named(begun) } : {}),
    ...(band ? { band: { ...band, name: band.name === from ? to : band.name } } : {}),
    ...(pins ? { pins: pins.map(named) } : {}),
    ...(runs ? { runs: runs.map(([value, speed]) => [across * value, speed]) } : {}),
    ...(best ? { best: { ...best, vary: best.vary.map(ranged), given: named(best.given) } } : {}),
  };
}
