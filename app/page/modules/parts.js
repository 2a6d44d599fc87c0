// Parts as they are drawn: by name a title, its length and height in mm, and its outline.

import { drawn } from "./elements.js";

/** @type {Record<string, {title: string, length: number, height: number, shape: string}>} */
export const PARTS = {
  "m4-nut": { title: "M4 nut, 7 × 3.2 mm", length: 7, height: 3.2, shape: "nut" },
  "m4-washer": { title: "M4 washer, 9 × 0.8 mm", length: 9, height: 0.8, shape: "box" },
  "m6-nut": { title: "M6 nut, 10 × 5 mm", length: 10, height: 5, shape: "nut" },
  pin: { title: "Pin, 4 × 20 mm", length: 20, height: 4, shape: "box" },
  box: { title: "Box, 30 × 10 mm", length: 30, height: 10, shape: "box" },
};
export const FIRST_PART = "m4-nut";

const ROUND = /^(sphere|roller|disc)/;

// The part of a view: the lengths of its fields, where it has them, else those of the part that was chosen.
export function partOf(view) {
  const chosen = Object.hasOwn(PARTS, view.part ?? "") ? PARTS[view.part] : PARTS[FIRST_PART];
  const { length, height, diameter } = view.values;
  if (ROUND.test(view.scene)) {
    const size = 1e3 * (diameter ?? 0.008);
    return { title: "Round part", length: size, height: size, shape: "round" };
  }
  const isOwn = view.kind === "simulate" && Boolean(length || diameter);
  if (!isOwn) return view.scene.startsWith("cylinder") ? { ...PARTS.pin } : chosen;
  const long = 1e3 * (length ?? diameter);
  return { title: "My part", length: long, height: 1e3 * (height ?? diameter ?? 0.4 * length), shape: "box" };
}

// A part of so many px, its foot on y = 0 and its middle at x = 0.
export function partDrawn({ shape }, wide, tall, more = {}) {
  const [x, y] = [-wide / 2, -tall];
  const r = Math.min(10, 0.18 * tall);
  if (shape === "round") {
    return drawn("g", more, drawn("circle", { cx: 0, cy: -tall / 2, r: tall / 2, class: "body" }), drawn("line", { x1: 0, x2: 0, y1: -tall / 2, y2: -tall, class: "edge" }));
  }
  const body = drawn("rect", { x, y, width: wide, height: tall, rx: shape === "nut" ? r : Math.min(2, r), class: "body" });
  if (shape !== "nut") return drawn("g", more, body);
  // Two faces of a hexagon, chamfered above and below.
  const arc = (from, up) => `M${from} ${up ? y + 0.16 * tall : -0.16 * tall}Q${from + wide / 4} ${up ? y - 0.1 * tall : 0.1 * tall} ${from + wide / 2} ${up ? y + 0.16 * tall : -0.16 * tall}`;
  const faces = [true, false].flatMap((up) => [x, 0].map((from) => arc(from, up))).join("");
  return drawn("g", more, body, drawn("path", { d: faces, class: "edge" }), drawn("line", { x1: 0, x2: 0, y1: y, y2: 0, class: "edge" }));
}
