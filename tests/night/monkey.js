// Random actions on the page, and whether address, fields, picture and crosshair then agree.
// `act`, `settled` and `disagreements` are added to the window.
// A monkey waits for a picture as long as most people do; then it presses the Cancel over it, and waits for no
// motion either: one that is not of the fields is dimmed.

{
  const all = (places) => [...document.querySelectorAll(places)].filter((one) => one.getClientRects().length);
  const picked = (list, share) => list[Math.min(list.length - 1, Math.floor(share * list.length))];
  const frame = () => new Promise((done) => requestAnimationFrame(done));
  const heard = (place, name, more = {}) => place.dispatchEvent(new Event(name, { bubbles: true, ...more }));
  const QUICK = ["rectangle-on-plane", "cylinder-on-plane", "rectangle-on-track"]; // their motion is soon known
  const PATIENCE = 3_000; // ms; which of the two comes, a picture or the word that it was cancelled, is the same to it
  const DIMMED_AFTER = 1_000; // ms: a motion has 100, and a busy machine its time
  const FRAME = { left: 52, right: 12, top: 10, bottom: 42 }; // of the picture, px

  window.faults = [];
  window.addEventListener("error", (event) => window.faults.push(event.message));
  window.addEventListener("unhandledrejection", (event) => window.faults.push(String(event.reason?.stack)));

  // Where the page stands among the views that it has been at, for browsers that do not tell.
  const steps = { at: 0, last: 0 };
  const { pushState } = history;
  history.pushState = function (...given) {
    pushState.apply(this, given);
    steps.last = steps.at += 1;
  };
  const go = (by) => {
    if (!window.navigation) {
      if (steps.at + by < 0 || steps.at + by > steps.last) return false;
      steps.at += by;
      history.go(by);
      return true;
    }
    const target = navigation.entries()[navigation.currentEntry.index + by];
    if (!target?.url.startsWith(location.origin)) return false;
    const { committed, finished } = navigation.traverseTo(target.key);
    for (const one of [committed, finished]) one.catch(() => {}); // a browser forgets the oldest of many entries
    return true;
  };

  const ACTIONS = {
    type({ share, text }) {
      const field = picked(all("#controls input[inputmode], #expert input[inputmode]"), share);
      if (!field) return;
      // Beside hostile texts, numbers near the one that stands there.
      field.value = text.startsWith("*") ? String(Number(field.value) * Number(text.slice(1))) : text;
      heard(field, "change");
    },
    async drag({ share, places }) {
      const slider = picked(all("#controls input[type=range], #expert input[type=range]"), share);
      for (const place of places) {
        if (!slider?.isConnected) return;
        slider.value = String(Number(slider.min) + place * (slider.max - slider.min));
        heard(slider, "input");
        await frame();
      }
      if (slider) heard(slider, "change");
    },
    select({ share, places }) {
      const isSlow = (one) => ["choose-method", "choose-variant"].includes(one.id);
      const choice = picked(all("#controls select, #expert select, #figures select").filter((one) => !isSlow(one)), share);
      const values = [...(choice?.options ?? [])].map(({ value }) => value);
      const known = choice?.id === "choose-system" ? values.filter((one) => QUICK.includes(one)) : values;
      if (!known.length) return;
      choice.focus();
      choice.value = picked(known, places[0]);
      heard(choice, "change");
    },
    point({ places: [x, y] }) {
      const [map] = all("#host .map, #host .curves");
      if (!map) return;
      const box = map.getBoundingClientRect();
      const at = { clientX: box.x + x * box.width, clientY: box.y + y * box.height, bubbles: true };
      map.focus();
      map.dispatchEvent(new PointerEvent("pointermove", at));
      map.dispatchEvent(new MouseEvent("mousemove", at));
      map.dispatchEvent(new MouseEvent("click", at));
    },
    key({ share, places }) {
      const [map] = all("#host .map");
      map?.focus();
      for (const _ of places) {
        const key = picked(["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Enter"], share);
        map?.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
      }
    },
    ask({ share }) {
      picked(all("#questions button"), share)?.click();
    },
    wish({ share }) {
      picked(all("#wishes fieldset button, #wishes input[type=checkbox], #chips button, #best-told button, #keep, .remove"), share)?.click();
    },
    // A handle of the stage, by the pointer.
    async pull({ share, places }) {
      const handle = picked(all(".stage .handle"), share);
      if (!handle) return;
      const box = handle.getBoundingClientRect();
      const at = (x, y) => ({ clientX: box.x + 20 + x, clientY: box.y + 20 + y, bubbles: true, pointerId: 1 });
      handle.setPointerCapture = handle.releasePointerCapture = () => {};
      handle.hasPointerCapture = () => true;
      handle.dispatchEvent(new PointerEvent("pointerdown", at(0, 0)));
      for (const place of places) {
        handle.dispatchEvent(new PointerEvent("pointermove", at(80 * (place - 0.5), 60 * (share - 0.5))));
        await frame();
      }
      handle.dispatchEvent(new PointerEvent("pointerup", at(0, 0)));
    },
    async back({ share }) {
      const changed = new Promise((done) => addEventListener("hashchange", done, { once: true }));
      if (!go(share < 0.7 ? -1 : 1)) return;
      await Promise.race([changed, new Promise((done) => setTimeout(done, 500))]);
    },
  };

  window.act = async (action) => {
    await ACTIONS[action.kind](action);
  };

  const busy = (id) => document.getElementById(id).getAttribute("aria-busy") === "true";

  window.settled = async () => {
    for (const menu of all("#expert, #part")) menu.open = true; // what is hidden is not tried
    const begun = performance.now();
    const isTired = () => performance.now() - begun > PATIENCE;
    for (let calm = 0; calm < 3; ) {
      calm = busy("picture") || busy("answer") ? 0 : calm + 1;
      const cancel = all("#stale button, #answer .actions button").find((one) => one.textContent.startsWith("Cancel"));
      if (isTired()) cancel?.click();
      await frame();
    }
  };

  const near = (value, wanted, part = 1e-5) => Math.abs(value - wanted) <= part * Math.abs(wanted) + 1e-12;
  const FACTORS = { mm: 1e3, "mm/s": 1e3, g: 1e3, MPa: 1e-6, "N/mm": 1e-3, "cm²": 1e4 };
  const factorOf = (text) => FACTORS[text.match(/\(([^)]+)\)/)?.[1]] ?? 1;

  window.disagreements = async () => {
    const { fromLink, pictureOf } = await import(new URL("page/modules/link.js", document.baseURI));
    const found = [...window.faults];
    window.faults.length = 0;
    const say = (what, one, other) => found.push(`${what}: ${one} and ${other}, at ${location.hash}`);
    const { wanted: view, complaints } = fromLink(location.hash);
    if (complaints.length) found.push(complaints[0]);
    for (const [name, value] of Object.entries(view.values)) {
      const field = document.getElementById(`value-${name}`);
      if (!field) {
        if (/^turn_/.test(name)) continue; // of a place without a device
        const isBound = view.question === "drive" && [view.x, view.y].some((axis) => axis?.name === name);
        if (!isBound) found.push(`no field for ${name}, at ${location.hash}`);
        continue;
      }
      if (field.getAttribute("aria-invalid")) continue; // the last value holds, which the slider has
      const box = field.closest(".field");
      if (!near(Number(field.value), value * factorOf(`(${box.querySelector(".unit")?.textContent})`))) say(`field ${name}`, field.value, value);
      const spoken = box.querySelector("input[type=range]").getAttribute("aria-valuetext").replace("\u2212", "-");
      if (!near(parseFloat(spoken), Number(field.value), 1e-3)) say(`slider ${name}`, spoken, field.value);
    }
    const chosen = { system: view.scene, model: view.kind, output: view.output, across: view.x?.name, up: view.y?.name ?? "" };
    for (const [id, value] of Object.entries(chosen)) {
      const choice = document.getElementById(`choose-${id}`);
      if (!choice && id === "model") continue; // what is not followed in time has one
      const { value: shown } = choice;
      if (shown !== value) say(id, shown, value);
    }
    for (const [id, axis] of [["across", view.x], ["up", view.y]]) {
      if (!axis) continue;
      const box = document.getElementById(`choose-${id}`).closest(".field");
      const { text } = document.getElementById(`choose-${id}`).selectedOptions[0];
      [...box.querySelectorAll(".pair input")].forEach((input, i) => {
        if (input.getAttribute("aria-invalid")) return; // the last value holds
        const value = [axis.from, axis.to][i] * factorOf(text);
        if (!near(Number(input.value), value)) say(`end of ${id}`, input.value, value);
      });
    }
    const host = document.getElementById("host");
    const isStale = document.getElementById("picture").classList.contains("stale");
    const isAsking = /takes about/.test(document.getElementById("stale").textContent); // of a slow method
    const asSet = (text) => [...new URLSearchParams(text.replace("#", ""))].map(String).filter((one) => !one.startsWith("band")).sort().join("&");
    if (isStale) {
      if (!document.getElementById("stale").textContent) found.push("dimmed without a reason");
    } else if (!isAsking && asSet(host.dataset.view ?? "") !== asSet(pictureOf({ choice: "", ...view }))) {
      say("picture", host.dataset.view, "the address");
    }
    if (!isStale && !isAsking) found.push(...crosshair(view));
    const number = document.querySelector("#answer .answer strong").textContent;
    if (!number) found.push(`no number and no reason, at ${location.hash}`);
    return found;
  };

  // The marked point and the crosshair are where their numbers say.
  function crosshair(view) {
    const found = [];
    const [map] = all("#host .map");
    if (!map || !view.y) return found;
    const { clientWidth: width, clientHeight: height } = map;
    const value = ({ from, to }, share) => from + share * (to - from);
    const across = (at) => value(view.x, (at - FRAME.left) / (width - FRAME.left - FRAME.right));
    const up = (at) => value(view.y, (height - FRAME.bottom - at) / (height - FRAME.top - FRAME.bottom));
    const isNear = (one, other, axis, part) => Math.abs(one - other) <= part * (axis.to - axis.from);
    const at = { x: view.values[view.x.name], y: view.values[view.y.name] };
    const places = [...map.querySelectorAll(".dragged .ring")].map((one) => [across(one.cx.baseVal.value), up(one.cy.baseVal.value)]);
    const isMarked = places.some(([x, y]) => isNear(x, at.x, view.x, 0.01) && isNear(y, at.y, view.y, 0.01));
    const isInside = ["x", "y"].every((place) => at[place] >= view[place].from && at[place] <= view[place].to);
    if (isInside && !isMarked) found.push(`no ring at the design, but at ${JSON.stringify(places)}, at ${location.hash}`);
    const lines = map.querySelectorAll(".cursor line");
    if (lines.length) {
      const told = document.querySelector("#host .said").textContent.replaceAll("\u2212", "-").match(/-?[\d.]+(?:e-?\d+)?/g).map(Number);
      const units = ["across", "up"].map((id) => factorOf(document.getElementById(`choose-${id}`).selectedOptions[0].text));
      const lies = [across(lines[0].x1.baseVal.value), up(lines[1].y1.baseVal.value)];
      // What is told is that of the cell, a thirtieth of a coarse map.
      if (!isNear(lies[0], told[0] / units[0], view.x, 1 / 29) || !isNear(lies[1], told[1] / units[1], view.y, 1 / 29)) {
        found.push(`crosshair at ${lies}, told ${told}, at ${location.hash}`);
      }
    }
    return found;
  }
}
