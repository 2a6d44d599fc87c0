// The ways in which a part comes to rest: a card each, drawn, with its share as a bracket.

import { aspectsOf, liesTold, wantedIn } from "./answers.js";
import { drawn, element, fill } from "./elements.js";
import { capital, number, withUnit } from "./words.js";

const ROOM = { wide: 190, tall: 130 };
const DEPTH = 0.32; // of the depth, as it is seen

// Length along, depth and height of a part that lies so.
function sizeOf({ length, width, height, diameter, small_diameter: small }, aspect) {
  if (width !== undefined && length !== undefined) {
    if (aspect === "on_side") return [length, height, width];
    if (aspect === "on_end") return [width, height, length];
    return [length, width, height];
  }
  const long = height ?? length ?? diameter;
  const across = Math.max(diameter ?? 0, small ?? 0) || width || long;
  return aspect === "on_side" ? [long, across, across] : [across, across, long];
}

function boxDrawn(values, aspect, size) {
  const [along, deep, tall] = size ?? sizeOf(values, aspect);
  const isRound = !size && values.diameter !== undefined;
  const svg = drawn("svg", { viewBox: `0 0 ${ROOM.wide} ${ROOM.tall}`, class: "aspect", "aria-hidden": "true" });
  if (![along, deep, tall].every(Number.isFinite)) return { svg, tall: NaN }; // a shape that is not drawn
  const reach = Math.max(...(size ?? [values.length, values.width, values.height, values.diameter].filter(Boolean)));
  const scale = Math.min(110 / reach, 96 / reach);
  const [w, h, d] = [along * scale, tall * scale, deep * scale * DEPTH];
  const [x, y] = [(ROOM.wide - w - d) / 2, ROOM.tall - 12];
  svg.append(drawn("path", { d: `M8 ${y}H${ROOM.wide - 30}l22 -22H${x + d}Z`, class: "ground" }));
  if (isRound && aspect === "on_side") {
    svg.append(
      drawn("path", { d: `M${x + w} ${y - h}h${-w}v${h}h${w}Z`, class: "body" }),
      drawn("ellipse", { cx: x + w, cy: y - h / 2, rx: h * 0.16, ry: h / 2, class: "side" }),
    );
  } else if (isRound) {
    const [low, high] = aspect === "inverted" ? [values.small_diameter, values.diameter] : [values.diameter, values.small_diameter ?? values.diameter];
    const [a, b] = [low, high ?? low].map((one) => (one * scale) / 2);
    const cx = ROOM.wide / 2;
    svg.append(
      drawn("path", { d: `M${cx - b} ${y - h}L${cx - a} ${y}A${a} ${a * 0.22} 0 0 0 ${cx + a} ${y}L${cx + b} ${y - h}Z`, class: "body" }),
      drawn("ellipse", { cx, cy: y - h, rx: b, ry: b * 0.22, class: "lid" }),
    );
  } else {
    svg.append(
      drawn("path", { d: `M${x} ${y}v${-h}h${w}v${h}Z`, class: "body" }),
      drawn("path", { d: `M${x} ${y - h}l${d} ${-d}h${w}l${-d} ${d}Z`, class: "lid" }),
      drawn("path", { d: `M${x + w} ${y}v${-h}l${d} ${-d}v${h}Z`, class: "side" }),
    );
  }
  return { svg, tall };
}

// `onwant(name)` hears of the aspect that is wanted.
export function tellAspects(host, view, dataset, isStale, onwant) {
  host.classList.toggle("stale", isStale);
  const aspects = aspectsOf(dataset);
  const width = (share) => `${Math.max(0, Math.min(100, 100 * share))}%`;
  fill(
    host,
    ...aspects.map(({ name, value, low, high, size }) => {
      const { svg, tall } = boxDrawn(view.values, name, size);
      const bar = element("span", { class: "bar" });
      bar.style.cssText = `--value: ${width(value)}; --low: ${width(low)}; --high: ${width(high)}`;
      const isWanted = name === (wantedIn(view) ?? aspects[0].name);
      const range = number(100 * low, 2) === number(100 * high, 2) ? `${number(100 * low, 2)} %` : `${number(100 * low, 2)} to ${number(100 * high, 2)} %`;
      return element(
        "button",
        { type: "button", class: "aspect-card", "aria-pressed": String(isWanted), onclick: () => onwant(name) },
        element("span", { class: "head" }, element("b", {}, capital(liesTold(name).replace(/^(lie in|lie|stand|rest as) /, ""))), element("small", {}, `${isWanted ? "wanted, " : ""}${Number.isFinite(tall) ? `${withUnit(tall, "m", 3)} high` : ""}`)),
        svg,
        element("span", { class: "share" }, range),
        bar,
        element("span", { class: "ends" }, element("span", {}, "0"), element("span", {}, "100 %")),
      );
    }),
  );
}
