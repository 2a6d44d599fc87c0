// What the page says at its top: what is wrong, that the service is waited for, that it asks for a key.

import { element, fill } from "./elements.js";
import { Away, Refusal, key } from "./service.js";

const RETRY = 2000; // ms

export class Notice {
  constructor(host) {
    this.host = host;
  }

  tell(sentences = []) {
    fill(this.host, ...sentences.map((text) => element("p", {}, text)));
  }

  // Ask until the service answers, and say so meanwhile.
  async persist(task) {
    for (;;) {
      try {
        const found = await task();
        this.tell();
        return found;
      } catch (error) {
        if (error instanceof Away) this.tell(["The service does not answer. Asking again ..."]);
        else if (error instanceof Refusal && error.status === 401) await this.askForKey(error);
        else if (error instanceof Refusal && [429, 503].includes(error.status)) this.tell([error.message]);
        else throw error;
        if (!(error instanceof Refusal && error.status === 401)) {
          await new Promise((done) => setTimeout(done, RETRY));
        }
      }
    }
  }

  askForKey(error) {
    return new Promise((done) => {
      const field = element("input", { type: "password", id: "key", autocomplete: "off" });
      const form = element(
        "form",
        {
          onsubmit: (event) => {
            event.preventDefault();
            key.set(field.value.trim());
            done();
          },
        },
        element("p", {}, key.get() ? error.message : "The service asks for a key."),
        element("label", { for: "key" }, "Key, kept until this tab is closed "),
        field,
        element("button", {}, "Use it"),
      );
      fill(this.host, form);
      field.focus();
    });
  }
}
