// Take away: the sheet, the numbers, the picture, the study, a link, in one menu.

import { element, fill } from "./elements.js";
import { file, follow, key, put, text } from "./service.js";
import { save } from "./saving.js";

// Files of numbers, and texts of a study as the service writes them.
const FORMS = {
  xlsx: ["Table (XLSX)", "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"],
  csv: ["Table (CSV)", "text/csv"],
  nc: ["NetCDF", "application/x-netcdf"],
};
const TEXTS = {
  toml: ["Study (TOML)", "study.toml"],
  curl: ["Code for curl", "study.sh"],
  python: ["Code in Python", "study.py"],
};

// A service with keys wants one; a file that is passed on holds none.
function withKey(command) {
  return command.replace(/^curl /, 'curl -H "Authorization: Bearer $VIBRAFEED_KEY" ');
}

export class Away {
  // `study(what)` is that of the picture or of the best, `picture()` what is drawn of it, `told()` its title, values
  // and link, `hasBest()` whether there is a best.
  constructor(host, { study, picture, told, tell, hasBest }) {
    this.study = study;
    this.picture = picture;
    this.told = told;
    this.tell = tell;
    this.hasBest = hasBest;
    this.said = element("p", { role: "status", id: "away-told" });
    this.text = element("pre", { hidden: true, tabindex: "0" });
    this.toggle = element("button", { type: "button", id: "take-away", "aria-haspopup": "menu", "aria-expanded": "false", "aria-controls": "away-menu", onclick: () => this.open(this.menu.hidden) }, element("span", {}, "Take away"));
    this.menu = element("div", { role: "menu", id: "away-menu", hidden: true, "aria-label": "Take away", onkeydown: (event) => this.press(event) });
    this.dialog = element("div", { class: "away-told", hidden: true }, element("button", { type: "button", class: "remove", "aria-label": "Close", onclick: () => (this.dialog.hidden = true) }, "×"), this.said, this.text);
    fill(host, this.toggle, this.menu, this.dialog);
    document.addEventListener("pointerdown", (event) => {
      if (!this.menu.hidden && event.target instanceof Node && !host.contains(event.target)) this.open(false);
    });
  }

  open(isOpen) {
    if (isOpen) this.list();
    if (isOpen) this.dialog.hidden = true;
    this.menu.hidden = !isOpen;
    this.toggle.setAttribute("aria-expanded", String(isOpen));
    if (isOpen) this.menu.querySelector("button").focus();
  }

  list() {
    const item = (title, onclick) => element("button", { type: "button", role: "menuitem", tabindex: "-1", onclick: () => this.choose(onclick) }, title);
    const best = this.hasBest();
    fill(
      this.menu,
      item("Print a sheet", () => this.print()),
      item("Link", () => this.link()),
      item("Picture (SVG)", () => this.svg()),
      item("Picture (PNG)", () => this.png()),
      ...Object.entries(FORMS).map(([suffix, [title]]) => item(title, () => this.numbers(suffix, "values"))),
      ...Object.entries(TEXTS).map(([form, [title, name]]) => item(title, () => this.written(form, name, "values"))),
      ...(best ? [item("Study of the best (TOML)", () => this.written("toml", "study.toml", "best")), item("Best as a table (CSV)", () => this.numbers("csv", "best"))] : []),
    );
  }

  choose(onclick) {
    this.open(false);
    this.toggle.focus();
    onclick();
  }

  press(event) {
    const items = [...this.menu.querySelectorAll("button")];
    const at = items.indexOf(/** @type {any} */ (document.activeElement));
    const to = { ArrowDown: at + 1, ArrowUp: at - 1 + items.length, Home: 0, End: items.length - 1 }[event.key];
    if (event.key === "Escape" || event.key === "Tab") {
      this.open(false);
      if (event.key === "Escape") this.toggle.focus();
      return;
    }
    if (to === undefined) return;
    event.preventDefault();
    items[to % items.length].focus();
  }

  print() {
    window.print();
  }

  say(told, content = null) {
    this.dialog.hidden = !told && !content;
    this.said.textContent = told;
    this.text.hidden = content === null;
    this.text.textContent = content ?? "";
  }

  async written(form, name, what) {
    try {
      const found = await text(`/convert?to=${form}`, this.study(what));
      const isKeyed = form === "curl" && key.get();
      const content = isKeyed ? withKey(found) : found;
      this.say(isKeyed ? "Set VIBRAFEED_KEY to your key before you run the command." : `${name} is saved.`, content);
      save(new Blob([content], { type: "text/plain" }), name);
    } catch (error) {
      this.say([error.message, ...(error.errors ?? []).map((one) => one.message)].join(" "));
    }
  }

  async link() {
    try {
      await navigator.clipboard.writeText(location.href);
      this.say("The link is copied.", location.href);
    } catch {
      this.say("This link opens the page with the same settings:", location.href);
    }
  }

  async numbers(suffix, what) {
    this.say("The service is making the file ...");
    try {
      const study = this.study(what);
      const { content } = await put(`/processes/${study.kind}/execution`, study, { headers: { Prefer: "respond-async" } });
      const job = await follow(content, (now) => {
        this.tell(now);
        this.say(`${now.message} ${now.progress} %`);
      });
      save(await file(`/jobs/${job.jobID}/results/dataset`, FORMS[suffix][1]), `vibrafeed.${suffix}`);
      this.say(`vibrafeed.${suffix} is saved.`);
    } catch (error) {
      this.say(error.message);
    }
  }

  svgText() {
    const style = [...document.styleSheets]
      .filter((sheet) => /page(-[0-9a-z]+)?\.css$/i.test(sheet.href ?? ""))
      .flatMap((sheet) => [...sheet.cssRules].map((rule) => rule.cssText))
      .join("\n");
    return this.picture().svgText(style, this.told());
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
