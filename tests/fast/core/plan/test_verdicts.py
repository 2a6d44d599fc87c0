"""A verdict belongs to the values that it judges: asking for one more output changes none."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibrafeed
from vibrafeed.core.dataset.formats import read_result, write_result
from vibrafeed.core.dataset.table import Table, is_valid
from vibrafeed.core.motion import SYSTEMS
from vibrafeed.core.plan.plan import verdicts_of
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes import EXACT, SCENES

GRID: dict[str, Any] = {
    "scene": "rectangle-on-track",
    "frequency": {"start": "20 Hz", "stop": "100 Hz", "num": 10},
    "amplitude": {"start": "0.05 mm", "stop": "0.5 mm", "num": 10},
    "beta": {"start": 5, "stop": 50, "num": 10},
    "gamma": 2,
    "delta": 5,
    "alpha": 0,
    "friction": 0.3,
    "radius": "150 mm",
}
VARIANTS = [(name, variant) for name, scene in SCENES.items() for variant in scene.variants]
TRAVEL = ["terminal_velocity", "stopping_distance", "starting_acceleration"]


def judge(dataset: Any, output: str) -> Any:
    return dataset[dataset[output].attrs["ancillary_variables"]]


def counts(regimes: Any) -> dict[str, int]:
    by_value = {flag.value: name for name, flag in REGIMES.items()}
    numbers, found = np.unique(regimes.values, return_counts=True)
    return {by_value[n]: c for n, c in zip(numbers.tolist(), found.tolist(), strict=True)}


def test_accelerations_stay_valid_beside_a_velocity_that_is_not() -> None:
    """469 of 1,000 accelerations are valid; a terminal velocity is valid in none of the cells."""
    outputs = ["acceleration_x", "acceleration_y", "terminal_velocity"]
    dataset = vibrafeed.sweep(outputs=outputs, **GRID)
    assert counts(dataset.regime) == {"stick": 71, "slip": 398, "flight": 531}
    assert judge(dataset, "acceleration_x") is not None
    assert dataset.acceleration_x.attrs["ancillary_variables"] == "regime"
    velocity = judge(dataset, "terminal_velocity")
    assert velocity.name == "regime_terminal_velocity"
    assert counts(velocity) == {"flight": 531, "no_motion": 2, "faster_than_track": 467}
    assert velocity.attrs["long_name"] == "Regime of terminal velocity"


@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("pair", [*itertools.combinations(["acceleration_x", *TRAVEL], 2)])
def test_an_output_is_judged_in_company_as_it_is_alone(pair: tuple[str, str], order: int) -> None:
    together = vibrafeed.sweep(outputs=list(pair[::order]), **GRID)
    for name in pair:
        alone = vibrafeed.sweep(outputs=[name], **GRID)
        np.testing.assert_array_equal(judge(together, name), judge(alone, name))


@pytest.mark.parametrize(("scene", "variant"), VARIANTS)
def test_validity_is_the_same_in_company(scene: str, variant: str) -> None:
    """In the order of a verdict no state of one output comes before what judges another."""
    conditions = SCENES[scene].conditions[variant]
    outputs = SCENES[scene].outputs(variant)
    for verdict in verdicts_of(conditions, outputs):
        for name in verdict.outputs:
            own = [one for one in verdict.conditions if name in one.outputs]
            judging = [k for k, one in enumerate(verdict.conditions) if one in own and _judges(one)]
            before = verdict.conditions[: judging[-1]] if judging else ()
            assert set(before) <= set(own), (verdict.name, name)
            others = [one for one in verdict.conditions if one not in own]
            assert not any(_judges(one) for one in others), (verdict.name, name)


def _judges(condition: Any) -> bool:
    return REGIMES[condition.regime].judges


@pytest.mark.parametrize(("scene", "variant"), VARIANTS)
def test_every_output_has_at_most_one_verdict(scene: str, variant: str) -> None:
    conditions = SCENES[scene].conditions[variant]
    outputs = SCENES[scene].outputs(variant)
    verdicts = verdicts_of(conditions, outputs)
    assert verdicts[0].name == "regime"
    assert len({verdict.name for verdict in verdicts}) == len(verdicts)
    judged = [name for verdict in verdicts for name in verdict.outputs]
    assert len(judged) == len(set(judged))
    concerned = {name for one in conditions for name in one.outputs & set(outputs)}
    if conditions:
        assert set(judged) == concerned - {"regime", *EXACT}


@pytest.mark.parametrize("scenes", [SCENES, SYSTEMS])
def test_a_verdict_with_conditions_says_something_of_every_cell(scenes: Any) -> None:
    for scene in scenes.values():
        for variant in scene.variants:
            for verdict in verdicts_of(scene.conditions[variant], scene.outputs(variant)):
                assert not verdict.conditions or verdict.otherwise != "not_assessed", verdict.name


def test_an_unbounded_efficiency_leaves_the_speed_its_regime() -> None:
    motion = vibrafeed.simulate(
        scene="rectangle-on-plane",
        outputs=["conveying_velocity", "efficiency"],
        frequency=50,
        amplitude="0.3 mm",
        beta=[20, 90],
        gamma=5,
        friction=0.4,
    )
    alone = vibrafeed.simulate(
        scene="rectangle-on-plane",
        outputs=["conveying_velocity"],
        frequency=50,
        amplitude="0.3 mm",
        beta=[20, 90],
        gamma=5,
        friction=0.4,
    )
    assert "unbounded" in counts(motion.regime_efficiency)
    assert judge(motion, "efficiency").name == "regime_efficiency"
    assert judge(motion, "conveying_velocity").name == "regime"
    np.testing.assert_array_equal(motion.regime, alone.regime)


def test_what_always_holds_has_no_verdict_and_counts_everywhere() -> None:
    dataset = vibrafeed.sweep(outputs=["throw_number", "acceleration_x"], **GRID)
    assert "ancillary_variables" not in dataset.throw_number.attrs
    assert Table.of_xarray(dataset).valid("throw_number") is None
    valid = Table.of_xarray(dataset).valid("acceleration_x")
    assert valid is not None
    assert valid.sum() == 469
    np.testing.assert_array_equal(valid, is_valid(dataset.regime.values))


def test_a_throw_number_puts_no_verdict_on_what_always_holds() -> None:
    """A drive's acceleration holds in flight, too, where the throw number tells it."""
    drive = {
        key: GRID[key] for key in ("scene", "frequency", "amplitude", "beta", "gamma", "delta")
    }
    dataset = vibrafeed.sweep(outputs=["throw_number", "drive_across"], **drive)
    assert counts(dataset.regime) == {"contact": 469, "flight": 531}
    assert Table.of_xarray(dataset).valid("drive_across") is None


@pytest.mark.parametrize("beside", ["acceleration_x", "terminal_velocity"])
def test_statistics_of_what_always_holds_are_of_every_cell(beside: str) -> None:
    asked = {"over": ["frequency", "amplitude", "beta"], "statistics": ["max"]}
    dataset = vibrafeed.sweep(outputs=["throw_number", beside], **GRID)
    reduced = vibrafeed.sweep(outputs=["throw_number", beside], reduce=asked, **GRID)
    assert int(reduced.throw_number_count) == 1000
    assert float(reduced.throw_number_max) == float(dataset.throw_number.max())


def test_files_keep_the_links(tmp_path: Path) -> None:
    dataset = vibrafeed.sweep(outputs=["acceleration_x", "terminal_velocity"], **GRID)
    for name in ("a.nc", "a.zarr"):
        write_result(Table.of_xarray(dataset), str(tmp_path / name), history="")
    nc, zarr = (read_result(str(tmp_path / name)) for name in ("a.nc", "a.zarr"))
    for read in (nc, zarr):
        verdict = read.variables["regime_terminal_velocity"]
        link = read.variables["terminal_velocity"].attributes["ancillary_variables"]
        assert link == "regime_terminal_velocity"
        np.testing.assert_array_equal(verdict.values, dataset.regime_terminal_velocity)


def test_a_share_names_the_verdict_that_it_means() -> None:
    asked = {
        "over": ["frequency", "amplitude", "beta"],
        "statistics": ["max"],
        "regimes": True,
        "shares": {"too_fast": ["regime_terminal_velocity == faster_than_track"]},
    }
    outputs = ["acceleration_x", "terminal_velocity"]
    reduced = vibrafeed.sweep(outputs=outputs, reduce=asked, **GRID)
    assert float(reduced.share_too_fast) == pytest.approx(0.467)
    assert int(reduced.acceleration_x_count) == 469
    assert int(reduced.terminal_velocity_count) == 2
    assert int(reduced.regime_slip_count) == 398
    assert int(reduced.regime_terminal_velocity_faster_than_track_count) == 467
    asked["shares"] = {"too_fast": ["regime_terminal_velocity == stick"]}
    with pytest.raises(vibrafeed.VibrafeedError, match="no cell of this study has a regime_term"):
        vibrafeed.sweep(outputs=outputs, reduce=asked, **GRID)
    asked["shares"] = {"too_fast": ["regime_acceleration_y == flight"]}
    with pytest.raises(vibrafeed.VibrafeedError, match="Name one of regime, regime_terminal"):
        vibrafeed.sweep(outputs=outputs, reduce=asked, **GRID)
