"""Units that vibrafeed writes, to files, headings, the screen and pictures, are read again."""

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
from vibrafeed.core.study.shown import SI, SMALLER, TRADE, Shown, ShownUnits, read_shown
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


def test_each_quantity_is_read_from_the_headings_of_its_own_files():
    for name, quantity in QUANTITIES.items():
        value = next(x for x in (0.3, 1.0, 3.0, 30.0) if quantity.lower < x <= quantity.upper)
        column = TableVariable((), np.array(value), quantity_attributes(name))
        found, unit = name_and_unit(heading(name, column))
        assert found == name
        assert read_number(name, quantity, with_unit(repr(value), unit)) == value


@pytest.mark.parametrize(
    ("name", "text", "right"),
    [
        # The gram of a mass, the standard gravity of an acceleration; of gravity itself a slip.
        *(("acceleration_along_1", f"1 {g}", 9.80665) for g in ("g", "G", "gn")),
        ("acceleration_along_1", "1 mg", 0.00980665),
        ("mass", "1 g", 0.001),
        ("mass", "1 mg", 1e-6),
        ("gravity", "9.8 g", "'g'"),
        ("mass", "3 G", "'G'"),
        ("acceleration_along_1", "3 gram", "'gram'"),
        # pint reads rpm as radians a second: as a frequency that would be off by 2 pi.
        *(("frequency", f"3000 {turn}", 50.0)
          for turn in ("RPM", "1 / min", "/ min", "per minute", "r/min", "vib/min", "min-1",
                       "strokes/min")),
        ("spin_rate", "3000 rpm", 100 * math.pi),
        *(("frequency", f"314 {turn}", "angular velocity") for turn in ("rad/s", "rad·s⁻¹")),
        *(("amplitude", f"250 {sign}m", 250e-6)
          for sign in ("\N{MICRO SIGN}", "\N{GREEK SMALL LETTER MU}", "u")),
        # Signs of word processors.
        ("gamma", "\N{MINUS SIGN}5 deg", -5.0), ("gamma", "\N{EN DASH}5 deg", -5.0),
        ("gamma", "5e\N{MINUS SIGN}1 °", 0.5), ("gamma", "5\N{NO-BREAK SPACE}º", 5.0),
        ("gamma", "\N{NARROW NO-BREAK SPACE}5 deg", 5.0),
    ],
)  # fmt: skip
def test_a_text_is_read_as_the_quantity_has_it(name, text, right):
    if isinstance(right, str):
        with pytest.raises(UnitError, match=right):
            read_number(name, QUANTITIES[name], text)
    else:
        found = read_number(name, QUANTITIES[name], text)
        assert math.isclose(found, right, rel_tol=1e-15)


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


STUDY = {"scene": "rectangle-on-plane", "outputs": ["throw_number"]}


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


@pytest.mark.parametrize("unit", UNITS)
@settings(max_examples=8, deadline=None)
@given(x=NUMBERS)
def test_what_is_written_or_shown_is_read(unit, x):
    """In the unit of files to the bit; what a person is shown but for its roundings."""
    for spelled in spellings(unit):
        assert read_number("value", free(unit), f"{x!r} {spelled}") == x
        assert read_number("value", free(unit), with_unit(repr(x), spelled)) == x
    for one in {ShownUnits().of(unit, abs(x)), ShownUnits("si").of(unit, abs(x))}:
        read = read_number("value", free(unit), f"{x * one.factor!r} {one.unit}")
        assert math.isclose(read, x, rel_tol=THREE_ROUNDINGS)


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
