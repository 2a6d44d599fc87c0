"""The page at /: its questions, each from an empty page to the answer of the service."""

from __future__ import annotations

import csv
import json
import re
import urllib.request

import pytest

from audit import audited
from waiting import PATIENCE, wait_for

TRACK = (
    "#question=speed&kind=simulate&scene=rectangle-on-plane&output=conveying_velocity"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4"
)
SHOWN = re.compile("^Shown")


def posted(address, study):
    request = urllib.request.Request(
        f"{address}/processes/{study['kind']}/execution",
        json.dumps(study).encode(),
        {"Content-Type": "application/json"},
    )
    with urllib.request.urlopen(request, timeout=PATIENCE) as reply:
        return json.load(reply)


def shown(page):
    from playwright.sync_api import expect

    # Its words say what it waits for, where it does.
    expect(page.locator("#progress")).to_have_text(SHOWN)


def told(page):
    return page.locator("#picture .said").inner_text()


def at_cursor(page, moves=""):
    """Return what the page says at the middle of its map, after some moves of the cursor."""
    page.locator("#picture .map").focus()
    for key in ["ArrowRight", *moves.split()]:
        page.keyboard.press(key)
    return told(page)


def numbers(text):
    found = re.findall(r"([\u2212]?[\d.]+(?:e[\u2212\d]+)?)", text)
    return [float(word.replace("\u2212", "-")) for word in found]


def test_how_fast_does_my_part_travel(page, address):
    page.emulate_media(reduced_motion="no-preference")
    page.goto(f"{address}/{TRACK}")
    shown(page)
    amplitude, beta, velocity = numbers(at_cursor(page))[:3]
    study = {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "parameters": {
            "frequency": 50,
            "friction": 0.4,
            "amplitude": amplitude / 1e3,
            "beta": beta,
        },
    }
    answer = posted(address, study)["variables"]["conveying_velocity"]["data"]
    # The page shows four digits of each.
    assert velocity == pytest.approx(answer * 1e3, rel=5e-3)
    page.keyboard.press("Enter")
    page.locator("#detail").wait_for()
    page.locator("#detail .said").filter(has_text="Mean speed").wait_for()
    moment = page.locator("#detail .now").get_attribute("x1")
    wait_for(lambda: page.locator("#detail .now").get_attribute("x1") != moment)  # it plays
    page.get_by_role("button", name="Pause").click()
    before = page.locator("#detail .now").get_attribute("x1")
    page.get_by_role("button", name="Step on").click()
    assert page.locator("#detail .now").get_attribute("x1") != before
    with page.expect_download() as download:
        page.get_by_role("button", name="CSV").click()
    rows = list(csv.DictReader(download.value.path().read_text().splitlines()))
    near = min(
        rows,
        key=lambda row: (
            abs(float(row["amplitude [m]"]) * 1e3 - amplitude)
            + abs(float(row["beta [degree]"]) - beta)
        ),
    )
    assert float(near["conveying_velocity [m s-1]"]) * 1e3 == pytest.approx(velocity, rel=5e-3)
    assert "The results are ready." in page.locator("#jobs").inner_text()


def test_which_drive_is_best(page, address):
    page.goto(f"{address}/#question=drive")
    shown(page)
    page.get_by_role("button", name="Find the best").click()
    row = page.locator("#optimum tr", has_text="Best drive elevation")
    row.wait_for()
    (best,) = numbers(row.locator("td").inner_text())
    value = numbers(page.locator("#optimum tr", has_text="Conveying velocity").inner_text())[0]
    study = {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "parameters": {"frequency": 50, "friction": 0.3, "amplitude": "1 mm", "beta": best},
    }
    answer = posted(address, study)["variables"]["conveying_velocity"]["data"]
    assert value == pytest.approx(answer * 1e3, rel=5e-3)
    assert page.locator("#picture .mark:not(.dragged)").count() == 1


def test_what_amplitude_will_my_springs_give(page, address):
    page.goto(f"{address}/")
    shown(page)
    page.get_by_role("button", name="What amplitude will my springs give?").click()
    page.locator("#headline", has_text="Amplitude of the track").wait_for()
    shown(page)
    page.get_by_text("Tuned stiff").first.wait_for()
    frequency, load, amplitude = numbers(at_cursor(page))[:3]
    study = {
        "kind": "sweep", "scene": "linear-drive-unit", "variant": "measured",
        "outputs": ["track_amplitude"],
        "parameters": {
            "moving_mass": 10, "base_mass": 30, "ring_down_frequency": 53, "damping_ratio": 0.02,
            "drive_force": 100, "frequency": frequency, "load_mass": load / 1e3,
        },
    }  # fmt: skip
    answer = posted(address, study)["variables"]["track_amplitude"]["data"]
    assert amplitude == pytest.approx(answer * 1e3, rel=5e-3)
    assert page.get_by_label("Model", exact=True).count() == 0  # nothing is followed in time there
    page.goto(f"{address}/#question=speed&kind=simulate&scene=linear-drive-unit&choice=events")
    page.wait_for_url(lambda url: "question=speed" in url and "kind=sweep" in url)
    page.locator("#headline", has_text="Amplitude of the track").wait_for()
    shown(page)


def test_what_did_the_thesis_draw(page, address):
    page.goto(f"{address}/#question=thesis")
    shown(page)
    assert "Verdict" in page.locator("#figures").inner_text()
    assert "do not describe a real part" in page.locator("#note").inner_text()
    assert page.locator("#choose-figure option").count() == 31
    page.locator("#choose-figure").select_option("fig-5-22")
    page.get_by_text("It is zero where the").wait_for()
    shown(page)
    assert "velocity" in page.locator("#headline").inner_text().lower()


def test_everything_follows_a_slider_and_a_link_restores_it(page, address):
    page.goto(f"{address}/#question=all")
    shown(page)
    before = at_cursor(page)
    slider = page.get_by_label("Frequency, slider")
    slider.focus()
    for _ in range(10):
        page.keyboard.press("ArrowRight")
    # The map follows while the keys are pressed; the last of them counts.
    taken = page.locator("#value-frequency").input_value()
    page.wait_for_url(re.compile(rf"p\.frequency={re.escape(taken)}(&|$)"))

    def followed():
        """Return the words at the same point once the map has followed, which takes a moment."""
        shown(page)
        found, again = (at_cursor(page, "ArrowLeft") for _ in range(2))
        return found if found == again and numbers(found)[2] != numbers(before)[2] else None

    after = wait_for(followed)
    link = page.url
    assert "p.frequency" in link
    page.goto("about:blank")
    page.goto(link)
    shown(page)
    assert at_cursor(page) == after


def test_a_mistake_is_told_beside_its_field(page, address):
    page.goto(f"{address}/{TRACK}")
    shown(page)
    field = page.locator("#value-friction")
    field.fill("-1")
    field.press("Tab")
    page.locator("#wrong-friction", has_text="It must be at least 0").wait_for()
    field = page.locator("#value-friction")
    field.fill("0.3")
    field.press("Tab")
    page.locator("#wrong-friction", has_text=re.compile("^$")).wait_for(state="attached")


def test_the_motion_follows_the_knobs_and_skipping_keeps_the_view(page, address):
    page.goto(f"{address}/{TRACK}&point=0.0005:30")
    shown(page)
    speed = page.locator("#detail .said", has_text="Mean speed")
    speed.wait_for()
    before = re.search("Mean speed [^;]*", speed.inner_text()).group()
    field = page.locator("#value-friction")
    field.fill("0.1")
    field.press("Tab")
    speed.filter(has_not_text=before).wait_for()
    page.wait_for_url(re.compile("p.friction=0.1"))
    link = page.url
    page.locator("#skip").focus()
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "headline"
    assert page.url == link


def test_friction_is_chosen_from_published_values_with_its_range(page, address):
    page.goto(f"{address}/{TRACK.replace('&y=beta:5:60', '&y=&p.beta=30')}")
    shown(page)
    choice = page.get_by_label("Published values of the friction coefficient")
    choice.select_option(label="steel on steel, dry: 0.08 to 0.5")
    page.get_by_text("The band: friction coefficient known within 72.41 %.").wait_for()
    assert page.locator("#value-friction").input_value() == "0.29"
    page.locator("#picture .u-over").hover()
    assert re.search(r"\(.* to .*\)", told(page))


def test_nothing_stands_in_the_way_of_anybody(page, address):
    page.goto(f"{address}/{TRACK}&point=0.0003:30")
    shown(page)
    page.locator("#detail .panels polyline").first.wait_for(state="attached")
    for width, height in ((1280, 900), (390, 800)):
        page.set_viewport_size({"width": width, "height": height})
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            assert audited(page) == [], (width, scheme)
