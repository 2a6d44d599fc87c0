// The picture of a view: a map or lines, the worst case of what is not known exactly, and how much holds.

import { Curves } from "./curves.js";
import { scaleOf } from "./colours.js";
import { byId, element, fill, reveal } from "./elements.js";
import { occurring } from "./legend.js";
import { HeatMap } from "./map.js";
import { lookOf } from "./markers.js";
import { Overlay } from "./overlay.js";
import { pictureOf } from "./view.js";
import { capital, number, words } from "./words.js";

export class Picture {
  constructor({ onpick, onpoint, ondrag }) {
    this.onpick = onpick;
    this.ondrag = ondrag;
    this.onpoint = onpoint;
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
    this.dim("Computing ...");
    fill(byId("headline"), capital(words(view.output)), " ", element("small", {}, scene.title));
    byId("worst").hidden = true;
    // Maps of what is not known exactly have their room from the start.
    const hasMaps = Boolean(view.band && view.y) && view.question !== "drive";
    byId("beside").hidden = !hasMaps;
    fill(byId("beside"), ...(hasMaps ? [element("div", { class: "map small" }), element("div", { class: "map small" })] : []));
    byId("note").hidden = view.kind === "simulate" || scene.regimes.every(({ valid }) => valid);
  }

  // `isMoving` while a slider is dragged: the next picture will soon be there.
  show(found, view, { isMoving = false } = {}) {
    this.undim();
    byId("host").dataset.view = pictureOf(view);
    const kind = found.y ? "map" : "curves";
    if (this.kind !== kind) {
      const { onpick, onpoint, ondrag } = this;
      const told = { hint: this.hint(), title: words(this.view.output) };
      const options = { onpick, onpoint, ondrag, ...told };
      const host = byId("host");
      this.drawing = kind === "map" ? new HeatMap(host, options) : new Curves(host, options);
      this.kind = kind;
      for (const [whose, marks] of Object.entries(this.marks)) this.mark(marks, whose);
      this.drawing.points?.(this.measured);
    }
    const look = (name) => lookOf(this.scene, name);
    if (kind === "map") this.drawing.show({ ...found, look }, { isMoving });
    else {
      const values = Array.from(found.x.values, (_, i) => found.z.at(i));
      this.lines = [{ name: found.z.name, unit: found.z.unit, values }];
      this.drawing.show({
        x: found.x,
        lines: this.lines,
        regime: found.regime,
        look,
      });
    }
    this.tellValidity(found);
    reveal();
  }

  // What lies between the cells of a map that is shown.
  sharpen(found, edges) {
    this.drawing?.sharpen?.(found.regime, edges);
  }

  // What is drawn is not, or not yet, of the fields: it is dimmed, and why is said over it, with
  // {text, onclick} of what one can do.
  dim(reason, action = null) {
    byId("picture").classList.add("stale");
    this.overlay.say(reason, action);
  }

  // The same over a picture that is of the fields.
  tell(text, action = null) {
    this.overlay.say(text, action);
  }

  undim() {
    byId("picture").classList.remove("stale");
    this.overlay.clear();
  }

  hint() {
    const motion = this.scene.methods.length ? " Click, press Enter, or drag the ring to show the motion at that point." : "";
    return `Point at the picture to read its values.${motion}`;
  }

  // What is not known exactly: a band about each line, or maps of the least value and of the spread, in
  // the colours of the picture.
  showBand(found, { x, y, low, high }, { name, share }) {
    const told = `${words(name)} known within ${number(100 * share)} %`;
    const look = (one) => lookOf(this.scene, one);
    if (found.y) {
      const spread = (i, j) => high(i, j) - low(i, j);
      const values = [low, spread].flatMap((at) => Array.from(y.values, (_, j) => Array.from(x.values, (__, i) => at(i, j))).flat());
      const range = scaleOf([...this.drawing.flat, ...values]);
      this.drawing.show({ ...found, look }, { range });
      const hosts = [element("div", {}), element("div", {})];
      byId("beside").hidden = false;
      fill(
        byId("beside"),
        element("h3", {}, `The least value, ${told}`),
        hosts[0],
        element("h3", {}, "Range of the values, in the same colours"),
        hosts[1],
      );
      [low, spread].forEach((at, i) => {
        const map = new HeatMap(hosts[i], { title: i ? "Spread" : "Least value", isSmall: true });
        map.show({ x, y, z: { ...found.z, at }, regime: null }, { range });
      });
      return;
    }
    byId("worst").hidden = false;
    fill(byId("worst"), `The band: ${told}.`);
    const along = (at) => Array.from(found.x.values, (_, i) => at(i));
    this.lines = [{ ...found.z, values: along(found.z.at), low: along(low), high: along(high) }];
    this.drawing.show({ x: found.x, lines: this.lines, regime: found.regime, look });
  }

  // Lines of other designs over the same axis, of {text, found}.
  showOthers(found, others) {
    if (found.y || !others.length) return;
    const along = (one) => Array.from(one.x.values, (_, i) => one.z.at(i));
    const lines = others.map((one) => ({ ...one.found.z, label: one.text, values: along(one.found) }));
    const look = (one) => lookOf(this.scene, one);
    this.drawing.show({ x: found.x, lines: [...this.lines, ...lines], regime: found.regime, look });
  }

  // Points to be marked, of {x, y, text}, by whoever sets them. Lines have no marks.
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
    const apart = (axis, values) =>
      values?.length > 1 ? Math.abs(values[1] - values[0]) : axis && (axis.to - axis.from) / 100;
    const { x, y } = this.drawing?.data ?? {};
    return { x: apart(this.view.x, x?.values), y: apart(this.view.y, y?.values) };
  }

  // How much of the picture does not describe a real part.
  tellValidity(found) {
    const invalid = new Set(this.scene.regimes.filter(({ valid }) => !valid).map(({ value }) => value));
    if (!found.regime || !invalid.size) {
      byId("note").textContent = "";
      return;
    }
    const beyond = occurring(found, (name) => lookOf(this.scene, name))
      .filter(({ value }) => invalid.has(value))
      .reduce((sum, { share }) => sum + share, 0);
    byId("note").textContent = beyond
      ? `In ${number(100 * beyond, 3)} % of the picture${found.y ? ", which is hatched," : ""} these formulas do not ` +
        "describe a real part: it has left the track. A simulation of the motion gives its true speed."
      : "";
  }
}
