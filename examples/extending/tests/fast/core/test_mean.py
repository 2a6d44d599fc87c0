"""The mean of closed forms: by hand, and between its cells."""

import numpy as np
import pytest

from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import KINDS, tabulate

EXAMPLE = {**KINDS["mean"].example}


def values(content):
    return tabulate(prepare_content(content)).variables["throw_number"].values


def test_the_mean_of_two_throw_numbers():
    # a w^2 sin(beta) / g at 0.5 mm and 1 mm: the mean is that at 0.75 mm
    expected = 0.75e-3 * (2 * np.pi * 50) ** 2 * 0.5 / 9.80665
    assert float(values(EXAMPLE)) == pytest.approx(expected, rel=1e-14)


def test_it_lies_between_its_cells():
    cells = values({**EXAMPLE, "kind": "sweep"})
    assert cells.min() < float(values(EXAMPLE)) < cells.max()
