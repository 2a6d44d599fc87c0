// What the printed sheet has besides the answer and the pictures: date, values, and the address of the design.

import { flagOf, valueOf } from "./computed.js";
import { element, fill } from "./elements.js";
import { liftOff } from "./answers.js";
import { partOf } from "./parts.js";
import { toLink } from "./link.js";
import { capital, number, withUnit, words } from "./words.js";

export function tellSheet(host, { view, scene, dataset, version }) {
  const unitOf = (name) => scene.parameters.find((one) => one.name === name)?.unit ?? "1";
  const row = (name, value) => element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, value));
  const rows = [row("System", scene.title)];
  if (view.surface) rows.push(row("Part", view.surface.name));
  if (view.kind === "simulate") rows.push(row("Part", partOf(view).title));
  if (view.pair) rows.push(row("Materials", view.pair));
  for (const { name, unit } of scene.parameters.filter(({ name }) => !view.surface && name in view.values && (name === "gamma" || view.own?.[name] !== view.values[name]))) {
    const band = view.band?.name === name ? ` (${[1 - view.band.share, 1 + view.band.share].map((one) => number(view.values[name] * one, 2)).join(" to ")})` : "";
    rows.push(row(capital(words(name)), withUnit(view.values[name], unit) + band));
  }
  const throwNumber = valueOf(dataset, "throw_number");
  const drive = ["amplitude", "peak_to_peak"].find((name) => name in view.values);
  if (throwNumber > 0 && drive) rows.push(row("Lifts off at", withUnit(liftOff(drive, view.values, throwNumber), unitOf(drive), 2)));
  for (const name of [...new Set([view.output, "hop_height", "throw_number"])]) {
    const output = scene.outputs.find((one) => one.name === name);
    const value = valueOf(dataset, name);
    if (output && typeof value === "number") rows.push(row(capital(words(name)), withUnit(value, output.unit, 3)));
  }
  const regime = flagOf(dataset);
  if (regime && regime !== "not_assessed") rows.push(row("Motion", words(regime)));
  fill(
    host,
    element("p", { class: "date" }, new Date().toLocaleDateString([], { day: "numeric", month: "long", year: "numeric" })),
    element("div", { class: "sheet-values" }, element("h3", {}, "Values"), element("table", {}, ...rows)),
    element("p", { class: "address" }, element("b", {}, "Address of this design"), element("br"), new URL(toLink(view), location.href).href),
    element("p", { class: "address pale" }, `${scene.validity ?? ""} Computed by vibrafeed ${version}.`),
  );
}
