"""The page opens in a browser, a slider moves, and the number follows."""

from __future__ import annotations

import re

import pytest

from benchmarks.browsing import browsed
from benchmarks.serving import served
from tools import tool
from waiting import PATIENCE, wait_for

TRACK = (
    "#question=speed&kind=simulate&scene=rectangle-on-plane&output=conveying_velocity"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4&point=0.0005:30"
)


@pytest.fixture
def page():
    tool("chromium")
    with served(workers=1) as server, browsed() as context:
        opened = context.new_page()
        opened.set_default_timeout(1000 * PATIENCE)
        opened.goto(f"{server.address}/{TRACK}")
        yield opened


def test_the_number_follows_a_slider(page):
    speed = page.locator("#detail .said", has_text="Mean speed")

    def number() -> float:
        found = re.search(r"Mean speed ([\u2212]?[\d.]+)", speed.inner_text())
        return float(found.group(1).replace("\u2212", "-"))

    before = number()
    page.get_by_label("Frequency, slider").focus()
    for _ in range(10):
        page.keyboard.press("ArrowRight")
    wait_for(lambda: number() != before)
