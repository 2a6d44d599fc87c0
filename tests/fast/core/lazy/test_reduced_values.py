"""A reduced sweep has what numpy says of the stored one; means are within the bound of the docs."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from night import spread
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.quantities import REGIMES

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


@pytest.mark.parametrize("over", spread(CHOICES, 7), ids="-".join)
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
                want = np.quantile(some, ASKED["quantiles"])
                np.testing.assert_allclose(got, want, rtol=1e-14)
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
    """Each addition errs by 2^-53 of a partial sum, up or down: 1000 of 10^6 remain."""
    some = line[~np.isnan(line)].tolist()
    if not some:
        assert math.isnan(mean)
        return
    exact = sum(map(Fraction, some)) / len(some)
    size = sum(abs(Fraction(value)) for value in some) / len(some)
    assert abs(Fraction(mean) - exact) <= Fraction(1e-13) * size


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
        first = found[f"{SPEED}_quantile"].values.ravel()[:500]
        np.testing.assert_allclose(first, quantiles, rtol=1e-14)


@pytest.mark.parametrize(
    ("scene", "name", "more"),
    [("sphere-on-plane", "required_friction", {"friction": [0.1, 0.3, 0.6]}),
     ("rectangle-on-plane", "floor_force", {"mass": [1, 2]})],
)  # fmt: skip
def test_regimes_with_other_axes_than_their_output(
    scene: str, name: str, more: dict[str, list[float]]
) -> None:
    parameters = {"frequency": [30, 60, 90], "amplitude": [5e-5, 2e-4, 8e-4], "beta": [10, 40]}
    study = {
        "kind": "sweep", "scene": scene, "outputs": [name], "parameters": {**parameters, **more},
    }  # fmt: skip
    whole = tabulate(prepare_content(study)).to_xarray()
    for over in (("beta",), tuple(more), ("amplitude", *more)):
        asked = {"over": list(over), "statistics": ["max", "mean", "std"]}
        found = tabulate(prepare_content({**study, "reduce": asked})).to_xarray()
        cells = on_all(over, whole, whole[name].where(valid_of(whole, name)))
        for what in ("max", "mean", "std", "count"):
            got = found[f"{name}_{what}"]
            want = getattr(cells, what)(over)
            np.testing.assert_allclose(got, want.transpose(*got.dims), rtol=1e-12, atol=1e-12)
