"""Laws of rows of parts, on random ones under a sine and under waves: a thousand by night."""

import numpy as np
import pytest

from night import count
from rows import TURN, cell, followed, path
from vibrafeed.core.motion.kernels.rows.row_sine import flight_time
from vibrafeed.core.motion.kernels.rows.row_state import NO_STOP, ON_TRACK
from vibrafeed.core.motion.waves import Wave

ROWS = 1000
"""Rows of a law by night."""
ENDS = TURN * np.arange(1, 7)
"""Ends of periods at which paths of one row are compared: rounding grows in chaotic rows."""
DRIVES = pytest.mark.parametrize("waved", [False, True], ids=["sine", "wave"])


def random_row(random, waved, normal=(0.1, 2.5)):
    """Return the numbers of a row, as `cell` takes them: half of them on a slope, some apart."""
    n, along, normal = int(random.integers(2, 6)), random.uniform(0.5, 3.0), random.uniform(*normal)
    slope = random.choice([0.0, random.uniform(-0.03, 0.03)])
    kinetic = random.uniform(0.1, 0.7, n)
    row = {
        "px": along, "pz": normal, "wave": None, "kinetic": kinetic,
        "friction": kinetic * random.choice([1.0, 1.3]), "mass": random.uniform(0.3, 3.0, n),
        "gap": random.choice([0.0, 0.3], n - 1), "gs": np.sin(slope), "gn": np.cos(slope),
    }  # fmt: skip
    if waved:
        harmonics = random.normal(size=(3, 2, 3)) / np.arange(1, 4)
        sizes = np.array([along, 0.0, normal]) / 2
        row["wave"] = Wave(harmonics * sizes[:, np.newaxis, np.newaxis], np.empty((4, 0)))
    return row


def mirrored(wave):
    """Return the wave that pushes back where another pushes forward."""
    return wave and Wave(wave.harmonics * np.array([-1, 1, 1]).reshape(3, 1, 1), wave.steps)


@DRIVES
def test_the_mirror_image_masses_and_a_part_far_in_front_change_nothing(waved):
    random = np.random.default_rng(6)
    for _ in range(count(10, ROWS)):
        row = random_row(random, waved)
        places = path(cell(**row), ENDS)[0]
        image = {
            **row, "px": -row["px"], "wave": mirrored(row["wave"]), "gs": -row["gs"],
            **{name: row[name][::-1] for name in ("friction", "kinetic", "mass", "gap")},
        }  # fmt: skip
        assert -path(cell(**image), ENDS)[0][:, ::-1] == pytest.approx(places, abs=1e-8)
        heavier = {**row, "mass": 3.0 * row["mass"]}
        assert path(cell(**heavier), ENDS)[0] == pytest.approx(places, abs=1e-8)
        more = {
            **row, "friction": [*row["friction"], 0.3], "kinetic": [*row["kinetic"], 0.3],
            "mass": [*row["mass"], 1.0], "gap": [*row["gap"], 1e6],
        }  # fmt: skip
        assert path(cell(**more), ENDS)[0][:, :-1] == pytest.approx(places, abs=1e-8)


@DRIVES
def test_two_parts_of_one_friction_are_one_of_their_mass(waved):
    random = np.random.default_rng(8)
    for _ in range(count(10, ROWS)):
        row = random_row(random, waved)
        which = int(random.integers(row["mass"].size))
        share = random.uniform(0.1, 0.9) * row["mass"][which]
        two = {
            name: np.insert(row[name], which, row[name][which]) for name in ("friction", "kinetic")
        }
        two |= {"mass": np.insert(row["mass"], which, share)}
        two |= {"gap": np.insert(row["gap"], which, 0.0)}
        two["mass"][which + 1] -= share
        halves = path(cell(**{**row, **two}), ENDS)[0]
        whole = np.insert(path(cell(**row), ENDS)[0], which, halves[:, which], axis=1)
        assert halves == pytest.approx(whole, abs=1e-8)


@DRIVES
def test_frictions_that_differ_by_rounding_move_as_one(waved):
    """As 0.3 and 0.1 + 0.2: parts whose rounding tells them apart left and met without end."""
    random = np.random.default_rng(11)
    for _ in range(count(30, ROWS)):
        row = random_row(random, waved)
        static, kinetic, parts = row["friction"][0], row["kinetic"][0], len(row["mass"])
        bits = 1.0 + random.choice([0.0, 2.3e-16, 1e-15], parts)
        row |= {"friction": static * bits, "kinetic": kinetic * bits, "most": 40}
        row["gap"] = [0.0] * (parts - 1)
        found, name = followed(cell(**row))
        one = {**row, "friction": [static], "kinetic": [kinetic], "mass": [1.0], "gap": []}
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


@DRIVES
@pytest.mark.parametrize("stop", [NO_STOP, ON_TRACK])
def test_parts_never_overlap_and_gaps_are_those_of_their_places(waved, stop):
    random, phases = np.random.default_rng(9), np.linspace(0.0, 15 * TURN, 300)
    for _ in range(count(8, ROWS)):
        row = random_row(random, waved)
        more = {"e": random.choice([0.0, 0.5]), "stop": stop, "stop_gap": random.choice([0.0, 0.4])}
        places, gaps = path(cell(**row, **more), phases)
        assert np.nanmin(gaps) >= -1e-11
        between = gaps[:, : len(row["gap"])] - row["gap"]
        np.testing.assert_allclose(between, np.diff(places, axis=1), rtol=0, atol=1e-11)


def test_parts_in_the_air_keep_their_momentum():
    random = np.random.default_rng(10)
    for _ in range(count(20, ROWS)):
        row = random_row(random, waved=False, normal=(1.1, 3.2))  # every hop ends before the next
        lifts = np.arcsin(row["gn"] / row["pz"])
        span = flight_time(row["pz"], row["gn"], lifts, 10)
        phases = 7 * TURN + lifts + span * np.linspace(0.01, 0.99, 5)
        centre = path(cell(**row), phases)[0] @ row["mass"] / row["mass"].sum()
        # Without the push of the drive and the slope it moves on at its velocity.
        free = centre + row["px"] * np.sin(phases) + row["gs"] * (phases - phases[0]) ** 2 / 2
        assert np.diff(free, 2) == pytest.approx(np.zeros(3), abs=1e-10)
