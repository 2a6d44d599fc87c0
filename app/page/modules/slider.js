// A parameter as a slider with its field: ends, a mark where the part lifts off, a word about an unusual value.

import { places } from "./computed.js";
import { element } from "./elements.js";
import { numberInput } from "./fields.js";
import { unusual, usual } from "./view.js";
import { capital, number, shown, withUnit, words } from "./words.js";

// The ends of the slider of a parameter: those of the map's axis, else the usual ones; and the value itself.
export function endsOf(view, parameter) {
  const axis = [view.x, view.y].find((one) => one?.name === parameter.name);
  const [low, high] = axis ? [axis.from, axis.to] : usual(parameter);
  const value = view.values[parameter.name];
  return [Math.min(low, value ?? low), Math.max(high, value ?? high)];
}

// `onmove(value, range)` hears of each step of the slider, `ontake(value)` of a value that is chosen. Returns
// {field, follow(view), mark(value)}. `more` stands below the slider.
export function sliderField(view, parameter, { onmove, ontake, onremove = null }, ...more) {
  const { name, unit, description } = parameter;
  const [factor, unitShown] = shown(unit);
  const id = `value-${name}`;
  const text = capital(words(name));
  let current = view.values[name];
  let range;
  let isMoved = false; // and not yet let go
  const take = () => {
    isMoved = false;
    ontake(range.at(Number(slider.value)));
  };
  const slider = element("input", {
    type: "range",
    min: 0,
    step: 1,
    "aria-label": `${text}, slider`,
    oninput: () => {
      isMoved = true;
      current = range.at(Number(slider.value));
      typed.show(current);
      tell();
      onmove(current, range);
    },
    onchange: () => take(),
    // Back where it began a browser tells of no change, and the picture is still that of a drag.
    onpointerup: () => setTimeout(() => isMoved && take()),
  });
  const odd = element("span", { class: "unusual", id: `unusual-${name}` });
  const lift = element("span", { class: "lift", "aria-hidden": "true", hidden: true });
  const [low, high] = [element("span", { class: "low" }), element("span", { class: "high" })];
  const tell = () => {
    slider.setAttribute("aria-valuetext", withUnit(current, unit));
    slider.style.setProperty("--at", `${(100 * (current - range.from)) / (range.to - range.from || 1)}%`);
    odd.textContent = unusual(parameter, current, view.begun?.[name]);
    typed.classList.toggle("odd", odd.textContent !== "");
  };
  const follow = (other) => {
    view = other;
    const value = view.values[name];
    if (!isMoved) {
      const [from, to] = endsOf(view, parameter);
      range = places(from, to === from ? from + 1 : to);
      slider.max = String(range.num - 1);
      slider.value = String(Math.round(((value - range.from) / (range.to - range.from)) * (range.num - 1)));
      low.textContent = number(range.from * factor);
      high.textContent = number(range.to * factor);
    }
    if (value !== current || (typed.getAttribute("aria-invalid") !== "true" && document.activeElement !== typed)) typed.show(value);
    current = value;
    tell();
  };
  const typed = numberInput(null, current, unit, (taken) => ontake(taken), { id, "aria-describedby": `wrong-${name} unusual-${name}` });
  // Where the part lifts off, in the unit of the service; null where it does not, or nobody knows.
  const mark = (at) => {
    lift.hidden = at === null || !(at > range.from && at < range.to);
    if (lift.hidden) return;
    const share = (at - range.from) / (range.to - range.from);
    lift.style.setProperty("--at", `${100 * share}%`);
    lift.style.setProperty("--shift", `${100 * Math.max(0, Math.min(1, 2 * share - 0.5))}%`); // away from the ends
    lift.textContent = `hops above ${number(at * factor, 2)}`;
  };
  const field = element(
    "div",
    { class: "field slider", title: description, "data-name": name },
    element("label", { for: id }, text),
    element("span", { class: "slot" }, typed, unitShown ? element("span", { class: "unit", "aria-hidden": "true" }, unitShown) : null),
    onremove ? element("button", { type: "button", class: "remove", "aria-label": `Remove ${words(name)}`, onclick: onremove }, "×") : null,
    element("div", { class: "reach" }, slider, lift, element("div", { class: "ends" }, low, high)),
    odd,
    element("span", { class: "wrong", id: `wrong-${name}` }),
    ...more,
  );
  follow(view);
  return { field, follow, mark };
}

// Two ends of what may be chosen, on one line: `ontake(from, to)` hears.
export function rangeField(text, axis, parameter, ontake, ...more) {
  const { name, unit } = parameter;
  const [least, most] = usual(parameter);
  const [low, high] = [Math.min(least, axis.from), Math.max(most, axis.to)];
  const step = (high - low) / 100;
  const ends = [axis.from, axis.to];
  const track = element("div", { class: "two" });
  const tell = () => ["--from", "--at"].forEach((end, k) => track.style.setProperty(end, `${(100 * (ends[k] - low)) / (high - low)}%`));
  const typed = ["Least", "Largest"].map((which, k) => {
    const told = `${which} ${words(name)}`;
    const field = numberInput(told, ends[k], unit, (value) => ontake(...(k ? [ends[0], value] : [value, ends[1]])), {
      id: `${k ? "most" : "least"}-${name}`,
      check: (value) => ((k ? value > ends[0] : value < ends[1]) ? "" : "The lower bound has to be below the upper bound"),
    });
    const slider = element("input", {
      type: "range",
      min: low,
      max: high,
      step,
      "aria-label": `${told} (slider)`,
      "aria-valuetext": withUnit(ends[k], unit),
      oninput: () => {
        const value = Number(slider.value);
        slider.value = ends[k] = k ? Math.max(ends[0] + step, value) : Math.min(ends[1] - step, value);
        field.show(ends[k]);
        tell();
      },
      onchange: () => ontake(...ends),
      value: ends[k],
    });
    track.append(slider);
    return field;
  });
  const [, unitShown] = shown(unit);
  tell();
  return element(
    "div",
    { class: "field bounds" },
    element("span", { class: "name" }, text, ...more),
    element("span", { class: "pair" }, element("span", { class: "slot" }, typed[0]), " to ", element("span", { class: "slot" }, typed[1], unitShown ? element("span", { class: "unit" }, unitShown) : null)),
    track,
  );
}
