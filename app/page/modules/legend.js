// What the colours of a picture mean: the scale of a quantity, and the regimes that occur.

import { drawn, element } from "./elements.js";
import { capital, label, number, shown, words } from "./words.js";

const { extent, ticks } = /** @type {any} */ (window).d3;
const BAR = { width: 340, height: 15, left: 12, ticks: 4 };
const SIGNED = new Set(["conveying_velocity", "drift_velocity"]);

// The bar of a scale with its ticks, as a group of 364 x 50.
export function barDrawn({ low, high, bands }, { name, unit }) {
  const [factor, unitShown] = shown(unit);
  const { width, height, left } = BAR;
  const group = drawn("g", { class: "bar" });
  const room = width / bands.length;
  bands.forEach(([r, g, b], i) => group.append(drawn("rect", { x: left + i * room, y: 0, width: room + 0.4, height, fill: `rgb(${r} ${g} ${b})` })));
  group.append(drawn("rect", { x: left, y: 0, width, height, class: "frame" }));
  const place = (value) => left + ((value - low) / (high - low)) * width;
  for (const tick of ticks(low * factor, high * factor, BAR.ticks)) {
    const x = place(tick / factor);
    group.append(
      drawn("line", { x1: x, x2: x, y1: height, y2: height + 4, class: "tick" }),
      drawn("text", { x, y: height + 17, "text-anchor": "middle" }, number(tick, 4, high * factor)),
    );
  }
  const zero = place(Math.max(low, Math.min(0, high)));
  const said = (x, anchor, text) => group.append(drawn("text", { x, y: height + 33, "text-anchor": anchor, class: "pale" }, text));
  if (SIGNED.has(name) && low < 0 && high > 0) {
    const at = Math.max(left + 66, Math.min(left + width - 110, zero));
    said(at - 6, "end", "backwards");
    said(at + 8, "start", `forwards, ${unitShown}`);
  } else said(left, "start", label(name, unit));
  return group;
}

// What the colours of a scale mean: a bar with ticks, and what is cut.
export function scaleTold(range, { name, unit }, values) {
  if (!range) return [`The ${words(name)} has no value anywhere in this picture.`];
  const [factor] = shown(unit);
  const { low, high, step } = range;
  const svg = drawn("svg", { viewBox: "0 0 364 52", class: "scale-bar", "aria-hidden": "true" }, barDrawn(range, { name, unit }));
  const [least, largest] = extent(values, (value) => (Number.isFinite(value) ? value : NaN));
  const isCut = least < low - step || largest > high + step;
  const spoken = `${label(name, unit)} from ${number(low * factor)} to ${number(high * factor)}`;
  return [
    element("span", { role: "img", "aria-label": spoken }, svg),
    isCut ? element("small", {}, `beyond the ends: ${number(least * factor, 3)} to ${number(largest * factor, 3)}`) : null,
  ].filter(Boolean);
}

// The regimes that occur in what is shown, the most frequent first: {value, name, share} and its look.
export function occurring({ regime, x, y }, look) {
  if (!regime) return [];
  const counts = [];
  const [across, up] = [x.values.length, y ? y.values.length : 1];
  for (let j = 0; j < up; j++) {
    for (let i = 0; i < across; i++) {
      const value = regime.at(i, j);
      counts[value] = (counts[value] ?? 0) + 1;
    }
  }
  const named = Object.entries(counts).map(([value, count]) => ({ value: Number(value), name: regime.names[value] ?? "", share: count / (across * up) }));
  return named.sort((one, other) => other.share - one.share).map((one) => ({ ...one, ...look(one.name) }));
}

// Lines of a legend in words.
export function legendOf(found) {
  return found.map((one) => {
    const { name, share, meaning } = one;
    const swatch = element("i", { class: "swatch regime" });
    swatch.style.background = one.colour;
    return element(
      "li",
      { title: meaning },
      swatch,
      `${capital(words(name))} ${number(100 * share, 2)}\u00a0%`,
      meaning ? element("small", {}, ` ${meaning}`) : null,
    );
  });
}

// In a map: regimes with the same word are one area.
const SAID = { stick: "slides", slip: "slides", stick_slip: "slides", hopping: "hops", hop_after_hop: "hops", period_doubled: "hops", aperiodic: "hops" };

// {said, colour, meaning, valid} of a regime of a scene by its name.
export function lookOf(scene, name) {
  const found = scene.regimes.find((one) => one.name === name);
  return { said: SAID[name] ?? words(name), colour: found?.colour ?? "#888888", meaning: found?.description ?? "", valid: found?.valid ?? true };
}
