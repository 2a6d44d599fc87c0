// The field of a parameter: its number, a slider with ends that can be typed, and a word where the
// value is outside of what is usual.

import { places } from "./computed.js";
import { element } from "./elements.js";
import { numberInput } from "./fields.js";
import { unusual, usual } from "./view.js";
import { capital, shown, withUnit, words } from "./words.js";

// `ends` [low, high] of the slider that were typed, or null: those that are usual. `onmove(value,
// range)` hears of each step of the slider, `ontake(value)` of a value that is chosen, `onends` of
// other ends. Returns {field, show(value)}. `more` stands below the slider.
export function knob(parameter, value, { ends = null, onmove, ontake, onends }, ...more) {
  const { name, unit, description } = parameter;
  const [, unitShown] = shown(unit);
  let [low, high] = ends ?? usual(parameter);
  const id = `value-${name}`;
  const text = capital(words(name));
  let range;
  let current = value;
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
  const tell = () => {
    slider.setAttribute("aria-valuetext", withUnit(current, unit));
    odd.textContent = unusual(parameter, current);
  };
  // The slider reaches from end to end, and to the value, and stands at it.
  const follow = () => {
    range = places(Math.min(low, current), Math.max(high, current));
    slider.max = String(range.num - 1);
    slider.value = String(Math.round(((current - range.from) / (range.to - range.from)) * (range.num - 1)));
    lower.show(range.from);
    upper.show(range.to);
    tell();
  };
  const typed = numberInput(
    null,
    value,
    unit,
    (taken) => {
      current = taken;
      follow();
      ontake(taken);
    },
    { id, "aria-describedby": `wrong-${name} unusual-${name}` },
  );
  const end = (which, isFit, problem) =>
    numberInput(
      `${which} end of the slider of ${words(name)}`,
      null,
      unit,
      (taken) => {
        if (which === "Lower") low = taken;
        else high = taken;
        onends([low, high]);
        follow();
      },
      { class: "end", check: (taken) => (isFit(taken) ? "" : problem) },
    );
  const lower = end("Lower", (taken) => taken < high && taken <= current, "The lower end of the slider has to be below the upper end, and not above the value");
  const upper = end("Upper", (taken) => taken > low && taken >= current, "The upper end of the slider has to be above the lower end, and not below the value");
  follow();
  const field = element(
    "div",
    { class: "field", title: description },
    element("label", { for: id }, `${text} `, unitShown ? element("span", { class: "unit" }, `(${unitShown})`) : null),
    typed,
    element("div", { class: "slider" }, lower, slider, upper),
    odd,
    ...more,
  );
  const show = (other) => {
    if (other === current) return;
    current = other;
    typed.show(other);
    follow();
  };
  return { field, show };
}
