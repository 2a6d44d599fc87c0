// A part from a file of its surface: it is dropped or chosen, and sent as data.

import { byId } from "./elements.js";

const OUTPUTS = ["let_down_share", "thrown_share", "lying_height", "lying_length", "lying_width"];

// The study of a part from a file: all its aspects.
/** @param {any} view */
export function surfaceStudy({ scene, surface }) {
  return { kind: "sweep", scene, variant: "mesh", outputs: OUTPUTS, part: surface.part, parameters: {} };
}

// The content as a study has it: text as it is, a binary file in Base64.
async function contentOf(file) {
  const isBinary = new Uint8Array(await file.slice(0, 1000).arrayBuffer()).includes(0);
  if (!isBinary) return file.text();
  const reader = new FileReader();
  await new Promise((done) => {
    reader.onload = done;
    reader.readAsDataURL(file);
  });
  return String(reader.result).split(",")[1];
}

export class Surface {
  // `onsurface(surface)` hears of a file {name, place, part}, null of a plain shape in its place.
  constructor(onsurface) {
    this.onsurface = onsurface;
    this.taken = 0; // files
    const [host, file] = [byId("surface"), byId("surface-file")];
    file.addEventListener("change", () => this.take(file.files[0]));
    host.addEventListener("dragover", (event) => event.preventDefault());
    host.addEventListener("drop", (event) => {
      event.preventDefault();
      this.take(event.dataTransfer.files[0]);
    });
    byId("surface-told").lastElementChild.addEventListener("click", () => onsurface(null));
  }

  show({ surface }) {
    byId("surface-told").hidden = !surface;
    byId("surface-told").firstElementChild.textContent = surface?.name ?? "";
    if (!surface) byId("surface-file").value = "";
  }

  async take(file) {
    if (!file) return;
    const data = await contentOf(file);
    const part = data.startsWith("ISO-10303") ? { data } : { data, unit: byId("surface-unit").value };
    this.onsurface({ name: file.name, place: (this.taken += 1), part });
  }
}
