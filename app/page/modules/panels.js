// Curves of a motion over one cycle, coloured by what the part does; a line shows the moment.

import { MODES, PARTS, cycleOf, stretches } from "./course.js";
import { drawn, fill } from "./elements.js";
import { capital, number, shown } from "./words.js";

const PANEL = 88; // px
const CURVE = 60; // px, of its height
const OF_ROW = 2.5; // times as high: there is one
const LEFT = 64; // px, as of a map
const PHASES = 30; // px, of what the part does, above the curves
const RIGHT = 8; // px
const LEAST = 280; // px
const SMALL = 1e-5; // m: less is told in micrometres

export class Panels {
  constructor() {
    this.svg = drawn("svg", { class: "panels", "aria-hidden": "true" });
  }

  // What is drawn of a course: {name, unit, lines of {values, modes, stroke}}.
  curves({ along, height, wall, modes, row, unit }) {
    if (row) {
      const lines = row.ahead.map((values, i) => ({ values, stroke: PARTS[i % PARTS.length] }));
      return [{ name: "ahead of the mean travel", unit: "m", lines }];
    }
    const named = { "position on the track": along, "height above the floor": height, ...(wall ? { "distance from the wall": wall } : {}) };
    return Object.entries(named).map(([name, values]) => ({ name, unit, lines: [{ values, modes }] }));
  }

  draw(course) {
    this.course = course;
    const panels = this.curves(course);
    this.width = Math.max(LEAST, this.svg.clientWidth);
    this.tall = course.row ? OF_ROW : 1;
    const top = course.row ? 0 : PHASES;
    const height = top + this.tall * PANEL * panels.length;
    this.svg.setAttribute("viewBox", `0 0 ${this.width} ${height}`);
    this.now = drawn("line", { y1: 0, y2: height, class: "now" });
    fill(this.svg, ...(course.row ? [] : this.phases(course)), ...panels.flatMap((panel, place) => this.panel(panel, top + place * PANEL)), this.now);
  }

  across(time) {
    const { times } = this.course;
    return LEFT + ((time - times[0]) / cycleOf(this.course)) * (this.width - LEFT - RIGHT);
  }

  // What the part does when, as a bar with words where they have room.
  phases({ times, modes }) {
    return stretches(modes).flatMap(([from, to]) => {
      const [look, text] = MODES[modes[from]] ?? MODES.unknown;
      const [x, end] = [this.across(times[from]), this.across(times[to])];
      const said = text.replace("slides ", "");
      return [
        drawn("rect", { x, y: 0, width: Math.max(0, end - x), height: 20, class: `phase ${look}` }),
        ...(end - x > 8 * said.length + 6 ? [drawn("text", { x: (x + end) / 2, y: 14.5, "text-anchor": "middle", class: "on" }, said)] : []),
      ];
    });
  }

  panel({ name, unit, lines }, above) {
    const top = above + 22;
    const all = lines.flatMap(({ values }) => values);
    const [low, high] = [Math.min(...all), Math.max(...all)];
    const largest = Math.max(Math.abs(low), Math.abs(high));
    const [factor, unitShown] = unit === "m" && largest < SMALL ? [1e6, "µm"] : shown(unit);
    const step = 10 ** (Math.floor(Math.log10(factor * largest || 1)) - 2); // what is smaller is not told
    const tall = this.tall * PANEL - (PANEL - CURVE);
    const up = (value) => top + tall - ((value - low) / (high - low || 1)) * tall;
    const end = (value) => drawn("text", { x: LEFT - 8, y: up(value) + 4, "text-anchor": "end" }, number(Math.round((value * factor) / step) * step, 2));
    const zero = low < 0 && high > 0 ? [drawn("line", { x1: LEFT, x2: this.width - RIGHT, y1: up(0), y2: up(0), class: "level" })] : [];
    return [
      drawn("text", { x: LEFT + 6, y: top - 6, class: "pale" }, `${capital(name)}, ${unitShown}`),
      ...zero,
      end(high),
      end(low),
      ...lines.flatMap((one) => this.line(one, up)),
    ];
  }

  line({ values, modes, stroke }, up) {
    const { times } = this.course;
    const points = (from, to) => values.slice(from, to + 1).map((value, k) => `${this.across(times[from + k]).toFixed(1)},${up(value).toFixed(1)}`).join(" ");
    if (stroke) return [drawn("polyline", { points: points(0, values.length - 1), class: "course own", stroke })];
    return stretches(modes).map(([from, to]) => drawn("polyline", { points: points(from, to), class: `course ${(MODES[modes[from]] ?? MODES.unknown)[0]}` }));
  }

  // Show a moment of the cycle, from 0 on.
  at(time) {
    const x = this.across(time + this.course.times[0]);
    this.now.setAttribute("x1", x);
    this.now.setAttribute("x2", x);
  }
}
