"""Laws of planar motion that hold for every part, over random studies."""

from __future__ import annotations

import math
import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from benchmarks.motions import planar_motion, planar_path
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


def fractions(motion: Motion) -> np.ndarray:
    return np.array([motion.stick, motion.forward, motion.backward, motion.flight])


@pytest.fixture(scope="module")
def sample() -> tuple[dict[str, np.ndarray], Motion]:
    groups = cells(4000, 11)
    return groups, planar_motion(**groups)


def test_every_cell_has_a_status(sample):
    _, motion = sample
    assert not (motion.status == STATUS["not_computed"]).any()
    finite = np.isin(motion.status, FINITE)
    assert np.isfinite(motion.velocity[finite]).all()
    assert np.isnan(motion.velocity[motion.status == STATUS["runaway"]]).all()
    assert (motion.status == STATUS["limit_reached"]).mean() < 1e-3


def test_fractions_fill_the_period(sample):
    _, motion = sample
    finite = np.isin(motion.status, FINITE)
    total = fractions(motion)[:, finite].sum(axis=0)
    # Up to some thousand spans are added up, each rounded to 1e-16.
    np.testing.assert_allclose(total, 1, atol=1e-12)
    assert (fractions(motion)[:, finite] >= 0).all()


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
    groups, _ = sample
    low = groups["drive_number_normal"] <= groups["gravity_number_normal"]
    there = {name: values[low] for name, values in groups.items()}
    bouncing = planar_motion(**there | {"restitution": np.full(low.sum(), 0.9)})
    dead = planar_motion(**there | {"restitution": np.zeros(low.sum())})
    np.testing.assert_array_equal(bouncing.velocity, dead.velocity)


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


def test_a_drive_that_points_down_pushes_half_a_turn_later():
    # Where only one motion attracts, it does not matter when the drive started.
    groups = cells(500, 12, restitution=np.zeros(500), throw=np.linspace(0.2, 3.2, 500))
    ahead = planar_motion(**groups)
    turned = groups | {
        "drive_number_along": -groups["drive_number_along"],
        "drive_number_normal": -groups["drive_number_normal"],
    }
    behind = planar_motion(**turned)
    scale = np.abs(groups["drive_number_along"]) + 1
    assert (np.abs(ahead.velocity - behind.velocity)[ahead.status == 1] <= 1e-11).all() or (
        np.nanmax(np.abs(ahead.velocity - behind.velocity) / scale) <= 1e-11
    )


def test_momentum_balance():
    """Over a cycle the mean of friction balances gravity along the track.

    Friction is mu_k n while sliding, and what the drive asks while sticking: its mean is computed
    from the path alone, by the trapezium rule, so the bar is that of the rule.
    """
    phases = np.linspace(0, 2 * np.pi, 20_001)
    groups = cells(30, 13, restitution=np.zeros(30), throw=np.linspace(0.3, 0.99, 30))
    motion = planar_motion(**groups)
    for cell in np.flatnonzero(motion.status == 1):
        case = {name: float(values[cell]) for name, values in groups.items()}
        _, modes = planar_path(**case, phases=phases)
        n = case["gravity_number_normal"] - case["drive_number_normal"] * np.sin(phases)
        drive = case["drive_number_along"] * np.sin(phases) - case["gravity_number_along"]
        friction = np.select(
            [modes == 1, modes == 2], [-1, 1], 0.0
        ) * case["friction_kinetic"] * n - np.where(modes == 0, drive, 0.0)  # fmt: skip
        mean = np.trapezoid(friction, phases) / (2 * np.pi)
        # A jump inside one step counts half a step too much or too little; there are up to six.
        bar = 6 * np.abs(friction).max() / 20_000
        assert abs(mean - case["gravity_number_along"]) <= bar


def test_the_path_moves_with_its_velocities():
    for seed in range(12):
        groups = cells(1, 100 + seed, restitution=np.array([0.3 * (seed % 2)]))
        case = {name: float(values[0]) for name, values in groups.items()}
        phases = np.linspace(0, 2 * np.pi, 4001)
        path, modes = planar_path(**case, phases=phases)
        if np.isnan(path.position[:, 0]).any():
            continue
        step = phases[1]
        speed = np.abs(path.velocity[:, 0]).max() + 1
        change = abs(case["drive_number_along"]) * (1 + case["friction_kinetic"]) + 1
        moved = np.diff(path.position[:, 0])
        meant = step * (path.velocity[:, 0][1:] + path.velocity[:, 0][:-1]) / 2
        # Smooth pieces: h^3; a step with an impact or a stop: the jump in velocity times h.
        jumps = np.abs(np.diff(path.velocity[:, 0])) > 3 * change * step
        assert (np.abs(moved - meant)[~jumps] <= 4 * change * step**2).all()
        assert (np.abs(moved - meant) <= 2 * speed * step).all()
        assert (path.position[:, 2] >= 0).all()
        assert (path.position[:, 2][modes != 3] == 0).all()


def test_the_same_whatever_the_threads(sample, monkeypatch):
    groups, motion = sample
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    alone = planar_motion(**groups)
    monkeypatch.setattr(os, "cpu_count", lambda: 7)
    shared = planar_motion(**groups)
    for one, two, three in zip(motion, alone, shared, strict=True):
        np.testing.assert_array_equal(one, two)
        np.testing.assert_array_equal(one, three)


def test_two_callers_at_a_time(sample):
    groups, motion = sample
    with ThreadPoolExecutor(4) as pool:
        for done in [pool.submit(planar_motion, **groups) for _ in range(4)]:
            np.testing.assert_array_equal(done.result().velocity, motion.velocity)


def test_equal_cells_are_computed_once(monkeypatch):
    from vibrafeed.core.motion import events

    seen: list[int] = []
    kernel = events.solve_cells

    def counting(groups, table, status, stop):
        seen.append(len(groups))
        kernel(groups, table, status, stop)

    monkeypatch.setattr(events, "solve_cells", counting)
    groups = cells(50, 14, throw=np.linspace(0.3, 0.9, 50))
    twice = {name: np.repeat(values, 20) for name, values in groups.items()}
    twice["restitution"] = np.linspace(0, 0.9, 1000)  # no part of it: nothing lifts off
    once, many = planar_motion(**groups), planar_motion(**twice)
    assert sum(seen) == 50 + 50
    np.testing.assert_array_equal(many.velocity, np.repeat(once.velocity, 20))


@pytest.mark.parametrize(
    "extreme",
    [
        {"friction": np.zeros(40), "gamma": np.zeros(40)},
        {"friction": np.full(40, 1e-12), "gamma": np.zeros(40)},
        {"friction": np.geomspace(1e-6, 1e-2, 40), "gamma": np.zeros(40)},
        {"friction": np.full(40, 1e6)},
        {"throw": np.geomspace(1e-300, 1e-3, 40)},
        {"throw": np.geomspace(10, 1e9, 40)},
        {"throw": 1 + np.linspace(-1, 1, 40) * 1e-15},
        {"throw": 1 + np.geomspace(1e-14, 1e-2, 40)},
        {"throw": math.sqrt(1 + math.pi**2) * (1 + np.linspace(-1, 1, 40) * 1e-14)},
        {"restitution": np.ones(40), "throw": np.linspace(0.5, 5, 40)},
        {"restitution": 1 - np.geomspace(1e-12, 1e-2, 40), "throw": np.linspace(1.1, 5, 40)},
        {"beta": np.radians(np.full(40, 90.0))},
        {"beta": np.radians(np.linspace(85, 90, 40)), "gamma": np.full(40, math.radians(10))},
        {"beta": np.zeros(40) + 1e-9, "throw": np.full(40, 1e-9)},
        {"gamma": np.full(40, math.radians(89.0))},
        {"gamma": np.arctan(np.linspace(0, 2, 40)), "friction": np.linspace(0, 2, 40)},
        {"static_share": np.full(40, 3.0)},
        {"static_share": np.full(40, 1 + 1e-15)},
    ],
)
def test_extremes_end_with_a_status(extreme):
    motion = planar_motion(**cells(40, 15, **extreme))
    assert not (motion.status == STATUS["not_computed"]).any()
    finite = np.isin(motion.status, FINITE)
    assert np.isfinite(motion.velocity[finite]).all()
    assert np.isfinite(motion.hop_height[finite]).all()


def test_frictionless_parts_keep_the_speed_of_the_start():
    # The track passes its middle at full speed when the part is put down on it.
    groups = cells(20, 16, friction=np.zeros(20), gamma=np.zeros(20))
    motion = planar_motion(**groups)
    neutral = motion.status == STATUS["neutral"]
    np.testing.assert_allclose(
        motion.velocity[neutral], groups["drive_number_along"][neutral], rtol=1e-12
    )
    assert neutral.any()


def one(**case) -> Motion:
    groups = cells(1, 0, **{name: np.array([value]) for name, value in case.items()})
    return planar_motion(**groups)


def test_small_friction_says_how_sure_it_is():
    """As friction goes to 0 the mean goes to a limit, and rounding takes the digits away."""
    case = {"throw": 1.26, "beta": math.radians(30), "gamma": 0.0, "restitution": 0.1}
    limit = float(one(friction=1e-5, **case).velocity[0])
    for friction in 10.0 ** np.arange(-6, -17, -1):
        motion = one(friction=friction, **case)
        if motion.status[0] == STATUS["periodic"]:
            # The limit itself is approached linearly in friction: by less than 1e-4 from 1e-5 on.
            assert abs(motion.velocity[0] - limit) <= 2 * motion.error[0] + 1e-3 * abs(limit)
        else:
            assert motion.status[0] == STATUS["limit_reached"]
            assert np.isnan(motion.velocity[0])
    assert motion.status[0] == STATUS["limit_reached"]


def test_static_friction_alone_holds_a_part_for_a_while():
    # With no kinetic friction every turn has slope 1: that is no sign of running away.
    groups = cells(1, 0, throw=np.array([0.7]), beta=np.radians([9.0]), gamma=np.radians([0.2]),
                   friction=np.array([0.0]), restitution=np.array([0.0]))  # fmt: skip
    groups["friction_static"] = np.array([0.44])
    nearly = groups | {"friction_kinetic": np.array([1e-9])}
    without, little = planar_motion(**groups), planar_motion(**nearly)
    assert without.status[0] == little.status[0]
    if without.status[0] == STATUS["periodic"]:
        assert without.velocity[0] == pytest.approx(little.velocity[0], rel=1e-6)


def test_friction_that_just_balances_gravity_has_no_mean():
    motion = one(friction=1.0, gamma=math.radians(45), beta=math.radians(40), throw=3.5,
                 restitution=0.0)  # fmt: skip
    assert motion.status[0] == STATUS["limit_reached"]
    assert np.isnan(motion.velocity[0])


def test_the_path_of_an_aperiodic_motion_ends_where_it_is_known():
    groups = cells(1, 0, throw=np.array([5.03]), beta=np.radians([30.0]), gamma=np.zeros(1),
                   friction=np.array([0.5]), restitution=np.array([0.7]))  # fmt: skip
    case = {name: float(values[0]) for name, values in groups.items()}
    step = 5e-3
    phases = np.arange(0, 60 * np.pi, step)
    path, modes = planar_path(**case, phases=phases)
    known = ~np.isnan(path.position[:, 0])
    assert known[: int(2 * np.pi / step)].all()
    assert not known[-1]
    assert (modes[~known] == 4).all()
    flying = (modes[1:] == 3) & (modes[:-1] == 3)
    gained = np.diff(path.velocity[:, 2]) / step
    asked = case["drive_number_normal"] * np.sin(phases[:-1] + step / 2) - 1
    free = flying & (np.abs(gained - asked) < 0.5)  # impacts apart
    # The middle of a step stands for its mean: off by s step^2/24.
    assert np.abs(gained - asked)[free].max() <= case["drive_number_normal"] * step**2
    assert free.sum() > 0.9 * flying.sum()
