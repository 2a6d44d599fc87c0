// Marks in a map: the chosen point, which is dragged, the best, and drives of a trade-off.

import { FRAME } from "./axes.js";
import { drawn } from "./elements.js";
import { markerDrawn } from "./markers.js";

const SMALL = 3.5; // px
const GRIP = 22; // px around a point that is dragged

// `mark` is {x, y, text, regime, isSmall, isDragged}, `map` has its axes, size and looks of regimes.
export function markDrawn({ x, y, text, regime, isSmall, isDragged }, map) {
  const cx = map.x.place(x);
  const cy = map.y.place(y);
  if (isSmall) return markerDrawn(map.data.look(regime), cx, cy, SMALL, { class: "marker" });
  const isRight = cx > map.size.width * 0.7;
  const isHigh = cy < 2 * FRAME.top + 14;
  return drawn(
    "g",
    { class: isDragged ? "mark dragged" : "mark" },
    ...(isDragged ? [drawn("circle", { cx, cy, r: GRIP, class: "grip" })] : []),
    drawn("circle", { cx, cy, r: 7, class: "halo" }),
    drawn("circle", { cx, cy, r: 7, class: "ring" }),
    drawn(
      "text",
      { x: cx + (isRight ? -11 : 11), y: cy + (isHigh ? 18 : -8), "text-anchor": isRight ? "end" : "start" },
      text,
    ),
  );
}
