// Axes of a picture: where ticks stand, and what they say.

import { drawn } from "./elements.js";
import { label, number, shown } from "./words.js";

const { ticks } = /** @type {any} */ (window).d3;

export const FRAME = { left: 64, right: 12, top: 10, bottom: 42 };

const FAR = 1e6; // px: beyond all screens, and a number that a picture takes

// A linear axis from the ends of a quantity to places on the screen.
export function axisOf({ name, unit, values, title = label(name, unit) }, from, to) {
  const [factor] = shown(unit);
  const [first, last] = [values[0], values[values.length - 1]];
  const span = last - first || 1;
  return {
    factor,
    first,
    last,
    place: (value) => Math.max(-FAR, Math.min(FAR, from + ((value - first) / span) * (to - from))),
    value: (place) => first + ((place - from) / (to - from)) * span,
    ticks: (count) => ticks(Math.min(first, last) * factor, Math.max(first, last) * factor, Math.max(2, Math.floor(count))),
    label: title,
  };
}

// The lines, ticks and labels of two axes around a picture.
export function axesDrawn(x, y, width, height) {
  const { left, right, top } = FRAME;
  const [wide, tall] = [width - left - right, height - top - FRAME.bottom];
  const floor = top + tall;
  const line = (x1, y1, x2, y2) => drawn("line", { x1, y1, x2, y2 });
  const text = (told, more) => drawn("text", { "text-anchor": "middle", ...more }, told);
  const across = x.ticks(wide / 90).flatMap((tick) => {
    const at = x.place(tick / x.factor);
    return [line(at, floor, at, floor + 5), text(number(tick), { x: at, y: floor + 18 })];
  });
  const up = y.ticks(tall / 50).flatMap((tick) => {
    const at = y.place(tick / y.factor);
    return [line(left - 5, at, left, at), text(number(tick), { x: left - 8, y: at + 4, "text-anchor": "end" })];
  });
  return drawn(
    "g",
    { class: "axes" },
    drawn("rect", { x: left, y: top, width: wide, height: tall, class: "frame" }),
    ...across,
    ...up,
    text(x.label, { x: left + wide / 2, y: height - 6, class: "pale" }),
    text(y.label, { transform: `translate(12 ${top + tall / 2}) rotate(-90)`, class: "pale" }),
  );
}
