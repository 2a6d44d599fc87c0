"""The page opens in a browser, a slider moves, and the number follows."""

import pytest

from benchmarks.browsing import browsed
from benchmarks.serving import served
from looking import number, opened, pressed, settled, watched
from tools import tool
from waiting import wait_for

TRACK = (
    "#question=speed&kind=simulate&scene=rectangle-on-plane&output=conveying_velocity"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4&p.amplitude=0.0005&p.beta=30"
)


@pytest.fixture
def page():
    tool("chromium")
    with served(workers=1) as server, browsed() as context, watched(context) as found:
        opened(found, f"{server.address}/{TRACK}")
        yield found


def test_the_number_follows_a_slider(page):
    before = number(page)
    assert before > 0
    pressed(page, page.get_by_label("Frequency, slider"), *["ArrowRight"] * 10)
    wait_for(lambda: number(page) != before)
    settled(page)
