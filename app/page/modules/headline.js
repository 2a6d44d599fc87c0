// The answer on top: the question, its number with unit and sentence, a strip for its range, and what to do where
// there is none.

import { byId, drawn, element, fill } from "./elements.js";
import { number, shown } from "./words.js";

const { nice, ticks } = /** @type {any} */ (window).d3;
const STRIP = { wide: 300, tall: 62, left: 14 };
const NARROW = 150; // px, on a phone and beside a long unit
const LONG = 12; // letters

// The range of a number on its axis.
function stripDrawn({ low, high, value, unit, most }, isNarrow) {
  const [factor] = shown(unit);
  const [from, to, at] = [low, high, value].map((one) => one * factor);
  const largest = Math.max(Math.abs(from), Math.abs(to), Math.abs(at)) || 1;
  const [bottom, top] = most ? [0, most] : nice(Math.min(0, 1.3 * from, 1.3 * at), Math.max(0, 1.3 * largest), 4);
  const wide = isNarrow ? NARROW : STRIP.wide;
  const place = (one) => STRIP.left + ((one - bottom) / (top - bottom)) * (wide - 2 * STRIP.left);
  const line = 40;
  const svg = drawn("svg", { viewBox: `0 0 ${wide} ${STRIP.tall}`, width: wide, class: "strip", role: "img", "aria-label": `from ${number(from, 3)} to ${number(to, 3)}` });
  svg.append(
    drawn("line", { x1: place(bottom), x2: place(top), y1: line, y2: line, class: "axis" }),
    ...(isNarrow ? [bottom, (bottom + top) / 2, top] : ticks(bottom, top, 4)).flatMap((tick) => [
      drawn("line", { x1: place(tick), x2: place(tick), y1: line - 4, y2: line + 4, class: "axis" }),
      drawn("text", { x: place(tick), y: line + 18, "text-anchor": "middle", class: "pale" }, number(tick, 3, top)),
    ]),
    drawn("rect", { x: place(from), y: line - 10, width: Math.max(1, place(to) - place(from)), height: 10, class: "range" }),
    ...[from, to].map((end) => drawn("line", { x1: place(end), x2: place(end), y1: line - 15, y2: line, class: "end" })),
    drawn("circle", { cx: place(at), cy: line - 5, r: 5, class: "here" }),
  );
  const [a, b] = [from, to].map((one) => number(one, 2, largest));
  const near = place(to) - place(from) < 26;
  if (a !== b) {
    svg.append(
      drawn("text", { x: place(from) + (near ? -3 : 0), y: 20, "text-anchor": near ? "end" : "middle" }, a),
      drawn("text", { x: place(to) + (near ? 3 : 0), y: 20, "text-anchor": near ? "start" : "middle" }, b),
    );
  }
  return svg;
}

export class Headline {
  constructor() {
    this.host = byId("answer");
    this.parts = Object.fromEntries(["number", "unit", "strip", "sentence", "spoken", "odd", "actions", "bar"].map((id) => [id, byId(`answer-${id}`)]));
  }

  /**
   * `state` is {status, isLate, reason, job}, `answer` that of `answers.js` or null, `odd` a sentence on unusual values,
   * `actions` of {text, onclick}.
   */
  show(state, answer, { odd = "", actions = [], waiting = "" } = {}) {
    const isFailed = ["failed", "asking"].includes(state.status) && !answer;
    this.host.classList.toggle("stale", state.isLate);
    this.host.classList.toggle("failed", isFailed);
    this.host.classList.toggle("odd", Boolean(odd) && !isFailed);
    this.host.setAttribute("aria-busy", String(state.status === "computing"));
    if (state.job) this.parts.bar.style.setProperty("--share", `${state.job.progress}%`);
    this.parts.number.textContent = isFailed ? "–" : (answer?.number ?? "");
    this.parts.unit.textContent = isFailed ? "" : (answer?.unit ?? "");
    const old = state.isLate ? `for the old values. ${waiting || (state.job ? `${state.job.message} ${state.job.progress} %` : state.reason || "Computing.")}` : "";
    const sentence = isFailed ? state.reason : old || (answer ? answer.sentence : "Computing.");
    fill(this.parts.sentence, sentence, " ", !old && !isFailed && answer?.more ? element("span", { class: "pale" }, answer.more) : null);
    fill(this.parts.strip, answer?.strip && !isFailed ? stripDrawn(answer.strip, innerWidth <= 700 || answer.unit.length > LONG) : "");
    this.parts.odd.textContent = isFailed ? "" : odd;
    const same = actions.map(({ text }) => text).join("|");
    this.onclick = actions.map(({ onclick }) => onclick);
    if (this.offered !== same) {
      this.offered = same;
      fill(this.parts.actions, ...actions.map(({ text }, k) => element("button", { type: "button", class: "link", onclick: () => this.onclick[k]() }, text)));
    }
    if (["ready", "failed"].includes(state.status) && !state.isLate) this.speak(`${this.parts.number.textContent} ${this.parts.unit.textContent}. ${sentence}`);
  }

  // For screen readers: once it has not changed for a while.
  speak(text) {
    clearTimeout(this.speaking);
    this.speaking = setTimeout(() => {
      if (this.parts.spoken.textContent !== text) this.parts.spoken.textContent = text;
    }, 400);
  }
}
