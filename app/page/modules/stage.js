// The part on its track, to scale, its movement enlarged; the line of vibration and the slope of the track are
// handles that are dragged, or moved by keys.

import { MODES, PARTS as INKS, between, cycleOf, platoonsAt, stretches } from "./course.js";
import { arrowOf, drawn, fill } from "./elements.js";
import { partDrawn, partOf } from "./parts.js";
import { endsOf } from "./slider.js";
import { number, withUnit } from "./words.js";

const ENLARGED = [1, 2, 3, 5, 8, 10, 20];
const RADIANS = Math.PI / 180;
const DOTS = 14; // along the path, at equal times
const TRACK = 22; // px
const STEEP = 45; // degrees, as far as the track is drawn tilted

export class Stage {
  // `onmove(values, {isOver})` hears of values that a handle is moved to.
  constructor(host, onmove) {
    this.onmove = onmove;
    this.svg = drawn("svg", { class: "stage", role: "group", "aria-label": "The part on its track, from the side" });
    this.shown = null;
    this.size = { width: 0, height: 0 };
    this.enlarged = 0;
    this.time = 0;
    this.turns = 0;
    // Of the drawing, in px: where floor, vibration and part are, px a metre of movement, and the size of the part.
    [this.floor, this.pivot, this.across, this.moved, this.wide, this.tall] = [0, 0, 0, 1, 0, 0];
    this.part = null;
    fill(host, this.svg);
    this.scenery = drawn("g");
    new ResizeObserver(() => requestAnimationFrame(() => this.redraw())).observe(host);
    this.vibration = this.handle("Line of vibration: left and right change the amplitude, up and down the angle", (event) => this.dragLine(event), (across, up) => this.keyLine(across, up));
    this.slope = this.handle("Climb of the track", (event) => this.dragSlope(event), (across, up) => this.turn((this.shown.view.values.gamma ?? 0) + 0.5 * (across + up), true));
    // Drawn once: what is dragged stays where it is among the elements.
    this.tilted = drawn("g", {}, this.vibration);
    fill(this.svg, this.scenery, this.tilted, this.slope);
  }

  // A round handle: one stop of the keyboard, 44 px wide.
  handle(label, drag, press) {
    const made = drawn(
      "g",
      { class: "handle", tabindex: "0", role: "slider", "aria-label": label, "aria-valuenow": 0 },
      drawn("circle", { r: 22, class: "reach" }),
      drawn("circle", { r: 10, class: "knob" }),
    );
    made.addEventListener("pointerdown", (event) => {
      made.setPointerCapture(event.pointerId);
      made.focus({ preventScroll: true });
      this.dragged = this.shown.view.values; // as they were before
      made.classList.add("held");
      event.preventDefault();
    });
    made.addEventListener("pointermove", (event) => made.hasPointerCapture(event.pointerId) && this.dragged && drag(event));
    const leave = (values) => {
      if (!this.dragged) return;
      this.dragged = null;
      made.classList.remove("held");
      this.onmove(values, { isOver: true });
      this.redraw();
    };
    for (const name of ["pointerup", "pointercancel"]) made.addEventListener(name, () => leave({}));
    made.addEventListener("keydown", (event) => {
      const steps = arrowOf(event);
      if (event.key === "Escape" && this.dragged) leave(this.dragged);
      if (!steps) return;
      event.preventDefault();
      press(...steps);
    });
    return made;
  }

  // `shown` is {view, scene, course, hop}.
  show(shown) {
    this.shown = shown;
    this.redraw();
  }

  redraw() {
    if (!this.shown) return;
    const width = Math.max(280, this.svg.parentElement.clientWidth);
    const height = width < 430 ? 240 : Math.min(380, Math.round(0.5 * width));
    this.size = { width, height };
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.svg.style.setProperty("--ratio", `${width} / ${height}`);
    this.place();
    this.draw();
  }

  // How px, part and movement go together.
  place() {
    const { view, course } = this.shown;
    const { width, height } = this.size;
    const isNarrow = width < 430;
    const part = partOf(view);
    const wide = course?.row ? 0.11 * width : Math.min(0.27 * width, (0.36 * height * part.length) / part.height);
    const scale = course?.row ? wide / (course.row.length || 0.01) : (1000 * wide) / part.length; // px a metre
    const amplitude = this.amplitude();
    const reach = amplitude ?? Math.max(1e-9, ...(course?.trackAlong ?? [0]).map(Math.abs), ...(course?.trackNormal ?? [0]).map(Math.abs));
    const travel = course && !course.row ? Math.abs(course.along.at(-1) - course.along[0]) : 0;
    const most = course ? Math.max(...course.height) : 0;
    const fits = (times) =>
      reach * scale * times <= 0.16 * width && travel * scale * times <= 0.34 * width && most * scale * times <= 0.22 * height;
    if (!this.dragged || !this.enlarged) this.enlarged = ENLARGED.filter(fits).at(-1) ?? 1;
    const across = course?.row ? 0.42 * width : (isNarrow ? 0.46 : 0.48) * width;
    this.part = part;
    this.wide = wide * (course?.row ? 0.92 : 1);
    this.tall = course?.row ? 0.5 * wide : (wide * part.height) / part.length;
    this.moved = scale * this.enlarged;
    this.floor = Math.round(0.69 * height);
    this.pivot = 0.16 * width;
    this.across = across;
  }

  // Whether the drive is an ellipse, whose two amplitudes are one handle.
  isEllipse() {
    const { values } = this.shown.view;
    return "amplitude_along_1" in values && "amplitude_normal_1" in values;
  }

  // The middle of the closed path of a track, above its floor.
  middle() {
    return this.floor - 0.16 * this.size.height;
  }

  amplitude() {
    const { values } = this.shown.view;
    if (!("beta" in values)) return null;
    const sine = Math.sin(values.beta * RADIANS);
    return values.amplitude ?? (values.peak_to_peak ? values.peak_to_peak / 2 : sine && values.vertical_amplitude ? values.vertical_amplitude / Math.abs(sine) : null);
  }

  draw() {
    const { width } = this.size;
    const { view, course } = this.shown;
    const slope = view.values.gamma ?? 0;
    const tilt = Math.max(-STEEP, Math.min(STEEP, slope));
    const transform = `rotate(${-tilt} ${width / 2} ${this.floor})`;
    this.tilted.setAttribute("transform", transform);
    this.vibration.toggleAttribute("hidden", this.amplitude() === null && !this.isEllipse());
    this.slope.toggleAttribute("hidden", !("gamma" in view.values));
    const turning = drawn("g", { transform });
    this.moving = drawn("g", { class: "moving" });
    const { beneath, above } = this.path();
    fill(turning, ...this.feeder(), ...beneath, this.moving, ...above, ...this.line());
    const parts = [turning, ...this.climb(tilt, slope)];
    const enlarged = this.enlarged > 1 ? `movement ${this.enlarged} times enlarged` : "movement to scale";
    const isNarrow = width < 430;
    parts.push(drawn("text", { x: isNarrow ? 12 : width - 16, y: this.size.height - 6, "text-anchor": isNarrow ? "start" : "end", class: "pale haloed" }, course ? (isNarrow ? enlarged : `Part to scale, its ${enlarged}`) : "Part to scale, at rest"));
    if (!isNarrow && !this.vibration.hasAttribute("hidden")) {
      parts.push(drawn("text", { x: 16, y: this.size.height - 6, class: "pale haloed" }, "Drag a blue handle."));
    }
    fill(this.scenery, ...parts);
    this.moment(this.time, this.turns);
  }

  feeder() {
    const { width } = this.size;
    const { floor } = this;
    const leg = this.size.height - floor - TRACK - 32;
    const leaf = (x) => drawn("path", { d: `M${x} ${floor + TRACK}l${0.38 * leg} ${leg}`, class: "leaf" });
    return [
      drawn("rect", { x: 0.022 * width, y: floor, width: 0.95 * width, height: TRACK, class: "trough" }),
      leaf(0.2 * width),
      leaf(0.74 * width),
      drawn("rect", { x: 0.08 * width, y: floor + TRACK + leg, width: 0.83 * width, height: 9, class: "trough" }),
      drawn("line", { x1: 0.022 * width, x2: 0.972 * width, y1: floor, y2: floor, class: "floor" }),
    ];
  }

  // Where the middle of the part is on the screen at a place of the course.
  at(along, height) {
    return [this.across + along * this.moved, this.floor - this.tall / 2 - height * this.moved];
  }

  path() {
    const { course, hop } = this.shown;
    if (!course || course.row) return { beneath: [], above: [] };
    const { along, height, modes, times } = course;
    const start = along[0];
    const beneath = [];
    const made = [];
    const travel = (along.at(-1) - start) * this.moved;
    if (Math.abs(travel) > 3) {
      beneath.push(partDrawn(this.part, this.wide, this.tall, { class: "part later", transform: `translate(${this.across + travel} ${this.floor})` }));
      const top = Math.min(this.floor - this.tall - 0.11 * this.size.height, this.at(0, Math.max(...height))[1] - 34);
      const [from, to] = [this.across, this.across + travel].sort((a, b) => a - b);
      made.push(
        drawn("path", { d: `M${from} ${top - 5}V${this.floor - this.tall}M${to} ${top - 5}V${this.floor - this.tall}`, class: "dotted" }),
        drawn("path", { d: `M${from} ${top}H${to}M${from + 8} ${top - 4}L${from} ${top}L${from + 8} ${top + 4}M${to - 8} ${top - 4}L${to} ${top}L${to - 8} ${top + 4}`, class: "measure" }),
        drawn("text", { x: (from + to) / 2, y: top - 8, "text-anchor": "middle" }, `${withUnit(along.at(-1) - start, course.unit, 2)} a cycle${this.size.width < 430 ? "" : ` (${number(1000 * cycleOf(course), 3)} ms)`}`),
      );
    }
    const points = along.map((one, k) => this.at(one - start, height[k]).map((place) => place.toFixed(1)).join(","));
    const runs = stretches(modes).map(([from, to]) => drawn("polyline", { points: points.slice(from, to + 1).join(" "), class: `run ${(MODES[modes[from]] ?? MODES.unknown)[0]}` }));
    made.push(drawn("polyline", { points: points.join(" "), class: "halo" }), ...runs);
    for (let k = 0; k <= DOTS; k++) {
      const i = Math.min(times.length - 1, Math.round((k / DOTS) * (times.length - 1)));
      const [cx, cy] = this.at(along[i] - start, height[i]);
      made.push(drawn("circle", { cx, cy, r: 3.6, class: "dot" }));
    }
    const highest = height.indexOf(Math.max(...height));
    if (hop > 0 && height[highest] * this.moved > 4) {
      const [x, y] = this.at(along[highest] - start, height[highest]);
      const low = this.at(0, 0)[1];
      made.push(
        drawn("path", { d: `M${x} ${y + 4}V${low}M${x - 4} ${y + 11}L${x} ${y + 4}L${x + 4} ${y + 11}M${x - 11} ${low}H${x + 11}`, class: "measure" }),
        drawn("text", { x: Math.min(x - 10, this.size.width - 60), y: Math.min(y - 12, this.floor - this.tall + 2), "text-anchor": "middle", class: "label haloed" }, `hops ${withUnit(hop, "m", 2)}`),
      );
    }
    return { beneath, above: made };
  }

  // The line of vibration with its handle; of another drive the closed path of the track.
  line() {
    const { course, view } = this.shown;
    const { pivot, floor } = this;
    const amplitude = this.amplitude();
    if (amplitude === null) {
      if (!course) return [];
      const points = course.trackAlong.map((x, i) => `${(pivot + x * this.moved).toFixed(1)},${(this.middle() - course.trackNormal[i] * this.moved).toFixed(1)}`);
      this.ball = drawn("circle", { r: 5, class: "ball" });
      if (this.isEllipse()) {
        const [along, normal] = [view.values.amplitude_along_1, view.values.amplitude_normal_1];
        this.vibration.setAttribute("transform", `translate(${pivot + along * this.moved} ${this.middle() - normal * this.moved})`);
        this.vibration.setAttribute("aria-valuenow", String(along * 1000));
        this.vibration.setAttribute("aria-valuetext", `${withUnit(along, "m", 3)} along, ${withUnit(normal, "m", 3)} off the floor`);
      }
      return [
        drawn("polyline", { points: points.join(" "), class: "vibration" }),
        this.ball,
        drawn("text", { x: pivot, y: floor - 0.02 * this.size.height - 6, "text-anchor": "middle", class: "blue" }, "path of the track"),
      ];
    }
    const { beta } = view.values;
    const long = Math.max(14, amplitude * this.moved);
    const [dx, dy] = [Math.cos(beta * RADIANS), -Math.sin(beta * RADIANS)];
    const tip = [pivot + long * dx, floor + long * dy];
    const radius = 0.6 * Math.min(long, 64);
    this.vibration.setAttribute("transform", `translate(${tip[0]} ${tip[1]})`);
    this.vibration.setAttribute("aria-valuenow", String(amplitude * 1000));
    const told = `${withUnit(amplitude, "m", 3)}, ${number(beta, 3)}°`;
    this.vibration.setAttribute("aria-valuetext", told);
    this.ball = drawn("circle", { cx: pivot, cy: floor, r: 4.5, class: "ball" });
    const isNarrow = this.size.width < 430;
    // The angle stands beside its arc where neither line nor handle is in its way, else with the amplitude.
    const isFree = beta < 0 || ((radius + 8) * Math.tan(beta * RADIANS) > 14 && (long * -dy > 29 || radius + 38 < long * dx - 12));
    const isOne = isNarrow || this.dragged || !isFree;
    const away = `M${pivot} ${floor}L${pivot - long * dx} ${floor - long * dy}`;
    return [
      drawn("path", { d: away, class: "vibration dashed" }),
      drawn("path", { d: `M${tip[0]} ${tip[1]}l${34 * dx} ${34 * dy}`, class: "vibration thin" }),
      drawn("path", { d: `M${pivot} ${floor}L${tip[0]} ${tip[1]}`, class: "vibration" }),
      drawn("path", { d: `M${pivot + radius} ${floor}A${radius} ${radius} 0 0 ${beta < 0 ? 1 : 0} ${pivot + radius * dx} ${floor + radius * dy}`, class: "vibration thin plain" }),
      this.ball,
      drawn("text", { x: isNarrow ? Math.max(8 * told.length, tip[0] + 6) : tip[0] - 10, y: tip[1] + (this.dragged ? -40 : Math.min(-20, 34 * dy - 4)), "text-anchor": isNarrow ? "end" : "middle", class: "blue label" }, isOne ? told : withUnit(amplitude, "m", 3)),
      ...(isOne ? [] : [drawn("text", { x: pivot + radius + 8, y: floor - 7, class: "blue label" }, `${number(beta, 3)}°`)]),
    ];
  }

  climb(tilt, slope) {
    if (!("gamma" in this.shown.view.values)) return [];
    const { width } = this.size;
    const long = 0.462 * width;
    const at = (angle, far = long) => [width / 2 + far * Math.cos(angle * RADIANS), this.floor - far * Math.sin(angle * RADIANS)];
    const [x, y] = at(tilt);
    this.slope.setAttribute("transform", `translate(${x} ${y})`);
    this.slope.setAttribute("aria-valuenow", String(slope));
    this.slope.setAttribute("aria-valuetext", `climb ${number(slope, 3)}°`);
    const [up, down] = [at(tilt + 7), at(tilt - 7)];
    const tipped = (/** @type {number[]} */ [px, py], sign) => `M${px - 5} ${py + sign * 7}L${px} ${py}L${px + 6} ${py + sign * 6}`;
    return [
      drawn("path", { d: `M${up.join(" ")}A${long} ${long} 0 0 1 ${down.join(" ")}${tipped(up, 1)}${tipped(down, -1)}`, class: "vibration thin plain solid" }),
      drawn("text", { x: Math.min(width - 10, x + 16), y: Math.min(this.size.height - 24, down[1] + 20), "text-anchor": "end", class: "blue label haloed" }, `climb ${number(slope, 3)}°`),
    ];
  }

  // Show a moment of the course: `turns` are the cycles before it.
  moment(time, turns) {
    this.time = time;
    this.turns = turns;
    const { course } = this.shown ?? {};
    if (!this.moving) return;
    if (!course) {
      fill(this.moving, partDrawn(this.part, this.wide, this.tall, { class: "part", transform: `translate(${this.across} ${this.floor})` }));
      return;
    }
    const now = time + course.times[0];
    const here = (values) => between(course, values, now);
    if (this.ball) {
      const lift = this.amplitude() === null ? this.floor - this.middle() : 0;
      this.ball.setAttribute("cx", this.pivot + here(course.trackAlong) * this.moved);
      this.ball.setAttribute("cy", this.floor - lift - here(course.trackNormal) * this.moved);
    }
    if (course.row) {
      fill(this.moving, ...this.rowDrawn(course.row, now, here));
      return;
    }
    const dx = (here(course.along) - course.along[0]) * this.moved;
    const dy = here(course.height) * this.moved;
    const pitch = course.pitch ? ` rotate(${-here(course.pitch)})` : "";
    fill(
      this.moving,
      partDrawn(this.part, this.wide, this.tall, { class: "part", transform: `translate(${this.across + dx} ${this.floor - dy})${pitch}` }),
      drawn("circle", { cx: this.across + dx, cy: this.floor - this.tall / 2 - dy, r: 5, class: "now-dot" }),
    );
  }

  // The parts of a row, by number from the rear: gaps are enlarged as movements are, a bar joins what touches.
  rowDrawn(row, now, here) {
    const parts = row.positions.map(here);
    const joined = new Set(platoonsAt(this.shown.course, now).flatMap((platoon) => platoon.slice(1)));
    let left = this.across - this.wide / 2;
    return parts.flatMap((position, i) => {
      const before = left;
      if (i) left += this.wide + Math.min(this.wide, Math.max(0, position - parts[i - 1] - row.length) * this.moved);
      const middle = left + this.wide / 2;
      const made = [
        drawn("rect", { x: left, y: this.floor - this.tall, width: this.wide - 1, height: this.tall, rx: 3, class: "body numbered" }),
        drawn("text", { x: middle, y: this.floor - this.tall / 2 + 5, "text-anchor": "middle", class: "label" }, String(i + 1)),
        drawn("rect", { x: left, y: this.floor - this.tall, width: this.wide - 1, height: 4, fill: INKS[i % INKS.length] }),
      ];
      if (joined.has(i + 1)) made.push(drawn("rect", { x: before + this.wide / 2, y: this.floor - this.tall - 8, width: middle - before - this.wide / 2, height: 3, class: "joined" }));
      return made;
    });
  }

  // Where the pointer is, in px from the middle of the floor.
  pointed(event) {
    const box = this.svg.getBoundingClientRect();
    const ratio = this.size.width / box.width;
    return [(event.clientX - box.left) * ratio - this.size.width / 2, this.floor - (event.clientY - box.top) * ratio];
  }

  // Where the pointer is, from the pivot, on axes along the track and off it, in m of the drive.
  under(event) {
    const tilt = Math.max(-STEEP, Math.min(STEEP, this.shown.view.values.gamma ?? 0)) * RADIANS;
    const [x, y] = this.pointed(event);
    const [along, off] = [x * Math.cos(tilt) + y * Math.sin(tilt), -x * Math.sin(tilt) + y * Math.cos(tilt)];
    return [(along + this.size.width / 2 - this.pivot) / this.moved, off / this.moved];
  }

  limited(name, value) {
    const [low, high] = endsOf(this.shown.view, this.shown.scene.parameters.find((one) => one.name === name));
    const digit = name === "beta" || name === "gamma" ? 0.5 : 5e-6;
    return Number(Math.max(low, Math.min(high, Math.round(value / digit) * digit)).toPrecision(6));
  }

  moveLine(amplitude, beta, how) {
    const { values } = this.shown.view;
    const angle = this.limited("beta", beta);
    const patch = { beta: angle };
    if ("amplitude" in values) patch.amplitude = this.limited("amplitude", amplitude);
    else if ("peak_to_peak" in values) patch.peak_to_peak = this.limited("peak_to_peak", 2 * amplitude);
    else if ("vertical_amplitude" in values) patch.vertical_amplitude = this.limited("vertical_amplitude", amplitude * Math.abs(Math.sin(angle * RADIANS)));
    this.onmove(patch, how);
  }

  // Both amplitudes of an ellipse.
  moveEllipse(along, normal, how) {
    this.onmove({ amplitude_along_1: this.limited("amplitude_along_1", along), amplitude_normal_1: this.limited("amplitude_normal_1", normal) }, how);
  }

  dragLine(event) {
    const [x, y] = this.under(event);
    if (this.amplitude() === null) return this.moveEllipse(Math.abs(x), Math.abs(y - (this.floor - this.middle()) / this.moved), { isOver: false });
    this.moveLine(Math.hypot(x, y), Math.atan2(y, x) / RADIANS, { isOver: false });
  }

  keyLine(across, up) {
    const { amplitude_along_1: along, amplitude_normal_1: normal, beta } = this.shown.view.values;
    if (this.amplitude() === null) this.moveEllipse(along + 1e-5 * across, normal + 5e-6 * up, { isOver: true });
    else this.moveLine(this.amplitude() + 1e-5 * across, beta + 0.5 * up, { isOver: true });
  }

  dragSlope(event) {
    const [x, y] = this.pointed(event);
    this.turn(Math.atan2(y, x) / RADIANS, false);
  }

  turn(gamma, isOver) {
    this.onmove({ gamma: this.limited("gamma", gamma) }, { isOver });
  }
}
