"""Where a plate carries parts: speed and direction at a place, and the field of arrows."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

from looking import SENTENCE, clicked, numbers, opened, posted

PLATE = {
    "frequency": 50, "friction": 0.3, "phase_along_1": 90, "amplitude_along_1": 1e-4,
    "amplitude_across_1": 1e-4,
}  # fmt: skip


def answer(page: Page, address: str, **move: float) -> None:
    """Compare speed and direction on the page with those of the service."""
    study = {
        "kind": "simulate",
        "scene": "part-on-plate",
        "outputs": ["travel_speed", "travel_direction"],
        "parameters": PLATE | move,
    }
    found = posted(address, study)
    speed, direction = numbers(page.locator("#answer .answer").inner_text())
    assert speed == pytest.approx(1e3 * found["travel_speed"], rel=0.005)
    assert direction == pytest.approx(found["travel_direction"], abs=0.5)


def test_arrows_and_answer_of_a_plate_are_of_its_move(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=plate")
    answer(page, address, amplitude_normal_1=4e-5, phase_normal_1=-17)
    shafts = re.compile("M[^M]*M")
    (path,) = page.locator("#picture .arrows .arrow").evaluate_all(
        "all => all.map(({ attributes }) => attributes.d.value)"
    )
    assert len(shafts.findall(path)) == 169
    expect(page.get_by_role("button", name="Convey")).to_have_attribute("aria-pressed", "true")
    clicked(page, "Centre")
    expect(page.locator(SENTENCE)).to_contain_text("the plate gathers parts")
    tilts = {"amplitude_tilt_x_1": 0.02, "phase_tilt_x_1": 119, "amplitude_tilt_y_1": 0.02}
    answer(page, address, **tilts, phase_tilt_y_1=29, position_x=0.06, position_y=0.03)
