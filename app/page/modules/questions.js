// The questions that the page answers, as buttons.

import { element, fill } from "./elements.js";

const TITLES = {
  speed: "How fast does my part travel?",
  drive: "Which drive is best?",
  thesis: "What did the thesis draw?",
  all: "Everything",
};

// `onask(question)` hears which of them is asked; `current` is the one that is.
export function tellQuestions(host, current, onask) {
  fill(
    host,
    ...Object.entries(TITLES).map(([question, title]) =>
      element(
        "button",
        {
          type: "button",
          "aria-current": question === current ? "true" : "false",
          onclick: () => onask(question),
        },
        title,
      ),
    ),
  );
}
