// What is said over the picture: what it waits for, why it is not of the fields, and what one can do.

import { element, fill } from "./elements.js";

export class Overlay {
  constructor(host) {
    this.host = host;
    this.said = element("p", { role: "status" });
  }

  // A sentence and, where there is something to do, {text, onclick} of a button. A button that is
  // there already stays, and keeps the focus.
  say(text, action = null) {
    if (this.said.parentElement !== this.host) fill(this.host, this.said);
    this.said.textContent = text;
    this.onclick = action?.onclick;
    if (this.button?.textContent === action?.text && this.button?.isConnected) return;
    this.button?.remove();
    if (!action) return;
    this.button = element("button", { type: "button", onclick: () => this.onclick?.() }, action.text);
    this.host.append(this.button);
  }

  clear() {
    fill(this.host);
  }
}
