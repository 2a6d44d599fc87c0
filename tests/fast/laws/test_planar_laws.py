"""Laws of planar motion that hold for every part, over random studies."""

import math
import os

import numpy as np
import pytest

from benchmarks.motions import planar_motion
from vibrafeed.core.motion.method import Motion
from vibrafeed.core.quantities import MOTION_STATUSES

STATUS = {name: flag.value for name, flag in MOTION_STATUSES.items()}
FINITE = [STATUS[name] for name in ("periodic", "at_rest", "aperiodic", "neutral")]


def cells(count: int, seed: int, **fixed) -> dict[str, np.ndarray]:
    """Return groups of random parts over the whole range that users type."""
    random = np.random.default_rng(seed)
    values = {
        "throw": random.uniform(0.1, 6, count),
        "friction": random.uniform(0, 2, count),
        "beta": np.radians(random.uniform(1, 89, count)),
        "gamma": np.radians(random.uniform(-10, 10, count)),
        "restitution": random.uniform(0, 0.95, count),
    } | fixed
    p = values["throw"] * np.cos(values["gamma"]) / np.sin(values["beta"])
    return {
        "drive_number_along": p * np.cos(values["beta"]),
        "drive_number_normal": p * np.sin(values["beta"]),
        "gravity_number_along": np.sin(values["gamma"]),
        "gravity_number_normal": np.cos(values["gamma"]),
        "friction_static": values["friction"] * values.get("static_share", 1.0),
        "friction_kinetic": values["friction"],
        "restitution": values["restitution"],
        "tolerance": np.full(count, 1e-12),
        "max_periods": np.full(count, 200.0),
    }


@pytest.fixture(scope="module")
def sample() -> tuple[dict[str, np.ndarray], Motion]:
    groups = cells(1500, 11)
    return groups, planar_motion(**groups)


def test_every_cell_has_a_status_and_fractions_fill_the_period(sample):
    _, motion = sample
    assert not (motion.status == STATUS["not_computed"]).any()
    finite = np.isin(motion.status, FINITE)
    assert np.isfinite(motion.velocity[finite]).all()
    assert np.isnan(motion.velocity[motion.status == STATUS["runaway"]]).all()
    assert (motion.status == STATUS["limit_reached"]).mean() < 2e-3
    shares = np.array([motion.stick, motion.forward, motion.backward, motion.flight])[:, finite]
    # Up to some thousand spans are added up, each rounded to 1e-16.
    np.testing.assert_allclose(shares.sum(axis=0), 1, atol=1e-12)
    assert (shares >= 0).all()


def test_friction_carries_no_part_faster_than_the_track(sample):
    # Friction is the only forward force where the track does not fall (theory 11.1).
    groups, motion = sample
    level_or_up = np.isin(motion.status, FINITE) & (groups["gravity_number_along"] >= 0)
    excess = motion.velocity / groups["drive_number_along"] - 1
    assert (excess[level_or_up] <= 1e-12).all()


def test_runaway_is_where_friction_cannot_hold(sample):
    # Mean friction is at most mu times the mean normal force, which balances gravity.
    groups, motion = sample
    too_steep = np.abs(groups["gravity_number_along"]) > (
        groups["friction_kinetic"] * groups["gravity_number_normal"]
    )
    np.testing.assert_array_equal(motion.status == STATUS["runaway"], too_steep)


def test_restitution_plays_no_part_on_the_floor(sample):
    groups, motion = sample
    low = groups["drive_number_normal"] <= groups["gravity_number_normal"]
    there = {name: values[low] for name, values in groups.items()}
    dead = planar_motion(**there | {"restitution": np.zeros(low.sum())})
    np.testing.assert_array_equal(motion.velocity[low], dead.velocity)


def test_mirror_image(sample):
    # Seen from behind, the drive points back and the track climbs the other way.
    groups, motion = sample
    turned = groups | {
        "drive_number_along": -groups["drive_number_along"],
        "gravity_number_along": -groups["gravity_number_along"],
    }
    mirrored = planar_motion(**turned)
    np.testing.assert_array_equal(mirrored.velocity, -motion.velocity)
    np.testing.assert_array_equal(mirrored.forward, motion.backward)


@pytest.mark.parametrize("threads", [1, 7])
def test_the_same_whatever_the_threads(sample, monkeypatch, threads):
    groups, motion = sample
    monkeypatch.setattr(os, "cpu_count", lambda: threads)
    few = {name: values[:300] for name, values in groups.items()}
    for one, two in zip(motion, planar_motion(**few), strict=True):
        np.testing.assert_array_equal(one[:300], two)


@pytest.mark.parametrize(
    "extreme",
    [
        {"friction": np.zeros(40), "gamma": np.zeros(40)},
        {"friction": np.geomspace(1e-12, 1e-2, 40), "gamma": np.zeros(40)},
        {"friction": np.full(40, 1e6)},
        {"throw": np.geomspace(1e-300, 1e-3, 40)},
        {"throw": np.geomspace(10, 1e9, 40)},
        {"throw": 1 + np.linspace(-1, 1, 40) * 1e-15},
        {"throw": math.sqrt(1 + math.pi**2) * (1 + np.linspace(-1, 1, 40) * 1e-14)},
        {"restitution": 1 - np.geomspace(1e-17, 1e-2, 40), "throw": np.linspace(1.1, 5, 40)},
        {"beta": np.radians(np.linspace(85, 90, 40)), "gamma": np.full(40, math.radians(10))},
        {"beta": np.zeros(40) + 1e-9, "throw": np.full(40, 1e-9)},
        {"gamma": np.arctan(np.linspace(0, 2, 40)), "friction": np.linspace(0, 2, 40)},
        {"static_share": np.full(40, 3.0)},
    ],
)
def test_extremes_end_with_a_status(extreme):
    groups = cells(40, 15, **extreme)
    motion = planar_motion(**groups)
    assert not (motion.status == STATUS["not_computed"]).any()
    finite = np.isin(motion.status, FINITE)
    assert np.isfinite(motion.velocity[finite]).all()
    assert np.isfinite(motion.hop_height[finite]).all()
    # Without friction a part keeps the track's speed at the start.
    free = motion.status == STATUS["neutral"]
    speed = groups["drive_number_along"][free]
    np.testing.assert_allclose(motion.velocity[free], speed, rtol=1e-12)


def one(**case) -> Motion:
    groups = cells(1, 0, **{name: np.array([value]) for name, value in case.items()})
    return planar_motion(**groups)


def test_small_friction_says_how_sure_it_is():
    """As friction goes to 0 the mean goes to a limit, and rounding takes the digits away."""
    case = {"throw": 1.26, "beta": math.radians(30), "gamma": 0.0, "restitution": 0.1}
    limit = float(one(friction=1e-5, **case).velocity[0])
    for friction in 10.0 ** np.arange(-6, -17, -1):
        motion = one(friction=friction, **case)
        (status,), (velocity,), (error,) = motion.status, motion.velocity, motion.error
        assert np.isnan(velocity) == (status == STATUS["limit_reached"])
        # The limit itself is approached linearly in friction: by less than 1e-4 from 1e-5 on.
        assert not abs(velocity - limit) > 2 * error + 1e-3 * abs(limit)
    assert status == STATUS["limit_reached"]


def test_friction_that_just_balances_gravity_has_no_mean():
    motion = one(friction=1.0, gamma=math.radians(45), beta=math.radians(40), throw=3.5,
                 restitution=0.0)  # fmt: skip
    assert motion.status[0] == STATUS["limit_reached"]
    assert np.isnan(motion.velocity[0])
