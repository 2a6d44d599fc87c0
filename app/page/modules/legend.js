// What the colours of a picture mean: the scale of a quantity, and the regimes that occur.

import { ticks } from "./axes.js";
import { drawn, element } from "./elements.js";
import { levelsOf } from "./layers.js";
import { markerDrawn } from "./markers.js";
import { capital, label, number, shown, words } from "./words.js";

const BAR = { width: 260, height: 12, left: 24, ticks: 4, stops: 32 };

// The bar of a scale with its ticks, as a group of 300 x 32.
export function barDrawn({ low, high, lut, steps }, unit) {
  const [factor] = shown(unit);
  const { width, height, left, stops } = BAR;
  const group = drawn("g", { class: "bar" });
  for (let i = 0; i < stops; i++) {
    const at = 3 * Math.round((i / (stops - 1)) * (steps - 1));
    const fill = `rgb(${lut[at]} ${lut[at + 1]} ${lut[at + 2]})`;
    const room = width / stops;
    group.append(drawn("rect", { x: left + i * room, y: 0, width: room + 0.5, height, fill }));
  }
  for (const tick of ticks(low * factor, high * factor, BAR.ticks)) {
    const x = left + ((tick / factor - low) / (high - low)) * width;
    group.append(
      drawn("line", { x1: x, x2: x, y1: height, y2: height + 4, class: "tick" }),
      drawn("text", { x, y: height + 17, "text-anchor": "middle" }, number(tick, 4, high * factor)),
    );
  }
  return group;
}

// What the colours of a scale mean: a bar with ticks, how far contours lie apart, what is cut.
export function scaleTold(range, { name, unit }, values) {
  if (!range) return [`The ${words(name)} has no value anywhere in this picture.`];
  const [factor, unitShown] = shown(unit);
  const { low, high } = range;
  const svg = drawn("svg", { viewBox: "0 0 308 32", width: 308, height: 32, "aria-hidden": "true" }, barDrawn(range, unit));
  const [first, second] = levelsOf(range, unit);
  const lines = [];
  if (second !== undefined) lines.push(`a thin line every ${number((second - first) * factor, 3)}${unitShown && ` ${unitShown}`}`);
  if (low < 0 && high > 0) lines.push("the thick line is 0");
  const [least, largest] = extremes(values);
  // Room for rounding: an end of the scale is a value, too.
  if (least < low - 1e-9 * (high - low) || largest > high + 1e-9 * (high - low)) {
    lines.push(`beyond the ends: ${number(least * factor, 3)} to ${number(largest * factor, 3)}`);
  }
  const spoken = `${label(name, unit)} from ${number(low * factor)} to ${number(high * factor)}`;
  return [
    element("span", {}, label(name, unit)),
    element("span", { role: "img", "aria-label": spoken }, svg),
    element("small", {}, lines.join("; ")),
  ];
}

function extremes(values) {
  let least = Infinity;
  let largest = -Infinity;
  for (const value of values) {
    if (value < least && value > -Infinity) least = value;
    if (value > largest && value < Infinity) largest = value;
  }
  return [least, largest];
}

// The regimes that occur in what is shown, the most frequent first: {value, name, share} and its look.
export function occurring({ regime, x, y }, look) {
  if (!regime) return [];
  const counts = new Map();
  const rows = y ? y.values.length : 1;
  let value; // of the run that is being counted: neighbours are mostly alike
  let run = 0;
  const note = () => run && counts.set(value, (counts.get(value) ?? 0) + run);
  for (let j = 0; j < rows; j++) {
    for (let i = 0; i < x.values.length; i++) {
      const next = regime.at(i, j);
      if (next !== value) {
        note();
        value = next;
        run = 0;
      }
      run += 1;
    }
  }
  note();
  const all = rows * x.values.length;
  return [...counts]
    .sort((a, b) => b[1] - a[1])
    .map(([value, count]) => {
      const name = regime.names[value] ?? "";
      return { value, name, share: count / all, ...look(name) };
    });
}

// Lines of a legend in words.
export function legendOf(found) {
  return found.map((one) => {
    const { name, share, meaning } = one;
    const swatch = drawn("svg", { class: "swatch", viewBox: "-8 -8 16 16", "aria-hidden": "true" });
    swatch.append(markerDrawn(one, 0, 0, 5, { class: "marker" }));
    return element(
      "li",
      { title: meaning },
      swatch,
      `${capital(words(name))} ${number(100 * share, 2)}\u00a0%`,
      meaning ? element("small", {}, ` ${meaning}`) : null,
    );
  });
}
