// The answer on top: the question, its number with unit and sentence, a strip for its range, and what to do where
// there is none.

import { drawn, element, fill } from "./elements.js";
import { number, shown } from "./words.js";

const STRIP = { wide: 300, tall: 62, left: 14 };
const NARROW = 150; // px, on a phone

function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 4, 5, 8, 10].map((one) => one * power).find((one) => one >= value);
}

// The range of a number on its axis.
function stripDrawn({ low, high, value, unit, most }) {
  const [factor] = shown(unit);
  const [from, to, at] = [low, high, value].map((one) => one * factor);
  const largest = Math.max(Math.abs(from), Math.abs(to), Math.abs(at)) || 1;
  const top = most ?? roundUp(1.3 * largest);
  const bottom = Math.min(from, at) < 0 ? -roundUp(1.3 * Math.max(-Math.min(from, at), 1e-9)) : 0;
  const isNarrow = innerWidth <= 700;
  const wide = isNarrow ? NARROW : STRIP.wide;
  const place = (one) => STRIP.left + ((one - bottom) / (top - bottom)) * (wide - 2 * STRIP.left);
  const line = 40;
  const svg = drawn("svg", { viewBox: `0 0 ${wide} ${STRIP.tall}`, class: "strip", role: "img", "aria-label": `from ${number(from, 3)} to ${number(to, 3)}` });
  const ticks = isNarrow ? [bottom, (bottom + top) / 2, top] : Array.from({ length: 5 }, (_, k) => bottom + (k / 4) * (top - bottom));
  svg.append(
    drawn("line", { x1: place(bottom), x2: place(top), y1: line, y2: line, class: "axis" }),
    ...ticks.flatMap((tick) => [
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
  constructor(host, title) {
    this.title = title;
    this.number = element("strong", {});
    this.unit = element("span", { class: "unit" });
    this.strip = element("div", { class: "strip-host" });
    this.sentence = element("p", { class: "sentence" });
    this.more = element("span", { class: "pale" });
    this.spoken = element("p", { class: "spoken", "aria-live": "polite" });
    this.odd = element("p", { class: "unusual" });
    this.actions = element("p", { class: "actions" });
    this.bar = element("div", { class: "progress-bar", hidden: true });
    this.host = host;
    host.append(
      this.bar,
      element("div", { class: "answered" }, element("p", { class: "answer" }, this.number, " ", this.unit), this.strip),
      this.sentence,
      this.spoken,
      this.odd,
      this.actions,
    );
  }

  ask(title) {
    this.title.textContent = title;
    document.title = "vibrafeed";
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
    clearTimeout(this.timer);
    const isBusy = state.status === "computing";
    if (!isBusy) this.bar.hidden = true;
    else this.timer = setTimeout(() => (this.bar.hidden = false), 300);
    if (state.job) this.bar.style.setProperty("--share", `${state.job.progress}%`);
    this.number.textContent = isFailed ? "–" : (answer?.number ?? "");
    this.unit.textContent = isFailed ? "" : (answer?.unit ?? "");
    const old = state.isLate ? `for the old values. ${waiting || (state.job ? `${state.job.message} ${state.job.progress} %` : state.reason || "Computing.")}` : "";
    const sentence = isFailed ? state.reason : old || (answer ? answer.sentence : "Computing.");
    fill(this.sentence, sentence, " ", this.more);
    this.more.textContent = !old && !isFailed && answer?.more ? answer.more : "";
    fill(this.strip, answer?.strip && !isFailed ? stripDrawn(answer.strip) : "");
    this.odd.textContent = isFailed ? "" : odd;
    const same = actions.map(({ text }) => text).join("|");
    this.onclick = actions.map(({ onclick }) => onclick);
    if (this.offered !== same) {
      this.offered = same;
      fill(this.actions, ...actions.map(({ text }, k) => element("button", { type: "button", class: "link", onclick: () => this.onclick[k]() }, text)));
    }
    if (["ready", "failed"].includes(state.status) && !state.isLate) this.speak(`${this.number.textContent} ${this.unit.textContent}. ${sentence}`);
  }

  // For screen readers: once it has not changed for a while.
  speak(text) {
    clearTimeout(this.speaking);
    this.speaking = setTimeout(() => {
      if (this.spoken.textContent !== text) this.spoken.textContent = text;
    }, 400);
  }
}
