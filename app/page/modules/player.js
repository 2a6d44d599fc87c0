// The moment of a motion that is shown: it plays, is paused, or is chosen on a slider.

import { cycleOf } from "./course.js";
import { byId } from "./elements.js";
import { number } from "./words.js";

export class Player {
  // `onmoment(time, turns)` hears of each moment: the time within a cycle, and the cycles before it.
  constructor(onmoment) {
    this.onmoment = onmoment;
    this.parts = Object.fromEntries(["player", "now", "now-told", "play", "slow"].map((id) => [id, byId(id)]));
    this.course = null;
    this.time = 0;
    this.turns = 0;
    this.isRunning = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.isHalted = false; // what is shown is not of the view
    this.last = null; // when it was drawn last, while it plays
    this.frame = 0; // the next one
    this.parts.play.addEventListener("click", () => this.toggle());
    this.parts.now.addEventListener("input", () => this.course && this.choose((Number(this.parts.now.value) / 100) * cycleOf(this.course)));
  }

  show(course, isHalted) {
    this.isHalted = isHalted;
    if (course !== this.course) {
      const share = this.course && course ? this.time / cycleOf(this.course) : 0; // it goes on where it was
      this.course = course;
      this.time = course ? share * cycleOf(course) : 0;
    }
    this.parts.player.hidden = !course;
    if (course) this.tell();
    this.awake();
  }

  tell() {
    const cycle = cycleOf(this.course);
    this.parts.now.value = String((100 * this.time) / cycle);
    this.parts.now.style.setProperty("--at", `${(100 * this.time) / cycle}%`);
    this.parts["now-told"].textContent = `${number(1000 * this.time, 2)} of ${number(1000 * cycle, 3)} ms`;
    this.onmoment(this.time, this.turns);
  }

  toggle() {
    this.isRunning = !this.isRunning;
    this.awake();
  }

  // A moment of the cycle was chosen.
  choose(time) {
    this.isRunning = false;
    this.awake();
    this.time = Math.min(time, 0.9999 * cycleOf(this.course));
    this.tell();
  }

  // Frames are asked for only while it plays: else the page rests.
  awake() {
    this.parts.play.textContent = this.isRunning ? "Pause" : "Play";
    cancelAnimationFrame(this.frame);
    this.last = null;
    if (this.course && this.isRunning && !this.isHalted) this.frame = requestAnimationFrame((now) => this.tick(now));
  }

  tick(now) {
    if (this.last !== null) {
      const cycle = cycleOf(this.course);
      const next = this.time + (now - this.last) / 1000 / Number(this.parts.slow.value);
      const turns = Math.floor(next / cycle);
      this.time = next - turns * cycle;
      this.turns += turns;
      this.tell();
    }
    this.last = now;
    this.frame = requestAnimationFrame((later) => this.tick(later));
  }
}
