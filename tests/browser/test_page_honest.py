"""Colours keep their meaning, what is not valid is hatched, and what is saved says what it is."""

from __future__ import annotations

import csv
import math
import re
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from looking import opened, revealed, taken_away, typed
from night import NIGHT, spread
from tools import tool

CLOSED = (
    "#question=all&kind=sweep&scene=rectangle-on-plane&choice=physical&output=acceleration_x"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4"
)
MOTION = (
    "#question=speed&kind=simulate&scene=rectangle-on-plane&output=conveying_velocity"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4"
)
LINES = MOTION.replace("&y=beta:5:60", "&y=&p.beta=30")
SHIFTS = """
window.shifted = 0;
new PerformanceObserver((list) => {
  for (const entry of list.getEntries()) if (!entry.hadRecentInput) window.shifted += entry.value;
}).observe({ type: "layout-shift", buffered: true });
"""
MAX_SHIFT = 0.1  # what the Web Vitals call good


def saved(page: Page, name: str, folder: Path) -> Path:
    download = taken_away(page, name)
    target = folder / download.suggested_filename
    download.save_as(target)
    return target


def test_colours_keep_their_meaning_while_a_slider_is_dragged(page: Page, address: str) -> None:
    opened(page, f"{address}/{CLOSED}")
    bar = page.locator("#picture .scale [role=img]")
    before = bar.get_attribute("aria-label")
    slider = page.get_by_label("Frequency, slider")
    slider.scroll_into_view_if_needed()
    thumb = slider.bounding_box()
    assert thumb is not None
    y = thumb["y"] + 0.5 * thumb["height"]
    page.mouse.move(thumb["x"] + 0.5 * thumb["width"], y)
    page.mouse.down()
    page.mouse.move(thumb["x"] + 0.8 * thumb["width"], y, steps=5)
    expect(page.locator("#picture .scale")).to_contain_text("beyond the ends")
    assert bar.get_attribute("aria-label") == before
    page.mouse.up()
    expect(page.locator("#picture .scale")).not_to_contain_text("beyond the ends")
    assert bar.get_attribute("aria-label") != before


def test_what_describes_no_real_part_is_hatched(page: Page, address: str) -> None:
    opened(page, f"{address}/{CLOSED}")
    expect(page.locator("#note")).to_contain_text(re.compile("^Hatched, .* %: the part has left"))
    assert page.locator("#picture .hatch path").count() == 1
    opened(page, f"{address}/{MOTION}")
    assert page.locator("#picture .hatch path").count() == 0


def test_borders_lie_where_the_part_lifts_off(page: Page, address: str) -> None:
    opened(page, f"{address}/{CLOSED}")
    picture = page.locator("#picture .map[data-borders=exact]")
    expect(picture).to_be_attached()
    left, low = (float(picture.locator(".frame").get_attribute(name) or 0) for name in "xy")
    wide, tall = (
        float(picture.locator(".frame").get_attribute(n) or 0) for n in ("width", "height")
    )
    found = [
        [tuple(map(float, point.split(","))) for point in re.findall(r"[\d.-]+,[\d.-]+", drawn)]
        for drawn in picture.locator(".borders .border").evaluate_all(
            "all => all.map((one) => one.getAttribute('d'))"
        )
    ]
    weight = 9.80665 / (2 * math.pi * 50) ** 2

    def apart(x: float, y: float) -> float:
        """Return how many dots a point lies from where the throw number is 1, up or across."""
        amplitude = 1e-4 + (x - left) / wide * 6e-4
        beta = math.radians(5 + (low + tall - y) / tall * 55)
        up = math.degrees(math.asin(min(1, weight / amplitude)) - beta) * tall / 55
        return min(abs(up), abs(weight / math.sin(beta) - amplitude) * wide / 6e-4)

    inside = [
        [apart(x, y) for x, y in ring if left < x < left + wide and low < y < low + tall]
        for ring in found
    ]
    # One border is that of lift-off; half a value of the picture is 2 to 3 dots.
    assert min(max(ring) for ring in inside if len(ring) > 50) < 1.5


@pytest.mark.parametrize("link", spread([CLOSED, MOTION, LINES], 2))
def test_a_saved_picture_says_what_it_shows(
    page: Page, address: str, tmp_path: Path, link: str
) -> None:
    opened(page, f"{address}/{link}")
    root = ElementTree.fromstring(saved(page, "Picture (SVG)", tmp_path).read_text())
    words = " ".join(root.itertext())
    assert page.locator("#headline").inner_text() in words
    assert "frequency 50\u00a0hz" in words.lower()
    assert "friction coefficient 0.4" in words.lower()
    assert page.url in words  # the view that it belongs to
    if "&y=beta" in link:
        bars = [one for one in root.iter() if one.get("class") == "bar"]
        assert len(bars) == 1
        assert any(one.get("class") == "tick" for one in bars[0].iter())
    assert saved(page, "Picture (PNG)", tmp_path).read_bytes().startswith(b"\x89PNG")


def test_every_file_that_is_offered_comes(page: Page, address: str, tmp_path: Path) -> None:
    opened(page, f"{address}/{CLOSED}")
    for name, starts in (
        ("NetCDF", b"\x89HDF"),
        ("Table (XLSX)", b"PK"),
        ("Study (TOML)", b"kind"),
    ):
        assert saved(page, name, tmp_path).read_bytes().startswith(starts)
    assert next(csv.reader(saved(page, "Table (CSV)", tmp_path).read_text().splitlines()))


def test_the_command_for_curl_brings_the_same_study(
    page: Page, address: str, tmp_path: Path
) -> None:
    curl, shell = tool("curl"), tool("sh")
    opened(page, f"{address}/{CLOSED}")
    command = saved(page, "Code for curl", tmp_path).read_text()
    assert command.startswith("curl ")
    done = subprocess.run(
        [shell, "-c", command.replace("curl ", f"{curl} -s -H 'Prefer: respond-async' ", 1)],
        capture_output=True,
        check=True,
    )
    assert b'"jobID"' in done.stdout


@pytest.mark.parametrize("size", [(1440, 900), (390, 844)])
def test_nothing_moves_while_the_page_opens(
    page: Page, address: str, size: tuple[int, int]
) -> None:
    page.add_init_script(SHIFTS)
    page.set_viewport_size({"width": size[0], "height": size[1]})
    questions = ("speed", "drive", "thesis", "all")
    # By day each at one size: the two with most beside the picture on a phone.
    for question in questions if NIGHT else questions[size[0] < 1000 :: 2]:
        page.goto("about:blank")
        opened(page, f"{address}/#question={question}")
        assert page.evaluate("window.shifted") < MAX_SHIFT, question


def test_a_mistake_is_told_in_the_words_of_the_page(page: Page, address: str) -> None:
    opened(page, f"{address}/{MOTION}")
    typed(page, "#value-gravity", "-1")
    expect(page.locator("#wrong-gravity")).to_contain_text("Gravity is")
    expect(page.locator("#wrong-gravity")).not_to_contain_text("m s-2")
    revealed(page, "#meaning")
    expect(page.locator("#meaning")).to_contain_text("Conveying velocity")
    expect(page.locator("#version")).to_have_text(re.compile(r"^\d+\.\d+"))
