"""Exact motion in space: against the reference, and by laws (theory 13.13)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from core.motion.groups import Contacts, Groups, each
from core.motion.kernels.track.polynomials import NEVER, first_fall
from core.motion.methods.events import motion_by_events
from core.motion.methods.reference import reference_motion
from core.motion.methods.spatial_events import spatial_motion, spatial_path
from core.motion.result import STATUS, Motion

SETTINGS = {"tolerance": 1e-12, "most_periods": 300}
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
    [(PLANE, False), (TRACK, False), (TRACK, True), (CYLINDER, False)],
)
def test_means_are_those_of_the_reference(contacts, curved):
    """Two witnesses that share nothing: the reference has neither kernels nor series."""
    given = random_groups(6, 5, wall=contacts.wall, curved=curved)
    found = spatial_motion(given, contacts, **SETTINGS)
    parts, _ = each(given)
    alone = [reference_motion(part, contacts, most_periods=60) for part in parts]
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
        one = Groups._make(np.broadcast_to(field, 5)[number].item() for field in given)
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
