// What can be taken away: the numbers, the picture, the study, a link.

import { element, fill } from "./elements.js";
import { address, file, follow, put } from "./service.js";
import { save } from "./saving.js";

// A study as TOML: its values are numbers, texts, lists and small tables only.
export function toToml(study) {
  const lines = [];
  const one = (value) => {
    if (Array.isArray(value)) return `[${value.map(one).join(", ")}]`;
    if (value !== null && typeof value === "object") {
      return `{ ${Object.entries(value).map(([name, inner]) => `${name} = ${one(inner)}`).join(", ")} }`;
    }
    // JSON's texts and numbers are TOML's as well.
    return JSON.stringify(value);
  };
  const tables = [];
  for (const [name, value] of Object.entries(study)) {
    const isTable = value !== null && typeof value === "object" && !Array.isArray(value);
    if (isTable) tables.push([name, value]);
    else lines.push(`${name} = ${one(value)}`);
  }
  for (const [name, value] of tables) {
    lines.push("", `[${name}]`);
    for (const [key, inner] of Object.entries(value)) lines.push(`${key} = ${one(inner)}`);
  }
  return `${lines.join("\n")}\n`;
}

export function toCurl(study) {
  const text = JSON.stringify(study).replaceAll("'", "'\\''");
  return `curl -H 'Content-Type: application/json' -d '${text}' '${address(`/processes/${study.kind}/execution`)}'\n`;
}

export function toPython(study) {
  const { kind, parameters, ...rest } = study;
  const one = (value) => {
    if (value === true) return "True";
    if (value === false) return "False";
    if (value === null) return "None";
    if (Array.isArray(value)) return `[${value.map(one).join(", ")}]`;
    if (typeof value === "object") {
      return `{${Object.entries(value).map(([name, inner]) => `${JSON.stringify(name)}: ${one(inner)}`).join(", ")}}`;
    }
    return JSON.stringify(value);
  };
  const given = Object.entries({ ...rest, ...parameters });
  const lines = given.map(([name, value]) => `    ${name}=${one(value)},`);
  return `import vibrafeed\n\ndataset = vibrafeed.${kind}(\n${lines.join("\n")}\n)\n`;
}

const FORMS = {
  nc: ["NetCDF", "application/x-netcdf"],
  csv: ["CSV", "text/csv"],
  xlsx: ["XLSX", "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"],
};

export class Away {
  constructor(host, { study, picture, tell }) {
    this.of = { study, picture, tell };
    this.said = element("p", { role: "status" });
    this.text = element("pre", { hidden: true, tabindex: "0" });
    const button = (title, onclick) => element("button", { type: "button", onclick }, title);
    fill(
      host,
      element("h2", {}, "Take away"),
      element(
        "div",
        { class: "buttons" },
        ...Object.entries(FORMS).map(([suffix, [title]]) => button(title, () => this.numbers(suffix))),
        button("SVG", () => this.svg()),
        button("PNG", () => this.png()),
        button("Study (TOML)", () => this.show("study.toml", toToml(study()))),
        button("curl", () => this.show("study.sh", toCurl(study()))),
        button("Python", () => this.show("study.py", toPython(study()))),
        button("Link", () => this.link()),
      ),
      this.said,
      this.text,
    );
  }

  async link() {
    this.show(null, location.href);
    try {
      await navigator.clipboard.writeText(location.href);
      this.said.textContent = "The link is copied.";
    } catch {
      this.said.textContent = "This link shows the same again:";
    }
  }

  show(name, text) {
    this.text.hidden = false;
    this.text.textContent = text;
    this.said.textContent = "";
    if (name) save(new Blob([text], { type: "text/plain" }), name);
  }

  async numbers(suffix) {
    this.said.textContent = "The file is being made ...";
    const [, type] = FORMS[suffix];
    try {
      const study = this.of.study();
      const { content } = await put(`/processes/${study.kind}/execution`, study, {
        headers: { Prefer: "respond-async" },
      });
      const job = await follow(content, (now) => {
        this.of.tell(now);
        this.said.textContent = `${now.message} ${now.progress} %`;
      });
      save(await file(`/jobs/${job.jobID}/results/dataset`, type), `vibrafeed.${suffix}`);
      this.said.textContent = `vibrafeed.${suffix} is saved.`;
    } catch (error) {
      this.said.textContent = error.message;
    }
  }

  async svgText() {
    const style = [...document.styleSheets]
      .filter((sheet) => sheet.href?.endsWith("page.css"))
      .flatMap((sheet) => [...sheet.cssRules].map((rule) => rule.cssText))
      .join("\n");
    return this.of.picture().svgText?.(style);
  }

  async svg() {
    const text = await this.svgText();
    if (text) save(new Blob([text], { type: "image/svg+xml" }), "vibrafeed.svg");
    else this.said.textContent = "Lines are saved as PNG.";
  }

  async png() {
    const picture = this.of.picture();
    if (picture.image) {
      picture.image().toBlob((blob) => save(blob, "vibrafeed.png"));
      return;
    }
    const image = new Image();
    const url = URL.createObjectURL(new Blob([await this.svgText()], { type: "image/svg+xml" }));
    image.onload = () => {
      const canvas = element("canvas", { width: 2 * image.width, height: 2 * image.height });
      canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
      canvas.toBlob((blob) => save(blob, "vibrafeed.png"));
      URL.revokeObjectURL(url);
    };
    image.src = url;
  }
}
