// Names of regimes in a map: each in the middle of the widest place that its regime has.

import { drawn } from "./elements.js";

const LETTER = { wide: 7, tall: 20 }; // px, of a name
const RING = 10; // px, around a marked point
const FITS = 0.5; // of the name's own size, from its middle to the next border

export function namesDrawn({ data, x, y }, regimes) {
  const group = drawn("g", { class: "names" });
  if (regimes.length < 2) return group;
  const texts = new Map(regimes.map(({ value, said }) => [value, said]));
  for (const [value, { room, i, j }] of widest({ data, x, y }, texts)) {
    if (room < FITS) continue;
    const place = { x: x.place(data.x.values[i]), y: y.place(data.y.values[j]) + 4 };
    group.append(drawn("text", { ...place, "text-anchor": "middle" }, texts.get(value)));
  }
  return group;
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

// The place of each regime with the most room around it: {room, i, j} by value.
// Room is the way to the next border, sideways in widths of the name and up in its heights.
function widest({ data, x, y }, texts) {
  const nx = data.x.values.length;
  const ny = data.y.values.length;
  const values = new Int32Array(nx * ny);
  for (let j = 0; j < ny; j++) for (let i = 0; i < nx; i++) values[j * nx + i] = data.regime.at(i, j);
  const up = Math.abs(y.place(y.last) - y.place(y.first)) / Math.max(1, ny - 1) / LETTER.tall;
  const wide = Math.abs(x.place(x.last) - x.place(x.first)) / Math.max(1, nx - 1) / LETTER.wide;
  const across = new Map([...texts].map(([value, text]) => [value, wide / text.length]));
  const room = new Float64Array(nx * ny).fill(Infinity);
  const narrow = (i, j, di, dj) => {
    const at = j * nx + i;
    const isInside = i + di >= 0 && i + di < nx && j + dj >= 0 && j + dj < ny;
    const next = at + dj * nx + di;
    const beyond = isInside && values[next] === values[at] ? room[next] : 0;
    const step = di && dj ? Math.max(up, across.get(values[at])) : di ? across.get(values[at]) : up;
    room[at] = Math.min(room[at], isInside ? beyond + step : 0);
  };
  // Once from the first corner and once from the last one: each way there is made of such steps.
  const found = new Map();
  for (let j = 0; j < ny; j++) {
    for (let i = 0; i < nx; i++) for (const [di, dj] of BEFORE) narrow(i, j, di, dj);
  }
  for (let j = ny - 1; j >= 0; j--) {
    for (let i = nx - 1; i >= 0; i--) {
      for (const [di, dj] of BEFORE) narrow(i, j, -di, -dj);
      const at = j * nx + i;
      if (room[at] > (found.get(values[at])?.room ?? 0)) found.set(values[at], { room: room[at], i, j });
    }
  }
  return found;
}

const BEFORE = [[-1, 0], [-1, -1], [0, -1], [1, -1]];
