"""The page at /: its questions, each from an empty page to the answer of the service."""

from __future__ import annotations

import csv
import re

import pytest
from playwright.sync_api import Page, expect

from audit import audited
from looking import (
    NUMBER,
    SENTENCE,
    numbers,
    opened,
    posted,
    revealed,
    settled,
    taken_away,
    typed,
)
from night import spread
from waiting import wait_for

TRACK = (
    "#question=speed&kind=simulate&scene=rectangle-on-plane&output=conveying_velocity"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4"
)
ANSWERS = {
    "speed": ("49.9", "41 to 58 mm/s for friction 0.2 to 0.4; hops 0.15"),
    "hop": ("0.149", "In the air for 66 % of a cycle; lifts off above 0.29"),
    "drive": ("300", "300 mm/s for friction 0.2 to 0.4; hops 0.63"),
    "uncertain": ("41 to 58", "For friction 0.2 to 0.4; the friction coefficient matters most"),
    "measured": ("0.27", "with 95 %; the measured speeds differ from the curve by"),
    "waves": ("56", "times the speed with a sine of the same amplitudes; slides."),
    "springs": ("1.04", "At 50\u00a0Hz; the springs are tuned to 52"),
    "rows": ("22.3", "3 platoons, the rear one of 1 part"),
    "resting": ("65 %", "65 to 86 % by two estimates."),
    "orienting": ("194", "194 to 258 a minute by two estimates"),
    "thesis": ("55.75", "Acceleration along the track: the part has left the floor."),
    "all": ("46.37", "Acceleration along the track: the part has left the floor."),
}


def at_cursor(page: Page, moves: str = "") -> str:
    """Return what the page says at the middle of its map, after some moves of the cursor."""
    page.locator("#picture .map").focus()
    for key in ["ArrowRight", *moves.split()]:
        page.keyboard.press(key)
    return page.locator("#picture .said").inner_text()


@pytest.mark.parametrize("question", spread(ANSWERS, len(ANSWERS)))
def test_each_question_is_answered_on_top(page: Page, address: str, question: str) -> None:
    opened(page, f"{address}/#question={question}")
    number, sentence = ANSWERS[question]
    expect(page.locator(SENTENCE)).to_contain_text(sentence)
    expect(page.locator(NUMBER)).to_contain_text(number)
    expect(page.locator("#answer")).not_to_have_class(re.compile("failed|odd"))
    expect(page.locator("#notice")).to_be_empty()
    for place in (NUMBER, SENTENCE):
        box = page.locator(place).bounding_box()
        assert box is not None
        assert box["y"] + box["height"] < 300


def test_map_cursor_motion_and_table_are_those_of_the_service(page: Page, address: str) -> None:
    page.emulate_media(reduced_motion="no-preference")
    opened(page, f"{address}/{TRACK}")
    amplitude, beta, velocity = numbers(at_cursor(page))[:3]
    parameters = {"frequency": 50, "friction": 0.4, "amplitude": amplitude / 1e3, "beta": beta}
    study = {"kind": "simulate", "scene": "rectangle-on-plane", "parameters": parameters}
    answer = posted(address, study)["conveying_velocity"]["data"]
    assert velocity == pytest.approx(answer * 1e3, rel=5e-3)  # four digits of each are shown
    page.keyboard.press("Enter")
    expect(page.locator(NUMBER)).to_have_text(f"{1e3 * answer:.3g}")
    now = page.locator("#detail .now")
    moment = now.get_attribute("x1")
    wait_for(lambda: now.get_attribute("x1") != moment)  # it plays
    page.get_by_role("button", name="Pause").click()
    panels = page.locator(".panels")
    before = now.get_attribute("x1")
    panels.press("ArrowRight")
    assert now.get_attribute("x1") != before
    rows = list(csv.DictReader(taken_away(page, "Table (CSV)").path().read_text().splitlines()))
    near = min(
        rows,
        key=lambda row: (
            abs(float(row["amplitude [m]"]) * 1e3 - amplitude)
            + abs(float(row["beta [degree]"]) - beta)
        ),
    )
    assert float(near["conveying_velocity [m s-1]"]) * 1e3 == pytest.approx(velocity, rel=5e-3)


def test_the_figures_of_the_thesis_and_every_output(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=thesis")
    expect(page.locator("#figures")).to_contain_text("Verdict")
    expect(page.locator("#note")).to_contain_text("the part has left the floor")
    assert page.locator("#choose-figure option").count() == 32
    page.locator("#choose-figure").select_option("fig-5-22")
    expect(page.locator("#figures")).to_contain_text("It is zero where the")
    settled(page)
    assert page.locator("#values tr").count() > 10
    page.locator("#choose-figure").select_option("")
    expect(page.locator("#headline")).to_have_text("Every output")


def test_everything_follows_a_slider_and_a_link_restores_it(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=all")
    before = at_cursor(page)
    slider = page.get_by_label("Frequency, slider")
    slider.focus()
    for _ in range(10):
        page.keyboard.press("ArrowRight")
    taken = page.locator("#value-frequency").input_value()
    page.wait_for_url(re.compile(rf"p\.frequency={re.escape(taken)}(&|$)"))
    settled(page)
    after = at_cursor(page, "ArrowLeft")
    assert numbers(after)[2] != numbers(before)[2]
    number, link = page.locator(NUMBER).inner_text(), page.url
    opened(page, link)
    assert at_cursor(page) == after
    expect(page.locator(NUMBER)).to_have_text(number)


def test_skipping_keeps_the_view(page: Page, address: str) -> None:
    opened(page, f"{address}/{TRACK}")
    link = page.url
    page.locator("#skip").focus()
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "headline"
    assert page.url == link


def test_friction_is_chosen_from_published_values_with_its_range(page: Page, address: str) -> None:
    opened(page, f"{address}/{TRACK.replace('&y=beta:5:60', '&y=&p.beta=30')}")
    revealed(page, "#published-friction")
    page.locator("#published-friction").select_option(label="steel on steel, dry: 0.08 to 0.5")
    expect(page.locator(SENTENCE)).to_contain_text("for friction 0.08 to 0.5")
    expect(page.locator("#part summary")).to_contain_text("steel on steel")
    assert page.locator("#value-friction").input_value() == "0.29"
    settled(page)
    page.locator("#picture .curves").hover()
    expect(page.locator("#picture .said")).to_have_text(re.compile(r"\(.* to .*\)"))
    typed(page, "#value-friction", "0.3")
    expect(page.locator("#part summary")).not_to_contain_text("steel on steel")


def test_a_row_moves_in_its_lane_and_tells_which_parts_touch(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=rows")
    expect(page.locator("#moment")).to_have_text("Parts 1 to 4 touch.")
    assert page.locator("#detail .touching").count() > 3  # they meet again
    panels = page.locator("#detail .panels")
    panels.press("End")
    expect(page.locator("#moment")).not_to_contain_text("1 to 4")
    expect(panels).to_have_attribute("aria-valuetext", re.compile("ms, (no )?parts .*touch$"))


def test_measured_runs_are_pasted_and_what_explains_them_is_taken(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=measured")
    page.locator("#runs").fill("0.1\t3.5\n0.2\tfast")
    page.locator("#runs").press("Tab")
    expect(page.locator("#measured .wrong")).to_contain_text("is not a number")
    page.locator("#runs").fill("0.1\t3.0\n0.2 7.0\n0.3;18")
    page.locator("#runs").press("Tab")
    expect(page).to_have_url(re.compile("runs=0.0001%3A0.003%2C"))
    settled(page)
    found = page.locator(NUMBER).inner_text()
    page.get_by_role("button", name=f"Use {found} as").click()
    settled(page)
    assert float(page.locator("#value-friction").input_value()) == pytest.approx(
        float(found), rel=2e-3
    )
    expect(page.locator("#answer .actions button")).to_have_count(0)


def test_designs_are_kept_and_compared(page: Page, address: str) -> None:
    opened(page, address)
    page.locator("#keep").click()
    row = page.locator("#pins tr", has_text="Conveying velocity")
    expect(row.locator("td")).to_have_text(["49.92", "49.92"])
    typed(page, "#value-beta", "30")
    expect(row.locator("td").first).to_have_text("49.92")
    expect(row.locator("td").last).not_to_have_text("49.92")
    for angle in range(31, 36):
        typed(page, "#value-beta", str(angle))
        page.locator("#keep").click()
    expect(row.locator("td")).to_have_count(5)
    page.reload()
    expect(row.locator("td")).to_have_count(5)
    page.get_by_role("button", name="Show design A").click()
    expect(page.locator(NUMBER)).to_have_text("49.9")
    page.get_by_role("button", name="Remove design D").click()
    expect(row.locator("td")).to_have_count(4)


@pytest.mark.parametrize("question", spread(ANSWERS, 3))
def test_nothing_stands_in_the_way_of_anybody(page: Page, address: str, question: str) -> None:
    for width, height in ((1280, 900), (390, 800)):
        page.set_viewport_size({"width": width, "height": height})
        opened(page, f"{address}/#question={question}")
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            assert audited(page) == [], (width, scheme)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
