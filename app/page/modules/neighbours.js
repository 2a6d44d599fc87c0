// What lies about the best, in words and drawn.

import { drawn, element } from "./elements.js";
import { lookOf, markerDrawn } from "./markers.js";
import { capital, number, withUnit, words } from "./words.js";

const CELL = { width: 112, height: 66, left: 34, top: 8 };
const LETTERS = 17; // in a line of a cell
const SAME = 5e-5; // a share that is told as nothing
const UP = ["less", "as much", "more"];

function told({ fall: share, broken, objective }) {
  if (!Number.isFinite(objective)) return "no value";
  if (broken.length) return `breaks ${words(broken[0])}`;
  if (Math.abs(share) < SAME) return "the same";
  return share > 0 ? `${number(100 * share, 2)} % worse` : `${number(-100 * share, 2)} % better`;
}

function directionOf(view, { middle }, i, j) {
  const parts = [];
  if (i !== middle.i) parts.push(`${UP[1 + Math.sign(i - middle.i)]} ${words(view.x.name)}`);
  if (view.y && j !== middle.j) parts.push(`${UP[1 + Math.sign(j - middle.j)]} ${words(view.y.name)}`);
  return parts.join(", ");
}

// Sentences: the steps, and what each direction costs, the worst first.
export function neighboursTold(view, found, units) {
  const { step } = found;
  const all = found.cells.flatMap((row, j) =>
    row.map((cell, i) => ({ ...cell, where: directionOf(view, found, i, j) })).filter(({ isBest }) => !isBest),
  );
  const size = (place) => `${withUnit(step[place], units(view[place].name), 3)} of ${words(view[place].name)}`;
  const worst = all
    .filter(({ objective, broken }) => Number.isFinite(objective) && !broken.length)
    .sort((a, b) => b.fall - a.fall)[0];
  const breaking = all.filter(({ broken }) => broken.length);
  return [
    `One step of the picture is ${size("x")}${view.y ? ` and ${size("y")}` : ""}.`,
    worst && worst.fall >= SAME ? `Of the neighbouring drives that keep the limits the worst is ${told(worst)} (${worst.where}).` : "",
    worst && worst.fall < SAME ? "No neighbouring drive that keeps the limits is worse." : "",
    breaking.length
      ? `${breaking.length} of ${all.length} neighbouring drives break a limit: ${[...new Set(breaking.flatMap((one) => one.broken))].map(words).join(", ")}.`
      : "",
  ].filter(Boolean);
}

// A text over two lines, the second cut where it is long.
function linesOf(text) {
  if (text.length <= LETTERS) return [text];
  const [first, ...rest] = text.split(" ");
  const second = rest.join(" ");
  return [first, second.length > LETTERS ? `${second.slice(0, LETTERS - 1)}\u2026` : second];
}

// The cells about the best, each with what it costs there, and its regime.
export function neighboursDrawn(view, scene, found) {
  const { cells } = found;
  const columns = cells[0].length;
  const { width, height, left, top } = CELL;
  const across = left + columns * width + 4;
  const down = top + cells.length * height + 34;
  const texts = cells.flatMap((row, j) =>
    row.filter(({ isBest }) => !isBest).map((cell) => `${directionOf(view, found, row.indexOf(cell), j)}: ${told(cell)}`),
  );
  const svg = drawn("svg", {
    class: "around",
    role: "img",
    viewBox: `0 0 ${across} ${down}`,
    width: across,
    "aria-label": `Next to the best: ${texts.join("; ")}`,
  });
  cells.forEach((row, j) =>
    row.forEach((cell, i) => {
      const x = left + i * width;
      const y = top + (cells.length - 1 - j) * height;
      const shade = Math.min(0.5, Math.max(0, cell.broken.length ? 0 : cell.fall * 2));
      svg.append(
        drawn("rect", { x, y, width, height, class: cell.isBest ? "cell best" : cell.broken.length ? "cell broken" : "cell" }),
        drawn("rect", { x, y, width, height, class: "fall", "fill-opacity": Number.isFinite(shade) ? shade : 0 }),
        markerDrawn(lookOf(scene, cell.regime), x + width / 2, y + 16, 6, { class: "marker" }),
        ...linesOf(cell.isBest ? "the best" : told(cell)).map((line, place) =>
          drawn("text", { x: x + width / 2, y: y + 42 + 15 * place, "text-anchor": "middle" }, line),
        ),
      );
    }),
  );
  svg.append(
    drawn("text", { x: left + (columns * width) / 2, y: down - 10, "text-anchor": "middle" }, `${capital(words(view.x.name))} \u2192`),
  );
  if (view.y) {
    const middle = top + (cells.length * height) / 2;
    svg.append(
      drawn("text", { transform: `translate(18 ${middle}) rotate(-90)`, "text-anchor": "middle" }, `${capital(words(view.y.name))} \u2192`),
    );
  }
  return svg;
}

// A list: what the criterion makes of the best where something is otherwise than thought.
export function bandTold({ name, values, places }, unit) {
  const worst = places.reduce((a, b) => (b.fall > a.fall ? b : a));
  return [
    element(
      "p",
      {},
      Number.isFinite(worst.fall)
        ? `Within the band of the ${words(name)} this drive gets at most ${number(100 * Math.max(0, worst.fall), 2)} % worse.`
        : `Somewhere within the band of the ${words(name)} this drive has no value.`,
    ),
    element(
      "ul",
      { class: "band" },
      ...places.map((one, place) => {
        const bar = element("span", { class: "share" });
        bar.style.width = `${Math.max(0, Math.min(1.5, 1 - one.fall)) * 8 || 0}rem`;
        return element("li", {}, element("span", {}, `${capital(words(name))} ${withUnit(values[place], unit, 3)}`), bar, element("span", {}, told(one)));
      }),
    ),
  ];
}
