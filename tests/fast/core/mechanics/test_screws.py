"""Screws: reduction from the least to the largest float, and equations of chapters 2 and 4."""

import numpy as np
import pytest

from vibrafeed.core.mechanics.screws import dot, floor_wrench, reduce_screw

RANDOM = np.random.default_rng(4)
POINTS = 2000
EPS = np.finfo(float).eps
MAGNITUDES = [1e-300, 1e-160, 1.0, 1e160, 1e300]


def vectors(count: int = 1) -> np.ndarray:
    return RANDOM.normal(size=(count, POINTS, 3))


@pytest.mark.parametrize("force", MAGNITUDES)
def test_reduction_survives_forces_of_any_size(force):
    (F, r), p = vectors(2), RANDOM.normal(size=POINTS)
    r -= F * (dot(F, r) / dot(F, F))[..., None]
    M = np.cross(r, F) + p[..., None] * F
    at = reduce_screw(F * force, M * force)
    np.testing.assert_allclose(at.pitch, p, rtol=0, atol=1e-13)
    np.testing.assert_allclose(at.axis_point, r, rtol=0, atol=1e-13)
    assert np.all(at.has_axis)


@pytest.mark.parametrize("force", [*MAGNITUDES, 5e-324, 1.7e308])
@pytest.mark.parametrize("moment", [*MAGNITUDES, 0.0])
def test_reduction_gives_what_a_float_can_hold_and_infinity_beyond(force, moment):
    at = reduce_screw(np.array([0.0, force, 0.0]), np.array([0.0, moment, 2 * moment]))
    with np.errstate(over="ignore", under="ignore"):
        pitch, far = np.float64([moment, 2 * moment]) / np.float64(force)
    np.testing.assert_allclose(at.pitch, pitch, rtol=4 * EPS)
    np.testing.assert_allclose(at.axis_point, [far, 0, 0], rtol=4 * EPS)


@pytest.mark.parametrize("moment", [5e-324, *MAGNITUDES])
def test_a_pure_couple_has_no_axis(moment):
    at = reduce_screw(np.zeros(3), np.array([0.0, moment, 0.0]))
    assert not at.has_axis
    assert np.isnan([at.pitch, *at.axis_point]).all()


def test_moment_about_the_axis_is_pitch_times_force():
    force, moment = vectors(2)
    at = reduce_screw(force, moment)
    there = moment + np.cross(force, at.axis_point)
    scale = np.max(np.abs(at.axis_point), -1, keepdims=True) + np.abs(at.pitch)[:, None] + 1
    assert np.max(np.abs(there - at.pitch[:, None] * force) / scale) < 1e-14


def test_the_floor_wrench_is_that_of_its_forces_at_the_lowest_point():
    force, (drilling, spin, yaw) = np.array([20.0, -3.0, -4.0]), (0.4, 5.0, 7.0)
    found = floor_wrench(
        mass=2.0, diameter=0.02, spin_rate=spin, yaw_rate=yaw, drilling_moment=drilling,
        rolling_friction=-force[1], axial_friction=-force[2], floor_force=force[0],
    )  # fmt: skip
    np.testing.assert_array_equal(found.force, force)
    about_axis = np.cross([-0.01, 0.0, 0.0], force)[2]
    gyroscopic = -2.0 * 0.01**2 / 2 * spin * yaw
    np.testing.assert_allclose(found.moment, [drilling, gyroscopic, about_axis], rtol=1e-14)


def test_the_sign_printed_in_4_3_does_not_give_the_moment_back():
    F, M = np.array([0.0, 0.0, 2.0]), np.array([4.0, 0.0, 6.0])
    at = reduce_screw(F, M)
    printed = np.cross(M, F) / dot(F, F)
    np.testing.assert_array_equal(printed, -at.axis_point)
    np.testing.assert_array_equal(np.cross(at.axis_point, F) + at.pitch * F, M)
    np.testing.assert_array_equal(np.cross(printed, F) + at.pitch * F, [-4.0, 0.0, 6.0])


def test_the_cross_that_2_13_drops_makes_the_dual_euler_equation_that_of_newton_and_euler():
    """(2.2), (2.7) to (2.14): the momentum screw (q, H) about any point A of a body, in its axes.

    Its rate is that of its components and the product of twist (w, v) and momentum,
    w x q + e (w x H + v x q): (2.13) prints the last term without its cross.
    """
    w, v, wdot, vdot, centre = vectors(5)
    mass, inertia = 0.7, np.diag([1.0, 2.0, 2.5])  # about the mass centre

    def momentum(w, v):
        q = mass * (v + np.cross(w, centre))
        return q, w @ inertia + np.cross(centre, q)

    (q, H), (qdot, Hdot) = momentum(w, v), momentum(wdot, vdot)
    force, moment = qdot + np.cross(w, q), Hdot + np.cross(w, H) + np.cross(v, q)
    of_centre = vdot + np.cross(w, v) + np.cross(wdot, centre)
    newton = mass * (of_centre + np.cross(w, np.cross(w, centre)))
    euler = wdot @ inertia + np.cross(w, w @ inertia) + np.cross(centre, newton)
    np.testing.assert_allclose(force, newton, atol=1e-12)
    np.testing.assert_allclose(moment, euler, atol=1e-12)
    assert np.max(np.abs(Hdot + np.cross(w, H) + v * q - euler)) > 1
