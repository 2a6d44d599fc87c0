// Quantities over one parameter, with a band where something is uncertain, and the regimes below.

import { axesDrawn, axisOf, FRAME } from "./axes.js";
import { drawn, element, fill, whenRecoloured } from "./elements.js";
import { svgDocument } from "./exported.js";
import { legendOf, occurring } from "./legend.js";
import { capital, label, number, shown, withUnit, words } from "./words.js";

const LINES = ["#0b5cad", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
const STRIP = 8; // px

function ink(host) {
  return getComputedStyle(host).color;
}

export class Curves {
  /**
   * @param {HTMLElement} host
   * @param {{onpick?: Function, onpoint?: Function, ondrag?: Function, title?: string, hint?: string, isSmall?: boolean}} options
   */
  constructor(host, { onpick = () => {}, onpoint = () => {}, hint = "" } = {}) {
    this.onpick = onpick;
    this.onpoint = onpoint;
    this.hint = hint; // told while no point is
    this.marks = {}; // by who sets them
    this.box = element("div", { class: "curves" });
    this.said = element("p", { class: "said", "aria-live": "polite" }, hint);
    this.legend = element("ul", { class: "legend", "aria-label": "Regimes" });
    fill(host, this.box, this.said, this.legend);
    this.plot = null;
    this.at = null;
    new ResizeObserver(() => this.resize()).observe(this.box);
    whenRecoloured(() => this.plot && this.box.isConnected && this.show(this.data));
  }

  // data: {x: {name, unit, values}, lines: [{name, unit, values, low, high}], regime or null, look}
  show(data) {
    this.data = data;
    this.regimes = occurring(data, data.look);
    const [xFactor] = shown(data.x.unit);
    const [yFactor] = shown(data.lines[0].unit);
    const columns = [Array.from(data.x.values, (value) => value * xFactor)];
    const series = [{}];
    const bands = [];
    const scaled = (values) =>
      Array.from(values, (value) => (Number.isFinite(value) ? value * yFactor : null));
    for (const [place, line] of data.lines.entries()) {
      const stroke = place ? LINES[place % LINES.length] : this.style("--accent");
      if (line.low) {
        columns.push(scaled(line.high), scaled(line.low));
        series.push({ stroke: "transparent" }, { stroke: "transparent" });
        bands.push({ series: [series.length - 2, series.length - 1], fill: `${stroke}33` });
      }
      columns.push(scaled(line.values));
      series.push({ label: capital(words(line.label ?? line.name)), stroke, width: 2, pxAlign: 0 });
    }
    this.plot?.destroy();
    const colour = ink(this.box);
    const axis = (text, size) => ({
      label: text,
      stroke: colour,
      labelSize: 20,
      size,
      grid: { stroke: this.style("--line"), width: 1 },
      ticks: { stroke: this.style("--line") },
      values: (_, splits) => splits.map((value) => number(value)),
    });
    this.plot = new (/** @type {any} */ (window).uPlot)(
      {
        width: Math.max(200, this.box.clientWidth),
        height: Math.max(200, this.box.clientHeight),
        scales: { x: { time: false } },
        axes: [axis(label(data.x.name, data.x.unit), 40), axis(this.yLabel(), 64)],
        series,
        bands,
        legend: { show: data.lines.length > 1, live: false },
        cursor: { drag: { x: false, y: false } },
        hooks: {
          setCursor: [(plot) => this.say(plot.cursor.idx)],
          draw: [(plot) => this.strip(plot), (plot) => this.drawMarks(plot), (plot) => this.drawPoints(plot)],
        },
      },
      columns,
      this.box,
    );
    this.plot.over.addEventListener("click", () => {
      const { idx } = this.plot.cursor;
      if (idx !== null) this.onpick({ x: data.x.values[idx] });
    });
    fill(this.legend, ...legendOf(this.regimes));
  }

  yLabel() {
    const [line] = this.data.lines;
    return label(line.name, line.unit);
  }

  style(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim() || "#888888";
  }

  resize() {
    if (!this.plot || !this.box.clientWidth) return;
    this.plot.setSize({ width: this.box.clientWidth, height: Math.max(200, this.box.clientHeight) });
  }

  strip(plot) {
    const { regime, x } = this.data;
    if (!regime) return;
    const colours = new Map(this.regimes.map(({ value, colour }) => [value, colour]));
    const { ctx, bbox } = plot;
    const [factor] = shown(x.unit);
    const ratio = window.devicePixelRatio || 1;
    for (let i = 0; i < x.values.length; i++) {
      const here = plot.valToPos(x.values[i] * factor, "x", true);
      const next = plot.valToPos(x.values[Math.min(i + 1, x.values.length - 1)] * factor, "x", true);
      ctx.fillStyle = colours.get(regime.at(i));
      ctx.fillRect(here, bbox.top + bbox.height - STRIP * ratio, next - here + 1, STRIP * ratio);
    }
  }

  // Set somebody's marks, of {x, text, isSmall}.
  mark(marks, whose) {
    this.marks[whose] = marks;
    this.plot?.redraw(false, false); // not its scales, which may not be there yet
  }

  // Points that were measured, of [value of x, value of the line], or null.
  points(points) {
    this.measured = points;
    this.plot?.redraw(false, false); // not its scales, which may not be there yet
  }

  drawPoints(plot) {
    const { ctx } = plot;
    const [xFactor] = shown(this.data.x.unit);
    const [yFactor] = shown(this.data.lines[0].unit);
    const size = 4 * (window.devicePixelRatio || 1);
    ctx.save();
    ctx.strokeStyle = ctx.fillStyle = ink(this.box);
    for (const [x, y] of this.measured ?? []) {
      const at = [plot.valToPos(x * xFactor, "x", true), plot.valToPos(y * yFactor, "y", true)];
      ctx.beginPath();
      ctx.arc(...at, size, 0, 2 * Math.PI);
      ctx.fill();
    }
    ctx.restore();
  }

  drawMarks(plot) {
    const { ctx, bbox } = plot;
    const [factor] = shown(this.data.x.unit);
    const ratio = window.devicePixelRatio || 1;
    ctx.save();
    ctx.strokeStyle = ctx.fillStyle = ink(this.box);
    ctx.font = `600 ${12 * ratio}px system-ui, sans-serif`;
    for (const { x, text, isSmall, isLow } of Object.values(this.marks).flat()) {
      const at = plot.valToPos(x * factor, "x", true);
      ctx.lineWidth = (isSmall ? 1 : 2) * ratio;
      ctx.beginPath();
      ctx.moveTo(at, isSmall ? bbox.top + bbox.height - 3 * STRIP * ratio : bbox.top);
      ctx.lineTo(at, bbox.top + bbox.height - STRIP * ratio);
      ctx.stroke();
      const isRight = at > bbox.left + 0.7 * bbox.width;
      ctx.textAlign = isRight ? "right" : "left";
      ctx.fillText(text, at + (isRight ? -6 : 6) * ratio, bbox.top + (isLow ? 32 : 14) * ratio);
    }
    ctx.restore();
  }

  say(i) {
    if (i === null || i === undefined) {
      this.said.textContent = this.hint;
      return;
    }
    const { x, lines, regime } = this.data;
    const parts = [`${words(x.name)} ${withUnit(x.values[i], x.unit)}`];
    for (const line of lines) {
      const band = line.low
        ? ` (${withUnit(line.low[i], line.unit)} to ${withUnit(line.high[i], line.unit)})`
        : "";
      parts.push(`${words(line.label ?? line.name)} ${withUnit(line.values[i], line.unit)}${band}`);
    }
    if (regime) parts.push(words(regime.names[regime.at(i)] ?? ""));
    this.onpoint({ x: x.values[i] });
    this.said.textContent = capital(parts.filter(Boolean).join(", "));
  }

  // The lines as one SVG document, drawn anew from their values.
  svgText(style, told) {
    const { x, lines, regime } = this.data;
    const { clientWidth: width, clientHeight: height } = this.box;
    const { left, right, top, bottom } = FRAME;
    const { min, max } = this.plot.scales.y;
    const [factor] = shown(lines[0].unit);
    const across = axisOf(x, left, width - right);
    const up = axisOf({ ...lines[0], values: [min / factor, max / factor] }, height - bottom, top);
    const at = (values, i) => `${across.place(x.values[i]).toFixed(1)},${up.place(values[i]).toFixed(1)}`;
    const there = (values) => [...values.keys()].filter((i) => Number.isFinite(values[i]));
    const parts = lines.flatMap(({ values, low, high }, place) => {
      const stroke = LINES[place % LINES.length];
      const band = low && there(low).filter((i) => Number.isFinite(high[i]));
      const around = band && [...band.map((i) => at(high, i)), ...band.reverse().map((i) => at(low, i))];
      const line = there(values).map((i) => at(values, i));
      return [
        ...(band ? [drawn("polygon", { points: around.join(" "), fill: stroke, "fill-opacity": 0.2 })] : []),
        drawn("polyline", { points: line.join(" "), fill: "none", stroke, "stroke-width": 2 }),
      ];
    });
    const colours = new Map(this.regimes.map(({ value, colour }) => [value, colour]));
    for (let i = 0; regime && i + 1 < x.values.length; i++) {
      const from = across.place(x.values[i]);
      const cell = { x: from, width: across.place(x.values[i + 1]) - from, y: height - bottom - STRIP, height: STRIP };
      parts.push(drawn("rect", { ...cell, fill: colours.get(regime.at(i)) ?? "none" }));
    }
    parts.push(axesDrawn(across, up, width, height));
    return svgDocument(parts, { width, height, style, told, regimes: this.regimes });
  }
}
