// The answer to each question in a number, a unit and a sentence, of what the service computed of the design.

import { flagOf, valueOf } from "./computed.js";
import { gathersTold } from "./plate.js";
import { capital, number, shown, withUnit, words } from "./words.js";

export const HOP = 1e-9; // m: what is lower is rounding
const RADIANS = Math.PI / 180;

// At which value of a parameter of the drive the part lifts off, from the throw number: null where it does not
// depend on it, or is not there.
export function liftOff(name, values, throwNumber) {
  if (!(throwNumber > 0)) return null;
  const value = values[name];
  if (["amplitude", "peak_to_peak", "vertical_amplitude", "vertical_peak_to_peak"].includes(name)) return value / throwNumber;
  if (name === "frequency") return value / Math.sqrt(throwNumber);
  if (name !== "beta" || "vertical_amplitude" in values) return null;
  const sine = Math.sin(value * RADIANS) / throwNumber;
  return sine < 1 ? Math.asin(sine) / RADIANS : null;
}

const DOES = {
  stick: "friction holds it",
  slip: "slides",
  stick_slip: "slides, and sticks in between",
  hopping: "hops",
  hop_after_hop: "hops without touching the floor in between",
};

// A number and its unit, as the answer has them.
export function told(value, unit, digits = 3) {
  const [factor, name] = shown(unit);
  return { number: value === null || !Number.isFinite(value) ? "–" : number(value * factor, digits), unit: name };
}

function ends(low, high, unit, digits = 2) {
  const [factor, name] = shown(unit);
  const [one, other] = [low, high].map((value) => number(value * factor, digits, Math.max(Math.abs(low), Math.abs(high)) * factor));
  return one === other ? `${one} ${name}`.trim() : `${one} to ${other} ${name}`.trim();
}

// The sentence of a band: "for friction 0.2 to 0.4", after its range.
function bandTold({ name, low, high, from, to }, unit) {
  return `for ${words(name)} ${ends(from, to, unit)}${low < 0 && high > 0 ? "; it may run backwards" : ""}`;
}

function hopTold({ dataset, scene }) {
  const hop = valueOf(dataset, "hop_height");
  const regime = flagOf(dataset);
  if (hop > HOP) return `hops ${withUnit(hop, "m", 2)}`;
  return DOES[regime] ?? scene.regimes.find(({ name }) => name === regime)?.description ?? words(regime);
}

function speed({ view, scene, dataset, band, sine, unitOf }) {
  const value = valueOf(dataset, view.output);
  const unit = unitOf(view.output);
  const axes = view.question === "drive" ? [view.x, view.y, ...view.best.vary].filter(Boolean) : [];
  const parts = axes.length ? [axes.map(({ name }) => `${words(name)} ${withUnit(view.values[name], unitOf(name), 3)}`).join(", ")] : [];
  if (band) parts.push(`${ends(band.low, band.high, unit)} ${bandTold(band, unitOf(band.name))}`);
  if (sine) parts.push(`${number(value / sine, 2)} times the speed with a sine of the same amplitudes`);
  parts.push(hopTold({ dataset, scene }));
  return { ...told(value, unit), sentence: parts.join("; "), strip: band && { ...band, value, unit } };
}

function hop({ view, dataset, scene }) {
  const height = valueOf(dataset, "hop_height");
  const air = valueOf(dataset, "flight_fraction");
  const throwNumber = valueOf(dataset, "throw_number");
  const name = ["amplitude", "peak_to_peak"].find((one) => one in view.values);
  const level = name ? liftOff(name, view.values, throwNumber) : null;
  const parts = [height > HOP ? `in the air for ${number(100 * (air ?? 0), 2)} % of a cycle` : "does not hop"];
  if (level !== null) parts.push(`lifts off above ${withUnit(level, "m", 2)} of ${words(name)}`);
  if (throwNumber !== null) parts.push(`throw number ${number(throwNumber, 3)}`);
  const isOther = view.output !== "hop_height";
  const unit = scene.outputs.find((one) => one.name === view.output)?.unit ?? "1";
  return { ...told(isOther ? valueOf(dataset, view.output) : height > HOP ? height : 0, unit), sentence: parts.join("; ") };
}

function uncertain(given) {
  const { view, dataset, band, unitOf, matters } = given;
  if (!band || view.output !== "conveying_velocity") return speed(given);
  const unit = unitOf(view.output);
  const [factor, name] = shown(unit);
  const range = ends(band.low, band.high, unit).replace(name, "").trim();
  const most = matters?.[0];
  const parts = [bandTold(band, unitOf(band.name))];
  if (most) parts.push(`the ${words(most.name)} matters most`);
  const value = valueOf(dataset, view.output);
  parts.push(`${number(value * factor, 3)} ${name} in the middle`);
  return { number: range, unit: name, sentence: parts.join("; "), strip: { ...band, value, unit } };
}

function springs(given) {
  const { dataset } = given;
  const { view, unitOf } = given;
  if (view.output !== "track_amplitude") return any(given);
  const natural = valueOf(dataset, "natural_frequency");
  const drive = view.values.frequency;
  const apart = natural / drive - 1;
  const side = apart > 0 ? "above the drive: tuned stiff" : "below the drive: tuned soft";
  const near = Math.abs(apart) < 0.005 ? "at the drive: at resonance" : `${number(100 * Math.abs(apart), 2)} % ${side}`;
  const sentence = Number.isFinite(natural) && natural > 0 ? `At ${withUnit(drive, "Hz", 3)}; the springs are tuned to ${withUnit(natural, "Hz", 3)}, ${near}` : `At ${withUnit(drive, "Hz", 3)}`;
  return { ...told(valueOf(dataset, view.output), unitOf(view.output)), sentence };
}

// `field` is a map with the velocity over the plate, or null.
function plate(given) {
  const { view, dataset, unitOf, band, field } = given;
  if (view.output !== "travel_speed") return any(given);
  const value = valueOf(dataset, view.output);
  const unit = unitOf(view.output);
  const direction = valueOf(dataset, "travel_direction");
  const made = told(value, unit);
  const parts = [band && `${ends(band.low, band.high, unit)} ${bandTold(band, unitOf(band.name))}`, field && gathersTold(field), hopTold(given), "0° is along x, 90° along y"];
  return { ...made, unit: Number.isFinite(direction) ? `${made.unit} to ${number(direction, 3)}°` : made.unit, sentence: parts.filter(Boolean).join("; "), strip: band && { ...band, value, unit } };
}

function rows(given) {
  const { view, dataset, unitOf } = given;
  const value = valueOf(dataset, view.output);
  const platoons = valueOf(dataset, "platoons");
  const size = valueOf(dataset, "platoon_size_1");
  const parts = [];
  if (platoons) parts.push(platoons === 1 ? "the parts travel as one platoon" : `${number(platoons)} platoons${size ? `, the rear one of ${number(size)} ${size === 1 ? "part" : "parts"}` : ""}`);
  parts.push(DOES[flagOf(dataset)] ?? words(flagOf(dataset)));
  return { ...told(value, unitOf(view.output)), sentence: parts.filter(Boolean).join("; ") };
}

// The aspects in which a part comes to rest, the most frequent first: {name, value, low, high}, of a part from a file
// with the `size` of the box that it fills.
/** @param {any} dataset @returns {any[]} */
export function aspectsOf(dataset) {
  const named = Object.keys(dataset?.variables ?? {}).filter((name) => name.startsWith("let_down_share_"));
  const numbered = [dataset?.coordinates?.aspect?.data ?? []].flat();
  const at = (name, i) => [valueOf(dataset, name)].flat()[i];
  const all = numbered.length
    ? numbered.map((name, i) => ({ name: String(name), both: [at("let_down_share", i), at("thrown_share", i)], size: ["length", "width", "height"].map((one) => at(`lying_${one}`, i)) }))
    : named.map((name) => ({ name: name.slice("let_down_share_".length), both: [name, name.replace("let_down", "thrown")].map((one) => valueOf(dataset, one)).filter(Number.isFinite) }));
  return all
    .map(({ both, ...one }) => ({ ...one, value: both[0], low: Math.min(...both), high: Math.max(...both) }))
    .filter(({ value }) => Number.isFinite(value))
    .sort((one, other) => other.value - one.value);
}

const LIES = { on_side: "lie on the side", on_end: "stand on end", upright: "stand upright", inverted: "stand upside down", flat: "lie flat" };

export function liesTold(name) {
  if (/^\d+$/.test(name)) return `lie in way ${name}`;
  return LIES[name] ?? `rest as ${name.replaceAll("_", " ")}`;
}

// The name of the aspect that is wanted.
export function wantedIn({ output, surface }) {
  return surface ? surface.wanted : output.replace(/^.*_share_/, "");
}

function resting(given) {
  const { view, dataset } = given;
  const aspects = aspectsOf(dataset);
  const wanted = aspects.find(({ name }) => name === wantedIn(view)) ?? (view.output.includes("_share_") ? aspects[0] : null);
  if (!wanted) return any(given);
  const percent = (value) => number(100 * value, 2);
  return {
    number: `${percent(wanted.value)} %`,
    unit: liesTold(wanted.name),
    sentence: percent(wanted.low) === percent(wanted.high) ? "Both estimates agree" : `${percent(wanted.low)} to ${percent(wanted.high)} % by two estimates`,
    more: "To be sure, tip out 200 parts and count them.",
    strip: { low: 100 * wanted.low, high: 100 * wanted.high, value: 100 * wanted.value, unit: "%", most: 100 },
  };
}

function orienting(given) {
  const { view, dataset, unitOf } = given;
  if (view.output !== "oriented_feed_rate") return any(given);
  const value = valueOf(dataset, view.output);
  const back = valueOf(dataset, "return_rate");
  const purity = valueOf(dataset, "purity");
  const both = ["lower", "upper"].map((end) => valueOf(dataset, `oriented_feed_rate_${end}`)).filter(Number.isFinite);
  const parts = [];
  if (both.length > 1) parts.push(`${ends(Math.min(...both), Math.max(...both), "1", 3)} a minute by two estimates`);
  if (Number.isFinite(back)) parts.push(`${number(back, 3)} a minute fall back`);
  if (Number.isFinite(purity)) parts.push(`${number(100 * purity, 3)} % of what leaves lies as wanted`);
  return { ...told(value, unitOf(view.output)), unit: "oriented parts a minute", sentence: parts.join("; "), strip: both.length > 1 && both[0] !== both[1] ? { low: Math.min(...both), high: Math.max(...both), value, unit: "1" } : null };
}

function any({ view, scene, dataset, unitOf }) {
  const regime = flagOf(dataset);
  const meaning = scene.regimes.find(({ name }) => name === regime);
  const told_ = `${capital(words(view.output))}${meaning && regime !== "not_assessed" ? `: ${meaning.description}` : ""}`;
  return { ...told(valueOf(dataset, view.output), unitOf(view.output), 4), sentence: told_ };
}

const BY_QUESTION = { speed, hop, drive: speed, uncertain, waves: speed, springs, rows, plate, resting, orienting };
const SPEEDS = new Set(["conveying_velocity", "drift_velocity"]);

/** The answer: {number, unit, sentence, more, strip}. @param {any} given {view, scene, dataset, band, matters} */
export function answerTo(given) {
  const { view, scene } = given;
  const unitOf = (name) => [...scene.outputs, ...scene.parameters].find((one) => one.name === name)?.unit ?? "1";
  const isOfQuestion = view.question === "hop" || !["speed", "drive", "uncertain", "waves", "rows", "measured"].includes(view.question) || SPEEDS.has(view.output);
  const answer = (isOfQuestion && BY_QUESTION[view.question]) || (view.question === "measured" && SPEEDS.has(view.output) ? speed : any);
  const found = answer({ ...given, unitOf });
  return { ...found, sentence: found.sentence ? `${capital(found.sentence)}.`.replace("..", ".") : "" };
}
