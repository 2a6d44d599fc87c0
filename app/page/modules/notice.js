// What the page says at its top: what is wrong, and that it asks for a key; that the service is waited for is said
// beside the number.

import { byId, element, fill } from "./elements.js";
import { Away, Refusal, isPassing, key } from "./service.js";
import { signal } from "./store.js";

const RETRY = 2000; // ms
const KEY = /^[\x21-\x7e]+$/; // what a header can carry

const asksForKey = (error) => error.status === 401 || error.type.endsWith(":wrong-keys");

export class Notice {
  constructor(host) {
    this.host = host;
    this.form = byId("key-form");
    this.away = signal(""); // why the service does not answer, while it does not
    this.retries = new Set(); // what asks it again at once
    this.asking = null; // promise that a key is given
  }

  // Say what is wrong; without sentences, that nothing is.
  tell(sentences = []) {
    fill(this.host, ...sentences.map((text) => element("p", {}, text)));
  }

  // Ask until the service answers, and say so meanwhile.
  async persist(task) {
    for (;;) {
      const used = key.get();
      try {
        const found = await task();
        this.away.value = "";
        return found;
      } catch (error) {
        if (error instanceof Refusal && asksForKey(error)) {
          // A late refusal of a key in whose place another has been given is none of that one.
          if (key.get() === used) await (this.asking ??= this.askForKey(error));
        } else if (isPassing(error)) {
          const told = error instanceof Away ? "The service does not answer" : error.message.replace(/\.$/, "");
          this.away.value = `${told}; asking again in ${RETRY / 1000} s.`;
          await new Promise((done) => {
            this.retries.add(done);
            setTimeout(done, RETRY);
          });
        } else {
          this.away.value = "";
          throw error;
        }
      }
    }
  }

  // Ask the service again at once.
  now() {
    for (const retry of this.retries) retry();
    this.retries.clear();
  }

  askForKey(error) {
    const [said, , field] = this.form.children;
    this.form.hidden = false;
    said.textContent = key.get() ? error.message : "The service needs an access key: enter yours.";
    field.value = "";
    field.focus();
    return new Promise((done) => {
      this.form.onsubmit = (event) => {
        event.preventDefault();
        const given = field.value.trim();
        if (!KEY.test(given)) {
          said.textContent = "An access key consists of English letters, digits and punctuation, without spaces.";
          return;
        }
        key.set(given);
        this.asking = null;
        this.form.hidden = true;
        done();
      };
    });
  }
}
