"""Keys that were called otherwise in an earlier version still work in this one."""

from __future__ import annotations

import pytest

from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study

CONTENT = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity"],
    "parameters": {"frequency": 50, "amplitude": "0.3 mm", "beta": 20, "friction": 0.3},
}


RUNS = {
    "kind": "calibrate",
    "scene": "rectangle-on-plane",
    "observations": [{"amplitude": "0.2 mm", "regime": "hops"}],
    "unknowns": {"friction": {"lower": 0.1, "upper": 0.5}},
    "parameters": {"frequency": 50, "beta": 20},
}


@pytest.mark.parametrize(
    ("content", "old", "new", "right", "wrong", "words"),
    [
        (CONTENT, "most_periods", "max_periods", 64, 2, "periods"),
        (RUNS, "doubt", "outlier_probability", 0.02, 0.7, "not a probability between"),
    ],
)
def test_an_old_key_still_works(content, old, new, right, wrong, words):
    before, now = (parse_study({**content, key: right}) for key in (old, new))
    assert getattr(before, new) == right
    assert before.canonical() == now.canonical()
    with pytest.raises(StudyError, match=words):
        parse_study({**content, old: wrong})
