"""Drives beyond the plain sine, by the reference method and from event to event.

Known values are those of two-level waves, of waves along and normal in phase, and of the limit of
weak friction; laws are symmetries, balances, and that the methods agree.
"""

import math
from typing import Any

import numpy as np
import pytest

import vibrafeed
from benchmarks.motions import path_by_reference
from night import count, spread
from vibrafeed.core.motion.events import motion_by_events
from vibrafeed.core.motion.method import BLOCK_ON_FLOOR, STATUS, Contacts, Groups, Motion
from vibrafeed.core.motion.reference import reference_motion
from vibrafeed.core.motion.reference.laws import pieces
from vibrafeed.core.motion.waves import ALONG, ENDS, TURN, Wave, bound, push, speed

GRAVITY = 9.81
WALL = Contacts(wall=True)
CYLINDER = Contacts(rolling=2.0)
EXACTLY = {"tolerance": 1e-12, "max_periods": 1000.0}


def driven(wave: Wave, kinetic: float = 0.3, **changes: Any) -> Groups:
    """Return the groups of a part on a level floor under a wave."""
    along, across, normal = (float(bound(wave, axis)) for axis in range(ENDS))
    numbers = {
        "drive_number_along": along, "drive_number_across": across, "drive_number_normal": normal,
        "gravity_number_along": 0.0, "gravity_number_normal": 1.0,
        "friction_static": kinetic, "friction_kinetic": kinetic, **changes,
    }  # fmt: skip
    return Groups(**numbers, wave=wave)


def levels(ends: list[float], along: Any = 0.0, normal: Any = 0.0, across: Any = 0.0) -> Wave:
    """Return the wave of these levels of the push; ends as shares of the period."""
    steps = np.zeros((4, len(ends)))
    steps[0], steps[1], steps[2], steps[3] = along, across, normal, TURN * np.array(ends)
    return Wave(np.zeros((3, 2, 0)), steps)


def random_wave(random: np.random.Generator, across: float) -> Wave:
    """Return up to four harmonics, or three to six levels, that may make a part hop."""
    sizes = np.array([0.6, across, random.choice([0.2, 0.7])])
    count = int(random.integers(3, 7))
    if random.random() < 0.5:
        found = random.normal(size=(3, 2, count - 2)) * 0.8 * sizes[:, None, None]
        return Wave(found, np.zeros((4, 0)))
    ends = np.sort(random.random(count))
    ends[-1] = 1.0
    push = random.normal(size=(3, count)) * sizes[:, None]
    push -= (push * np.diff(ends, prepend=0.0)).sum(axis=1, keepdims=True)
    return levels(ends.tolist(), push[0], push[2], push[1])


# --- known values


def quaid(slow: float, fast: float, static: float, kinetic: float) -> tuple[dict[str, Any], float]:
    """Return the parameters of a two-level wave, and its velocity in g T (D. Quaid 1999).

    The part sticks while the track speeds up slowly, and slips while it falls back fast.
    """
    first = fast / (2 * (slow + fast))
    parameters = {
        "acceleration_along_1": slow * GRAVITY, "acceleration_along_2": -fast * GRAVITY,
        "acceleration_along_3": slow * GRAVITY,
        "duration_1": first, "duration_2": 1 - 2 * first, "duration_3": first,
        "friction_static": static, "friction_kinetic": kinetic,
    }  # fmt: skip
    return parameters, slow**2 * (fast - kinetic) / (2 * (slow + fast) * (slow + kinetic))


def winkler(along: float, normal: float, friction: float) -> tuple[dict[str, Any], float]:
    """Return the parameters of a wave along and normal in phase, and its velocity in g T.

    Half a period each; the part slides both ways and never sticks (after Winkler 1978).
    """
    parameters = {
        "acceleration_along_1": along * GRAVITY, "acceleration_along_2": -along * GRAVITY,
        "acceleration_normal_1": normal * GRAVITY, "acceleration_normal_2": -normal * GRAVITY,
        "friction": friction,
    }  # fmt: skip
    slow, fast = friction * (1 - normal), friction * (1 + normal)
    return parameters, (along - slow) * (2 * along + fast - slow) / (8 * (along + fast))


LEVELS = [
    pytest.param(*quaid(0.4, 2.0, 0.5, 0.3), 50.0, 15.882857e-3, id="two levels"),
    pytest.param(*quaid(0.2, 1.0, 0.25, 0.2), 100.0, 3.27e-3, id="two slow levels"),
    pytest.param(*winkler(0.4, 0.3, 0.4), 50.0, 3.32687e-3, id="in phase"),
    pytest.param(*winkler(0.3, 0.9, 0.25), 50.0, 9.1376e-3, id="in phase, nearly lifted"),
]


def follow(method: str, parameters: dict[str, Any], frequency: float = 50.0) -> Any:
    return vibrafeed.simulate(
        scene="rectangle-on-plane", method=method, gravity=GRAVITY, frequency=frequency,
        outputs=["conveying_velocity", "conveying_velocity_error"], **parameters,
    )  # fmt: skip


@pytest.mark.parametrize("method", ["events", "reference"])
@pytest.mark.parametrize(("parameters", "velocity", "frequency", "published"), LEVELS)
def test_waves_in_steps_in_closed_form(
    parameters: dict[str, Any], velocity: float, frequency: float, published: float, method: str
) -> None:
    velocity *= GRAVITY / frequency
    assert velocity == pytest.approx(published, rel=1e-5)
    # Constant accelerations between events: nothing but rounding is left.
    exact = follow(method, parameters, frequency)
    assert float(exact.conveying_velocity) == pytest.approx(velocity, rel=1e-12)
    assert float(exact.conveying_velocity_error) < 1e-12 * velocity
    assert int(exact.motion_status) == STATUS["periodic"]


# --- jumps


def test_a_jump_of_the_push_lifts_and_tears_loose() -> None:
    # At rest up to a quarter of a period; then off the floor at 0.5 g, along at 0.8 g.
    wave = levels([0.25, 0.5, 1.0], along=[0.0, 0.8, -0.4], normal=[0.0, 1.5, -0.75])
    lift, turn = TURN / 4, TURN / 2
    groups = driven(wave, kinetic=0.3, friction_static=0.6)
    phases = np.array([0.0, lift - 1e-9, lift + 0.5, turn, turn + 0.4])
    path = path_by_reference(groups, phases=phases)
    high, fast = 0.25 * (turn - lift) ** 2, 0.5 * (turn - lift)
    expected = [0.0, 0.0, 0.0625, high, high + 0.4 * fast - 0.5 * 1.75 * 0.16]
    np.testing.assert_allclose(path.position[:, 2], expected, atol=1e-13)
    np.testing.assert_allclose(path.velocity[2:4, 0], [0.4, 0.8 * (turn - lift)], atol=1e-13)
    np.testing.assert_array_equal(path.velocity[:2], 0.0)
    # The same begun later, turns away: the jumps are where they were.
    far = path_by_reference(groups, phases=phases + 50 * TURN)
    np.testing.assert_allclose(far.position, path.position, atol=1e-11)


def test_steps_of_no_length_are_none() -> None:
    wave = levels([0.25, 0.5, 1.0], along=[0.8, -0.4, -0.2], normal=[0.5, -0.5, 0.0])
    padded = levels(
        [0.25, 0.25, 0.5, 0.5, 1.0], along=[0.8, 9.0, -0.4, 3.0, -0.2],
        normal=[0.5, 1.0, -0.5, 2.0, 0.0],
    )  # fmt: skip
    one, other = (reference_motion(driven(each)).velocity for each in (wave, padded))
    assert float(one) == pytest.approx(float(other), abs=1e-14)


def test_jumps_leave_a_solution_at_the_wall() -> None:
    wave = levels(
        [0.1, 0.35, 0.8, 1.0], along=[-2.3, 1.2, 0.4, -1.25], normal=[1.1, -0.2, -0.4, 0.6],
        across=[-0.2, -0.3, 0.2, -0.025],
    )  # fmt: skip
    groups = driven(wave, gravity_number_across=0.2, wall_friction=0.3, curvature_number=0.01)
    ratio, exact, found = disagree(groups, WALL)
    assert exact.status == found.status == STATUS["periodic"]
    assert ratio < 1.0


def test_a_jump_may_come_amid_the_last_hops() -> None:
    # Hops shrink towards a phase just before, at and after the jump that lifts the part again.
    landing, restitution = math.sqrt(2 * 0.01), 0.4
    done = landing * (1 + restitution) / (1 - restitution)
    for jump in (done * (1 - 1e-5), done, done * (1 + 1e-5)):
        share = jump / TURN
        wave = levels([share, 2 * share, 1.0], normal=[0.0, 2.0, -2.0 * share / (1 - 2 * share)])
        path = path_by_reference(
            driven(wave, restitution=restitution), phases=[0.0, 1.8 * jump],
            position=(0.0, 0.0, 0.01),
        )  # fmt: skip
        # Whatever is left of the hops at the jump goes on: some 1e-6 of them.
        assert path.position[1, 2] == pytest.approx(0.5 * (0.8 * jump) ** 2, rel=1e-4)


@pytest.mark.parametrize("begin", [0.0, 0.3, 7.7, 20 * math.pi])
def test_pieces_tell_the_push_and_the_speed_up_to_both_ends(begin: float) -> None:
    random = np.random.default_rng(5)
    wave = Wave(random.normal(size=(3, 2, 2)), random_wave(random, 0.4).steps)
    if not wave.steps.size:
        wave = wave._replace(steps=levels([0.3, 1.0], along=[0.7, -0.3]).steps)
    phase = begin
    for piece, end in pieces(driven(wave), begin, begin + 9.0):
        inside = phase + (end - phase) * np.array([0.001, 0.4, 0.999])
        for axis, value in enumerate(piece.push(inside)):
            np.testing.assert_allclose(value, push(wave, axis, inside), atol=1e-12)
        np.testing.assert_allclose(piece.speed(inside), speed(wave, ALONG, inside), atol=1e-12)
        assert end > phase
        phase = end
    assert phase == begin + 9.0


# --- methods agree


def disagree(groups: Groups, contacts: Contacts) -> tuple[float, Motion, Motion]:
    """Return how far events are from the reference, over what both state."""
    exact = reference_motion(groups, contacts)
    found = motion_by_events(groups, contacts, **EXACTLY)
    stated = sum(float(one.error + one.spread) for one in (exact, found)) + 1e-12
    return abs(float(exact.velocity - found.velocity)) / stated, exact, found


@pytest.mark.parametrize(
    ("contacts", "across", "seeds"),
    spread(
        [
            (BLOCK_ON_FLOOR, 0.0, count(3, 100)),
            (BLOCK_ON_FLOOR, 0.3, count(2, 60)),
            (CYLINDER, 0.3, count(2, 60)),
            (WALL, 0.3, count(2, 60)),
        ],
        2,
    ),
)
def test_events_are_within_both_errors_of_the_reference(
    contacts: Contacts, across: float, seeds: int
) -> None:
    more = {"gravity_number_across": 0.2, "wall_friction": 0.3, "curvature_number": 0.01}
    off = []
    for seed in range(seeds):
        random = np.random.default_rng(100 + seed)
        groups = driven(
            random_wave(random, across), random.uniform(0.15, 0.6), restitution=0.3 * (seed % 2),
            **(more if contacts.wall else {}),
        )  # fmt: skip
        ratio, exact, found = disagree(groups, contacts)
        assert int(found.status) != STATUS["no_solution"]
        if exact.status == STATUS["periodic"]:
            assert float(exact.error) < 1e-9
        off.append(ratio)
    assert max(off) <= 1.0


def test_cells_of_a_grid_are_those_of_single_waves() -> None:
    pushes = np.random.default_rng(7).normal(size=(5, 3))
    pushes -= (pushes @ [0.2, 0.4, 0.4])[:, np.newaxis]
    waves = [levels([0.2, 0.6, 1.0], along=push) for push in pushes]
    grid = Wave(np.zeros((3, 2, 0, 5)), np.stack([wave.steps for wave in waves], axis=-1))
    groups = driven(waves[0])._replace(drive_number_along=bound(grid, ALONG), wave=grid)
    many = motion_by_events(groups, BLOCK_ON_FLOOR, **EXACTLY).velocity.tolist()
    alone = [motion_by_events(driven(wave), BLOCK_ON_FLOOR, **EXACTLY) for wave in waves]
    assert [float(one.velocity) for one in alone] == many


@pytest.mark.parametrize("method", ["events", "reference"])
def test_a_wave_that_does_not_close_is_no_drive(method: str) -> None:
    open_wave = {"acceleration_along_1": 4, "acceleration_along_2": [-4, 3], "friction": 0.3}
    dataset = follow(method, open_wave)
    assert dataset.motion_status.values[1] == STATUS["no_drive"]
    assert np.isnan(dataset.conveying_velocity.values).tolist() == [False, True]


def test_a_course_shows_the_track() -> None:
    parameters, _ = quaid(0.4, 2.0, 0.5, 0.3)
    dataset = vibrafeed.simulate(
        scene="rectangle-on-plane", gravity=GRAVITY, frequency=50, trajectory=600, **parameters,
        outputs=["conveying_velocity"],
    )  # fmt: skip
    times = dataset.cycle_time.values
    acceleration = np.gradient(np.gradient(dataset.track_along.values, times), times)
    middle = np.abs(times - 0.01) < 0.001
    np.testing.assert_allclose(acceleration[middle], -2.0 * GRAVITY, rtol=1e-6)
    assert not dataset.track_normal.values.any()
    travel = dataset.position_along.values[-1] / times[-1]
    assert travel == pytest.approx(float(dataset.conveying_velocity), rel=1e-4)
