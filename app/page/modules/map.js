// One quantity over two parameters: colours, contours, regimes, and a cursor that says what it meets.

import { axesDrawn, axisOf, FRAME } from "./axes.js";
import { scaleOf } from "./colours.js";
import { drawn, element, fill } from "./elements.js";
import { svgDocument } from "./exported.js";
import { bordersDrawn, clipDrawn, hatchDrawn, paint, thinned } from "./layers.js";
import { occurring, scaleTold } from "./legend.js";
import { markDrawn } from "./marks.js";
import { giveWay, namesDrawn } from "./names.js";
import { capital, withUnit, words } from "./words.js";

let maps = 0;

// Regimes that one word stands for are one area, by the value of its most frequent one.
function areasOf(regimes) {
  const areas = new Map();
  for (const one of regimes) {
    const key = one.valid ? one.said : one.name;
    const area = areas.get(key);
    if (area) area.values.add(one.value);
    else areas.set(key, { ...one, values: new Set([one.value]) });
  }
  return [...areas.values()];
}

function joined(regime, areas) {
  const of = new Map(areas.flatMap(({ value, values }) => [...values].map((one) => [one, value])));
  return { ...regime, of: regime, at: (i, j) => of.get(regime.at(i, j)) ?? regime.at(i, j) };
}

export class HeatMap {
  // `onpick` is called with {x, y} when a point is clicked, or Enter is pressed at the cursor;
  // `onpoint` with that of the cursor wherever it moves, `ondrag(point, {isOver})` with that of the
  // mark that is dragged.
  /**
   * @param {HTMLElement} host
   * @param {{onpick?: Function, onpoint?: Function, ondrag?: Function, title?: string, hint?: string, isSmall?: boolean}} options
   */
  constructor(host, { onpick = () => {}, onpoint = () => {}, ondrag = () => {}, title = "Map", hint = "", isSmall = false } = {}) {
    this.onpick = onpick;
    this.ondrag = ondrag;
    this.onpoint = onpoint;
    this.hint = hint; // told while no point is
    this.clipId = `inside-${(maps += 1)}`;
    this.canvas = element("canvas", { "aria-hidden": "true" });
    this.svg = drawn("svg", { "aria-hidden": "true", preserveAspectRatio: "none" });
    this.said = element("p", { class: "said", "aria-live": "polite" }, hint);
    this.scale = element("div", { class: "scale" });
    this.box = element(
      "div",
      {
        class: isSmall ? "map small" : "map",
        tabindex: "0",
        role: "application",
        "aria-label": `${title}: arrow keys move the cursor, Enter chooses the point`,
        onpointermove: (event) => this.point(event),
        onpointerdown: (event) => this.grip(event),
        onpointerup: (event) => this.let(event),
        onpointercancel: () => (this.gripped = null),
        onpointerleave: () => this.leave(),
        onclick: (event) => this.pick(event),
        onkeydown: (event) => this.press(event),
      },
      this.canvas,
      this.svg,
    );
    fill(host, this.box, ...(isSmall ? [] : [this.scale, this.said]));
    this.data = null;
    this.cursor = null; // {x, y}, values of the axes: the next picture may have other cells
    this.marks = {}; // by who sets them
    new ResizeObserver(() => this.resize()).observe(this.box);
  }

  // data: {x, y: {name, unit, values}, z: {name, unit, at(i, j), isJudged}, regime: {at(i, j), names} or null,
  // look(name) of a regime}. While it `isMoving`, lines are drawn of fewer values: they take most of
  // the time. A `range` of colours is that of several maps.
  show(data, { isMoving = false, isRough = false, range = null } = {}) {
    this.data = data;
    this.isRough = isRough;
    this.edges = null;
    delete this.box.dataset.borders;
    this.isMoving = isMoving;
    const size = data.x.values.length * data.y.values.length;
    this.flat = new Float64Array(size);
    const nx = data.x.values.length;
    for (let j = 0; j < data.y.values.length; j++) {
      for (let i = 0; i < nx; i++) this.flat[j * nx + i] = data.z.at(i, j) ?? NaN;
    }
    // While something moves, colours keep their meaning.
    const isHeld = isMoving && this.range && this.rangeOf === data.z.name;
    if (!isHeld) this.range = range ?? scaleOf(this.flat);
    this.rangeOf = data.z.name;
    this.regimes = occurring(data, data.look);
    this.areas = areasOf(this.regimes);
    if (data.regime) this.data = { ...data, regime: joined(data.regime, this.areas) };
    this.draw();
    fill(this.scale, ...scaleTold(this.range, data.z, this.flat));
    this.box.dataset.size = `${data.x.values.length} x ${data.y.values.length}`;
    if (this.cursor) this.say();
  }

  // Draw the borders of what is shown by what lies between its cells; `regime` tells which picture it is of.
  sharpen(regime, edges) {
    if (this.data?.regime?.of !== regime) return;
    this.edges = { ...edges, across: joined({ at: edges.across }, this.areas).at, up: joined({ at: edges.up }, this.areas).at };
    this.box.dataset.borders = "exact";
    this.draw();
  }

  // Set somebody's marks, of {x, y, text}; with `isSmall` and a `regime` it is one of many.
  mark(marks, whose) {
    this.marks[whose] = marks;
    if (!this.x) return;
    this.svg.querySelector(".marks")?.replaceWith(this.marksDrawn());
    this.arrange();
  }

  resize() {
    this.size = { width: this.box.clientWidth, height: this.box.clientHeight };
    this.draw();
  }

  draw() {
    if (!this.data) return;
    // Asked for once: with each frame it would have the whole page laid out.
    this.size ??= { width: this.box.clientWidth, height: this.box.clientHeight };
    const { width, height } = this.size;
    if (width < 80 || height < 80) return;
    const { left, right, top, bottom } = FRAME;
    const { data } = this;
    this.x = axisOf(data.x, left, width - right);
    this.y = axisOf(data.y, height - bottom, top);
    // In parts of the box, as the drawing is: both keep together whatever its size, on paper, too.
    const [wide, tall] = [width - left - right, height - top - bottom];
    const part = (one, all) => `${(100 * one) / all}%`;
    Object.assign(this.canvas.style, { left: part(left, width), top: part(top, height), width: part(wide, width), height: part(tall, height) });
    this.box.style.setProperty("--ratio", `${width} / ${height}`);
    paint(this.canvas, this, wide, tall);
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const ground = this.isMoving ? thinned(this) : this;
    fill(
      this.svg,
      clipDrawn(this.clipId, width, height),
      hatchDrawn(ground, this.areas),
      bordersDrawn(ground, this.areas),
      namesDrawn(this.isMoving ? ground : thinned(this), this.areas),
      this.axesDrawn(width, height),
      this.marksDrawn(),
      this.cursorDrawn(),
    );
    this.arrange();
  }

  // Names of regimes stand beside marked points.
  arrange() {
    const marks = Object.values(this.marks).flat().filter(({ isSmall }) => !isSmall);
    const names = this.svg.querySelector(".names");
    if (names) giveWay(names, marks.map(({ x, y }) => [this.x.place(x), this.y.place(y)]));
  }

  // The axes, drawn anew where they are others than before.
  axesDrawn(width, height) {
    const ends = [this.x, this.y].flatMap(({ label, first, last }) => [label, first, last]);
    const told = [...ends, width, height].join();
    if (this.axes?.told !== told) {
      this.axes = { told, group: axesDrawn(this.x, this.y, width, height) };
    }
    return this.axes.group;
  }

  marksDrawn() {
    const all = Object.values(this.marks).flat();
    return drawn("g", { class: "marks" }, ...all.map((mark) => markDrawn(mark, this)));
  }

  cursorDrawn() {
    if (!this.cursor) return null;
    const { left, right, top, bottom } = FRAME;
    const x = this.x.place(this.cursor.x);
    const y = this.y.place(this.cursor.y);
    const width = this.box.clientWidth - right;
    const height = this.box.clientHeight - bottom;
    if (x < left - 1 || x > width + 1 || y < top - 1 || y > height + 1) return null; // of other axes
    return drawn(
      "g",
      { class: "cursor" },
      drawn("line", { x1: x, x2: x, y1: top, y2: height }),
      drawn("line", { x1: left, x2: width, y1: y, y2: y }),
    );
  }

  // The cell that the cursor is in.
  cell() {
    return {
      i: this.nearest(this.data.x.values, this.cursor.x),
      j: this.nearest(this.data.y.values, this.cursor.y),
    };
  }

  nearest(values, wanted) {
    let best = 0;
    for (let i = 1; i < values.length; i++) {
      if (Math.abs(values[i] - wanted) < Math.abs(values[best] - wanted)) best = i;
    }
    return best;
  }

  // The middle of the cell under the pointer.
  under(event) {
    const box = this.box.getBoundingClientRect();
    const { x, y } = this.data;
    return {
      x: x.values[this.nearest(x.values, this.x.value(event.clientX - box.left))],
      y: y.values[this.nearest(y.values, this.y.value(event.clientY - box.top))],
    };
  }

  point(event) {
    if (!this.data) return;
    if (this.gripped) this.ondrag(this.exactly(event), { isOver: false });
    else this.move(this.under(event));
  }

  // The chosen point is taken hold of.
  grip(event) {
    if (!event.target.closest?.(".dragged")) return;
    this.gripped = event.target;
    this.box.setPointerCapture(event.pointerId);
  }

  let(event) {
    if (!this.gripped) return;
    this.gripped = null;
    this.isLet = true; // the click that follows chooses nothing
    this.ondrag(this.exactly(event), { isOver: true });
  }

  // The point under the pointer, within the axes, to four digits of them.
  exactly(event) {
    const box = this.box.getBoundingClientRect();
    const within = (axis, value) => {
      const [low, high] = [Math.min(axis.first, axis.last), Math.max(axis.first, axis.last)];
      const digit = 10 ** Math.floor(Math.log10((high - low) / 300));
      const rounded = Math.round(value / digit) * digit;
      return Number(Math.max(low, Math.min(high, rounded)).toPrecision(6));
    };
    return {
      x: within(this.x, this.x.value(event.clientX - box.left)),
      y: within(this.y, this.y.value(event.clientY - box.top)),
    };
  }

  move(cursor) {
    this.cursor = cursor;
    this.svg.querySelector(".cursor")?.remove();
    const lines = this.cursorDrawn();
    if (lines) this.svg.append(lines);
    this.say();
    this.onpoint(this.cursor);
  }

  leave() {
    if (this.box === document.activeElement) return;
    this.cursor = null;
    this.svg.querySelector(".cursor")?.remove();
    this.said.textContent = this.hint;
  }

  say() {
    const { x, y, z, regime } = this.data;
    const { i, j } = this.cell();
    const parts = [
      `${words(x.name)} ${withUnit(x.values[i], x.unit)}`,
      `${words(y.name)} ${withUnit(y.values[j], y.unit)}`,
      `${words(z.name)} ${withUnit(z.at(i, j), z.unit)}`,
    ];
    if (regime) parts.push(words(regime.names[regime.of.at(i, j)] ?? ""));
    this.said.textContent = capital(parts.filter(Boolean).join(", "));
  }

  pick(event) {
    if (!this.data) return;
    if (this.isLet) {
      this.isLet = false;
      return;
    }
    this.move(this.under(event));
    this.onpick(this.cursor);
  }

  press(event) {
    if (!this.data) return;
    const step = event.shiftKey ? 10 : 1;
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const { x, y } = this.data;
    const last = [x.values.length - 1, y.values.length - 1];
    this.cursor ??= { x: x.values[Math.round(last[0] / 2)], y: y.values[Math.round(last[1] / 2)] };
    if (event.key === "Enter") {
      this.move(this.cursor);
      this.onpick(this.cursor);
    } else if (moves[event.key]) {
      const [di, dj] = moves[event.key];
      const { i, j } = this.cell();
      this.move({
        x: x.values[Math.max(0, Math.min(last[0], i + step * di))],
        y: y.values[Math.max(0, Math.min(last[1], j + step * dj))],
      });
    } else return;
    event.preventDefault();
  }

  // The picture as one SVG document, the colours as an image within it; `told` is its title and values.
  svgText(style, told) {
    const copy = this.svg.cloneNode(true);
    copy.querySelector(".cursor")?.remove();
    const { left, right, top, bottom } = FRAME;
    const width = this.box.clientWidth;
    const height = this.box.clientHeight;
    const colours = drawn("image", {
      x: left,
      y: top,
      width: width - left - right,
      height: height - top - bottom,
      preserveAspectRatio: "none",
      "image-rendering": "pixelated",
      href: this.canvas.toDataURL(),
    });
    const bar = { range: this.range, ...this.data.z };
    return svgDocument([colours, ...copy.childNodes], { width, height, style, told, bar, regimes: this.regimes });
  }
}
