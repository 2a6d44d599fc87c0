// Marks of regimes: each has its colour and its shape, so that nobody needs to tell colours apart.

import { drawn } from "./elements.js";

// Within 1 of the middle.
const SHAPES = [
  "M1 0A1 1 0 1 1-1 0A1 1 0 1 1 1 0Z",
  "M-.9-.9H.9V.9H-.9Z",
  "M0-1.15L1.05 .8H-1.05Z",
  "M0-1.2L1.2 0L0 1.2L-1.2 0Z",
  "M0 1.15L1.05-.8H-1.05Z",
  "M-.4-1.1H.4V-.4H1.1V.4H.4V1.1H-.4V.4H-1.1V-.4H-.4Z",
  "M0-1.2L.35-.4L1.2-.35L.5.25L.75 1.1L0 .6L-.75 1.1L-.5.25L-1.2-.35L-.35-.4Z",
  "M-1.2-.7H1.2V.7H-1.2Z",
];

// {colour, ink, shape, meaning, valid} of a regime of a scene by its name.
export function lookOf(scene, name) {
  const place = scene.regimes.findIndex((one) => one.name === name);
  const found = scene.regimes[place];
  return {
    colour: found?.colour ?? "#888888",
    ink: found?.ink ?? "#444444",
    shape: SHAPES[Math.max(0, place) % SHAPES.length],
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
