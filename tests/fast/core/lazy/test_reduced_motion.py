"""A reduced simulation has what numpy says of the stored one."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from vibrafeed.core.errors import StoppedError, StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.lazy.dataset import block_cells, chunks_of, fields_of
from vibrafeed.core.quantities import FLAGS, REGIMES
from vibrafeed.core.watch import Watch

AXES: dict[str, Any] = {
    "frequency": [40, 50],
    "amplitude": {"start": "0.1 mm", "stop": "0.7 mm", "num": 9},
    "beta": {"start": 10, "stop": 60, "num": 6},
    "friction": [0.4, 0.2],
}
SPEED = "conveying_velocity"
STUDY: dict[str, Any] = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": [SPEED, "flight_fraction", "throw_number"],
    "parameters": {**AXES, "restitution": 0.1},
}
LEVELS = {
    "reach": {"output": SPEED, "level": "50 mm/s", "along": "amplitude"},
    "steep": {"output": SPEED, "level": "50 mm/s", "along": "beta", "take": "largest"},
}
ASKED: dict[str, Any] = {
    "statistics": ["max", "min", "mean", "argmax", "argmin"],
    "quantiles": [0, 0.1, 0.5, 1],
    "regimes": True,
    "shares": {"hops": ["flight_fraction > 0"], "fast": ["regime != stick", f"{SPEED} >= 50 mm/s"]},
}
CHOICES = [over for n in range(1, len(AXES) + 1) for over in itertools.combinations(AXES, n)]


def reduced(over: tuple[str, ...], study: dict[str, Any] = STUDY, **asked: Any) -> Any:
    levels = {name: one for name, one in LEVELS.items() if one["along"] in over}
    content = {**ASKED, "levels": levels, **asked, "over": list(over)}
    return prepare_content({**study, "reduce": content})


@pytest.fixture(scope="module")
def stored() -> Any:
    return tabulate(prepare_content(STUDY)).to_xarray()


@pytest.mark.parametrize("over", CHOICES[::2], ids="-".join)
def test_answers_are_those_of_the_stored_motion(stored: Any, over: tuple[str, ...]) -> None:
    found = tabulate(reduced(over)).to_xarray()
    valid = stored.regime.isin([flag.value for flag in REGIMES.values() if flag.valid])
    assert not any(name.startswith("motion_status") for name in found)
    for name in STUDY["outputs"]:
        cells = stored[name] if name == "throw_number" else stored[name].where(valid)
        cells = cells.expand_dims({dim: stored.sizes[dim] for dim in over if dim not in cells.dims})
        kept = found[f"{name}_count"].dims
        for what in ("max", "min", "count"):
            same(found[f"{name}_{what}"], getattr(cells, what)(over))
        gone = [axis for axis in cells.dims if axis in over]
        lines = cells.transpose(*kept, *gone).values.reshape(found[f"{name}_count"].size, -1)
        for line, mean in zip(lines, found[f"{name}_mean"].values.ravel(), strict=True):
            some = [Fraction(value) for value in line[~np.isnan(line)]]
            bound = 1e-13 * max(map(abs, some))
            assert abs(Fraction(mean) - sum(some) / len(some)) <= bound
        told = found[f"{name}_quantile"].transpose("quantile", ...).values.reshape(4, -1)
        for line, got in zip(lines, told.T, strict=True):
            want = np.quantile(line[~np.isnan(line)], ASKED["quantiles"])
            np.testing.assert_allclose(got, want, rtol=1e-14)
        for axis in set(gone) & set(stored[name].dims):
            place = cells.transpose(*kept, *gone).stack(cell=gone).argmax("cell")
            at = np.unravel_index(place.values, [cells.sizes[axis] for axis in gone])
            want = stored[axis].values[at[gone.index(axis)]]
            np.testing.assert_array_equal(found[f"{name}_argmax_{axis}"].values, want)
    for name in stored.regime.attrs["flag_meanings"].split():
        same(found[f"regime_{name}_count"], (stored.regime == REGIMES[name].value).sum(over))
    same(found.share_hops, ((stored.flight_fraction > 0) & valid).mean(over))


def same(found: Any, want: Any) -> None:
    np.testing.assert_array_equal(found.values, want.transpose(*found.dims).values)


def test_memory_is_that_of_a_box() -> None:
    """A grid of 10^12 cells has answers of a few bytes, and boxes of a few thousand cells."""
    parameters = {
        **STUDY["parameters"],
        "amplitude": {"start": "0.1 mm", "stop": "0.7 mm", "num": 500_000},
        "beta": {"start": 10, "stop": 60, "num": 500_000},
    }
    prepared = reduced(("amplitude", "beta"), {**STUDY, "parameters": parameters}, quantiles=[])
    assert prepared.cells == 10**12
    assert prepared.bytes < 2_000
    (field,) = [one for one in fields_of(prepared.whole) if SPEED in one.names]
    chunks = chunks_of(prepared.whole, field, block_cells(prepared.whole, field), ["beta"])
    assert math.prod(max(lengths) for lengths in chunks.values()) <= 1 << 22


@pytest.mark.parametrize(
    ("kind", "other"), [("sweep", "acceleration_x"), ("simulate", "conveying_velocity")]
)
@pytest.mark.parametrize("frequency", [50, [50, 60]])
def test_an_output_without_an_axis_that_goes(kind: str, other: str, frequency: Any) -> None:
    """It raised IndexError: a field of no axes, or of none that goes, has no row of cells."""
    study = {
        "kind": kind,
        "scene": "rectangle-on-plane",
        "outputs": ["throw_number", other],
        "parameters": {
            "frequency": frequency, "amplitude": "0.3 mm", "beta": 30, "friction": [0.2, 0.3, 0.4],
        },
    }  # fmt: skip
    want = tabulate(prepare_content(study)).to_xarray().throw_number
    asked = {"statistics": ["max", "mean", "argmin"], "quantiles": [0.5], "cells": "all"}
    content = {**study, "reduce": {"over": ["friction"], **asked}}
    found = tabulate(prepare_content(content)).to_xarray()
    for name in ("throw_number_max", "throw_number_mean"):
        np.testing.assert_array_equal(found[name].values, want.values)
    np.testing.assert_array_equal(found.throw_number_quantile.values[0], want.values)
    assert (found.throw_number_count == 3).all()
    assert (found.throw_number_argmin_friction == 0.2).all()


def test_what_is_stopped_gives_no_answer() -> None:
    prepared = reduced(("beta",))
    with pytest.raises(StoppedError, match="no result"):
        tabulate(prepared, Watch(stop=lambda: True))


def test_cells_are_verified_by_another_method() -> None:
    study = {**STUDY, "verify": 3, "parameters": {**STUDY["parameters"], "restitution": 0}}
    attributes = tabulate(reduced(("beta",), study)).attributes
    assert attributes["verified_cells"] == 3
    assert "reference" in attributes["verified_against"]
    assert "verified_failed" not in attributes
    assert attributes["reduced"].startswith("over beta")


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        ({"sensitivities": True}, "sensitivities", "reduce too"),
        ({"trajectory": 10}, "trajectory", "reduce too"),
        ({"of": ["motion_status"]}, "reduce.of.0", "not a numeric output"),
        ({"over": ["gamma"]}, "reduce.over.0", "not an axis"),
        (
            {"statistics": [], "shares": {}, "quantiles": [], "regimes": False},
            "reduce",
            "no statistic is requested",
        ),
    ],
)
def test_what_is_wrong_is_told_where_it_stands(change: Any, place: str, words: str) -> None:
    own = {key: change[key] for key in ("sensitivities", "trajectory") if key in change}
    asked = {key: one for key, one in change.items() if key not in own}
    study = {**STUDY, **own, "outputs": [*STUDY["outputs"], "motion_status"]}
    content = {**ASKED, "over": ["beta"], **asked}
    with pytest.raises(StudyError) as caught:
        prepare_content({**study, "reduce": content})
    assert any(one.place == place and words in one.message for one in caught.value.problems)


def test_codes_have_shares_and_no_statistics() -> None:
    study = {**STUDY, "outputs": [SPEED, "direction"]}
    forwards = FLAGS["direction"]["forwards"].value
    shares = {"forwards": [f"direction == {forwards}"]}
    found = tabulate(reduced(("beta",), study, shares=shares, levels={})).to_xarray()
    want = tabulate(prepare_content(study)).to_xarray().direction == forwards
    np.testing.assert_array_equal(found.share_forwards.values, want.mean("beta").values)
    assert not any(name.startswith("direction_") for name in found)
