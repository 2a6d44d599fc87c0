"""The values of a range are the numbers that a person types for them."""

from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vibrafeed.core.study import values
from vibrafeed.core.study.values import as_typed, evenly, geometrically, read_values

UNITS = {
    "amplitude": {"m": 1, "mm": Fraction(1, 1000), "um": Fraction(1, 10**6)},
    "frequency": {"Hz": 1, "kHz": 1000, "rpm": Fraction(1, 60)},
    "beta": {"deg": 1},
}


@st.composite
def ranges(draw):
    """Return a name, a unit with its size, and a start, a step and a number in decimals."""
    name = draw(st.sampled_from(sorted(UNITS)))
    unit = draw(st.sampled_from(sorted(UNITS[name])))
    places = draw(st.integers(0, 4 if unit == "rpm" else 6))
    ends = {"deg": 40, "kHz": 9}.get(unit, 2000)
    step = Decimal(draw(st.integers(1, max(1, 10**places)))).scaleb(-places)
    start = Decimal(draw(st.integers(1, ends * 10**places))).scaleb(-places)
    size = draw(st.integers(2, 41))
    return name, unit, Fraction(UNITS[name][unit]), start, step, size


@settings(deadline=None, max_examples=60)
@given(ranges(), st.sampled_from(["num", "step", "beyond"]), st.integers(1, 99))
def test_every_value_is_the_one_that_is_typed(range_, how, beyond):
    """Also where a step misses the stop."""
    name, unit, one, start, step, size = range_
    stop = start + (size - 1) * step + (step * beyond / 100 if how == "beyond" else 0)
    more = {"num": size} if how == "num" else {"step": f"{step} {unit}"}
    axis = read_values(name, {"start": f"{start} {unit}", "stop": f"{stop} {unit}", **more})
    typed = [float(Fraction(start + k * step) * one) for k in range(size)]
    assert axis.array().tolist() == typed
    assert [read_values(name, f"{start + k * step} {unit}").value for k in range(size)] == typed


@settings(deadline=None, max_examples=60)
@given(
    st.floats(-1e9, 1e9),
    st.floats(1e-9, 1e9),
    st.integers(2, 300),
    st.tuples(st.integers(0, 300), st.integers(0, 300)),
)
def test_a_part_is_a_part_of_the_whole_and_values_rise(first, length, size, cut):
    last = first + length
    if not first < last:
        return
    whole = evenly(first, last, size)
    assert whole[[0, -1]].tolist() == [first, last]
    assert (np.diff(whole) >= 0).all()
    np.testing.assert_allclose(whole, np.linspace(first, last, size), rtol=1e-9, atol=1e-9)
    start, stop = sorted(min(end, size) for end in cut)
    assert evenly(first, last, size, start, stop).tobytes() == whole[start:stop].tobytes()


@pytest.mark.parametrize(
    ("number", "exact"),
    [
        (0.1, Fraction(1, 10)),
        (1e-7, Fraction(1, 10**7)),
        (1000 / 60, Fraction(50, 3)),
        (0.123456789, Fraction(123456789, 10**9)),
        (-2.5, Fraction(-5, 2)),
        (1e300, Fraction(10**300)),
        (0.01 / 60, Fraction(1, 6000)),
        (5e-324, Fraction(5, 10**324)),
    ],
)
def test_what_a_float_stands_for(number, exact):
    assert as_typed(number) == exact


def test_three_ways_agree(monkeypatch):
    ends = 0.1, 0.7, 601
    whole = evenly(*ends)
    assert whole.tolist() == [float(f"{k / 1000:.3f}") for k in range(100, 701)]
    monkeypatch.setattr(values, "EXACT", 0)
    assert evenly(*ends).tobytes() == whole.tobytes()
    monkeypatch.setattr(values, "MAX_SLOW", 0)
    rough = evenly(*ends)
    assert rough.tobytes() == np.linspace(*ends).tobytes()
    assert evenly(*ends, 600, 601).tolist() == [0.7]


def test_a_step_that_floats_miss_reaches_the_stop():
    written = {"start": "26.277 m", "stop": "26.278 m", "step": "1 mm"}
    assert read_values("radius", written).array().tolist() == [26.277, 26.278]
    radians = read_values("beta", {"start": 0, "stop": "1 rad", "step": "0.1 rad"})
    assert radians.size == 11


@pytest.mark.parametrize(
    "ends",
    [{"num": 3}, {"step": "10 Hz"}, {"num": 5, "spacing": "log"}, {"step": 7}],
)
def test_a_range_may_fall(ends):
    """It has the values of the one that rises, backwards; a step that misses keeps its start."""
    down = read_values("frequency", {"start": 40, "stop": "20 Hz", **ends}).array()
    if ends == {"step": 7}:
        assert down.tolist() == [40.0, 33.0, 26.0]
        return
    up = read_values("frequency", {"start": 20, "stop": 40, **ends}).array()
    np.testing.assert_allclose(down, up[::-1], rtol=1e-15)


def test_a_logarithmic_range_is_numpys():
    whole = geometrically(1e-9, 3e5, 77)
    assert whole.tobytes() == np.geomspace(1e-9, 3e5, 77).tobytes()
    assert geometrically(1e-9, 3e5, 77, 70, 77).tobytes() == whole[70:].tobytes()
