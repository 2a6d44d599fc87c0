// Curves of a motion over one cycle, coloured by what the part does. A line shows the moment: it is
// dragged, or moved by the arrow keys.

import { MODES, PARTS, cycleOf, stretches } from "./course.js";
import { drawn, fill } from "./elements.js";
import { capital, number, shown } from "./words.js";

const PANEL = 88; // px
const CURVE = 60; // px, of its height
const OF_ROW = 2.5; // times as high: there is one
const TITLE = 20; // px, above the bars of a row
const BAR = 14; // px, for the bar of two neighbours
const LEFT = 44; // px
const PHASES = 30; // px, of what the part does, above the curves
const RIGHT = 8; // px
const LEAST = 280; // px
const STEP = 0.01; // of a cycle

export class Panels {
  // `ontime(time)` hears of a moment that was chosen.
  constructor(ontime) {
    this.ontime = ontime;
    this.svg = drawn("svg", {
      class: "panels",
      tabindex: "0",
      role: "slider",
      "aria-label": "Moment of the motion",
      "aria-valuemin": "0",
      "aria-valuemax": "100",
      "aria-valuenow": "0",
    });
    this.svg.addEventListener("pointerdown", (event) => {
      this.svg.setPointerCapture(event.pointerId);
      this.choose(event);
    });
    this.svg.addEventListener("pointermove", (event) => {
      if (this.svg.hasPointerCapture(event.pointerId)) this.choose(event);
    });
    this.svg.addEventListener("keydown", (event) => this.press(event));
  }

  choose(event) {
    if (!this.course) return;
    const box = this.svg.getBoundingClientRect();
    const at = ((event.clientX - box.left) / box.width) * this.width;
    this.ontime(((at - LEFT) / (this.width - LEFT - RIGHT)) * cycleOf(this.course));
  }

  press(event) {
    if (!this.course) return;
    const cycle = cycleOf(this.course);
    const to = {
      ArrowLeft: this.time - STEP * cycle,
      ArrowDown: this.time - STEP * cycle,
      ArrowRight: this.time + STEP * cycle,
      ArrowUp: this.time + STEP * cycle,
      Home: 0,
      End: (1 - STEP) * cycle,
    }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    this.ontime(to);
  }

  // What is drawn of a course: {name, unit, lines of {values, modes, stroke}}.
  curves({ along, height, wall, modes, row, unit }) {
    if (row) {
      const lines = row.ahead.map((values, i) => ({ values, stroke: PARTS[i % PARTS.length] }));
      return [{ name: "ahead of the mean travel", unit: "m", lines }];
    }
    const found = [
      { name: "position on the track", unit, lines: [{ values: along, modes }] },
      { name: "height above the floor", unit, lines: [{ values: height, modes }] },
    ];
    if (wall) found.push({ name: "distance from the wall", unit, lines: [{ values: wall, modes }] });
    return found;
  }

  draw(course) {
    this.course = course;
    const panels = this.curves(course);
    this.width = Math.max(LEAST, this.svg.clientWidth);
    this.tall = course.row ? OF_ROW : 1;
    const bars = course.row ? TITLE + BAR * course.row.closed.length : 0;
    const curves = this.tall * PANEL * panels.length;
    const top = course.row ? 0 : PHASES;
    const height = top + curves + bars + 30;
    this.svg.setAttribute("viewBox", `0 0 ${this.width} ${height}`);
    const parts = panels.flatMap((panel, place) => this.panel(panel, top + place * PANEL));
    if (top) parts.push(...this.phases(course));
    if (bars) parts.push(...this.touching(course, curves));
    this.now = drawn("line", { y1: 0, y2: height - 22, class: "now" });
    this.knob = drawn("circle", { cy: height - 13, r: 9, class: "knob" });
    this.told = drawn("text", { y: height - 8 }, "0 ms");
    parts.push(drawn("text", { x: this.width - RIGHT, y: height - 8, "text-anchor": "end" }, `${number(1000 * cycleOf(course), 3)} ms`), this.now, this.knob, this.told);
    fill(this.svg, ...parts);
  }

  across(time) {
    const { times } = this.course;
    return LEFT + ((time - times[0]) / cycleOf(this.course)) * (this.width - LEFT - RIGHT);
  }

  // What the part does when, as a bar with words where they have room.
  phases({ times, modes }) {
    return stretches(modes).flatMap(([from, to]) => {
      const [look, text] = MODES[modes[from]] ?? MODES.unknown;
      const [x, end] = [from, to].map((k) => this.across(times[k]));
      const said = text.replace("slides ", "");
      const bar = drawn("rect", { x, y: 0, width: Math.max(0, end - x), height: 20, class: `phase ${look}` });
      const isWide = end - x > 8 * said.length + 6;
      return isWide ? [bar, drawn("text", { x: (x + end) / 2, y: 14.5, "text-anchor": "middle", class: "on" }, said)] : [bar];
    });
  }

  panel({ name, unit, lines }, above) {
    const top = above + 22;
    const [factor, unitShown] = shown(unit);
    const all = lines.flatMap(({ values }) => values);
    const low = Math.min(...all);
    const high = Math.max(...all);
    const size = factor * Math.max(Math.abs(low), Math.abs(high));
    const tall = this.tall * PANEL - (PANEL - CURVE);
    const up = (value) => top + tall - ((value - low) / (high - low || 1)) * tall;
    const end = (value) => drawn("text", { x: LEFT - 8, y: up(value) + 4, "text-anchor": "end" }, number(value * factor, 2, size));
    const zero = low < 0 && high > 0 ? [drawn("line", { x1: LEFT, x2: this.width - RIGHT, y1: up(0), y2: up(0), class: "level" })] : [];
    return [
      drawn("text", { x: LEFT, y: top - 6, class: "pale" }, `${capital(name)}, ${unitShown}`),
      ...zero,
      end(high),
      end(low),
      ...lines.flatMap((one) => this.line(one, up)),
    ];
  }

  // While which neighbours of a row touch, a line of bars for each two.
  touching({ times, row }, above) {
    const bars = row.closed.flatMap((closed, i) => {
      const y = above + TITLE + BAR * (i + 0.5);
      const name = drawn("text", { x: LEFT - 6, y: y + 4, "text-anchor": "end" }, `${i + 1}, ${i + 2}`);
      const touches = stretches(closed).filter(([from]) => closed[from]);
      return [name, ...touches.map(([from, to]) => drawn("line", { x1: this.across(times[from]), x2: this.across(times[to]), y1: y, y2: y, class: "touching" }))];
    });
    return [drawn("text", { x: LEFT, y: above + TITLE - 6, class: "label" }, "Neighbours that touch"), ...bars];
  }

  line({ values, modes, stroke: own }, up) {
    const { times } = this.course;
    const at = (k) => `${this.across(times[k]).toFixed(1)},${up(values[k]).toFixed(1)}`;
    if (!modes) {
      const points = values.map((_, k) => at(k)).join(" ");
      return [drawn("polyline", own ? { points, class: "course own", stroke: own } : { points, class: "track" })];
    }
    return stretches(modes).map(([from, to]) => {
      const points = Array.from({ length: to - from + 1 }, (_, k) => at(from + k)).join(" ");
      const [look] = MODES[modes[from]] ?? MODES.unknown;
      return drawn("polyline", { points, class: `course ${look}` });
    });
  }

  // Show a moment of the cycle, from 0 on.
  at(time) {
    this.time = time;
    const x = this.across(time + this.course.times[0]);
    this.now.setAttribute("x1", x);
    this.now.setAttribute("x2", x);
    this.knob.setAttribute("cx", x);
    this.told.setAttribute("x", Math.min(x + 14, this.width - 100));
    this.told.textContent = `${number(1000 * time, 2)} ms`;
  }

  // The same for screen readers, which do not want to hear of each frame.
  tell(text) {
    this.svg.setAttribute("aria-valuenow", String(Math.round((100 * this.time) / cycleOf(this.course))));
    this.svg.setAttribute("aria-valuetext", `${number(1000 * this.time, 3)} ms, ${text.slice(0, 1).toLowerCase()}${text.slice(1)}`);
  }
}
