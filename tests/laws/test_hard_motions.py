"""Cells at which a method, a search or a posterior has been wrong, with what is right there.

Those of the track are in `test_every_status.py`, of waves in `test_planar_means.py`, of derivatives in
`test_motion_derivatives.py`; here is what belongs to none of them.
"""  # noqa: E501

from __future__ import annotations

import warnings

import numpy as np
import pytest

import vibrafeed
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.quantities import MOTION_STATUSES, REGIMES
from vibrafeed.core.watch import Watch

LEVEL = {"scene": "rectangle-on-plane", "frequency": 50, "friction": 0.5}
MEAN = ["conveying_velocity", "conveying_velocity_error", "period_multiple"]


def moved(**parameters):
    """Return mean velocity [m/s], its error, multiple and status of one part; no warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", ".*usual values are")
        found = vibrafeed.simulate(**parameters, outputs=MEAN)
    status = MOTION_STATUSES.keys()
    value = int(found.motion_status)
    (name,) = (name for name in status if MOTION_STATUSES[name].value == value)
    return *(float(found[output]) for output in MEAN), name


# --- methods


@pytest.mark.parametrize("method", ["events", "reference", "time-stepping"])
@pytest.mark.parametrize("beta", [90, -90])
def test_a_part_that_is_only_lifted_goes_nowhere(method, beta):
    """The reference divided 0 by 0 and told `aperiodic`."""
    velocity, error, multiple, status = moved(
        **LEVEL, amplitude="0.25 mm", beta=beta, method=method
    )
    assert status == "periodic"
    assert multiple == 1
    assert abs(velocity) <= error + 1e-15


@pytest.mark.parametrize("method", ["events", "reference"])
def test_a_drive_beyond_all_numbers_has_no_mean(method):
    """The reference did not return."""
    velocity, _, _, status = moved(**LEVEL, amplitude=1e200, beta=30, method=method)
    assert status == "limit_reached"
    assert np.isnan(velocity)


def test_a_reference_on_its_way_has_no_mean_and_followed_further_the_right_one():
    """It told 23.757 +- 0.010 mm/s; right is 23.7885049, by `events` and by itself, followed on."""
    part = {
        "scene": "rectangle-on-track", "frequency": 94.77336081655253,
        "amplitude": 0.24976347661458185e-3, "beta": 15.821811376990269,
        "alpha": -23.300678233595903, "delta": 29.684382450095644,
        "radius": 0.2571147638571506, "friction": 0.6647636435674749,
    }  # fmt: skip
    early, _, _, status = moved(**part, method="reference")
    assert np.isnan(early)
    assert status == "limit_reached"
    for settings in ({}, {"method": "reference", "max_periods": 1000}):
        velocity, error, multiple, status = moved(**part, **settings)
        assert (multiple, status) == (2, "periodic")
        assert abs(velocity - 23.7885049e-3) <= error + 5e-11


@pytest.mark.parametrize(
    ("friction", "right"),
    [(1e-2, 4.10), (3e-3, 3.58), (1e-3, 3.43), (1e-4, 3.36), (1e-9, 3.353)],
)
def test_time_stepping_has_no_mean_while_a_part_loses_its_first_speed(friction, right):
    """It told 10.6 to 68.0 mm/s, the last of them as `periodic`. Right [mm/s]: by an own solver."""
    part = {**LEVEL, "friction": friction, "amplitude": "0.25 mm", "beta": 30}
    velocity, _, _, status = moved(**part)
    assert status == "periodic"
    assert 1e3 * velocity == pytest.approx(right, abs=6e-3)
    stepped, error, _, status = moved(**part, method="time-stepping")
    assert status == "limit_reached" or abs(stepped - velocity) <= error
    assert np.isnan(stepped) == (status == "limit_reached")


# --- numbers at the end of floats


@pytest.mark.parametrize("variant", ["thesis", "derived", "physical"])
@pytest.mark.parametrize(
    "scene", ["rectangle-on-plane", "cylinder-on-plane", "rectangle-on-track"]
)  # fmt: skip
def test_a_drive_too_large_for_a_float_is_data_and_no_warning(scene, variant):
    """An infinite acceleration is flight, as that just below is: no cell becomes valid."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", ".*usual values are")
        found = vibrafeed.sweep(
            scene=scene, variant=variant, frequency=50, amplitude=[1e300, 1e308, 1.7e308],
            beta=[30, 60], friction=0.5, alpha=10, outputs=["acceleration_x", "throw_number"],
        )  # fmt: skip
    assert np.isfinite(found.throw_number[0]).all()
    assert np.isposinf(found.throw_number[1:]).all()
    flying = [REGIMES[name].value for name in ("flight", "flight_and_wall_lost")]
    assert np.isin(found.regime, flying).all()


@pytest.mark.parametrize("length", [0, -0.01, np.array([0.01, 0.0])])
def test_parts_without_a_length_have_no_rate(length):
    """A rate was infinite or below 0, with a warning of numpy."""
    for rate in (
        lambda: vibrafeed.parts_per_minute(velocity=0.03, length=length),
        lambda: vibrafeed.velocity_for(parts_per_minute=100, length=length),
    ):
        with pytest.raises(
            vibrafeed.StudyError, match="length: length plus gap, the track that one part takes"
        ):
            rate()


# --- searches and reductions


@pytest.mark.parametrize("method", ["newton", "population", "grid", "slsqp"])
def test_a_limit_that_nothing_keeps_is_infeasible_by_every_method(method):
    """By newton it was `no_motion`. Each choice moves the part; the least |a_y| is 10.4 m/s^2."""
    found = vibrafeed.optimise({
        "kind": "optimise", "scene": "rectangle-on-plane", "variant": "physical", "method": method,
        "criterion": {"kind": "limit", "limit": "2.17 m/s^2"},
        "variables": {"alpha": {"lower": 6, "upper": 72}, "beta": {"lower": 0, "upper": 90}},
        "parameters": {
            "frequency": 96.84, "amplitude": "0.29 mm", "friction": 0.7646, "gamma": 7.67,
        },
    })  # fmt: skip
    assert found.attrs["message"].startswith("infeasible: no choice keeps")


def test_quantiles_count_cells_whether_all_count_or_the_valid_ones():
    """Where all are valid both are numpy's; of all cells only an output's own values counted."""
    sweep = {
        "scene": "rectangle-on-plane", "frequency": 50, "amplitude": 2e-5, "friction": 0.3,
        "alpha": {"start": 0, "stop": 60, "num": 7}, "beta": {"start": 2, "stop": 60, "num": 6},
        "outputs": ["throw_number", "acceleration_x"],
    }  # fmt: skip
    values = np.repeat(vibrafeed.sweep(**sweep).throw_number.values.ravel(), 7)
    asked = [0.1, 0.37, 0.5, 0.9]
    for cells in ("valid", "all"):
        reduced = {"over": ["alpha", "beta"], "quantiles": asked, "cells": cells}
        found = vibrafeed.sweep(reduce=reduced, **sweep)
        assert int(found.throw_number_count) == values.size == 42
        np.testing.assert_allclose(
            found.throw_number_quantile, np.quantile(values, asked), rtol=1e-12
        )


# --- calibrations


def calibration(friction, amplitudes, error, *, beta, gamma=0):
    """Return a study of runs, each as of a part with its own friction, and their speeds [m/s]."""
    drive = {"frequency": 50, "beta": beta, "gamma": gamma}
    speeds = [
        float(
            vibrafeed.simulate(
                scene="rectangle-on-plane", **drive, friction=mu, amplitude=amplitude
            ).conveying_velocity
        )
        for mu, amplitude in zip(friction, amplitudes, strict=True)
    ]
    runs = [
        {"amplitude": amplitude, "conveying_velocity": speed, "error": error}
        for amplitude, speed in zip(amplitudes, speeds, strict=True)
    ]
    return {
        "kind": "calibrate", "scene": "rectangle-on-plane", "parameters": drive,
        "observations": runs, "unknowns": {"friction": {"lower": 0.05, "upper": 0.8}},
        "discrepancy": False,
    }, speeds  # fmt: skip


@pytest.mark.parametrize(("friction", "share"), [(0.27, 0.02), (0.25, 0.1)])
def test_modes_share_out_the_mass_of_the_posterior(friction, share):
    """By 20,000 frictions of equal weight; the narrow mode had 0.6 points too much of it.

    The modes are apart: between them the density falls to 1e-6 of its largest, so that it does not
    matter to which of them the border belongs.
    """
    study, (speed,) = calibration([friction], [1e-4], f"{100 * share} %", beta=40, gamma=2)
    prepared = prepare_content(study)
    found = tabulate(prepared).to_xarray()
    grid = 0.05 + (np.arange(20_000) + 0.5) / 20_000 * 0.75
    value = prepared.model.predict(grid[:, np.newaxis], Watch()).value[:, 0]
    weight = np.exp(-0.5 * np.square((value - speed) / (share * speed)))
    border = grid[np.argmax(value)]  # the fastest friction, far from what was measured
    assert weight[np.argmax(value)] < 1e-6
    narrow = weight[grid < border].sum() / weight.sum()
    modes = dict(zip(found.mode_friction.values, found.mode_share.values, strict=True))
    assert len(modes) == 2
    assert modes[min(modes)] == pytest.approx(narrow, abs=1e-3)
    assert sum(modes.values()) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.night
def test_runs_that_contradict_each_other_have_an_interval_around_the_best():
    """Errors are 300 times too small; the interval was 0.31039 to 0.31039, the best 0.28586."""
    study, _ = calibration([0.2, 0.575], [2e-4, 1.5e-4], 1e-6, beta=20)
    found = vibrafeed.calibrate(study)
    assert float(found.best_friction) == pytest.approx(0.28586, abs=1e-5)
    assert found.lower_95_friction < found.best_friction < found.upper_95_friction
    assert float(found.upper_95_friction - found.lower_95_friction) < 2e-4
    assert "Far from what the best values give" in found.attrs["findings"]


def test_a_speed_with_its_unit_forgotten_has_one_mode_at_the_edge():
    """It was 0.461 to 0.461, and "cannot tell friction 0.6 (98 %) from friction 0.6 (2 %)"."""
    study, _ = calibration([], [], 1e-6, beta=20)
    study["observations"] = [{"amplitude": 2e-4, "conveying_velocity": 5.0, "error": 1e-6}]
    study["unknowns"] = {"friction": {"lower": 0.05, "upper": 0.6}}
    found = vibrafeed.calibrate(study)
    assert found.mode_friction.size == 1
    for name in ("best_friction", "lower_95_friction", "upper_95_friction"):
        assert float(found[name]) == pytest.approx(0.6, abs=1e-6)
    assert "cannot tell" not in found.attrs["findings"]
