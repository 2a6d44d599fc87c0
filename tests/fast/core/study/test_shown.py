"""Units of screens and pictures."""

from __future__ import annotations

import math

import pytest

from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.shown import SI, Shown, ShownUnits, read_shown
from vibrafeed.core.study.units import UnitError


def test_every_unit_of_a_quantity_can_be_asked_for_and_read():
    for unit in {quantity.unit for quantity in QUANTITIES.values()} - {"1"}:
        shown = ShownUnits("si").of(unit, 1.0)
        assert "-1" not in shown.unit, f"{unit} is written as {shown.unit}: add it to SI"
    assert SI["m s-2"] == "m/s²"


@pytest.mark.parametrize("words", [["candela"], [""], ["1"], ["mm/s", "m/min"]])
def test_what_is_no_unit_is_refused(words):
    with pytest.raises(UnitError):
        read_shown(words)


@pytest.mark.parametrize(
    ("words", "unit", "largest", "factor", "shown"),
    [
        ([], "m s-1", 12.0, 1000.0, "mm/s"),
        (["SI"], "m s-1", 0.01, 1.0, "m/s"),
        ([], "kg", 0.05, 1000.0, "g"),
        ([], "kg", 0.5, 1.0, "kg"),
        ([], "kg", 0.0, 1.0, "kg"),
        (["m/min", "rad", "si"], "m s-1", 1.0, 60.0, "m/min"),
        (["m/min", "rad", "si"], "m", 1e-3, 1.0, "m"),
        (["rad"], "degree", 1.0, math.pi / 180, "rad"),
    ],
)
def test_a_unit_stands_for_its_kind(words, unit, largest, factor, shown):
    found = read_shown(words).of(unit, largest)
    assert found == Shown(pytest.approx(factor, rel=1e-15), shown)
