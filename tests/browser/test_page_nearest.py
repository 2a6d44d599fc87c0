"""Where no drive keeps all limits: the nearest drives, and what would make one."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from looking import NUMBER, numbers, opened, posted, settled

ASKED = 0.05  # m/s, without a hop
LINK = (
    f"#question=drive&best=maximise&found=1&keep=conveying_velocity:{ASKED}::&keep=throw_number::1:"
)


def test_the_nearest_drives_and_what_would_do_it(page: Page, address: str) -> None:
    opened(page, f"{address}/{LINK}")
    told = page.locator("#best-told")
    expect(told).to_contain_text("No drive within the bounds keeps all limits")
    expect(page.locator("#chip-still")).to_contain_text("nothing fits")
    lines = told.locator(".near li")
    expect(lines.filter(has_text="where at least 50\u00a0mm/s is asked")).to_have_count(1)
    expect(told).to_contain_text("What would do it?")
    line = lines.filter(has_text="where at least").first
    speed, _, amplitude, beta = numbers(line.inner_text().replace("°.", "°"))[:4]
    study = {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "outputs": ["conveying_velocity", "throw_number"],
        "parameters": {
            "frequency": 50,
            "friction": 0.3,
            "amplitude": amplitude / 1e3,
            "beta": beta,
        },
    }
    answer = posted(address, study)
    assert 1e3 * answer["conveying_velocity"] == pytest.approx(speed, rel=0.02)
    assert answer["throw_number"] == pytest.approx(1, rel=0.02)
    line.get_by_role("button", name="Show").click()
    settled(page)
    assert float(page.locator(NUMBER).inner_text()) == pytest.approx(speed, rel=0.02)
