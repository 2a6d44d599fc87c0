// A motion that plays: the sketch, the curves that are scrubbed, and what the part does.

import { MODES, PARTS, cycleOf, modeAt, platoonsAt } from "./course.js";
import { element, fill, whenRecoloured } from "./elements.js";
import { Panels } from "./panels.js";
import { drawAbove, drawSide } from "./sketch.js";
import { capital, withUnit } from "./words.js";

const SLOWNESS = [10, 30, 100, 300];

// Which parts of a row touch, in a sentence: those of each platoon by the numbers of its ends.
function platoonsTold(platoons) {
  const joined = platoons.filter(({ length }) => length > 1).map((one) => `${one[0]} to ${one[one.length - 1]}`);
  return joined.length ? `Parts ${joined.join(", and ")} touch` : "No parts touch";
}

export class Animation {
  constructor(host) {
    this.side = element("canvas", { class: "side", role: "img", "aria-label": "The part on its track, seen from the side" });
    this.above = element("canvas", { class: "above", role: "img", hidden: true, "aria-label": "The part in the bowl, seen from above" });
    this.said = element("p", { class: "said", "aria-live": "off" }, "Simulating the motion ...");
    this.legend = element("ul", { class: "legend", "aria-label": "What the part does" });
    this.panels = new Panels((time) => this.choose(time));
    this.play = element("button", { type: "button", onclick: () => this.toggle() }, "Pause");
    this.slow = element(
      "select",
      { "aria-label": "Slowed down" },
      ...SLOWNESS.map((times) => element("option", { value: times }, `${times}× slower`)),
    );
    this.slow.value = "30";
    const step = (share, text) => element("button", { type: "button", onclick: () => this.step(share) }, text);
    fill(
      host,
      element("div", { class: "views" }, this.side, this.above),
      element("div", { class: "buttons" }, this.play, step(-0.01, "Step back"), step(0.01, "Step on"), this.slow),
      this.said,
      this.panels.svg,
      this.legend,
    );
    this.course = null;
    this.time = 0;
    this.turns = 0; // cycles since the beginning
    this.isRunning = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.isSeen = true;
    this.last = null; // when it was drawn last, while it plays
    this.awaitsFrame = false;
    whenRecoloured(() => this.course && this.drawAll());
    // In a frame of its own: what is drawn changes the height.
    new ResizeObserver(() => requestAnimationFrame(() => this.resize())).observe(host);
    new IntersectionObserver(([{ isIntersecting }]) => {
      this.isSeen = isIntersecting;
      this.awake();
    }).observe(host);
  }

  show(course) {
    const share = this.course ? this.time / cycleOf(this.course) : 0; // it goes on where it was
    this.course = course;
    this.time = share * cycleOf(course);
    this.play.textContent = this.isRunning ? "Pause" : "Play";
    this.above.hidden = !course.radius;
    const parts = (course.row?.positions ?? []).map((_, i) => [PARTS[i % PARTS.length], `part ${i + 1}${i ? "" : ", the rearmost"}`]);
    const present = course.row ? parts : [...new Set(course.modes)].map((mode) => MODES[mode] ?? MODES.unknown);
    fill(
      this.legend,
      ...present.map(([colour, text]) => {
        const swatch = element("span", { class: "swatch line" });
        swatch.style.borderColor = colour;
        return element("li", {}, swatch, capital(text));
      }),
    );
    this.told = null;
    this.drawAll();
    this.awake();
  }

  // There is no motion to show, for this reason.
  fail(reason) {
    this.course = null;
    this.said.textContent = reason;
  }

  toggle() {
    this.isRunning = !this.isRunning;
    this.play.textContent = this.isRunning ? "Pause" : "Play";
    this.awake();
  }

  step(share) {
    if (!this.course) return;
    if (this.isRunning) this.toggle();
    this.go(share * cycleOf(this.course));
  }

  // A moment of the cycle was chosen.
  choose(time) {
    if (this.isRunning) this.toggle();
    const cycle = cycleOf(this.course);
    this.time = Math.max(0, Math.min(time, 0.9999 * cycle));
    this.draw();
  }

  go(seconds) {
    const cycle = cycleOf(this.course);
    const turns = Math.floor((this.time + seconds) / cycle);
    this.time += seconds - turns * cycle;
    this.turns += turns;
    this.draw();
  }

  // Frames are asked for only while it plays and is seen: else the page rests.
  awake() {
    if (this.awaitsFrame || !this.plays()) return;
    this.awaitsFrame = true;
    requestAnimationFrame((now) => this.tick(now));
  }

  plays() {
    return this.course !== null && this.isRunning && this.isSeen;
  }

  tick(now) {
    this.awaitsFrame = false;
    if (this.plays() && this.last !== null) this.go((now - this.last) / 1000 / Number(this.slow.value));
    this.last = this.plays() ? now : null;
    this.awake();
  }

  resize() {
    if (!this.course || this.width === this.side.clientWidth) return;
    this.drawAll();
  }

  drawAll() {
    this.width = this.side.clientWidth;
    this.panels.draw(this.course);
    this.draw();
  }

  draw() {
    const { course } = this;
    const time = this.time + course.times[0];
    const mode = modeAt(course, time);
    const [colour, text] = MODES[mode] ?? MODES.unknown;
    drawSide(this.side, course, time, this.turns, colour);
    if (course.radius) drawAbove(this.above, course, time, this.turns, colour);
    this.panels.at(this.time);
    const told = course.row ? platoonsTold(platoonsAt(course, time)) : `The part ${text}`;
    if (!this.isRunning || this.told !== told) this.panels.tell(told);
    if (this.told === told) return;
    this.told = told;
    this.said.textContent = `${told}. Mean speed ${withUnit(course.velocity, "m s-1")}.`;
  }
}
