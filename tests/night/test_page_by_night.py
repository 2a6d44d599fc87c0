"""The page by night: in Firefox too, and under random actions."""

import asyncio
import csv
import json
import random
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import expect

from benchmarks.browsing import browsed
from bidi import Tab, firefox
from links import NUMBERS, SCRIPTS, TEXTS
from looking import watched
from night import count
from services import services
from tools import tool
from waiting import PATIENCE, awaited

LINK = (
    "#question=speed&kind=simulate&scene=rectangle-on-plane&output=conveying_velocity"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4"
)
SHOWN = """document.getElementById("progress")?.textContent === 'Shown.'"""
MIDDLE = """(() => {
  const box = document.querySelector("#picture .map").getBoundingClientRect();
  return `${box.x + box.width / 2} ${box.y + box.height / 2}`;
})()"""
SIZE = 'document.querySelector("#picture .map").dataset.size'
COLOURS = """(() => {
  const { width, height } = document.querySelector("#picture canvas");
  const { data } = document.querySelector("#picture canvas").getContext("2d")
    .getImageData(0, 0, width, height);
  return new Set(new Uint32Array(data.buffer)).size;
})()"""
SAVE = """(() => {
  document.getElementById("take-away").click();
  const items = [...document.querySelectorAll("#away-menu button")];
  items.find((one) => one.textContent === "Table (CSV)").click();
})()"""
ACTIONS = count(200, 2000, "VIBRAFEED_FUZZ_ACTIONS")
OF_FIREFOX = ACTIONS // 10
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


@pytest.fixture
def page():
    tool("chromium")
    expect.set_options(timeout=1000 * PATIENCE)
    with browsed() as context, watched(context) as found:
        yield found


async def to_a_file(tab: Tab, address: str, folder: Path) -> None:
    """Go from the empty page to a drawn map, a motion, and a file of all its values."""
    await tab.go(f"{address}/{LINK}")
    await tab.until(SHOWN)
    across, up = map(int, (await tab.evaluate(SIZE)).split(" x "))
    assert across == up
    assert 30 < up <= 100  # as fine as this machine draws it in time, and finer than at first
    assert await tab.evaluate(COLOURS) > 8
    await tab.click(*map(float, (await tab.evaluate(MIDDLE)).split()))
    await tab.until("""document.querySelector("#detail .panels polyline")""")
    assert "mm/s" in await tab.evaluate("""document.querySelector("#answer .answer").textContent""")
    await tab.evaluate(SAVE)
    text = await awaited(lambda: "".join(path.read_text() for path in folder.glob("*.csv")))
    rows = list(csv.DictReader(text.splitlines()))
    assert len(rows) == across * up
    assert {"amplitude [m]", "beta [degree]", "conveying_velocity [m s-1]"} <= set(rows[0])


def test_from_the_empty_page_to_a_file_in_firefox(service, tmp_path):
    program = tool("firefox-esr", "firefox")

    async def walked() -> Tab:
        async with firefox(program, tmp_path) as tab:
            await to_a_file(tab, service.address, tmp_path / "saved")
        return tab

    tab = asyncio.run(walked())
    assert tab.told == []
    own = (service.address, "data:", "blob:")
    assert [one for one in tab.asked if not one.startswith(own)] == []


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
    for left in reversed(range(ACTIONS)):
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


def test_random_actions_in_firefox(service, tmp_path):
    program = tool("firefox-esr", "firefox")

    async def walked() -> None:
        async with firefox(program, tmp_path) as tab:
            await tab.go(f"{service.address}/")
            await tab.evaluate(MONKEY)
            await tab.evaluate("settled()")
            chance, done = random.Random(SEED), []
            for left in reversed(range(OF_FIREFOX)):
                done.append(action(chance))
                await tab.evaluate(f"act({json.dumps(done[-1])})")
                if chance.random() < REST or not left:
                    await tab.evaluate("settled()")
                    assert await tab.evaluate("disagreements().then(String)") == "", done[-8:]

    asyncio.run(walked())
