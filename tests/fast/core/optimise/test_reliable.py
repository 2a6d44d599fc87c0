"""Of points whose values chance favoured, the one is kept that stands when it is asked again."""

from __future__ import annotations

import numpy as np

from vibrafeed.core.intake import parse_study
from vibrafeed.core.optimise.optima import designs_of
from vibrafeed.core.optimise.prepare import prepare
from vibrafeed.core.optimise.problem import chosen_cells
from vibrafeed.core.optimise.search import most_reliable

NOISE = 0.2


class Noisy:
    """A hill, or other values, under noise below 0.85 and exactly known from there on."""

    lower, upper = np.zeros(1), np.ones(1)

    def __init__(self, true=lambda x: 1.0 - (x - 0.7) ** 2, noise=NOISE):
        self.true, self.noise = true, noise

    def inside(self, unit):
        return unit

    def longer(self, times):
        assert times > 1
        return Noisy(self.true, NOISE / 100)

    def judged(self, x, design, scales):
        del design, scales
        doubt = np.where(x[0] < 0.85, self.noise, 0.0)
        chance = np.random.default_rng(3).uniform(-1, 1, x[0].size) if self.noise == NOISE else 0.0
        return self.true(x[0]) + doubt * chance, np.zeros(x[0].size), doubt


def kept_of(problem, unit, beyond=None):
    """Return the values of all points, the place of the one that is kept, and its value."""
    value, within, doubt = problem.judged(unit, {}, {})
    judged = value, within if beyond is None else beyond, doubt
    return value, *most_reliable(problem, unit, judged, {}, {})


UNIT = np.linspace(0, 1, 2000)[None]


def test_the_luckiest_point_is_not_kept():
    problem = Noisy()
    value, place, kept = kept_of(problem, UNIT)
    assert value.max() > 1.1
    assert kept == problem.true(UNIT[0, place])
    # 32 niches of 2,000/128 points each: the best of them is near the top of the hill.
    assert kept > max(0.99, problem.true(UNIT[0, value.argmax()]))
    _, place, _ = kept_of(problem, UNIT, beyond=np.where(UNIT[0] > 0.4, 1.0, 0.0))
    assert UNIT[0, place] <= 0.4  # what breaks a constraint is not kept


def test_a_known_value_beats_lucky_ones_that_do_not_stand():
    value, place, kept = kept_of(Noisy(lambda x: np.where(x < 0.85, 0.5, 0.6)), UNIT)
    assert UNIT[0, value.argmax()] < 0.85 <= UNIT[0, place]
    assert kept == 0.6


def test_simulated_velocities_stand():
    study = parse_study({
        "kind": "optimise", "scene": "rectangle-on-plane",
        "criterion": {"kind": "maximise", "output": "conveying_velocity"},
        "variables": {"beta": {"lower": "12 deg", "upper": "20 deg"}},
        "parameters": {"frequency": "60 Hz", "amplitude": "0.5 mm", "friction": 0.5,
                       "restitution": [0.0, 0.8]},
    })  # fmt: skip
    prepared, unit = prepare(study), np.linspace(0, 1, 300)[None]
    problem, designs = prepared.problem, designs_of(prepared.problem, prepared.designs)
    x = problem.lower[:, None] + (problem.upper - problem.lower)[:, None] * unit
    for place_of_design in (0, 1):
        design = chosen_cells(designs, slice(place_of_design, place_of_design + 1))
        scales = problem.scales(design)
        value, _, doubt = judged = problem.judged(x, design, scales)
        best = int(value.argmax())
        place, kept = most_reliable(problem, unit, judged, design, scales)
        if place_of_design == 0:
            assert (place, kept, doubt[best]) == (best, value[best], 0)
    assert doubt[best] > 0  # the largest mean is chance in part
    again, _, unsure = problem.longer(300.0).judged(x[:, [place]], design, scales)
    assert abs(again - kept) <= unsure + 1e-12
    # What is kept is no less than what was sure of the largest.
    assert kept >= value[best] - doubt[best]
