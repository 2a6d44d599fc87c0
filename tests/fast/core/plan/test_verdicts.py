"""A verdict belongs to the values that it judges: asking for one more output changes none."""

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibrafeed
from vibrafeed.core.dataset.formats import read_result, write_result
from vibrafeed.core.dataset.table import Table
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
    outputs = ["acceleration_x", "acceleration_y", "terminal_velocity", "throw_number"]
    dataset = vibrafeed.sweep(outputs=outputs, **GRID)
    assert counts(dataset.regime) == {"stick": 71, "slip": 398, "flight": 531}
    assert dataset.acceleration_x.attrs["ancillary_variables"] == "regime"
    velocity = judge(dataset, "terminal_velocity")
    assert velocity.name == "regime_terminal_velocity"
    assert counts(velocity) == {"flight": 531, "no_motion": 2, "faster_than_track": 467}
    assert velocity.attrs["long_name"] == "Regime of terminal velocity"
    # What always holds has no verdict.
    assert "ancillary_variables" not in dataset.throw_number.attrs
    valid = Table.of_xarray(dataset).valid
    assert valid("throw_number") is None
    assert valid("acceleration_x").sum() == 469


@pytest.mark.parametrize("pair", [*itertools.permutations(["acceleration_x", *TRAVEL], 2)])
def test_an_output_is_judged_in_company_as_it_is_alone(pair: tuple[str, str], alone: Any) -> None:
    together = vibrafeed.sweep(outputs=list(pair), **GRID)
    for name in pair:
        np.testing.assert_array_equal(judge(together, name), alone[name])


@pytest.fixture(scope="module")
def alone() -> dict[str, Any]:
    return {
        name: judge(vibrafeed.sweep(outputs=[name], **GRID), name)
        for name in ("acceleration_x", *TRAVEL)
    }


@pytest.mark.parametrize(("scene", "variant"), VARIANTS)
def test_validity_is_the_same_in_company(scene: str, variant: str) -> None:
    """In the order of a verdict no state of one output comes before what judges another."""
    conditions, outputs = SCENES[scene].conditions[variant], SCENES[scene].outputs(variant)
    verdicts = verdicts_of(conditions, outputs)
    assert verdicts[0].name == "regime"
    for verdict in verdicts:
        for name in verdict.outputs:
            own = [one for one in verdict.conditions if name in one.outputs]
            judging = [k for k, one in enumerate(verdict.conditions) if REGIMES[one.regime].judges]
            assert all(verdict.conditions[k] in own for k in judging), (verdict.name, name)
            before = verdict.conditions[: judging[-1]] if judging else ()
            assert set(before) <= set(own), (verdict.name, name)
    judged = [name for verdict in verdicts for name in verdict.outputs]
    assert len(judged) == len(set(judged))  # every output has at most one verdict
    concerned = {name for one in conditions for name in one.outputs & set(outputs)}
    if conditions:
        assert set(judged) == concerned - {"regime", *EXACT}


def test_an_unbounded_efficiency_leaves_the_speed_its_regime() -> None:
    motion, alone = (
        vibrafeed.simulate(
            scene="rectangle-on-plane", outputs=outputs, frequency=50, amplitude="0.3 mm",
            beta=[20, 90], gamma=5, friction=0.4,
        )
        for outputs in (["conveying_velocity", "efficiency"], ["conveying_velocity"])
    )  # fmt: skip
    assert "unbounded" in counts(motion.regime_efficiency)
    assert judge(motion, "efficiency").name == "regime_efficiency"
    assert judge(motion, "conveying_velocity").name == "regime"
    np.testing.assert_array_equal(motion.regime, alone.regime)


@pytest.mark.parametrize("name", ["a.nc", "a.zarr"])
def test_files_keep_the_links(tmp_path: Path, name: str) -> None:
    dataset = vibrafeed.sweep(outputs=["acceleration_x", "terminal_velocity"], **GRID)
    write_result(Table.of_xarray(dataset), str(tmp_path / name), history="")
    variables = read_result(str(tmp_path / name)).variables
    link = variables["terminal_velocity"].attributes["ancillary_variables"]
    assert link == "regime_terminal_velocity"
    np.testing.assert_array_equal(variables[link].values, dataset.regime_terminal_velocity)


def test_a_share_names_the_verdict_that_it_means() -> None:
    def reduced(share: str) -> Any:
        asked = {
            "over": ["frequency", "amplitude", "beta"], "statistics": ["max"], "regimes": True,
            "shares": {"too_fast": [share]},
        }  # fmt: skip
        outputs = ["acceleration_x", "terminal_velocity", "throw_number"]
        return vibrafeed.sweep(outputs=outputs, reduce=asked, **GRID)

    found = reduced("regime_terminal_velocity == faster_than_track")
    told = {
        "share_too_fast": 0.467, "acceleration_x_count": 469, "terminal_velocity_count": 2,
        "throw_number_count": 1000, "regime_slip_count": 398,
        "regime_terminal_velocity_faster_than_track_count": 467,
    }  # fmt: skip
    assert {name: float(found[name]) for name in told} == pytest.approx(told)
    for share, words in (
        ("regime_terminal_velocity == stick", "regime_terminal_velocity is never 'stick'"),
        ("regime_acceleration_y == flight", "Choose one of regime, regime_terminal"),
    ):
        with pytest.raises(vibrafeed.VibrafeedError, match=words):
            reduced(share)
