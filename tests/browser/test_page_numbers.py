"""Typed text counts as the number that was meant, or not at all."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

from looking import NUMBER, SENTENCE, opened, settled, shows, speed, typed, value

FRICTION, FREQUENCY = "#value-friction", "#value-frequency"
NONSENSE = ("1e400", "", "0.3.1", "3 mm")
NUMBERS = (
    (FRICTION, "0,35", 0.35),
    (FREQUENCY, "55 hz", 55.0),
    (FREQUENCY, "3300 RPM", 55.0),
    (FRICTION, "25 %", 0.25),
    (FREQUENCY, "53,5", 53.5),
)


def in_address(page: Page, field: str) -> float:
    """Return a parameter of the link; what has its default value stands there, too."""
    name = field.removeprefix("#value-")
    (found,) = re.findall(rf"p\.{name}=([^&]+)", page.url)
    return float(found)


def test_numbers_as_people_type_them_and_what_is_none(page: Page, address: str) -> None:
    opened(page, address)
    before, said = page.url, page.locator(".field:has(#value-friction) [role=alert]")
    for nonsense in NONSENSE:
        typed(page, FRICTION, nonsense)
        assert page.locator(FRICTION).input_value() == nonsense
        assert page.url == before, nonsense
        expect(said).to_contain_text("0.3 holds until it is corrected.")
    for field, text, meant in NUMBERS:
        typed(page, field, "0.31" if field == FRICTION else "49")
        typed(page, field, text)
        assert in_address(page, field) == pytest.approx(meant, rel=1e-12)
        assert float(page.locator(field).input_value()) == pytest.approx(meant, rel=1e-5)
        slider = page.locator(f".field:has({field}) input[type=range]")
        spoken = slider.get_attribute("aria-valuetext") or ""
        assert float(re.sub(r"[^\d.]", "", spoken)) == pytest.approx(meant, rel=1e-3)
    expect(said).to_be_hidden()
    typed(page, FRICTION, "0.3")
    typed(page, FRICTION, "0.4")
    page.go_back()
    settled(page)
    assert value(page, "friction") == 0.3


def test_an_exact_point_is_typed_and_answered_in_one_line(page: Page, address: str) -> None:
    """2 pi 50 Hz, 0.35 mm, 25 degrees: throw number (A w^2/g) sin(beta) = 1.489."""
    opened(page, f"{address}/#question=hop")
    typed(page, "#value-amplitude", "0,35 mm")
    typed(page, "#value-beta", "25")
    shows(page, {SENTENCE: "lifts off above 0.24\u00a0mm of amplitude; throw number 1.49"})
    opened(page, f"{address}/#question=speed&p.amplitude=0.00035&p.beta=25&p.friction=0.3")
    answer = speed(address, frequency=50, amplitude=0.35e-3, beta=25, friction=0.3)
    expect(page.locator(NUMBER)).to_have_text(f"{answer:.3g}")
