// One quantity over two parameters: colours, regimes, marks, and the design as a ring that is dragged.

import { axesDrawn, axisOf, FRAME } from "./axes.js";
import { scaleOf } from "./colours.js";
import { drawn, element, fill } from "./elements.js";
import { bordersDrawn, clipDrawn, hatchDrawn, paint, thinned } from "./layers.js";
import { occurring, scaleTold } from "./legend.js";
import { giveWay, markDrawn, namesDrawn } from "./marks.js";
import { arrowsDrawn } from "./plate.js";
import { Plot } from "./plot.js";
import { withUnit, words } from "./words.js";

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
  return { ...regime, of: regime, at: (i, j) => of.get(regime.at(i, j)) };
}

export class HeatMap extends Plot {
  /**
   * `ondrag(point, {isOver})` hears of the mark that is dragged.
   * @param {HTMLElement} host
   * @param {{onpick: Function, ondrag: Function, title: string}} options
   */
  constructor(host, { onpick, ondrag, title }) {
    const scale = element("div", { class: "scale" });
    super(host, { onpick, name: "map", label: `${title}: arrow keys`, after: [scale] });
    this.scale = scale;
    this.ondrag = ondrag;
    this.canvas = element("canvas", { "aria-hidden": "true" });
    this.box.prepend(this.canvas);
    this.box.addEventListener("pointerdown", (event) => {
      this.isDragged = Boolean(event.target.closest(".dragged"));
      if (this.isDragged) this.box.setPointerCapture(event.pointerId);
    });
    this.box.addEventListener("pointerup", (event) => {
      if (!this.isDragged) return;
      this.isDragged = false;
      this.isLetGo = true; // the click that follows chooses nothing
      this.ondrag(this.rounded(event), { isOver: true });
    });
    this.box.addEventListener("pointercancel", () => (this.isDragged = false));
  }

  // data: {x, y: {name, unit, values}, z: {name, unit, at(i, j), isJudged}, regime: {at(i, j), names} or null, field,
  // look(name) of a regime}. While it `isMoving`, lines are drawn of fewer values: they take most of the time. Values
  // that are `isRough` stay blocks.
  show(data, { isMoving, isRough }) {
    const [nx, ny] = [data.x.values.length, data.y.values.length];
    this.isRough = isRough;
    this.isMoving = isMoving;
    this.flat = new Float64Array(nx * ny);
    for (let j = 0; j < ny; j++) for (let i = 0; i < nx; i++) this.flat[j * nx + i] = data.z.at(i, j) ?? NaN;
    // While something moves, colours keep their meaning.
    const isHeld = isMoving && this.range && this.data?.z.name === data.z.name;
    if (!isHeld) this.range = scaleOf(this.flat);
    this.regimes = occurring(data, data.look);
    this.areas = areasOf(this.regimes);
    this.data = data.regime ? { ...data, regime: joined(data.regime, this.areas) } : data;
    fill(this.scale, ...scaleTold(this.range, data.z, this.flat));
    this.box.dataset.size = `${nx} x ${ny}`;
    this.redraw();
  }

  draw() {
    const { width, height } = this.size;
    const { left, right, top, bottom } = FRAME;
    this.x = axisOf(this.data.x, left, width - right);
    this.y = axisOf(this.data.y, height - bottom, top);
    // In parts of the box, as the drawing is: both keep together whatever its size, on paper, too.
    const [wide, tall] = [width - left - right, height - top - bottom];
    const part = (one, all) => `${(100 * one) / all}%`;
    Object.assign(this.canvas.style, { left: part(left, width), top: part(top, height), width: part(wide, width), height: part(tall, height) });
    this.box.style.setProperty("--ratio", `${width} / ${height}`);
    paint(this.canvas, this, wide, tall);
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const few = thinned(this);
    const ground = this.isMoving ? few : this;
    this.names = namesDrawn(few, this.areas);
    this.drawnMarks = drawn("g", { class: "marks" });
    fill(
      this.svg,
      clipDrawn(width, height),
      hatchDrawn(ground, this.areas),
      bordersDrawn(ground, this.areas),
      this.names,
      arrowsDrawn(this),
      this.axesDrawn(width, height),
      this.drawnMarks,
    );
    this.drawMarks();
  }

  // The axes, drawn anew where they are others than before.
  axesDrawn(width, height) {
    const told = [this.x, this.y].flatMap(({ label, first, last }) => [label, first, last]).join() + [width, height];
    if (this.axes?.told !== told) this.axes = { told, group: axesDrawn(this.x, this.y, width, height) };
    return this.axes.group;
  }

  drawMarks() {
    const all = Object.values(this.marks).flat();
    fill(this.drawnMarks, ...all.map((mark) => markDrawn(mark, this)));
    const large = all.filter(({ isSmall }) => !isSmall);
    giveWay(this.names, large.map(({ x, y }) => [this.x.place(x), this.y.place(y)]));
  }

  point(event) {
    if (this.isDragged) this.ondrag(this.rounded(event), { isOver: false });
    else super.point(event);
  }

  pick(event) {
    if (!this.isLetGo) super.pick(event);
    this.isLetGo = false;
  }

  // The point under the pointer, within the axes, to four digits of them.
  rounded(event) {
    const { x, y } = this.under(event);
    const within = ({ first, last }, value) => {
      const [low, high] = [Math.min(first, last), Math.max(first, last)];
      const digit = 10 ** Math.floor(Math.log10((high - low) / 300));
      return Number(Math.max(low, Math.min(high, Math.round(value / digit) * digit)).toPrecision(6));
    };
    return { x: within(this.x, x), y: within(this.y, y) };
  }

  told(i, j) {
    const { x, y, z, regime } = this.data;
    const values = [[x, x.values[i]], [y, y.values[j]], [z, z.at(i, j)]];
    return [...values.map(([one, value]) => `${words(one.name)} ${withUnit(value, one.unit)}`), regime && words(regime.names[regime.of.at(i, j)] ?? "")];
  }

  // The picture as one SVG document, the colours as an image within it.
  svgText(style, told) {
    const { left, right, top, bottom } = FRAME;
    const { width, height } = this.size;
    const place = { x: left, y: top, width: width - left - right, height: height - top - bottom };
    const colours = drawn("image", { ...place, preserveAspectRatio: "none", "image-rendering": "pixelated", href: this.canvas.toDataURL() });
    return super.svgText(style, told, { before: [colours], bar: { range: this.range, ...this.data.z } });
  }
}
