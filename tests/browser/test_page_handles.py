"""What is dragged: the line of vibration, the track, the ring, sliders; by pointer and by keys."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

from looking import (
    NUMBER,
    held,
    middle,
    number,
    opened,
    pressed,
    settled,
    speed,
    typed,
    value,
)

LINE = re.compile("Line of vibration")


def test_what_is_dragged_stays_under_the_pointer_and_going_back_undoes_it(
    page: Page, address: str
) -> None:
    opened(page, address)
    line = page.get_by_role("slider", name=LINE)
    expect(line).to_have_attribute("aria-valuetext", "0.5\u00a0mm, 20°")
    before = page.url
    knob = line.locator(".knob")
    x, y = middle(knob)
    with held(page, knob, 20, -30):
        expect(page.locator(NUMBER)).not_to_have_text("49.9")
        assert value(page, "amplitude") > 0.5
        assert value(page, "beta") > 25
        assert middle(knob) == pytest.approx((x + 20, y - 30), abs=4)
        assert page.url == before  # until it is let go
    expect(page).not_to_have_url(before)
    amplitude, beta = value(page, "amplitude") / 1e3, value(page, "beta")
    answer = speed(address, frequency=50, friction=0.3, amplitude=amplitude, beta=beta)
    assert number(page) == pytest.approx(answer, rel=6e-3)
    page.go_back()
    expect(page.locator(NUMBER)).to_have_text("49.9")
    expect(line).to_have_attribute("aria-valuetext", "0.5\u00a0mm, 20°")
    # The ring is both axes of the map.
    settled(page)
    with held(page, page.locator("#host .dragged .grip"), 60, 0):
        expect(page.locator(NUMBER)).not_to_have_text("49.9")
        assert value(page, "amplitude") > 0.6
        assert page.url == before
    page.go_back()
    expect(page.locator(NUMBER)).to_have_text("49.9")
    pressed(page, "#picture .map", "ArrowRight", "Shift+ArrowUp", "Enter")
    settled(page)
    assert value(page, "beta") > 30
    # The right end of the track is its climb.
    with held(page, page.get_by_role("slider", name="Climb of the track").locator(".knob"), 0, -40):
        pass
    climb = value(page, "gamma")
    assert 5 <= climb <= 10
    expect(page.locator(".stage > g > g").first).to_have_attribute(
        "transform", re.compile(rf"rotate\(-{climb:g} ")
    )


def test_handles_are_moved_by_keys_and_escape_undoes_a_drag(page: Page, address: str) -> None:
    opened(page, address)
    line = page.get_by_role("slider", name=LINE)
    pressed(page, line, "ArrowRight", "Shift+ArrowUp")
    expect(line).to_have_attribute("aria-valuetext", "0.51\u00a0mm, 25°")
    expect(line).to_be_focused()
    slope = page.get_by_role("slider", name="Climb of the track", exact=True)
    pressed(page, slope, "Shift+ArrowUp")
    expect(slope).to_have_attribute("aria-valuetext", "climb 5°")
    settled(page)
    before = number(page)
    with held(page, line.locator(".knob"), 30, 10):
        page.keyboard.press("Escape")
    expect(line).to_have_attribute("aria-valuetext", "0.51\u00a0mm, 25°")
    assert number(page) == before


def test_the_path_of_an_ellipse_is_a_handle(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=waves")
    with held(page, page.get_by_role("slider", name=LINE).locator(".knob"), 20, -10):
        pass
    assert value(page, "amplitude_along_1") > 0.32
    assert value(page, "amplitude_normal_1") > 0.09
    expect(page.locator(NUMBER)).not_to_have_text("56")


def test_a_slider_marks_lift_off_and_a_crosshair_stays_where_it_was_put(
    page: Page, address: str
) -> None:
    """A drag shows another grid; before, the crosshair held its place in the old one."""
    opened(page, address)
    expect(page.locator("[data-name=amplitude] .lift")).to_have_text("hops above 0.29")
    expect(page.locator("[data-name=frequency] .lift")).to_have_text("hops above 38")
    with held(page, page.get_by_label("Amplitude, slider"), 50, 0):
        expect(page.locator(NUMBER)).not_to_have_text("49.9")
        taken = value(page, "amplitude")
    assert value(page, "amplitude") == pytest.approx(taken)
    typed(page, "#value-amplitude", "3")  # beyond the end: slider and map reach beyond it
    expect(page.locator("[data-name=amplitude] .high")).to_have_text("3.6")

    box = page.locator("#host .map").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + 0.9 * box["width"], box["y"] + 0.2 * box["height"])
    lines = page.locator("#host .cursor line")
    expect(lines).to_have_count(2)

    def crossing() -> list[float]:
        found = lines.evaluate_all("all => [all[0].getAttribute('x1'), all[1].getAttribute('y1')]")
        return [float(one) for one in found]

    before = crossing()
    with held(page, page.get_by_label("Frequency, slider"), 40, 0):
        settled(page)
        assert crossing() == pytest.approx(before, abs=0.6)  # px; held: the map is a coarse one
    assert crossing() == pytest.approx(before, abs=0.6)
