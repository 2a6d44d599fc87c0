"""A newcomer asks each question: the answer stands on the first screen, after three clicks."""

from __future__ import annotations

from dataclasses import dataclass

import pytest
from playwright.sync_api import Locator, Page, Route, expect

from looking import settled
from night import NIGHT
from waiting import wait_for

MAX_CLICKS = 3


@dataclass(frozen=True)
class Question:
    """What is asked, what is clicked then, and where which words answer it."""

    name: str
    answer: str
    words: str
    then: str = ""


QUESTIONS = (
    Question("speed", "#answer .answer", "49.9"),
    Question("hop", "#answer .sentence", "In the air for 66 %"),
    Question("drive", "#answer .answer", "6 times as fast"),
    Question("drive", "#answer .answer", "20.6", then="#chip-still"),
    Question("uncertain", "#matters li", "Friction coefficient"),
    Question("uncertain", "#answer .answer", "41 to 58"),
    Question("measured", "#answer .answer", "0.27"),
    Question("waves", "#answer .answer", "56"),
    Question("springs", "#answer .sentence", "tuned to"),
    Question("rows", "#answer .sentence", "3 platoons"),
    Question("resting", "#answer .answer", "65 %"),
    Question("orienting", "#answer .answer", "194"),
)
# By day each is asked once: every other one on a phone, the others by keys.
ON_A_PHONE, BY_KEYS = (QUESTIONS, QUESTIONS) if NIGHT else (QUESTIONS[::2], QUESTIONS[1::2])


def in_sight(page: Page, found: Locator) -> None:
    """Assert that an element is on the screen as it stands, without any scrolling."""
    assert page.evaluate("scrollY") == 0
    box = wait_for(found.bounding_box)  # what is being drawn anew has none for a moment
    size = page.viewport_size
    assert box is not None
    assert size is not None
    assert box["y"] >= 0
    assert box["y"] + box["height"] <= size["height"]
    assert box["x"] + box["width"] <= size["width"]


def answered(page: Page, question: Question) -> None:
    found = page.locator(question.answer).filter(has_text=question.words).first
    expect(found).to_be_visible()
    in_sight(page, found)


def test_each_question_on_a_phone(page: Page, address: str) -> None:
    page.set_viewport_size({"width": 390, "height": 844})
    page.goto(f"{address}/")
    for question in ON_A_PHONE:
        clicks = 2  # the list of questions, and one of them
        page.locator("#choose-question").select_option(question.name)
        if question.then:
            clicks += 1
            page.locator(question.then).click()
        answered(page, question)
        assert clicks <= MAX_CLICKS


def test_a_question_asked_before_the_scenes_are_known_is_answered_then(
    page: Page, address: str
) -> None:
    held: list[Route] = []
    page.route("**/scenes", lambda route: held.append(route))
    with page.expect_request("**/scenes"):
        page.goto(f"{address}/")
    page.locator("#question-hop").click()
    [asked] = held
    asked.continue_()
    expect(page.locator("#answer .answer")).to_contain_text("0.149")
    expect(page.locator("#question-hop")).to_have_attribute("aria-current", "true")


TARGETS = """() => [...document.querySelectorAll("button, select, input, summary, footer a")]
  .filter((one) => one.type !== "checkbox")
  .map((one) => ({ box: one.getBoundingClientRect(), html: one.outerHTML.slice(0, 90) }))
  .filter(({ box }) => box.width && (box.width < 44 || box.height < 44))
  .map(({ box, html }) => `${box.width} x ${box.height}: ${html}`)"""


def test_on_a_phone_each_target_takes_a_finger(page: Page, address: str) -> None:
    """44 px is what WCAG 2.5.5 and phones' makers ask for."""
    page.set_viewport_size({"width": 390, "height": 844})
    for question in ("speed", "drive", "measured", "waves", "rows"):
        page.goto(f"{address}/#question={question}")
        expect(page.locator(f"#choose-question option[value={question}]:checked")).to_have_count(1)
        settled(page)
        assert page.evaluate(TARGETS) == []


def tabbed(page: Page, to: str, most: int = 60) -> None:
    """Press Tab until an element has the focus."""
    for _ in range(most):
        page.keyboard.press("Tab")
        if page.evaluate("to => document.activeElement.matches(to)", to):
            return
    pytest.fail(f"{to} is not reached by Tab")


def test_each_question_by_keys_alone(page: Page, address: str) -> None:
    page.set_viewport_size({"width": 1440, "height": 900})
    page.goto(f"{address}/")
    for question in BY_KEYS:
        page.locator("#skip").focus()  # where a page begins
        tabbed(page, f"#question-{question.name}")
        page.keyboard.press("Enter")
        if question.then:
            expect(page.locator(question.then)).to_be_visible()
            tabbed(page, question.then)
            page.keyboard.press("Enter")
        answered(page, question)
