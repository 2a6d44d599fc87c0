"""The page of known answers is up to date, and the engines' driver finds what is known."""

import re

import numpy as np
import pytest

from benchmarks.engine_drivers import follow
from benchmarks.validation_engines import ASKED, PICTURE, RESULTS, STEPS, answer, asked_cases, jobs
from benchmarks.validation_page import PAGE, page

NUMBER = re.compile(r"(?<![\w.-])-?\d+\.\d+(?:e-?\d+)?")


def parts(text: str) -> tuple[list[str], list[float]]:
    """Return what stands between the numbers of a text, and the numbers."""
    return NUMBER.split(text), [float(number) for number in NUMBER.findall(text)]


def test_the_page_is_up_to_date():
    (now, numbers), (then, known) = map(parts, (page(), PAGE.read_text(encoding="utf-8")))
    assert now == then, "python -m benchmarks.validation_page"
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


def test_errors_of_an_engine_shrink_with_its_step():
    """It is of first order: a tenth of the step is a tenth of the error, or less."""
    case, truth = asked_cases()["V-speed-7"]
    of_steps = dict(zip(STEPS, jobs(case), strict=True))
    coarse, fine = (
        abs(answer(case, steps, follow("pymunk", of_steps[steps])) / truth - 1)
        for steps in (100, 2000)
    )
    assert coarse < 0.04  # a step is 1 % of a period
    assert fine < coarse / 10
