"""Rows of parts: values that other programs and closed forms give, to their digits."""

import numpy as np
import pytest

from rows import TURN, cell, followed, path, two_level
from vibrafeed.core.motion.kernels.rows.row_state import IN_SPACE

MM_S = 9.81 / (2 * np.pi * 50) * 1e3
"""g/w at 50 Hz and 9.81 m/s2 [mm/s]."""


@pytest.mark.parametrize(
    ("row", "slow", "slowest", "fastest", "platoons"),
    [
        (([0.5], [0.3]), 0.4, 15.882857, 15.882857, 1),
        (([0.5] * 4, [0.3] * 4), 0.4, 15.882857, 15.882857, 1),
        (([0.3, 0.4], None), 0.2, 5.350909, 5.350909, 1),  # as one part of friction 0.35
        (([0.4, 0.3], None), 0.2, 4.756364, 6.064364, 2),
    ],
    ids=["one", "alike", "push each other", "leave each other"],
)
def test_parts_under_two_levels(row, slow, slowest, fastest, platoons):
    static, kinetic = row
    found, name = followed(cell(0, 0, static, kinetic=kinetic, steps=two_level(slow, 2.0)))
    assert (name, found["platoons"]) == ("periodic", platoons)
    assert found["slowest"] * MM_S == pytest.approx(slowest, abs=5e-7)
    assert found["fastest"] * MM_S == pytest.approx(fastest, abs=5e-7)


def test_a_gap_closes_after_its_length_over_the_difference_of_velocities():
    gap = 5e-3 / (9.81 / (TURN * 50) ** 2)
    row = cell(0, 0, [0.3, 0.4], gap=[gap], steps=two_level(0.2, 2.0))
    # Velocities swing within a period: the gap closes within one of the time of the means.
    _, gaps = path(row, TURN * 50 * np.array([3.82263 - 0.02, 3.82263 + 0.02]))
    assert gaps[0] > 0.0
    assert gaps[1] == 0.0


def test_three_parts_of_one_friction_that_is_larger_at_rest():
    three = cell(2.0, 0.6, [0.5] * 3, kinetic=[0.3] * 3, mass=[1.0, 2.0, 0.5])
    places, _ = path(three, TURN * np.arange(31))
    # Of another program: the mean of the periods 21 to 30, which have not quite settled yet.
    assert (places[30] - places[20]) / (10 * TURN) == pytest.approx([0.3861115517] * 3, abs=5e-11)
    settled, name = followed(three)
    assert name == "periodic"
    # The method "reference" of one part gives 0.38611096503.
    assert settled["velocity"] == pytest.approx(0.38611096503, abs=2e-11)


def test_a_row_of_period_two():
    found, name = followed(cell(3.0, 0.9, [0.5, 0.3]))
    assert (name, found["multiple"]) == ("periodic", 2)
    assert found["velocity"] == pytest.approx(0.821698729434, abs=1e-11)
    _, gaps = path(cell(3.0, 0.9, [0.5, 0.3]), TURN * np.arange(200, 204))
    assert sorted(gaps[:2, 0]) == pytest.approx([0.36625036, 0.81667924], abs=1e-8)
    assert gaps[2:] == pytest.approx(gaps[:2], abs=1e-10)


def test_an_aperiodic_row_keeps_its_mean():
    p, pz, gamma = 3.3397910, 0.6899518, -0.0118420
    row = cell(
        np.sqrt(p * p - pz * pz), pz, [0.6497323, 0.1273437], mass=[0.7813170, 1.6836820],
        gs=np.sin(gamma), gn=np.cos(gamma), most=8000,
    )  # fmt: skip
    found, name = followed(row)
    assert (name, found["platoons"]) == ("aperiodic", 1)
    # 0.9198 +- 0.0005 over 1,200 periods by another program; both errors are statistical.
    assert found["velocity"] == pytest.approx(0.9198, abs=3 * (5e-4 + found["error"]))
    # The gap at the starts of 1,200 periods, once the parts have met again after the first.
    _, gaps = path(row, TURN * np.arange(36, 1201))
    assert gaps.min() == pytest.approx(0.52, abs=5e-3)
    # The largest of so many hangs on rounding, as the motion is chaotic.
    assert gaps.max() == pytest.approx(3.94, abs=0.1)


def test_parts_that_hop():
    one, other = (followed(cell(2.5, 1.8, [mu]))[0]["velocity"] for mu in (0.4, 0.6))
    three, _ = followed(cell(2.5, 1.8, [0.4] * 3, mass=[1.0, 2.0, 0.5]))
    assert three["velocity"] == pytest.approx(one, abs=1e-12)
    assert three["flight"] > 0.0
    # By another program in 8,000 steps of a period, whose error is some 1e-3.
    assert other == pytest.approx(2.0977, abs=2e-3)
    row = cell(2.5, 1.8, [0.6, 0.2])
    pair, _ = followed(row)
    assert pair["velocity"] == pytest.approx(1.8556, abs=1e-3)
    # Sums over a period by its path: a collision of equal parts that stay together takes v^2/4.
    gap = path(row, TURN * np.arange(40, 41, 1 / 2000))[1][:, 0]
    closed = gap < 1e-12
    closes = np.flatnonzero(~closed[1:-1] & closed[2:]) + 1
    speed = (gap[closes - 1] - gap[closes]) * 2000 / TURN
    sums = {"gap": gap.mean(), "contact": closed.mean(), "collisions": len(closes),
            "impact": (speed**2 / 4).sum()}  # fmt: skip
    assert {name: pair[name] for name in sums} == pytest.approx(sums, rel=0.01)


def test_a_stop_just_below_the_throw_number_from_which_it_takes_all_friction():
    found, _ = followed(cell(2.5, 1.6, [0.4], stop=IN_SPACE))
    assert found["stop_force"] == pytest.approx(0.1764, abs=3e-4)  # by stepping
