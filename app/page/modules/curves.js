// Quantities over one parameter, with a band where something is uncertain, and the regimes below.

import { axesDrawn, axisOf, FRAME } from "./axes.js";
import { stretches } from "./course.js";
import { drawn, element, fill } from "./elements.js";
import { legendOf, occurring } from "./legend.js";
import { Plot } from "./plot.js";
import { capital, withUnit, words } from "./words.js";

const STRIP = 8; // px, of the regimes
const ROOM = 0.04; // of the range of values, above and below
const INKS = 6; // classes of lines

export class Curves extends Plot {
  constructor(host, { onpick, title = "Lines" }) {
    const legend = element("ul", { class: "legend", "aria-label": "Lines and regimes" });
    super(host, { onpick, name: "curves", label: `${title}: left and right`, after: [legend] });
    this.legend = legend;
  }

  // data: {x: {name, unit, values}, lines: [{name, unit, values, low, high, label}], regime or null, look}
  show(data) {
    this.data = data;
    this.regimes = occurring(data, data.look);
    const named = data.lines.map((line, place) => element("li", {}, element("i", { class: `swatch line-${place % INKS}` }), capital(words(line.label ?? line.name))));
    fill(this.legend, ...(data.lines.length > 1 ? named : []), ...legendOf(this.regimes));
    this.redraw();
  }

  draw() {
    const { width, height } = this.size;
    const { x, lines } = this.data;
    const { left, right, top, bottom } = FRAME;
    this.x = axisOf(x, left, width - right);
    const all = [...lines.flatMap(({ values, low, high }) => [...values, ...(low ?? []), ...(high ?? [])]), ...(this.measured ?? []).map(([, y]) => y)].filter(Number.isFinite);
    let [least, most] = all.length ? [Math.min(...all), Math.max(...all)] : [0, 1];
    if (least > 0 && least < 0.5 * most) least = 0;
    const room = ROOM * (most - least) || Math.abs(most) || 1;
    this.y = axisOf({ ...lines[0], values: [least - (least === 0 ? 0 : room), most + room] }, height - bottom - STRIP, top);
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.box.style.setProperty("--ratio", `${width} / ${height}`);
    this.drawnMarks = drawn("g");
    fill(this.svg, ...this.strip(height - bottom), ...lines.flatMap((line, place) => this.line(line, place)), axesDrawn(this.x, this.y, width, height), this.drawnMarks);
    this.drawMarks();
  }

  // Lines end where there is no value.
  path(values) {
    const isThere = (i) => Number.isFinite(values[i]);
    const places = [...values.keys()].filter(isThere);
    return places.map((i) => `${isThere(i - 1) ? "L" : "M"}${this.x.place(this.data.x.values[i]).toFixed(1)} ${this.y.place(values[i]).toFixed(1)}`).join("");
  }

  line({ values, low, high }, place) {
    const made = [drawn("path", { d: this.path(values), class: `line line-${place % INKS}` })];
    if (!low) return made;
    const there = [...values.keys()].filter((i) => Number.isFinite(low[i]) && Number.isFinite(high[i]));
    const at = (list, i) => `${this.x.place(this.data.x.values[i]).toFixed(1)},${this.y.place(list[i]).toFixed(1)}`;
    const points = [...there.map((i) => at(high, i)), ...there.reverse().map((i) => at(low, i))].join(" ");
    return [drawn("polygon", { points, class: `range line-${place % INKS}` }), ...made];
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

  // Marks are {x, text, isSmall, isLow}.
  drawMarks() {
    const { width, height } = this.size;
    const bottom = height - FRAME.bottom;
    const points = (this.measured ?? []).map(([x, y]) => drawn("circle", { cx: this.x.place(x), cy: this.y.place(y), r: 4, class: "measured" }));
    const lines = Object.values(this.marks).flat().flatMap(({ x, text, isSmall, isLow }) => {
      const at = this.x.place(x);
      const isRight = at > 0.75 * width;
      return [
        drawn("line", { x1: at, x2: at, y1: isSmall ? bottom - 3 * STRIP : FRAME.top, y2: bottom, class: "marked" }),
        drawn("text", { x: at + (isRight ? -6 : 6), y: FRAME.top + (isLow ? 30 : 12), "text-anchor": isRight ? "end" : "start", class: "label haloed" }, text ?? ""),
      ];
    });
    fill(this.drawnMarks, ...points, ...lines);
  }

  told(i) {
    const { x, lines, regime } = this.data;
    const band = ({ low, high, unit }) => (low ? ` (${withUnit(low[i], unit)} to ${withUnit(high[i], unit)})` : "");
    const values = lines.map((line) => `${words(line.label ?? line.name)} ${withUnit(line.values[i], line.unit)}${band(line)}`);
    return [`${words(x.name)} ${withUnit(x.values[i], x.unit)}`, ...values, regime && words(regime.names[regime.at(i)] ?? "")];
  }
}
