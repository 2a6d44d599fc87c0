// The motion at the chosen point of a view.

import { courseAt } from "./computed.js";
import { Course, courseOf } from "./course.js";
import { Refusal } from "./service.js";

export class MotionAtPoint {
  // `onshown(point, course)` hears whose motion is shown.
  constructor(section, host, { notice, onshown }) {
    this.section = section;
    this.host = host;
    this.notice = notice;
    this.onshown = onshown;
    this.next = null; // the view and scene whose motion is wanted
    this.isFollowing = false;
  }

  // Show the motion at the point of a view; of the views meanwhile only the last counts.
  async follow(view, scene) {
    this.next = { view, scene };
    if (this.isFollowing) return;
    this.isFollowing = true;
    this.section.setAttribute("aria-busy", "true");
    try {
      while (this.next) {
        const { next } = this;
        this.next = null;
        await this.show(next.view, next.scene, next.view.point);
      }
    } finally {
      this.section.setAttribute("aria-busy", "false");
      this.isFollowing = false;
    }
  }

  // Another view is opened, or one without a point: what is under way is of no use.
  leave() {
    this.turn = (this.turn ?? 0) + 1;
    this.next = null;
    this.section.hidden = true;
  }

  async show(view, scene, point) {
    const { turn } = this;
    const isLeft = () => turn !== this.turn || (this.next && this.next.view.point !== point);
    try {
      const dataset = await this.notice.persist(() => courseAt(view, scene, point));
      if (isLeft()) return;
      this.section.hidden = false;
      this.course ??= new Course(this.host);
      const course = courseOf(dataset);
      this.course.show(course);
      this.onshown(point, course);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      if (isLeft()) return;
      this.notice.tell([error.errors[0]?.message ?? error.message]);
    }
  }
}
