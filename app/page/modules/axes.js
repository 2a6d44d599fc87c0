// Axes of a picture: where ticks stand, and what they say.

import { drawn } from "./elements.js";
import { label, number, shown } from "./words.js";

export const { ticks } = /** @type {any} */ (window).d3;

export const FRAME = { left: 52, right: 12, top: 10, bottom: 42 };

const FAR = 1e6; // px: beyond all screens, and a number that a picture takes

// A linear axis from the ends of a quantity to places on the screen.
export function axisOf({ name, unit, values }, from, to) {
  const [factor, unitShown] = shown(unit);
  const first = values[0];
  const last = values[values.length - 1];
  const span = last - first || 1;
  return {
    name,
    unit,
    unitShown,
    factor,
    first,
    last,
    place: (value) => Math.max(-FAR, Math.min(FAR, from + ((value - first) / span) * (to - from))),
    value: (place) => first + ((place - from) / (to - from)) * span,
    ticks: (count) => ticks(Math.min(first, last) * factor, Math.max(first, last) * factor, count),
    label: label(name, unit),
  };
}

// The lines, ticks and labels of two axes around a picture.
export function axesDrawn(x, y, width, height) {
  const { left, right, top, bottom } = FRAME;
  const group = drawn("g", { class: "axes" });
  group.append(
    drawn("rect", {
      x: left, y: top, width: width - left - right, height: height - top - bottom, class: "frame",
    }),
  );
  const acrossCount = Math.max(2, Math.floor((width - left - right) / 90));
  for (const tick of x.ticks(acrossCount)) {
    const at = x.place(tick / x.factor);
    group.append(
      drawn("line", { x1: at, x2: at, y1: height - bottom, y2: height - bottom + 5 }),
      drawn("text", { x: at, y: height - bottom + 18, "text-anchor": "middle" }, number(tick)),
    );
  }
  const upCount = Math.max(2, Math.floor((height - top - bottom) / 50));
  for (const tick of y.ticks(upCount)) {
    const at = y.place(tick / y.factor);
    group.append(
      drawn("line", { x1: left - 5, x2: left, y1: at, y2: at }),
      drawn("text", { x: left - 8, y: at + 4, "text-anchor": "end" }, number(tick)),
    );
  }
  group.append(
    drawn(
      "text",
      { x: (left + width - right) / 2, y: height - 6, "text-anchor": "middle", class: "pale" },
      x.label,
    ),
    drawn(
      "text",
      {
        transform: `translate(12 ${(top + height - bottom) / 2}) rotate(-90)`,
        "text-anchor": "middle",
        class: "pale",
      },
      y.label,
    ),
  );
  return group;
}
