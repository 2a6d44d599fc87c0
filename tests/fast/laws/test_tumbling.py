"""Laws and known values of tumbling: a part that strikes a plane, rocks and comes to rest."""

import numpy as np
import pytest

from benchmarks.motions import tumbling_motion, tumbling_path
from mean_velocities import MEAN_VELOCITIES
from vibrafeed.core.mechanics import impact
from vibrafeed.core.motion import tumbling_scene
from vibrafeed.core.motion.kernels.tumbling.corners import (
    SLOW,
    STATE,
    cell_of,
    corner_at,
    speed_scale,
)
from vibrafeed.core.motion.kernels.tumbling.supports import apply_impact
from vibrafeed.core.motion.method import STATUS
from vibrafeed.core.motion.tumbling_scene import Body, cylinder, rectangle

GRAVITY = 9.81


def block(length, height):
    return rectangle(length=length, height=height)


def pin(length, diameter):
    return cylinder(length=length, diameter=diameter)


def sphere(radius):
    """A ball, whose one contact lies below its centre; m R^2/I = 5/2, and it has no corners."""
    return Body(np.asarray(radius), np.full((), 2.5), np.full((), np.pi / 2), np.zeros(()))


# The rocking block of the literature: half sizes 0.0282 m by 0.1065 m, here full ones.
BLOCK = block(0.0564, 0.213)
BLOCK_ANGLE = np.arctan2(0.0282, 0.1065)


def ball(**change):
    """A ball of 0.1 m dropped with its centre at 1 m."""
    given = {"part": sphere(0.1), "gap_normal": 0.9, "restitution": 0.5, "friction_kinetic": 0.3}
    return tumbling_motion(**{**given, "gravity": GRAVITY, "duration": 2.0, **change})


def dropped(count: int, seed: int) -> dict:
    """Random parts that fall, turn and slide; restitution below 0.7, so that they come to rest."""
    draw = np.random.default_rng(seed).uniform
    return {
        "part": block(0.02, draw(0.004, 0.03, count)),
        "friction_kinetic": draw(0.2, 1.1, count),
        "restitution": draw(0.0, 0.7, count),
        "gap_normal": draw(0.0, 0.03, count),
        "pitch": draw(-4.0, 4.0, count),
        "pitch_rate": draw(-20.0, 20.0, count),
        "velocity_along": draw(-0.5, 0.5, count),
        "gravity": GRAVITY,
    }


def one(case: dict, number: int) -> dict:
    """One of the parts."""
    part = case["part"]
    values = {key: value for key, value in case.items() if key != "part"}
    single = {key: value[number] if np.ndim(value) else value for key, value in values.items()}
    return {**single, "part": Body(*(np.broadcast_to(n, part[0].shape)[number] for n in part))}


def energy(path, part, gravity=GRAVITY):
    """Kinetic and potential energy per mass, from m rho^2/I of theory 2.1."""
    turning = (part.half_diagonal * path.pitch_rate) ** 2 / part.inertia_ratio
    moving = path.velocity_along**2 + path.velocity_upward**2 + turning
    return 0.5 * moving + gravity * path.upward


# --- impacts in a series: the bouncing ball


def test_a_ball_comes_to_rest_after_endlessly_many_bounces():
    # Fall t_1, then bounces of 2 e^k t_1: together t_1 (1 + e)/(1 - e). The series is cut where a
    # bounce leaves with 1e-6 sqrt(g R): it lacks at most 2e-6 sqrt(R/g)/(1 - e) = 4e-7 s.
    found = ball()
    assert found.settling_time == pytest.approx(3 * np.sqrt(2 * 0.9 / GRAVITY), abs=4e-7)
    assert found.settling_time == pytest.approx(1.285059, abs=1e-6)
    assert found.status == STATUS["settled"]
    assert found.energy_lost == pytest.approx(GRAVITY * 0.9, rel=1e-11)
    # e^2 of the fall; the steps miss the top by g (h/2)^2/2 at most, h = 0.02 sqrt(R/g).
    assert found.largest_bounce == pytest.approx(0.225, abs=GRAVITY * 0.002**2 / 8)


# --- rocking


def housner_ratio() -> float:
    """Pitch rate after an impact over that before it: 1 - (3/2) sin^2 of the block's angle."""
    return 1 - 1.5 * np.sin(BLOCK_ANGLE) ** 2


def rocking(**change):
    given = {"part": BLOCK, "pitch": 0.1, "friction_kinetic": 1.0, "restitution": 0.0}
    return {**given, "gravity": GRAVITY, **change}


def test_a_rocking_block_loses_what_housner_says():
    # Between impacts the energy above that of standing upright stays; at an impact it falls by the
    # square of the ratio of the pitch rates: 1 - (m R^2/I_O)(1 - cos 2 alpha), I_O = 4/3 m R^2.
    assert housner_ratio() == pytest.approx(0.901721, abs=5e-7)
    times = np.linspace(0, 2, 2001)
    path = tumbling_path(times=times, **rocking())
    left = energy(path, BLOCK) - GRAVITY * 0.1065
    swings = np.cumsum(np.r_[False, np.diff(np.sign(path.pitch)) != 0])
    per_swing = np.array([np.median(left[swings == number]) for number in range(6)])
    # Runge-Kutta of order 4 with 50 steps in sqrt(R/g): (1/50)^4 = 1.6e-7 over a swing or less.
    assert np.sqrt(per_swing[1:] / per_swing[:-1]) == pytest.approx(housner_ratio(), abs=2e-7)
    assert np.all(np.sign(path.pitch[path.touching[:, 0] & ~path.touching[:, 1]]) >= 0)


def test_a_pushed_block_topples_beyond_its_angle_only():
    # Released at rest, a block falls back if its centre is inside its corner, and over if not.
    pitch = BLOCK_ANGLE + np.array([-0.01, 0.01])
    found = tumbling_motion(duration=10.0, **rocking(pitch=pitch))
    assert found.resting_side.tolist() == [1, 2]
    assert found.pitch == pytest.approx([0, np.pi / 2], abs=1e-12)


# --- one impact


@pytest.mark.parametrize("shape", [block, pin])
def test_an_impact_of_a_corner_is_that_of_the_impact_scenes(shape):
    draw = np.random.default_rng(3).uniform
    mu, eps = draw(0, 3, 120), draw(0, 1, 120)
    cells, _ = cells_of(shape(0.03, 0.02), friction_kinetic=mu, restitution=eps)
    for number, row in enumerate(cells):
        cell = cell_of(row)
        state, after = np.zeros(len(STATE)), np.empty(len(STATE))
        state[STATE.pitch] = draw(0.05, 1.5)
        s, c = corner_at(cell, 0, state[STATE.pitch])
        rho, kappa = cell.half_diagonal, cell.inertia_ratio
        state[STATE.up] = rho * s
        state[3:6] = draw([-1, -1, -50], [1, 1, 50])
        u_n, u_t = state[4] - rho * state[5] * c, state[3] - rho * state[5] * s
        before = state.copy()
        struck = apply_impact(cell, state, after)
        assert struck == (u_n < -SLOW * speed_scale(cell))
        if not struck:
            continue
        given = {"G_NN": 1 + kappa * c * c, "G_NT": kappa * s * c, "G_TT": 1 + kappa * s * s,
                 "u_N": u_n, "u_T": u_t, "friction": mu[number],
                 "restitution": eps[number]}  # fmt: skip
        expected = impact.pfeiffer_glocker(**{k: np.asarray(v) for k, v in given.items()})
        change = state - before
        # A dozen operations on velocities of 1 m/s, and divisions by numbers above 0.1.
        assert change[3] == pytest.approx(float(expected.tangential), abs=1e-12)
        assert change[4] == pytest.approx(float(expected.normal), abs=1e-12)
        # The angular momentum about the corner stays, whatever the impulse.
        about = rho * (change[4] * c + change[3] * s) + rho**2 / kappa * change[5]
        assert about == pytest.approx(0, abs=1e-12 * rho)
        assert state[STATE.lost] >= -1e-12


def cells_of(part, **given):
    rest = {"friction_static": None, "gravity": GRAVITY, "duration": 1.0}
    return tumbling_scene._cells(tumbling_scene.Throw(part=part, **{**rest, **given}))


# --- coming to rest


def test_dropped_parts_come_to_rest_on_a_side():
    found = tumbling_motion(duration=4.0, **dropped(100, 7))
    assert np.all(found.status == STATUS["settled"])
    quarter = np.rint(found.pitch / (np.pi / 2))
    assert np.array_equal(found.resting_side, quarter % 4 + 1)
    assert found.pitch == pytest.approx(quarter * np.pi / 2, abs=1e-12)


@pytest.mark.parametrize("number", range(4))
def test_energy_never_grows_and_no_corner_sinks(number):
    given = one(dropped(4, 11), number)
    path = tumbling_path(times=np.linspace(0, 1, 501), **given)
    total = energy(path, given["part"])
    # Order 4 in steps of 1/50 of the scale: 1e-7 of the energy over a run at the very most.
    assert np.all(np.diff(total) <= 1e-8 * total[0])
    assert total + path.energy_lost == pytest.approx(total[0], rel=1e-7)
    assert np.all(path.gap_normal >= -1e-12 * 0.02)
    assert np.all(np.diff(path.energy_lost) >= 0)
    # The path's times cut some steps: the difference is that of two runs of order 4.
    found = tumbling_motion(duration=1.0, **given)
    assert path.along[-1] == pytest.approx(float(found.velocity), abs=1e-7)


def test_a_mirrored_part_moves_as_its_mirror_image():
    # Rounding grows from impact to impact: few impacts, short runs.
    case = {**dropped(100, 13), "restitution": 0.2}
    turned = {name: -case[name] for name in ("pitch", "pitch_rate", "velocity_along")}
    found = tumbling_motion(duration=0.15, **case)
    mirrored = tumbling_motion(duration=0.15, **{**case, **turned})
    assert mirrored.pitch == pytest.approx(-found.pitch, abs=1e-6)
    assert mirrored.velocity == pytest.approx(-found.velocity, abs=1e-6)


def test_a_part_four_times_as_large_takes_twice_as_long():
    # Lengths 4, times and velocities 2, same gravity: powers of 2 change no rounding.
    case = dropped(100, 19)
    part = case["part"]
    large = {
        **case,
        "part": part._replace(half_diagonal=4 * part.half_diagonal),
        "gap_normal": 4 * case["gap_normal"],
        "velocity_along": 2 * case["velocity_along"],
        "pitch_rate": case["pitch_rate"] / 2,
    }
    drive = {"amplitude": 2e-4, "frequency": 50.0, "beta": 0.5}
    slow = {"amplitude": 8e-4, "frequency": 25.0, "beta": 0.5}
    found = tumbling_motion(duration=0.5, **case, **drive)
    scaled = tumbling_motion(duration=1.0, **large, **slow)
    assert np.array_equal(scaled.pitch, found.pitch)
    assert np.array_equal(scaled.velocity, 2 * found.velocity)
    assert np.array_equal(scaled.impacts, found.impacts)
    assert np.array_equal(scaled.settling_time, 2 * found.settling_time, equal_nan=True)


# --- the vibrating plane


@pytest.mark.parametrize("beta", [np.pi / 2, 0.3])
def test_below_throw_number_one_a_part_at_rest_stays(beta):
    # Throw number 0.9 or less, and friction that holds at every phase.
    found = tumbling_motion(
        part=block(0.02, 0.01), friction_kinetic=5.0, restitution=0.5, duration=1.0, beta=beta,
        frequency=50.0, amplitude=np.array([0.1, 0.9]) * GRAVITY / (100 * np.pi) ** 2,
        gravity=GRAVITY,
    )  # fmt: skip
    assert np.all(found.status == STATUS["settled"])
    assert not np.any([found.settling_time, found.velocity])


def test_above_throw_number_one_it_leaves():
    found = tumbling_motion(
        part=block(0.02, 0.01), friction_kinetic=0.5, restitution=0.0, duration=0.5,
        frequency=50.0, amplitude=1.2 * GRAVITY / (2 * np.pi * 50) ** 2, beta=np.pi / 2,
        gravity=GRAVITY,
    )  # fmt: skip
    # One hop per period for throw numbers to 3.297 (theory 13.7), straight up and flat; the first
    # begins in the first period, the last of 25 ends in the last.
    assert found.impacts == 25
    assert found.status == STATUS["moving"]
    assert found.velocity == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "periods"), [("sliding", 400), ("stick-slip", 40), ("hop on a climb", 40)]
)
def test_a_flat_part_is_conveyed_like_a_point(name, periods):
    # The part is so long that it never tips; a hop lands on both ends at once.
    case = MEAN_VELOCITIES[name]
    path = tumbling_path(
        part=block(0.2, 0.001), times=np.array([periods, periods + 1]) / case.frequency,
        friction_kinetic=case.friction_kinetic, friction_static=case.friction_static,
        restitution=0.0, frequency=case.frequency, amplitude=case.amplitude,
        beta=np.radians(case.beta), gamma=np.radians(case.gamma), gravity=9.8,
    )  # fmt: skip
    # Order 4 with 64 steps a period, and an end of the transient that decays by the period.
    speed = np.diff(path.along)[0] * case.frequency
    assert speed == pytest.approx(case.value, rel=1e-5)


# --- no solution


def test_where_a_sliding_corner_has_no_solution_the_run_says_so():
    # Rectangle at s = 60 degrees: limiting friction 1.347 (theory 2.5), whatever its shape.
    pitch = np.pi / 3 - np.arctan2(0.005, 0.02)
    slides = {"part": block(0.02, 0.005), "pitch": pitch, "restitution": 0.0, "gravity": GRAVITY}
    slides |= {"duration": 1e-3, "friction_kinetic": np.array([1.3471, 1.3472, 2.0])}
    right = tumbling_motion(velocity_along=1.0, **slides)
    paradox = right.status == STATUS["no_solution"]
    assert paradox.tolist() == [False, True, True]
    assert np.all(np.isnan(right.settling_time[paradox]))
    # To the left the same corner is dragged: one solution at any friction.
    left = tumbling_motion(velocity_along=-1.0, **slides)
    assert np.all(left.status == STATUS["moving"])


# --- the interface


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"restitution": 1.1}, "restitution"),
        ({"gap_normal": -0.1}, "gap_normal"),
        ({"friction_static": 0.1}, "friction_static"),
        ({"duration": 0.0}, "duration"),
        ({"gravity": 0.0}, "gravity"),
        ({"velocity_along": np.nan}, "finite"),
    ],
)
def test_wrong_values_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        ball(**change)


@pytest.mark.parametrize(
    "change",
    [
        {"gravity": 5e-324},  # the time of a fall overflows
        {"amplitude": 1e306, "frequency": 50.0},
        {"amplitude": 1e-3, "frequency": 1e200},
        {"part": sphere(5e-324), "gamma": 1.0},
    ],
)
def test_what_overflows_is_said_by_a_status(change):
    given = {"part": sphere(1.0), "friction_kinetic": 0.3, "restitution": 0.5, **change}
    with np.errstate(all="ignore"):
        found = tumbling_motion(duration=0.1, **given)
    assert found.status == STATUS["limit_reached"]
    assert np.isnan(found.pitch)
