// Marks in a map: the chosen point, which is dragged, the best, and drives of a trade-off.

import { FRAME } from "./axes.js";
import { drawn } from "./elements.js";

const SMALL = 3.5; // px
const GRIP = 22; // px around a point that is dragged

// `mark` is {x, y, text, regime, isSmall, isDragged}, `map` has its axes, size and looks of regimes.
export function markDrawn({ x, y, text, regime, isSmall, isDragged, isEnd, to }, map) {
  const cx = map.x.place(x);
  const cy = map.y.place(y);
  if (isSmall) return drawn("circle", { cx, cy, r: SMALL, class: "marker", fill: map.data.look(regime).colour });
  const isRight = cx > map.size.width * 0.7;
  const isHigh = cy < 2 * FRAME.top + 14;
  // The flight from a design to a better one.
  const end = to && [map.x.place(to[map.data.x.name]), map.y.place(to[map.data.y.name])];
  const way = end ? `M${cx} ${cy}Q${(cx + end[0]) / 2} ${Math.min(cy, end[1]) - 26} ${end[0]} ${end[1]}` : "";
  return drawn(
    "g",
    { class: isDragged ? "mark dragged" : "mark" },
    ...(way ? [drawn("path", { d: way, class: "flight-under" }), drawn("path", { d: way, class: "flight-way" })] : []),
    ...(isDragged ? [drawn("circle", { cx, cy, r: GRIP, class: "grip" })] : []),
    drawn("circle", { cx, cy, r: isDragged ? 10 : 6, class: "halo" }),
    drawn("circle", { cx, cy, r: isDragged ? 10 : 6, class: "ring" }),
    ...(isDragged ? [drawn("circle", { cx, cy, r: 1.5, class: "point" })] : []),
    drawn("text", { x: isEnd ? cx : cx + (isRight ? -16 : 16), y: isEnd ? cy - 16 : cy + (isHigh ? 18 : 5), "text-anchor": isEnd ? "middle" : isRight ? "end" : "start", class: "haloed label" }, text),
  );
}
