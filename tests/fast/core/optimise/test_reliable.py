"""Of points whose values chance favoured, the one is kept that stands when it is asked again."""

from __future__ import annotations

import numpy as np
import pytest

from night import spread
from vibrafeed.core.intake import parse_study
from vibrafeed.core.optimise.optima import designs_of
from vibrafeed.core.optimise.prepare import prepare
from vibrafeed.core.optimise.problem import OptimisationProblem, chosen_cells
from vibrafeed.core.optimise.search import most_reliable

NOISE = 0.2


class Noisy:
    """A hill of height 1 at 0.7, under noise below 0.85 and exactly known from there on."""

    lower, upper = np.zeros(1), np.ones(1)

    def __init__(self, noisy: bool = True):
        self.noisy = noisy

    def true(self, x):
        return 1.0 - (x - 0.7) ** 2

    def inside(self, unit):
        return unit

    def longer(self, times):
        assert times > 1
        return Noisy(noisy=False)

    def judged(self, x, design, scales):
        del design, scales
        doubt = np.where(x[0] < 0.85, NOISE if self.noisy else NOISE / 100, 0.0)
        value = self.true(x[0])
        if self.noisy:
            chance = np.random.default_rng(3).uniform(-NOISE, NOISE, value.size)
            value = value + np.where(x[0] < 0.85, chance, 0.0)
        return value, np.zeros(value.size), doubt


def test_the_luckiest_point_is_not_kept():
    problem, unit = Noisy(), np.linspace(0, 1, 2000)[None]
    value, beyond, doubt = problem.judged(unit, {}, {})
    lucky = int(value.argmax())
    place, kept = most_reliable(problem, unit, (value, beyond, doubt), {}, {})
    assert value[lucky] > 1.1
    assert kept == problem.true(unit[0, place])
    # 32 niches of 2,000/128 points each: the best of them is near the top of the hill.
    assert kept > problem.true(unit[0, lucky])
    assert kept > 0.99


def test_a_known_value_beats_lucky_ones_that_do_not_stand():
    problem, unit = Noisy(), np.linspace(0, 1, 2000)[None]
    problem.true = lambda x: np.where(x < 0.85, 0.5, 0.6)
    longer = Noisy(noisy=False)
    longer.true = problem.true
    problem.longer = lambda times: longer
    value, beyond, doubt = problem.judged(unit, {}, {})
    assert unit[0, value.argmax()] < 0.85
    place, kept = most_reliable(problem, unit, (value, beyond, doubt), {}, {})
    assert unit[0, place] >= 0.85
    assert kept == 0.6


def test_what_breaks_a_constraint_is_not_kept():
    problem, unit = Noisy(), np.linspace(0, 1, 2000)[None]
    value, _, doubt = problem.judged(unit, {}, {})
    beyond = np.where(unit[0] > 0.4, 1.0, 0.0)
    place, _ = most_reliable(problem, unit, (value, beyond, doubt), {}, {})
    assert unit[0, place] <= 0.4


def simulated(restitution: float) -> tuple[OptimisationProblem, dict, dict]:
    study = parse_study({
        "kind": "optimise", "scene": "rectangle-on-plane",
        "criterion": {"kind": "maximise", "output": "conveying_velocity"},
        "variables": {"beta": {"lower": "12 deg", "upper": "20 deg"}},
        "parameters": {"frequency": "60 Hz", "amplitude": "0.5 mm", "friction": 0.5,
                       "restitution": restitution},
    })  # fmt: skip
    prepared = prepare(study)
    design = chosen_cells(designs_of(prepared.problem, prepared.designs), slice(0, 1))
    return prepared.problem, design, prepared.problem.scales(design)


@pytest.mark.parametrize("restitution", spread([0.0, 0.8], 1))
def test_simulated_velocities_stand(restitution):
    problem, design, scales = simulated(restitution)
    unit = np.linspace(0, 1, 300)[None]
    x = problem.lower[:, None] + (problem.upper - problem.lower)[:, None] * unit
    judged = problem.judged(x, design, scales)
    value = judged[0]
    best = int(value.argmax())
    place, kept = most_reliable(problem, unit, judged, design, scales)
    doubt = judged[2]
    if restitution == 0:
        assert (place, kept) == (best, value[best])
        assert doubt[best] == 0
    else:
        assert doubt[best] > 0  # the largest mean is chance in part
        again, _, unsure = problem.longer(300.0).judged(x[:, [place]], design, scales)
        assert abs(again - kept) <= unsure + 1e-12
        # What is kept is no less than what was sure of the largest.
        assert kept >= value[best] - doubt[best]
