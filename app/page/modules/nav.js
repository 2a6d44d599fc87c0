// The questions that the page answers, as buttons.

import { element, refill } from "./elements.js";
import { QUESTIONS } from "./questions.js";


// `onask(question)` hears which of them is asked; `current` is the one that is.
export function tellQuestions(host, current, onask) {
  refill(
    host,
    ...Object.entries(QUESTIONS).map(([question, { title }]) =>
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
    // The same on a phone, where buttons would take the place of the answer.
    element(
      "select",
      { id: "choose-question", "aria-label": "Question", onchange: (event) => onask(event.target.value) },
      ...Object.entries(QUESTIONS).map(([question, { title }]) =>
        element("option", { value: question, selected: question === current }, title),
      ),
    ),
  );
}
