"""Worked values, computed independently of this code, digit by digit."""

from __future__ import annotations

import pytest

from benchmarks.worked_values import CLOSED_FORMS, Row
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study

EXACT = 1e-13


@pytest.mark.parametrize(
    "row", CLOSED_FORMS, ids=lambda row: f"{row.scene}-{row.variant}-{row.output}-{row.value}"
)
def test_a_worked_value(row: Row) -> None:
    study = {
        "kind": "sweep", "scene": row.scene, "variant": row.variant, "outputs": [row.output],
        "parameters": row.given,
    }  # fmt: skip
    found = float(run_study(parse_study(study))[row.output])
    if row.half_unit is None:
        assert found == pytest.approx(row.value, rel=EXACT)
    else:
        assert found == pytest.approx(row.value, abs=row.half_unit, rel=0)
