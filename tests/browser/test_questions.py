"""Each question from an empty page to its answer: at a desk, on a phone, by keys, on paper."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Locator, Page, Route, expect

from audit import audited
from looking import NUMBER, SENTENCE, opened, pressed, settled, shows
from waiting import wait_for

ANSWERS = {
    "speed": ("49.9", "41 to 58 mm/s for friction 0.2 to 0.4; hops 0.15"),
    "hop": ("0.149", "In the air for 66 % of a cycle; lifts off above 0.29"),
    "drive": ("300", "300 mm/s for friction 0.2 to 0.4; hops 0.63"),
    "uncertain": ("41 to 58", "For friction 0.2 to 0.4; the friction matters most"),
    "measured": ("0.27", "with 95 %; the measured speeds differ from the curve by"),
    "waves": ("56", "times the speed with a sine of the same amplitudes; slides."),
    "springs": ("1.04", "At 50\u00a0Hz; the springs are tuned to 52"),
    "rows": ("22.3", "3 platoons, the rear one of 1 part"),
    "resting": ("65 %", "65 to 86 % by two estimates."),
    "orienting": ("194", "194 to 258 a minute by two estimates"),
    "plate": ("11.4", "11 to 12 mm/s for friction 0.2 to 0.4"),
    "thesis": ("55.75", "Acceleration along the track: the part has left the floor."),
    "all": ("46.37", "Acceleration along the track: the part has left the floor."),
}
PRINTED = ("speed", "drive", "resting")
PHONE = {"width": 390, "height": 844}
SHIFTS = """
window.shifted = 0;
new PerformanceObserver((list) => {
  for (const entry of list.getEntries()) if (!entry.hadRecentInput) window.shifted += entry.value;
}).observe({ type: "layout-shift", buffered: true });
"""
MAX_SHIFT = 0.1  # what the Web Vitals call good
BOXES = """() => [...document.querySelectorAll("#host .map canvas, #host .map .axes .frame")]
  .map((one) => one.getBoundingClientRect()).map((box) => [box.x, box.y, box.width, box.height])"""
# 44 px are what WCAG 2.5.5 and phones' makers ask for.
TOO_SMALL = """() => [...document.querySelectorAll("button, select, input, summary, footer a")]
  .filter((one) => one.type !== "checkbox")
  .map((one) => ({ box: one.getBoundingClientRect(), html: one.outerHTML.slice(0, 90) }))
  .filter(({ box }) => box.width && (box.width < 44 || box.height < 44))
  .map(({ box, html }) => `${box.width} x ${box.height}: ${html}`)"""


def answered(page: Page, question: str, *schemes: str) -> None:
    """Assert that a question has its answer, and that nothing stands in anybody's way."""
    answer, sentence = ANSWERS[question]
    shows(page, {NUMBER: answer, SENTENCE: sentence})
    settled(page)
    expect(page.locator("#answer")).not_to_have_class(re.compile("failed|odd"))
    expect(page.locator("#notice")).to_be_empty()
    assert "".join(page.locator(".unusual").all_inner_texts()) == ""
    width = page.evaluate("document.documentElement.scrollWidth")
    assert width <= page.evaluate("innerWidth")
    for scheme in schemes:
        page.emulate_media(color_scheme=scheme)
        assert audited(page) == [], scheme


def in_sight(page: Page, found: Locator, bottom: float = PHONE["height"]) -> None:
    """Assert that an element is on the screen as it stands, without any scrolling."""
    assert page.evaluate("scrollY") == 0
    box = wait_for(found.bounding_box)  # what is being drawn anew has none for a moment
    assert box is not None
    assert box["y"] >= 0
    assert box["y"] + box["height"] <= bottom


@pytest.mark.parametrize("question", ANSWERS)
def test_each_question_is_answered_on_top(page: Page, address: str, question: str) -> None:
    page.add_init_script(SHIFTS)
    page.set_viewport_size({"width": 1440, "height": 900})
    opened(page, f"{address}/#question={question}")
    answered(page, question)
    assert page.evaluate("window.shifted") < MAX_SHIFT  # before the audits change colours
    answered(page, question, "light", "dark")
    for place in (NUMBER, SENTENCE):
        in_sight(page, page.locator(place), bottom=300)
    if question in PRINTED:
        page.emulate_media(media="print")
        page.set_viewport_size({"width": 690, "height": 1000})  # of paper; nobody redraws anything
        page.locator("#sheet").wait_for()
        canvas, frame = page.evaluate(BOXES)
        assert canvas == pytest.approx(frame, abs=1)
        for place in ("nav", "#controls", "#expert", "header"):
            assert not page.locator(place).is_visible()
        shows(page, {"#sheet": page.url})
        assert page.pdf(prefer_css_page_size=True).count(b"/Type /Page\n") == 1


def test_each_question_on_a_phone(page: Page, address: str) -> None:
    """The list of questions and one of them are two clicks; a third one asks further."""
    page.add_init_script(SHIFTS)
    page.set_viewport_size(PHONE)
    opened(page, address)
    assert page.evaluate("window.shifted") < MAX_SHIFT
    for place in (NUMBER, "#stage", "[data-name=amplitude]"):
        in_sight(page, page.locator(place))
    for question in list(ANSWERS)[:-1]:
        page.locator("#choose-question").select_option(question)
        answered(page, question, "light")
        in_sight(page, page.locator(NUMBER))
        assert page.evaluate(TOO_SMALL) == [], question
        if question in ("hop", "springs", "rows"):
            in_sight(page, page.locator(SENTENCE))
        if question == "uncertain":
            in_sight(page, page.locator("#matters li", has_text="Friction").first)
        if question == "drive":
            page.locator("#chip-still").click()
            shows(page, {NUMBER: "20.6"})
            in_sight(page, page.locator(NUMBER))
    page.locator("#choose-question").select_option("speed")
    expect(page.locator("#picture")).to_be_hidden()
    page.locator("#tab-picture").click()
    expect(page.locator("#stage")).to_be_hidden()
    expect(page.locator("#picture .map canvas")).to_be_visible()
    page.locator("#tab-detail").click()
    expect(page.locator(".panels")).to_be_visible()
    page.mouse.wheel(0, 600)
    expect(page.locator(NUMBER)).to_be_in_viewport()  # it stays


def tabbed(page: Page, to: str) -> None:
    """Press Tab until an element has the focus."""
    for _ in range(60):
        page.keyboard.press("Tab")
        if page.evaluate("to => document.activeElement.matches(to)", to):
            return
    pytest.fail(f"{to} is not reached by Tab")


def test_a_question_is_asked_by_keys_alone(page: Page, address: str) -> None:
    opened(page, address)
    link = page.url
    pressed(page, "#skip", "Enter")
    assert page.evaluate("document.activeElement.id") == "headline"
    assert page.url == link
    page.locator("#skip").focus()  # where a page begins
    for place in ("#question-drive", "#chip-still"):
        page.locator(place).wait_for()
        tabbed(page, place)
        page.keyboard.press("Enter")
        settled(page)
    shows(page, {NUMBER: "20.6"})


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
    shows(page, {NUMBER: "0.149"})
    expect(page.locator("#question-hop")).to_have_attribute("aria-current", "true")


def test_the_figures_of_the_thesis_and_every_output(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=thesis")
    shows(page, {"#figures": "Verdict", "#note": "the part has left the floor"})
    assert page.locator("#choose-figure option").count() == 32
    page.locator("#choose-figure").select_option("fig-5-22")
    shows(page, {"#figures": "It is zero where the"})
    settled(page)
    assert page.locator("#values tr").count() > 10
    page.locator("#choose-figure").select_option("")
    expect(page.locator("#headline")).to_have_text("Every output")


def test_a_search_that_is_left_moves_no_other_design(page: Page, address: str) -> None:
    held: list[Route] = []
    page.route(re.compile("/optimise/"), lambda route: held.append(route))
    page.goto(f"{address}/#question=drive")
    shows(page, {"#chips": "searching"})
    wait_for(lambda: held)
    page.locator("#question-resting").click()
    settled(page)
    before = page.url, page.locator(NUMBER).inner_text()
    for route in held:
        route.continue_()
    page.wait_for_timeout(500)
    settled(page)
    assert (page.url, page.locator(NUMBER).inner_text()) == before
