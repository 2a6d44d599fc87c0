"""Every known answer is found, and a wrong one would be noticed."""

import numpy as np
import pytest

from benchmarks.known_answers import FILES, Found, Known, fault, found, known_answers
from night import NIGHT

TOO_WIDE = {
    **{
        f"K, gravity {ulps:+d} ulp from the drive": "the roundings of A0 w^2 are larger than K"
        for ulps in (-3, -1, 0, 1, 3)
    },
    "m tau, mu = mu_c (1+0)": "what the rounding of mu_c leaves, below that of the sum",
}
"""Answers that a wrong value would pass, with the reason why it must be so."""

BY_NIGHT = {"hard-grids"}
"""Files with an axis of ten million values."""


def wrong_values(known: Known, result: Found) -> list[np.ndarray]:
    """Return results with one cell made wrong, each in turn."""
    wrongs = []
    values = np.atleast_1d(np.asarray(known.value, dtype=np.float64))
    for cell, right in enumerate(values.flat):
        if known.relation != "equals":
            off = 2 * known.tolerance or 0.5 * abs(right) or 1.0
            others = [right + off if known.relation == "at most" else right - off]
        elif np.isfinite(right) and right:
            others = [1.5 * right, -right, 0.0]
        else:
            others = [1.0, -1.0]
        for other in others:
            changed = np.broadcast_to(result.value, values.shape).copy()
            changed.flat[cell] = other
            wrongs.append(changed)
    return wrongs


@pytest.mark.parametrize("file", [file for file in FILES if NIGHT or file not in BY_NIGHT])
def test_every_answer_is_right_and_a_wrong_one_would_not_be(file: str) -> None:
    tables: dict = {}
    wrong = {}
    for known in known_answers(file):
        if text := fault(known, tables):
            wrong[known.name] = text
        elif hasattr(known, "value") and known.relation != "shown":
            result = found(known, tables)
            wrongs = wrong_values(known, result)
            passing = [one for one in wrongs if known.holds(one, result.stated)]
            if bool(passing) != (known.name in TOO_WIDE):
                wrong[known.name] = f"{passing} would pass"
    assert not wrong


def test_answers_have_names_of_their_own_and_sources() -> None:
    answers = [one for file in FILES for one in known_answers(file)]
    assert len({one.name for one in answers}) == len(answers) == 930
    for one in answers:
        judged = hasattr(one, "value") or one.status or one.refused
        assert judged, one.name
        assert not hasattr(one, "value") or one.source, one.name
        for term in one.terms:
            study = term.get("study", one.study)
            assert term["output"] in study["outputs"] or "trajectory" in study, one.name
