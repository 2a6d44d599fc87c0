"""Families that are measured apart, kept, and put together are as if measured at once."""

from __future__ import annotations

import numpy as np

from vibrafeed.core.assurance.accuracy.curves import Curve, Measured, Point, single
from vibrafeed.core.assurance.accuracy.kept import keep, kept


def test_what_is_kept_comes_back():
    points = (Point("plain", float("nan"), 0.0, 1e-16, 2.0, 3, {"ulps": 0.5}),)
    flags = np.array([0, 3], dtype=np.int8)
    cells = {
        "regime": single(flags, "regime", "1", flag_values=flags, flag_meanings="a b"),
        "true_velocity": single(np.array([1.5, np.nan]), "velocity", "m s-1"),
    }
    curve = Curve("model", "x", "formula", points, "steep", float("-inf"))
    found, machine = kept(keep(Measured("model", (curve,), ("a note",), cells), {"date": "today"}))
    assert machine == {"date": "today"}
    assert found is not None
    assert repr(found.curves) == repr((curve,))  # a number that is none is equal to none
    assert (found.family, found.notes) == ("model", ("a note",))
    assert list(found.cells) == list(cells)
    for name, one in cells.items():
        other = found.cells[name]
        np.testing.assert_array_equal(other.values, one.values)
        assert (other.values.dtype, other.dims) == (one.values.dtype, one.dims)
        assert set(other.attributes) == set(one.attributes)
    assert found.cells["regime"].attributes["flag_values"].dtype == np.int8


def test_nothing_to_say_comes_back_too():
    assert kept(keep(None, {})) == (None, {})
