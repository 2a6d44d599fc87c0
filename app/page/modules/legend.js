// What the colours of a picture mean: the scale of a quantity, and the regimes that occur.

import { drawn, element } from "./elements.js";
import { levelsOf } from "./layers.js";
import { markerDrawn } from "./markers.js";
import { capital, label, number, shown, words } from "./words.js";

// A bar of the colours of a scale, between the values at its ends, and how far contours lie apart.
export function scaleTold(range, { name, unit }) {
  if (!range) return [`No ${words(name)} has a value here.`];
  const [factor, unitShown] = shown(unit);
  const { low, high, lut, steps } = range;
  const stops = Array.from({ length: 9 }, (_, i) => {
    const at = 3 * Math.round((i / 8) * (steps - 1));
    return `rgb(${lut[at]} ${lut[at + 1]} ${lut[at + 2]})`;
  });
  const bar = element("span", { class: "bar" });
  bar.style.background = `linear-gradient(to right, ${stops.join(",")})`;
  const [first, second] = levelsOf(range, unit);
  const apart = number((second - first) * factor, 3);
  return [
    element("span", {}, label(name, unit)),
    element(
      "span",
      { class: "ends" },
      number(low * factor, 4, high * factor),
      bar,
      number(high * factor, 4, low * factor),
    ),
    second === undefined ? "" : element("small", {}, `a thin line every ${apart}${unitShown && ` ${unitShown}`}`),
  ];
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
