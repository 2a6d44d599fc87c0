"""The page's question "Which drive is best?": chips, flight, limits, trade-offs."""

from __future__ import annotations

import csv
import re
import tomllib
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from audit import audited
from looking import NUMBER, numbers, opened, posted, revealed, settled, taken_away, typed

SNAPSHOT = (
    "#question=drive&kind=sweep&scene=rectangle-on-plane&choice=physical&output=acceleration_x"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4&p.alpha=20"
)
TRADE_OFF = f"{SNAPSHOT}&best=pareto&against=acceleration_y&points=9&vary=frequency:30:80&found=1"
BEST = f"{SNAPSHOT}&best=maximise&keep=throw_number::0.8:&band=friction:0.2&found=1"


def read(page: Page, name: str) -> str:
    return Path(taken_away(page, name).path()).read_text()


def test_the_design_flies_to_the_best_and_back(page: Page, address: str) -> None:
    page.emulate_media(reduced_motion="no-preference")
    opened(page, f"{address}/#question=drive")
    expect(page.locator("#answer .unit")).to_have_text("mm/s, 6 times as fast")
    expect(page.locator("#picture .flight-way")).to_be_attached()
    expect(page.locator("#picture .mark", has_text="before 49.9")).to_be_visible()
    table = page.locator("#best-told table")
    (before, best) = numbers(table.locator("tr", has_text="Angle of").inner_text())
    assert before == 20
    parameters = {"frequency": 50, "friction": 0.3, "amplitude": "1 mm", "beta": best}
    study = {"kind": "simulate", "scene": "rectangle-on-plane", "parameters": parameters}
    answer = 1e3 * posted(address, study)["conveying_velocity"]["data"]
    assert float(page.locator(NUMBER).inner_text()) == pytest.approx(answer, rel=5e-3)
    told = page.locator("#best-told")
    expect(told).to_contain_text("Amplitude is at its bound of 1\u00a0mm.")
    expect(told).to_contain_text(re.compile("or 2° of angle of vibration, at least .* remain"))
    for chip, value in (("still", "20.6"), ("robust", "300")):
        expect(page.locator(f"#chip-{chip}")).to_contain_text(value)
    page.locator("#chip-still").click()
    settled(page)
    expect(page.locator(NUMBER)).to_have_text("20.6")
    expect(page.locator("#answer .sentence")).not_to_contain_text("hops")
    page.get_by_role("button", name="Go back to 0.5").click()
    settled(page)
    expect(page.locator(NUMBER)).to_have_text("49.9")
    page.get_by_role("button", name="Show the best").click()
    settled(page)
    page.get_by_role("button", name="Compare both").click()
    expect(page.locator("#pins thead th")).to_have_count(3)


def test_bounds_are_those_of_the_search(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=drive")
    expect(page.locator("#chip-fastest")).to_contain_text("300")
    largest = page.get_by_label("Largest amplitude", exact=True)
    largest.fill("0,6 mm")
    largest.press("Enter")
    settled(page)
    expect(page.locator("#best-told")).to_contain_text("at its bound of 0.6\u00a0mm")
    expect(page.locator(NUMBER)).not_to_have_text("300")
    settled(page)
    assert float(page.locator(NUMBER).inner_text()) < 300


def test_the_best_tells_what_holds_it_back_and_a_changed_value_searches_again(
    page: Page, address: str
) -> None:
    opened(page, f"{address}/{BEST}")
    said = page.locator("#best-told")
    expect(said).to_contain_text("Throw number is 0.8: 20 % below lift-off, which comes at 1.")
    expect(said).to_contain_text("The upper limit of the throw number has no room left")
    study = tomllib.loads(read(page, "Study of the best (TOML)"))
    answer = {name: one["data"] for name, one in posted(address, study).items()}
    expect(said).to_contain_text(f"The floor contact has {answer['margin_floor_contact']:.4g}")
    row = next(csv.DictReader(read(page, "Best as a table (CSV)").splitlines()))
    assert float(row["acceleration_x [m s-2]"]) == pytest.approx(answer["acceleration_x"])
    before = page.locator(NUMBER).inner_text()
    typed(page, "#value-friction", "0.3")
    expect(page.locator(NUMBER)).not_to_have_text(before)
    expect(said).to_contain_text("Throw number is 0.8")
    # A limit that cannot be: the service's sentence stands beside it.
    revealed(page, "#wishes")
    page.get_by_label("Least throw number").fill("5")
    page.get_by_label("Least throw number").press("Enter")
    page.locator("#find").click()
    expect(page.locator("[data-place='constraints.0']")).to_have_text(
        "Lower is above upper. Swap them."
    )
    page.get_by_role("button", name="Remove limit 1").click()
    assert page.locator("[data-place='constraints.0']").count() == 0


def test_where_nothing_is_feasible_a_click_relaxes_it(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=drive&best=maximise&found=1&keep=conveying_velocity:9::")
    expect(page.locator("#best-told")).to_contain_text("keeps all limits")
    page.get_by_role("button", name="Search without the limits").click()
    expect(page.locator("#chip-fastest")).to_contain_text("300")


def test_a_trade_off_is_one_thing_in_map_and_plot(page: Page, address: str) -> None:
    opened(page, f"{address}/{TRADE_OFF}")
    front = page.locator("#front .front")
    expect(front.locator(".marker")).to_have_count(9)
    study = tomllib.loads(read(page, "Study of the best (TOML)"))
    answer = posted(address, study)
    knee = answer["knee"]["data"].index(1)
    told = page.locator("#front .said")

    def is_told(place: int) -> None:
        names = ("acceleration_x", "acceleration_y", "best_amplitude", "best_beta")
        values = [answer[name]["data"][place] for name in (*names, "best_frequency")]
        values[2] *= 1e3  # mm
        assert numbers(told.inner_text()) == pytest.approx(values, rel=1e-3)

    is_told(knee)
    front.focus()
    page.keyboard.press("End")
    is_told(8)
    page.keyboard.press("ArrowRight")
    is_told(7)
    assert page.locator("#picture .map .marks > .marker").count() == 8
    page.keyboard.press("Home")
    page.keyboard.press("Enter")  # the drive becomes the design
    settled(page)
    frequency = answer["best_frequency"]["data"][0]
    assert float(page.locator("#value-frequency").input_value()) == pytest.approx(
        frequency, rel=1e-5
    )
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        assert audited(page) == []
