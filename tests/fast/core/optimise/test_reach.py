"""Where no choice keeps all limits: how near one gets, and what would keep them."""

from __future__ import annotations

import pytest

import vibrafeed
from vibrafeed.core import optimise
from vibrafeed.core.intake import parse_study, prepare_content
from vibrafeed.core.kinds import tabulate

STUDY = {
    "kind": "optimise", "scene": "rectangle-on-plane",
    "criterion": {"kind": "maximise", "output": "conveying_velocity"},
    "constraints": [
        {"output": "throw_number", "upper": 1},
        {"output": "conveying_velocity", "lower": "50 mm/s"},
    ],
    "variables": {
        "amplitude": {"lower": "0.1 mm", "upper": "1 mm"},
        "beta": {"lower": "5 deg", "upper": "45 deg"},
    },
    "parameters": {"frequency": "50 Hz", "friction": 0.3, "gamma": "3 deg"},
}  # fmt: skip
FIXED = {"scene": "rectangle-on-plane", "frequency": 50, "friction": 0.3, "gamma": 3}
OUTPUTS = ["conveying_velocity", "throw_number"]


@pytest.fixture(scope="module")
def ways():
    """Return what would keep the limits of the study; the searches for it take seconds."""
    return optimise.ways(parse_study(STUDY))


def test_each_limit_is_reached_as_far_as_the_others_allow():
    throw, speed = optimise.nearest(parse_study(STUDY))
    assert (throw.output, speed.output) == ("throw_number", "conveying_velocity")
    # The same by two other studies: the fastest without a hop, the gentlest with 50 mm/s.
    fastest = vibrafeed.optimise({**STUDY, "constraints": STUDY["constraints"][:1]})
    assert speed.value == pytest.approx(float(fastest.objective), rel=1e-9)
    held = vibrafeed.simulate(**FIXED, **throw.choice, outputs=OUTPUTS)
    # What is told is the bound that suffices; the search keeps it by a little more.
    assert throw.value * (1 - 1e-6) < float(held.throw_number) <= throw.value * (1 + 1e-12)
    assert float(held.conveying_velocity) >= 0.05 * (1 - 1e-9)
    # Beneath it nothing is fast enough: the best of a fine grid without that throw number.
    grid = vibrafeed.simulate(
        **FIXED, amplitude={"start": 1e-4, "stop": 1e-3, "num": 60},
        beta={"start": 5, "stop": 45, "num": 60}, outputs=OUTPUTS,
    )  # fmt: skip
    slow = grid.conveying_velocity.where(grid.throw_number < 0.97 * throw.value)
    assert float(slow.max()) < 0.05


def test_an_ellipse_keeps_limits_that_no_line_keeps(ways):
    (way,) = [one for one in ways if "ellip" in one.change]
    held = vibrafeed.simulate(**FIXED, **way.choice, outputs=OUTPUTS)
    assert float(held.conveying_velocity) == pytest.approx(way.value, rel=1e-9)
    assert way.value > 0.05
    assert float(held.throw_number) <= 1 + 1e-9


@pytest.mark.night
def test_more_friction_keeps_limits_where_it_does(ways):
    limits = [STUDY["constraints"][0], {"output": "conveying_velocity", "lower": "14 mm/s"}]
    slower = optimise.ways(parse_study({**STUDY, "constraints": limits}))
    (way,) = [one for one in slower if one.change == "more friction"]
    assert 0.3 < way.choice["friction"] <= 0.8
    held = vibrafeed.simulate(**{**FIXED, **way.choice}, outputs=OUTPUTS)
    assert float(held.conveying_velocity) == pytest.approx(way.value, rel=1e-9)
    assert way.value > 0.014
    assert float(held.throw_number) <= 1 + 1e-9
    # With 50 mm/s no friction does: nothing is said of it.
    assert all("friction" not in one.change for one in ways)
    rough = {**STUDY, "parameters": {**STUDY["parameters"], "friction": 0.9}}
    assert all("friction" not in one.change for one in optimise.ways(parse_study(rough)))


def test_what_has_no_line_or_is_no_search_has_no_wider_choice():
    other = {**STUDY, "variables": {"friction": {"lower": 0.1, "upper": 0.5}}}
    other["parameters"] = {"frequency": "50 Hz", "amplitude": "0.1 mm", "beta": 20, "gamma": 3}
    assert all("ellip" not in one.change for one in optimise.ways(parse_study(other)))
    sweep = {"kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["throw_number"],
             "parameters": {"frequency": 50, "amplitude": 1e-3, "beta": 20}}  # fmt: skip
    assert optimise.nearest(parse_study(sweep)) == optimise.ways(parse_study(sweep)) == []


def test_the_nearest_approach_of_a_robust_study_is_that_of_all_units():
    study = {
        "kind": "optimise", "scene": "linear-drive-unit", "variant": "measured",
        "criterion": {"kind": "maximise", "output": "drive_unit_power"},
        "variables": {"ring_down_frequency": {"lower": 44.0, "upper": 48.0}},
        "constraints": [{"output": "track_amplitude", "lower": 0.8e-3}],
        "uncertain": {"damping_ratio": {"lower": 0.014, "upper": 0.026}},
        "robust": "quantile", "quantile": 0.5,
        "parameters": {
            "frequency": 50.0, "moving_mass": 10.0, "base_mass": 30.0, "drive_force": 30.0,
        },
    }  # fmt: skip
    prepared = prepare_content(study)
    (reach,) = optimise.nearest(prepared.study)
    worst = tabulate(
        prepare_content(
            {**study, "robust": "worst", "quantile": None, "constraints": [],
             "criterion": {"kind": "maximise", "output": "track_amplitude"}}
        )
    )  # fmt: skip
    assert reach.value == pytest.approx(float(worst.variables["objective"].values), rel=1e-9)
    assert reach.value < 0.8e-3
