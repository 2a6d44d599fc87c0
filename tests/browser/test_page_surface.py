"""A part from a file in "Which way up will it lie?", and the band of a speed under its number."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from looking import NUMBER, SENTENCE, opened, posted, settled, taken_away, typed

BRACKET = Path(__file__).parents[2] / "configs" / "bracket.stl"
DROPPED = """(content) => {
  const files = new DataTransfer();
  files.items.add(new File([content], "bracket.stl"));
  const drop = new DragEvent("drop", { dataTransfer: files, bubbles: true, cancelable: true });
  document.getElementById("surface").dispatchEvent(drop);
}"""


def test_a_dropped_file_shows_its_ways_to_lie(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=resting")
    page.evaluate(DROPPED, BRACKET.read_text())
    cards = page.locator("#aspects .aspect-card")
    expect(cards).to_have_count(5)
    expect(cards.first).to_contain_text("26 to 33 %")
    expect(cards.first).to_contain_text("20\u00a0mm high")
    expect(page.locator(NUMBER)).to_have_text("26 %")
    expect(page.locator("#picture")).to_be_hidden()
    cards.last.click()
    expect(page.locator(SENTENCE)).to_contain_text("7 to 12 %")
    study = tomllib.loads(taken_away(page, "Study (TOML)").decode())
    assert posted(address, study)["let_down_share"][0] > 0.25
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Show a plain shape").click()
    settled(page)
    expect(page.locator(NUMBER)).to_have_text("65 %")


def test_a_file_that_is_no_surface_is_told_and_left(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=resting")
    page.evaluate(DROPPED, "no surface")
    expect(page.locator("#answer")).to_have_class(re.compile("failed"))
    page.locator("#answer").get_by_role("button", name="Show a plain shape").click()
    settled(page)
    expect(page.locator(NUMBER)).to_have_text("65 %")


def test_the_band_of_a_speed_is_that_of_the_service(page: Page, address: str) -> None:
    sent: list[str] = []
    page.on("request", lambda request: sent.append(request.post_data or ""))
    opened(page, address)
    typed(page, "#band-share", "50")
    expect(page.locator(SENTENCE)).to_contain_text("for friction 0.15 to 0.45")
    study = next(json.loads(one) for one in reversed(sent) if '"low":' in one)
    assert study["parameters"]["friction"] == pytest.approx({"low": 0.15, "high": 0.45})
    found = posted(address, study)
    ends = [1e3 * found[f"conveying_velocity_{end}"] for end in ("least", "most")]
    expect(page.locator(SENTENCE)).to_contain_text(f"{ends[0]:.2g} to {ends[1]:.2g} mm/s")
