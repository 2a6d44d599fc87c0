"""The page by night: in Firefox too, under random actions, and in the states of its pictures."""

from __future__ import annotations

import csv
import random
import struct
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import expect, sync_playwright

from benchmarks import page_pictures
from benchmarks.browsing import browsed
from links import NUMBERS, SCRIPTS, TEXTS
from looking import opened, shows, taken_away, watched
from night import count
from services import services
from tools import tool
from waiting import PATIENCE

LINK = (
    "#question=speed&kind=simulate&scene=rectangle-on-plane&output=conveying_velocity"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4"
)
COLOURS = """() => {
  const { width, height } = document.querySelector("#picture canvas");
  const { data } = document.querySelector("#picture canvas").getContext("2d")
    .getImageData(0, 0, width, height);
  return new Set(new Uint32Array(data.buffer)).size;
}"""
ACTIONS = {"chromium": 2000, "firefox": 200}
SEED = 34
MONKEY = (Path(__file__).parent / "monkey.js").read_text()
KINDS = {
    "type": 5, "drag": 4, "select": 4, "point": 3, "key": 2, "ask": 1, "wish": 2, "back": 3,
    "pull": 3,
}  # fmt: skip
SANE = ["*1", "*1.1", "*0.9", "*1.5", "*0.5", "0.3", "0,3", "25 %", "50 Hz", "30°", "0.4 mm"]
HOSTILE = [*NUMBERS, *SCRIPTS, *TEXTS]
RELOAD, KILL, REST = 0.02, 0.005, 0.3


@pytest.fixture(scope="module")
def service(tmp_path_factory):
    with services(tmp_path_factory) as start:
        yield start(workers=1)


@contextmanager
def firefox(profile):
    program = tool("firefox-esr", "firefox")
    with sync_playwright() as playwright:
        # By WebDriver BiDi, which any Firefox speaks.
        context = playwright.firefox.launch_persistent_context(
            profile, channel="moz-firefox", executable_path=program
        )
        yield context
        context.close()


@pytest.fixture(params=ACTIONS)
def page(request, tmp_path):
    tool(*{"chromium": ["chromium"], "firefox": ["firefox-esr", "firefox"]}[request.param])
    expect.set_options(timeout=1000 * PATIENCE)
    with (
        browsed() if request.param == "chromium" else firefox(tmp_path) as context,
        watched(context) as found,
    ):
        found.name = request.param
        yield found


def test_from_the_empty_page_to_a_file(page, service):
    opened(page, f"{service.address}/{LINK}")
    shows(page, {"#progress": "Shown."})
    across, up = map(int, page.locator("#picture .map").get_attribute("data-size").split(" x "))
    assert across == up
    assert 30 < up <= 100  # as fine as this machine draws it in time, and finer than at first
    assert page.evaluate(COLOURS) > 8
    page.locator("#picture .map").click()
    page.locator("#detail .panels polyline").first.wait_for()
    shows(page, {"#answer .answer": "mm/s"})
    rows = list(csv.DictReader(taken_away(page, "Table (CSV)").decode().splitlines()))
    assert len(rows) == across * up
    assert {"amplitude [m]", "beta [degree]", "conveying_velocity [m s-1]"} <= set(rows[0])


def action(chance: random.Random) -> dict[str, Any]:
    """Return a random action; after some of them the page is left to settle."""
    return {
        "kind": chance.choices(list(KINDS), list(KINDS.values()))[0],
        "share": chance.random(),
        "text": chance.choice(SANE if chance.random() < 0.6 else HOSTILE),
        "places": [chance.random() for _ in range(chance.randint(2, 6))],
    }


def test_random_actions_leave_address_fields_and_picture_of_one_mind(page, service):
    page.add_init_script(MONKEY)
    page.goto(f"{service.address}/")
    page.evaluate("settled()")
    chance, done = random.Random(SEED), []
    number = count(20, ACTIONS[page.name], "VIBRAFEED_FUZZ_ACTIONS")
    for left in reversed(range(number)):
        done.append(action(chance))
        if chance.random() < RELOAD:
            page.reload()
        kills = chance.random() < KILL
        if kills:
            service.kill()
        page.evaluate("action => act(action)", done[-1])
        if kills:
            service.start()
        if chance.random() < REST or not left:
            page.evaluate("settled()")
            assert page.evaluate("disagreements()") == [], done[-8:]


def size_of(png):
    return struct.unpack(">II", png[16:24])


@pytest.mark.parametrize("page", ["chromium"], indirect=True)
def test_each_state_of_the_pictures_is_reached_and_fits_a_desk_and_a_phone(page, service):
    told = (page_pictures.FOLDER.parent / "page.md").read_text()
    assert len(page_pictures.STATES) == 8
    for state in page_pictures.STATES:
        page_pictures.reach(page, service.address, state)
        for name, picture in page_pictures.pictures(page, state):
            wide = page.evaluate("document.documentElement.scrollWidth")
            assert wide <= page.viewport_size["width"], name
            assert size_of(picture) == tuple(page.viewport_size.values())
            assert f"(page/{name})" in told
            assert size_of((page_pictures.FOLDER / name).read_bytes()) == size_of(picture)
