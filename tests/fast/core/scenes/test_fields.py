"""Quantities that stand in a bundle are rows of a table, and equations like any other."""

from __future__ import annotations

import pickle
from typing import NamedTuple

import numpy as np

from vibrafeed.core.scenes.scene import fields


class Pair(NamedTuple):
    sides: tuple[np.ndarray, np.ndarray]
    points: np.ndarray


ROWS = fields(
    "planar_impulse",
    "theory 5.2",
    gap=("sides", 1, "the second side [m]"),
    normal_x=("points", (..., 0), "the first column [1]"),
)


def test_a_row_is_an_equation():
    gap, _ = ROWS
    assert gap.gives == "gap"
    assert gap.inputs == ("planar_impulse",)
    assert gap.summary == "The second side."
    assert (gap.source, gap.variant) == ("theory 5.2", "all")


def test_it_gives_the_field_itself():
    pair = Pair((np.zeros(2), np.ones(2)), np.arange(6.0).reshape(2, 3))
    gap, normal = ROWS
    assert gap.function(planar_impulse=pair) is pair.sides[1]
    assert normal.function(planar_impulse=pair).tolist() == [0.0, 3.0]


def test_a_worker_can_be_sent_one():
    sent = pickle.loads(pickle.dumps(ROWS[0]))
    assert sent.inputs == ROWS[0].inputs
    assert sent.summary == ROWS[0].summary
