// The motion of one part over a cycle: curves with what the part does, and an animation.

import { drawn, element, fill } from "./elements.js";
import { beside, capital, number, shown, withUnit } from "./words.js";

export const MODES = {
  stick: ["#0072b2", "sticks"],
  forward: ["#009e73", "slides forwards"],
  backward: ["#cc79a7", "slides backwards"],
  slide: ["#009e73", "slides"],
  flight: ["#e69f00", "hops"],
  unknown: ["#888888", "unknown"],
};
const SLOWNESS = [10, 30, 100, 300];
const PANEL = 96; // px
const WIDTHS = [300, 960]; // px

// A course out of a dataset of a simulation with `trajectory`.
export function courseOf(dataset) {
  const all = { ...dataset.coordinates, ...dataset.variables };
  const values = (name) => all[name]?.data;
  const flags = all.motion_mode?.flags ?? {};
  const names = Object.fromEntries(Object.entries(flags).map(([name, value]) => [value, name]));
  const times = values("cycle_time");
  const zeros = () => times.map(() => 0);
  return {
    times,
    along: values("position_along") ?? zeros(),
    height: values("height_above_floor") ?? zeros(),
    wall: values("distance_from_wall"),
    trackAlong: values("track_along") ?? zeros(),
    trackNormal: values("track_normal") ?? zeros(),
    modes: (values("motion_mode") ?? zeros()).map((value) => names[value] ?? "unknown"),
    radius: values("radius") ?? null,
    unit: all.position_along?.units ?? "m",
    velocity: values("conveying_velocity"),
    throwNumber: values("throw_number") ?? null,
    amplitude: values("amplitude") ?? null,
    regime: nameOf(all.regime),
  };
}

// The name of the one value of a flag.
function nameOf({ data, flags = {} } = {}) {
  return Object.keys(flags).find((name) => flags[name] === data) ?? "";
}

function between(course, values, time) {
  const { times } = course;
  let i = times.findIndex((t) => t > time);
  if (i < 0) i = times.length - 1;
  i = Math.max(1, i);
  const share = (time - times[i - 1]) / (times[i] - times[i - 1] || 1);
  return values[i - 1] + share * (values[i] - values[i - 1]);
}

export class Course {
  constructor(host) {
    this.panels = drawn("svg", { class: "panels", role: "img" });
    this.side = element("canvas", { class: "side", role: "img" });
    this.above = element("canvas", { class: "above", role: "img" });
    this.said = element("p", { class: "said", "aria-live": "off" });
    this.legend = element("ul", { class: "legend", "aria-label": "What the part does" });
    this.play = element("button", { type: "button", onclick: () => this.toggle() }, "Pause");
    this.slow = element(
      "select",
      { "aria-label": "Slowed down" },
      ...SLOWNESS.map((times) => element("option", { value: times }, `${times} times slower`)),
    );
    this.slow.value = "30";
    const step = (share, text) =>
      element("button", { type: "button", onclick: () => this.step(share) }, text);
    fill(
      host,
      element("div", { class: "views" }, this.side, this.above),
      element(
        "div",
        { class: "buttons" },
        this.play,
        step(-0.01, "Step back"),
        step(0.01, "Step on"),
        this.slow,
      ),
      this.said,
      this.panels,
      this.legend,
    );
    this.course = null;
    this.time = 0;
    this.turns = 0;
    this.isRunning = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.last = null;
    requestAnimationFrame((now) => this.tick(now));
    new ResizeObserver(() => this.resize()).observe(host);
  }

  resize() {
    if (!this.course) return;
    this.drawPanels();
    this.drawViews();
  }

  show(course) {
    const share = this.course ? this.time / this.cycle : 0; // it goes on where it was
    this.course = course;
    this.time = share * this.cycle;
    this.play.textContent = this.isRunning ? "Pause" : "Play";
    this.drawPanels();
    const present = [...new Set(course.modes)];
    fill(
      this.legend,
      ...present.map((mode) => {
        const [colour, text] = MODES[mode] ?? MODES.unknown;
        const swatch = element("span", { class: "swatch line" });
        swatch.style.borderColor = colour;
        return element("li", {}, swatch, capital(text));
      }),
    );
    this.side.setAttribute("aria-label", "The part on its track, seen from the side");
    this.above.setAttribute("aria-label", "The part in the bowl, seen from above");
    this.above.hidden = !course.radius;
    this.drawViews();
  }

  get cycle() {
    const { times } = this.course;
    return times[times.length - 1] - times[0];
  }

  toggle() {
    this.isRunning = !this.isRunning;
    this.play.textContent = this.isRunning ? "Pause" : "Play";
  }

  step(share) {
    if (this.isRunning) this.toggle();
    this.go(share * this.cycle);
  }

  go(seconds) {
    this.time += seconds;
    while (this.time >= this.cycle) {
      this.time -= this.cycle;
      this.turns += 1;
    }
    while (this.time < 0) {
      this.time += this.cycle;
      this.turns -= 1;
    }
    this.drawViews();
  }

  tick(now) {
    if (this.course && this.isRunning && this.last !== null && this.side.isConnected) {
      this.go((now - this.last) / 1000 / Number(this.slow.value));
    }
    this.last = now;
    requestAnimationFrame((next) => this.tick(next));
  }

  drawPanels() {
    const { course } = this;
    const shownPanels = [
      ["position on the track", course.along],
      ["height above the floor", course.height],
      ...(course.wall ? [["distance from the wall", course.wall]] : []),
    ];
    // As wide as it is shown, so that words keep their size on a phone.
    const width = Math.max(WIDTHS[0], Math.min(WIDTHS[1], this.panels.clientWidth));
    const height = PANEL * shownPanels.length + 34;
    this.panels.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.panels.setAttribute("aria-label", "The motion of the part over one cycle");
    const [factor, unit] = shown(course.unit);
    const across = (time) => 70 + ((time - course.times[0]) / this.cycle) * (width - 84);
    const parts = [];
    shownPanels.forEach(([name, values], place) => {
      const top = place * PANEL + 22;
      const low = Math.min(...values);
      const high = Math.max(...values);
      const size = factor * Math.max(Math.abs(low), Math.abs(high));
      const up = (value) => top + 60 - ((value - low) / (high - low || 1)) * 56;
      const end = (value) =>
        drawn("text", { x: 62, y: up(value) + 4, "text-anchor": "end" }, beside(size, value * factor));
      parts.push(
        drawn("text", { x: 70, y: top - 7, class: "label" }, `${capital(name)} (${unit})`),
        end(high),
        end(low),
      );
      let from = 0;
      for (let i = 1; i <= values.length; i++) {
        if (i < values.length && course.modes[i] === course.modes[from]) continue;
        const to = Math.min(i, values.length - 1);
        const points = [];
        for (let k = from; k <= to; k++) {
          points.push(`${across(course.times[k]).toFixed(1)},${up(values[k]).toFixed(1)}`);
        }
        const [stroke] = MODES[course.modes[from]] ?? MODES.unknown;
        parts.push(drawn("polyline", { points: points.join(" "), stroke, class: "course" }));
        from = i;
      }
    });
    this.now = drawn("line", { y1: 18, y2: height - 20, class: "now" });
    parts.push(
      this.now,
      drawn(
        "text",
        { x: width - 14, y: height - 4, "text-anchor": "end" },
        `time over one cycle of ${number(this.cycle * 1000, 3)} ms`,
      ),
    );
    this.across = across;
    fill(this.panels, ...parts);
  }

  drawViews() {
    if (!this.course) return;
    const { course, time } = this;
    const at = time + course.times[0];
    const here = (values) => between(course, values, at);
    const net = course.along[course.along.length - 1] - course.along[0];
    const along = here(course.along) + this.turns * net;
    const place = course.times.findIndex((t) => t > at);
    const mode = course.modes[Math.max(0, (place < 0 ? course.times.length : place) - 1)];
    const [colour, text] = MODES[mode] ?? MODES.unknown;
    this.drawSide(along, here(course.height), here(course.trackAlong), here(course.trackNormal), colour);
    if (course.radius) this.drawAbove(along, colour);
    const [factor, unit] = shown(course.unit);
    const x = this.across(at);
    this.now.setAttribute("x1", x);
    this.now.setAttribute("x2", x);
    this.said.textContent =
      `The part ${text}. Mean speed ${withUnit(course.velocity, "m s-1")}; ` +
      `height ${beside(factor * Math.max(...course.height), factor * here(course.height))}\u00a0${unit}.`;
  }

  prepare(canvas) {
    const ratio = devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = canvas;
    if (canvas.width !== Math.round(width * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    return { context, width, height, ink: getComputedStyle(canvas).color };
  }

  drawSide(along, height, trackAlong, trackNormal, colour) {
    const { context, width, height: tall, ink } = this.prepare(this.side);
    const { course } = this;
    // Movements fill a third of the picture; the part's own size is not drawn to scale.
    const reach = Math.max(
      ...course.height, ...course.trackNormal.map(Math.abs), ...course.trackAlong.map(Math.abs), 1e-9,
    );
    const scale = (tall * 0.2) / reach;
    const floor = tall * 0.72 - trackNormal * scale;
    const spacing = 40;
    const shift = (((trackAlong * scale) % spacing) + spacing) % spacing;
    context.strokeStyle = ink;
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(0, floor);
    context.lineTo(width, floor);
    for (let x = shift - spacing; x < width + spacing; x += spacing) {
      context.moveTo(x, floor);
      context.lineTo(x - 8, floor + 10);
    }
    context.stroke();
    const size = tall * 0.2;
    const room = width + size;
    const left = (((width * 0.2 + (along + trackAlong) * scale) % room) + room) % room;
    context.fillStyle = colour;
    context.fillRect(left - size, floor - height * scale - size, size * 1.4, size);
  }

  drawAbove(along, colour) {
    const { context, width, height, ink } = this.prepare(this.above);
    const { course } = this;
    const middle = [width / 2, height / 2];
    const reach = Math.min(width, height) * 0.42;
    context.strokeStyle = ink;
    context.lineWidth = 2;
    context.beginPath();
    context.arc(...middle, reach, 0, 2 * Math.PI);
    context.stroke();
    context.setLineDash([4, 4]);
    context.beginPath();
    context.arc(...middle, reach * 0.84, 0, 2 * Math.PI);
    context.stroke();
    context.setLineDash([]);
    const angle = along / course.radius;
    context.save();
    context.translate(...middle);
    context.rotate(-angle);
    context.fillStyle = colour;
    context.fillRect(reach * 0.86, -8, reach * 0.12, 16);
    context.restore();
  }
}

