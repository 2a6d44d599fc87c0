// A trade-off: two outputs of designs that nothing beats in both, as a plot with a cursor.

import { axesDrawn, axisOf, FRAME } from "./axes.js";
import { drawn, fill } from "./elements.js";
import { lookOf } from "./legend.js";
import { Plot } from "./plot.js";
import { capital, withUnit, words } from "./words.js";

const SIZE = 5; // px
const ROOM = 0.05; // of an axis, beyond the points

function ends(values) {
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const room = ROOM * (high - low || Math.abs(high) || 1);
  return [low - room, high + room];
}

export class Front extends Plot {
  // `onpoint(index)` hears of the point under pointer or cursor, `onpick(index)` of the one chosen.
  constructor(host, { onpoint, onpick }) {
    super(host, { onpick, name: "map front", label: "Trade-off: left and right" });
    this.onpoint = onpoint;
    this.at = null;
  }

  // data: {designs, output, against, scene, names, units, isBent}, of designs {at, values, regime, isKnee} along the front;
  // `output` against the size of `against`; one that is not bent has no knee to be named.
  show(data) {
    this.data = data;
    this.at = null;
    this.redraw();
  }

  draw() {
    const { width, height } = this.size;
    const { designs, output, against, scene, isBent } = this.data;
    const { left, right, top, bottom } = FRAME;
    const sizes = designs.map(({ values }) => Math.abs(values[against].value));
    const largest = designs.map(({ values }) => values[output].value);
    const along = (name, values, from, to) => axisOf({ name, unit: designs[0].values[name].unit, values: ends(values) }, from, to);
    this.x = along(against, sizes, left, width - right);
    this.x.label = `Size of ${this.x.label.slice(0, 1).toLowerCase()}${this.x.label.slice(1)}`;
    this.y = along(output, largest, height - bottom, top);
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.placed = sizes.map((size, i) => [this.x.place(size), this.y.place(largest[i])]);
    this.points = this.placed.map(([cx, cy], i) => drawn("circle", { cx, cy, r: SIZE, class: "marker", fill: lookOf(scene, designs[i].regime.name).colour }));
    const knees = this.placed
      .filter((_, i) => isBent && designs[i].isKnee)
      .map(([x, y]) => drawn("text", { x: x + 8, y: y + 20, "text-anchor": x > width * 0.8 ? "end" : "start" }, "knee"));
    fill(this.svg, axesDrawn(this.x, this.y, width, height), drawn("polyline", { points: this.placed.join(" "), class: "link" }), ...this.points, ...knees);
  }

  // Make one point the one that is looked at; null for none.
  highlight(index) {
    this.at = index;
    this.move();
  }

  move() {
    this.points?.forEach((one, i) => one.classList.toggle("chosen", i === this.at));
    if (this.at !== null && this.points) this.svg.append(this.points[this.at]);
    this.said.textContent = this.at === null ? "" : this.told(this.at);
  }

  told(index) {
    const { designs, output, against, names, units } = this.data;
    const { values, regime, at } = designs[index];
    const parts = [output, against].map((name) => `${words(name)} ${withUnit(values[name].value, values[name].unit)}`);
    const chosen = names.map((name) => `${words(name)} ${withUnit(at[name], units(name))}`);
    return capital([...parts, ...chosen, words(regime.name)].filter(Boolean).join(", "));
  }

  point(event) {
    const box = this.box.getBoundingClientRect();
    const distances = this.placed.map(([x, y]) => Math.hypot(x + box.left - event.clientX, y + box.top - event.clientY));
    this.onpoint(distances.indexOf(Math.min(...distances)));
  }

  pick(event) {
    this.point(event);
    this.onpick(this.at);
  }

  press(event) {
    const last = this.data.designs.length - 1;
    const step = { ArrowLeft: 1, ArrowDown: 1, ArrowRight: -1, ArrowUp: -1 }[event.key] * (event.shiftKey ? 5 : 1);
    if (event.key === "Enter" && this.at !== null) this.onpick(this.at);
    else if (event.key === "Home") this.onpoint(0);
    else if (event.key === "End") this.onpoint(last);
    else if (step) this.onpoint(this.at === null ? 0 : Math.max(0, Math.min(last, this.at + step)));
    else return;
    event.preventDefault();
  }
}
