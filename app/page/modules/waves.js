// "My drive is not a sine": an ellipse, two frequencies, steps, or what an accelerometer recorded.

import { element, fill } from "./elements.js";
import { choiceField } from "./fields.js";
import { SETS } from "./sets.js";

const CHOICES = ["ellipse", "harmonics", "steps", "recorded"];
const MAX_BYTES = 2_000_000;

export class Waves {
  // `onchange(patch)` hears of another drive.
  constructor(host, onchange) {
    this.host = host;
    this.onchange = onchange;
    this.said = element("span", { role: "status" });
  }

  show(view) {
    const file = element("input", { type: "file", id: "recording", accept: ".csv,.txt,text/csv", onchange: () => this.read(file.files[0]) });
    fill(
      this.host,
      element(
        "div",
        { class: "runs" },
        choiceField("wave", "Shape of the drive", CHOICES.map((name) => [name, SETS[name].title]), view.set, (set) => this.choose(set)),
        view.set === "recorded" || this.isWaiting
          ? element("span", {}, element("label", { for: "recording" }, "CSV file of the recording: time [s], then accelerations [g] or [m/s^2]"), file)
          : null,
        this.said,
      ),
    );
    if (view.recording && view.set === "recorded") this.said.textContent = view.recording.name;
  }

  choose(set) {
    this.isWaiting = set === "recorded";
    this.said.textContent = this.isWaiting ? "Choose the CSV file of the recording." : "";
    if (this.isWaiting) this.show({ set });
    else this.onchange({ set, x: undefined, y: undefined });
  }

  // The columns by their names: those that end in x or say along, and in z or say normal.
  async read(file) {
    if (!file) return;
    if (file.size > MAX_BYTES) {
      this.said.textContent = "The recording is too large: cut it to 20,000 rows or fewer.";
      return;
    }
    const data = await file.text();
    const head = data.split(/\r?\n/, 1)[0].split(/[,;\t]/).map((one) => one.trim());
    const bare = (one) => one.replace(/\[.*\]/, "").trim();
    const column = (pattern) => head.slice(1).map(bare).find((one) => pattern.test(one));
    const along = column(/x$|along/i);
    const normal = column(/z$|normal/i);
    if (!along && !normal) {
      this.said.textContent = "The first line of the recording has to name its columns, such as time [s],ax [g],az [g].";
      return;
    }
    const recording = { name: file.name, drive: { data, ...(along ? { along } : {}), ...(normal ? { normal } : {}) } };
    this.isWaiting = false;
    this.said.textContent = `${file.name} is being fitted ...`;
    this.onchange({ set: "recorded", recording, x: undefined, y: undefined });
  }
}
