// "My drive is not a sine": an ellipse, two frequencies, steps, or what an accelerometer recorded.

import { element, fill } from "./elements.js";
import { choiceField } from "./fields.js";
import { SETS } from "./sets.js";

const CHOICES = ["ellipse", "harmonics", "steps"];
const MAX_BYTES = 2_000_000;

// `onchange(patch)` hears of another drive.
export function tellWaves(host, view, onchange) {
  const said = element("span", { role: "status" }, view.recording?.name);
  const take = async () => {
    const { recording, problem } = await recordingOf(file.files[0]);
    said.textContent = problem ?? `${recording.name} is being fitted ...`;
    if (recording) onchange({ set: "recorded", recording, x: undefined, y: undefined });
  };
  const file = element("input", { type: "file", id: "recording", accept: ".csv,.txt,text/csv", onchange: () => file.files.length && take() });
  const names = view.recording ? [...CHOICES, "recorded"] : CHOICES;
  fill(
    host,
    element(
      "div",
      { class: "runs" },
      choiceField("wave", "Shape of the drive", names.map((name) => [name, SETS[name].title]), view.set, (set) => onchange({ set, x: undefined, y: undefined })),
      element("span", {}, element("label", { for: "recording" }, "or the CSV file of a recording: time [s], then accelerations [g] or [m/s^2]"), file),
      said,
    ),
  );
}

// A file as a drive of a study, or what is wrong with it. Its columns by their names: those that end in x or say along,
// and in z or say normal.
/** @returns {Promise<any>} */
async function recordingOf(file) {
  if (file.size > MAX_BYTES) return { problem: "The recording is too large: cut it to 20,000 rows or fewer." };
  const data = await file.text();
  const head = data.split(/\r?\n/, 1)[0].split(/[,;\t]/).map((one) => one.replace(/\[.*\]/, "").trim());
  const column = (pattern) => head.slice(1).find((one) => pattern.test(one));
  const along = column(/x$|along/i);
  const normal = column(/z$|normal/i);
  if (!along && !normal) return { problem: "The first line of the recording has to name its columns, such as time [s],ax [g],az [g]." };
  return { recording: { name: file.name, drive: { data, ...(along ? { along } : {}), ...(normal ? { normal } : {}) } } };
}
