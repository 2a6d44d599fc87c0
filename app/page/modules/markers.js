// Marks of regimes: each has its colour and its shape, so that nobody needs to tell colours apart.

import { drawn } from "./elements.js";
import { words } from "./words.js";

// Within 1 of the middle.
const CIRCLE = "M1 0A1 1 0 1 1-1 0A1 1 0 1 1 1 0Z";
const SQUARE = "M-.9-.9H.9V.9H-.9Z";
const UPWARDS = "M0-1.15L1.05 .8H-1.05Z";
const DIAMOND = "M0-1.2L1.2 0L0 1.2L-1.2 0Z";
const DOWNWARDS = "M0 1.15L1.05-.8H-1.05Z";
const CROSS = "M-.4-1.1H.4V-.4H1.1V.4H.4V1.1H-.4V.4H-1.1V-.4H-.4Z";
const STAR = "M0-1.2L.35-.4L1.2-.35L.5.25L.75 1.1L0 .6L-.75 1.1L-.5.25L-1.2-.35L-.35-.4Z";
const BAR = "M-1.2-.7H1.2V.7H-1.2Z";
// By colour: a regime has the same mark in each system, as it has the same colour; those of motion that meet
// in one picture differ.
const SHAPES = {
  "#9ccbff": CIRCLE,
  "#a3c02c": UPWARDS,
  "#3f8a70": DOWNWARDS,
  "#ffd98f": CROSS,
  "#c66a2c": STAR,
  "#ee7fa6": BAR,
  "#a05ce6": DIAMOND,
  "#4a4a4a": SQUARE,
  "#b3560f": UPWARDS,
  "#5e2d91": DOWNWARDS,
  "#9b1b5a": DIAMOND,
  "#6b5d00": SQUARE,
  "#8b1a1a": STAR,
  "#8a7a1f": UPWARDS,
  "#00696b": CIRCLE,
  "#d6d6d6": DIAMOND,
  "#dddddd": BAR,
  "#ffffff": CROSS,
};

// In a map: regimes with the same word are one area.
const SAID = { stick: "slides", slip: "slides", stick_slip: "slides", hopping: "hops", hop_after_hop: "hops", period_doubled: "hops", aperiodic: "hops" };

// {said, colour, ink, shape, meaning, valid} of a regime of a scene by its name.
export function lookOf(scene, name) {
  const found = scene.regimes.find((one) => one.name === name);
  return {
    said: SAID[name] ?? words(name),
    colour: found?.colour ?? "#888888",
    ink: found?.ink ?? "#444444",
    shape: SHAPES[found?.colour] ?? CIRCLE,
    meaning: found?.description ?? "",
    valid: found?.valid ?? true,
  };
}

export function markerDrawn({ colour, ink, shape }, x, y, size, more = {}) {
  return drawn("path", {
    d: shape,
    transform: `translate(${x.toFixed(1)} ${y.toFixed(1)}) scale(${size})`,
    fill: colour,
    stroke: ink,
    "vector-effect": "non-scaling-stroke",
    ...more,
  });
}
