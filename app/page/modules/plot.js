// A picture with two axes: its box, a cursor by pointer and keys, and a sentence on what the cursor meets.

import { FRAME } from "./axes.js";
import { arrowOf, drawn, element, fill } from "./elements.js";
import { barDrawn } from "./legend.js";
import { capital, number, words } from "./words.js";

const { leastIndex } = /** @type {any} */ (window).d3;

export class Plot {
  /**
   * `onpick({x, y})` hears of a point that is clicked, or where Enter is pressed.
   * @param {HTMLElement} host
   * @param {{onpick: Function, name: string, label: string, after?: any[]}} options
   */
  constructor(host, { onpick, name, label, after = [] }) {
    this.onpick = onpick;
    this.svg = drawn("svg", { "aria-hidden": "true", preserveAspectRatio: "none" });
    this.said = element("p", { class: "said", "aria-live": "polite" });
    this.box = element(
      "div",
      {
        class: name,
        tabindex: "0",
        role: "application",
        "aria-label": `${label} move the cursor, Enter chooses the point`,
        onpointermove: (event) => this.x && this.point(event),
        onpointerleave: () => this.box !== document.activeElement && this.move(null),
        onclick: (event) => this.x && this.pick(event),
        onkeydown: (event) => this.x && this.press(event),
      },
      this.svg,
    );
    fill(host, this.box, ...after, this.said);
    this.data = null;
    this.cursor = null; // {x, y}, values of the axes: the next picture may have other cells
    this.marks = {}; // by who sets them
    this.regimes = [];
    this.x = null; // axes
    this.y = null;
    this.size = null; // of the box: to ask for it in each frame has the page laid out anew
    const resize = () => {
      this.size = null;
      this.redraw();
    };
    new ResizeObserver(() => requestAnimationFrame(resize)).observe(this.box);
  }

  draw() {}

  redraw() {
    this.size ??= { width: this.box.clientWidth, height: this.box.clientHeight };
    if (!this.data || this.size.width < 80 || this.size.height < 80) return;
    this.draw();
    this.move(this.cursor);
  }

  // Set somebody's marks.
  mark(marks, whose) {
    this.marks[whose] = marks;
    if (this.x) this.drawMarks();
  }

  drawMarks() {}

  // The cell that the cursor is in.
  cell() {
    const nearest = (axis, wanted) => (axis ? leastIndex(axis.values, (one, other) => Math.abs(one - wanted) - Math.abs(other - wanted)) : 0);
    return { i: nearest(this.data.x, this.cursor.x), j: nearest(this.data.y, this.cursor.y) };
  }

  // The point under the pointer.
  under(event) {
    const box = this.box.getBoundingClientRect();
    return { x: this.x.value(event.clientX - box.left), y: this.y.value(event.clientY - box.top) };
  }

  // The cursor goes to the middle of the cell under the pointer.
  point(event) {
    this.cursor = this.under(event);
    const { i, j } = this.cell();
    this.move({ x: this.data.x.values[i], y: this.data.y?.values[j] });
  }

  pick(event) {
    this.point(event);
    this.onpick(this.cursor);
  }

  press(event) {
    const steps = arrowOf(event);
    if (event.key !== "Enter" && !steps) return;
    event.preventDefault();
    const { x, y } = this.data;
    const at = (axis, place) => axis && axis.values[Math.max(0, Math.min(axis.values.length - 1, place))];
    const half = (axis) => axis && axis.values[Math.round((axis.values.length - 1) / 2)];
    this.cursor ??= { x: half(x), y: half(y) };
    if (!steps) return this.onpick(this.cursor);
    const { i, j } = this.cell();
    this.move({ x: at(x, i + steps[0]), y: at(y, j + steps[1]) });
  }

  // Show the cursor, and say what is there; null for none.
  move(cursor) {
    this.cursor = cursor;
    this.svg.querySelector(".cursor")?.remove();
    this.said.textContent = "";
    // One of other axes goes: new values may have come.
    const isWithin = ({ first, last }, value) => value >= Math.min(first, last) && value <= Math.max(first, last);
    if (cursor && !(isWithin(this.x, cursor.x) && (!this.data.y || isWithin(this.y, cursor.y)))) this.cursor = null;
    if (!this.cursor) return;
    const { i, j } = this.cell();
    this.said.textContent = capital(this.told(i, j).filter(Boolean).join(", "));
    const { width, height } = this.size;
    const across = this.x.place(this.cursor.x);
    const lines = [drawn("line", { x1: across, x2: across, y1: FRAME.top, y2: height - FRAME.bottom })];
    if (this.data.y) {
      const up = this.y.place(this.cursor.y);
      lines.push(drawn("line", { x1: FRAME.left, x2: width - FRAME.right, y1: up, y2: up }));
    }
    this.svg.append(drawn("g", { class: "cursor" }, ...lines));
  }

  /** @param {number} _i @param {number} _j @returns {string[]} */
  told(_i, _j) {
    return [];
  }

  // The picture as one SVG document; `told` is its title and values, `before` what lies beneath it.
  /** @param {string} style @param {any} told @param {any} more */
  svgText(style, told, { before = [], ...more } = {}) {
    const copy = this.svg.cloneNode(true);
    copy.querySelector(".cursor")?.remove();
    return svgDocument([...before, ...copy.childNodes], { ...this.size, style, told, regimes: this.regimes, ...more });
  }
}

// A picture as one SVG document, which says by itself what it shows: title, values, colours, regimes.
const LINE = 18; // px
const LETTER = 6.6; // px, on average
const EDGE = 12; // px
const BAR = 364; // px

// `parts` are elements of a picture of `width` times `height`; `told` is {title, lines, link}; `bar` is
// {range, name, unit} or null, `regimes` as a legend has them.
function svgDocument(parts, { width, height, style, told, bar = null, regimes = [] }) {
  const head = [told.title, ...told.lines.flatMap((line) => wrapped(line, (width - 2 * EDGE) / LETTER))];
  const top = LINE * head.length + EDGE;
  const text = (words_, x, y, more = {}) => drawn("text", { x, y, ...more }, words_);
  const below = [];
  let at = top + height + 8;
  if (bar?.range) {
    below.push(drawn("g", { transform: `translate(${Math.max(0, (width - BAR) / 2)} ${at})` }, barDrawn(bar.range, bar)));
    at += 3 * LINE;
  }
  for (const one of regimes) {
    below.push(
      drawn("circle", { cx: EDGE + 6, cy: at + 6, r: 5, class: "marker", fill: one.colour }),
      text(`${capital(words(one.name))} ${number(100 * one.share, 2)} %`, EDGE + 20, at + 10),
    );
    at += LINE;
  }
  const made = drawn(
    "svg",
    { xmlns: "http://www.w3.org/2000/svg", width, height: at + EDGE },
    drawn("title", {}, told.title),
    drawn("desc", {}, told.link),
    drawn("style", {}, style),
    drawn("rect", { width, height: at + EDGE, class: "paper" }),
    ...head.map((line, i) => text(line, EDGE, LINE * (i + 1), i ? {} : { class: "label" })),
    drawn("g", { transform: `translate(0 ${top})` }, ...parts),
    ...below,
  );
  return new XMLSerializer().serializeToString(made);
}

// Lines of at most so many letters, broken at commas.
function wrapped(text, most) {
  const lines = [""];
  for (const part of text.split(/(?<=, )/)) {
    if (lines.at(-1) && lines.at(-1).length + part.length > most) lines.push("");
    lines[lines.length - 1] += part;
  }
  return lines;
}
