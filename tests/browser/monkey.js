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
  const FRAME = { left: 62, right: 14, top: 10, bottom: 46 }; // of the picture, px

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
      const field = picked(all("#controls input[inputmode], #part input, #optimum input[inputmode]"), share);
      if (!field) return;
      // Beside hostile texts, numbers near the one that stands there.
      field.value = text.startsWith("*") ? String(Number(field.value) * Number(text.slice(1))) : text;
      heard(field, "change");
    },
    async drag({ share, places }) {
      const slider = picked(all("#controls input[type=range]"), share);
      for (const place of places) {
        if (!slider?.isConnected) return;
        slider.value = String(Math.round(place * Number(slider.max)));
        heard(slider, "input");
        await frame();
      }
      if (slider) heard(slider, "change");
    },
    select({ share, places }) {
      const isSlow = (one) => ["choose-method", "choose-variant"].includes(one.id);
      const choice = picked(all("#controls select, #optimum select, #figures select").filter((one) => !isSlow(one)), share);
      const values = [...(choice?.options ?? [])].map(({ value }) => value);
      const known = choice?.id === "choose-system" ? values.filter((one) => QUICK.includes(one)) : values;
      if (!known.length) return;
      choice.focus();
      choice.value = picked(known, places[0]);
      heard(choice, "change");
    },
    point({ places: [x, y] }) {
      const [map] = all("#host .map, #host .u-over");
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
      const isSaving = (one) => /Find the best/.test(one.textContent);
      picked(all("#optimum fieldset button, #optimum input[type=checkbox]").filter((one) => !isSaving(one)), share)?.click();
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

  window.settled = async () => {
    const begun = performance.now();
    const isTired = () => performance.now() - begun > PATIENCE;
    const isBusy = () =>
      document.getElementById("picture").getAttribute("aria-busy") !== "false" ||
      (!isTired() && document.getElementById("detail").getAttribute("aria-busy") === "true");
    for (let calm = 0; calm < 3; ) {
      calm = isBusy() ? 0 : calm + 1;
      const cancel = all("#stale button").find((one) => one.textContent === "Cancel");
      if (isTired()) cancel?.click();
      await frame();
    }
  };

  const near = (value, wanted, part = 1e-5) => Math.abs(value - wanted) <= part * Math.abs(wanted) + 1e-12;
  const FACTORS = { mm: 1e3, "mm/s": 1e3, g: 1e3, MPa: 1e-6, "N/mm": 1e-3, "cm²": 1e4 };
  const factorOf = (text) => FACTORS[text.match(/\(([^)]+)\)/)?.[1]] ?? 1;

  window.disagreements = async () => {
    const { fromLink, pictureOf } = await import(new URL("page/modules/view.js", document.baseURI));
    const found = [...window.faults];
    window.faults.length = 0;
    const say = (what, one, other) => found.push(`${what}: ${one} and ${other}, at ${location.hash}`);
    const { wanted: view, complaints } = fromLink(location.hash);
    if (complaints.length) found.push(complaints[0]);
    for (const [name, value] of Object.entries(view.values)) {
      const field = document.getElementById(`value-${name}`);
      if (!field) {
        found.push(`no field for ${name}, at ${location.hash}`);
        continue;
      }
      const box = field.closest(".field");
      if (!near(Number(field.value), value * factorOf(box.textContent))) say(`field ${name}`, field.value, value);
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
      [...box.querySelectorAll(".ends input")].forEach((input, i) => {
        const value = [axis.from, axis.to][i] * factorOf(text);
        if (!near(Number(input.value), value)) say(`end of ${id}`, input.value, value);
      });
    }
    const host = document.getElementById("host");
    const isStale = document.getElementById("picture").classList.contains("stale");
    const asSet = (text) => [...new URLSearchParams(text.replace("#", ""))].map(String).sort().join("&");
    if (isStale) {
      if (!document.getElementById("stale").textContent) found.push("dimmed without a reason");
    } else if (asSet(host.dataset.view ?? "") !== asSet(pictureOf({ choice: "", ...view }))) {
      say("picture", host.dataset.view, "the address");
    }
    if (!isStale) found.push(...crosshair(view));
    const detail = document.getElementById("detail");
    if (detail.getAttribute("aria-busy") === "true" && !detail.classList.contains("stale")) {
      await new Promise((done) => setTimeout(done, DIMMED_AFTER));
      const isLate = detail.getAttribute("aria-busy") === "true" && !detail.classList.contains("stale");
      if (isLate && !detail.hidden) found.push(`a motion that is not of the fields is not dimmed, at ${location.hash}`);
    }
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
    if (view.point && !document.getElementById("detail").hidden) {
      for (const place of ["x", "y"]) {
        const { value: typed, labels } = document.getElementById(`here-${place}`);
        const wanted = view.point[place] * factorOf(labels[0].textContent);
        if (!near(Number(typed), wanted)) found.push(`point ${typed} and ${wanted}, at ${location.hash}`);
      }
      const places = [...map.querySelectorAll(".mark circle")].map((one) => [across(one.cx.baseVal.value), up(one.cy.baseVal.value)]);
      const isMarked = places.some(([x, y]) => isNear(x, view.point.x, view.x, 0.01) && isNear(y, view.point.y, view.y, 0.01));
      const isInside = ["x", "y"].every((place) => view.point[place] >= view[place].from && view.point[place] <= view[place].to);
      if (isInside && !isMarked) found.push(`no mark at the point, but at ${JSON.stringify(places)}, at ${location.hash}`);
    }
    const lines = map.querySelectorAll(".cursor line");
    if (lines.length) {
      const told = document.querySelector("#host .said").textContent.replaceAll("\u2212", "-").match(/-?[\d.]+(?:e-?\d+)?/g).map(Number);
      const units = ["across", "up"].map((id) => factorOf(document.getElementById(`choose-${id}`).selectedOptions[0].text));
      const at = [across(lines[0].x1.baseVal.value), up(lines[1].y1.baseVal.value)];
      // What is told is that of the cell, a thirtieth of a coarse map.
      if (!isNear(at[0], told[0] / units[0], view.x, 1 / 29) || !isNear(at[1], told[1] / units[1], view.y, 1 / 29)) {
        found.push(`crosshair at ${at}, told ${told}, at ${location.hash}`);
      }
    }
    return found;
  }
}
