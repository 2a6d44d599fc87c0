// Numbers, units and names as a person reads them.

const UNITS = {
  1: [1, ""],
  share: [100, "%"],
  m: [1e3, "mm"],
  "m s-1": [1e3, "mm/s"],
  "m s-2": [1, "m/s²"],
  "m s-3": [1, "m/s³"],
  degree: [1, "°"],
  kg: [1e3, "g"],
  s: [1, "s"],
  "rad s-1": [1, "rad/s"],
  "rad s-2": [1, "rad/s²"],
  "min-1": [1, "parts/min"],
  "W kg-1": [1, "W/kg"],
  "J kg-1 m-1": [1, "J/(kg m)"],
  "J m-1": [1, "J/m"],
  "N m-1": [1e-3, "N/mm"],
  "N s m-1": [1, "N s/m"],
  "kg m2": [1, "kg m²"],
  m2: [1e4, "cm²"],
  Pa: [1e-6, "MPa"],
};

// The factor to the unit that is shown, and that unit.
export function shown(unit) {
  return UNITS[unit] ?? [1, unit];
}

// `size` is what is large beside it: what is nothing but rounding is told as 0.
export function number(value, digits = 4, size = 0) {
  if (value === null || !Number.isFinite(value)) return "no value";
  if (Math.abs(value) < 1e-9 * Math.abs(size)) return "0";
  const text = Number(value.toPrecision(digits)).toString();
  return text.replace("-", "\u2212");
}

export function withUnit(value, unit, digits = 4) {
  const [factor, name] = shown(unit);
  const gap = name === "" || name === "°" ? "" : "\u00a0";
  return value === null || !Number.isFinite(value)
    ? "no value"
    : number(value * factor, digits) + gap + name;
}

const LABELS = new Map();
// What a shop calls them.
const NAMES = { beta: "Angle of vibration", gamma: "Climb of the track", friction: "Friction", load_mass: "Load", ring_down_frequency: "Springs tuned to", arrival_rate: "Arriving", wiper_height_1: "Wiper" };
const SHARES = /share|_fraction$|^yield|^purity|^efficiency$/; // told in per cent

// Note what the service calls its quantities. A drive unit weighs kilograms, a part grams.
export function learn(scene) {
  UNITS.kg = /drive-unit$/.test(scene.name) ? [1, "kg"] : [1e3, "g"];
  for (const output of scene.outputs) if (output.unit === "1" && SHARES.test(output.name)) output.unit = "share";
  for (const { name, label: text } of [...scene.parameters, ...scene.outputs]) {
    if (text) LABELS.set(name, NAMES[name] ?? text);
  }
}

export function words(name) {
  return LABELS.get(name)?.toLowerCase() ?? name.replaceAll("_", " ");
}

export function capital(text) {
  return text.slice(0, 1).toUpperCase() + text.slice(1);
}

export function label(name, unit) {
  const [, shownUnit] = shown(unit);
  return capital(words(name)) + (shownUnit ? ` (${shownUnit})` : "");
}

export function duration(seconds) {
  if (seconds >= 7200) return `${number(seconds / 3600, 2)} hours`;
  if (seconds >= 120) return `${number(seconds / 60, 2)} minutes`;
  return `${number(seconds, 2)} s`;
}

// The fixed values of a view in one line, and the version of it that was chosen.
export function valuesTold({ values, choice }, { parameters }) {
  const fixed = parameters
    .filter(({ name }) => name in values)
    .map(({ name, unit }) => `${words(name)} ${withUnit(values[name], unit)}`);
  return capital([...fixed, ...(choice ? [words(choice)] : [])].join(", "));
}

const SPOKEN = { "m s-1": "m/s", "m s-2": "m/s²", "m s-3": "m/s³", "rad s-1": "rad/s", "rad s-2": "rad/s²", degree: "°", "N m-1": "N/m", "N s m-1": "N s/m", "kg m2": "kg m²", m2: "m²" };

// What the service says of a study, in the names and units of this page.
export function sentence({ message, fix }) {
  const plain = `${message}. ${fix}.`
    .replace("..", ".")
    .replace(/(-?[\d.]+(?:e[-+]?\d+)?) (m s-[123]|rad s-[12]|degree)(?![\w-])/g, (_, value, unit) =>
      unit === "degree" ? `${value}°` : `${value} ${SPOKEN[unit]}`,
    );
  const [name] = plain.match(/^\w+(?= is )/) ?? [];
  return capital(LABELS.has(name) ? words(name) + plain.slice(name.length) : plain);
}
