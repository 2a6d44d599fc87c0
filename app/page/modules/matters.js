// What matters most for the speed at the chosen point: shares of its variance, as the service computes
// them (Sobol's first-order indices), as bars.

import { recordedDrive, valuesAt } from "./computed.js";
import { element, fill } from "./elements.js";
import { Refusal, carryOut, left } from "./service.js";
import { capital, number, words } from "./words.js";

const SAMPLES = 512;
const MOST = 4; // bars
const LEAST_SHARE = 0.005;
// What is usually known of a drive: a share of it, or so much of an angle.
const SHARES = { frequency: 0.01, amplitude: 0.05, peak_to_peak: 0.05 };
const DEGREES = { beta: 1, gamma: 0.5, alpha: 1 };

export class Matters {
  constructor(host) {
    this.host = host;
    this.said = element("p", { class: "matters-said" });
    this.bars = element("ul", { class: "matters", "aria-label": "What matters most" });
  }

  show() {
    this.for = null;
    fill(this.host, this.said, this.bars);
    fill(this.bars);
    this.said.textContent = "Computing which parameters matter most ...";
  }

  // The ranges of what is uncertain: the band of the view, and what drives are usually known to.
  uncertain(view) {
    const values = valuesAt(view, view.point);
    const found = {};
    for (const [name, value] of Object.entries(values)) {
      const half = view.band?.name === name ? view.band.share * Math.abs(value) : (DEGREES[name] ?? (SHARES[name] ?? 0) * Math.abs(value));
      if (half > 0) found[name] = { lower: value - half, upper: value + half };
    }
    return { found, values };
  }

  async follow(view) {
    const { found, values } = this.uncertain(view);
    const fixed = Object.fromEntries(Object.entries(values).filter(([name]) => !(name in found)));
    const study = {
      kind: "sensitivity",
      scene: view.scene,
      ...recordedDrive(view),
      ...(view.choice ? { method: view.choice } : {}),
      outputs: ["conveying_velocity"],
      parameters: fixed,
      uncertain: found,
      analyses: ["sobol"],
      samples: SAMPLES,
    };
    const text = JSON.stringify(study);
    if (this.for === text) return;
    this.for = text;
    this.abort?.abort(left());
    this.abort = new AbortController();
    try {
      const { dataset } = await carryOut("sensitivity", study, { signal: this.abort.signal });
      if (this.for === text) this.tell(dataset, view);
    } catch (error) {
      if (error.name === "AbortError" || this.for !== text) return;
      if (!(error instanceof Refusal)) throw error;
      this.said.textContent = `Which parameters matter most cannot be computed here: ${error.errors[0]?.message ?? error.message}.`;
    }
  }

  tell({ coordinates, variables }, view) {
    const names = Object.keys(coordinates.uncertain.flags);
    const shares = variables.conveying_velocity_first.data;
    const rows = names
      .map((name, i) => ({ name, share: shares[i] }))
      .filter(({ share }) => share > LEAST_SHARE)
      .sort((one, other) => other.share - one.share)
      .slice(0, MOST);
    const own = view.band ? `${words(view.band.name)} within ${number(100 * view.band.share, 3)} %` : "nothing else";
    this.said.textContent = rows.length
      ? `What matters most, with ${own}, amplitude within 5 %, frequency 1 %, elevation 1°, climb 0.5°:`
      : "None of the uncertain parameters matters here.";
    fill(
      this.bars,
      ...rows.map(({ name, share }) => {
        const bar = element("span", { class: "share" });
        bar.style.width = `${100 * Math.min(1, share)}%`;
        return element("li", {}, element("span", {}, `${capital(words(name))} ${number(100 * share, 2)} %`), element("span", {}, bar));
      }),
    );
  }
}
