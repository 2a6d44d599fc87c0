"""A newcomer asks each question: the answer stands on the first screen, after three clicks."""

from __future__ import annotations

import re
from dataclasses import dataclass

import pytest
from playwright.sync_api import Locator, Page, Route, expect

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
    Question("speed", "#part .answer strong", "49.92 mm/s"),
    Question("hop", "#part .answer strong", "Hops 0.149 mm high"),
    Question("drive", "#extra .finding strong", "Best: amplitude 1 mm"),
    Question("drive", "#extra .finding", "20.65", then="#below-throw_number"),
    Question("uncertain", "#extra .matters li", "Friction coefficient"),
    Question("uncertain", "#part .answer .band", "with the friction coefficient known"),
    Question("measured", "#extra .finding strong", "Friction coefficient 0.", then="#find-unknown"),
    Question("waves", "#part .answer strong", "55.99 mm/s"),
    Question("springs", "#headline", "Amplitude of the track"),
    Question("rows", "#part .more", "3 platoons"),
    Question("resting", "#headline", "Share that rests upright"),
    Question("orienting", "#headline", "Oriented feed rate"),
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
    picture = page.locator("#host .map, #host .curves")
    expect(picture).to_be_visible()
    box, size = wait_for(picture.bounding_box), page.viewport_size
    assert box is not None
    assert size is not None
    # Of the picture at least the half that matters to the eye is on the screen, too.
    assert box["y"] + 0.5 * box["height"] <= size["height"]


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
    expect(page.locator("#part .answer strong")).to_contain_text("Hops 0.149")
    expect(page.locator("#question-hop")).to_have_attribute("aria-current", "true")


def test_a_row_moves_in_its_lane_and_tells_which_parts_touch(page: Page, address: str) -> None:
    page.goto(f"{address}/#question=rows")
    said = page.locator("#detail .said")
    expect(said).to_contain_text("Parts 1 to 4 touch. Mean speed 22.34")
    expect(page.locator("#detail .legend li")).to_have_count(4)
    assert page.locator("#detail .touching").count() > 3  # they meet again
    panels = page.locator("#detail .panels")
    panels.press("End")
    expect(said).not_to_contain_text("1 to 4")
    expect(panels).to_have_attribute("aria-valuetext", re.compile("ms, (no )?parts .*touch$"))


TARGETS = """() => [...document.querySelectorAll("button, select, input, summary, footer a")]
  .map((one) => (one.type === "checkbox" ? one.parentElement : one))
  .map((one) => ({ box: one.getBoundingClientRect(), html: one.outerHTML.slice(0, 90) }))
  .filter(({ box }) => box.width && (box.width < 44 || box.height < 44))
  .map(({ box, html }) => `${box.width} x ${box.height}: ${html}`)"""


def test_on_a_phone_each_target_takes_a_finger(page: Page, address: str) -> None:
    """44 px is what WCAG 2.5.5 and phones' makers ask for."""
    page.set_viewport_size({"width": 390, "height": 844})
    for question in ("speed", "drive", "measured", "waves", "rows"):
        page.goto(f"{address}/#question={question}")
        expect(page.locator(f"#choose-question option[value={question}]:checked")).to_have_count(1)
        expect(page.locator("#progress")).to_contain_text("Shown after")
        expect(page.locator("#away button").first).to_be_visible()
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


def test_a_point_is_moved_and_a_motion_scrubbed_by_keys_and_pointer(
    page: Page, address: str
) -> None:
    page.set_viewport_size({"width": 1440, "height": 900})
    page.goto(f"{address}/")
    speed = page.locator("#part .answer strong")
    expect(speed).to_have_text("49.92\u00a0mm/s")
    in_sight(page, page.locator("#detail .panels"))
    in_sight(page, page.locator("#detail canvas.side"))
    # A moment is chosen by keys, then by dragging over the curves.
    panels = page.locator("#detail .panels")
    panels.focus()
    for _ in range(40):
        page.keyboard.press("ArrowRight")
    expect(panels).to_have_attribute("aria-valuetext", "8 ms, the part hops")
    box = panels.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.99 * box["width"], box["y"] + 0.5 * box["height"], steps=3)
    page.mouse.up()
    expect(panels).to_have_attribute("aria-valuenow", "100")
    # The ring is dragged: field and answer follow while it is held, the address when it is let go.
    ring = page.locator("#host .dragged .grip").bounding_box()
    assert ring is not None
    x, y = ring["x"] + 0.5 * ring["width"], ring["y"] + 0.5 * ring["height"]
    before = page.url
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 100, y, steps=4)
    expect(speed).not_to_have_text("49.92\u00a0mm/s")
    assert float(page.locator("#here-x").input_value()) > 0.6
    assert page.url == before
    page.mouse.up()
    expect(page).not_to_have_url(before)
    page.go_back()
    expect(speed).to_have_text("49.92\u00a0mm/s")


def test_up_to_four_designs_are_pinned_and_compared(page: Page, address: str) -> None:
    page.goto(f"{address}/")
    speed = page.locator("#part .answer strong")
    expect(speed).to_have_text("49.92\u00a0mm/s")
    pin = page.get_by_role("button", name="Pin")
    pin.click()
    row = page.locator("#pins tr", has_text="Conveying velocity")
    expect(row.locator("td")).to_have_text(["49.92", "49.92"])
    page.locator("#here-y").fill("30")
    page.locator("#here-y").press("Enter")
    expect(row.locator("td").first).to_have_text("49.92")
    expect(row.locator("td").last).not_to_have_text("49.92")
    expect(page.locator("#pins tr", has_text="Drive elevation").locator("td")).to_have_text(
        ["20", "30"]
    )
    for _ in range(5):
        pin.click()
    expect(row.locator("td")).to_have_count(5)
    page.reload()
    expect(row.locator("td")).to_have_count(5)
    page.get_by_role("button", name="Show design A").click()
    expect(speed).to_have_text("49.92\u00a0mm/s")
    page.get_by_role("button", name="Remove design D").click()
    expect(row.locator("td")).to_have_count(4)
