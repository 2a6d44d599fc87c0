"""Drives beyond the plain sine, by the reference method and from event to event.

Known values are those of two-level waves, of waves along and normal in phase, and of the limit of
weak friction; laws are symmetries, balances, and that the methods agree.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from benchmarks.motions import path_by_reference
from night import count, spread
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.events import motion_by_events
from vibrafeed.core.motion.method import BLOCK_ON_FLOOR, STATUS, Contacts, Groups, Motion
from vibrafeed.core.motion.reference import reference_motion
from vibrafeed.core.motion.reference.laws import pieces
from vibrafeed.core.motion.waves import ALONG, ENDS, NORMAL, TURN, Wave, bound, push, speed

GRAVITY = 9.81
G = f"{GRAVITY} m/s^2"
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


def harmonics(*terms: tuple[int, int, float, float]) -> Wave:
    """Return the wave whose push has size sin(k tau + phase), terms (axis, k, size, phase)."""
    found = np.zeros((3, 2, max(k for _, k, _, _ in terms)))
    for axis, k, size, phase in terms:
        found[axis, :, k - 1] += size * math.cos(phase), size * math.sin(phase)
    return Wave(found, np.zeros((4, 0)))


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
        **{f"acceleration_along_{n}": f"{a * GRAVITY} m/s^2"
           for n, a in enumerate((slow, -fast, slow), start=1)},
        "duration_1": first, "duration_2": 1 - 2 * first, "duration_3": first,
        "friction_static": static, "friction_kinetic": kinetic,
    }  # fmt: skip
    return parameters, slow**2 * (fast - kinetic) / (2 * (slow + fast) * (slow + kinetic))


def winkler(along: float, normal: float, friction: float) -> tuple[dict[str, Any], float]:
    """Return the parameters of a wave along and normal in phase, and its velocity in g T.

    Half a period each; the part slides both ways and never sticks (after Winkler 1978).
    """
    parameters = {
        f"acceleration_{axis}_{n}": f"{sign * size * GRAVITY} m/s^2"
        for axis, size in (("along", along), ("normal", normal))
        for n, sign in ((1, 1), (2, -1))
    }
    slow, fast = friction * (1 - normal), friction * (1 + normal)
    velocity = (along - slow) * (2 * along + fast - slow) / (8 * (along + fast))
    return {**parameters, "friction": friction}, velocity


LEVELS = [
    pytest.param(*quaid(0.4, 2.0, 0.5, 0.3), 50.0, 15.882857e-3, id="two levels"),
    pytest.param(*quaid(0.2, 1.0, 0.25, 0.2), 100.0, 3.27e-3, id="two slow levels"),
    pytest.param(*winkler(0.4, 0.3, 0.4), 50.0, 3.32687e-3, id="in phase"),
    pytest.param(*winkler(0.3, 0.9, 0.25), 50.0, 9.1376e-3, id="in phase, nearly lifted"),
]


def follow(method: str, parameters: dict[str, Any], frequency: float = 50.0) -> Any:
    return run_study(parse_study({
        "kind": "simulate", "scene": "rectangle-on-plane", "method": method,
        "outputs": ["conveying_velocity", "conveying_velocity_error"],
        "parameters": {"gravity": G, "frequency": f"{frequency} Hz", **parameters},
    }))  # fmt: skip


@pytest.mark.parametrize(("parameters", "velocity", "frequency", "published"), LEVELS)
def test_waves_in_steps_in_closed_form(
    parameters: dict[str, Any], velocity: float, frequency: float, published: float
) -> None:
    velocity *= GRAVITY / frequency
    assert velocity == pytest.approx(published, rel=1e-5)
    # Constant accelerations between events: nothing but rounding is left.
    exact = follow("reference", parameters, frequency)
    assert float(exact.conveying_velocity) == pytest.approx(velocity, rel=1e-13)
    assert float(exact.conveying_velocity_error) < 1e-12 * velocity
    assert int(exact.motion_status) == STATUS["periodic"]


def test_weak_friction_takes_the_weighted_median_of_an_ellipse() -> None:
    # Along sin t, normal sin(t - 90 deg), throw number all but 1: the load is 1 + cos t. In the
    # limit acos c + sqrt(1 - c^2) = pi/2; c is the sine of the number that is its own cosine.
    limit = math.sin(0.7390851332151607)
    for weak, share in ((0.2, 0.523), (0.1, 0.635), (0.05, 0.664)):
        wave = harmonics((ALONG, 1, 1.0, 0.0), (NORMAL, 1, 1.0 - 1e-6, -math.pi / 2))
        found = reference_motion(driven(wave, kinetic=weak))
        assert float(found.velocity) == pytest.approx(share, abs=1e-3)
        assert share < limit


def test_weak_friction_under_two_frequencies() -> None:
    # cos t + e cos 2 t along the track: the median of its speed is -e, up to e = 1/4.
    for share in (0.1, 0.25):
        wave = harmonics((ALONG, 1, 1.0, 0.0), (ALONG, 2, 2 * share, 0.0))
        off = []
        for weak in (0.08, 0.02):
            found = reference_motion(driven(wave, kinetic=weak), max_periods=300)
            off.append(abs(abs(float(found.velocity)) - share))
        assert off[1] < 0.3 * off[0] < 0.01


# --- laws


@pytest.mark.parametrize(
    ("normal", "contacts"),
    spread([(1.4, BLOCK_ON_FLOOR), (0.6, CYLINDER), (0.6, BLOCK_ON_FLOOR)], day=2),
)
def test_a_wave_of_one_order_is_the_plain_sine(normal: float, contacts: Contacts) -> None:
    numbers = {"gravity_number_along": 0.02, "friction_static": 0.45, "friction_kinetic": 0.4}
    wave = harmonics((ALONG, 1, 1.1, 0.0), (1, 1, 0.3, 0.0), (NORMAL, 1, normal, 0.0))
    waved = driven(wave, **numbers)
    plain = waved._replace(wave=None)
    one, other = reference_motion(plain, contacts), reference_motion(waved, contacts)
    assert float(one.velocity) == pytest.approx(float(other.velocity), abs=1e-12)


def later(wave: Wave, shift: float) -> Wave:
    """Return a wave that comes later by a phase."""
    turn = shift * np.arange(1, wave.harmonics.shape[2] + 1)
    sine, cosine = np.moveaxis(wave.harmonics, 1, 0)
    turned = np.stack(
        [sine * np.cos(turn) + cosine * np.sin(turn), cosine * np.cos(turn) - sine * np.sin(turn)],
        axis=1,
    )
    steps = wave.steps.copy()
    if steps.size:  # the step in which the shifted wave begins is cut in two
        ends = steps[ENDS] + shift
        first = int(np.argmax(ends > TURN))
        steps = np.concatenate([steps[:, first:], steps[:, : first + 1]], axis=1)
        steps[ENDS] = [*(ends[first:] - TURN), *ends[:first], TURN]
    return Wave(turned, steps)


@pytest.mark.parametrize("seed", range(4))
def test_a_shift_of_time_changes_nothing(seed: int) -> None:
    wave = random_wave(np.random.default_rng(seed), across=0.0)
    moved = later(wave, 2.0)
    phases = np.linspace(0.1, 6.0, 7)
    for axis in (ALONG, NORMAL):
        np.testing.assert_allclose(
            push(moved, axis, phases + 2.0), push(wave, axis, phases), atol=1e-13
        )
    one, other = reference_motion(driven(wave)), reference_motion(driven(moved))
    assert float(one.velocity) == pytest.approx(float(other.velocity), abs=1e-11)


@pytest.mark.parametrize("seed", spread(range(4), 1))
def test_along_and_climb_turned_turns_the_velocity(seed: int) -> None:
    wave = random_wave(np.random.default_rng(seed), across=0.3)
    turned = Wave(wave.harmonics.copy(), wave.steps.copy())
    turned.harmonics[ALONG] *= -1.0
    turned.steps[ALONG] *= -1.0
    for contacts in (BLOCK_ON_FLOOR, CYLINDER):
        up, down = (
            driven(one, gravity_number_along=climb)
            for one, climb in ((wave, 0.03), (turned, -0.03))
        )  # fmt: skip
        one, other = reference_motion(up, contacts), reference_motion(down, contacts)
        assert float(one.velocity) == pytest.approx(-float(other.velocity), abs=1e-11)


def test_twice_the_frequency_normal_conveys_nothing() -> None:
    # Half a period later the drive along is turned, and the load is the same.
    for phase in (0.0, 0.7, 2.0):
        wave = harmonics((ALONG, 1, 1.2, 0.0), (NORMAL, 2, 0.8, phase))
        assert abs(float(reference_motion(driven(wave)).velocity)) < 1e-12


def test_a_second_harmonic_turned_turns_the_velocity() -> None:
    for phase in (0.3, 1.5):
        one, other = (
            reference_motion(driven(harmonics((ALONG, 1, 0.9, 0.0), (ALONG, 2, 0.5, second))))
            for second in (phase, phase + math.pi)
        )
        assert abs(float(one.velocity)) > 1e-3
        assert float(one.velocity) == pytest.approx(-float(other.velocity), abs=1e-12)


@pytest.mark.parametrize(
    "wave",
    [
        harmonics((ALONG, 1, 1.0, 0.4), (ALONG, 3, 0.4, 0.0), (NORMAL, 2, 0.5, 1.0)),
        levels([0.2, 0.55, 1.0], along=[1.5, -0.6, -0.2], normal=[-0.5, 0.4, -0.4 / 4.5]),
    ],
)
def test_what_the_track_gives_is_lost_in_friction(wave: Wave) -> None:
    climb, friction = 0.03, 0.3
    groups = driven(wave, friction, gravity_number_along=climb)
    phases = np.linspace(0.0, 2 * TURN, 80_001)
    path = path_by_reference(groups, phases=phases)
    u, middles = path.velocity[:, 0], 0.5 * (phases[1:] + phases[:-1])  # jumps are at phases
    step, mean, rubs = phases[1], 0.5 * (u[1:] + u[:-1]), 0.5 * np.abs(u[1:] + u[:-1])
    work = step * float((push(wave, ALONG, middles) - climb) @ mean)
    heat = step * float(friction * (1.0 - push(wave, NORMAL, middles)) @ rubs)
    assert np.all(path.position[:, 2] == 0.0)
    assert work == pytest.approx(heat + 0.5 * u[-1] ** 2, rel=1e-7)


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
    one, other = reference_motion(driven(wave)), reference_motion(driven(padded))
    assert float(one.velocity) == pytest.approx(float(other.velocity), abs=1e-14)
    one, other = (motion_by_events(driven(each), BLOCK_ON_FLOOR, **EXACTLY)
                  for each in (wave, padded))  # fmt: skip
    assert float(one.velocity) == pytest.approx(float(other.velocity), abs=1e-12)


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
            (BLOCK_ON_FLOOR, 0.0, count(4, 16)),
            (BLOCK_ON_FLOOR, 0.3, count(2, 6)),
            (CYLINDER, 0.3, count(2, 6)),
            (WALL, 0.3, count(2, 6)),
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
    random = np.random.default_rng(7)
    waves = [levels([0.2, 0.6, 1.0], along=random.normal(size=3)) for _ in range(5)]
    for wave in waves:
        wave.steps[ALONG] -= wave.steps[ALONG] @ np.array([0.2, 0.4, 0.4])
    grid = Wave(np.zeros((3, 2, 0, 5)), np.stack([wave.steps for wave in waves], axis=-1))
    many = motion_by_events(
        driven(waves[0])._replace(drive_number_along=bound(grid, ALONG), wave=grid),
        BLOCK_ON_FLOOR, **EXACTLY,
    )  # fmt: skip
    for n, wave in enumerate(waves):
        one = motion_by_events(driven(wave), BLOCK_ON_FLOOR, **EXACTLY)
        assert float(one.velocity) == many.velocity[n]


def test_a_wave_that_does_not_close_is_no_drive() -> None:
    open_wave = {"acceleration_along_1": "4 m/s^2", "acceleration_along_2": ["-4 m/s^2", "3 m/s^2"]}
    for method in ("events", "reference"):
        dataset = follow(method, {**open_wave, "friction": 0.3})
        assert dataset.motion_status.values[1] == STATUS["no_drive"]
        assert np.isnan(dataset.conveying_velocity.values).tolist() == [False, True]


def test_a_course_shows_the_track() -> None:
    parameters, _ = quaid(0.4, 2.0, 0.5, 0.3)
    dataset = run_study(parse_study({
        "kind": "simulate", "scene": "rectangle-on-plane", "method": "events",
        "outputs": ["conveying_velocity"], "trajectory": 600,
        "parameters": {"gravity": G, "frequency": "50 Hz", **parameters},
    }))  # fmt: skip
    times: Array = dataset.cycle_time.values
    acceleration = np.gradient(np.gradient(dataset.track_along.values, times), times)
    middle = np.abs(times - 0.01) < 0.001
    np.testing.assert_allclose(acceleration[middle], -2.0 * GRAVITY, rtol=1e-6)
    assert not dataset.track_normal.values.any()
    travel = dataset.position_along.values[-1] / times[-1]
    assert travel == pytest.approx(float(dataset.conveying_velocity), rel=1e-4)
