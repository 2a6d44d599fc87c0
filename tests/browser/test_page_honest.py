"""Colours keep their meaning, and borders and hatching lie where the physics has them."""

from __future__ import annotations

import math
import re

from playwright.sync_api import Page, expect

from looking import held, opened, revealed, shows

SWEEP = (
    "#question=all&kind=sweep&scene=rectangle-on-plane&choice=physical&output=acceleration_x"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4"
)
MOTION = (
    "#question=speed&kind=simulate&scene=rectangle-on-plane&output=conveying_velocity"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4"
)


def test_colours_keep_their_meaning_while_a_slider_is_dragged(page: Page, address: str) -> None:
    opened(page, f"{address}/{SWEEP}")
    # What describes no real part is hatched.
    shows(page, {"#note": re.compile("^Hatched, .* %: the part has left")})
    assert page.locator("#picture .hatch path").count() == 1
    bar = page.locator("#picture .scale [role=img]")
    before = bar.get_attribute("aria-label")
    slider = page.get_by_label("Frequency, slider")
    box = slider.bounding_box()
    assert box is not None
    with held(page, slider, 0.3 * box["width"], 0):
        shows(page, {"#picture .scale": "beyond the ends"})
        assert bar.get_attribute("aria-label") == before
    expect(page.locator("#picture .scale")).not_to_contain_text("beyond the ends")
    assert bar.get_attribute("aria-label") != before
    opened(page, f"{address}/{MOTION}")
    assert page.locator("#picture .hatch path").count() == 0
    revealed(page, "#meaning")
    shows(page, {"#meaning": "Conveying velocity", "#version": re.compile(r"^\d+\.\d+")})


def test_borders_lie_where_the_part_lifts_off(page: Page, address: str) -> None:
    opened(page, f"{address}/{SWEEP}")
    picture = page.locator("#picture .map")
    expect(picture).to_be_attached()
    left, low, wide, tall = (
        float(picture.locator(".frame").get_attribute(name) or 0)
        for name in ("x", "y", "width", "height")
    )
    drawn = picture.locator(".borders .border").evaluate_all(
        "all => all.map((one) => one.getAttribute('d'))"
    )
    found = [
        [tuple(map(float, point.split(","))) for point in re.findall(r"[\d.-]+,[\d.-]+", ring)]
        for ring in drawn
    ]
    weight = 9.80665 / (2 * math.pi * 50) ** 2

    def apart(x: float, y: float) -> float:
        """Return how many dots a point lies from where the throw number is 1, up or across."""
        amplitude = 1e-4 + (x - left) / wide * 6e-4
        beta = math.radians(5 + (low + tall - y) / tall * 55)
        up = math.degrees(math.asin(min(1, weight / amplitude)) - beta) * tall / 55
        return min(abs(up), abs(weight / math.sin(beta) - amplitude) * wide / 6e-4)

    inside = [
        [apart(x, y) for x, y in ring if left < x < left + wide and low < y < low + tall]
        for ring in found
    ]
    # One border is that of lift-off; a value of the picture is 2 to 3 dots.
    assert min(max(ring) for ring in inside if len(ring) > 50) < 3
