// What matters most for the speed of the design: shares of its variance, as the service computes them (Sobol's
// first-order indices), as bars.

import { recordedDrive } from "./computed.js";
import { element, fill } from "./elements.js";
import { carryOut } from "./service.js";
import { givenValues } from "./view.js";
import { capital, number, words } from "./words.js";

const SAMPLES = 512;
const MOST = 4; // bars
const LEAST_SHARE = 0.005;
// What is usually known of a drive: a share of it, or so much of an angle.
const SHARES = { frequency: 0.01, amplitude: 0.05, peak_to_peak: 0.05 };
const DEGREES = { beta: 1, gamma: 0.5, alpha: 1 };

// The study of what matters: the band of the view, and what drives are usually known to. Null without a speed.
export function mattersStudy(view, scene) {
  const isSpeed = view.kind === "simulate" && scene.outputs.some(({ name }) => name === "conveying_velocity");
  if (view.question !== "uncertain" || !isSpeed) return null;
  const fixed = givenValues(view);
  const uncertain = {};
  for (const [name, value] of Object.entries(view.values)) {
    const half = view.band?.name === name ? view.band.share * Math.abs(value) : (DEGREES[name] ?? (SHARES[name] ?? 0) * Math.abs(value));
    if (!(half > 0)) continue;
    uncertain[name] = { lower: value - half, upper: value + half };
    delete fixed[name];
  }
  return {
    kind: "sensitivity",
    scene: view.scene,
    ...recordedDrive(view),
    ...(view.choice ? { method: view.choice } : {}),
    outputs: ["conveying_velocity"],
    parameters: fixed,
    uncertain,
    analyses: ["sobol"],
    samples: SAMPLES,
  };
}

// The parameters that matter, {name, share}, most first.
export async function mattersOf(view, scene, { signal, tell }) {
  const { dataset } = await carryOut("sensitivity", mattersStudy(view, scene), { signal, tell });
  const names = Object.keys(dataset.coordinates.uncertain.flags);
  const shares = dataset.variables.conveying_velocity_first.data;
  return names
    .map((name, i) => ({ name, share: shares[i] }))
    .filter(({ share }) => share > LEAST_SHARE)
    .sort((one, other) => other.share - one.share)
    .slice(0, MOST);
}

export function tellMatters(host, view, { status, value, reason, isLate }) {
  host.classList.toggle("stale", isLate);
  const own = view.band ? `${words(view.band.name)} within ${number(100 * view.band.share, 3)} %` : "nothing else";
  const told = {
    computing: "Computing what matters most.",
    failed: `Which parameters matter most cannot be computed here. ${reason}`,
  }[value ? "ready" : status] ?? (value?.length ? `With ${own}, amplitude within 5 %, frequency 1 %, angle 1°, climb 0.5°:` : "None of the uncertain parameters matters here.");
  fill(
    host,
    element("h3", {}, "What matters most?"),
    element("p", { class: "pale" }, told),
    element(
      "ul",
      { class: "matters", "aria-label": "What matters most" },
      ...(value ?? []).map(({ name, share }) => {
        const bar = element("span", { class: "share" });
        bar.style.setProperty("--share", `${100 * Math.min(1, share)}%`);
        return element("li", {}, element("span", {}, `${capital(words(name))} ${number(100 * share, 2)} %`), bar);
      }),
    ),
  );
}
