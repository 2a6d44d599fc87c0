"""Typed text counts as the number that was meant, or not at all; no picture shows other values."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

from looking import NUMBER, SENTENCE, opened, posted, revealed, settled, taken_away, typed
from night import count

FRICTION = "#value-friction"
NONSENSE = ("abc", "1e400", "", "0.3.1", "3 mm", "--")[: count(2, 6)]

NUMBERS = (
    (FRICTION, "friction", "0,35", 0.35),
    ("#value-frequency", "frequency", "55 hz", 55.0),
    ("#value-frequency", "frequency", "3300 RPM", 55.0),
    ("#value-frequency", "frequency", "3000/60", 50.0),
    (FRICTION, "friction", "25 %", 0.25),
    ("#value-frequency", "frequency", "53,5", 53.5),
)[: count(2, 5)]


def in_address(page: Page, name: str) -> float:
    """Return a parameter of the link; what has its default value stands there, too."""
    (value,) = re.findall(rf"p\.{name}=([^&]+)", page.url)
    return float(value)


def test_what_is_no_number_changes_nothing(page: Page, address: str) -> None:
    opened(page, address)
    before, said = page.url, page.locator(".field:has(#value-friction) [role=alert]")
    for nonsense in NONSENSE:
        typed(page, FRICTION, nonsense)
        assert page.locator(FRICTION).input_value() == nonsense
        assert page.url == before, nonsense
        expect(said).to_contain_text("0.3 holds until it is corrected.")
        for number in ("0.31", "0.3"):
            typed(page, FRICTION, number)
            expect(said).to_be_hidden()
        before = page.url


def test_numbers_as_people_type_them(page: Page, address: str) -> None:
    opened(page, address)
    for field, name, text, value in NUMBERS:
        typed(page, field, "0.31" if name == "friction" else "49")
        typed(page, field, text)
        assert in_address(page, name) == pytest.approx(value, rel=1e-12)
        assert float(page.locator(field).input_value()) == pytest.approx(value, rel=1e-5)
        slider = page.locator(f".field:has({field}) input[type=range]")
        spoken = slider.get_attribute("aria-valuetext")
        assert spoken is not None
        assert float(re.sub(r"[^\d.]", "", spoken)) == pytest.approx(value, rel=1e-3)


def test_arrow_keys_change_the_last_digit(page: Page, address: str) -> None:
    opened(page, address)
    revealed(page, FRICTION)
    page.locator(FRICTION).press("ArrowUp")
    settled(page)
    assert in_address(page, "friction") == pytest.approx(0.4)


def test_a_crosshair_stays_where_it_was_put(page: Page, address: str) -> None:
    """A drag shows another grid; before, the crosshair held its place in the old one."""
    opened(page, address)
    box = page.locator("#host .map").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + 0.9 * box["width"], box["y"] + 0.2 * box["height"])
    lines = page.locator("#host .cursor line")
    expect(lines).to_have_count(2)

    def crossing() -> tuple[float, float]:
        return float(lines.nth(0).get_attribute("x1") or 0), float(
            lines.nth(1).get_attribute("y1") or 0
        )

    before = crossing()
    slider = page.get_by_label("Frequency, slider")
    thumb = slider.bounding_box()
    assert thumb is not None
    x, y = thumb["x"] + 0.5 * thumb["width"], thumb["y"] + 0.5 * thumb["height"]
    page.mouse.move(x, y)
    page.mouse.down()
    for step in range(1, 6):
        page.mouse.move(x + 8 * step, y)
        settled(page)
        assert crossing() == pytest.approx(before, abs=0.6)  # px; held: the map is a coarse one
    page.mouse.up()
    settled(page)
    assert crossing() == pytest.approx(before, abs=0.6)


def test_a_choice_keeps_the_focus_and_going_back_undoes_it(page: Page, address: str) -> None:
    opened(page, address)
    first = page.url
    revealed(page, "#choose-output")
    page.locator("#choose-output").focus()
    page.locator("#choose-output").select_option("hop_height")
    settled(page)
    assert page.evaluate("document.activeElement.id") == "choose-output"
    typed(page, FRICTION, "0.4")
    page.go_back()
    settled(page)
    expect(page.locator(FRICTION)).to_have_value("0.3")
    expect(page.locator("#choose-output")).to_have_value("hop_height")
    page.go_back()
    settled(page)
    expect(page.locator("#choose-output")).to_have_value("conveying_velocity")
    assert page.url == first


def test_a_job_is_a_design_that_is_shown_again(page: Page, address: str) -> None:
    opened(page, address)
    typed(page, FRICTION, "0.35")
    before = page.url
    taken_away(page, "NetCDF")
    # On a busy machine the picture of another value is a job, too.
    named = page.locator("b[title*='friction coefficient 0.35']")
    line = page.locator("#jobs li").filter(has=named).first
    expect(line).to_contain_text("Motion: conveying velocity over amplitude")
    expect(line).to_contain_text("The results are ready.")
    typed(page, FRICTION, "0.4")
    expect(page).not_to_have_url(before)
    revealed(page, "#jobs")
    line.get_by_role("button", name="Show").click()
    expect(page).to_have_url(before)
    settled(page)
    expect(page.locator(FRICTION)).to_have_value("0.35")


def test_the_same_design_is_told_by_its_amplitude_or_from_peak_to_peak(
    page: Page, address: str
) -> None:
    opened(page, address)
    expect(page.locator(NUMBER)).to_have_text("49.9")
    revealed(page, "#choose-amplitude")
    page.locator("#choose-amplitude").select_option("stroke")
    expect(page.locator("#value-peak_to_peak")).to_have_value("1")
    settled(page)
    expect(page.locator(NUMBER)).to_have_text("49.9")
    assert "x=peak_to_peak" in page.url
    assert "amplitude" not in page.url
    page.go_back()
    expect(page.locator("#value-amplitude")).to_have_value("0.5")


def test_an_exact_point_is_typed_and_answered_in_one_line(page: Page, address: str) -> None:
    """2 pi 50 Hz, 0.35 mm, 25 degrees: throw number (A w^2/g) sin(beta) = 1.489."""
    opened(page, f"{address}/#question=hop")
    typed(page, "#value-amplitude", "0,35 mm")
    typed(page, "#value-beta", "25")
    expect(page.locator(SENTENCE)).to_contain_text("throw number 1.49")
    expect(page.locator(SENTENCE)).to_contain_text("lifts off above 0.24\u00a0mm of amplitude")
    page.locator("#question-speed").click()
    settled(page)
    opened(page, f"{address}/#question=speed&p.amplitude=0.00035&p.beta=25&p.friction=0.3")
    parameters = {"frequency": 50, "amplitude": 0.35e-3, "beta": 25, "friction": 0.3}
    study = {"kind": "simulate", "scene": "rectangle-on-plane", "parameters": parameters}
    speed = posted(address, study)["conveying_velocity"]["data"]
    expect(page.locator(NUMBER)).to_have_text(f"{1e3 * speed:.3g}")


def test_a_link_of_before_with_a_point_is_the_same_design(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=speed&x=amplitude:0.0001:0.001&y=beta:0:60&point=0.0003:30")
    assert page.locator("#value-amplitude").input_value() == "0.3"
    assert page.locator("#value-beta").input_value() == "30"
    assert "point" not in page.url
