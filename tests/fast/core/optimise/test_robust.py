"""Robust values: the worst and the mean over an interval, against brute force."""

import math

import numpy as np
import pytest

import vibrafeed
from robust_units import optimum, units_of
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.optimise.reach import nearest
from vibrafeed.core.optimise.uncertain import NODES, uncertain_of
from vibrafeed.core.study.distributions import read_distribution
from vibrafeed.core.study.values import Between


def robust_value(evaluate, interval, *, how="worst"):
    """Return an objective that knows a parameter only within an interval: what counts of it."""
    law = {"friction": Between(*interval)}
    uncertain = uncertain_of(law, how, None)
    places = uncertain.values["friction"]

    def robust(points):
        count = len(points)
        values = np.asarray(evaluate(np.tile(points, (NODES, 1)), np.repeat(places, count)))
        return uncertain.statistic(values.reshape(NODES, count), 1.0)

    return robust


def hill(points, friction):
    """Return a value with a minimum inside the interval of friction, and a jump at 0.5."""
    return points[:, 0] * (friction - 0.33) ** 2 - np.where(friction > 0.5, points[:, 1], 0.0)


def test_the_worst_case_against_brute_force():
    points = np.random.default_rng(0).uniform(0.5, 1.0, (50, 2))
    fine = np.linspace(0.2, 0.7, 5001)
    brute = np.min([hill(points, np.full(50, f)) for f in fine], axis=0)
    worst = robust_value(hill, (0.2, 0.7))(points)
    # The least value lies just beyond the jump; the next node is up to 1/16 further on.
    assert worst == pytest.approx(brute, abs=0.5 / 8 * 2 * 0.37)
    assert np.all(worst >= brute - 1e-15)


def test_the_mean_against_its_integral():
    points = np.random.default_rng(0).uniform(0.5, 1.0, (50, 2))
    smooth = robust_value(hill, (0.2, 0.4), how="mean")(points)
    exact = points[:, 0] * ((0.07**3 + 0.13**3) / 3) / 0.2  # nine nodes: exact up to order 17
    assert smooth == pytest.approx(exact, rel=1e-13)
    rough = robust_value(hill, (0.2, 0.7), how="mean")(points)
    brute = np.mean([hill(points, np.full(50, f)) for f in np.linspace(0.2, 0.7, 2001)], axis=0)
    # A jump of 1 at most, over 9 nodes whose weights are pi/2/9 at most.
    assert rough == pytest.approx(brute, abs=math.pi / 2 / 9)


@pytest.mark.parametrize("how", ["worst", "mean"])
def test_a_node_without_a_value_takes_the_value_away(how):
    no_value = robust_value(
        lambda points, friction: np.where(friction > 0.35, np.nan, points[:, 0]),
        (0.2, 0.4), how=how,
    )  # fmt: skip
    assert np.isnan(no_value(np.ones((2, 1)))).all()


def test_the_quantile_of_what_is_to_be_least_is_that_of_the_output_itself():
    law = {"friction": read_distribution("friction", {"mean": 0.4, "deviation": 0.03})}
    nodes = uncertain_of(law, "quantile", 0.9)
    output = nodes.values["friction"][:, None]
    assert nodes.statistic(output, 1.0) == pytest.approx([0.4 + 1.2816 * 0.03], rel=5e-3)
    assert nodes.statistic(-output, -1.0) == pytest.approx(-nodes.statistic(output, 1.0), rel=1e-12)


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_the_worst_case_knows_every_corner_and_the_middle(count):
    names = ("friction", "amplitude", "frequency", "gravity")[:count]
    law = {name: read_distribution(name, {"lower": 1.0, "upper": 2.0}) for name in names}
    found = np.array([*uncertain_of(law, "worst", None).values.values()])
    assert {tuple(one) for one in found.T} >= {(1.0,) * count, (2.0,) * count, (1.5,) * count}
    assert found.shape[1] == {1: 9, 2: 25, 3: 27, 4: 17}[count]


def test_a_robust_quantile_is_that_of_units_that_did_not_choose_the_design():
    limit = {"output": "track_amplitude", "upper": 3e-3}
    best = optimum(robust="quantile", quantile=0.05, constraints=[limit])
    told, error = float(best.objective), float(best.objective_error)
    asked = [{"output": "track_amplitude", "at_least": told}]
    many = units_of(best, quantiles=[0.05], demands=asked)
    true = float(many.track_amplitude_quantile[0])
    # By the points of the search it was 1.104 mm, and a tenth of the units fell below.
    assert true == pytest.approx(1.0348e-3, rel=5e-3)
    assert 0 < error < 0.01 * true
    assert abs(told - true) <= error + float(many.track_amplitude_quantile_error[0])
    assert float(many.probability_track_amplitude_at_least) == pytest.approx(0.95, abs=3e-3)
    assert float(best.objective_left_out) == 0
    assert float(best.probability_track_amplitude_upper_broken) == 0
    assert "no unit of those drawn breaks a limit" in best.attrs["message"]


def test_what_no_choice_keeps_for_all_units_and_a_quantile_of_too_many_points():
    best = optimum(
        robust="quantile", quantile=0.2,
        variables={"ring_down_frequency": {"lower": 49.5, "upper": 50.5}},
        constraints=[{"output": "track_amplitude", "upper": 1.5e-3}],
    )  # fmt: skip
    words = best.optimum_status.attrs["flag_meanings"].split()
    assert words[int(best.optimum_status)] == "infeasible"
    with pytest.raises(vibrafeed.StudyError, match=r"quantile of 1e-05 would need too many points"):
        optimum(robust="quantile", quantile=1e-5)


def test_the_nearest_approach_of_a_robust_study_is_that_of_all_units():
    study = {
        "kind": "optimise", "scene": "linear-drive-unit", "variant": "measured",
        "variables": {"ring_down_frequency": {"lower": 44.0, "upper": 48.0}},
        "uncertain": {"damping_ratio": {"lower": 0.014, "upper": 0.026}},
        "parameters": {
            "frequency": 50.0, "moving_mass": 10.0, "base_mass": 30.0, "drive_force": 30.0,
        },
    }  # fmt: skip
    power, amplitude = (
        {"kind": "maximise", "output": name} for name in ("drive_unit_power", "track_amplitude")
    )
    limit = [{"output": "track_amplitude", "lower": 0.8e-3}]
    asked = {"criterion": power, "constraints": limit, "robust": "quantile", "quantile": 0.5}
    (reach,) = nearest(prepare_content({**study, **asked}).study)
    worst = tabulate(prepare_content({**study, "robust": "worst", "criterion": amplitude}))
    assert reach.value == pytest.approx(float(worst.variables["objective"].values), rel=1e-9)
    assert reach.value < 0.8e-3
