// The moment of a motion that is shown: it plays, is paused, or is chosen.

import { cycleOf } from "./course.js";
import { element, fill } from "./elements.js";

const SLOWNESS = [10, 30, 100, 300];

export class Player {
  // `onmoment(time, turns)` hears of each moment: the time within a cycle, and the cycles before it.
  constructor(host, onmoment) {
    this.host = host;
    this.onmoment = onmoment;
    this.play = element("button", { type: "button", id: "play", onclick: () => this.toggle() }, "Pause");
    this.slow = element(
      "select",
      { id: "slow", "aria-label": "Slowed down" },
      ...SLOWNESS.map((times) => element("option", { value: times }, `${times} times slower`)),
    );
    this.slow.value = "30";
    this.course = null;
    this.time = 0;
    this.turns = 0;
    this.isRunning = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.isHalted = false; // what is shown is not of the view
    this.last = null; // when it was drawn last, while it plays
    this.awaitsFrame = false;
    document.addEventListener("visibilitychange", () => this.awake());
    fill(host, this.play, this.slow);
  }

  show(course, isHalted) {
    this.isHalted = isHalted;
    if (course !== this.course) {
      const share = this.course && course ? this.time / cycleOf(this.course) : 0; // it goes on where it was
      this.course = course;
      this.time = course ? share * cycleOf(course) : 0;
    }
    this.host.hidden = !course;
    this.play.textContent = this.isRunning ? "Pause" : "Play";
    if (course) this.onmoment(this.time, this.turns);
    this.awake();
  }

  toggle() {
    this.isRunning = !this.isRunning;
    this.play.textContent = this.isRunning ? "Pause" : "Play";
    this.awake();
  }

  // A moment of the cycle was chosen.
  choose(time) {
    if (!this.course) return;
    if (this.isRunning) this.toggle();
    this.time = Math.max(0, Math.min(time, 0.9999 * cycleOf(this.course)));
    this.onmoment(this.time, this.turns);
  }

  // Frames are asked for only while it plays and is seen: else the page rests.
  awake() {
    if (this.awaitsFrame || !this.plays()) return;
    this.awaitsFrame = true;
    requestAnimationFrame((now) => this.tick(now));
  }

  plays() {
    return this.course !== null && this.isRunning && !this.isHalted && !document.hidden;
  }

  tick(now) {
    this.awaitsFrame = false;
    if (this.plays() && this.last !== null) {
      const cycle = cycleOf(this.course);
      const next = this.time + (now - this.last) / 1000 / Number(this.slow.value);
      const turns = Math.floor(next / cycle);
      this.time = next - turns * cycle;
      this.turns += turns;
      this.onmoment(this.time, this.turns);
    }
    this.last = this.plays() ? now : null;
    this.awake();
  }
}
