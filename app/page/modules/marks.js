// Marks in a map: the chosen point, which is dragged, the best, and drives of a trade-off; and names of regimes, each where
// its regime reaches farthest, in the middle.

import { FRAME } from "./axes.js";
import { drawn } from "./elements.js";

const SMALL = 3.5; // px
const GRIP = 22; // px around a point that is dragged
const LETTER = { wide: 10, tall: 20 }; // px, of a name
const RING = 10; // px, around a marked point
const LEAST = 0.02; // of the map, of a regime with a name

// `mark` is {x, y, text, regime, isSmall, isDragged}, `map` has its axes, size and looks of regimes.
export function markDrawn({ x, y, text, regime, isSmall, isDragged, isEnd, to }, map) {
  const cx = map.x.place(x);
  const cy = map.y.place(y);
  if (isSmall) return drawn("circle", { cx, cy, r: SMALL, class: "marker", fill: map.data.look(regime).colour });
  const isRight = cx > map.size.width * 0.7;
  const isHigh = cy < 2 * FRAME.top + 14;
  const isAbove = isEnd || (isRight && !isHigh);
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
    drawn("text", { x: isAbove ? cx + (isRight ? 10 : 0) : cx + (isRight ? -16 : 16), y: isAbove ? cy - 16 : cy + (isHigh ? 18 : 5), "text-anchor": isRight ? "end" : isEnd ? "middle" : "start", class: "haloed label" }, text),
  );
}

export function namesDrawn({ data, x, y }, regimes) {
  const group = drawn("g", { class: "names" });
  if (regimes.length < 2) return group;
  for (const { value, said, share } of regimes) {
    if (share < LEAST) continue;
    const { i, j, wide } = longestRun(data, value);
    const place = { x: x.place(data.x.values[i]), y: y.place(data.y.values[j]) + 4 };
    const room = (wide * Math.abs(x.place(x.last) - x.place(x.first))) / data.x.values.length;
    if (room > LETTER.wide * said.length) group.append(drawn("text", { ...place, "text-anchor": "middle" }, said));
  }
  return group;
}

// The middle of the longest run of a regime along a row, of rows that are no nearer to the frame: {i, j, wide}; up or down
// it stands in the middle, where it is as wide there.
function longestRun({ x, y, regime }, value) {
  let best = { i: 0, j: 0, wide: 0, rank: -Infinity };
  const [nx, ny] = [x.values.length, y.values.length];
  for (let j = 0; j < ny; j++) {
    const aside = (Math.abs(j / ny - 0.5) * nx) / 2;
    let run = 0;
    for (let i = 0; i < nx; i++) {
      run = regime.at(i, j) === value ? run + 1 : 0;
      if (run && run - aside > best.rank) best = { i: i - Math.floor(run / 2), j, wide: run, rank: run - aside };
    }
  }
  let [low, high] = [best.j, best.j];
  while (low > 0 && regime.at(best.i, low - 1) === value) low -= 1;
  while (high < ny - 1 && regime.at(best.i, high + 1) === value) high += 1;
  const [middle, half] = [Math.round((low + high) / 2), Math.floor(best.wide / 4)];
  const isWide = [-half, half].every((aside) => regime.at(best.i + aside, middle) === value);
  return { ...best, j: isWide ? middle : best.j };
}

// A name that a ring, of [x, y], would stand on gives way to it, up or down.
export function giveWay(group, rings) {
  const room = 0.5 * LETTER.tall + RING;
  for (const text of group.children) {
    const [x, y] = [Number(text.getAttribute("x")), Number((text.dataset.y ??= text.getAttribute("y")))];
    const half = 0.5 * LETTER.wide * text.textContent.length + RING;
    const ring = rings.find(([across, up]) => Math.abs(across - x) < half && Math.abs(up + 4 - y) < room);
    text.setAttribute("y", ring ? ring[1] + 4 + (ring[1] + 4 > y ? -room : room) : y);
  }
}
