// A plate seen from above: its moves, arrows of the velocity at each place, and whether they gather parts.

import { drawn, fill } from "./elements.js";
import { button } from "./fields.js";

const MOST = 13; // arrows along an axis
const LEAST = 0.1; // of the longest arrow
const HEAD = 5; // px
const NONE = 0.05; // of the largest speed a plate's width: less neither gathers nor spreads
const TILT = 0.02; // degrees

const still = { amplitude_normal_1: 0, amplitude_tilt_x_1: 0, amplitude_tilt_y_1: 0 };
const tilted = (phase_tilt_x_1, phase_tilt_y_1) => ({ ...still, amplitude_tilt_x_1: TILT, phase_tilt_x_1, amplitude_tilt_y_1: TILT, phase_tilt_y_1 });

// The moves of docs/plate.md, on a circle of the plate: by their titles what they set.
const MOVES = {
  Convey: { ...still, amplitude_normal_1: 4e-5, phase_normal_1: -17 },
  Centre: tilted(119, 29),
  Spread: tilted(-61, -151),
  Swirl: tilted(-151, 119),
};

export function tellMoves(host, { values }, onmove) {
  const isSet = (move) => Object.entries(move).every(([name, value]) => values[name] === value);
  fill(host, ...Object.entries(MOVES).map(([title, move]) => button(title, () => onmove(move), { class: "chip", "aria-pressed": String(isSet(move)) })));
}

// Some places on the screen along an axis, at equal distances, with the nearest of its values.
function placesOf({ values }, { first, last, place }) {
  return Array.from({ length: MOST }, (_, k) => {
    const share = (k + 0.5) / MOST;
    return { at: place(first + share * (last - first)), nearest: Math.round(share * (values.length - 1)) };
  });
}

// Arrows of the velocity over a map of a plate.
export function arrowsDrawn({ data: { x, y, field }, x: across, y: up }) {
  if (!field) return null;
  const [columns, rows] = [placesOf(x, across), placesOf(y, up)];
  const arrows = rows.flatMap((row) => columns.map((column) => ({ x: column.at, y: row.at, velocity: [field.x, field.y].map((read) => read(column.nearest, row.nearest)) })));
  const speeds = arrows.map(({ velocity }) => Math.hypot(...velocity));
  const largest = Math.max(...speeds.filter(Number.isFinite), 0);
  const room = Math.abs(columns[1].at - columns[0].at);
  const path = arrows.map((arrow, k) => (speeds[k] > LEAST * largest ? arrowPath(arrow, (0.9 * room * speeds[k]) / largest) : "")).join("");
  return drawn("g", { class: "arrows" }, drawn("path", { d: path, class: "halo" }), drawn("path", { d: path, class: "arrow" }));
}

// An arrow of so many px about its middle.
/** @param {any} arrow @param {number} long */
function arrowPath({ x, y, velocity: [vx, vy] }, long) {
  const angle = Math.atan2(-vy, vx);
  const at = (far, turn = 0) => [Math.cos(angle + turn) * far, Math.sin(angle + turn) * far];
  const [[dx, dy], [lx, ly], [rx, ry]] = [at(long / 2), at(-HEAD, 0.5), at(-HEAD, -0.5)];
  const told = (...points) => points.map((one) => one.toFixed(1)).join(" ");
  return `M${told(x - dx, y - dy)}L${told(x + dx, y + dy)}M${told(x + dx + lx, y + dy + ly)}L${told(x + dx, y + dy)}L${told(x + dx + rx, y + dy + ry)}`;
}

// What a field does to parts: the mean divergence, from what crosses the edges of the map.
export function gathersTold({ x, y, field }) {
  const [nx, ny] = [x.values.length, y.values.length];
  const mean = (list) => list.reduce((sum, one) => sum + one, 0) / list.length;
  const rows = Array.from({ length: ny }, (_, j) => field.x(nx - 1, j) - field.x(0, j));
  const columns = Array.from({ length: nx }, (_, i) => field.y(i, ny - 1) - field.y(i, 0));
  const outwards = mean(rows) + mean(columns);
  const largest = Math.max(...Array.from({ length: ny }, (_, j) => Math.max(...Array.from({ length: nx }, (__, i) => Math.hypot(field.x(i, j), field.y(i, j))))));
  if (!(Math.abs(outwards) > NONE * largest)) return "";
  return outwards > 0 ? "the plate spreads parts" : "the plate gathers parts";
}
