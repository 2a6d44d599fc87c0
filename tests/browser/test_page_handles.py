"""What is dragged: the line of vibration, the track, the ring, sliders; by pointer and by keys."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Locator, Page, expect

from looking import NUMBER, opened, posted, settled, typed


def middle(found: Locator) -> tuple[float, float]:
    box = found.bounding_box()
    assert box is not None
    return box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]


def value(page: Page, name: str) -> float:
    return float(page.locator(f"#value-{name}").input_value())


def test_the_line_of_vibration_is_amplitude_and_angle(page: Page, address: str) -> None:
    opened(page, address)
    line = page.get_by_role("slider", name=re.compile("Line of vibration"))
    expect(line).to_have_attribute("aria-valuetext", "0.5\u00a0mm, 20°")
    x, y = middle(line.locator(".knob"))
    before = page.url
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 20, y - 30, steps=6)
    expect(page.locator(NUMBER)).not_to_have_text("49.9")
    assert value(page, "amplitude") > 0.5
    assert value(page, "beta") > 25
    at = middle(line.locator(".knob"))
    assert at == pytest.approx((x + 20, y - 30), abs=4)  # it stays under the pointer
    assert page.url == before  # until it is let go
    page.mouse.up()
    expect(page).not_to_have_url(before)
    settled(page)
    amplitude, beta = value(page, "amplitude"), value(page, "beta")
    parameters = {"frequency": 50, "friction": 0.3, "amplitude": amplitude / 1e3, "beta": beta}
    study = {"kind": "simulate", "scene": "rectangle-on-plane", "parameters": parameters}
    answer = 1e3 * posted(address, study)["conveying_velocity"]["data"]
    assert float(page.locator(NUMBER).inner_text()) == pytest.approx(answer, rel=6e-3)
    page.go_back()
    expect(page.locator(NUMBER)).to_have_text("49.9")
    expect(line).to_have_attribute("aria-valuetext", "0.5\u00a0mm, 20°")


def test_handles_are_moved_by_keys_and_escape_undoes_a_drag(page: Page, address: str) -> None:
    opened(page, address)
    line = page.get_by_role("slider", name=re.compile("Line of vibration"))
    line.focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowUp")
    expect(line).to_have_attribute("aria-valuetext", "0.51\u00a0mm, 25°")
    expect(line).to_be_focused()
    slope = page.get_by_role("slider", name="Climb of the track")
    slope.focus()
    page.keyboard.press("Shift+ArrowUp")
    expect(slope).to_have_attribute("aria-valuetext", "climb 5°")
    settled(page)
    speed = page.locator(NUMBER).inner_text()
    x, y = middle(line.locator(".knob"))
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 30, y + 10, steps=3)
    page.keyboard.press("Escape")
    page.mouse.up()
    settled(page)
    expect(line).to_have_attribute("aria-valuetext", "0.51\u00a0mm, 25°")
    expect(page.locator(NUMBER)).to_have_text(speed)


def test_the_path_of_an_ellipse_is_a_handle(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=waves")
    path = page.get_by_role("slider", name=re.compile("Line of vibration"))
    x, y = middle(path.locator(".knob"))
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 20, y - 10, steps=4)
    page.mouse.up()
    settled(page)
    assert value(page, "amplitude_along_1") > 0.32
    assert value(page, "amplitude_normal_1") > 0.09
    expect(page.locator(NUMBER)).not_to_have_text("56")


def test_the_track_is_tilted(page: Page, address: str) -> None:
    opened(page, address)
    slope = page.get_by_role("slider", name="Climb of the track")
    x, y = middle(slope.locator(".knob"))
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y - 40, steps=4)
    page.mouse.up()
    settled(page)
    climb = value(page, "gamma")
    assert 5 <= climb <= 10
    expect(page.locator(".stage > g > g").first).to_have_attribute(
        "transform", re.compile(rf"rotate\(-{climb:g} ")
    )


def test_the_ring_is_both_axes_of_the_map(page: Page, address: str) -> None:
    opened(page, address)
    x, y = middle(page.locator("#host .dragged .grip"))
    before = page.url
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 60, y, steps=4)
    expect(page.locator(NUMBER)).not_to_have_text("49.9")
    assert value(page, "amplitude") > 0.6
    assert page.url == before
    page.mouse.up()
    settled(page)
    page.go_back()
    expect(page.locator(NUMBER)).to_have_text("49.9")
    page.locator("#picture .map").focus()
    for key in ("ArrowRight", "Shift+ArrowUp", "Enter"):
        page.keyboard.press(key)
    settled(page)
    assert value(page, "beta") > 30


def test_a_slider_marks_lift_off_and_is_dragged(page: Page, address: str) -> None:
    opened(page, address)
    expect(page.locator("[data-name=amplitude] .lift")).to_have_text("hops above 0.29")
    expect(page.locator("[data-name=frequency] .lift")).to_have_text("hops above 38")
    slider = page.get_by_label("Amplitude, slider")
    box = slider.bounding_box()
    assert box is not None
    x, y = middle(slider)
    page.mouse.move(box["x"] + 0.45 * box["width"], y)
    page.mouse.down()
    page.mouse.move(x + 0.2 * box["width"], y, steps=5)
    expect(page.locator(NUMBER)).not_to_have_text("49.9")
    held = value(page, "amplitude")
    page.mouse.up()
    settled(page)
    assert value(page, "amplitude") == pytest.approx(held)
    typed(page, "#value-amplitude", "3")  # beyond the end: the slider reaches to it
    expect(page.locator("[data-name=amplitude] .high")).to_have_text("3")


def test_on_a_phone_number_part_and_first_slider_are_on_the_first_screen(
    page: Page, address: str
) -> None:
    page.set_viewport_size({"width": 390, "height": 844})
    opened(page, address)
    for place in (NUMBER, "#stage", "[data-name=amplitude]"):
        box = page.locator(place).bounding_box()
        assert box is not None
        assert box["y"] + box["height"] <= 844, place
    expect(page.locator("#picture")).to_be_hidden()
    page.locator("#tab-picture").click()
    expect(page.locator("#stage")).to_be_hidden()
    expect(page.locator("#picture .map canvas")).to_be_visible()
    page.locator("#tab-detail").click()
    expect(page.locator(".panels")).to_be_visible()
    page.mouse.wheel(0, 600)  # the number stays
    expect(page.locator(NUMBER)).to_be_in_viewport()
