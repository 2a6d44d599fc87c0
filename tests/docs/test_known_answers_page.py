"""The page of known answers is up to date, and the engines' driver finds what is known."""

import re

import numpy as np
import pytest

from benchmarks.engine_drivers import follow
from benchmarks.known_answers_page import PAGE, page
from benchmarks.validation_engines import ASKED, PICTURE, RESULTS, answer, asked_cases, jobs

NUMBER = re.compile(r"(?<![\w.-])-?\d+\.\d+(?:e-?\d+)?")


def parts(text: str) -> tuple[list[str], list[float]]:
    """Return what stands between the numbers of a text, and the numbers."""
    return NUMBER.split(text), [float(number) for number in NUMBER.findall(text)]


def test_the_page_is_up_to_date():
    (now, numbers), (then, known) = map(parts, (page(), PAGE.read_text(encoding="utf-8")))
    assert now == then, "python -m benchmarks.known_answers_page"
    # Another processor may round the last of the ten digits that the page has otherwise.
    np.testing.assert_allclose(numbers, known, rtol=1e-8, atol=1e-12)
    assert RESULTS.exists()
    assert PICTURE.exists()
    assert "**wrong**" not in PAGE.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ASKED)
def test_an_engine_comes_near(name):
    case, truth = asked_cases()[name]
    # 100 steps a period tell a mean, 500 a speed at one phase.
    job = jobs(case)[2 if case.name.startswith("Z") else 1]
    found = answer(case, len(job["gravities"]), follow("pymunk", job))
    assert found == pytest.approx(truth, rel=0.04)
