"""Rows of parts: values that other programs and closed forms give, to their digits."""

from __future__ import annotations

import numpy as np
import pytest

import vibrafeed
from rows import TURN, cell, followed, two_level
from vibrafeed.core.motion.kernels.rows import path_of_row
from vibrafeed.core.motion.kernels.rows.row_state import IN_SPACE

MM_S = 9.81 / (2 * np.pi * 50) * 1e3
"""g/w at 50 Hz and 9.81 m/s2 [mm/s]."""


def test_one_part_under_two_levels():
    one = cell(0, 0, [0.5], kinetic=[0.3], steps=two_level(0.4, 2.0))
    found, name = followed(one)
    assert name == "periodic"
    assert found["velocity"] * MM_S == pytest.approx(15.882857, abs=5e-7)
    many, _ = followed(cell(0, 0, [0.5] * 4, kinetic=[0.3] * 4, steps=two_level(0.4, 2.0)))
    assert many["velocity"] == pytest.approx(found["velocity"], abs=1e-14)


def test_two_parts_that_push_each_other_under_two_levels():
    together, name = followed(cell(0, 0, [0.3, 0.4], steps=two_level(0.2, 2.0)))
    assert name == "periodic"
    assert together["platoons"] == 1
    for column in ("velocity", "slowest", "fastest"):  # that of one part of friction 0.35
        assert together[column] * MM_S == pytest.approx(5.350909, abs=5e-7)


def test_two_parts_that_leave_each_other_under_two_levels():
    apart, _ = followed(cell(0, 0, [0.4, 0.3], steps=two_level(0.2, 2.0)))
    assert apart["platoons"] == 2
    assert apart["slowest"] * MM_S == pytest.approx(4.756364, abs=5e-7)
    assert apart["fastest"] * MM_S == pytest.approx(6.064364, abs=5e-7)


def test_a_gap_closes_after_its_length_over_the_difference_of_velocities():
    gap = 5e-3 / (9.81 / (TURN * 50) ** 2)
    row = cell(0, 0, [0.3, 0.4], gap=[gap], steps=two_level(0.2, 2.0))
    # Velocities swing within a period: the gap closes within one of the time of the means.
    phases = TURN * 50 * np.array([3.82263 - 0.02, 3.82263 + 0.02])
    gaps = np.empty((2, 1))
    path_of_row(row, phases, np.empty((2, 2)), gaps)
    assert gaps[0] > 0.0
    assert gaps[1] == 0.0


def test_three_parts_of_one_friction_that_is_larger_at_rest():
    three = cell(2.0, 0.6, [0.5] * 3, kinetic=[0.3] * 3, mass=[1.0, 2.0, 0.5])
    places = np.empty((31, 3))
    path_of_row(three, TURN * np.arange(31), places, np.empty((31, 2)))
    # Of another program: the mean of the periods 21 to 30, which have not quite settled yet.
    assert (places[30] - places[20]) / (10 * TURN) == pytest.approx([0.3861115517] * 3, abs=5e-11)
    settled, name = followed(three)
    assert name == "periodic"
    # The method "reference" of one part gives 0.38611096503.
    for column in ("velocity", "slowest", "fastest"):
        assert settled[column] == pytest.approx(0.38611096503, abs=2e-11)


def test_a_row_of_period_two():
    found, name = followed(cell(3.0, 0.9, [0.5, 0.3]))
    assert name == "periodic"
    assert found["multiple"] == 2
    assert found["velocity"] == pytest.approx(0.821698729434, abs=1e-11)
    gaps = np.empty((4, 1))
    path_of_row(cell(3.0, 0.9, [0.5, 0.3]), TURN * np.arange(200, 204), np.empty((4, 2)), gaps)
    assert sorted(gaps[:2, 0]) == pytest.approx([0.36625036, 0.81667924], abs=1e-8)
    assert gaps[2:] == pytest.approx(gaps[:2], abs=1e-10)


def test_an_aperiodic_row_keeps_its_mean():
    p, pz, gamma = 3.3397910, 0.6899518, -0.0118420
    row = cell(
        np.sqrt(p * p - pz * pz), pz, [0.6497323, 0.1273437], mass=[0.7813170, 1.6836820],
        gs=np.sin(gamma), gn=np.cos(gamma), most=8000,
    )  # fmt: skip
    found, name = followed(row)
    assert name == "aperiodic"
    assert found["platoons"] == 1
    # 0.9198 +- 0.0005 over 1,200 periods by another program; both errors are statistical.
    assert found["velocity"] == pytest.approx(0.9198, abs=3 * (5e-4 + found["error"]))
    # The gap at the starts of 1,200 periods, once the parts have met again after the first.
    gaps = np.empty((1201, 1))
    path_of_row(row, TURN * np.arange(1201), np.empty((1201, 2)), gaps)
    assert gaps[36:].min() == pytest.approx(0.52, abs=5e-3)
    # The largest of so many hangs on rounding, as the motion is chaotic.
    assert gaps[36:].max() == pytest.approx(3.94, abs=0.1)


def test_equal_parts_are_one_part_to_the_bit():
    study = {"frequency": 50, "amplitude": "0.4 mm", "beta": 25, "outputs": ["conveying_velocity"]}
    one = vibrafeed.simulate(scene="rectangle-on-plane", friction=[0.2, 0.4], **study)
    row = vibrafeed.simulate(scene="row-on-plane", parts=[2, 20], friction=[0.2, 0.4], **study)
    assert (row.conveying_velocity.values == one.conveying_velocity.values[:, np.newaxis]).all()


def test_the_compiled_row_of_equal_parts_is_one_part_too():
    study = {"frequency": 50, "beta": 25, "outputs": ["conveying_velocity"]}
    for size in ("0.08 mm", "0.3 mm", "0.6 mm"):
        one = vibrafeed.simulate(scene="rectangle-on-plane", friction=0.35, amplitude=size, **study)
        row = vibrafeed.simulate(
            scene="row-on-plane", part_friction_1=0.35, part_friction_2=0.35 * (1 + 1e-15),
            amplitude=size, **study,
        )  # fmt: skip
        assert float(row.conveying_velocity) == pytest.approx(
            float(one.conveying_velocity), rel=1e-9
        )


def test_parts_that_hop():
    one, _ = followed(cell(2.5, 1.8, [0.4]))
    three, _ = followed(cell(2.5, 1.8, [0.4] * 3, mass=[1.0, 2.0, 0.5]))
    assert three["velocity"] == pytest.approx(one["velocity"], abs=1e-12)
    assert three["flight"] > 0.0
    found, _ = followed(cell(2.5, 1.8, [0.6, 0.2]))
    alone = [followed(cell(2.5, 1.8, [mu]))[0]["velocity"] for mu in (0.6, 0.2)]
    # By another program in 8,000 steps of a period, whose error is some 1e-3.
    assert found["velocity"] == pytest.approx(1.8556, abs=1e-3)
    assert alone == pytest.approx([2.0977, 1.0184], abs=2e-3)


def test_a_stop_just_below_the_throw_number_from_which_it_takes_all_friction():
    found, _ = followed(cell(2.5, 1.6, [0.4], stop=IN_SPACE))
    assert found["stop_force"] == pytest.approx(0.1764, abs=3e-4)  # by stepping
