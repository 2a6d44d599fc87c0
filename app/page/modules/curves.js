// Quantities over one parameter, with a band where something is uncertain, and the regimes below.

import { axesDrawn, axisOf, FRAME } from "./axes.js";
import { drawn, element, fill } from "./elements.js";
import { svgDocument } from "./exported.js";
import { legendOf, occurring } from "./legend.js";
import { capital, withUnit, words } from "./words.js";

const STRIP = 8; // px, of the regimes
const ROOM = 0.04; // of the range of values, above and below
const INKS = 6; // classes of lines

export class Curves {
  /**
   * `onpick({x})` hears of a place that is chosen.
   * @param {HTMLElement} host
   * @param {{onpick?: Function, title?: string, [name: string]: any}} options
   */
  constructor(host, { onpick = () => {}, title = "Lines" } = {}) {
    this.onpick = onpick;
    this.marks = {}; // by who sets them
    this.svg = drawn("svg", { "aria-hidden": "true", preserveAspectRatio: "none" });
    this.said = element("p", { class: "said", "aria-live": "polite" });
    this.legend = element("ul", { class: "legend", "aria-label": "Lines and regimes" });
    this.box = element(
      "div",
      {
        class: "curves",
        tabindex: "0",
        role: "application",
        "aria-label": `${title}: left and right move the cursor, Enter chooses its place`,
        onpointermove: (event) => this.move(this.under(event)),
        onpointerleave: () => this.move(null),
        onclick: (event) => this.onpick({ x: this.data.x.values[this.under(event)] }),
        onkeydown: (event) => this.press(event),
      },
      this.svg,
    );
    fill(host, this.box, this.said, this.legend);
    this.at = null; // the place of the cursor among the values
    new ResizeObserver(() => requestAnimationFrame(() => this.draw())).observe(this.box);
  }

  // data: {x: {name, unit, values}, lines: [{name, unit, values, low, high, label}], regime or null, look}
  show(data) {
    this.data = data;
    this.regimes = occurring(data, data.look);
    const named = data.lines.map((line, place) => element("li", {}, element("i", { class: `swatch line-${place % INKS}` }), capital(words(line.label ?? line.name))));
    fill(this.legend, ...(data.lines.length > 1 ? named : []), ...legendOf(this.regimes));
    this.draw();
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (!this.data || width < 80 || height < 80) return;
    const { x, lines } = this.data;
    const { left, right, top, bottom } = FRAME;
    this.across = axisOf(x, left, width - right);
    const all = [...lines.flatMap(({ values, low, high }) => [...values, ...(low ?? []), ...(high ?? [])]), ...(this.measured ?? []).map(([, y]) => y)].filter(Number.isFinite);
    let [least, most] = [Math.min(...all), Math.max(...all)];
    if (!all.length) [least, most] = [0, 1];
    if (least > 0 && least < 0.5 * most) least = 0;
    const room = ROOM * (most - least) || Math.abs(most) || 1;
    this.up = axisOf({ ...lines[0], values: [least - (least === 0 ? 0 : room), most + room] }, height - bottom - STRIP, top);
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.box.style.setProperty("--ratio", `${width} / ${height}`);
    this.cursor = drawn("g", { class: "lines-cursor" });
    fill(this.svg, ...this.strip(height - bottom), ...lines.flatMap((line, place) => this.line(line, place)), axesDrawn(this.across, this.up, width, height), ...this.marked(height - bottom), this.cursor);
    this.move(this.at);
  }

  // Lines end where there is no value.
  path(values) {
    let isBroken = true;
    return Array.from(values, (value, i) => {
      if (!Number.isFinite(value)) {
        isBroken = true;
        return "";
      }
      const step = `${isBroken ? "M" : "L"}${this.across.place(this.data.x.values[i]).toFixed(1)} ${this.up.place(value).toFixed(1)}`;
      isBroken = false;
      return step;
    }).join("");
  }

  line({ values, low, high }, place) {
    const made = [drawn("path", { d: this.path(values), class: `line line-${place % INKS}` })];
    if (!low) return made;
    const there = [...values.keys()].filter((i) => Number.isFinite(low[i]) && Number.isFinite(high[i]));
    const at = (list, i) => `${this.across.place(this.data.x.values[i]).toFixed(1)},${this.up.place(list[i]).toFixed(1)}`;
    const points = [...there.map((i) => at(high, i)), ...there.reverse().map((i) => at(low, i))].join(" ");
    return [drawn("polygon", { points, class: `range line-${place % INKS}` }), ...made];
  }

  strip(bottom) {
    const { x, regime } = this.data;
    const looks = new Map(this.regimes.map((one) => [one.value, one.colour]));
    const made = [];
    let from = 0;
    for (let i = 1; regime && i <= x.values.length; i++) {
      if (i < x.values.length && regime.at(i) === regime.at(from)) continue;
      const [start, end] = [from, Math.min(i, x.values.length - 1)].map((k) => this.across.place(x.values[k]));
      made.push(drawn("rect", { x: start, width: end - start, y: bottom - STRIP, height: STRIP, fill: looks.get(regime.at(from)) ?? "none" }));
      from = i;
    }
    return made;
  }

  // Set somebody's marks, of {x, text, isSmall, isLow}.
  mark(marks, whose) {
    this.marks[whose] = marks;
    this.draw();
  }

  // Points that were measured, of [value of x, value of the line], or null.
  points(points) {
    this.measured = points;
    this.draw();
  }

  marked(bottom) {
    const points = (this.measured ?? []).map(([x, y]) => drawn("circle", { cx: this.across.place(x), cy: this.up.place(y), r: 4, class: "measured" }));
    const lines = Object.values(this.marks).flat().flatMap(({ x, text, isSmall, isLow }) => {
      const at = this.across.place(x);
      const isRight = at > 0.75 * this.box.clientWidth;
      return [
        drawn("line", { x1: at, x2: at, y1: isSmall ? bottom - 3 * STRIP : FRAME.top, y2: bottom, class: "marked" }),
        drawn("text", { x: at + (isRight ? -6 : 6), y: FRAME.top + (isLow ? 30 : 12), "text-anchor": isRight ? "end" : "start", class: "label haloed" }, text ?? ""),
      ];
    });
    return [...points, ...lines];
  }

  // The value nearest to the pointer.
  under(event) {
    if (!this.across) return null;
    const wanted = this.across.value(event.clientX - this.box.getBoundingClientRect().left);
    const { values } = this.data.x;
    let best = 0;
    for (let i = 1; i < values.length; i++) if (Math.abs(values[i] - wanted) < Math.abs(values[best] - wanted)) best = i;
    return best;
  }

  press(event) {
    const last = this.data.x.values.length - 1;
    const step = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
    if (event.key === "Enter" && this.at !== null) this.onpick({ x: this.data.x.values[this.at] });
    else if (step) this.move(Math.max(0, Math.min(last, (this.at ?? Math.round(last / 2)) + step * (event.shiftKey ? 10 : 1))));
    else return;
    event.preventDefault();
  }

  // Show the cursor at a place, and say what is there; null for none.
  move(i) {
    this.at = i;
    if (!this.cursor) return;
    const { x, lines, regime } = this.data;
    if (i === null || i >= x.values.length) {
      fill(this.cursor);
      this.said.textContent = "";
      return;
    }
    const at = this.across.place(x.values[i]);
    fill(this.cursor, drawn("line", { x1: at, x2: at, y1: FRAME.top, y2: this.box.clientHeight - FRAME.bottom }));
    const parts = [`${words(x.name)} ${withUnit(x.values[i], x.unit)}`];
    for (const line of lines) {
      const band = line.low ? ` (${withUnit(line.low[i], line.unit)} to ${withUnit(line.high[i], line.unit)})` : "";
      parts.push(`${words(line.label ?? line.name)} ${withUnit(line.values[i], line.unit)}${band}`);
    }
    if (regime) parts.push(words(regime.names[regime.at(i)] ?? ""));
    this.said.textContent = capital(parts.filter(Boolean).join(", "));
  }

  // The lines as one SVG document.
  svgText(style, told) {
    const copy = this.svg.cloneNode(true);
    copy.querySelector(".lines-cursor")?.remove();
    const { clientWidth: width, clientHeight: height } = this.box;
    return svgDocument([...copy.childNodes], { width, height, style, told, regimes: this.regimes });
  }
}
