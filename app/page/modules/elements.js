// Elements of the page, made without strings of markup: nothing that is shown is ever run.

/**
 * @param {string} tag
 * @param {Record<string, any>} attributes
 * @param {any[]} children
 * @returns {any}
 */
export function element(tag, attributes = {}, ...children) {
  /** @type {any} */
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (name === "value") made.value = value;
    else made.setAttribute(name, value === true ? "" : String(value));
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

export function fill(parent, ...children) {
  parent.replaceChildren(...children.filter((child) => child !== null && child !== undefined));
}

// The same; what had the focus has it still, if an element of that id is there again.
export function refill(parent, ...children) {
  const id = parent.contains(document.activeElement) ? document.activeElement.id : "";
  fill(parent, ...children);
  if (id) document.getElementById(id)?.focus({ preventScroll: true });
}

/** @returns {any} */
export function byId(id) {
  return document.getElementById(id);
}

const SVG = "http://www.w3.org/2000/svg";

export function drawn(tag, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  made.append(...children);
  return made;
}

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

// The steps across and up of an arrow key, ten with Shift; null of other keys.
export function arrowOf({ key, shiftKey }) {
  return ARROWS[key]?.map((one) => one * (shiftKey ? 10 : 1)) ?? null;
}
