"""Units that users write."""

from __future__ import annotations

import pytest

from core.quantities import QUANTITIES
from core.study.units import UnitError, read_number


@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    "unit",
    [
        "mm**99999999",
        "mm^99999999",
        "mm**9**9**9",
        "(mm**9)**9",
        "mm**9e9",
        "mm**9_9",
        "mm**(9)**9",
        "mm²²²²²²²²²",
        "mm*9e999999999",
        "mm*1.e99999999",
        "mm**\N{ARABIC-INDIC DIGIT NINE}9999999",
    ],
)
def test_powers_that_would_take_hours_are_no_units(unit):
    with pytest.raises(UnitError):
        read_number("amplitude", QUANTITIES["amplitude"], f"1 {unit}")


@pytest.mark.parametrize(
    "unit", ["m/s**2", "m/s^2", "m/s²", "m*s**-2", "m s^-2", "m / s ** 2", "mm³/mm²/s**2"]
)
def test_low_powers_are_read(unit):
    shown = 1e-3 if "mm" in unit else 1.0
    assert read_number("gravity", QUANTITIES["gravity"], f"1 {unit}") == shown
