// The picture of a view: a map or lines over the parameters of its axes, with the design as its ring.

import { Curves } from "./curves.js";
import { byId, element, fill } from "./elements.js";
import { legendOf, lookOf, occurring } from "./legend.js";
import { pictureOf } from "./link.js";
import { HeatMap } from "./map.js";
import { capital, number, withUnit, words } from "./words.js";

export class Picture {
  // `onpick(point)` hears of a point that is chosen, `ondrag(point, {isOver})` of the ring that is dragged.
  constructor({ onpick, ondrag }) {
    this.options = { onpick, ondrag };
    /** @type {any} */
    this.drawing = null; // a map or lines
    this.marks = {}; // by who sets them
    this.reason = element("p", { role: "status" });
  }

  // Begin anew: what was drawn is of another view.
  begin(scene) {
    this.look = (name) => lookOf(scene, name);
    this.kind = null;
    this.marks = {};
    this.measured = null;
    fill(byId("note"));
  }

  // `isMoving` while a slider is dragged: the next picture will soon be there. `isRough` are the first values.
  show(found, view, { isMoving = false, isRough = false } = {}) {
    byId("host").dataset.view = pictureOf(view);
    const kind = found.y ? "map" : "curves";
    if (this.kind !== kind) {
      const options = { ...this.options, title: words(view.output) };
      this.drawing = kind === "map" ? new HeatMap(byId("host"), options) : new Curves(byId("host"), options);
      this.kind = kind;
      for (const [whose, marks] of Object.entries(this.marks)) this.mark(marks, whose);
      this.drawing.points?.(this.measured);
    }
    this.drawing.show({ ...found, look: this.look }, { isMoving, isRough });
    this.tellRegimes(found);
  }

  // Whether what is drawn is of the view; else it is dimmed, and why is said over it, with {text, onclick} of what
  // one can do. A button that is there already stays, and keeps the focus.
  dim(isStale, reason = "", action = null) {
    byId("picture").classList.toggle("stale", isStale);
    this.onclick = action?.onclick;
    this.reason.textContent = reason;
    const offered = reason ? `${action?.text}` : "";
    if (this.offered === offered) return;
    this.offered = offered;
    const button = action && element("button", { type: "button", onclick: () => this.onclick() }, action.text);
    fill(byId("stale"), reason ? this.reason : null, reason ? button : null);
  }

  // Points to be marked, of {x, y, text}, by whoever sets them.
  mark(marks, whose) {
    this.marks[whose] = marks;
    this.drawing?.mark(marks, whose);
  }

  // Points that were measured, of [value of the axis, value of the output], or null.
  points(points) {
    this.measured = points;
    this.drawing?.points?.(points);
  }

  // Shares of the regimes under Expert; under the picture what of it describes no real part.
  tellRegimes(found) {
    const all = occurring(found, this.look);
    fill(byId("regimes"), ...legendOf(all));
    const beyond = all.filter(({ valid }) => !valid);
    const share = beyond.reduce((sum, one) => sum + one.share, 0);
    fill(byId("note"), share > 0 ? capital(`${found.y ? "hatched" : "without a line"}, ${number(100 * share, 2)} %: ${beyond[0].meaning}.`) : "");
  }
}

// The ring of the map: the design, with its value beside it.
export function ringOf(view, value, unit) {
  const { x, y, values } = view;
  const text = value === null || value === undefined || !Number.isFinite(value) ? "" : withUnit(value, unit, 3).replace(/\u00a0[^%]*$/, "").replace("\u00a0", " ");
  return { x: values[x.name], y: y ? values[y.name] : null, text, isDragged: true };
}
