// A quantity over one parameter, with a band where something is uncertain, and the regimes below; and a trade-off, one
// output of its drives over another.

import { axesDrawn, axisOf, FRAME } from "./axes.js";
import { stretches } from "./course.js";
import { drawn, element, fill } from "./elements.js";
import { legendOf, occurring } from "./legend.js";
import { Plot } from "./plot.js";
import { label, withUnit, words } from "./words.js";

const STRIP = 8; // px, of the regimes
const ROOM = 0.04; // of the range of values, above and below

export class Curves extends Plot {
  constructor(host, { onpick, title = "Lines" }) {
    const legend = element("ul", { class: "legend", "aria-label": "Regimes" });
    super(host, { onpick, name: "curves", label: `${title}: left and right`, after: [legend] });
    this.legend = legend;
  }

  // data: {x: {name, unit, values}, z: {name, unit, at(i)}, low, high, regime or null, look}
  show(data) {
    this.data = data;
    this.values = Array.from(data.x.values, (_, i) => data.z.at(i));
    this.regimes = occurring(data, data.look);
    fill(this.legend, ...legendOf(this.regimes));
    this.redraw();
  }

  draw() {
    const { width, height } = this.size;
    const { x, z, low, high } = this.data;
    const { left, right, top, bottom } = FRAME;
    this.x = axisOf(x, left, width - right);
    const all = [...this.values, ...(low ?? []), ...(high ?? []), ...(this.measured ?? []).map(([, y]) => y)].filter(Number.isFinite);
    let [least, most] = all.length ? [Math.min(...all), Math.max(...all)] : [0, 1];
    if (least > 0 && least < 0.5 * most) least = 0;
    const room = ROOM * (most - least) || Math.abs(most) || 1;
    this.y = axisOf({ ...z, values: [least - (least === 0 ? 0 : room), most + room] }, height - bottom - STRIP, top);
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.box.style.setProperty("--ratio", `${width} / ${height}`);
    this.drawnMarks = drawn("g");
    fill(this.svg, ...this.strip(height - bottom), ...this.line(), axesDrawn(this.x, this.y, width, height), this.drawnMarks);
    this.drawMarks();
  }

  // The line ends where there is no value.
  line() {
    const { low, high, x } = this.data;
    const isThere = (i) => Number.isFinite(this.values[i]);
    const at = (list, i) => `${this.x.place(x.values[i]).toFixed(1)} ${this.y.place(list[i]).toFixed(1)}`;
    const places = [...this.values.keys()];
    const path = places.filter(isThere).map((i) => `${isThere(i - 1) ? "L" : "M"}${at(this.values, i)}`).join("");
    const made = [drawn("path", { d: path, class: "line" })];
    if (!low) return made;
    const there = places.filter((i) => Number.isFinite(low[i]) && Number.isFinite(high[i]));
    const points = [...there.map((i) => at(high, i)), ...there.reverse().map((i) => at(low, i))].join(" ");
    return [drawn("polygon", { points, class: "range" }), ...made];
  }

  strip(bottom) {
    const { x, regime } = this.data;
    const looks = new Map(this.regimes.map((one) => [one.value, one.colour]));
    const values = regime ? Array.from(x.values, (_, i) => regime.at(i)) : [];
    return stretches(values).map(([from, to]) => {
      const [start, end] = [from, to].map((k) => this.x.place(x.values[k]));
      return drawn("rect", { x: start, width: end - start, y: bottom - STRIP, height: STRIP, fill: looks.get(values[from]) ?? "none" });
    });
  }

  // Points that were measured, of [value of x, value of the line], or null.
  points(points) {
    this.measured = points;
    this.redraw();
  }

  // Marks are {x, text}; a text stands to the left of its line where there is no room, or another line, on the right.
  drawMarks() {
    const { width, height } = this.size;
    const bottom = height - FRAME.bottom;
    const points = (this.measured ?? []).map(([x, y]) => drawn("circle", { cx: this.x.place(x), cy: this.y.place(y), r: 4, class: "measured" }));
    const marks = Object.values(this.marks).flat().map(({ x, text }) => ({ at: this.x.place(x), text }));
    const lines = marks.flatMap(({ at, text }, k) => {
      const isLeft = at > 0.75 * width || marks.some((other) => other.at > at && other.at < at + 80);
      return [
        drawn("line", { x1: at, x2: at, y1: FRAME.top, y2: bottom, class: "marked" }),
        drawn("text", { x: at + (isLeft ? -6 : 6), y: FRAME.top + 12 + 16 * k, "text-anchor": isLeft ? "end" : "start", class: "label haloed" }, text ?? ""),
      ];
    });
    fill(this.drawnMarks, ...points, ...lines);
  }

  told(i) {
    const { x, z, low, high, regime } = this.data;
    const band = low ? ` (${withUnit(low[i], z.unit)} to ${withUnit(high[i], z.unit)})` : "";
    return [`${words(x.name)} ${withUnit(x.values[i], x.unit)}`, `${words(z.name)} ${withUnit(this.values[i], z.unit)}${band}`, regime && words(regime.names[regime.at(i)] ?? "")];
  }
}

// A trade-off: designs that nothing beats in both outputs, {values}.
export class Front extends Curves {
  // `onpoint(index)` hears of the design at the cursor, `onpick(index)` of the one chosen; `tell(index)` is what it says.
  constructor(host, { designs, output, against, first, tell, onpoint, onpick }) {
    super(host, { title: "Trade-off", onpick: () => onpick(this.cell().i) });
    this.tell = tell;
    this.onpoint = onpoint;
    const { unit } = designs[0].values[against];
    const sizes = designs.map(({ values }) => Math.abs(values[against].value));
    const at = (i) => designs[i].values[output].value;
    this.cursor = { x: sizes[first] };
    this.points(sizes.map((size, i) => [size, at(i)]));
    this.show({ x: { name: against, unit, values: sizes, title: `Size of the ${label(against, unit).replace(/^./, (one) => one.toLowerCase())}` }, z: { name: output, unit: designs[0].values[output].unit, at }, regime: null });
  }

  told(i) {
    return this.tell(i);
  }

  move(cursor) {
    super.move(cursor);
    if (this.cursor) this.onpoint(this.cell().i);
  }
}
