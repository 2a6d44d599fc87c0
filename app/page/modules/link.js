// The link of a view. A link is somebody's text: nothing of it is believed before it is compared with what the service
// says there is.

import { CRITERIA, usualBest } from "./criterion.js";
import { QUESTIONS } from "./questions.js";
import { SETS } from "./sets.js";

const MAX_CHARACTERS = 4000;
const MAX_RUNS = 50;
export const MAX_PINS = 4;
const MAX_ROWS = 20; // of limits, of what is varied

const isNumber = (text) => Boolean(text) && Number.isFinite(Number(text));
const numbers = (texts) => (texts.every(isNumber) ? texts.map(Number) : undefined);

// Parts of a link, by their names: how each is written, and read; what makes no sense is read as undefined.
const word = { write: String, read: (text) => text };
const known = (names) => ({ write: String, read: (text) => (Object.hasOwn(names, text) ? text : undefined) });
const number = (least) => ({ write: String, read: (text) => (isNumber(text) && Number(text) >= least ? Number(text) : undefined) });
const flag = { write: (is) => (is ? "1" : "0"), read: (text) => text === "1" };
const axis = {
  write: (one) => (one ? `${one.name}:${one.from}:${one.to}` : ""),
  read: (text) => {
    const [name, ...ends] = text.split(":");
    const [from, to] = numbers(ends) ?? [];
    return from < to ? { name, from, to } : undefined;
  },
};
const band = {
  write: ({ name, share }) => `${name}:${share}`,
  read: (text) => {
    const [name, share] = text.split(":");
    return Number(share) > 0 && Number(share) < 1 ? { name, share: Number(share) } : undefined;
  },
};
const runs = {
  write: (all) => all.map((run) => run.join(":")).join(","),
  read: (text) => {
    const all = text.split(",").slice(0, MAX_RUNS).map((run) => numbers(run.split(":")));
    return all.length > 1 && all.every((run) => run?.length === 2) ? all : undefined;
  },
};
// Names may be any, also __proto__.
const values = {
  write: (all) => Object.entries(all).map((one) => one.join(":")).join(","),
  read: (text) => {
    const pairs = text.split(",").map((one) => one.split(":"));
    if (!pairs.every(([name, value]) => name && isNumber(value))) return undefined;
    return Object.assign(Object.create(null), ...pairs.map(([name, value]) => ({ [name]: Number(value) })));
  },
};
const limit = {
  write: ({ output, lower, upper, absolute }) => [output, lower ?? "", upper ?? "", absolute ? "size" : ""].join(":"),
  read: (text) => {
    const [output, lower, upper, size] = text.split(":");
    const end = (one) => (one ? Number(one) : null);
    if (![lower, upper].every((one) => !one || isNumber(one))) return undefined;
    return { output, lower: end(lower), upper: end(upper), absolute: size === "size" };
  },
};

const PARTS = {
  question: known(QUESTIONS),
  kind: known({ simulate: 0, sweep: 0 }),
  scene: word,
  choice: word,
  output: word,
  x: axis,
  y: { ...axis, read: (text) => (text === "" ? null : axis.read(text)) },
  band,
  set: known(SETS),
  figure: word,
  part: word,
  pair: word,
  runs,
};
// Those of the best, with the name of each in it.
/** @type {Record<string, [string, any]>} */
const OF_BEST = {
  best: ["kind", known(CRITERIA)],
  against: ["against", word],
  limit: ["limit", number(0)],
  weight: ["weight", number(0)],
  points: ["points", number(2)],
  target: ["target", number(-Infinity)],
  contact: ["isInContact", flag],
  robust: ["isRobust", flag],
  found: ["isFound", flag],
};
/** @type {Record<string, [string, any]>} */
const ROWS = { keep: ["limits", limit], vary: ["vary", axis] };

/** @param {import("./view.js").View} view */
export function toLink(view) {
  const query = new URLSearchParams();
  for (const [name, { write }] of Object.entries(PARTS)) {
    const value = view[name];
    if (value || name === "choice" || (name === "y" && value === null)) query.set(name, write(value));
  }
  for (const [name, value] of Object.entries(view.values)) query.set(`p.${name}`, String(value));
  for (const pin of view.pins ?? []) query.append("pin", values.write(pin));
  const { best } = view;
  if (view.question !== "drive" || !best) return `#${query}`;
  const usual = usualBest();
  for (const [name, [field, { write }]] of Object.entries(OF_BEST)) {
    if (name === "best" || best[field] !== usual[field]) query.set(name, write(best[field]));
  }
  for (const [name, [field, { write }]] of Object.entries(ROWS)) {
    for (const row of best[field]) query.append(name, write(row));
  }
  if (Object.keys(best.given).length) query.set("given", values.write(best.given));
  return `#${query}`;
}

// What a link asks for, and a sentence about each part of it that makes no sense.
/** @param {string} hash @returns {{wanted: any, complaints: string[]}} */
export function fromLink(hash) {
  const complaints = new Set();
  const text = hash.replace(/^#/, "");
  if (text.length > MAX_CHARACTERS) return { wanted: {}, complaints: ["The link is too long to be read: the page shows its defaults."] };
  const query = new URLSearchParams(text);
  const all = (name, { read }, most = 1) =>
    query.getAll(name).slice(0, most).map(read).filter((found) => {
      if (found === undefined) complaints.add(`The link gives ${name.startsWith("p.") ? "a parameter" : name} nothing that makes sense: the default is used.`);
      return found !== undefined;
    });
  const wanted = { values: Object.create(null) };
  for (const [name, part] of Object.entries(PARTS)) {
    for (const found of all(name, part)) wanted[name] = found;
  }
  for (const name of query.keys()) {
    if (name.startsWith("p.")) for (const found of all(name, number(-Infinity))) wanted.values[name.slice(2)] = found;
  }
  if (query.has("pin")) wanted.pins = all("pin", values, MAX_PINS);
  if (query.has("best")) {
    wanted.best = usualBest();
    for (const [name, [field, part]] of Object.entries(OF_BEST)) {
      for (const found of all(name, part)) wanted.best[field] = found;
    }
    for (const [name, [field, part]] of Object.entries(ROWS)) wanted.best[field] = all(name, part, MAX_ROWS);
    for (const found of all("given", values, MAX_ROWS)) Object.assign(wanted.best.given, found);
  }
  return { wanted: text ? wanted : {}, complaints: [...complaints] };
}

// What is drawn of a view, as text: two views with the same have the same picture.
/** @param {any} view */
export function pictureOf({ kind, scene, choice, set, recording, output, x, y, values, band }) {
  const fixed = Object.entries(values).filter(([name]) => name !== x.name && name !== y?.name);
  const told = toLink({ question: "", kind, scene, choice, set, output, x, y, values: Object.fromEntries(fixed), band });
  return recording ? `${told}&recording=${recording.name}:${recording.drive.data.length}` : told;
}

// What a design does, as text: two views with the same have the same answer.
export function designOf({ kind, scene, choice, set, recording, surface, output, values, band }) {
  if (surface) return `file ${surface.place}`;
  return pictureOf({ kind, scene, choice, set, recording, output, x: { name: "" }, y: null, values, band });
}
