// "My part, here": a point of the picture in exact numbers, and what a part does there in one large line.

import { speedBand } from "./computed.js";
import { element, fill } from "./elements.js";
import { numberInput } from "./fields.js";
import { Refusal } from "./service.js";
import { capital, label, number, withUnit, words } from "./words.js";

const HOP = 1e-9; // of the scale of lengths: what is lower is rounding

export class PartHere {
  // `onpoint({x, y})` hears of a point that was typed, `onpin()` that its design is to be pinned.
  constructor(host, { onpoint, onpin }) {
    this.host = host;
    this.onpoint = onpoint;
    this.pin = element("button", { type: "button", onclick: onpin, title: "Keep this design to compare it with others" }, "Pin");
    this.answer = element("p", { class: "answer", "aria-live": "polite" });
    this.more = element("p", { class: "more" });
  }

  // The fields of a view; without motion in time there is nothing to tell of a part.
  show(view, scene) {
    this.view = view;
    this.scene = scene;
    this.host.hidden = !scene.methods.length;
    this.host.classList.toggle("banded", Boolean(view.band));
    if (this.host.hidden) return;
    const axes = ["x", "y"].filter((place) => view[place]);
    const typed = { x: view.point?.x ?? null, y: view.point?.y ?? null };
    this.fields = {};
    const field = (place) => {
      const { name } = view[place];
      const { unit } = scene.parameters.find((one) => one.name === name);
      const set = (value) => {
        typed[place] = value;
        if (axes.every((one) => typed[one] !== null)) this.onpoint({ x: typed.x, y: typed.y });
      };
      this.fields[place] = numberInput(null, typed[place], unit, set, { id: `here-${place}`, size: 7 });
      this.fields[place].taken = (value) => (typed[place] = value);
      return element("span", {}, element("label", { for: `here-${place}` }, label(name, unit)), " ", this.fields[place]);
    };
    fill(
      this.host,
      this.answer,
      this.more,
      element("div", { class: "here" }, element("strong", {}, "My part, here:"), ...axes.map(field), this.pin),
    );
    this.pin.hidden = view.kind !== "simulate";
    fill(this.answer, view.point ? "Simulating the part ..." : "Type the values of a point, or click a point in the picture.");
    fill(this.more);
  }

  // A point that was chosen elsewhere stands in the fields, too.
  place(point) {
    for (const [place, field] of Object.entries(this.fields ?? {})) {
      if (point[place] === null || point[place] === undefined) continue;
      field.show(point[place]);
      field.taken(point[place]);
    }
  }

  // What a part does at a point, by its course; null where there is none.
  async tell(view, course) {
    this.told = view;
    if (!course) {
      fill(this.answer, "The motion at this point could not be computed: see the reason below.");
      fill(this.more);
      return;
    }
    const { velocity, regime } = course;
    const speed = velocity === null || velocity === undefined ? "No mean speed" : withUnit(velocity, "m s-1", 4);
    const band = element("span", { class: "band" });
    if (view.question === "hop") {
      const hop = this.hop(course);
      fill(this.answer, element("strong", {}, hop ? `Hops ${withUnit(hop, "m", 3)} high` : "Does not hop"), ` ${capital(words(regime))}`);
    } else fill(this.answer, element("strong", {}, speed), " ", band, ` ${capital(words(regime))}`);
    this.more.textContent = this.lines(course, view.question === "hop" ? [`mean speed ${speed}`] : []);
    if (!view.band || !(view.band.name in view.values)) return;
    try {
      const found = await speedBand(view, this.scene);
      if (this.told !== view || !found) return;
      const { name, share } = view.band;
      const told = `${words(name)} known within ${number(100 * share, 3)} %`;
      band.textContent = `(${withUnit(found.least, "m s-1", 3)} to ${withUnit(found.largest, "m s-1", 3)} with the ${told})`;
    } catch (error) {
      if (!(error instanceof Refusal)) throw error; // the picture tells what is wrong
    }
  }

  // How high it hops, how far from lift-off it is, and what a row does.
  lines(course, more) {
    const { throwNumber, amplitude, stroke, platoons } = course;
    const hop = this.hop(course);
    if (hop && !more.length) more.push(`hops ${withUnit(hop, "m", 3)} high`);
    if (throwNumber > 0) {
      const [size, text] = stroke ? [stroke, "from peak to peak"] : [amplitude, "of amplitude"];
      const lifts = size ? ` (lifts off at ${withUnit(size / throwNumber, "m", 3)} ${text})` : "";
      more.push(`throw number ${number(throwNumber, 3)}${lifts}`);
    }
    if (platoons) more.push(`${number(platoons)} ${platoons === 1 ? "platoon" : "platoons"}`);
    return more.length ? `${capital(more.join(", "))}.` : "";
  }

  // How high the part hops; 0 where that is nothing but rounding.
  hop({ height, hopHeight, amplitude, stroke }) {
    const most = hopHeight ?? Math.max(0, ...height);
    return most > HOP * Math.max(0, ...height.map(Math.abs), amplitude ?? stroke ?? 0) ? most : 0;
  }
}
