// Parallel coordinates: an axis for each variable and output, a line for each design. On each axis a
// part can be chosen, by dragging along it or with its two handles; lines outside are faint.

import { drawn, element, fill } from "./elements.js";
import { lookOf } from "./markers.js";
import { number, shown, withUnit, words } from "./words.js";

const FRAME = { left: 56, right: 56, top: 70, bottom: 42 };
const ROOM = [112, 220]; // px between two axes, least and most
const HEIGHT = 310;
const STEPS = 40; // of a handle from end to end
const LETTERS = 17; // in a line of a name
const NEAR = 12; // px within which a line is pointed at

// A name over at most three lines.
function wrapped(text) {
  const lines = [""];
  for (const word of text.split(" ")) {
    const line = lines.at(-1);
    if (line && line.length + word.length >= LETTERS && lines.length < 3) lines.push(word);
    else lines[lines.length - 1] = line ? `${line} ${word}` : word;
  }
  return lines;
}

export class Parallel {
  // `onpoint(index)` hears of the line under the pointer, `onpick(index)` of the one chosen,
  // `onbrush(set)` of the indices that are left out.
  constructor(host, { onpoint, onpick, onbrush }) {
    this.onpoint = onpoint;
    this.onpick = onpick;
    this.onbrush = onbrush;
    this.room = ROOM[0];
    this.svg = drawn("svg", { class: "parallel", role: "group", "aria-label": "All drives in parallel coordinates: one line per drive, one axis per quantity" });
    this.said = element("p", { class: "said", role: "status" });
    this.svg.addEventListener("pointermove", (event) => this.point(event));
    this.svg.addEventListener("click", (event) => this.click(event));
    const all = element("button", { type: "button", onclick: () => this.showAll() }, "All drives again");
    this.box = element("div", { class: "wide" }, this.svg);
    new ResizeObserver(() => this.columns && this.draw()).observe(this.box);
    fill(
      host,
      this.box,
      this.said,
      element("div", { class: "buttons" }, all),
    );
  }

  // columns: of {name, unit, values}; one value a design
  show(designs, columns, scene) {
    this.designs = designs;
    this.scene = scene;
    this.at = null;
    this.columns = columns.map((column) => {
      const low = Math.min(...column.values);
      const high = Math.max(...column.values);
      const room = high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high)) ? Math.abs(high) * 0.05 || 1 : 0;
      return { ...column, low: low - room, high: high + room, from: 0, to: 1 };
    });
    this.draw();
  }

  get height() {
    return HEIGHT - FRAME.top - FRAME.bottom;
  }

  across(place) {
    return FRAME.left + place * this.room;
  }

  share(column, value) {
    return (value - column.low) / (column.high - column.low);
  }

  up(share) {
    return FRAME.top + (1 - share) * this.height;
  }

  draw() {
    const free = (this.box.clientWidth - FRAME.left - FRAME.right) / (this.columns.length - 1);
    this.room = Math.max(ROOM[0], Math.min(ROOM[1], free));
    const width = this.across(this.columns.length - 1) + FRAME.right;
    this.svg.setAttribute("viewBox", `0 0 ${width} ${HEIGHT}`);
    this.svg.setAttribute("width", width);
    this.svg.setAttribute("height", HEIGHT);
    this.lines = this.designs.map((design, i) => {
      const points = this.columns.map(
        (column, place) => `${this.across(place)},${this.up(this.share(column, column.values[i])).toFixed(1)}`,
      );
      const line = drawn("polyline", { points: points.join(" "), class: "design" });
      const { colour, ink } = lookOf(this.scene, design.regime.name);
      line.style.setProperty("--light", colour);
      line.style.setProperty("--dark", ink);
      return line;
    });
    fill(this.svg, ...this.lines, ...this.columns.map((column, place) => this.axis(column, place)));
    this.mark();
  }

  axis(column, place) {
    const x = this.across(place);
    const [factor] = shown(column.unit);
    const name = wrapped(words(column.name));
    const area = drawn("rect", {
      x: x - 14, y: FRAME.top, width: 28, height: this.height, class: "catch",
    });
    column.chosen = drawn("rect", { x: x - 6, width: 12, class: "brush" });
    column.handles = ["from", "to"].map((end) => this.handle(column, x, end));
    area.addEventListener("pointerdown", (event) => this.drag(event, column));
    const text = (y, value, more = {}) => drawn("text", { x, y, "text-anchor": "middle", ...more }, value);
    const group = drawn(
      "g",
      { class: "axes" },
      ...name.map((line, i) => text(14 + 14 * (i + 3 - name.length), line, { class: "label" })),
      drawn("line", { x1: x, x2: x, y1: this.up(0), y2: this.up(1) }),
      text(this.up(1) - 13, number(column.high * factor, 3)),
      text(this.up(0) + 24, withUnit(column.low, column.unit, 3)),
      area,
      column.chosen,
      ...column.handles,
    );
    this.place(column);
    return group;
  }

  handle(column, x, end) {
    const told = `${end === "from" ? "Least" : "Largest"} ${words(column.name)} of the lines`;
    const made = drawn(
      "g",
      { class: "handle", tabindex: "0", role: "slider", "aria-label": told, "aria-orientation": "vertical", "aria-valuemin": 0, "aria-valuemax": STEPS },
      drawn("path", { d: end === "from" ? "M-9 0H9L0 9Z" : "M-9 0H9L0-9Z", transform: `translate(${x} 0)` }),
    );
    made.addEventListener("keydown", (event) => this.press(event, column, end));
    made.addEventListener("pointerdown", (event) => this.drag(event, column, column[end === "from" ? "to" : "from"]));
    return made;
  }

  // Put brush and handles where they belong.
  place(column) {
    const { from, to } = column;
    column.chosen.setAttribute("y", this.up(to));
    column.chosen.setAttribute("height", Math.max(0, (to - from) * this.height));
    column.chosen.classList.toggle("idle", from === 0 && to === 1);
    for (const [place, end] of ["from", "to"].entries()) {
      const handle = column.handles[place];
      const value = column.low + column[end] * (column.high - column.low);
      handle.setAttribute("transform", `translate(0 ${this.up(column[end])})`);
      handle.setAttribute("aria-valuenow", Math.round(column[end] * STEPS));
      handle.setAttribute("aria-valuetext", withUnit(value, column.unit, 3));
    }
  }

  brush(column, from, to) {
    column.from = Math.max(0, Math.min(1, from));
    column.to = Math.max(column.from, Math.min(1, to));
    this.place(column);
    this.mark();
    const out = this.left();
    this.said.textContent = out.size ? `${this.designs.length - out.size} of ${this.designs.length} drives are left.` : "";
    this.onbrush(out);
  }

  // The indices of what lies outside a chosen part of an axis.
  left() {
    const out = new Set();
    for (const column of this.columns) {
      column.values.forEach((value, i) => {
        const share = this.share(column, value);
        if (share < column.from - 1e-9 || share > column.to + 1e-9) out.add(i);
      });
    }
    return out;
  }

  showAll() {
    for (const column of this.columns) Object.assign(column, { from: 0, to: 1 });
    for (const column of this.columns) this.place(column);
    this.brush(this.columns[0], 0, 1);
  }

  mark() {
    const out = this.left();
    this.lines.forEach((line, i) => {
      line.classList.toggle("dim", out.has(i));
      line.classList.toggle("chosen", i === this.at);
    });
    if (this.at !== null) this.lines.at(-1).after(this.lines[this.at]);
  }

  highlight(index) {
    this.at = index;
    this.mark();
  }

  shareAt(event) {
    const box = this.svg.getBoundingClientRect();
    const y = ((event.clientY - box.top) * HEIGHT) / box.height;
    return Math.max(0, Math.min(1, 1 - (y - FRAME.top) / this.height));
  }

  // Choose the part of an axis between a place on it, where it was taken hold of, and the pointer.
  drag(event, column, start = this.shareAt(event)) {
    const area = event.currentTarget;
    const move = (now) => {
      const here = this.shareAt(now);
      this.isDragging = true;
      this.brush(column, Math.min(start, here), Math.max(start, here));
    };
    area.setPointerCapture(event.pointerId);
    area.addEventListener("pointermove", move);
    area.addEventListener("pointerup", () => area.removeEventListener("pointermove", move), { once: true });
    area.addEventListener("pointercancel", () => area.removeEventListener("pointermove", move), { once: true });
  }

  press(event, column, end) {
    const step = (event.shiftKey ? 5 : 1) / STEPS;
    const here = column[end];
    const places = { ArrowUp: here + step, ArrowRight: here + step, ArrowDown: here - step, ArrowLeft: here - step, Home: 0, End: 1 };
    if (!(event.key in places)) return;
    event.preventDefault();
    if (end === "from") this.brush(column, Math.min(places[event.key], column.to), column.to);
    else this.brush(column, column.from, Math.max(places[event.key], column.from));
  }

  // The line under the pointer, between two axes; null where there is none.
  under(event) {
    const box = this.svg.getBoundingClientRect();
    const scale = HEIGHT / box.height;
    const x = (event.clientX - box.left) * scale;
    const y = (event.clientY - box.top) * scale;
    const place = Math.max(0, Math.min(this.columns.length - 2, Math.floor((x - FRAME.left) / this.room)));
    const part = (x - this.across(place)) / this.room;
    const [one, other] = [this.columns[place], this.columns[place + 1]];
    const out = this.left();
    let best = null;
    let least = NEAR;
    this.designs.forEach((_, i) => {
      if (out.has(i)) return;
      const ends = [one, other].map((column) => this.up(this.share(column, column.values[i])));
      const distance = Math.abs(ends[0] + part * (ends[1] - ends[0]) - y);
      if (distance < least) [best, least] = [i, distance];
    });
    return best;
  }

  point(event) {
    if (!this.columns || event.buttons) return;
    const found = this.under(event);
    if (found !== null) this.onpoint(found);
  }

  click(event) {
    if (this.isDragging) {
      this.isDragging = false; // a brush has been drawn
      return;
    }
    const found = this.under(event);
    if (found !== null) this.onpick(found);
  }
}
