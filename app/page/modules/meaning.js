// What the words of a picture mean: its equation, and each parameter that it depends on.

import { element, fill } from "./elements.js";
import { capital, label } from "./words.js";

export function tellMeaning(host, { output, values, x, y }, scene) {
  const shown = scene.outputs.find(({ name }) => name === output);
  const names = new Set([x?.name, y?.name, ...Object.keys(values)]);
  const line = ({ name, symbol, unit, description }) => [
    element("dt", {}, label(name, unit), symbol ? ` ${symbol}` : null),
    element("dd", {}, description),
  ];
  fill(
    host,
    element("p", {}, capital(shown.equation || shown.description), " ", element("small", {}, shown.source ?? "")),
    element("dl", {}, ...[shown, ...scene.parameters.filter(({ name }) => names.has(name))].flatMap(line)),
  );
}
