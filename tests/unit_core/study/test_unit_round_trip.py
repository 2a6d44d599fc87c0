"""Units that vibrafeed writes, to files, headings and the screen, are read again."""

from __future__ import annotations

import math

import numpy as np
import pytest
import xarray
from hypothesis import given, settings
from hypothesis import strategies as st

import vibrafeed
from vibrafeed.core.dataset.frame import heading
from vibrafeed.core.dataset.table import TableVariable, quantity_attributes
from vibrafeed.core.quantities import QUANTITIES, Quantity
from vibrafeed.core.study.shown import SI, SMALLER, TRADE, ShownUnits, read_shown
from vibrafeed.core.study.units import UnitError, read_number, unit_factor, with_unit
from vibrafeed.core.tables.headings import name_and_unit

UNITS = sorted({quantity.unit for quantity in QUANTITIES.values()})
SUPERSCRIPTS = str.maketrans("-123", "⁻¹²³")
# A shown value is rounded three times at most: its factor, the product, and what is read of it.
THREE_ROUNDINGS = 4 * 2.0**-53
NUMBERS = st.floats(-1e280, 1e280).filter(lambda x: x == 0 or abs(x) > 1e-280)


def free(unit):
    """A quantity of a unit, without bounds."""
    return Quantity(unit, "x", "Value", "A value.", examples=(f"1 {unit}",))


def spellings(unit):
    """The ways in which a unit is written in files, by CF, in SI and in other programs."""
    yield unit
    if unit != "1":
        yield SI.get(unit, unit)
        yield unit.translate(SUPERSCRIPTS)  # m s⁻²
        yield unit.translate(SUPERSCRIPTS).replace(" ", "·")
        yield unit.replace(" ", ".")
        yield unit.replace(" ", "\N{NO-BREAK SPACE}").replace("-", "\N{MINUS SIGN}")


@pytest.mark.parametrize("unit", UNITS)
@settings(max_examples=30, deadline=None)
@given(x=NUMBERS)
def test_what_is_written_in_the_unit_of_files_is_read_to_the_bit(unit, x):
    for spelled in spellings(unit):
        assert read_number("value", free(unit), f"{x!r} {spelled}") == x
        assert read_number("value", free(unit), with_unit(repr(x), spelled)) == x


@pytest.mark.parametrize("unit", UNITS)
@settings(max_examples=30, deadline=None)
@given(x=NUMBERS)
def test_what_a_person_is_shown_is_read(unit, x):
    shown = {ShownUnits().of(unit, abs(x)), ShownUnits("si").of(unit, abs(x))}
    for one in shown:
        read = read_number("value", free(unit), f"{x * one.factor!r} {one.unit}")
        assert math.isclose(read, x, rel_tol=THREE_ROUNDINGS)


@pytest.mark.parametrize("name", sorted(QUANTITIES))
def test_each_quantity_is_read_from_the_headings_of_its_own_files(name):
    quantity = QUANTITIES[name]
    value = next(x for x in (0.3, 1.0, 3.0, 30.0) if quantity.lower < x <= quantity.upper)
    column = TableVariable((), np.array(value), quantity_attributes(name))
    found, unit = name_and_unit(heading(name, column))
    assert found == name
    assert read_number(name, quantity, with_unit(repr(value), unit)) == value
    assert read_number(name, quantity, f"{value!r} {quantity.unit}") == value


@pytest.mark.parametrize(
    ("unit", "shown"),
    [(unit, shown) for unit, shown in SI.items() if shown]
    + [(unit, shown) for table in (TRADE, SMALLER) for unit, (_, shown) in table.items()],
)
def test_each_unit_of_the_screen_is_a_heading_and_a_choice(unit, shown):
    assert name_and_unit(f"value [{shown}]") == ("value", shown)
    factor = unit_factor("value", free(unit), shown)
    (chosen,) = read_shown([shown]).wanted.values()
    assert chosen.unit == shown
    assert math.isclose(chosen.factor * float(factor), 1.0, rel_tol=THREE_ROUNDINGS)


@pytest.mark.parametrize(
    ("unit", "texts"),
    [
        ("m s-2", "m/s2 m/s^2 m/s² m·s⁻² m.s-2 m/s/s ms-2 m*s**-2 meter/second**2"),
        ("Hz", "1/s s⁻¹ s-1 cps rps rev/s cycles/s"),
        ("min-1", "1/min /min parts/min part/min pcs/min pieces/min Parts/min ppm min⁻¹"),
        ("degree", "deg ° º ˚ degrees Deg"),
        ("s", "sec Sec seconds second (s)"),
        ("N s m-1", "N·s/m N*s/m N.s.m-1 kg/s"),
        ("kg m2", "kg·m² kg*m^2 kg.m2"),
        ("Pa", "N/m² N/m2 N.m-2"),
        ("1", "1 - dimensionless"),
    ],
)
def test_spellings_of_the_field(unit, texts):
    for text in texts.split():
        assert unit_factor("value", free(unit), text) == 1, text


def test_micro_has_two_signs():
    for sign in ("\N{MICRO SIGN}m", "\N{GREEK SMALL LETTER MU}m", "um"):
        assert read_number("value", free("m"), f"250 {sign}") == 250e-6


def test_g_is_what_the_quantity_weighs():
    """The gram of a mass; the standard gravity of an acceleration; of gravity itself a slip."""
    for text, right in (("g", 9.80665), ("G", 9.80665), ("gn", 9.80665), ("mg", 0.00980665)):
        assert float(unit_factor("value", free("m s-2"), text)) == right
    assert float(unit_factor("value", free("kg"), "g")) == 0.001
    assert float(unit_factor("value", free("kg"), "mg")) == 1e-6
    assert read_shown(["g"]).of("kg", 1.0).factor == 1000.0
    for name, text in (("gravity", "9.8 g"), ("mass", "3 G"), ("acceleration_along_1", "3 gram")):
        with pytest.raises(UnitError):
            read_number(name, QUANTITIES[name], text)


def test_a_turn_a_minute_is_a_frequency_and_an_angular_velocity():
    """pint reads rpm as radians a second: as a frequency that would be off by 2 pi."""
    for text in (
        "rpm",
        "RPM",
        "1/min",
        "1 / min",
        "/ min",
        "per minute",
        "rev/min",
        "r/min",
        "vib/min",
        "min-1",
        "strokes/min",
    ):
        assert read_number("frequency", QUANTITIES["frequency"], f"3000 {text}") == 50.0
    spin = read_number("spin_rate", QUANTITIES["spin_rate"], "3000 rpm")
    assert math.isclose(spin, 100 * math.pi, rel_tol=1e-15)
    for text in ("314 rad/s", "314 rad s-1", "314 rad·s⁻¹"):
        with pytest.raises(UnitError, match="angular velocity"):
            read_number("frequency", QUANTITIES["frequency"], text)


@pytest.mark.parametrize(
    ("text", "right"),
    [("\N{MINUS SIGN}5 deg", -5.0), ("\N{EN DASH}5 deg", -5.0), ("5e\N{MINUS SIGN}1 °", 0.5),
     ("5\N{NO-BREAK SPACE}º", 5.0), ("\N{NARROW NO-BREAK SPACE}5 deg", 5.0)],
)  # fmt: skip
def test_signs_of_word_processors_are_read(text, right):
    assert read_number("gamma", QUANTITIES["gamma"], text) == right


STUDY = {"scene": "rectangle-on-plane", "outputs": ["throw_number"]}


def test_the_settings_of_a_motion_are_read_from_its_coordinates():
    point = {"frequency": 50, "amplitude": "0.2 mm", "beta": 20, "friction": 0.3}
    first = vibrafeed.simulate(scene="rectangle-on-plane", **point)
    given = {name: first[name] for name in (*point, "gravity", "gamma", "alpha", "tolerance")}
    again = vibrafeed.simulate(scene="rectangle-on-plane", **given)
    xarray.testing.assert_identical(again.conveying_velocity, first.conveying_velocity)


def test_the_coordinates_of_a_file_are_parameters(tmp_path):
    first = vibrafeed.sweep(
        **STUDY, frequency="3000 rpm", amplitude=["0.1 mm", "0.3 mm"], beta=["0.1 rad", "0.3 rad"]
    )
    first.to_netcdf(tmp_path / "x.nc")
    with xarray.open_dataset(tmp_path / "x.nc") as file:
        for fed in (first, file, first.vibrafeed.shown("si")):
            names = ("frequency", "amplitude", "beta", "gravity", "gamma")
            again = vibrafeed.sweep(**STUDY, **{name: fed[name] for name in names})
            xarray.testing.assert_identical(again.throw_number, first.throw_number)
        shown = vibrafeed.sweep(**STUDY, **{n: first.vibrafeed.shown("trade")[n] for n in names})
    np.testing.assert_allclose(shown.amplitude, first.amplitude, rtol=THREE_ROUNDINGS)
