"""Walks over the page at /: map, motion, table, links, friction, rows, measured runs, designs."""

from __future__ import annotations

import csv
import re

import pytest
from playwright.sync_api import Page, expect

from looking import (
    NUMBER,
    SENTENCE,
    chosen,
    clicked,
    number,
    numbers,
    opened,
    pressed,
    settled,
    shows,
    speed,
    taken_away,
    typed,
    value,
)
from waiting import wait_for

TRACK = (
    "#question=speed&kind=simulate&scene=rectangle-on-plane&output=conveying_velocity"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4"
)


def at_cursor(page: Page, *moves: str) -> str:
    """Return what the page says at the middle of its map, after some moves of the cursor."""
    pressed(page, "#picture .map", "ArrowRight", *moves)
    return page.locator("#picture .said").inner_text()


def test_map_cursor_motion_and_table_are_those_of_the_service(page: Page, address: str) -> None:
    page.emulate_media(reduced_motion="no-preference")
    opened(page, f"{address}/{TRACK}")
    amplitude, beta, velocity = numbers(at_cursor(page))[:3]
    answer = speed(address, frequency=50, friction=0.4, amplitude=amplitude / 1e3, beta=beta)
    assert velocity == pytest.approx(answer, rel=5e-3)  # four digits of each are shown
    page.keyboard.press("Enter")
    expect(page.locator(NUMBER)).to_have_text(f"{answer:.3g}")
    now = page.locator("#detail .now")
    moment = now.get_attribute("x1")
    wait_for(lambda: now.get_attribute("x1") != moment)  # it plays
    page.get_by_role("button", name="Pause").click()
    before = now.get_attribute("x1")
    page.locator("#now").press("ArrowRight")
    assert now.get_attribute("x1") != before
    rows = csv.DictReader(taken_away(page, "Table (CSV)").decode().splitlines())

    def apart(row: dict[str, str]) -> float:
        along = abs(float(row["amplitude [m]"]) * 1e3 - amplitude)
        return along + abs(float(row["beta [degree]"]) - beta)

    near = min(rows, key=apart)
    assert float(near["conveying_velocity [m s-1]"]) * 1e3 == pytest.approx(velocity, rel=5e-3)


def test_everything_follows_a_slider_and_a_link_restores_it(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=all")
    before = at_cursor(page)
    pressed(page, page.get_by_label("Frequency, slider"), *["ArrowRight"] * 10)
    taken = page.locator("#value-frequency").input_value()
    page.wait_for_url(re.compile(rf"p\.frequency={re.escape(taken)}(&|$)"))
    settled(page)
    after = at_cursor(page, "ArrowLeft")
    assert numbers(after)[2] != numbers(before)[2]
    told, link = page.locator(NUMBER).inner_text(), page.url
    opened(page, link)
    assert at_cursor(page) == after
    expect(page.locator(NUMBER)).to_have_text(told)


def test_friction_is_chosen_from_published_values_with_its_range(page: Page, address: str) -> None:
    opened(page, f"{address}/{TRACK.replace('&y=beta:5:60', '&y=&p.beta=30')}")
    chosen(page, "#published-friction", label="steel on steel, dry: 0.08 to 0.5")
    shows(page, {SENTENCE: "for friction 0.08 to 0.5", "#part summary": "steel on steel"})
    assert value(page, "friction") == 0.29
    page.locator("#picture .curves").hover()
    shows(page, {"#picture .said": re.compile(r"\(.* to .*\)")})
    typed(page, "#value-friction", "0.3")
    expect(page.locator("#part summary")).not_to_contain_text("steel on steel")


def test_a_row_moves_in_its_lane_and_tells_which_parts_touch(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=rows")
    expect(page.locator("#moment")).to_have_text("Parts 1 to 4 touch.")
    now = page.locator("#now")
    now.press("End")
    expect(page.locator("#moment")).not_to_contain_text("1 to 4")
    expect(now).to_have_attribute("aria-valuetext", re.compile("ms, (no )?parts .*touch$"))


def test_measured_runs_are_pasted_and_what_explains_them_is_taken(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=measured")
    page.locator("#runs").fill("0.1\t3.5\n0.2\tfast")
    page.locator("#runs").press("Tab")
    shows(page, {"#measured .wrong": "is not a number"})
    page.locator("#runs").fill("0.1\t3.0\n0.2 7.0\n0.3;18")
    page.locator("#runs").press("Tab")
    expect(page).to_have_url(re.compile("runs=0.0001%3A0.003%2C"))
    settled(page)
    found = page.locator(NUMBER).inner_text()
    clicked(page, re.compile(f"^Use {found} as"))
    assert value(page, "friction") == pytest.approx(float(found), rel=2e-3)
    expect(page.locator("#answer .actions button")).to_have_count(0)


def test_designs_are_kept_and_compared(page: Page, address: str) -> None:
    opened(page, address)
    page.locator("#keep").click()
    cells = page.locator("#pins tr", has_text="Conveying velocity").locator("td")
    expect(cells).to_have_text(["49.92", "49.92"])
    typed(page, "#value-beta", "30")
    expect(cells.first).to_have_text("49.92")
    expect(cells.last).not_to_have_text("49.92")
    for angle in range(31, 36):
        typed(page, "#value-beta", str(angle))
        page.locator("#keep").click()
    expect(cells).to_have_count(5)
    page.reload()
    expect(cells).to_have_count(5)
    clicked(page, "Show design A")
    assert number(page) == 49.9
    clicked(page, "Remove design D")
    expect(cells).to_have_count(4)
