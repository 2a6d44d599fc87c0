"""All systems, models, methods and questions: a number of the service, or a reason."""

from __future__ import annotations

import json
import re
import urllib.request
from itertools import product
from typing import Any

import pytest
from playwright.sync_api import Page, Request, expect

from looking import NUMBER, SENTENCE, posted
from night import NIGHT
from waiting import PATIENCE

QUESTIONS = (
    "speed",
    "hop",
    "resting",
    "drive",
    "waves",
    "springs",
    "uncertain",
    "measured",
    "rows",
    "orienting",
    "all",
)
OWN_MAKING = re.compile("trajectory|has no output|is not a parameter|page has an error|undefined")


def views(address: str) -> list[tuple[str, str, str, str]]:
    """Return what is looked at: by night everything, by day each system once."""
    with urllib.request.urlopen(f"{address}/scenes", timeout=PATIENCE) as reply:
        scenes = json.load(reply)
    found = []
    for place, scene in enumerate(scenes):
        kinds = {"simulate": scene["methods"], "sweep": scene["variants"]}
        of_scene = [(kind, scene["name"], choice) for kind in kinds for choice in kinds[kind]]
        if NIGHT:
            found += [(question, *one) for question, one in product(QUESTIONS, of_scene)]
        else:
            found.append((QUESTIONS[place % len(QUESTIONS)], *of_scene[0]))
    return found


def test_every_system_by_every_method_answers_every_question(page: Page, address: str) -> None:
    studies: list[Any] = []

    def hear(request: Request) -> None:
        if request.method == "POST" and "/execution" in request.url:
            studies.append(request.post_data_json)

    page.on("request", hear)
    for question, kind, scene, choice in views(address):
        link = f"#question={question}&kind={kind}&scene={scene}&choice={choice}"
        page.goto("about:blank")
        studies.clear()
        page.goto(f"{address}/{link}")
        expect(page.locator("#answer"), link).to_have_attribute("aria-busy", "false")
        expect(page.locator(NUMBER), link).not_to_be_empty()
        expect(page.locator("#notice"), link).to_be_empty()
        assert not OWN_MAKING.search(page.locator(SENTENCE).inner_text()), link
        if question in ("drive", "measured", "uncertain"):
            continue  # the number is of another study, or a range
        output = re.search("output=([^&]*)", page.url)
        assert output is not None
        one = next(
            study
            for study in studies
            if study["kind"] == kind
            and not any(isinstance(v, dict | list) for v in study["parameters"].values())
        )
        value = posted(address, one)[output[1]]["data"]
        shown = page.locator("#answer .answer").inner_text().replace("\u2212", "-")
        number = float(re.findall(r"-?[\d.]+(?:e[+-]?\d+)?", shown)[0]) if value is not None else 0
        factors = (1, 1e3, 100, 1e4, 1e-6, 1e-3)
        close = [pytest.approx(value * one, rel=1e-2, abs=1e-9) for one in factors if value]
        assert not value or abs(value) < 1e-9 or number in close, (link, shown, value)
