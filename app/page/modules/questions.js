// The questions that the page answers. A question is a record: its title, and the view that it begins
// with. `extra` names what it has beside picture, fields and motion; `set` other parameters of its scene.

import { usualBest } from "./criterion.js";

const MOTION = { kind: "simulate", scene: "rectangle-on-plane", output: "conveying_velocity" };

export const QUESTIONS = {
  speed: { title: "How fast does my part travel?", begin: MOTION },
  hop: { title: "Does it hop?", begin: { ...MOTION, output: "hop_height" } },
  drive: { title: "Which drive is best?", begin: { ...MOTION, best: { ...usualBest(), isFound: true } }, extra: "optimum" },
  uncertain: {
    title: "What if friction is uncertain?",
    begin: { ...MOTION, band: { name: "friction", share: 0.2 } },
    extra: "matters",
  },
  measured: {
    title: "What did I measure?",
    begin: {
      ...MOTION,
      x: { name: "amplitude", from: 0.00005, to: 0.0004 },
      y: null,
      values: { frequency: 50, beta: 30, gamma: 2 },
      runs: [[0.0001, 0.0035], [0.00015, 0.0055], [0.0002, 0.0076], [0.00025, 0.012], [0.0003, 0.02]],
    },
    extra: "measured",
  },
  waves: {
    title: "My drive is not a sine: how do parts travel?",
    begin: { ...MOTION, set: "ellipse" },
    extra: "waves",
  },
  springs: {
    title: "What amplitude will my springs give?",
    begin: {
      kind: "sweep",
      scene: "linear-drive-unit",
      choice: "measured",
      output: "track_amplitude",
      x: { name: "frequency", from: 40, to: 60 },
      y: { name: "load_mass", from: 0, to: 2 },
    },
  },
  rows: {
    title: "How do rows of parts move?",
    begin: {
      kind: "simulate",
      scene: "row-on-plane",
      output: "conveying_velocity",
      set: "row",
      x: { name: "amplitude", from: 0.0001, to: 0.0005 },
      y: { name: "beta", from: 5, to: 40 },
      point: { x: 0.0003, y: 20 },
    },
  },
  resting: {
    title: "Which way up will it lie?",
    begin: {
      kind: "sweep",
      scene: "resting-part",
      choice: "truncated_cone",
      output: "let_down_share_upright",
      x: { name: "small_diameter", from: 0.002, to: 0.02 },
      y: { name: "height", from: 0.01, to: 0.04 },
      values: { diameter: 0.02 },
    },
  },
  orienting: {
    title: "What leaves my line?",
    begin: {
      kind: "sweep",
      scene: "orienting-line",
      choice: "box",
      output: "oriented_feed_rate",
      x: { name: "wiper_height_1", from: 0.008, to: 0.032 },
      y: { name: "arrival_rate", from: 60, to: 600 },
      values: { length: 0.03, width: 0.02, height: 0.01 },
    },
  },
  thesis: { title: "What do the figures of the thesis show?", begin: MOTION, extra: "figures" },
  all: { title: "Everything", begin: { kind: "sweep", scene: "rectangle-on-plane", output: "acceleration_x" } },
};

// The view that a question begins with.
export function begun(question) {
  const record = Object.hasOwn(QUESTIONS, question) ? QUESTIONS[question] : QUESTIONS.speed;
  return structuredClone({ choice: "", values: {}, ...record.begin, question });
}
