// The questions that the page answers. A question is a record: the view that it begins with, what is shown of it, and
// the parameters that have a slider on the first screen. Its words are in index.html.

import { usualBest } from "./criterion.js";

const MOTION = { kind: "simulate", scene: "rectangle-on-plane", output: "conveying_velocity" };
const KNOWN = { band: { name: "friction", share: 1 / 3 } };
const DRIVE = ["amplitude", "peak_to_peak", "vertical_amplitude", "beta", "frequency", "gamma"];

/**
 * @typedef {object} Question
 * @property {any} begin
 * @property {string[]} main sections under the answer
 * @property {string[]} side sections beside it
 * @property {string[]} sliders
 * @property {string} [map] title of the map
 * @property {string} [choice] name of its variants, where they stand on the first screen
 */

/** @type {Record<string, any>} */
export const QUESTIONS = {
  speed: {
    begin: { ...MOTION, ...KNOWN },
    main: ["stage"],
    side: ["picture", "detail"],
    sliders: DRIVE,
  },
  hop: {
    begin: { ...MOTION, output: "hop_height" },
    main: ["stage"],
    side: ["picture", "detail"],
    sliders: DRIVE,
  },
  resting: {
    begin: {
      kind: "sweep",
      scene: "resting-part",
      choice: "box",
      output: "let_down_share_flat",
      x: { name: "width", from: 0.005, to: 0.04 },
      y: { name: "height", from: 0.004, to: 0.03 },
      values: { length: 0.03, width: 0.02, height: 0.01 },
    },
    map: "How would another size lie?",
    main: ["aspects"],
    side: ["surface", "picture", "onward"],
    sliders: ["length", "width", "height", "diameter", "small_diameter", "centre_of_mass"],
    choice: "Shape",
  },
  drive: {
    begin: { ...MOTION, ...KNOWN, best: { ...usualBest(), isFound: true } },
    main: ["chips", "picture"],
    side: ["stage", "optimum"],
    sliders: ["frequency"],
  },
  waves: {
    begin: { ...MOTION, set: "ellipse" },
    main: ["waves", "stage"],
    side: ["picture", "detail"],
    sliders: [],
  },
  springs: {
    begin: {
      kind: "sweep",
      scene: "linear-drive-unit",
      choice: "measured",
      output: "track_amplitude",
      x: { name: "frequency", from: 40, to: 60 },
      y: { name: "load_mass", from: 0, to: 2 },
      values: { load_mass: 0.5, base_mass: 30, moving_mass: 10 },
    },
    main: ["resonance"],
    side: ["picture"],
    sliders: ["frequency", "load_mass", "moving_mass", "base_mass", "ring_down_frequency", "spring_count"],
  },
  uncertain: {
    begin: { ...MOTION, ...KNOWN },
    main: ["matters", "stage"],
    side: ["picture"],
    sliders: ["friction", "amplitude", "peak_to_peak", "beta"],
  },
  measured: {
    begin: {
      ...MOTION,
      x: { name: "amplitude", from: 0.00005, to: 0.0004 },
      y: null,
      values: { frequency: 50, beta: 30, gamma: 2, amplitude: 0.0002 },
      runs: [[0.0001, 0.0035], [0.00015, 0.0055], [0.0002, 0.0076], [0.00025, 0.012], [0.0003, 0.02]],
    },
    main: ["picture", "measured"],
    side: ["stage", "detail"],
    sliders: ["friction", "beta", "frequency"],
  },
  rows: {
    begin: {
      kind: "simulate",
      scene: "row-on-plane",
      output: "conveying_velocity",
      set: "row",
      x: { name: "amplitude", from: 0.0001, to: 0.0005 },
      y: { name: "beta", from: 5, to: 40 },
      values: { amplitude: 0.0003, beta: 20 },
    },
    main: ["stage"],
    side: ["picture", "detail"],
    sliders: DRIVE,
  },
  orienting: {
    begin: {
      kind: "sweep",
      scene: "orienting-line",
      choice: "box",
      output: "oriented_feed_rate",
      x: { name: "wiper_height_1", from: 0.008, to: 0.032 },
      y: { name: "arrival_rate", from: 60, to: 600 },
      values: { length: 0.03, width: 0.02, height: 0.01, wiper_height_1: 0.015, arrival_rate: 300, wanted_aspect: 1 },
    },
    main: ["devices"],
    side: ["picture"],
    sliders: ["arrival_rate", "wiper_height_1", "height"],
    choice: "Shape",
  },
  plate: {
    begin: { kind: "simulate", scene: "part-on-plate", output: "travel_speed", set: "plate", ...KNOWN },
    map: "The plate from above",
    main: ["moves", "picture"],
    side: ["stage", "detail"],
    sliders: ["frequency", "amplitude_along_1", "amplitude_across_1", "amplitude_normal_1", "phase_normal_1", "amplitude_tilt_x_1", "phase_tilt_x_1", "amplitude_tilt_y_1", "phase_tilt_y_1"],
  },
  thesis: {
    begin: MOTION,
    main: ["figures", "picture"],
    side: ["values"],
    sliders: [],
  },
  all: {
    begin: { kind: "sweep", scene: "rectangle-on-plane", output: "acceleration_x" },
    main: ["figures", "picture"],
    side: ["values"],
    sliders: DRIVE,
  },
};

// The view that a question begins with.
export function begun(question) {
  const record = Object.hasOwn(QUESTIONS, question) ? QUESTIONS[question] : QUESTIONS.speed;
  const view = structuredClone({ choice: "", values: {}, ...record.begin, question });
  return { ...view, begun: view.values };
}
