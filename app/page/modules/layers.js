// What lies over each other in a map: colours, contours, borders of regimes.
// A `ground` is {data, flat, range, x, y}: what is drawn, its values row by row, the scale of their colours, and the axes
// on the screen.

import { FRAME } from "./axes.js";
import { drawn } from "./elements.js";
import { bandOf } from "./colours.js";

const { blur2, contours } = /** @type {any} */ (window).d3;

const BLUR = 2; // cells: borders lose their steps
const FEW = 50; // values of an axis, for lines that move

// The colours of the values, in the dots of the screen: between values as straight lines go, so that the steps of
// the scale end along smooth lines; values that are `isRough` stay blocks.
export function paint(canvas, { data, flat, range, isRough }, wide, tall) {
  const [nx, ny] = [data.x.values.length, data.y.values.length];
  Object.assign(canvas, { width: wide, height: tall });
  const context = canvas.getContext("2d");
  const image = context.createImageData(wide, tall);
  const dots = new Uint32Array(image.data.buffer);
  const inks = range?.bands.map(([r, g, b]) => (255 << 24) | (b << 16) | (g << 8) | r) ?? [];
  const across = placesOf(wide, nx, isRough);
  const up = placesOf(tall, ny, isRough);
  for (let row = 0; range && row < tall; row++) {
    const { low, part } = up[tall - 1 - row];
    const below = low * nx;
    const above = Math.min(ny - 1, low + 1) * nx;
    for (let column = 0; column < wide; column++) {
      const { low: left, part: share } = across[column];
      const right = left + 1 < nx ? left + 1 : left;
      let value = (flat[below + left] * (1 - share) + flat[below + right] * share) * (1 - part) + (flat[above + left] * (1 - share) + flat[above + right] * share) * part;
      if (value !== value) value = flat[(part > 0.5 ? above : below) + (share > 0.5 ? right : left)]; // beside one without
      if (value === value) dots[row * wide + column] = inks[bandOf(range, value)];
    }
  }
  context.putImageData(image, 0, 0);
}

// Of each dot along an axis: the value below it, and how far it is on the way to the next.
function placesOf(dots, count, isRough) {
  return Array.from({ length: dots }, (_, k) => {
    const at = ((k + 0.5) / dots) * (count - 1);
    const low = isRough ? Math.round(at) : Math.min(count - 1, Math.floor(at));
    return { low, part: isRough ? 0 : at - low };
  });
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

export function clipDrawn(width, height) {
  const { left, right, top, bottom } = FRAME;
  const [wide, tall] = [width - left - right, height - top - bottom].map((side) => Math.max(0, side - 2));
  return drawn("clipPath", { id: "inside" }, drawn("rect", { x: left + 1, y: top + 1, width: wide, height: tall }));
}

// Lines over what does not describe a real part, so that its colours are not read as speeds.
export function hatchDrawn({ data, x, y }, regimes) {
  const invalid = new Set(regimes.filter(({ valid }) => !valid).map(({ value }) => value));
  const group = drawn("g", { class: "hatch", "clip-path": "url(#inside)" });
  if (!invalid.size || !data.z.isJudged) return group; // such as a throw number, which always holds
  const area = ringsAround(data, (value) => invalid.has(value));
  group.append(
    drawn(
      "pattern",
      { id: "hatched", width: 8, height: 8, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" },
      drawn("rect", { width: 8, height: 8, class: "haze" }),
      drawn("line", { x1: 0, y1: 0, x2: 0, y2: 8, class: "stripe" }),
    ),
    drawn("path", { d: path(area, data, x, y), fill: "url(#hatched)" }),
  );
  return group;
}

// Borders of the regimes of a list: of two neighbours one draws the line between them.
export function bordersDrawn({ data, x, y }, regimes) {
  const group = drawn("g", { class: "borders", "clip-path": "url(#inside)" });
  for (const { value } of regimes.slice(1)) {
    const area = ringsAround(data, (one) => one === value);
    const d = path(area, data, x, y);
    // A pale line below it: it is seen on dark colours, too.
    group.append(drawn("path", { d, class: "halo" }), drawn("path", { d, class: "border" }));
  }
  return group;
}

// Rings around the cells whose regime is in, as polygons.
export function ringsAround({ x, y, regime }, isIn) {
  const [width, height] = [x.values.length, y.values.length];
  const data = Float64Array.from({ length: width * height }, (_, k) => (isIn(regime.at(k % width, Math.floor(k / width))) ? 1 : 0));
  blur2({ data, width, height }, BLUR);
  return contours().size([width, height]).thresholds([0.5])(data)[0].coordinates;
}

function path(polygons, data, x, y) {
  const parts = [];
  for (const polygon of polygons) {
    for (const ring of polygon) {
      // d3 puts the value of a cell into its middle.
      const points = ring.map(([i, j]) => `${placed(x, data.x.values, i - 0.5).toFixed(1)},${placed(y, data.y.values, j - 0.5).toFixed(1)}`);
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
