"""Numbers in sentences of the command line: as many digits as say something."""

from __future__ import annotations

import numpy as np
import pytest

from vibrafeed.core.dataset.table import percent_with_error
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.plan.prepared import in_words


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.8, 0.00535, "80.0 ± 0.5 %"),
        (0.759, 0.019, "76 ± 2 %"),
        (0.0123, 0.0123, "1 ± 1 %"),
        (-0.0001, 0.02, "0 ± 2 %"),
        (0.25, None, "25.0 %"),
        (0.25, 0.0, "25.0 ± 0.0 %"),
        (np.nan, 0.1, "-"),
    ],
)
def test_a_share_has_the_decimals_that_its_error_leaves(value, error, text):
    shown = percent_with_error(value, error)
    assert shown.replace(" % ±", " ±") == text


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.0123, "0.012 s"), (100, "100 s"), (8.4e2 * 86_400, "840 days"), (1e9, "12,000 days")],
)
def test_a_time_is_never_in_powers_of_ten(seconds, words):
    assert in_words(seconds) == words


def test_one_cell_is_a_cell():
    content = {"kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["throw_number"]}
    content["parameters"] = {"frequency": 50, "amplitude": 1e-4, "beta": 20}
    assert prepare_content(content).size_in_words.startswith("1 cell, ")
