"""Laws of free rows of parts, on random ones: ten thousand by night."""

from __future__ import annotations

import numpy as np
import pytest

from night import count
from rows import TURN, cell, followed, two_level
from vibrafeed.core.motion.kernels.rows import path_of_row
from vibrafeed.core.motion.kernels.rows.row_sine import flight_time

ROWS = 10_000
"""Rows of a law by night."""
SHORT = 10
"""Periods after which paths of one row, computed in two ways, are compared: some rows are chaotic,
and rounding grows in them."""


def random_row(random, parts=None, px=(0.5, 3.0), pz=(0.1, 2.5)):
    """Return the numbers of a row, as `cell` takes them: half of them on a slope, some apart."""
    n = int(random.integers(2, 7)) if parts is None else parts
    slope = random.choice([0.0, random.uniform(-0.03, 0.03)])
    return {
        "px": random.uniform(*px), "pz": random.uniform(*pz),
        "friction": random.uniform(0.1, 0.8, n), "mass": random.uniform(0.3, 3.0, n),
        "gap": random.choice([0.0, 0.3], n - 1), "gs": np.sin(slope), "gn": np.cos(slope),
    }  # fmt: skip


def path(row, phases):
    """Return places and gaps of the parts of a row at phases."""
    parts = int(row[9])
    places, gaps = np.empty((len(phases), parts)), np.empty((len(phases), parts - 1))
    path_of_row(row, np.asarray(phases, dtype=float), places, gaps)
    return places, gaps


ENDS = TURN * np.arange(1, SHORT + 1)


def test_masses_count_by_their_ratios():
    random = np.random.default_rng(5)
    for _ in range(count(20, ROWS)):
        row = random_row(random)
        again = {**row, "mass": 3.0 * row["mass"]}
        assert path(cell(**again), ENDS)[0] == pytest.approx(path(cell(**row), ENDS)[0], abs=1e-8)


def test_the_mirror_image_of_a_row_moves_as_its_mirror_image():
    random = np.random.default_rng(6)
    for _ in range(count(20, ROWS)):
        row = random_row(random)
        image = {
            **row, "px": -row["px"], "gs": -row["gs"],
            **{name: row[name][::-1] for name in ("friction", "mass", "gap")},
        }  # fmt: skip
        there = path(cell(**image), ENDS)[0][:, ::-1]
        assert -there == pytest.approx(path(cell(**row), ENDS)[0], abs=1e-8)


def test_a_part_far_in_front_changes_nothing():
    random = np.random.default_rng(7)
    for _ in range(count(20, ROWS)):
        row = random_row(random)
        more = {
            **row, "friction": [*row["friction"], 0.3], "mass": [*row["mass"], 1.0],
            "gap": [*row["gap"], 1e6],
        }  # fmt: skip
        assert path(cell(**more), ENDS)[0][:, :-1] == pytest.approx(
            path(cell(**row), ENDS)[0], abs=1e-8
        )


def test_two_parts_of_one_friction_are_one_of_their_mass():
    random = np.random.default_rng(8)
    for _ in range(count(20, ROWS)):
        row = random_row(random)
        n = row["mass"].size
        which = int(random.integers(n))
        share = random.uniform(0.1, 0.9) * row["mass"][which]
        two = {
            **row, "friction": np.insert(row["friction"], which, row["friction"][which]),
            "mass": np.insert(row["mass"], which, share), "gap": np.insert(row["gap"], which, 0.0),
        }  # fmt: skip
        two["mass"][which + 1] -= share
        halves = path(cell(**two), ENDS)[0]
        whole = np.insert(path(cell(**row), ENDS)[0], which, halves[:, which], axis=1)
        assert halves == pytest.approx(whole, abs=1e-8)


def test_frictions_that_differ_by_rounding_move_as_one():
    """As 0.3 and 0.1 + 0.2: parts whose rounding tells them apart left and met without end."""
    random = np.random.default_rng(11)
    for _ in range(count(60, ROWS)):
        row = random_row(random)
        friction, parts = random.uniform(0.1, 0.7), len(row["mass"])
        row |= {
            "friction": friction * (1.0 + random.choice([0.0, 2.3e-16, 1e-15], parts)),
            "gap": [0.0] * (parts - 1), "most": 40,
        }  # fmt: skip
        found, name = followed(cell(**row))
        one = {**row, "friction": [friction], "mass": [1.0], "gap": []}
        alone, same = followed(cell(**one))
        assert (name, found["platoons"]) == (same, 1)
        assert found["velocity"] == pytest.approx(alone["velocity"], abs=1e-9)


def test_blocks_of_one_mean_of_friction_are_one():
    """0.2 and 0.4 push as 0.3 does, but for a last bit: some such rows had no answer."""
    row = {"friction": [0.2, 0.3, 0.2, 0.4, 0.2, 0.4], "gap": [0.3, 0.0, 0.0, 0.3, 0.3]}
    _, name = followed(cell(1.5538372584255442, 1.243287804382345, **row, most=60))
    assert name in ("periodic", "aperiodic")
    _, name = followed(cell(1.3, 0.735, [0.4, 0.2, 0.4, 0.5, 0.3], gap=[0.0, 0.0, 0.3, 0.3], e=0.4))
    assert name in ("periodic", "aperiodic")


def test_parts_never_overlap():
    random = np.random.default_rng(9)
    phases = np.linspace(0.0, 20 * TURN, 400)
    for _ in range(count(10, ROWS)):
        row = random_row(random)
        places, gaps = path(cell(**row), phases)
        assert gaps.min() >= -1e-12
        assert np.abs(gaps - row["gap"] - np.diff(places, axis=1)).max() < 1e-11


def test_parts_in_the_air_keep_their_momentum():
    random = np.random.default_rng(10)
    for _ in range(count(20, ROWS)):
        row = random_row(random, pz=(1.1, 3.2))  # every hop ends before the next
        lifts = np.arcsin(row["gn"] / row["pz"])
        span = flight_time(row["pz"], row["gn"], lifts, 10)
        phases = 7 * TURN + lifts + span * np.linspace(0.01, 0.99, 5)
        centre = path(cell(**row), phases)[0] @ row["mass"] / row["mass"].sum()
        # Without the push of the drive and the slope it moves on at its velocity.
        free = centre + row["px"] * np.sin(phases) + row["gs"] * (phases - phases[0]) ** 2 / 2
        assert np.diff(free, 2) == pytest.approx(np.zeros(3), abs=1e-10)


def test_a_pair_is_as_fast_as_its_parts_or_between_them():
    """It was always so, and is not proven."""
    random, pairs = np.random.default_rng(11), 0
    for _ in range(count(25, ROWS)):
        row = random_row(random, parts=2, px=(0.5, 4.0), pz=(0.2, 2.5))
        row["gap"] = None
        found, name = followed(cell(**row))
        assert name in ("periodic", "aperiodic", "at_rest")
        alone = []
        for part in range(2):
            own = {"friction": row["friction"][[part]], "mass": [1.0], "gap": None}
            one, _ = followed(cell(**{**row, **own}))
            alone.append(one["velocity"])
        if found["platoons"] == 1 and alone[0] > alone[1]:
            pairs += 1
            slack = 1e-9 + 2.0 * found["error"]
            assert min(alone) - slack <= found["velocity"] <= max(alone) + slack
    assert pairs > 0


def test_platoons_of_a_wave_that_slips_one_way_are_as_many_as_records():
    # Random frictions: 1 + 1/2 + ... + 1/n platoons in the mean, whatever their distribution.
    random, rows = np.random.default_rng(7), count(200, 3000)
    found = [
        followed(cell(0, 0, random.uniform(0.25, 0.9, 3), steps=two_level(0.2, 2.0)))[0]["platoons"]
        for _ in range(rows)
    ]
    # The number of blocks of three has the variance 1/4 + 2/9.
    assert np.mean(found) == pytest.approx(1 + 1 / 2 + 1 / 3, abs=4 * np.sqrt(0.4722 / rows))
