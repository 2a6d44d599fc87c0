// What can be taken away: the numbers, the picture, the study, a link.

import { element, fill } from "./elements.js";
import { file, follow, key, put, text } from "./service.js";
import { save } from "./saving.js";

// Files of numbers, and texts of a study as the service writes them.
const FORMS = {
  nc: ["NetCDF", "application/x-netcdf"],
  csv: ["CSV", "text/csv"],
  xlsx: ["XLSX", "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"],
};

const TEXTS = {
  toml: ["Study (TOML)", "study.toml"],
  curl: ["curl", "study.sh"],
  python: ["Python", "study.py"],
};

// A service with keys wants one; a file that is passed on holds none.
export function withKey(command) {
  return command.replace(/^curl /, 'curl -H "Authorization: Bearer $VIBRAFEED_KEY" ');
}

export class Away {
  // `study()` is that of the picture, `best()` that of the best; `picture(what)` what is drawn of it,
  // `told()` its title, values and link.
  constructor(host, { study, best, picture, told, tell }) {
    this.of = { picture, best, values: study, told, tell };
    this.what = element(
      "select",
      { id: "away-what" },
      element("option", { value: "values" }, "The picture"),
      element("option", { value: "best" }, "The best"),
    );
    this.choice = element(
      "div",
      { class: "field", hidden: true },
      element("label", { for: "away-what" }, "Of"),
      this.what,
    );
    this.said = element("p", { role: "status" });
    this.text = element("pre", { hidden: true, tabindex: "0" });
    const button = (title, onclick) => element("button", { type: "button", onclick }, title);
    fill(
      host,
      element("h2", {}, "Take away"),
      this.choice,
      element(
        "div",
        { class: "buttons" },
        ...Object.entries(FORMS).map(([suffix, [title]]) => button(title, () => this.numbers(suffix))),
        button("SVG", () => this.svg()),
        button("PNG", () => this.png()),
        ...Object.entries(TEXTS).map(([form, [title, name]]) => button(title, () => this.study(form, name))),
        button("Link", () => this.link()),
      ),
      this.said,
      this.text,
    );
  }

  // Whether there is a best that can be taken away, too.
  offer(hasBest) {
    this.choice.hidden = !hasBest;
    this.what.value = "values";
  }

  picture() {
    return this.of.picture(this.what.value);
  }

  chosen() {
    return this.of[this.what.value]();
  }

  async study(form, name) {
    try {
      const written = await text(`/convert?to=${form}`, this.chosen());
      this.show(name, form === "curl" && key.get() ? withKey(written) : written);
      if (form === "curl" && key.get()) this.said.textContent = "Set VIBRAFEED_KEY to your key before you run the command.";
    } catch (error) {
      this.said.textContent = [error.message, ...(error.errors ?? []).map((one) => one.message)].join(" ");
    }
  }

  async link() {
    this.show(null, location.href);
    try {
      await navigator.clipboard.writeText(location.href);
      this.said.textContent = "The link is copied.";
    } catch {
      this.said.textContent = "This link opens the page with the same settings:";
    }
  }

  show(name, text) {
    this.text.hidden = false;
    this.text.textContent = text;
    this.said.textContent = "";
    if (name) save(new Blob([text], { type: "text/plain" }), name);
  }

  async numbers(suffix) {
    this.said.textContent = "The service is making the file ...";
    const [, type] = FORMS[suffix];
    try {
      const study = this.chosen();
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

  svgText() {
    const style = [...document.styleSheets]
      .filter((sheet) => sheet.href?.endsWith("page.css"))
      .flatMap((sheet) => [...sheet.cssRules].map((rule) => rule.cssText))
      .join("\n");
    return this.picture().svgText(style, this.of.told());
  }

  svg() {
    save(new Blob([this.svgText()], { type: "image/svg+xml" }), "vibrafeed.svg");
  }

  png() {
    const image = new Image();
    const url = URL.createObjectURL(new Blob([this.svgText()], { type: "image/svg+xml" }));
    image.onload = () => {
      const canvas = element("canvas", { width: 2 * image.width, height: 2 * image.height });
      canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
      canvas.toBlob((blob) => save(blob, "vibrafeed.png"));
      URL.revokeObjectURL(url);
    };
    image.src = url;
  }
}
