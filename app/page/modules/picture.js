// The picture of a view: a map or lines, the worst case of what is not known exactly, and how much holds.

import { Curves } from "./curves.js";
import { byId, element, fill, reveal } from "./elements.js";
import { occurring } from "./legend.js";
import { HeatMap } from "./map.js";
import { lookOf } from "./markers.js";
import { pictureOf } from "./view.js";
import { capital, number, words } from "./words.js";

export class Picture {
  constructor({ onpick, onpoint }) {
    this.onpick = onpick;
    this.onpoint = onpoint;
    this.drawing = null; // a map or lines
    this.marks = {}; // by who sets them
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
    byId("note").hidden = scene.regimes.every(({ valid }) => valid);
  }

  // `isMoving` while a slider is dragged: the next picture will soon be there.
  show(found, view, { isMoving = false } = {}) {
    this.undim();
    byId("host").dataset.view = pictureOf(view);
    const kind = found.y ? "map" : "curves";
    if (this.kind !== kind) {
      const { onpick, onpoint } = this;
      const told = { hint: this.hint(), title: words(this.view.output) };
      const options = { onpick, onpoint, ...told };
      const host = byId("host");
      this.drawing = kind === "map" ? new HeatMap(host, options) : new Curves(host, options);
      this.kind = kind;
      for (const [whose, marks] of Object.entries(this.marks)) this.mark(marks, whose);
    }
    const look = (name) => lookOf(this.scene, name);
    if (kind === "map") this.drawing.show({ ...found, look }, { isMoving });
    else {
      const values = Array.from(found.x.values, (_, i) => found.z.at(i));
      this.drawing.show({
        x: found.x,
        lines: [{ name: found.z.name, unit: found.z.unit, values }],
        regime: found.regime,
        look,
      });
    }
    this.tellValidity(found);
    reveal();
  }

  // What is drawn is not, or not yet, of the fields: it is dimmed, and why is said over it.
  dim(reason) {
    if (!this.drawing) return;
    byId("picture").classList.add("stale");
    byId("stale").textContent = reason;
  }

  undim() {
    byId("picture").classList.remove("stale");
    byId("stale").textContent = "";
  }

  hint() {
    const motion = this.scene.methods.length ? " Click, or press Enter, to see the motion there." : "";
    return `Point at the picture to read it.${motion}`;
  }

  // What is not known exactly: a band about each line, or a second map of the worst case.
  showBand(found, { x, y, low, high }, { name, share }) {
    const host = byId("worst");
    const told = `${words(name)} known within ${number(100 * share)} %`;
    host.hidden = false;
    if (found.y) {
      fill(host, element("h2", {}, `The least value, ${told}`), element("div", { id: "worst-host" }));
      const worst = new HeatMap(byId("worst-host"), { title: "Worst case" });
      worst.show({ x, y, z: { ...found.z, at: low }, regime: null });
      return;
    }
    fill(host, element("p", {}, `The band: ${told}.`));
    const along = (at) => Array.from(found.x.values, (_, i) => at(i));
    this.drawing.show({
      x: found.x,
      lines: [{ ...found.z, values: along(found.z.at), low: along(low), high: along(high) }],
      regime: found.regime,
      look: (one) => lookOf(this.scene, one),
    });
  }

  // Points to be marked, of {x, y, text}, by whoever sets them. Lines have no marks.
  mark(marks, whose) {
    this.marks[whose] = marks;
    this.drawing?.mark?.(marks, whose);
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
        "describe a real part: it has left the track. Motion in time tells its true speed."
      : "";
  }
}
