// "What did I measure?": speeds that were measured, and the parameter that explains them, with its interval.

import { element, fill } from "./elements.js";
import { choiceField, fieldText, numberInput, readNumber } from "./fields.js";
import { carryOut } from "./service.js";
import { signal } from "./store.js";
import { givenValues } from "./view.js";
import { capital, label, number, shown, withUnit, words } from "./words.js";

const POINTS = 2000; // at which an unknown is tried
const SPEED = "m s-1";
const RANGES = { friction: [0.02, 1], restitution: [0, 0.9] };
const LEAST = 2; // runs
const MOST = 50;

export class Measured {
  // `onruns(runs)` hears of what was measured.
  constructor(host, onruns) {
    this.host = host;
    this.onruns = onruns;
    this.options = signal({ unknown: "friction", error: 0.05 });
  }

  show(view, scene) {
    const { unit } = scene.parameters.find(({ name }) => name === view.x.name);
    const unknowns = Object.keys(RANGES).filter((name) => name in view.values);
    const { unknown, error } = this.options.value;
    const lines = view.runs.map(([x, speed]) => `${fieldText(x, unit)}\t${fieldText(speed, SPEED)}`);
    const wrong = element("span", { class: "wrong", role: "alert" });
    const table = element("textarea", { id: "runs", rows: Math.min(12, lines.length + 1), autocomplete: "off", spellcheck: "false", onchange: () => this.read(table.value, unit, wrong) });
    table.value = lines.join("\n");
    const known = numberInput("Error of each measured speed, in per cent", 100 * error, "%", (value) => (this.options.value = { ...this.options.value, error: value / 100 }), {
      check: (value) => (value > 0 && value < 100 ? "" : "The error of the measured speeds has to be between 0 and 100 %"),
    });
    fill(
      this.host,
      element("div", { class: "field" }, element("label", { for: "runs" }, `${label(view.x.name, unit)} and measured speed (mm/s), a line each, or pasted from a table`), table),
      element("div", { class: "within" }, "each speed within ±", element("span", { class: "slot" }, known, element("span", { class: "unit" }, "%"))),
      unknowns.length > 1
        ? choiceField("unknown", "Unknown", unknowns.map((name) => [name, capital(words(name))]), unknown, (name) => (this.options.value = { ...this.options.value, unknown: name }))
        : null,
      wrong,
    );
  }

  // The runs that are typed; what is none is said, and changes nothing.
  read(text, unit, wrong) {
    const rows = text.split(/\n/).map((line) => line.trim()).filter(Boolean).map((line) => line.split(/[\s;]+/));
    const problem = (told) => {
      wrong.textContent = `${told}.`;
    };
    const odd = rows.find((row) => row.length !== 2);
    if (odd) return problem(`"${odd.join(" ").slice(0, 40)}" is not two numbers: a setting and a speed`);
    const read = rows.map(([x, speed]) => [readNumber(x, unit), readNumber(speed, SPEED)]);
    const bad = read.flat().find((one) => one.problem);
    if (bad) return problem(bad.problem);
    if (read.length < LEAST || read.length > MOST) return problem(`Give from ${LEAST} to ${MOST} runs`);
    wrong.textContent = "";
    this.onruns(read.map(([x, speed]) => [x.value, speed.value]));
  }

  // What is asked of the service; null where nothing was measured.
  study(view) {
    const { unknown, error } = this.options.value;
    if (view.question !== "measured" || view.kind !== "simulate" || !view.runs || !(unknown in view.values) || view.y) return null;
    const fixed = givenValues(view);
    delete fixed[unknown];
    delete fixed[view.x.name];
    const [lower, upper] = RANGES[unknown];
    return {
      kind: "calibrate",
      scene: view.scene,
      ...(view.choice ? { method: view.choice } : {}),
      points: POINTS,
      parameters: fixed,
      observations: [{ [view.x.name]: view.runs.map(([x]) => x), conveying_velocity: view.runs.map(([, speed]) => speed), error: `${number(100 * error)} %` }],
      unknowns: { [unknown]: { lower, upper } },
    };
  }

  // {name, value, low, high, rms} of what explains the runs.
  async fit(view, scene, { signal: abort, tell }) {
    const { unknown } = this.options.peek();
    const { dataset } = await carryOut("calibrate", this.study(view), { signal: abort, tell });
    const value = (what) => dataset.variables[`${what}_${unknown}`]?.data;
    const residuals = dataset.variables.residual.data;
    const rms = Math.sqrt(residuals.reduce((sum, one) => sum + one * one, 0) / residuals.length);
    return { name: unknown, value: value("best"), low: value("lower_95"), high: value("upper_95"), rms };
  }
}

// The answer of a fit, as `answers.js` has them.
export function fitTold({ name, value, low, high, rms }, scene) {
  const { unit } = scene.parameters.find((one) => one.name === name);
  const [lower, upper] = [low, high].map((end) => withUnit(end, unit, 3));
  return {
    number: number(value * shown(unit)[0], 3),
    unit: words(name),
    sentence: `${lower} to ${upper} with 95 %; the measured speeds differ from the curve by ${number(rms * shown(SPEED)[0], 2)} mm/s.`,
    strip: { low, high, value, unit },
  };
}
