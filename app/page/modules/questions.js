// The questions that the page answers. A question is a record: its words, the view that it begins with, what
// is shown of it, and the parameters that have a slider on the first screen.

import { usualBest } from "./criterion.js";

const MOTION = { kind: "simulate", scene: "rectangle-on-plane", output: "conveying_velocity" };
const KNOWN = { band: { name: "friction", share: 1 / 3 } };
const DRIVE = ["amplitude", "peak_to_peak", "vertical_amplitude", "beta", "frequency"];

/**
 * @typedef {object} Question
 * @property {string} group of the navigation
 * @property {string} nav its words there
 * @property {string} title
 * @property {any} begin
 * @property {string[]} main sections under the answer
 * @property {string[]} side sections beside it
 * @property {string[]} sliders
 */

/** @type {Record<string, any>} */
export const QUESTIONS = {
  speed: {
    group: "My part",
    nav: "How fast does it travel?",
    title: "How fast does my part travel?",
    begin: { ...MOTION, ...KNOWN },
    main: ["stage"],
    side: ["picture", "detail"],
    sliders: DRIVE,
  },
  hop: {
    group: "My part",
    nav: "Does it hop?",
    title: "Does my part hop?",
    begin: { ...MOTION, output: "hop_height" },
    main: ["stage"],
    side: ["picture", "detail"],
    sliders: DRIVE,
  },
  resting: {
    group: "My part",
    nav: "Which way up will it lie?",
    title: "Which way up will it lie?",
    begin: {
      kind: "sweep",
      scene: "resting-part",
      choice: "box",
      output: "let_down_share_flat",
      x: { name: "width", from: 0.005, to: 0.04 },
      y: { name: "height", from: 0.004, to: 0.03 },
      values: { length: 0.03, width: 0.02, height: 0.01 },
    },
    main: ["aspects"],
    side: ["picture", "onward"],
    sliders: ["length", "width", "height", "diameter", "small_diameter"],
  },
  drive: {
    group: "My drive",
    nav: "Which drive is best?",
    title: "Which drive is best?",
    begin: { ...MOTION, ...KNOWN, best: { ...usualBest(), isFound: true } },
    main: ["chips", "picture"],
    side: ["stage", "optimum"],
    sliders: [],
  },
  waves: {
    group: "My drive",
    nav: "What if it is not a sine?",
    title: "My drive is not a sine: how do parts travel?",
    begin: { ...MOTION, set: "ellipse" },
    main: ["waves", "stage"],
    side: ["picture", "detail"],
    sliders: [],
  },
  springs: {
    group: "My drive",
    nav: "What will my springs give?",
    title: "What amplitude will my springs give?",
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
    sliders: ["frequency", "load_mass", "ring_down_frequency", "spring_count"],
  },
  uncertain: {
    group: "How sure is it?",
    nav: "What if friction is uncertain?",
    title: "What if friction is uncertain?",
    begin: { ...MOTION, ...KNOWN },
    main: ["matters", "stage"],
    side: ["picture", "beside"],
    sliders: ["friction", "amplitude", "peak_to_peak", "beta"],
  },
  measured: {
    group: "How sure is it?",
    nav: "What did I measure?",
    title: "What did I measure?",
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
    group: "My line",
    nav: "How do rows of parts move?",
    title: "How do rows of parts move?",
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
    group: "My line",
    nav: "What leaves my line?",
    title: "What leaves my line?",
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
  },
  thesis: {
    group: "Reference",
    nav: "Thesis and every output",
    title: "What do the figures of the thesis show?",
    begin: MOTION,
    main: ["figures", "picture"],
    side: ["values"],
    sliders: [],
  },
  all: {
    group: "",
    nav: "",
    title: "Every output",
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
