// The motion at the chosen point of a view.

import { Animation } from "./animation.js";
import { courseAt } from "./computed.js";
import { courseOf } from "./course.js";
import { Refusal, left } from "./service.js";
import { sentence } from "./words.js";

const DIMMED_AFTER = 100; // ms without the motion of the fields

export class MotionAtPoint {
  // `onshown(view, course)` hears whose motion is shown.
  constructor(section, { notice, onshown }) {
    this.section = section;
    this.notice = notice;
    this.onshown = onshown;
    this.next = null; // the view and scene whose motion is wanted
    this.isFollowing = false;
    this.isJob = false; // the service carries out what is followed as a job
    this.turn = 0;
    /** @type {Animation | null} */
    this.animation = null;
  }

  // Another view is opened: what is under way is of no use. Its motion has its place from the start.
  begin({ kind, point }) {
    this.turn += 1;
    this.next = null;
    this.abort?.abort(left());
    this.section.hidden = kind !== "simulate" || !point;
  }

  // Show the motion at the point of a view; of the views meanwhile only the last counts, and one that the
  // service has made a job of is not waited for.
  async follow(view, scene) {
    this.next = { view, scene };
    if (this.isJob) this.abort.abort(left());
    if (this.isFollowing) return;
    this.isFollowing = true;
    this.section.setAttribute("aria-busy", "true");
    try {
      while (this.next) {
        const { next } = this;
        this.next = null;
        await this.show(next.view, next.scene);
      }
    } finally {
      this.section.setAttribute("aria-busy", "false");
      this.isFollowing = false;
    }
  }

  async show(view, scene) {
    const { turn } = this;
    this.section.hidden = false;
    this.animation ??= new Animation(this.section);
    const stale = (isStale) => this.section.classList.toggle("stale", isStale);
    const dimming = setTimeout(() => stale(true), DIMMED_AFTER);
    this.abort = new AbortController();
    const { signal } = this.abort;
    const tell = () => {
      this.isJob = true;
      if (this.next) this.abort.abort(left());
    };
    try {
      const course = courseOf(await this.notice.persist(() => courseAt(view, scene, view.point, { signal, tell })));
      if (turn !== this.turn) return;
      stale(false);
      this.section.hidden = !course.times.length; // some systems and methods give means only
      if (course.times.length) this.animation.show(course);
      this.onshown(view, course);
    } catch (error) {
      if (error.name === "AbortError") return;
      if (!(error instanceof Refusal)) throw error;
      if (turn !== this.turn) return;
      stale(true);
      this.animation.fail(error.errors[0] ? sentence(error.errors[0]) : error.message);
      this.onshown(view, null);
    } finally {
      clearTimeout(dimming);
      this.isJob = false;
    }
  }
}
