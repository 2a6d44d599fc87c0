// Error against run time of what is shown, as the service measures it: its pictures, one by one.

import { element, fill } from "./elements.js";
import { file, follow, get, put } from "./service.js";

export class Accuracy {
  constructor(host, { study, tell }) {
    this.said = element("p", { role: "status" });
    this.pictures = element("div", {});
    fill(
      host,
      element("h2", {}, "How accurate is it, and what does it cost?"),
      element(
        "button",
        { type: "button", onclick: () => this.measure(study(), tell) },
        "Measure accuracy and run time",
      ),
      this.said,
      this.pictures,
    );
  }

  async measure(study, tell) {
    fill(this.pictures);
    try {
      const path = "/processes/accuracy/execution";
      const headers = { Prefer: "respond-async" };
      const { content } = await put(path, study, { headers });
      const job = await follow(content, (now) => {
        tell(now);
        this.said.textContent = `${now.message} ${now.progress} %`;
      });
      const { files } = await get(`/jobs/${job.jobID}/results`);
      for (const one of files.filter(({ title }) => title.endsWith(".png"))) {
        const blob = await file(`/jobs/${job.jobID}/results/files/${encodeURIComponent(one.title)}`);
        const words = one.title.replace(".png", "").replaceAll("-", " ");
        this.pictures.append(
          element(
            "figure",
            {},
            element("img", { src: URL.createObjectURL(blob), alt: `Error against run time: ${words}` }),
            element("figcaption", {}, words),
          ),
        );
      }
      this.said.textContent =
        "Each mark is a setting: further left is faster, further down is more accurate.";
    } catch (error) {
      this.said.textContent = error.message;
    }
  }
}
