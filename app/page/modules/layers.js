// What lies over each other in a map: colours, contours, borders of regimes.
// A `ground` is {data, flat, range, x, y, clipId, edges}: what is drawn, its values row by row, the scale of
// their colours, the axes on the screen, the name of the area that the layers keep within, and regimes
// between its cells, or null.

import { FRAME } from "./axes.js";
import { ringsAround } from "./borders.js";
import { drawn } from "./elements.js";
import { shown } from "./words.js";

const { contours, ticks } = /** @type {any} */ (window).d3;
const LEVELS = 10;
const FEW = 50; // values of an axis, for lines that move

// One point of the canvas a value: the browser enlarges it.
export function paint(canvas, { data, flat, range }) {
  const nx = data.x.values.length;
  const ny = data.y.values.length;
  if (canvas.width !== nx) canvas.width = nx;
  if (canvas.height !== ny) canvas.height = ny;
  const context = canvas.getContext("2d");
  const image = context.createImageData(nx, ny);
  if (range) {
    const factor = (range.steps - 1) / (range.high - range.low);
    const { lut } = range;
    for (let j = 0; j < ny; j++) {
      for (let i = 0; i < nx; i++) {
        const value = flat[j * nx + i];
        const to = 4 * ((ny - 1 - j) * nx + i);
        if (value !== value) continue; // transparent: it has no value there
        let at = Math.round((value - range.low) * factor);
        at = 3 * (at < 0 ? 0 : at >= range.steps ? range.steps - 1 : at);
        image.data[to] = lut[at];
        image.data[to + 1] = lut[at + 1];
        image.data[to + 2] = lut[at + 2];
        image.data[to + 3] = 255;
      }
    }
  }
  context.putImageData(image, 0, 0);
}

// The same ground with fewer values, the first and the last of each axis among them.
export function thinned(ground) {
  const { data, flat } = ground;
  const [across, up] = [data.x, data.y].map(({ values }) => placesAmong(values.length));
  const some = new Float64Array(across.length * up.length);
  let at = 0;
  for (const j of up) for (const i of across) some[at++] = flat[j * data.x.values.length + i];
  const { regime } = data;
  return {
    ...ground,
    edges: null, // they are of all values
    flat: some,
    data: {
      ...data,
      x: { ...data.x, values: across.map((i) => data.x.values[i]) },
      y: { ...data.y, values: up.map((j) => data.y.values[j]) },
      regime: regime && { ...regime, at: (i, j) => regime.at(across[i], up[j]) },
    },
  };
}

function placesAmong(count) {
  const few = Math.min(FEW, count);
  return Array.from({ length: few }, (_, k) => Math.round((k * (count - 1)) / Math.max(1, few - 1)));
}

export function clipDrawn(clipId, width, height) {
  const { left, right, top, bottom } = FRAME;
  return drawn(
    "clipPath",
    { id: clipId },
    drawn("rect", {
      x: left + 1,
      y: top + 1,
      width: Math.max(0, width - left - right - 2),
      height: Math.max(0, height - top - bottom - 2),
    }),
  );
}

// The values at which contours are drawn.
export function levelsOf({ low, high }, unit) {
  const [factor] = shown(unit);
  return ticks(low * factor, high * factor, LEVELS).map((level) => level / factor);
}

// Lines over what does not describe a real part, so that its colours are not read as speeds.
export function hatchDrawn({ data, x, y, clipId, edges }, regimes) {
  const invalid = new Set(regimes.filter(({ valid }) => !valid).map(({ value }) => value));
  const group = drawn("g", { class: "hatch", "clip-path": `url(#${clipId})` });
  if (!invalid.size || !data.z.isJudged) return group; // such as a throw number, which always holds
  const area = ringsAround(gridOf(data), (value) => invalid.has(value), edges);
  const id = `${clipId}-hatch`;
  group.append(
    drawn(
      "pattern",
      { id, width: 8, height: 8, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" },
      drawn("rect", { width: 8, height: 8, class: "haze" }),
      drawn("line", { x1: 0, y1: 0, x2: 0, y2: 8, class: "stripe" }),
    ),
    drawn("path", { d: path(area, data, x, y), fill: `url(#${id})` }),
  );
  return group;
}

export function contoursDrawn({ data, flat, range, x, y, clipId }) {
  const group = drawn("g", { class: "contours", "clip-path": `url(#${clipId})` });
  if (!range) return group;
  const { low, high } = range;
  const levels = levelsOf(range, data.z.unit);
  const found = contours().size([data.x.values.length, data.y.values.length]).thresholds(levels)(flat);
  for (const level of found) {
    if (!level.coordinates.length) continue;
    const isZero = Math.abs(level.value) < 1e-12 * (high - low);
    group.append(
      drawn("path", { d: path(level.coordinates, data, x, y), class: isZero ? "zero" : "contour" }),
    );
  }
  return group;
}

// Borders of the regimes of a list: of two neighbours one draws the line between them.
export function bordersDrawn({ data, x, y, clipId, edges }, regimes) {
  const group = drawn("g", { class: "borders", "clip-path": `url(#${clipId})` });
  for (const { value, ink } of regimes.slice(1)) {
    const area = ringsAround(gridOf(data), (one) => one === value, edges);
    const d = path(area, data, x, y);
    // A pale line below it: dark colours are seen on dark ones, too.
    group.append(drawn("path", { d, class: "halo" }), drawn("path", { d, class: "border", stroke: ink }));
  }
  return group;
}

function gridOf({ x, y, regime }) {
  return { nx: x.values.length, ny: y.values.length, at: regime.at };
}

function path(polygons, data, x, y) {
  const parts = [];
  for (const polygon of polygons) {
    for (const ring of polygon) {
      const points = ring.map(
        // d3 puts the value of a cell into its middle
        ([i, j]) =>
          `${placed(x, data.x.values, i - 0.5).toFixed(1)},${placed(y, data.y.values, j - 0.5).toFixed(1)}`,
      );
      parts.push(`M${points.join("L")}Z`);
    }
  }
  return parts.join("");
}

// From places among the values of an axis to places on the screen: values may be unevenly spaced.
function placed(axis, values, at) {
  // Half a cell beyond the first and the last value: what ends there has no line along the frame.
  const low = Math.max(0, Math.min(values.length - 2, Math.floor(at)));
  const high = Math.min(values.length - 1, low + 1);
  return axis.place(values[low] + (at - low) * (values[high] - values[low]));
}
