// Take away: the sheet, the numbers, the picture, the study, a link, in one menu.

import { byId, element } from "./elements.js";
import { file, follow, key, put, text } from "./service.js";

const TYPES = { xlsx: "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet", csv: "text/csv", nc: "application/x-netcdf" };
const NAMES = { toml: "study.toml", curl: "study.sh", python: "study.py" };

const KEPT = 10_000; // ms for which a file that is being saved stays in memory

function save(blob, name) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), KEPT);
}

// A service with keys wants one; a file that is passed on holds none.
function withKey(command) {
  return command.replace(/^curl /, 'curl -H "Authorization: Bearer $VIBRAFEED_KEY" ');
}

export class Away {
  // `study(what)` is that of the picture or of the best, `picture()` what is drawn of it, `told()` its title, values
  // and link.
  constructor({ study, picture, told }) {
    this.study = study;
    this.picture = picture;
    this.told = told;
    const menu = byId("away-menu");
    // Each entry names what is taken, in which form, and whether of what is shown or of the best.
    menu.addEventListener("click", ({ target }) => {
      const { take, form, of = "values" } = target.dataset;
      if (!take) return;
      menu.hidePopover();
      this[take](form, of);
    });
  }

  print() {
    window.print();
  }

  keep() {
    byId("keep").click();
  }

  say(told, content = null) {
    const [said, text] = byId("away-said").children;
    byId("away-said").showPopover();
    said.textContent = told;
    text.hidden = content === null;
    text.textContent = content ?? "";
  }

  async text(form, of) {
    try {
      const found = await text(`/convert?to=${form}`, this.study(of));
      const isKeyed = form === "curl" && key.get();
      const content = isKeyed ? withKey(found) : found;
      this.say(isKeyed ? "Set VIBRAFEED_KEY to your key before you run the command." : `${NAMES[form]} is saved.`, content);
      save(new Blob([content], { type: "text/plain" }), NAMES[form]);
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

  async numbers(form, of) {
    this.say("The service is making the file ...");
    try {
      const study = this.study(of);
      const { content } = await put(`/processes/${study.kind}/execution`, study, { headers: { Prefer: "respond-async" } });
      const job = await follow(content, ({ message, progress }) => this.say(`${message} ${progress} %`));
      save(await file(`/jobs/${job.jobID}/results/dataset`, TYPES[form]), `vibrafeed.${form}`);
      this.say(`vibrafeed.${form} is saved.`);
    } catch (error) {
      this.say(error.message);
    }
  }

  drawing() {
    const style = [...document.styleSheets]
      .filter((sheet) => /page(-[0-9a-z]+)?\.css$/i.test(sheet.href ?? ""))
      .flatMap((sheet) => [...sheet.cssRules].map((rule) => rule.cssText))
      .join("\n");
    return new Blob([this.picture().svgText(style, this.told())], { type: "image/svg+xml" });
  }

  svg() {
    save(this.drawing(), "vibrafeed.svg");
  }

  async png() {
    const image = element("img", { src: URL.createObjectURL(this.drawing()) });
    await image.decode();
    const canvas = element("canvas", { width: 2 * image.width, height: 2 * image.height });
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    canvas.toBlob((blob) => save(blob, "vibrafeed.png"));
    URL.revokeObjectURL(image.src);
  }
}
