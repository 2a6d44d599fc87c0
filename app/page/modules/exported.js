// A picture as one SVG document, which says by itself what it shows: title, values, colours, regimes.

import { drawn } from "./elements.js";
import { barDrawn } from "./legend.js";
import { capital, number, words } from "./words.js";

const LINE = 18; // px
const LETTER = 6.6; // px, on average
const EDGE = 12; // px
const BAR = 364; // px

// `parts` are elements of a picture of `width` times `height`; `told` is {title, lines, link}; `bar` is
// {range, name, unit} or null, `regimes` as a legend has them.
export function svgDocument(parts, { width, height, style, told, bar = null, regimes = [] }) {
  const head = [told.title, ...told.lines.flatMap((line) => wrapped(line, (width - 2 * EDGE) / LETTER))];
  const top = LINE * head.length + EDGE;
  const text = (words_, x, y, more = {}) => drawn("text", { x, y, ...more }, words_);
  const below = [];
  let at = top + height + 8;
  if (bar?.range) {
    below.push(drawn("g", { transform: `translate(${Math.max(0, (width - BAR) / 2)} ${at})` }, barDrawn(bar.range, bar)));
    at += 3 * LINE;
  }
  for (const one of regimes) {
    below.push(
      drawn("circle", { cx: EDGE + 6, cy: at + 6, r: 5, class: "marker", fill: one.colour }),
      text(`${capital(words(one.name))} ${number(100 * one.share, 2)} %`, EDGE + 20, at + 10),
    );
    at += LINE;
  }
  const made = drawn(
    "svg",
    { xmlns: "http://www.w3.org/2000/svg", width, height: at + EDGE },
    drawn("title", {}, told.title),
    drawn("desc", {}, told.link),
    drawn("style", {}, style),
    drawn("rect", { width, height: at + EDGE, class: "paper" }),
    ...head.map((line, i) => text(line, EDGE, LINE * (i + 1), i ? {} : { class: "label" })),
    drawn("g", { transform: `translate(0 ${top})` }, ...parts),
    ...below,
  );
  return new XMLSerializer().serializeToString(made);
}

// Lines of at most so many letters, broken at commas.
function wrapped(text, most) {
  const lines = [""];
  for (const part of text.split(/(?<=, )/)) {
    if (lines.at(-1) && lines.at(-1).length + part.length > most) lines.push("");
    lines[lines.length - 1] += part;
  }
  return lines;
}
