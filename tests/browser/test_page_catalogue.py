"""All systems, models, methods and questions: a number of the service, or a reason."""

from __future__ import annotations

import re
from itertools import chain, product
from typing import Any

import pytest
from playwright.sync_api import Page, Request, expect

from benchmarks.serving import Served
from looking import NUMBER, SENTENCE, numbers, posted
from night import NIGHT

QUESTIONS = (
    "speed", "hop", "resting", "drive", "waves", "springs", "uncertain", "measured", "rows",
    "orienting", "plate", "all",
)  # fmt: skip
OF_A_FILE = "mesh"  # a part that is dropped on the page
KINDS = {"simulate": "methods", "sweep": "variants"}
OF_ANOTHER_STUDY = ("drive", "measured", "uncertain")  # or a range
OWN_MAKING = re.compile("trajectory|does not fit this system|page has an error|undefined")
FACTORS = (1, 1e3, 100, 1e4, 1e-6, 1e-3)


def views(server: Served) -> list[tuple[str, tuple[str, str, str]]]:
    """Return what is looked at: by night everything, by day each system with another question."""
    of_scenes = [
        [
            (kind, scene["name"], choice)
            for kind, of in KINDS.items()
            for choice in scene[of]
            if choice != OF_A_FILE
        ]
        for scene in server.get("/scenes")
    ]
    if NIGHT:
        return [*product(QUESTIONS, chain(*of_scenes))]
    # The question's own system with another variant is the one in which its values do not fit.
    others = [("orienting", ("sweep", "orienting-line", "cylinder"))]
    some = [one[place % len(one)] for place, one in enumerate(of_scenes)]
    return others + [(QUESTIONS[k % len(QUESTIONS)], one) for k, one in enumerate(some)]


def test_every_system_by_every_method_answers_every_question(page: Page, server: Served) -> None:
    studies: list[Any] = []

    def hear(request: Request) -> None:
        if request.method == "POST" and "/execution" in request.url:
            studies.append(request.post_data_json)

    page.on("request", hear)
    for question, (kind, scene, choice) in views(server):
        link = f"#question={question}&kind={kind}&scene={scene}&choice={choice}"
        page.goto("about:blank")
        studies.clear()
        page.goto(f"{server.address}/{link}")
        expect(page.locator("#answer"), link).to_have_attribute("aria-busy", "false")
        expect(page.locator(NUMBER), link).not_to_be_empty()
        expect(page.locator("#notice"), link).to_be_empty()
        assert not OWN_MAKING.search(page.locator(SENTENCE).inner_text()), link
        if question in OF_ANOTHER_STUDY:
            continue
        (output,) = re.findall("output=([^&]*)", page.url)
        one = next(
            study
            for study in studies
            if study["kind"] == kind
            and not any(isinstance(v, dict | list) for v in study["parameters"].values())
        )
        value = posted(server.address, one)[output]
        if value and abs(value) > 1e-9:
            shown = numbers(page.locator("#answer .answer").inner_text())[0]
            assert shown in [pytest.approx(value * by, rel=1e-2, abs=1e-9) for by in FACTORS], link
