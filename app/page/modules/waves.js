// "My drive is not a sine": an ellipse, two frequencies, steps, or what an accelerometer recorded.

import { element, fill } from "./elements.js";
import { choiceField } from "./fields.js";
import { SETS } from "./sets.js";

const CHOICES = ["ellipse", "harmonics", "steps"];
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
    const names = view.recording ? [...CHOICES, "recorded"] : CHOICES;
    this.said.textContent = view.recording?.name ?? "";
    fill(
      this.host,
      element(
        "div",
        { class: "runs" },
        choiceField("wave", "Shape of the drive", names.map((name) => [name, SETS[name].title]), view.set, (set) => this.onchange({ set, x: undefined, y: undefined })),
        element("span", {}, element("label", { for: "recording" }, "or the CSV file of a recording: time [s], then accelerations [g] or [m/s^2]"), file),
        this.said,
      ),
    );
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
    this.said.textContent = `${file.name} is being fitted ...`;
    this.onchange({ set: "recorded", recording, x: undefined, y: undefined });
  }
}
