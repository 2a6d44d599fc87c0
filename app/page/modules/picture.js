// The picture of a view: a map or lines over the parameters of its axes, with the design as its ring.

import { Curves } from "./curves.js";
import { scaleOf } from "./colours.js";
import { byId, element, fill } from "./elements.js";
import { legendOf, occurring } from "./legend.js";
import { HeatMap } from "./map.js";
import { lookOf } from "./markers.js";
import { Overlay } from "./overlay.js";
import { pictureOf } from "./view.js";
import { capital, number, withUnit, words } from "./words.js";

export class Picture {
  // `onpick(point)` hears of a point that is chosen, `ondrag(point, {isOver})` of the ring that is dragged,
  // `onpoint(point)` of the cursor.
  constructor({ onpick, onpoint, ondrag }) {
    this.options = { onpick, onpoint, ondrag };
    /** @type {any} */
    this.drawing = null; // a map or lines
    this.marks = {}; // by who sets them
    this.overlay = new Overlay(byId("stale"));
  }

  // Begin anew: what was drawn is of another view.
  begin(view, scene) {
    this.view = view;
    this.scene = scene;
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
      const options = { ...this.options, hint: "", title: words(view.output) };
      this.drawing = kind === "map" ? new HeatMap(byId("host"), options) : new Curves(byId("host"), options);
      this.kind = kind;
      for (const [whose, marks] of Object.entries(this.marks)) this.mark(marks, whose);
      this.drawing.points?.(this.measured);
    }
    const look = (name) => lookOf(this.scene, name);
    this.found = found;
    if (kind === "map") this.drawing.show({ ...found, look }, { isMoving, isRough });
    else {
      this.lines = [{ name: found.z.name, unit: found.z.unit, values: Array.from(found.x.values, (_, i) => found.z.at(i)) }];
      this.drawing.show({ x: found.x, lines: this.lines, regime: found.regime, look });
    }
    this.tellRegimes(found, look);
  }

  // What lies between the cells of a map that is shown.
  sharpen(found, edges) {
    this.drawing?.sharpen?.(found.regime, edges);
  }

  // Whether what is drawn is of the view; else it is dimmed, and why is said over it, with {text, onclick} of what
  // one can do.
  dim(isStale, reason = "", action = null) {
    byId("picture").classList.toggle("stale", isStale);
    if (reason) this.overlay.say(reason, action);
    else this.overlay.clear();
  }

  // What is not known exactly: a band about each line, or maps of the least value and of the range, in the
  // colours of the picture.
  showBand(found, { x, y, z, low, high }, { name, share }) {
    const told = `${words(name)} known within ${number(100 * share)} %`;
    const host = byId("beside");
    host.hidden = !found.y;
    if (found.y) {
      const spread = (i, j) => high(i, j) - low(i, j);
      const values = [low, spread].flatMap((at) => Array.from(y.values, (_, j) => Array.from(x.values, (__, i) => at(i, j))).flat());
      const range = scaleOf([...this.drawing.flat, ...values]);
      const hosts = [element("div", {}), element("div", {})];
      fill(host, element("h3", {}, `The least value, ${told}`), hosts[0], element("h3", {}, "From the least to the largest, in the same colours"), hosts[1]);
      [low, spread].forEach((at, i) => {
        new HeatMap(hosts[i], { title: i ? "Range" : "Least value", isSmall: true }).show({ x, y, z: { ...z, at }, regime: null, look: () => ({}) }, { range });
      });
      return;
    }
    const along = (at) => Array.from(found.x.values, (_, i) => at(i));
    this.lines = [{ ...found.z, values: along(found.z.at), low: along(low), high: along(high) }];
    this.drawing.show({ x: found.x, lines: this.lines, regime: found.regime, look: (one) => lookOf(this.scene, one) });
  }

  // Lines of other designs over the same axis, of {text, found}.
  showOthers(found, others) {
    if (found.y || !others.length) return;
    const along = (one) => Array.from(one.x.values, (_, i) => one.z.at(i));
    const lines = others.map((one) => ({ ...one.found.z, label: one.text, values: along(one.found) }));
    this.drawing.show({ x: found.x, lines: [...this.lines, ...lines], regime: found.regime, look: (one) => lookOf(this.scene, one) });
  }

  // Points to be marked, of {x, y, text}, by whoever sets them.
  mark(marks, whose) {
    this.marks[whose] = marks;
    this.drawing?.mark?.(marks, whose);
  }

  // Points that were measured, of [value of the axis, value of the output], or null.
  points(points) {
    this.measured = points;
    this.drawing?.points?.(points);
  }

  // How far values lie apart along the axes.
  steps() {
    const apart = (axis, values) => (values?.length > 1 ? Math.abs(values[1] - values[0]) : axis && (axis.to - axis.from) / 100);
    const { x, y } = this.drawing?.data ?? {};
    return { x: apart(this.view.x, x?.values), y: apart(this.view.y, y?.values) };
  }

  // Shares of the regimes under Expert; under the picture what of it describes no real part.
  tellRegimes(found, look) {
    const all = occurring(found, look);
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
