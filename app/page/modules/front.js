// A trade-off: two outputs of designs that nothing beats in both, as a plot with a cursor.

import { axesDrawn, axisOf, FRAME } from "./axes.js";
import { drawn, element, fill } from "./elements.js";
import { svgDocument } from "./exported.js";
import { lookOf, markerDrawn } from "./markers.js";
import { capital, withUnit, words } from "./words.js";

const SIZE = 5; // px
const ROOM = 0.05; // of an axis, beyond the points

function ends(values) {
  const low = Math.min(...values);
  const high = Math.max(...values);
  const room = ROOM * (high - low || Math.abs(high) || 1);
  return [low - room, high + room];
}

export class Front {
  // `onpoint(index)` hears of the point under pointer or cursor, `onpick(index)` of the one chosen.
  constructor(host, { onpoint, onpick }) {
    this.onpoint = onpoint;
    this.onpick = onpick;
    this.svg = drawn("svg", { "aria-hidden": "true" });
    this.said = element("p", { class: "said", "aria-live": "polite" });
    this.box = element(
      "div",
      {
        class: "map front",
        tabindex: "0",
        role: "application",
        "aria-label": "Trade-off: left and right move along it, Enter shows the drive",
        onpointermove: (event) => this.point(event),
        onclick: (event) => this.pick(event),
        onkeydown: (event) => this.press(event),
      },
      this.svg,
    );
    fill(host, this.box, this.said);
    this.at = null;
    new ResizeObserver(() => this.draw()).observe(this.box);
  }

  // designs: of {at, values, regime, isKnee}, along the front; `output` against the size of `against`; one that is
  // not bent has no knee to be named
  show(designs, { output, against, scene, names, units, isBent }) {
    this.designs = designs;
    this.isBent = isBent;
    this.output = output;
    this.against = against;
    this.scene = scene;
    this.names = names;
    this.units = units;
    this.points = designs.map(({ values }) => ({ x: Math.abs(values[against].value), y: values[output].value }));
    this.at = null;
    this.draw();
  }

  draw() {
    if (!this.designs?.length) return;
    const { clientWidth: width, clientHeight: height } = this.box;
    if (width < 80 || height < 80) return;
    const { left, right, top, bottom } = FRAME;
    const [first] = this.designs;
    const along = (name, key, from, to) =>
      axisOf({ name, unit: first.values[name].unit, values: ends(this.points.map((one) => one[key])) }, from, to);
    this.x = along(this.against, "x", left, width - right);
    this.x.label = `Size of ${words(this.against)}${this.x.unitShown ? ` (${this.x.unitShown})` : ""}`;
    this.y = along(this.output, "y", height - bottom, top);
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const placed = this.points.map(({ x, y }) => [this.x.place(x), this.y.place(y)]);
    this.placed = placed;
    this.marks = placed.map(([x, y], i) =>
      markerDrawn(lookOf(this.scene, this.designs[i].regime.name), x, y, SIZE, { class: "marker" }),
    );
    const knees = placed
      .filter((_, i) => this.isBent && this.designs[i].isKnee)
      .map(([x, y]) => drawn("text", { x: x + 8, y: y + 20, "text-anchor": x > width * 0.8 ? "end" : "start" }, "knee"));
    fill(
      this.svg,
      axesDrawn(this.x, this.y, width, height),
      drawn("polyline", { points: placed.map((one) => one.map((v) => v.toFixed(1)).join(",")).join(" "), class: "link" }),
      ...this.marks,
      ...knees,
    );
    this.mark();
  }

  mark() {
    this.marks?.forEach((one, i) => {
      one.classList.toggle("chosen", i === this.at);
    });
    if (this.at !== null && this.marks) this.svg.append(this.marks[this.at]);
  }

  // Make one point the one that is looked at; null for none.
  highlight(index) {
    this.at = index;
    this.mark();
    this.said.textContent = index === null ? "" : this.told(index);
  }

  told(index) {
    const { values, regime, at } = this.designs[index];
    const parts = [this.output, this.against].map(
      (name) => `${words(name)} ${withUnit(values[name].value, values[name].unit)}`,
    );
    const chosen = this.names.map((name) => `${words(name)} ${withUnit(at[name], this.units(name))}`);
    return capital([...parts, ...chosen, words(regime.name)].filter(Boolean).join(", "));
  }

  nearest(event) {
    const box = this.box.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const distances = this.placed.map(([px, py]) => Math.hypot(px - x, py - y));
    return distances.indexOf(Math.min(...distances));
  }

  point(event) {
    if (this.placed) this.onpoint(this.nearest(event));
  }

  pick(event) {
    if (!this.placed) return;
    this.onpoint(this.nearest(event));
    this.onpick(this.at);
  }

  press(event) {
    if (!this.designs?.length) return;
    const last = this.designs.length - 1;
    const moves = { ArrowLeft: 1, ArrowDown: 1, ArrowRight: -1, ArrowUp: -1 };
    if (event.key === "Enter" && this.at !== null) this.onpick(this.at);
    else if (event.key === "Home") this.onpoint(0);
    else if (event.key === "End") this.onpoint(last);
    else if (moves[event.key]) {
      const step = (event.shiftKey ? 5 : 1) * moves[event.key];
      this.onpoint(this.at === null ? 0 : Math.max(0, Math.min(last, this.at + step)));
    } else return;
    event.preventDefault();
  }

  // The picture as one SVG document.
  svgText(style, told) {
    const copy = this.svg.cloneNode(true);
    const { clientWidth: width, clientHeight: height } = this.box;
    return svgDocument([...copy.childNodes], { width, height, style, told });
  }
}
