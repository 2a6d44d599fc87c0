// "What did I measure?": speeds that were measured, the parameter that explains them, and both in one picture.

import { givenValues } from "./view.js";
import { byId, element, fill } from "./elements.js";
import { choiceField, numberInput } from "./fields.js";
import { fieldText, readNumber } from "./numbers.js";
import { Refusal, carryOut } from "./service.js";
import { capital, label, number, sentence, shown, withUnit, words } from "./words.js";

const POINTS = 2000; // at which an unknown is tried
const SPEED = "m s-1";
const RANGES = { friction: [0.02, 1], restitution: [0, 0.9] };
const LEAST = 2; // runs

export class Measured {
  // `onruns(runs)` hears of what was measured, `onvalue(name, value)` of what explains it.
  constructor(host, { onruns, onvalue, tell }) {
    this.host = host;
    this.onruns = onruns;
    this.onvalue = onvalue;
    this.tellJob = tell;
    this.error = 0.05;
    this.unknown = "friction";
    this.said = element("p", { class: "finding", role: "status" });
  }

  show(view, scene) {
    this.view = view;
    this.scene = scene;
    const { unit } = scene.parameters.find(({ name }) => name === view.x.name);
    const unknowns = Object.keys(RANGES).filter((name) => name in view.values);
    if (!unknowns.includes(this.unknown)) [this.unknown] = unknowns;
    const columns = [unit, SPEED].map((one, i) => view.runs.map((run) => fieldText(run[i], one)).join("  "));
    this.wrong = element("span", { class: "wrong", role: "alert" });
    const list = (id, text, value) =>
      element("span", {}, element("label", { for: id }, text), element("input", { id, value, autocomplete: "off", onchange: () => this.read(unit) }));
    const error = numberInput("Error of each measured speed, in per cent", 100 * this.error, "%", (value) => (this.error = value / 100), {
      check: (value) => (value > 0 && value < 100 ? "" : "The error of the measured speeds has to be between 0 and 100 %"),
    });
    fill(
      this.host,
      element(
        "div",
        { class: "runs" },
        list("runs-x", label(view.x.name, unit), columns[0]),
        list("runs-speed", "Measured speeds (mm/s)", columns[1]),
        element("span", { class: "error" }, "each ±", error, "%"),
        unknowns.length > 1
          ? choiceField("unknown", "Unknown", unknowns.map((name) => [name, capital(words(name))]), this.unknown, (name) => (this.unknown = name))
          : null,
        element("button", { type: "button", id: "find-unknown", class: "main", onclick: () => this.find() }, `Find the ${words(this.unknown ?? "friction")}`),
      ),
      this.wrong,
      this.said,
    );
    this.said.textContent = "Enter your measured speeds, or use these five runs of an M4 nut.";
  }

  follow(view) {
    this.view = view;
  }

  // The runs that are typed; what is none is said, and changes nothing.
  read(unit) {
    const [xs, speeds] = ["runs-x", "runs-speed"].map((id) => byId(id).value.split(/[\s;]+/).filter(Boolean));
    const problem = (text) => {
      this.wrong.textContent = `${text}.`;
    };
    const numbers = [[xs, unit], [speeds, SPEED]].map(([list, one]) => list.map((text) => readNumber(text, one)));
    const bad = numbers.flat().find((one) => one.problem);
    if (bad) return problem(bad.problem);
    if (xs.length !== speeds.length) return problem(`You gave ${xs.length} settings and ${speeds.length} speeds: give one speed for each setting`);
    if (xs.length < LEAST || xs.length > 50) return problem("Give from 2 to 50 runs");
    this.wrong.textContent = "";
    this.onruns(numbers[0].map(({ value }, i) => [value, numbers[1][i].value]));
  }

  async find() {
    const { view } = this;
    const fixed = givenValues(view);
    delete fixed[this.unknown];
    const [lower, upper] = RANGES[this.unknown];
    const study = {
      kind: "calibrate",
      scene: view.scene,
      ...(view.choice ? { method: view.choice } : {}),
      points: POINTS,
      parameters: fixed,
      observations: [
        { [view.x.name]: view.runs.map(([x]) => x), conveying_velocity: view.runs.map(([, speed]) => speed), error: this.error_() },
      ],
      unknowns: { [this.unknown]: { lower, upper } },
    };
    this.said.textContent = "Comparing simulated motions with the measured speeds ...";
    try {
      const tell = (job) => {
        this.tellJob(job);
        this.said.textContent = `${job.message} ${job.progress} %`;
      };
      const { dataset } = await carryOut("calibrate", study, { tell });
      this.tell(dataset.variables);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      this.said.textContent = error.errors[0] ? sentence(error.errors[0]) : error.message;
    }
  }

  error_() {
    return `${number(100 * this.error)} %`;
  }

  tell(variables) {
    const name = this.unknown;
    const { unit } = this.scene.parameters.find((one) => one.name === name);
    const value = (what) => variables[`${what}_${name}`]?.data;
    const told = [value("lower_95"), value("upper_95")].map((end) => withUnit(end, unit, 3)).join(" to ");
    const residuals = variables.residual.data;
    const rms = Math.sqrt(residuals.reduce((sum, one) => sum + one * one, 0) / residuals.length);
    fill(
      this.said,
      element("strong", {}, `${capital(words(name))} ${withUnit(value("best"), unit, 3)}`),
      ` (${told} with 95 %). The measured speeds differ from the computed curve by ${number(rms * shown(SPEED)[0], 2)} mm/s.`,
    );
    this.onvalue(name, Number(value("best").toPrecision(4)));
  }
}
