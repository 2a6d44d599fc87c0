"""Units of screens and pictures."""

from __future__ import annotations

import math

import pytest

from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.shown import SI, Shown, ShownUnits, read_shown
from vibrafeed.core.study.units import UnitError


def test_the_trade_reads_millimetres_and_si_does_not():
    assert ShownUnits().of("m s-1", 12.0) == Shown(1000.0, "mm/s")
    assert ShownUnits("si").of("m s-1", 0.01) == Shown(1.0, "m/s")
    assert read_shown(["SI"]).of("m", 0.01) == Shown(1.0, "m")


@pytest.mark.parametrize(("largest", "unit"), [(0.05, "g"), (0.5, "kg"), (0.0, "kg")])
def test_what_is_small_is_read_in_the_thousandth(largest, unit):
    assert ShownUnits().of("kg", largest).unit == unit


def test_a_unit_stands_for_its_kind():
    units = read_shown(["m/min", "rad", "si"])
    assert units.of("m s-1", 1.0) == Shown(60.0, "m/min")
    assert units.of("degree", 1.0).factor == pytest.approx(math.pi / 180, rel=1e-15)
    assert units.of("m", 1e-3) == Shown(1.0, "m")


def test_every_unit_of_a_quantity_can_be_asked_for_and_read():
    for unit in {quantity.unit for quantity in QUANTITIES.values()} - {"1"}:
        shown = ShownUnits("si").of(unit, 1.0)
        assert "-1" not in shown.unit, f"{unit} is written as {shown.unit}: add it to SI"
    assert SI["m s-2"] == "m/s²"


@pytest.mark.parametrize("words", [["candela"], [""], ["1"], ["mm/s", "m/min"]])
def test_what_is_no_unit_is_refused(words):
    with pytest.raises(UnitError):
        read_shown(words)
