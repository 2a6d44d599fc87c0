"""The page's question "Which drive is best?": chips, flight, limits, trade-offs."""

from __future__ import annotations

import csv
import re
import tomllib

import pytest
from playwright.sync_api import Page, expect

from audit import audited
from looking import (
    NUMBER,
    SENTENCE,
    clicked,
    entered,
    number,
    numbers,
    opened,
    posted,
    pressed,
    settled,
    shows,
    speed,
    taken_away,
    typed,
)

SNAPSHOT = (
    "#question=drive&kind=sweep&scene=rectangle-on-plane&choice=physical&output=acceleration_x"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4&p.alpha=20"
)
TRADE_OFF = f"{SNAPSHOT}&best=pareto&against=acceleration_y&points=9&vary=frequency:30:80&found=1"
BEST = f"{SNAPSHOT}&best=maximise&keep=throw_number::0.8:&band=friction:0.2&found=1"
TOLD = "#best-told"


def test_the_design_flies_to_the_best_and_back(page: Page, address: str) -> None:
    page.emulate_media(reduced_motion="no-preference")
    opened(page, f"{address}/#question=drive")
    expect(page.locator("#answer .unit")).to_have_text("mm/s, 6 times as fast")
    expect(page.locator("#picture .flight-way")).to_be_attached()
    expect(page.locator("#picture .mark", has_text="before 49.9")).to_be_visible()
    row = page.locator(f"{TOLD} .before tr", has_text="Angle of")
    (before, best) = numbers(row.inner_text())
    assert before == 20
    answer = speed(address, frequency=50, friction=0.3, amplitude="1 mm", beta=best)
    assert number(page) == pytest.approx(answer, rel=5e-3)
    shows(page, {TOLD: "Amplitude is at its bound of 1\u00a0mm."})
    shows(page, {TOLD: re.compile("or 2° of angle of vibration, at least .* remain")})
    shows(page, {"#chip-still": "20.6", "#chip-robust": "300"})
    page.locator("#chip-still").click()
    settled(page)
    assert number(page) == 20.6
    expect(page.locator(SENTENCE)).not_to_contain_text("hops")
    clicked(page, "Go back to 0.5")
    assert number(page) == 49.9
    clicked(page, "Show the best")
    clicked(page, "Compare both")
    expect(page.locator("#pins thead th")).to_have_count(3)
    # Bounds are those of the search.
    entered(page, "[aria-label='Largest amplitude']", "0,6 mm")
    shows(page, {TOLD: "at its bound of 0.6\u00a0mm"})
    settled(page)
    assert number(page) < 300
    page.locator("#vary-frequency").click()
    expect(page.locator(SENTENCE)).to_contain_text("\u00a0Hz;")


def test_the_best_tells_what_holds_it_back_and_a_changed_value_searches_again(
    page: Page, address: str
) -> None:
    opened(page, f"{address}/{BEST}")
    shows(page, {TOLD: "Throw number is 0.8: 20 % below lift-off, which comes at 1."})
    shows(page, {TOLD: "The upper limit of the throw number has no room left"})
    answer = posted(address, tomllib.loads(taken_away(page, "Study of the best (TOML)").decode()))
    shows(page, {TOLD: f"The floor contact has {answer['margin_floor_contact']:.4g}"})
    rows = csv.DictReader(taken_away(page, "Best as a table (CSV)").decode().splitlines())
    assert float(next(rows)["acceleration_x [m s-2]"]) == pytest.approx(answer["acceleration_x"])
    before = page.locator(NUMBER).inner_text()
    typed(page, "#value-friction", "0.3")
    expect(page.locator(NUMBER)).not_to_have_text(before)
    shows(page, {TOLD: "Throw number is 0.8"})
    # A limit that cannot be: the service's sentence stands beside it.
    entered(page, "[aria-label='Least throw number']", "5")
    page.locator("#find").click()
    wrong = page.locator("[data-place='constraints.0']")
    expect(wrong).to_have_text("The lower bound is above the upper bound. Swap lower and upper.")
    page.get_by_role("button", name="Remove limit 1").click()
    assert wrong.count() == 0


def test_where_nothing_is_feasible_a_click_relaxes_it(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=drive&best=maximise&found=1&keep=conveying_velocity:9::")
    shows(page, {TOLD: "keeps all limits"})
    page.get_by_role("button", name="Search without the limits").click()
    shows(page, {"#chip-fastest": "300"})


def test_a_trade_off_is_one_thing_in_map_and_plot(page: Page, address: str) -> None:
    opened(page, f"{address}/{TRADE_OFF}")
    front = page.locator("#front .curves")
    expect(front.locator(".measured")).to_have_count(9)
    answer = posted(address, tomllib.loads(taken_away(page, "Study of the best (TOML)").decode()))
    names = ("acceleration_x", "acceleration_y", "best_amplitude", "best_beta", "best_frequency")

    def is_told(place: int) -> None:
        values = [answer[name][place] for name in names]
        values[2] *= 1e3  # mm
        told = page.locator("#front .said").inner_text()
        assert numbers(told) == pytest.approx(values, rel=1e-3)

    is_told(answer["knee"].index(1))
    pressed(page, front, "Shift+ArrowLeft")
    is_told(8)
    page.keyboard.press("ArrowRight")
    is_told(7)
    assert page.locator("#picture .map .marks > .marker").count() == 8
    pressed(page, front, "Shift+ArrowRight", "Enter")  # the drive becomes the design
    settled(page)
    assert float(page.url.partition("p.frequency=")[2].split("&")[0]) == pytest.approx(
        answer["best_frequency"][0], rel=1e-5
    )
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        assert audited(page) == []
