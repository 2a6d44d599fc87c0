// The questions that the page answers, as buttons.

import { element, refill } from "./elements.js";

const TITLES = {
  speed: "How fast does my part travel?",
  drive: "Which drive is best?",
  springs: "What amplitude will my springs give?",
  thesis: "What did the thesis draw?",
  all: "Everything",
};

// `onask(question)` hears which of them is asked; `current` is the one that is.
export function tellQuestions(host, current, onask) {
  refill(
    host,
    ...Object.entries(TITLES).map(([question, title]) =>
      element(
        "button",
        {
          id: `question-${question}`,
          type: "button",
          "aria-current": question === current ? "true" : "false",
          onclick: () => onask(question),
        },
        title,
      ),
    ),
  );
}
