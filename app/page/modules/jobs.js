// The jobs of this browser's tab: how they stand, to be cancelled and their results taken.

import { element, fill } from "./elements.js";
import { Refusal, file, get, remove } from "./service.js";
import { save } from "./saving.js";
import { duration } from "./words.js";

const STORE = "vibrafeed-jobs";
const MOST = 20;
const ACTIVE = new Set(["accepted", "running"]);
const PROCESSES = {
  simulate: "Motion",
  sweep: "Closed forms",
  optimise: "Best drive",
  calibrate: "Calibration",
  sensitivity: "What matters",
  accuracy: "Error against run time",
};
const LOOK = 2000; // ms between two looks at jobs that were begun before this page was

export class Jobs {
  // `onshow(link)` hears that the view of a job is to be opened.
  constructor(host, onshow) {
    this.host = host;
    this.onshow = onshow;
    this.jobs = new Map();
    try {
      for (const job of JSON.parse(sessionStorage.getItem(STORE) ?? "[]")) {
        if (typeof job?.jobID === "string") this.jobs.set(job.jobID, job);
      }
    } catch {
      sessionStorage.removeItem(STORE);
    }
    this.draw();
    this.lookAfter([...this.jobs.values()].filter(({ status }) => ACTIVE.has(status)));
  }

  // Ask how jobs stand that nothing on this page follows, until they are over.
  async lookAfter(left) {
    while (left.length) {
      for (const { jobID } of left) {
        try {
          this.note(await get(`/jobs/${jobID}`));
        } catch (error) {
          if (!(error instanceof Refusal)) continue; // the service is away
          const job = this.jobs.get(jobID);
          if (error.status === 404) this.note({ ...job, status: "dismissed", message: "The service has removed the job." });
        }
      }
      left = left.filter(({ jobID }) => ACTIVE.has(this.jobs.get(jobID)?.status));
      await new Promise((done) => setTimeout(done, LOOK));
    }
  }

  // Note how a job stands now, and for which view {title, told, link} it was begun.
  note(job, view = null) {
    const { jobID, processID, status, message, progress, secondsLeft } = job;
    const { of = view, begun = Date.now() } = this.jobs.get(jobID) ?? {}; // the first view that asked
    this.jobs.delete(jobID);
    if (status === "successful") this.forget({ processID, of });
    this.jobs.set(jobID, { jobID, processID, status, message, progress, secondsLeft, of, begun });
    while (this.jobs.size > MOST) this.jobs.delete(this.jobs.keys().next().value);
    sessionStorage.setItem(STORE, JSON.stringify([...this.jobs.values()]));
    this.draw();
  }

  // Results of the same view that another of its jobs has more of now.
  forget({ processID, of }) {
    for (const [jobID, one] of this.jobs) {
      const isSame = of && one.processID === processID && one.of?.link === of.link;
      if (isSame && one.status === "successful") this.jobs.delete(jobID);
    }
  }

  draw() {
    this.host.hidden = this.jobs.size === 0;
    fill(
      this.host,
      element("h2", {}, "Jobs of this tab"),
      element("ul", { class: "jobs" }, ...[...this.jobs.values()].reverse().map((job) => this.line(job))),
    );
  }

  line(job) {
    const left = job.secondsLeft ? `, ${duration(job.secondsLeft)} left` : "";
    const told = ACTIVE.has(job.status) ? `${job.message} ${job.progress} %${left}` : job.message;
    return element(
      "li",
      {},
      element("span", {}, ...this.name(job), ` ${told}`),
      " ",
      ACTIVE.has(job.status)
        ? element("button", { type: "button", onclick: () => this.cancel(job) }, "Cancel")
        : null,
      job.of?.link ? element("button", { type: "button", onclick: () => this.onshow(job.of.link) }, "Show") : null,
      job.status === "successful"
        ? element("button", { type: "button", onclick: () => this.take(job) }, "NetCDF")
        : null,
    );
  }

  // What it computes, and since when.
  name({ processID, of, begun }) {
    const at = begun ? `, ${new Date(begun).toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" })}` : "";
    const text = PROCESSES[processID] ?? processID;
    if (!of) return [`${text}${at}:`];
    return [element("strong", { title: of.told }, `${text}: ${of.title}`), `${at}.`];
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
