"""The page's question "Which drive is best?": margins, neighbours, trade-offs, all linked."""

from __future__ import annotations

import csv
import json
import re
import tomllib
import urllib.request

import pytest
from playwright.sync_api import expect

from audit import audited
from waiting import PATIENCE

SNAPSHOT = (
    "#question=drive&kind=sweep&scene=rectangle-on-plane&choice=physical&output=acceleration_x"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4&p.alpha=20"
)
# Only two of the three things that may be chosen are axes of the map.
TRADE_OFF = f"{SNAPSHOT}&best=pareto&against=acceleration_y&points=9&vary=frequency:30:80"
BEST = f"{SNAPSHOT}&best=maximise&keep=throw_number::0.8:&band=friction:0.2"


def posted(address, study):
    request = urllib.request.Request(
        f"{address}/processes/{study['kind']}/execution",
        json.dumps(study).encode(),
        {"Content-Type": "application/json"},
    )
    with urllib.request.urlopen(request, timeout=PATIENCE) as reply:
        return json.load(reply)["variables"]


def opened(page, address, link):
    page.goto("about:blank")
    page.goto(f"{address}/{link}")
    expect(page.locator("#progress")).to_have_text(re.compile("^Shown"))


def numbers(text):
    return [
        float(word.replace("\u2212", "-")) for word in re.findall(r"[\u2212]?\d+(?:\.\d+)?", text)
    ]


def taken(page, name):
    """Return the text that is saved of the best."""
    page.locator("#away-what").select_option("best")
    with page.expect_download() as download:
        page.get_by_role("button", name=name, exact=True).click()
    return download.value.path().read_text()


def test_a_trade_off_is_one_thing_in_all_its_pictures(page, address):
    opened(page, address, TRADE_OFF)
    page.get_by_role("button", name="Find the best").click()
    front = page.locator("#beside .front")
    expect(front.locator(".marker")).to_have_count(9)
    study = tomllib.loads(taken(page, "Study (TOML)"))
    answer = posted(address, study)
    knee = answer["knee"]["data"].index(1)
    told = page.locator("#beside .said")

    def is_told(place):
        names = ("acceleration_x", "acceleration_y", "best_amplitude", "best_beta")
        values = [answer[name]["data"][place] for name in (*names, "best_frequency")]
        values[2] *= 1e3  # mm
        assert numbers(told.inner_text()) == pytest.approx(values, rel=1e-3)

    is_told(knee)
    # By keys along the trade-off: the map and the lines follow, and its end is its least value.
    front.focus()
    page.keyboard.press("End")
    is_told(8)
    page.keyboard.press("ArrowRight")
    is_told(7)
    assert page.locator("#picture .map .marks .mark").count() == 1
    assert page.locator("#picture .map .marks > .marker").count() == 9
    assert page.locator(".design.chosen").count() == 1
    expect(page.locator("#optimum .details li").first).to_contain_text("the part")
    # A part of an axis by keys, then by the pointer: what lies outside is faint in both pictures.
    for _ in range(20):
        page.get_by_role("slider", name="Largest frequency of the lines").press("ArrowDown")
    values = answer["best_frequency"]["data"]
    middle = (min(values) + max(values)) / 2
    outside = sum(value > middle for value in values)
    expect(page.locator(".design.dim")).to_have_count(outside)
    expect(front.locator(".marker.dim")).to_have_count(outside)
    page.get_by_role("button", name="All drives again").click()
    expect(front.locator(".dim")).to_have_count(0)
    area = page.locator(".parallel .catch").last
    area.scroll_into_view_if_needed()
    box = area.bounding_box()
    page.mouse.move(box["x"] + 14, box["y"] + 2)
    page.mouse.down()
    page.mouse.move(box["x"] + 14, box["y"] + box["height"] / 2, steps=3)
    page.mouse.up()
    expect(page.locator("#optimum .said")).to_contain_text("of 9 drives are left")
    out = page.locator(".design.dim").count()
    assert 0 < out < 9
    handle = page.get_by_role("slider", name="Largest frequency of the lines").bounding_box()
    page.mouse.move(handle["x"] + 9, handle["y"] + 4)
    page.mouse.down()
    page.mouse.move(handle["x"] + 9, handle["y"] + box["height"], steps=3)
    page.mouse.up()
    expect(page.locator("#optimum .said")).to_contain_text("of 9 drives are left")
    assert page.locator(".design.dim").count() > out
    # The way back: a point of the map near a drive of the trade-off.
    dot = page.locator("#picture .map .marks > .marker").first
    dot.scroll_into_view_if_needed()
    place = dot.bounding_box()
    page.mouse.move(place["x"] + place["width"] / 2, place["y"] + place["height"] / 2)
    is_told(0)
    # Enter shows the drive: its frequency at the slider, and its motion.
    front.focus()
    page.keyboard.press("Enter")
    expect(page.locator("#detail")).to_contain_text("Mean speed")
    shown = float(page.locator("#value-frequency").input_value())
    assert shown == pytest.approx(values[0], rel=1e-5)
    # A link restores all of it, and finds it again.
    link = page.url
    opened(page, address, link[link.index("#") :])
    expect(front.locator(".marker")).to_have_count(9)
    is_told(knee)
    assert "vibrafeed.optimise(" in taken(page, "Python")
    drawn = taken(page, "SVG")
    assert drawn.startswith("<svg")
    assert drawn.count("<path") == 9


def test_the_best_tells_its_margins_its_neighbours_and_its_band(page, address):
    opened(page, address, BEST)
    page.get_by_role("button", name="Find the best").click()
    around = page.locator("#optimum .around")
    around.wait_for()
    study = tomllib.loads(taken(page, "Study (TOML)"))
    answer = {name: one["data"] for name, one in posted(address, study).items()}
    said = page.locator("#optimum .answer")
    expect(said).to_contain_text("Throw number is 0.8: 20 % below lift-off, which comes at 1.")
    expect(said).to_contain_text("The upper limit of the throw number has no room left")
    room = answer["margin_floor_contact"]
    expect(said).to_contain_text(f"The floor contact has {room:.4g}")
    # One value of the picture to the left and below, as the service has it.
    step, turn = numbers(said.get_by_text("One step of the picture").inner_text())
    parameters = study["parameters"] | {
        "amplitude": answer["best_amplitude"] - step / 1e3,
        "beta": answer["best_beta"],
    }
    sweep = {"kind": "sweep", "scene": study["scene"], "variant": "physical"}
    sweep |= {"outputs": ["acceleration_x"], "parameters": parameters}
    left = posted(address, sweep)["acceleration_x"]["data"]
    fall = 100 * (1 - left / answer["acceleration_x"])
    (told,) = re.findall(r"to the best: .*?; less amplitude: ([\d.]+) % worse", label(around))
    assert float(told) == pytest.approx(fall, rel=0.05)
    assert turn == pytest.approx(55 / 199, rel=1e-2)
    assert "more drive elevation: breaks throw number" in label(around)
    expect(page.locator("#optimum .band li")).to_have_count(5)
    expect(page.locator("#picture .mark:not(.dragged)")).to_have_count(1)
    assert taken(page, "SVG").count('class="mark"') == 1
    row = next(csv.DictReader(taken(page, "CSV").splitlines()))
    assert float(row["acceleration_x [m s-2]"]) == pytest.approx(answer["acceleration_x"])
    # A changed value: the best is of another drive, and is no longer told.
    field = page.locator("#value-friction")
    field.fill("0.3")
    field.press("Tab")
    expect(page.locator("#extra [role=status]").first).to_have_text(
        "The values changed after the best drive was found: search again."
    )
    expect(page.locator("#picture .mark:not(.dragged)")).to_have_count(0)
    # A limit that cannot be: the service's sentence stands beside it.
    page.get_by_label("Least throw number").fill("5")
    page.get_by_role("button", name="Find the best").click()
    expect(page.locator("[data-place='constraints.0']")).to_have_text(
        "Lower is above upper. Swap them."
    )
    page.get_by_role("button", name="Remove limit 1").click()
    assert page.locator("[data-place='constraints.0']").count() == 0


def label(locator):
    return locator.get_attribute("aria-label")


def test_nothing_of_it_stands_in_the_way_of_anybody(page, address):
    page.set_viewport_size({"width": 1280, "height": 900})
    opened(page, address, f"{TRADE_OFF}&found=1")
    expect(page.locator("#beside .marker")).to_have_count(9)
    in_both_lights(page)
    page.set_viewport_size({"width": 390, "height": 800})
    # Lines of one parameter, for a change.
    opened(page, address, f"{BEST.replace('&y=beta:5:60', '&y=&p.beta=10')}&found=1")
    page.locator("#optimum .band").wait_for()
    in_both_lights(page)
    assert page.locator("main").bounding_box()["width"] <= 390


def in_both_lights(page):
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        assert audited(page) == []
