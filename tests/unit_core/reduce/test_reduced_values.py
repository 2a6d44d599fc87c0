"""A reduced sweep has what numpy says of the stored one, to the bit, however it is cut.

Means are within the bound that docs/reduce.md states.
"""

from __future__ import annotations

import itertools
import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from boxes import assert_same_bits
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.plan.lane_loop import DEPTH, LARGE_TILE_CELLS, MAX_LANES, TILE_CELLS
from vibrafeed.core.plan.program import program_of
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.reduce.arrays import reduced_arrays
from vibrafeed.core.reduce.run import Units
from vibrafeed.core.watch import Watch

AXES = {
    "frequency": {"start": 20, "stop": 120, "num": 7},
    "amplitude": {"start": 2e-5, "stop": 2e-4, "num": 9},
    "alpha": {"start": 0, "stop": 60, "num": 6},
    "beta": {"start": 1, "stop": 30, "num": 5},
    "friction": [0.6, 0.3, 0.1],
}
STUDY = {
    "kind": "sweep",
    "scene": "rectangle-on-track",
    "outputs": ["transport_velocity", "acceleration_x", "throw_number"],
    "parameters": {**AXES, "radius": "0.8 m", "distance": "0.05 mm", "gamma": 30},
}
SPEED = "transport_velocity"
ASKED: dict[str, Any] = {
    "statistics": ["max", "min", "mean", "argmax", "argmin"],
    "quantiles": [0, 0.05, 0.5, 0.9, 1],
    "regimes": True,
    "shares": {
        "slips": ["regime == slip", f"{SPEED} >= 10 mm/s"],
        "lies": ["regime != flight", "throw_number < 1", "throw_number != 0.5"],
    },
}


@pytest.fixture(scope="module")
def stored() -> Any:
    return tabulate(prepare_content(STUDY)).to_xarray()


def reduced(over: tuple[str, ...], **asked: Any) -> Any:
    return prepare_content({**STUDY, "reduce": {**ASKED, **asked, "over": list(over)}})


def valid_of(stored: Any, output: str) -> Any:
    """Where an output counts by the variable that judges it, a throw number everywhere."""
    judge = stored[output].attrs.get("ancillary_variables")
    if judge is None:
        return stored[output].notnull()
    return stored[judge].isin([flag.value for flag in REGIMES.values() if flag.valid])


def on_all(over: tuple[str, ...], stored: Any, cells: Any) -> Any:
    """Return cells that are repeated along the axes that go, where they do not depend on one."""
    more = {axis: stored.sizes[axis] for axis in over if axis not in cells.dims}
    return cells.expand_dims(more)


CHOICES = [
    over for count in range(1, len(AXES) + 1) for over in itertools.combinations(AXES, count)
]


@pytest.mark.by_day(7)
@pytest.mark.parametrize("over", CHOICES, ids="-".join)
def test_statistics_are_those_of_the_stored_sweep(stored: Any, over: tuple[str, ...]) -> None:
    found = tabulate(reduced(over)).to_xarray()
    for name in STUDY["outputs"]:
        cells = on_all(over, stored, stored[name].where(valid_of(stored, name)))
        same(found[f"{name}_max"], cells.max(over))
        same(found[f"{name}_min"], cells.min(over))
        same(found[f"{name}_count"], cells.count(over))
        kept = found[f"{name}_count"].dims
        over = tuple(axis for axis in AXES if axis in over and axis in cells.dims)
        lines = cells.transpose(*kept, *over).values.reshape(found[f"{name}_count"].size, -1)
        mean = found[f"{name}_mean"].values.ravel()
        for line, got in zip(lines, mean, strict=True):
            within_the_bound(got, line)
        for statistic in ("argmax", "argmin"):
            points = first_points(cells, over, kept, statistic)
            for axis in set(over) & set(stored[name].dims):
                got = found[f"{name}_{statistic}_{axis}"].values.ravel()
                np.testing.assert_array_equal(got, points[axis])
        told = found[f"{name}_quantile"].transpose("quantile", ...).values.reshape(5, -1)
        for line, got in zip(lines, told.T, strict=True):
            some = line[~np.isnan(line)]
            if some.size:
                np.testing.assert_array_equal(got, np.quantile(some, ASKED["quantiles"]))
            else:
                assert np.isnan(got).all()


@pytest.mark.parametrize("over", CHOICES[::3], ids="-".join)
def test_counts_and_shares_are_those_of_the_stored_sweep(stored: Any, over: Any) -> None:
    found = tabulate(reduced(over)).to_xarray()
    regime, judges = stored.regime, {"regime", f"regime_{SPEED}"}
    assert {name for name in stored.data_vars if name.startswith("regime")} == judges
    for judge in judges:
        for name in stored[judge].attrs["flag_meanings"].split():
            same(found[f"{judge}_{name}_count"], (stored[judge] == REGIMES[name].value).sum(over))
    slips = (regime == REGIMES["slip"].value) & valid_of(stored, SPEED) & (stored[SPEED] >= 0.01)
    same(found.share_slips, slips.mean(over))
    throw = stored.throw_number.where(valid_of(stored, "throw_number"))
    lies = (regime != REGIMES["flight"].value) & (throw < 1) & (throw != 0.5)
    same(found.share_lies, lies.mean(over))


@pytest.mark.by_day(3)
@pytest.mark.parametrize("over", [tuple(AXES), ("alpha", "beta"), ("frequency",), ("friction",)])
def test_no_bit_depends_on_boxes_threads_or_parts(over: tuple[str, ...]) -> None:
    prepared = reduced(over, levels={"fast": LEVEL} if "beta" in over else {})
    assert_same_bits(prepared, [(1 << 22, 1), (1 << 22, 2), (1000, 2), (97, 1)])


@pytest.mark.parametrize(
    "over", [("frequency",), ("amplitude", "friction"), ("beta",), ("alpha", "beta", "friction")]
)
def test_the_compiled_loop_has_the_bits_of_stored_cells(over, monkeypatch) -> None:
    both_ways(reduced(over, quantiles=[]), monkeypatch)


def test_so_has_one_with_functions_of_numpy_between_its_loops(monkeypatch) -> None:
    asked = {"over": ["amplitude", "beta"], "statistics": ["mean", "argmin"], "cells": "all"}
    study = {**STUDY, "outputs": ["travel_time"], "reduce": asked}
    both_ways(prepare_content(study), monkeypatch)


@pytest.mark.parametrize("over", [("frequency", "alpha"), ("amplitude", "beta")], ids="-".join)
def test_rows_taken_in_pairs_have_the_bits_of_stored_cells(over, monkeypatch) -> None:
    """Rows in the same lanes are paired, and an odd one is left; those in their own are not."""
    monkeypatch.setattr("vibrafeed.core.plan.program.PAIRED_CELLS", 1)
    program_of.cache_clear()
    axes = {name: {**AXES[name], "num": num} for name, num in PAIRED.items()}
    asked = {**ASKED, "over": list(over), "quantiles": [], "shares": {}}
    parameters = {**STUDY["parameters"], **axes}
    study = {**STUDY, "outputs": [SPEED], "parameters": parameters, "reduce": asked}
    prepared = prepare_content(study)
    order = prepared.work.boxes[0]._loop.order
    last = order.outer[-1]
    assert (last in over and order.steps[last] in (3, 5, 7)) == ("frequency" in over)
    both_ways(prepared, monkeypatch)
    program_of.cache_clear()


@pytest.mark.parametrize("output", [SPEED, "travel_time"])
@pytest.mark.parametrize(
    ("over", "in_order"), [(("frequency", "amplitude"), True), (("frequency", "alpha"), False)]
)
def test_places_of_extremes_have_the_bits_of_stored_cells(over, in_order, output, monkeypatch):
    """Many cells rest, and their times are infinite.

    That the first of equal cells is told is tried in test_reduce_numbers.py; few lanes meet it.
    """
    axes = {name: {**AXES[name], "num": num} for name, num in PAIRED.items()}
    asked = {"over": list(over), "statistics": ["argmax", "argmin", "max", "min"], "cells": "all"}
    study = {**STUDY, "outputs": [output], "parameters": {**STUDY["parameters"], **axes}}
    prepared = prepare_content({**study, "reduce": asked})
    order = prepared.work.boxes[0]._loop.order
    assert order.is_in_grid_order(prepared.grid.shape, over) == in_order
    both_ways(prepared, monkeypatch)
    extremes = tabulate(prepared).to_xarray()
    assert (extremes[f"{output}_min"] == 0).any() or np.isinf(extremes[f"{output}_max"]).any()


@pytest.mark.parametrize("statistics", [["max", "argmin"], ["max", "mean"]], ids="-".join)
def test_tiles_are_larger_where_no_values_are_summed(statistics: list[str]) -> None:
    """What a tile gives is folded and Python comes between: 2 % of `argmax`, more beside load."""
    axes = {name: {**AXES[name], "num": 200} for name in PAIRED}
    asked = {"over": ["alpha", "beta"], "statistics": statistics}
    parameters = {**STUDY["parameters"], **axes}
    study = {**STUDY, "outputs": [SPEED], "parameters": parameters, "reduce": asked}
    order = prepare_content(study).work.boxes[0]._loop.order
    cells = math.prod(order.steps.values())
    assert cells <= TILE_CELLS if "mean" in statistics else TILE_CELLS < cells <= LARGE_TILE_CELLS


PAIRED = {"frequency": 14, "amplitude": 15, "alpha": 20, "beta": 20}


def both_ways(prepared: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    want: dict[str, bytes] = {}
    for is_compiled, cells in ((False, 1 << 22), (True, 1 << 22), (True, 97)):
        monkeypatch.setattr(
            "vibrafeed.core.reduce.boxes.is_compiled_for", lambda *_, how=is_compiled: how
        )
        units = Units(prepared.plan, prepared.grid, prepared.asked, cells)
        states = units.states(0, len(units), Watch(threads=2))
        got = reduced_arrays(units, prepared.grid, prepared.asked, states)
        got_bytes = {name: array.tobytes() for name, array in got.items()}
        want = want or got_bytes
        assert got_bytes == want


LEVEL = {"output": SPEED, "level": "20 mm/s", "along": "beta"}


@pytest.mark.parametrize("take", ["smallest", "largest"])
@pytest.mark.parametrize("along", ["beta", "amplitude", "frequency"])
@pytest.mark.parametrize("others", [(), ("alpha",), ("frequency", "friction")])
def test_levels_are_crossed_where_numpy_finds_it(stored: Any, take, along, others) -> None:
    over = tuple(axis for axis in AXES if axis == along or axis in others)
    level = {**LEVEL, "along": along, "take": take}
    found = tabulate(reduced(over, statistics=[], quantiles=[], levels={"fast": level}))
    cells = stored[SPEED].where(valid_of(stored, SPEED))
    dims = (*(dim for dim in cells.dims if dim not in over), *(d for d in over if d != along))
    lines = cells.transpose(*dims, along).values
    axis = stored[along].values
    one, other = lines[..., :-1], lines[..., 1:]
    crossed = ((one <= 0.02) & (other >= 0.02)) | ((one >= 0.02) & (other <= 0.02))
    with np.errstate(invalid="ignore", divide="ignore"):
        places = axis[:-1] + (0.02 - one) / (other - one) * np.diff(axis)
    worst = -np.inf if take == "largest" else np.inf
    places = np.where(crossed, places, worst)
    gone = tuple(range(len(dims) - len(over) + 1, places.ndim))
    want = places.max(gone) if take == "largest" else places.min(gone)
    want = np.where(np.isinf(want), np.nan, want)
    np.testing.assert_allclose(found.variables["level_fast"].values, want, rtol=1e-13)
    assert np.isfinite(want).any()


def same(found: Any, wanted: Any) -> None:
    np.testing.assert_array_equal(found, wanted.transpose(*found.dims))


def within_the_bound(mean: float, line: np.ndarray) -> None:
    """A lane adds DEPTH cells one after another, then lanes are added by halves.

    Each addition errs by 2^-53 of a partial sum, which no sum of sizes falls short of. Tiles are
    added exactly, and the quotient is rounded once.
    """
    some = line[~np.isnan(line)].tolist()
    if not some:
        assert math.isnan(mean)
        return
    exact = sum(map(Fraction, some)) / len(some)
    size = sum(abs(Fraction(value)) for value in some) / len(some)
    additions = min(DEPTH + math.log2(MAX_LANES), len(some))
    assert abs(Fraction(mean) - exact) <= Fraction(additions + 1) / 2**53 * size


def first_points(cells: Any, over: Any, kept: Any, statistic: str) -> dict[str, np.ndarray]:
    lines = cells.transpose(*kept, *over)
    shape = lines.shape[len(kept) :]
    flat = lines.values.reshape(-1, int(np.prod(shape)))
    empty = np.isnan(flat).all(axis=1)
    filled = np.where(np.isnan(flat), -np.inf if statistic == "argmax" else np.inf, flat)
    at = getattr(filled, statistic)(axis=1)
    return {
        axis: np.where(empty, np.nan, cells[axis].values[place])
        for axis, place in zip(over, np.unravel_index(at, shape), strict=True)
    }


def test_a_million_cells_over_one_two_and_all_axes() -> None:
    counts = {"frequency": 19, "amplitude": 21, "alpha": 18, "beta": 13, "friction": 11}
    axes = {
        name: {"start": low, "stop": high, "num": counts[name]}
        for name, low, high in (
            ("frequency", 20, 120), ("amplitude", 2e-5, 2e-4), ("alpha", 0, 60), ("beta", 1, 30),
            ("friction", 0.1, 0.6),
        )
    }  # fmt: skip
    study = {**STUDY, "parameters": {**STUDY["parameters"], **axes}, "outputs": [SPEED]}
    whole = tabulate(prepare_content(study)).to_xarray()
    cells = whole[SPEED].where(valid_of(whole, SPEED))
    assert cells.size > 1_000_000
    for over in (("beta",), ("frequency", "friction"), tuple(axes)):
        asked = {"over": list(over), "statistics": ["max", "mean", "argmax"], "quantiles": [0.3]}
        prepared = prepare_content({**study, "reduce": asked})
        found = tabulate(prepared).to_xarray()
        same(found[f"{SPEED}_max"], cells.max(over))
        kept = found[f"{SPEED}_max"].dims
        for axis, points in first_points(cells, over, kept, "argmax").items():
            np.testing.assert_array_equal(found[f"{SPEED}_argmax_{axis}"].values.ravel(), points)
        lines = cells.transpose(*kept, *over).values.reshape(found[f"{SPEED}_max"].size, -1)
        for line, got in zip(lines[:50], found[f"{SPEED}_mean"].values.ravel(), strict=False):
            within_the_bound(got, line)
        quantiles = np.nanquantile(lines[:500], 0.3, axis=1)
        np.testing.assert_array_equal(found[f"{SPEED}_quantile"].values.ravel()[:500], quantiles)
