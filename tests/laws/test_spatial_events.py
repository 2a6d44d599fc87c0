"""Exact motion in space: against the reference, and by laws (theory 13.13)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from night import spread
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.motion.events import motion_by_events, spatial_motion, spatial_path
from vibrafeed.core.motion.kernels.constants import MODE
from vibrafeed.core.motion.kernels.track.series import NEVER, first_fall
from vibrafeed.core.motion.method import STATUS, Contacts, Groups, Motion, each
from vibrafeed.core.motion.reference import reference_motion

SETTINGS = {"tolerance": 1e-12, "max_periods": 300}
PLANE, TRACK, CYLINDER = Contacts(), Contacts(wall=True), Contacts(rolling=2.0)


def random_groups(count: int, seed: int, *, wall: bool, curved: bool = False, **given) -> Groups:
    """Return groups of parts of all regimes from slip to hops."""
    pick = np.random.default_rng(seed).uniform
    beta, alpha = np.radians(pick(10, 50, count)), np.radians(pick(-35, 35, count))
    gamma, delta = np.radians(pick(0, 4, count)), np.radians(pick(2, 20, count) if wall else 0)
    normal = np.cos(gamma) * np.cos(delta)
    drive = pick(0.2, 2.5, count) * normal / np.sin(beta)
    friction = pick(0.15, 0.8, count)
    found = Groups(
        drive_number_along=drive * np.cos(beta) * np.cos(alpha),
        drive_number_across=drive * np.cos(beta) * np.sin(alpha),
        drive_number_normal=drive * np.sin(beta),
        gravity_number_along=np.sin(gamma),
        gravity_number_across=np.cos(gamma) * np.sin(delta),
        gravity_number_normal=normal,
        curvature_number=10 ** pick(-3, -1, count) if curved else 0.0,
        friction_static=friction,
        friction_kinetic=friction,
        wall_friction=friction,
    )
    return found._replace(**given)


def drive_of(groups: Groups) -> np.ndarray:
    """Return the size of the drive's speed."""
    return np.sqrt(
        np.square(groups.drive_number_along)
        + np.square(groups.drive_number_across)
        + np.square(groups.drive_number_normal)
    )


@pytest.mark.parametrize(
    ("contacts", "curved"),
    spread([(PLANE, False), (TRACK, False), (TRACK, True), (CYLINDER, False)], 2),
)
def test_means_are_those_of_the_reference(contacts, curved):
    """Two witnesses that share nothing: the reference has neither kernels nor series."""
    given = random_groups(6, 5, wall=contacts.wall, curved=curved)
    found = spatial_motion(given, contacts, **SETTINGS)
    parts, _ = each(given)
    alone = [reference_motion(part, contacts, max_periods=60) for part in parts]
    other = Motion._make(
        np.array([np.asarray(n).item() for n in column]) for column in zip(*alone, strict=True)
    )
    both = np.isin(found.status, [STATUS["periodic"], STATUS["at_rest"]])
    both &= np.isin(other.status, [STATUS["periodic"], STATUS["at_rest"]])
    assert both.sum() >= 4  # some are chance, or are slow to settle
    apart = np.abs(found.velocity - other.velocity)
    assert (apart <= found.error + other.error)[both].all()
    assert (apart <= 1e-9 * drive_of(given))[both].all()
    assert (found.multiple == other.multiple)[both & (found.multiple > 0)].all()


def test_next_to_the_plane_it_is_next_to_the_planar_motion():
    """The limit of a drive that hardly leaves the plane, within what each states of its error."""
    given = random_groups(40, 8, wall=False)
    planar = motion_by_events(given._replace(drive_number_across=0.0), PLANE, **SETTINGS)
    near = given._replace(drive_number_across=1e-3 * given.drive_number_along)
    found = motion_by_events(near, PLANE, **SETTINGS)
    both = (planar.status == STATUS["periodic"]) & (found.status == STATUS["periodic"])
    assert both.sum() >= 30
    # The drive across turns the slip by as much, and takes away from friction along by its square.
    apart = np.abs(planar.velocity - found.velocity)[both]
    assert apart.max() <= 1e-4 * drive_of(given).max()


def test_each_cell_goes_its_own_way():
    given = random_groups(8, 9, wall=True)
    flat = {"drive_number_across": 0.0, "gravity_number_across": 0.0}
    across = np.where(np.arange(8) % 2, given.drive_number_across, 0.0)
    lean = np.where(np.arange(8) % 2, given.gravity_number_across, 0.0)
    mixed = given._replace(drive_number_across=across, gravity_number_across=lean)
    found = motion_by_events(mixed, TRACK, **SETTINGS)
    planar = motion_by_events(given._replace(**flat), TRACK, **SETTINGS)
    spatial = motion_by_events(given, TRACK, **SETTINGS)
    for field, flat_field, other in zip(found, planar, spatial, strict=True):
        assert np.array_equal(field[::2], flat_field[::2], equal_nan=True)
        assert np.array_equal(field[1::2], other[1::2], equal_nan=True)


def test_a_mirror_changes_nothing_along():
    given = random_groups(30, 3, wall=False)
    found = spatial_motion(given, PLANE, **SETTINGS)
    mirrored = spatial_motion(
        given._replace(drive_number_across=-given.drive_number_across), PLANE, **SETTINGS
    )
    periodic = found.status == STATUS["periodic"]
    assert periodic.sum() >= 20
    apart = np.abs(found.velocity - mirrored.velocity)[periodic]
    assert (apart <= (found.error + mirrored.error)[periodic]).all()


def test_no_part_is_faster_than_the_track():
    """Uphill no point of the track is faster than its drive, and friction pushes no further."""
    given = random_groups(60, 4, wall=True, curved=True)
    found = spatial_motion(given, TRACK, **SETTINGS)
    assert (found.status > 0).all()
    periodic = found.status == STATUS["periodic"]
    assert (found.velocity <= given.drive_number_along + found.error)[periodic].all()


def test_shares_add_up_and_a_course_closes():
    given = random_groups(5, 11, wall=True, curved=True)
    found = spatial_motion(given, TRACK, **SETTINGS)
    shares = found.stick + found.forward + found.backward + found.flight
    for number in np.flatnonzero(found.status == STATUS["periodic"]):
        assert shares[number] == pytest.approx(1.0, abs=1e-12)
        one = Groups(*(np.broadcast_to(field, 5)[number].item() for field in given.numbers))
        cycle = 2 * math.pi * found.multiple[number]
        phases = np.linspace(0.0, cycle, 400)
        path, modes = spatial_path(one, TRACK, **SETTINGS, phases=phases)
        assert np.abs(path.velocity[-1] - path.velocity[0]).max() <= 1e-9
        travel = path.position[-1, 0] - path.position[0, 0]
        assert travel == pytest.approx(found.velocity[number] * cycle, abs=1e-8)
        assert (path.position[:, 1:] >= 0.0).all()
        assert set(modes.tolist()) <= {0, 1, 2, 3}


def test_the_first_fall_is_the_first_of_all_roots():
    """Random polynomials with roots on both sides, and a graze that is none."""
    pick = np.random.default_rng(2)
    table = np.zeros((2, 20))  # a polynomial, and room for the search
    series = table[0]
    for _ in range(200):
        roots = pick.uniform(-1.0, 1.0, 6)
        series[:7] = np.polynomial.polynomial.polyfromroots(roots)
        series *= np.sign(series[0])
        inside = np.sort(roots[roots > 0.0])
        found = first_fall(table, 0, 6, 1.0, 1)
        if inside.size:
            assert found == pytest.approx(inside[0], abs=1e-9)  # near pairs are ill conditioned
        else:
            assert found == NEVER
    series[:] = 0.0
    series[:3] = (0.25 + 1e-12, -1.0, 1.0)
    assert first_fall(table, 0, 2, 1.0, 1) == NEVER
    series[0] = 0.25 - 1e-12
    assert first_fall(table, 0, 2, 1.0, 1) == pytest.approx(0.5 - 1e-6, abs=1e-8)


def test_a_drive_turned_round_changes_nothing():
    """Half a turn of the drive is half a period later: another start, the same motion."""
    given = random_groups(40, 21, wall=True, curved=True)
    turned = given._replace(
        drive_number_along=-given.drive_number_along,
        drive_number_across=-given.drive_number_across,
        drive_number_normal=-given.drive_number_normal,
    )
    found, later = (spatial_motion(one, TRACK, **SETTINGS) for one in (given, turned))
    both = (found.status == STATUS["periodic"]) & (later.status == STATUS["periodic"])
    same = np.abs(found.velocity - later.velocity) <= found.error + later.error
    assert both.sum() >= 30
    assert np.count_nonzero(both & ~same) <= 2  # two motions may lie beside each other


def test_next_to_a_reversal_in_a_line_the_answer_is_that_in_the_line():
    """A slip that reverses at a distance of 1e-5 to 1e-14 from nothing: no series may miss it."""
    given = random_groups(60, 1, wall=False)
    planar = motion_by_events(given._replace(drive_number_across=0.0), PLANE, **SETTINGS)
    for aslant in (1e-5, 1e-7, 1e-9, 1e-11, 1e-14):
        near = given._replace(drive_number_across=aslant * given.drive_number_along)
        found = spatial_motion(near, PLANE, **SETTINGS)
        both = (planar.status == STATUS["periodic"]) & (found.status == STATUS["periodic"])
        assert np.array_equal(both, planar.status == STATUS["periodic"])
        apart = np.abs(found.velocity - planar.velocity) / drive_of(given)
        assert apart[both].max() <= aslant**2 + 1e-9  # what is across acts by its square


def test_a_slip_that_hardly_closes_is_followed_to_its_end():
    """Friction is above the push by 6e-4 where 3e-6 of the slip is left: a line would end it."""
    given = Groups(
        drive_number_along=0.7102702358959131, drive_number_across=0.08518469178316451,
        drive_number_normal=0.5114328032709998, gravity_number_along=0.00371151582962297,
        gravity_number_normal=0.9999931123014031, friction_static=0.32122861972245564,
        friction_kinetic=0.32122861972245564,
    )  # fmt: skip
    found = spatial_motion(given, PLANE, **SETTINGS)
    # By series of order 24 with terms of 1e-13 and of 1e-14.
    assert float(found.velocity) == pytest.approx(0.2304533405261, abs=1e-10)


def test_size_does_not_matter_to_the_bit():
    """(A0, w, R) to (A0/4, 2 w, R/4): half the velocity, to the last digit."""
    parameters = {
        "frequency": 50, "amplitude": 0.4, "alpha": 10, "beta": 25, "gamma": 2, "delta": 5,
        "friction": 0.3, "radius": 0.2,
    }  # fmt: skip
    small = {**parameters, "frequency": 100, "amplitude": 0.1, "radius": 0.05}
    speeds = []
    for one in (parameters, small):
        amplitude = f"{one['amplitude']} mm"
        study = {"kind": "simulate", "scene": "rectangle-on-track",
                 "parameters": {**one, "amplitude": amplitude}}  # fmt: skip
        speeds.append(float(run_study(parse_study(study)).conveying_velocity))
    assert speeds[0] == 2 * speeds[1] != 0.0


def pieces_of(groups: Groups, cycle: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the phases between which a part stays in one mode, and the modes."""

    def modes(phases: np.ndarray) -> np.ndarray:
        return spatial_path(groups, PLANE, **SETTINGS, phases=phases)[1]

    phases = np.linspace(0.0, cycle, 3000)
    found = modes(phases)
    (changes,) = np.nonzero(np.diff(found))
    ends = []
    for change in changes:
        low, high = phases[change], phases[change + 1]
        for _ in range(4):
            inner = np.linspace(low, high, 1000)
            (first, *_) = np.nonzero(np.diff(modes(inner)))[0]
            low, high = inner[first], inner[first + 1]
        ends.append(0.5 * (low + high))
    return np.array([0.0, *ends, cycle]), found[[*changes, -1]]


def integral(ends: tuple[float, float], of, nodes: int = 24, parts: int = 60) -> float:
    """Return an integral over a piece, by Gauss' rule on parts that shrink towards both ends."""
    x, w = np.polynomial.legendre.leggauss(nodes)
    half = 0.5 * 0.6 ** np.arange(parts, -1.0, -1.0)
    marks = np.concatenate([[0.0], half, 1.0 - half[-2::-1], [1.0]])
    marks = ends[0] + (ends[1] - ends[0]) * marks
    width, middle = 0.5 * np.diff(marks), 0.5 * (marks[1:] + marks[:-1])
    phases = (middle[:, None] + width[:, None] * x).ravel()
    weights = (width[:, None] * w).ravel()
    order = np.argsort(phases)
    return float(weights[order] @ of(phases[order]))


@pytest.mark.parametrize(("drive", "friction"), [(0.8, 0.35), (1.4, 0.3), (2.2, 0.5)])
def test_momentum_and_work_balance_over_a_cycle(drive, friction):
    """What pushes a part along, across and up, and what friction and impacts take, add up to 0.

    By a quadrature of its own over the path: the kernel integrates neither forces nor work.
    """
    beta, alpha, gamma = np.radians([25.0, 12.0, 2.0])
    size = drive / math.sin(beta)
    push = size * np.array(
        [math.cos(beta) * math.cos(alpha), math.cos(beta) * math.sin(alpha), math.sin(beta)]
    )
    weight = np.array([math.sin(gamma), 0.0, math.cos(gamma)])
    groups = Groups(
        drive_number_along=push[0], drive_number_across=push[1], drive_number_normal=push[2],
        gravity_number_along=weight[0], gravity_number_normal=weight[2],
        friction_static=friction, friction_kinetic=friction,
    )  # fmt: skip
    motion = spatial_motion(groups, PLANE, **SETTINGS)
    assert motion.status == STATUS["periodic"]
    ends, modes = pieces_of(groups, 2 * math.pi * float(motion.multiple))
    momentum, work, scale = np.zeros(3), 0.0, 0.0
    for low, high, mode in zip(ends, ends[1:], modes, strict=False):

        def velocity(phases: np.ndarray) -> np.ndarray:
            return spatial_path(groups, PLANE, **SETTINGS, phases=phases)[0].velocity

        def force(phases: np.ndarray, flies: bool = mode == MODE.flight) -> np.ndarray:
            """Return the force of the floor: its load, and friction against the slip."""
            if flies:
                return np.zeros((len(phases), 3))
            load = weight[2] - push[2] * np.sin(phases)
            slip = velocity(phases)[:, :2]
            size = np.hypot(*slip.T)
            rubs = -friction * load[:, None] * slip / np.where(size > 0.0, size, 1.0)[:, None]
            holds = weight[:2] - push[:2] * np.sin(phases)[:, None]
            return np.column_stack([np.where(size[:, None] > 0.0, rubs, holds), load])

        for axis in range(3):

            def net(phases: np.ndarray, axis: int = axis) -> np.ndarray:
                free = push[axis] * np.sin(phases) - weight[axis]
                return free + force(phases)[:, axis]

            momentum[axis] += integral((low, high), net)

        def power(phases: np.ndarray) -> np.ndarray:
            free = push * np.sin(phases)[:, None] - weight
            return np.sum((free + force(phases)) * velocity(phases), axis=1)

        work += integral((low, high), power)
        scale += integral((low, high), lambda phases: np.abs(velocity(phases)).max(axis=1))
        if mode == MODE.flight and high < ends[-1]:  # an impact: it stops the fall, and rubs
            before, after = velocity(np.array([high - 1e-11, high + 1e-11]))
            fall = -before[2]
            slip = math.hypot(before[0], before[1])
            rub = min(friction * fall, slip) / slip
            np.testing.assert_allclose(after[:2], before[:2] * (1 - rub), atol=1e-9)
            momentum += [-rub * before[0], -rub * before[1], fall]
            work += 0.5 * ((slip - rub * slip) ** 2 - slip**2 - fall**2)
    np.testing.assert_allclose(momentum, 0.0, atol=1e-10 * max(1.0, size))
    assert abs(work) <= 1e-10 * max(1.0, scale)
