"""A reduced study has what numpy says of the stored one; means are within the bound of the docs."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
import xarray

from night import spread
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.lazy import dataset, statistics
from vibrafeed.core.lazy.dataset import block_cells, chunks_of, fields_of
from vibrafeed.core.quantities import FLAGS, REGIMES

Content = dict[str, Any]
TRACK: Content = {
    "kind": "sweep", "scene": "rectangle-on-track",
    "outputs": ["transport_velocity", "acceleration_x", "throw_number"],
    "parameters": {
        "frequency": {"start": 20, "stop": 120, "num": 5},
        "amplitude": {"start": 2e-5, "stop": 2e-4, "num": 6},
        "alpha": {"start": 0, "stop": 60, "num": 4}, "beta": {"start": 1, "stop": 30, "num": 5},
        "friction": [0.6, 0.3, 0.1], "radius": "0.8 m", "distance": "0.05 mm", "gamma": 30,
    },
}  # fmt: skip
MOTION: Content = {
    "kind": "simulate", "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity", "flight_fraction", "throw_number"],
    "parameters": {
        "frequency": [40, 50], "amplitude": {"start": "0.1 mm", "stop": "0.7 mm", "num": 9},
        "beta": {"start": 10, "stop": 60, "num": 6}, "friction": [0.4, 0.2], "restitution": 0.1,
    },
}  # fmt: skip
# Regimes that depend on more axes than the output, and on fewer.
AXES = {"frequency": [30, 60, 90], "amplitude": [5e-5, 2e-4, 8e-4], "beta": [10, 40]}
ROLLING: Content = {
    "kind": "sweep", "scene": "sphere-on-plane", "outputs": ["required_friction"],
    "parameters": {**AXES, "friction": [0.1, 0.3, 0.6]},
}  # fmt: skip
LYING: Content = {
    "kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["floor_force"],
    "parameters": {**AXES, "mass": [1, 2]},
}  # fmt: skip
STUDIES = [TRACK, MOTION, ROLLING, LYING]
ASKED: Content = {
    "statistics": ["max", "min", "mean", "std", "argmax", "argmin"],
    "quantiles": [0, 0.05, 0.5, 0.9, 1], "regimes": True,
}  # fmt: skip
SPEED = "transport_velocity"


def ranges(study: Content) -> list[str]:
    return [name for name, one in study["parameters"].items() if isinstance(one, (list, dict))]


def choices(study: Content) -> list[tuple[str, ...]]:
    """Return all choices of axes."""
    axes = ranges(study)
    return [over for n in range(1, len(axes) + 1) for over in itertools.combinations(axes, n)]


CASES = [(k, over) for k, study in enumerate(STUDIES) for over in choices(study)]


@pytest.fixture(scope="module")
def stored() -> list[xarray.Dataset]:
    return [tabulate(prepare_content(study)).to_xarray() for study in STUDIES]


def prepare(study: Content, over: tuple[str, ...], **asked: Any) -> Any:
    return prepare_content({**study, "reduce": {**ASKED, **asked, "over": list(over)}})


def reduced(study: Content, over: tuple[str, ...], **asked: Any) -> xarray.Dataset:
    return tabulate(prepare(study, over, **asked)).to_xarray()


def counted(stored: xarray.Dataset, output: str) -> xarray.DataArray:
    """Return an output where it counts by the variable that judges it, a throw number always."""
    judge = stored[output].attrs.get("ancillary_variables")
    valid = [flag.value for flag in REGIMES.values() if flag.valid]
    return stored[output].where(stored[judge].isin(valid)) if judge else stored[output]


def same(found: xarray.DataArray, wanted: xarray.DataArray) -> None:
    np.testing.assert_array_equal(found, wanted.transpose(*found.dims))


@pytest.mark.parametrize("blocks", [1, 9])
@pytest.mark.parametrize(("number", "over"), spread(CASES, 6))
def test_statistics_are_those_of_the_stored_study(stored, monkeypatch, number, over, blocks):
    if blocks > 1:  # as a study of many million cells has
        monkeypatch.setattr(dataset, "block_cells", lambda prepared, *_: prepared.cells // blocks)
        monkeypatch.setattr(statistics, "BLOCK_CELLS", 64 * 50)
    study, whole = STUDIES[number], stored[number]
    found = reduced(study, over)
    for name in study["outputs"]:
        cells = counted(whole, name)
        cells = cells.expand_dims({dim: whole.sizes[dim] for dim in over if dim not in cells.dims})
        for what in ("max", "min", "count"):
            same(found[f"{name}_{what}"], getattr(cells, what)(over))
        kept = found[f"{name}_count"].dims
        lines = cells.transpose(*kept, *over).values.reshape(found[f"{name}_count"].size, -1)
        told = [found[f"{name}_{what}"].values.ravel() for what in ("mean", "std")]
        quantiles = found[f"{name}_quantile"].transpose(..., "quantile").values.reshape(-1, 5)
        for line, mean, deviation, quantile in zip(lines, *told, quantiles, strict=True):
            some = line[~np.isnan(line)]
            if not some.size:
                assert np.isnan([mean, deviation, *quantile]).all()
                continue
            # Each addition errs by 2^-53 of a partial sum, up or down: 1000 of 10^6 remain.
            size = np.abs(some).max()
            assert abs(mean - math.fsum(some) / some.size) <= 1e-13 * np.abs(some).mean()
            assert deviation == pytest.approx(some.std(), rel=1e-9, abs=1e-7 * size)
            np.testing.assert_allclose(quantile, np.quantile(some, ASKED["quantiles"]), rtol=1e-14)
        for what, worst in (("argmax", -np.inf), ("argmin", np.inf)):
            at = getattr(np.where(np.isnan(lines), worst, lines), what)(axis=1)
            places = np.unravel_index(at, [cells.sizes[axis] for axis in over])
            for axis, place in zip(over, places, strict=True):
                if axis in whole[name].dims:
                    wanted = np.where(
                        np.isnan(lines).all(axis=1), np.nan, whole[axis].values[place]
                    )
                    got = found[f"{name}_{what}_{axis}"].values.ravel()
                    np.testing.assert_array_equal(got, wanted)
    for judge in {name for name in whole.data_vars if str(name).startswith("regime")}:
        codes = whole[judge]
        codes = codes.expand_dims({dim: whole.sizes[dim] for dim in over if dim not in codes.dims})
        for name in codes.attrs["flag_meanings"].split():
            same(found[f"{judge}_{name}_count"], (codes == REGIMES[name].value).sum(over))


@pytest.mark.parametrize("over", [("beta",), ("frequency", "alpha")])
def test_shares_are_those_of_the_stored_sweep(stored, over):
    shares = {
        "slips": ["regime == slip", f"{SPEED} >= 10 mm/s"],
        "lies": ["regime != flight", "throw_number < 1", "throw_number != 0.5"],
    }
    found = reduced(TRACK, over, shares=shares)
    speed, throw = counted(stored[0], SPEED), counted(stored[0], "throw_number")
    slips = (stored[0].regime == REGIMES["slip"].value) & (speed >= 0.01)
    same(found.share_slips, slips.mean(over))
    lies = (stored[0].regime != REGIMES["flight"].value) & (throw < 1) & (throw != 0.5)
    same(found.share_lies, lies.mean(over))


@pytest.mark.parametrize("take", ["smallest", "largest"])
@pytest.mark.parametrize("over", [("beta",), ("alpha", "amplitude"), ("frequency", "friction")])
def test_levels_are_crossed_where_numpy_finds_it(stored, take, over):
    along = over[0] if over[0] != "alpha" else "amplitude"
    level = {"output": SPEED, "level": "20 mm/s", "along": along, "take": take}
    found = reduced(TRACK, over, statistics=[], quantiles=[], levels={"fast": level}).level_fast
    others = [axis for axis in over if axis != along]
    lines = counted(stored[0], SPEED).transpose(*found.dims, *others, along).values
    one, other = lines[..., :-1], lines[..., 1:]
    crossed = ((one <= 0.02) & (other >= 0.02)) | ((one >= 0.02) & (other <= 0.02))
    axis = stored[0][along].values
    with np.errstate(invalid="ignore", divide="ignore"):
        places = axis[:-1] + (0.02 - one) / (other - one) * np.diff(axis)
    worst, extreme = (-np.inf, np.max) if take == "largest" else (np.inf, np.min)
    gone = tuple(range(-1 - len(others), 0))
    wanted = extreme(np.where(crossed, places, worst), axis=gone)
    np.testing.assert_allclose(found, np.where(np.isinf(wanted), np.nan, wanted), rtol=1e-13)
    assert np.isfinite(wanted).any()


def test_memory_is_that_of_a_box():
    """A grid of 10^12 cells has answers of a few bytes, and boxes of a few thousand cells."""
    many = {"num": 500_000}
    axes = MOTION["parameters"]
    fine = {name: axes[name] | many for name in ("amplitude", "beta")}
    study = {**MOTION, "parameters": {**axes, **fine}}
    prepared = prepare(study, ("amplitude", "beta"), quantiles=[])
    assert prepared.cells == 10**12
    assert prepared.bytes < 2_000
    (field,) = [one for one in fields_of(prepared.whole) if "flight_fraction" in one.names]
    chunks = chunks_of(prepared.whole, field, block_cells(prepared.whole, field), ["beta"])
    assert math.prod(max(lengths) for lengths in chunks.values()) <= 1 << 22


@pytest.mark.parametrize(
    ("kind", "other"), [("sweep", "acceleration_x"), ("simulate", "conveying_velocity")]
)
def test_an_output_without_an_axis_that_goes(kind, other):
    """It raised IndexError: a field of no axes, or of none that goes, has no row of cells."""
    parameters = {"frequency": 50, "amplitude": "0.3 mm", "beta": 30, "friction": [0.2, 0.3, 0.4]}
    study = {**MOTION, "kind": kind, "outputs": ["throw_number", other], "parameters": parameters}
    wanted = tabulate(prepare_content(study)).variables["throw_number"].values
    found = reduced(study, ("friction",), cells="all")
    for name in ("max", "mean", "quantile"):
        assert (found[f"throw_number_{name}"] == wanted).all()
    assert int(found.throw_number_count) == 3
    assert float(found.throw_number_argmin_friction) == 0.2


def test_motions_are_verified_by_another_method():
    study = {**MOTION, "verify": 3, "parameters": {**MOTION["parameters"], "restitution": 0}}
    attributes = tabulate(prepare(study, ("beta",))).attributes
    assert attributes["verified_cells"] == 3
    assert "reference" in attributes["verified_against"]
    assert "verified_failed" not in attributes
    assert attributes["reduced"].startswith("over beta")


def test_codes_have_shares_and_no_statistics():
    study = {**MOTION, "outputs": ["conveying_velocity", "direction"]}
    forwards = FLAGS["direction"]["forwards"].value
    found = reduced(study, ("beta",), shares={"forwards": [f"direction == {forwards}"]})
    wanted = tabulate(prepare_content(study)).to_xarray().direction == forwards
    same(found.share_forwards, wanted.mean("beta"))
    assert not any(name.startswith("direction_") for name in found)
