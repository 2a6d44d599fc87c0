"""Typed text counts as the number that was meant, or not at all; no picture shows other values."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

from night import count

FRICTION = "#value-friction"
NONSENSE = ("abc", "1e400", "", "0.3.1", "3 mm", "--")[: count(2, 6)]

NUMBERS = (
    (FRICTION, "friction", "0,35", 0.35),
    ("#value-frequency", "frequency", "3300 rpm", 55.0),
    ("#value-frequency", "frequency", "3000/60", 50.0),
    (FRICTION, "friction", "25 %", 0.25),
    ("#value-frequency", "frequency", "53,5", 53.5),
)[: count(2, 5)]


def settled(page: Page) -> None:
    expect(page.locator("#picture")).to_have_attribute("aria-busy", "false")


def opened(page: Page, address: str) -> None:
    page.goto(address)
    settled(page)
    expect(page.locator("#progress")).to_contain_text("Shown after")


def typed(page: Page, field: str, text: str) -> None:
    page.locator(field).fill(text)
    page.locator(field).press("Enter")
    settled(page)


def in_address(page: Page, name: str) -> float:
    """Return a parameter of the link; what has its default value stands there, too."""
    (value,) = re.findall(rf"p\.{name}=([^&]+)", page.url)
    return float(value)


def test_what_is_no_number_changes_nothing(page: Page, address: str) -> None:
    opened(page, address)
    before, said = page.url, page.locator(".field:has(#value-friction) [role=alert]")
    for nonsense in NONSENSE:
        typed(page, FRICTION, nonsense)
        assert page.locator(FRICTION).input_value() == "0.3", nonsense
        assert page.url == before, nonsense
        expect(said).to_contain_text("It stays 0.3.")
        for number in ("0.31", "0.3"):
            typed(page, FRICTION, number)
            expect(said).to_be_hidden()


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


def test_a_picture_of_other_values_is_dimmed(page: Page, address: str) -> None:
    opened(page, address)
    typed(page, FRICTION, "-1")
    expect(page.locator("#picture")).to_have_class(re.compile("stale"))
    expect(page.locator("#stale")).to_contain_text("Not drawn. Friction coefficient is -1.")
    assert page.locator("#stale button").count() == 0  # to compute it again would change nothing
    typed(page, FRICTION, "0.3")
    expect(page.locator("#picture")).not_to_have_class(re.compile("stale"))
    expect(page.locator("#stale")).to_be_empty()


def test_a_choice_keeps_the_focus_and_going_back_undoes_it(page: Page, address: str) -> None:
    opened(page, address)
    first = page.url
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


def test_a_job_begun_before_a_reload_is_followed_to_its_end(page: Page, address: str) -> None:
    opened(page, address)
    study = {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "outputs": ["conveying_velocity"],
        "parameters": {"frequency": 50, "amplitude": 0.0002, "beta": 30, "friction": 0.321},
    }
    job = page.evaluate(
        """async (study) => (await fetch("processes/simulate/execution", {
            method: "POST",
            headers: {"Content-Type": "application/json", Prefer: "respond-async"},
            body: JSON.stringify(study),
        })).json()""",
        study,
    )
    frozen = [{**job, "status": "running", "progress": 1, "message": "as it stood"}]
    page.evaluate(
        "(jobs) => sessionStorage.setItem('vibrafeed-jobs', JSON.stringify(jobs))", frozen
    )
    page.reload()
    line = page.locator("#jobs li").first
    expect(line.get_by_role("button", name="NetCDF")).to_be_visible()


def test_a_job_is_a_design_that_is_shown_again(page: Page, address: str) -> None:
    opened(page, address)
    typed(page, FRICTION, "0.35")
    before = page.url
    with page.expect_download():
        page.locator("#away").get_by_role("button", name="NetCDF").click()
    # On a busy machine the picture of another value is a job, too.
    named = page.locator("strong[title*='friction coefficient 0.35']")
    line = page.locator("#jobs li").filter(has=named).first
    expect(line).to_contain_text("Motion: conveying velocity over amplitude")
    expect(line).to_contain_text("The results are ready.")
    typed(page, FRICTION, "0.4")
    expect(page).not_to_have_url(before)
    line.get_by_role("button", name="Show").click()
    expect(page).to_have_url(before)
    settled(page)
    expect(page.locator(FRICTION)).to_have_value("0.35")
    page.reload()  # it is kept with its job
    expect(line.get_by_role("button", name="Show")).to_be_visible()


def test_the_same_design_is_told_by_its_amplitude_or_from_peak_to_peak(
    page: Page, address: str
) -> None:
    opened(page, address)
    speed = page.locator("#part .answer strong")
    expect(speed).to_have_text("49.92\u00a0mm/s")
    expect(page.locator("#here-x")).to_have_value("0.5")
    page.locator("#choose-amplitude").select_option("stroke")
    expect(page.locator("#here-x")).to_have_value("1")
    expect(speed).to_have_text("49.92\u00a0mm/s")
    expect(page.locator("#part .more")).to_contain_text("from peak to peak")
    settled(page)
    assert "x=peak_to_peak" in page.url
    assert "amplitude" not in page.url
    page.go_back()
    expect(page.locator("#here-x")).to_have_value("0.5")


def test_an_exact_point_is_typed_and_answered_in_one_line(page: Page, address: str) -> None:
    """2 pi 50 Hz, 0.35 mm, 25 degrees: throw number (A w^2/g) sin(beta) = 1.489."""
    opened(page, address)
    for field, text in (("#here-x", "0,35 mm"), ("#here-y", "25")):
        page.locator(field).fill(text)
        page.locator(field).press("Enter")
    answer = page.locator("#part")
    expect(answer).to_contain_text("hrow number 1.49 (lifts off at 0.235 mm of amplitude)")
    expect(answer).to_contain_text("Hopping")
    study = {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "outputs": ["conveying_velocity"],
        "parameters": {"frequency": 50, "amplitude": 0.35e-3, "beta": 25, "friction": 0.3},
    }
    reply = page.request.post(f"{address}/processes/simulate/execution", data=study).json()
    speed = reply["variables"]["conveying_velocity"]["data"]
    expect(answer).to_contain_text(f"{1e3 * speed:.4g}\u00a0mm/s")
    assert page.url.endswith("point=0.00035%3A25")
    typed(page, FRICTION, "0.4")
    expect(answer).not_to_contain_text(f"{1e3 * speed:.4g}\u00a0mm/s")


def test_ends_of_a_slider_are_typed_and_an_unusual_value_is_said(page: Page, address: str) -> None:
    opened(page, address)
    odd = page.locator("#unusual-friction")
    expect(odd).to_be_empty()
    slider = page.get_by_label("Friction coefficient, slider")
    upper = page.get_by_label("Upper end of the slider of friction coefficient")
    upper.fill("0,2")
    upper.press("Enter")  # the value, 0.3, is above it
    expect(page.locator(".slider [role=alert]")).to_contain_text(
        "The upper end of the slider has to be above the lower end"
    )
    upper.fill("0.32")
    upper.press("Enter")
    before = page.url
    slider.press("End")
    expect(page).not_to_have_url(before)
    assert in_address(page, "friction") == pytest.approx(0.32)
    typed(page, FRICTION, "3")
    expect(odd).to_contain_text("Outside the usual")
    page.get_by_role("button", name="Everything").click()  # what was typed is kept
    settled(page)
    expect(upper).to_have_value("0.32")
