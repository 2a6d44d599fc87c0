// "My part, here": a point of the picture in exact numbers, and what a part does there in one line.

import { element, fill } from "./elements.js";
import { numberInput } from "./fields.js";
import { capital, label, number, withUnit, words } from "./words.js";

const HOP = 1e-9; // of the scale of lengths: what is lower is rounding

export class PartHere {
  // `onpoint({x, y})` hears of a point that was typed.
  constructor(host, onpoint) {
    this.host = host;
    this.onpoint = onpoint;
    this.answer = element("p", { class: "answer", "aria-live": "polite" });
  }

  // The fields of a view; without motion in time there is nothing to tell of a part.
  show(view, scene) {
    this.view = view;
    this.host.hidden = !scene.methods.length;
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
      return [element("label", { for: `here-${place}` }, label(name, unit)), this.fields[place]];
    };
    fill(
      this.host,
      element("div", { class: "here" }, element("strong", {}, "My part, here:"), ...axes.flatMap(field)),
      this.answer,
    );
    this.answer.textContent = view.point ? "" : "Type a point, or click one in the picture.";
  }

  // A point that was chosen elsewhere stands in the fields, too.
  place(point) {
    for (const [place, field] of Object.entries(this.fields ?? {})) {
      if (point[place] === null || point[place] === undefined) continue;
      field.show(point[place]);
      field.taken(point[place]);
    }
  }

  // What a part does at a point, by its course and the numbers of the study.
  tell({ velocity, height, throwNumber, amplitude, regime }) {
    const most = Math.max(...height);
    const scale = Math.max(...height.map(Math.abs), amplitude ?? 0);
    const more = [words(regime)];
    if (most > HOP * scale) more.push(`hops ${withUnit(most, "m", 3)} high`);
    if (throwNumber > 0) {
      const lifts = amplitude ? ` (lifts off at ${withUnit(amplitude / throwNumber, "m", 3)} of amplitude)` : "";
      more.push(`throw number ${number(throwNumber, 3)}${lifts}`);
    }
    fill(
      this.answer,
      element("strong", {}, velocity === null ? "No mean speed" : withUnit(velocity, "m s-1", 4)),
      ` ${capital(more.filter(Boolean).join(", "))}.`,
    );
  }
}
