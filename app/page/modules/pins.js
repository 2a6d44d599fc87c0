// Designs that are pinned, beside the one at the chosen point: their values and what a part does there.

import { design, flagOf, valueOf } from "./computed.js";
import { element, fill } from "./elements.js";
import { button } from "./fields.js";
import { Refusal } from "./service.js";
import { MAX_PINS } from "./link.js";
import { givenValues } from "./view.js";
import { capital, label, number, shown, words } from "./words.js";

export const LETTERS = ["A", "B", "C", "D"];
const TOLD = ["conveying_velocity", "hop_height", "throw_number"];

export class Pins {
  // `onpins(pins)` hears of other pins, `onshow(values)` of one that is to be the design.
  constructor(host, { onpins, onshow, persist }) {
    this.host = host;
    this.onpins = onpins;
    this.persist = persist;
    this.onshow = onshow;
  }

  // Keep designs, each once, the last ones where there are too many.
  pin(view, designs = [view.values]) {
    const told = (values) => JSON.stringify(Object.entries(values).sort());
    const pins = view.pins ?? [];
    const added = designs.filter((one) => !pins.some((pin) => told(pin) === told(one)));
    this.onpins([...pins, ...added.map((one) => ({ ...one }))].slice(0, MAX_PINS));
  }

  async show(view, scene) {
    const pins = view.pins ?? [];
    this.shown = view;
    this.host.hidden = !pins.length;
    if (this.host.hidden) return;
    const designs = [...pins, view.values];
    const found = await Promise.all(designs.map((values) => this.done(view, scene, values)));
    if (this.shown === view) this.draw(view, scene, designs, found);
  }

  // What a part does with these values, or null where the service refuses them.
  done(view, scene, values) {
    return this.persist(() => design(view, scene, {}, { values: givenValues({ ...view, values }) })).catch((error) => {
      if (error instanceof Refusal) return null;
      throw error;
    });
  }

  draw(view, scene, designs, found) {
    const row = (head, texts) => element("tr", {}, element("th", { scope: "row" }, head), ...texts.map((text) => element("td", {}, text)));
    const numbers = (name, unit, values) => row(label(name, unit), values.map((value) => (Number.isFinite(value) ? number(value * shown(unit)[0]) : "-")));
    const kept = (view.pins ?? []).map((values, i) =>
      element(
        "th",
        { scope: "col" },
        LETTERS[i],
        button("Show", () => this.onshow(values), { "aria-label": `Show design ${LETTERS[i]}` }),
        button("Remove", () => this.onpins(view.pins.filter((_, k) => k !== i)), { "aria-label": `Remove design ${LETTERS[i]}` }),
      ),
    );
    const differs = ({ name }) => new Set(designs.map((values) => values[name])).size > 1;
    const outputs = scene.outputs.filter(({ name }) => TOLD.includes(name) || name === view.output);
    fill(
      this.host.lastElementChild,
      element("thead", {}, element("tr", {}, element("td"), ...kept, element("th", { scope: "col" }, "Here"))),
      element(
        "tbody",
        {},
        ...outputs.map(({ name, unit }) => numbers(name, unit, found.map((one) => valueOf(one?.dataset, name)))),
        row("What it does", found.map((one) => (one ? capital(words(flagOf(one.dataset))) : "Not computed"))),
        ...scene.parameters.filter(differs).map(({ name, unit }) => numbers(name, unit, designs.map((values) => values[name]))),
      ),
    );
  }
}
