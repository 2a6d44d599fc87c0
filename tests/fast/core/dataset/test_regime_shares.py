"""Shares of regimes, and how they are written."""

from __future__ import annotations

import numpy as np
import pytest

from vibrafeed.core.dataset.table import percent, regime_shares
from vibrafeed.core.quantities import REGIMES

SLIP, HOPPING = REGIMES["slip"].value, REGIMES["hopping"].value


def test_every_cell_counts_as_one():
    regimes = np.array([[HOPPING, SLIP, SLIP], [SLIP, SLIP, SLIP]], dtype=np.int8)
    assert regime_shares(regimes) == {"slip": pytest.approx(5 / 6), "hopping": pytest.approx(1 / 6)}


@pytest.mark.parametrize(
    ("share", "text"),
    [
        (0.0004, "< 0.1 %"),
        (0.0123, "1.2 %"),
        (0.476, "48 %"),
        (0.998, "99.8 %"),
        (0.99999, "99.9 %"),
        (1.0, "100 %"),
    ],
)
def test_small_shares_have_a_digit_more(share, text):
    assert percent(share).replace("\N{NO-BREAK SPACE}", " ") == text
