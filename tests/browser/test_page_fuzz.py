"""Random actions: no exception, and then address, fields, picture and crosshair agree."""

from __future__ import annotations

import asyncio
import json
import random
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from bidi import firefox
from links import NUMBERS, SCRIPTS, TEXTS
from night import count
from services import services
from tools import tool

ACTIONS = count(20, 2000, "VIBRAFEED_FUZZ_ACTIONS")
IN_FIREFOX = 200
SEED = 34
MONKEY = (Path(__file__).parent / "monkey.js").read_text()
KINDS = {
    "type": 5,
    "drag": 4,
    "select": 4,
    "point": 3,
    "key": 2,
    "ask": 1,
    "wish": 2,
    "back": 3,
    "pull": 3,
}
SANE = ["*1", "*1.1", "*0.9", "*1.5", "*0.5", "0.3", "0,3", "25 %", "50 Hz", "30°", "0.4 mm"]
RELOAD, KILL, REST = 0.02, 0.005, 0.3


def actions(number: int, seed: int) -> list[dict[str, Any]]:
    """Return random actions; after some of them the page is left to settle."""
    random_ = random.Random(seed)
    hostile = [*NUMBERS, *SCRIPTS, *TEXTS]
    found: list[dict[str, Any]] = []
    for _ in range(number):
        found.append(
            {
                "kind": random_.choices(list(KINDS), list(KINDS.values()))[0],
                "share": random_.random(),
                "text": random_.choice(SANE if random_.random() < 0.6 else hostile),
                "places": [random_.random() for _ in range(random_.randint(2, 6))],
                "reloads": random_.random() < RELOAD,
                "kills": random_.random() < KILL,
                "settles": random_.random() < REST,
            }
        )
    found[-1]["settles"] = True
    return found


@pytest.fixture(scope="module")
def service(tmp_path_factory):
    with services(tmp_path_factory) as start:
        yield start(workers=1)


def test_random_actions_leave_address_fields_and_picture_of_one_mind(page, service):
    page.add_init_script(MONKEY)
    page.goto(f"{service.address}/")
    page.evaluate("settled()")
    done: list[Any] = []
    for action in actions(ACTIONS, SEED):
        done.append(action)
        if action["reloads"]:
            page.reload()
        if action["kills"]:
            service.kill()
        page.evaluate("action => act(action)", action)
        if action["kills"]:
            service.start()
        if action["settles"]:
            page.evaluate("settled()")
            assert page.evaluate("disagreements()") == [], done[-8:]


@pytest.mark.night
def test_random_actions_in_firefox(address, tmp_path):
    program = tool("firefox-esr", "firefox")

    async def carried_out() -> list[str]:
        async with firefox(program, tmp_path) as tab:
            await tab.go(f"{address}/")
            await tab.evaluate(f"(() => {{{MONKEY}}})()")
            await tab.evaluate("settled().then(() => 0)")
            done: list[Any] = []
            for action in actions(IN_FIREFOX, SEED):
                done.append(action)
                await tab.evaluate(f"act({json.dumps(action)}).then(() => 0)")
                if action["settles"]:
                    await tab.evaluate("settled().then(() => 0)")
                    told = "disagreements().then((found) => JSON.stringify(found))"
                    assert json.loads(await tab.evaluate(told)) == [], done[-8:]
            return tab.told

    with ThreadPoolExecutor(1) as thread:  # the browser of the other test has this one's loop
        assert thread.submit(asyncio.run, carried_out()).result() == []
