// One quantity over two parameters: colours, contours, regimes, and a cursor that says what it meets.

import { axesDrawn, axisOf, FRAME } from "./axes.js";
import { REGIME_COLOURS, scaleOf } from "./colours.js";
import { drawn, element, fill } from "./elements.js";
import { capital, label, number, shown, withUnit, words } from "./words.js";

const { contours, ticks } = window.d3;
const LEVELS = 10;
let maps = 0;

export class HeatMap {
  // `onpick` is called with {x, y} when a point is clicked, or Enter is pressed at the cursor.
  constructor(host, { onpick = () => {}, title = "Map" } = {}) {
    this.onpick = onpick;
    this.clipId = `inside-${(maps += 1)}`;
    this.canvas = element("canvas", { "aria-hidden": "true" });
    this.svg = drawn("svg", { "aria-hidden": "true" });
    this.said = element("p", { class: "said", "aria-live": "polite" });
    this.legend = element("ul", { class: "legend", "aria-label": "Regimes" });
    this.scale = element("div", { class: "scale" });
    this.box = element(
      "div",
      {
        class: "map",
        tabindex: "0",
        role: "application",
        "aria-label": `${title}: arrow keys move the cursor, Enter chooses the point`,
        onpointermove: (event) => this.point(event),
        onpointerleave: () => this.leave(),
        onclick: (event) => this.pick(event),
        onkeydown: (event) => this.press(event),
      },
      this.canvas,
      this.svg,
    );
    fill(host, this.box, this.said, this.scale, this.legend);
    this.data = null;
    this.cursor = null;
    this.marks = [];
    new ResizeObserver(() => this.draw()).observe(this.box);
  }

  // data: {x, y: {name, unit, values}, z: {name, unit, at(i, j)}, regime: {at(i, j), names} or null}
  show(data, { showsRegimes = true } = {}) {
    this.data = data;
    this.showsRegimes = showsRegimes;
    const size = data.x.values.length * data.y.values.length;
    this.flat = new Float64Array(size);
    const nx = data.x.values.length;
    for (let j = 0; j < data.y.values.length; j++) {
      for (let i = 0; i < nx; i++) this.flat[j * nx + i] = data.z.at(i, j) ?? NaN;
    }
    this.range = scaleOf(this.flat);
    this.draw();
    this.tellLegend();
    if (this.cursor) this.say();
  }

  mark(marks) {
    this.marks = marks; // of {x, y, text}
    this.draw();
  }

  draw() {
    if (!this.data) return;
    const width = this.box.clientWidth;
    const height = this.box.clientHeight;
    if (width < 80 || height < 80) return;
    const { left, right, top, bottom } = FRAME;
    const { data } = this;
    this.x = axisOf(data.x, left, width - right);
    this.y = axisOf(data.y, height - bottom, top);
    this.paint(width - left - right, height - top - bottom);
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    fill(
      this.svg,
      this.contoursDrawn(),
      this.showsRegimes ? this.bordersDrawn() : null,
      axesDrawn(this.x, this.y, width, height),
      ...this.marks.map((mark) => this.markDrawn(mark)),
      this.cursorDrawn(),
    );
  }

  paint(width, height) {
    const nx = this.data.x.values.length;
    const ny = this.data.y.values.length;
    const { canvas, flat, range } = this;
    canvas.width = nx;
    canvas.height = ny;
    canvas.style.left = `${FRAME.left}px`;
    canvas.style.top = `${FRAME.top}px`;
    canvas.style.width = `${width}px`;
    canvas.style.height = `${height}px`;
    const context = canvas.getContext("2d");
    const image = context.createImageData(nx, ny);
    if (range) {
      const factor = (range.steps - 1) / (range.high - range.low);
      const { lut } = range;
      for (let j = 0; j < ny; j++) {
        for (let i = 0; i < nx; i++) {
          const value = flat[j * nx + i];
          const to = 4 * ((ny - 1 - j) * nx + i);
          if (value !== value) continue; // transparent: it has no value there
          let at = Math.round((value - range.low) * factor);
          at = 3 * (at < 0 ? 0 : at >= range.steps ? range.steps - 1 : at);
          image.data[to] = lut[at];
          image.data[to + 1] = lut[at + 1];
          image.data[to + 2] = lut[at + 2];
          image.data[to + 3] = 255;
        }
      }
    }
    context.putImageData(image, 0, 0);
  }

  // From places among the values of the axes to places on the screen: values may be unevenly spaced.
  placed(axis, values, at) {
    const low = Math.max(0, Math.min(values.length - 1, Math.floor(at)));
    const high = Math.min(values.length - 1, low + 1);
    return axis.place(values[low] + (at - low) * (values[high] - values[low]));
  }

  path(polygons) {
    const { x, y } = this.data;
    const parts = [];
    for (const polygon of polygons) {
      for (const ring of polygon) {
        const points = ring.map(
          // d3 puts the value of a cell into its middle
          ([i, j]) =>
            `${this.placed(this.x, x.values, i - 0.5).toFixed(1)},` +
            `${this.placed(this.y, y.values, j - 0.5).toFixed(1)}`,
        );
        parts.push(`M${points.join("L")}Z`);
      }
    }
    return parts.join("");
  }

  contoursDrawn() {
    const group = drawn("g", { class: "contours", "clip-path": `url(#${this.clipId})` });
    group.append(this.clip());
    if (!this.range) return group;
    const [factor] = shown(this.data.z.unit);
    const { low, high } = this.range;
    const levels = ticks(low * factor, high * factor, LEVELS).map((level) => level / factor);
    const found = contours()
      .size([this.data.x.values.length, this.data.y.values.length])
      .thresholds(levels)(this.flat);
    for (const level of found) {
      if (!level.coordinates.length) continue;
      const isZero = Math.abs(level.value) < 1e-12 * (high - low);
      group.append(
        drawn("path", { d: this.path(level.coordinates), class: isZero ? "zero" : "contour" }),
      );
    }
    return group;
  }

  clip() {
    const { left, right, top, bottom } = FRAME;
    return drawn(
      "clipPath",
      { id: this.clipId },
      drawn("rect", {
        x: left + 1,
        y: top + 1,
        width: Math.max(0, this.box.clientWidth - left - right - 2),
        height: Math.max(0, this.box.clientHeight - top - bottom - 2),
      }),
    );
  }

  bordersDrawn() {
    const group = drawn("g", { class: "borders", "clip-path": `url(#${this.clipId})` });
    const { regime, x, y } = this.data;
    if (!regime) return group;
    const nx = x.values.length;
    const ny = y.values.length;
    // Of two neighbours one draws the line between them.
    for (const [place, one] of this.regimes().entries()) {
      if (place === 0) continue;
      const inside = new Float64Array(nx * ny);
      for (let j = 0; j < ny; j++) {
        for (let i = 0; i < nx; i++) inside[j * nx + i] = regime.at(i, j) === one.value ? 1 : 0;
      }
      const [area] = contours().size([nx, ny]).smooth(true).thresholds([0.5])(inside);
      group.append(
        drawn("path", {
          d: this.path(area.coordinates),
          class: "border",
          stroke: REGIME_COLOURS[place % REGIME_COLOURS.length],
        }),
      );
    }
    return group;
  }

  // The regimes that occur, the most frequent first: {value, name, share}.
  regimes() {
    const { regime, x, y } = this.data;
    if (!regime) return [];
    const counts = new Map();
    for (let j = 0; j < y.values.length; j++) {
      for (let i = 0; i < x.values.length; i++) {
        const value = regime.at(i, j);
        counts.set(value, (counts.get(value) ?? 0) + 1);
      }
    }
    const cells = x.values.length * y.values.length;
    return [...counts]
      .map(([value, count]) => ({ value, name: regime.names[value] ?? "", share: count / cells }))
      .sort((a, b) => b.share - a.share);
  }

  tellLegend() {
    const [factor] = shown(this.data.z.unit);
    if (this.range) {
      const { low, high, lut, steps } = this.range;
      const stops = Array.from({ length: 9 }, (_, i) => {
        const at = 3 * Math.round((i / 8) * (steps - 1));
        return `rgb(${lut[at]} ${lut[at + 1]} ${lut[at + 2]})`;
      });
      const bar = element("span", { class: "bar" });
      bar.style.background = `linear-gradient(to right, ${stops.join(",")})`;
      fill(
        this.scale,
        element("span", {}, label(this.data.z.name, this.data.z.unit)),
        element("span", { class: "ends" }, number(low * factor, 4, high * factor), bar, number(high * factor, 4, low * factor)),
      );
    } else {
      fill(this.scale, `No ${words(this.data.z.name)} has a value here.`);
    }
    fill(
      this.legend,
      ...this.regimes().map(({ name, share }, place) => {
        const swatch = element("span", { class: "swatch" });
        swatch.style.borderColor = REGIME_COLOURS[place % REGIME_COLOURS.length];
        const meaning = this.data.regime.meanings?.[name];
        return element(
          "li",
          { title: meaning },
          swatch,
          `${capital(words(name))} ${number(100 * share, 3)}\u00a0%`,
          meaning ? element("small", {}, ` ${meaning}`) : null,
        );
      }),
    );
  }

  markDrawn({ x, y, text }) {
    const cx = this.x.place(x);
    const cy = this.y.place(y);
    const isRight = cx > this.box.clientWidth * 0.7;
    return drawn(
      "g",
      { class: "mark" },
      drawn("circle", { cx, cy, r: 6 }),
      drawn(
        "text",
        { x: cx + (isRight ? -10 : 10), y: cy - 8, "text-anchor": isRight ? "end" : "start" },
        text,
      ),
    );
  }

  cursorDrawn() {
    if (!this.cursor) return null;
    const x = this.x.place(this.data.x.values[this.cursor.i]);
    const y = this.y.place(this.data.y.values[this.cursor.j]);
    return drawn(
      "g",
      { class: "cursor" },
      drawn("line", { x1: x, x2: x, y1: FRAME.top, y2: this.box.clientHeight - FRAME.bottom }),
      drawn("line", { x1: FRAME.left, x2: this.box.clientWidth - FRAME.right, y1: y, y2: y }),
    );
  }

  nearest(values, wanted) {
    let best = 0;
    for (let i = 1; i < values.length; i++) {
      if (Math.abs(values[i] - wanted) < Math.abs(values[best] - wanted)) best = i;
    }
    return best;
  }

  under(event) {
    const box = this.box.getBoundingClientRect();
    return {
      i: this.nearest(this.data.x.values, this.x.value(event.clientX - box.left)),
      j: this.nearest(this.data.y.values, this.y.value(event.clientY - box.top)),
    };
  }

  point(event) {
    if (!this.data) return;
    this.move(this.under(event));
  }

  move(cursor) {
    this.cursor = cursor;
    this.svg.querySelector(".cursor")?.remove();
    const lines = this.cursorDrawn();
    if (lines) this.svg.append(lines);
    this.say();
  }

  leave() {
    if (this.box === document.activeElement) return;
    this.cursor = null;
    this.svg.querySelector(".cursor")?.remove();
    this.said.textContent = "";
  }

  say() {
    const { x, y, z, regime } = this.data;
    const { i, j } = this.cursor;
    const parts = [
      `${words(x.name)} ${withUnit(x.values[i], x.unit)}`,
      `${words(y.name)} ${withUnit(y.values[j], y.unit)}`,
      `${words(z.name)} ${withUnit(z.at(i, j), z.unit)}`,
    ];
    if (regime) parts.push(words(regime.names[regime.at(i, j)] ?? ""));
    this.said.textContent = capital(parts.filter(Boolean).join(", "));
  }

  chosen() {
    const { x, y } = this.data;
    return { x: x.values[this.cursor.i], y: y.values[this.cursor.j] };
  }

  pick(event) {
    if (!this.data) return;
    this.move(this.under(event));
    this.onpick(this.chosen());
  }

  press(event) {
    if (!this.data) return;
    const step = event.shiftKey ? 10 : 1;
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const last = [this.data.x.values.length - 1, this.data.y.values.length - 1];
    this.cursor ??= { i: Math.round(last[0] / 2), j: Math.round(last[1] / 2) };
    if (event.key === "Enter") {
      this.onpick(this.chosen());
    } else if (moves[event.key]) {
      const [di, dj] = moves[event.key];
      this.move({
        i: Math.max(0, Math.min(last[0], this.cursor.i + step * di)),
        j: Math.max(0, Math.min(last[1], this.cursor.j + step * dj)),
      });
    } else return;
    event.preventDefault();
  }

  // The picture as one SVG document, the colours as an image within it.
  svgText(style) {
    const copy = this.svg.cloneNode(true);
    copy.querySelector(".cursor")?.remove();
    const { left, right, top, bottom } = FRAME;
    const width = this.box.clientWidth;
    const height = this.box.clientHeight;
    copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
    copy.setAttribute("width", width);
    copy.setAttribute("height", height);
    copy.prepend(
      drawn("style", {}, style),
      drawn("rect", { width, height, class: "paper" }),
      drawn("image", {
        x: left,
        y: top,
        width: width - left - right,
        height: height - top - bottom,
        preserveAspectRatio: "none",
        style: "image-rendering: pixelated",
        href: this.canvas.toDataURL(),
      }),
    );
    return new XMLSerializer().serializeToString(copy);
  }
}
