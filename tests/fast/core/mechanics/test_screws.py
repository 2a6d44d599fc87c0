"""Screws: what each keeps when it moves, and reduction from the least to the largest float."""

import numpy as np
import pytest

from screws import (
    DualVector,
    Twist,
    Wrench,
    body_to_reference,
    force_at,
    power,
    rotation_x,
    rotation_y,
    rotation_z,
)
from vibrafeed.core.mechanics.screws import dot, reduce_screw

RANDOM = np.random.default_rng(4)
POINTS = 2000
EPS = np.finfo(float).eps
MAGNITUDES = [1e-300, 1e-160, 1.0, 1e160, 1e300]


def vectors() -> np.ndarray:
    return RANDOM.normal(size=(POINTS, 3))


def screws(kind):
    return kind(vectors(), vectors())


def test_matrices_are_those_of_2_1():
    c, s = np.cos(0.3), np.sin(0.3)
    np.testing.assert_array_equal(rotation_x(0.3), [[1, 0, 0], [0, c, -s], [0, s, c]])
    np.testing.assert_array_equal(rotation_y(0.3), [[c, 0, s], [0, 1, 0], [-s, 0, c]])
    np.testing.assert_array_equal(rotation_z(0.3), [[c, -s, 0], [s, c, 0], [0, 0, 1]])


def test_power_does_not_depend_on_point_or_axes():
    wrench, twist, point = screws(Wrench), screws(Twist), vectors()
    turns = RANDOM.uniform(-np.pi, np.pi, (3, POINTS))
    matrix = body_to_reference(**dict(zip(("about_x", "about_y", "about_z"), turns, strict=True)))
    expected = power(wrench, twist)
    for other in (
        power(wrench.moved_to(point), twist.moved_to(point)),
        power(wrench.rotated(matrix), twist.rotated(matrix)),
    ):
        np.testing.assert_allclose(other, expected, atol=1e-13)
    # That of a force is the force times the velocity of its point.
    there = power(force_at(point=point, force=wrench.real), twist)
    np.testing.assert_allclose(there, dot(wrench.real, twist.moved_to(point).dual), atol=1e-13)


def test_the_cross_product_is_the_rate_of_a_screw_that_a_body_carries_along():
    """By the turn about the origin and the way of a twist (w, v); central difference, error t^2."""
    w, v, carried, step = vectors(), vectors(), screws(DualVector), 1e-5

    def after(t: float) -> DualVector:
        # Three turns in a row depart from one about w by terms of t^2; the difference drops these.
        x, y, z = (w * t).T
        return carried.rotated(body_to_reference(about_x=x, about_y=y, about_z=z)).moved_to(-v * t)

    ahead, behind, product = after(step), after(-step), DualVector(w, v).cross(carried)
    for half in ("real", "dual"):
        rate = (getattr(ahead, half) - getattr(behind, half)) / (2 * step)
        np.testing.assert_allclose(rate, getattr(product, half), atol=1e-8)


def test_without_the_cross_that_2_13_drops_it_is_not():
    one, other = screws(DualVector), screws(DualVector)
    componentwise = np.cross(one.real, other.dual) - other.real * one.dual
    assert np.max(np.abs(componentwise - one.cross(other).dual)) > 1


@pytest.mark.parametrize("force", MAGNITUDES)
def test_reduction_survives_forces_of_any_size(force):
    F, r, p = vectors(), vectors(), RANDOM.normal(size=POINTS)
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
    wrench = screws(Wrench)
    at = wrench.reduced()
    there = wrench.moved_to(at.axis_point)
    scale = np.max(np.abs(at.axis_point), -1, keepdims=True) + np.abs(at.pitch)[:, None] + 1
    assert np.max(np.abs(there.dual - at.pitch[:, None] * wrench.real) / scale) < 1e-14


def test_the_sign_printed_in_4_3_does_not_give_the_moment_back():
    F, M = np.array([0.0, 0.0, 2.0]), np.array([4.0, 0.0, 6.0])
    at = reduce_screw(F, M)
    printed = np.cross(M, F) / dot(F, F)
    np.testing.assert_array_equal(printed, -at.axis_point)
    np.testing.assert_array_equal(np.cross(at.axis_point, F) + at.pitch * F, M)
    np.testing.assert_array_equal(np.cross(printed, F) + at.pitch * F, [-4.0, 0.0, 6.0])
