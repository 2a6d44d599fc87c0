"""Exact motion in space: against the reference, and by laws (theory 13.13)."""

import math

import numpy as np
import pytest

from night import count, spread
from vibrafeed.core.motion.events import motion_by_events, spatial_motion, spatial_path
from vibrafeed.core.motion.kernels.inputs import NEVER as NO_STOP
from vibrafeed.core.motion.kernels.track.push import STATE
from vibrafeed.core.motion.kernels.track.series import NEVER, first_fall
from vibrafeed.core.motion.kernels.track.settling import new_history, slowly_approached_cycle
from vibrafeed.core.motion.method import STATUS, Contacts, Groups, each
from vibrafeed.core.motion.reference import reference_motion

SETTINGS = {"tolerance": 1e-12, "max_periods": 300}
REPEATS = {STATUS["periodic"], STATUS["at_rest"]}
PLANE, TRACK, CYLINDER = Contacts(), Contacts(wall=True), Contacts(rolling=2.0)


def random_groups(number: int, seed: int, *, wall: bool, curved: bool = False, **given) -> Groups:
    """Return groups of parts of all regimes from slip to hops."""
    pick = np.random.default_rng(seed).uniform
    beta, alpha = np.radians(pick(10, 50, number)), np.radians(pick(-35, 35, number))
    gamma, delta = np.radians(pick(0, 4, number)), np.radians(pick(2, 20, number) if wall else 0)
    normal = np.cos(gamma) * np.cos(delta)
    drive = pick(0.2, 2.5, number) * normal / np.sin(beta)
    friction = pick(0.15, 0.8, number)
    found = Groups(
        drive_number_along=drive * np.cos(beta) * np.cos(alpha),
        drive_number_across=drive * np.cos(beta) * np.sin(alpha),
        drive_number_normal=drive * np.sin(beta),
        gravity_number_along=np.sin(gamma),
        gravity_number_across=np.cos(gamma) * np.sin(delta),
        gravity_number_normal=normal,
        curvature_number=10 ** pick(-3, -1, number) if curved else 0.0,
        friction_static=friction,
        friction_kinetic=friction,
        wall_friction=friction,
    )
    return found._replace(**given)


def drive_of(groups: Groups) -> np.ndarray:
    """Return the size of the drive's speed."""
    axes = ("along", "across", "normal")
    return np.linalg.norm([getattr(groups, f"drive_number_{axis}") for axis in axes], axis=0)


def test_what_is_left_of_a_geometric_approach_is_its_remainder():
    history, shrinks = new_history(40, NO_STOP), 0.7 ** np.arange(42)
    history.starts[:], history.ends[:] = 0.0, 0.0
    history.starts[:, STATE.ux], history.ends[:, STATE.ux] = shrinks[:-1], shrinks[1:]
    found = slowly_approached_cycle(False, 0.0, history, 40, 1e-3)
    assert (found.multiple, found.transient) == (1, pytest.approx(0.7**40))


@pytest.mark.parametrize(
    ("contacts", "curved"),
    spread([(PLANE, False), (TRACK, True), (CYLINDER, False), (TRACK, False)], 3),
)
def test_means_are_those_of_the_reference(contacts, curved):
    """Two witnesses that share nothing: the reference has neither kernels nor series."""
    given = random_groups(count(3, 100), 5, wall=contacts.wall, curved=curved)
    found, parts = spatial_motion(given, contacts, **SETTINGS), [*each(given)[0]]
    speed, judged = drive_of(given), 0
    for number, part in enumerate(parts):
        other = reference_motion(part, contacts, max_periods=60)
        if {int(found.status[number]), int(other.status)} <= REPEATS:
            judged += 1  # some are chance, or are slow to settle
            apart = abs(found.velocity[number] - float(other.velocity))
            assert apart <= found.error[number] + float(other.error)
            assert apart <= 1e-9 * speed[number]
            assert found.multiple[number] in (0, other.multiple)
    assert judged >= 0.6 * len(parts)


def test_each_cell_goes_its_own_way():
    given = random_groups(8, 9, wall=True)
    names = ("drive_number_across", "gravity_number_across")
    flat = given._replace(**dict.fromkeys(names, 0.0))
    odd = np.arange(8) % 2
    mixed = given._replace(**{name: odd * getattr(given, name) for name in names})
    found, planar, spatial = (
        motion_by_events(one, TRACK, **SETTINGS) for one in (mixed, flat, given)
    )
    for field, in_line, other in zip(found, planar, spatial, strict=True):
        np.testing.assert_array_equal(field[::2], in_line[::2])
        np.testing.assert_array_equal(field[1::2], other[1::2])


def test_a_mirror_changes_nothing_along():
    given = random_groups(30, 3, wall=False)
    turned = given._replace(drive_number_across=-given.drive_number_across)
    one, other = (spatial_motion(groups, PLANE, **SETTINGS) for groups in (given, turned))
    periodic = one.status == STATUS["periodic"]
    assert periodic.sum() >= 20
    assert (np.abs(one.velocity - other.velocity) <= one.error + other.error)[periodic].all()
    assert (np.abs(one.across + other.across) <= 1e-9 * drive_of(given))[periodic].all()


def test_shares_add_up_and_a_course_closes():
    given = random_groups(5, 11, wall=True, curved=True)
    found, parts = spatial_motion(given, TRACK, **SETTINGS), [*each(given)[0]]
    shares = found.stick + found.forward + found.backward + found.flight
    for number in np.flatnonzero(found.status == STATUS["periodic"]):
        assert shares[number] == pytest.approx(1.0, abs=1e-12)
        # Uphill no point of the track is faster than its drive, and friction pushes no further.
        most = given.drive_number_along[number] + found.error[number]
        assert found.velocity[number] <= most
        cycle = 2 * math.pi * found.multiple[number]
        phases = np.linspace(0.0, cycle, 400)
        path, _ = spatial_path(parts[number], TRACK, **SETTINGS, phases=phases)
        assert np.abs(path.velocity[-1] - path.velocity[0]).max() <= 1e-9
        travel = path.position[-1, 0] - path.position[0, 0]
        assert travel == pytest.approx(found.velocity[number] * cycle, abs=1e-8)
        assert (path.position[:, 1:] >= 0.0).all()


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
