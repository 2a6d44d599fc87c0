"""What time stepping calls a motion on the track does not hang on its steps.

Slips and landings fall on steps, so that a motion that repeats every period runs through a cycle of
several that differ by what a step changes. On this bowl a third of the cells were called
`period_doubled` for that.
"""

from __future__ import annotations

import numpy as np
import pytest

from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.motion.methods.stepping import without_landing_steps
from vibrafeed.core.motion.result import COLUMNS, SHARES, STATUS, motion_of
from vibrafeed.core.quantities import REGIMES

STUDY = {
    "kind": "simulate",
    "scene": "rectangle-on-track",
    "method": "time-stepping",
    "outputs": ["conveying_velocity", "conveying_velocity_error", "period_multiple"],
}
BOWL = {"frequency": 50, "gamma": 2, "radius": "0.15 m", "friction": 0.2}
AMPLITUDES, BETAS = np.linspace(1e-4, 6e-4, 11), np.linspace(10.0, 40.0, 7)
DOUBLED = (AMPLITUDES[:, None] > 0.54e-3) & (BETAS == 40.0)
"""Where the period doubles in truth, at 0.57 mm and 40 degrees, or nearly."""


def bowl(**changes):
    """Return multiples, velocities and errors over the bowl, or a part of it."""
    drive = {"amplitude": AMPLITUDES.tolist(), "beta": BETAS.tolist()}
    given = changes.pop("parameters", {})
    content = {**STUDY, **changes, "parameters": {**BOWL, **drive, **given}}
    table = tabulate(prepare_content(content))
    return [table.variables[name].values for name in ("period_multiple", *STUDY["outputs"][:2])]


@pytest.fixture(scope="module")
def by_steps():
    return {steps: bowl(steps_per_period=steps) for steps in (250, 1000)}


@pytest.mark.parametrize("steps", [250, 1000])
def test_no_period_is_doubled_by_the_steps(by_steps, steps):
    multiple, _, _ = by_steps[steps]
    wrong = (multiple > 1) & ~DOUBLED
    assert wrong.mean() <= 0.01


def test_labels_stay_while_the_motion_stays_within_its_error(by_steps):
    (coarse, slow, error), (fine, fast, finer) = by_steps.values()
    answered = np.isfinite(slow) & np.isfinite(fast)
    assert answered.mean() > 0.95
    same = np.abs(slow - fast) <= error + finer
    assert np.mean((coarse != fine)[answered & same & ~DOUBLED]) <= 0.01


def test_a_period_that_is_doubled_is_called_so():
    # Well beyond the doubling: states of two periods differ by more than a hundred steps' changes.
    multiple, _, _ = bowl(parameters={"amplitude": 6e-4, "beta": 40.0})
    assert multiple == 2


@pytest.mark.parametrize(("amplitude", "beta"), [(2e-4, 15.0), (3.5e-4, 20.0), (4e-4, 35.0)])
def test_the_reference_says_the_same(by_steps, amplitude, beta):
    point = {"amplitude": amplitude, "beta": beta}
    multiple, velocity, error = bowl(method="reference", parameters=point)
    at = np.argmin(np.abs(AMPLITUDES - amplitude)), np.argmin(np.abs(BETAS - beta))
    steps, slow, doubt = (values[at] for values in by_steps[1000])
    assert steps == multiple
    assert abs(slow - velocity) <= doubt + error


# Where a part only lands on the floor, a landing takes a step.

LOUD = {
    "frequency": 50,
    "friction": 0.2,
    "amplitude": np.linspace(3e-4, 4.5e-4, 15).tolist(),
    "beta": np.linspace(30.0, 60.0, 15).tolist(),
}
HOPS = {name: REGIMES[name].value for name in ("hopping", "hop_after_hop")}


def hops(**changes):
    """Return regimes, shares and impacts of a block on a plane under a drive that throws it."""
    outputs = [*(f"{name}_fraction" for name in SHARES), "impacts_per_period"]
    study = {**STUDY, "scene": "rectangle-on-plane", "outputs": outputs, "parameters": LOUD}
    table = tabulate(prepare_content(study | changes))
    *shares, impacts = (table.variables[name].values for name in outputs)
    return table.variables["regime"].values, dict(zip(SHARES, shares, strict=True)), impacts


@pytest.mark.parametrize("steps", [300, 1000])
def test_a_part_that_only_lands_is_in_the_air_all_the_time(steps):
    exact, truth, impacts = hops(method="events")
    found, shares, _ = hops(steps_per_period=steps)
    alone = found == HOPS["hop_after_hop"]
    assert alone.sum() > 15
    # In truth it may be on the floor for less than the step that an impact is a landing in.
    assert np.all(((1.0 - truth["flight"]) * (2 * steps + 1) < impacts)[alone])
    assert not np.any((exact == HOPS["hop_after_hop"]) & (found == HOPS["hopping"]))
    # Exactly so: labels hang on it.
    assert np.all(shares["flight"][alone] == 1.0)
    assert all(np.all(shares[name][alone] == 0.0) for name in SHARES if name != "flight")
    assert np.all(shares["flight"][found == HOPS["hopping"]] < 1.0)


def test_a_step_more_on_the_floor_than_landings_is_time_on_the_floor():
    steps, periods = 2001, 16
    floor = np.array([0, 16, 17, 32, 33, 272, 16]) / periods  # steps a period
    impacts = np.array([0, 16, 16, 32, 32, 272, 0]) / periods
    lands = np.array([False, True, False, True, False, True, False])
    motion = motion_of(np.zeros((7, COLUMNS)), np.full(7, STATUS["periodic"], np.int8), (7,))
    share = {"stick": floor / steps / 3, "forward": 2 * floor / steps / 3}
    motion = motion._replace(**share, flight=1.0 - floor / steps, impacts=impacts)
    found = without_landing_steps(motion, steps)
    for name in SHARES:
        alone = 1.0 if name == "flight" else 0.0
        assert np.array_equal(
            getattr(found, name), np.where(lands, alone, getattr(motion, name))
        ), name
