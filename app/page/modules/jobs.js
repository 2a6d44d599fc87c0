// The jobs of this page: how they stand, to be cancelled and their results taken. They end with the page.

import { element, fill } from "./elements.js";
import { abandon, file, remove } from "./service.js";
import { save } from "./saving.js";
import { duration } from "./words.js";

const MOST = 20;
const ACTIVE = new Set(["accepted", "running"]);
const PROCESSES = { simulate: "Motion", sweep: "Closed forms", optimise: "Best drive", calibrate: "Calibration", sensitivity: "What matters" };

export class Jobs {
  // `onshow(link)` hears that the view of a job is to be opened.
  constructor(host, onshow) {
    this.host = host;
    this.onshow = onshow;
    this.jobs = new Map();
    addEventListener("pagehide", () => {
      for (const { jobID, status } of this.jobs.values()) if (ACTIVE.has(status)) abandon(jobID);
    });
  }

  // Note how a job stands now, and for which view {title, told, link} it was begun.
  note(job, view = null) {
    const { jobID, processID, status, message, progress, secondsLeft } = job;
    const { of = view, begun = Date.now() } = this.jobs.get(jobID) ?? {}; // the first view that asked
    this.jobs.delete(jobID);
    this.jobs.set(jobID, { jobID, processID, status, message, progress, secondsLeft, of, begun });
    while (this.jobs.size > MOST) this.jobs.delete(this.jobs.keys().next().value);
    this.draw();
  }

  draw() {
    this.host.hidden = this.jobs.size === 0;
    fill(this.host, element("h3", {}, "Jobs of this page"), element("ul", { class: "jobs" }, ...[...this.jobs.values()].reverse().map((job) => this.line(job))));
  }

  line(job) {
    const isActive = ACTIVE.has(job.status);
    const left = job.secondsLeft ? `, ${duration(job.secondsLeft)} left` : "";
    const at = new Date(job.begun).toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
    const name = `${PROCESSES[job.processID] ?? job.processID}${job.of ? `: ${job.of.title}` : ""}, ${at}.`;
    const button = (text, onclick) => element("button", { type: "button", onclick }, text);
    return element(
      "li",
      {},
      element("span", {}, element("b", { title: job.of?.told }, name), ` ${job.message}${isActive ? ` ${job.progress} %${left}` : ""}`),
      isActive ? button("Cancel", () => this.cancel(job)) : null,
      job.of?.link ? button("Show", () => this.onshow(job.of.link)) : null,
      job.status === "successful" ? button("NetCDF", () => this.take(job)) : null,
    );
  }

  async cancel(job) {
    try {
      await remove(`/jobs/${job.jobID}`);
      this.note({ ...job, status: "dismissed", message: "The job was cancelled." });
    } catch (error) {
      this.note({ ...job, message: error.message });
    }
  }

  async take(job) {
    try {
      save(await file(`/jobs/${job.jobID}/results/dataset`, "application/x-netcdf"), "vibrafeed.nc");
    } catch (error) {
      this.note({ ...job, status: "failed", message: error.message });
    }
  }
}
