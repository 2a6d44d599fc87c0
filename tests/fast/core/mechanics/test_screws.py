"""Screws: what each kind keeps when it moves, and reduction from the least to the largest float."""

import numpy as np
import pytest

from screws import (
    DualVector,
    MomentumScrew,
    Twist,
    Wrench,
    body_to_reference,
    force_at,
    power,
    rotation_x,
    rotation_y,
    rotation_z,
    turned,
)
from vibrafeed.core.mechanics.screws import dot, reduce_screw, vector

RANDOM = np.random.default_rng(4)
POINTS = 2000
EPS = np.finfo(float).eps


def vectors(*shape: int) -> np.ndarray:
    return RANDOM.normal(size=(*(shape or (POINTS,)), 3))


def matrices() -> np.ndarray:
    x, y, z = RANDOM.uniform(-np.pi, np.pi, (3, POINTS))
    return body_to_reference(about_x=x, about_y=y, about_z=z)


class TestRotations:
    def test_elementary_matrices_turn_each_axis_into_the_next(self):
        quarter = np.array(np.pi / 2)
        x, y, z = np.eye(3)
        for rotation, before, after in (
            (rotation_x, y, z),
            (rotation_y, z, x),
            (rotation_z, x, y),
        ):
            np.testing.assert_allclose(turned(rotation(quarter), before), after, atol=EPS)

    def test_matrices_are_those_of_2_1(self):
        t = 0.3
        c, s = np.cos(t), np.sin(t)
        np.testing.assert_array_equal(rotation_x(t), [[1, 0, 0], [0, c, -s], [0, s, c]])
        np.testing.assert_array_equal(rotation_y(t), [[c, 0, s], [0, 1, 0], [-s, 0, c]])
        np.testing.assert_array_equal(rotation_z(t), [[c, -s, 0], [s, c, 0], [0, 0, 1]])

    def test_they_are_orthogonal_and_broadcast_over_grids(self):
        turn = body_to_reference(
            about_x=np.linspace(0, 1, 4)[:, None], about_y=np.array(0.2), about_z=np.ones(3)
        )
        assert turn.shape == (4, 3, 3, 3)
        np.testing.assert_allclose(
            turn @ np.swapaxes(turn, -1, -2), np.broadcast_to(np.eye(3), turn.shape), atol=4 * EPS
        )
        np.testing.assert_allclose(np.linalg.det(turn), 1, rtol=8 * EPS)


class TestTransforms:
    def test_power_does_not_depend_on_point_or_axes(self):
        wrench, twist = Wrench(vectors(), vectors()), Twist(vectors(), vectors())
        point, matrix = vectors(), matrices()
        expected = power(wrench, twist)
        moved = power(wrench.moved_to(point), twist.moved_to(point))
        rotated = power(wrench.rotated(matrix), twist.rotated(matrix))
        np.testing.assert_allclose(moved, expected, atol=1e-13)
        np.testing.assert_allclose(rotated, expected, atol=1e-13)

    def test_power_of_a_force_is_force_times_the_velocity_of_its_point(self):
        point, force, twist = vectors(), vectors(), Twist(vectors(), vectors())
        there = twist.moved_to(point)
        expected = dot(force, there.linear)
        np.testing.assert_allclose(
            power(force_at(point=point, force=force), twist), expected, atol=1e-13
        )
        assert np.all(np.abs(force_at(point=point, force=force).moved_to(point).moment) < 1e-14)

    @pytest.mark.parametrize("kind", [Twist, Wrench, MomentumScrew, DualVector])
    def test_moving_adds_up_and_goes_back(self, kind):
        screw, one, two = kind(vectors(), vectors()), vectors(), vectors()
        halves = list(kind.__dataclass_fields__)
        once = screw.moved_to(one).moved_to(two)
        both = screw.moved_to(one + two)
        back = once.moved_to(-one - two)
        for half in halves:
            np.testing.assert_allclose(getattr(once, half), getattr(both, half), atol=1e-13)
            np.testing.assert_allclose(getattr(back, half), getattr(screw, half), atol=1e-13)

    def test_each_kind_turns_and_moves_in_either_order(self):
        matrix, point = matrices(), vectors()
        for kind in (Twist, Wrench, MomentumScrew, DualVector):
            screw = kind(vectors(), vectors())
            one = screw.moved_to(point).rotated(matrix)
            other = screw.rotated(matrix).moved_to(turned(matrix, point))
            for half in kind.__dataclass_fields__:
                np.testing.assert_allclose(getattr(one, half), getattr(other, half), atol=1e-13)

    def test_kinds_do_not_mix(self):
        twist, wrench = Twist(vectors(), vectors()), Wrench(vectors(), vectors())
        with pytest.raises(AttributeError):
            twist + wrench  # type: ignore[operator]
        with pytest.raises(AttributeError):
            power(twist, wrench)  # type: ignore[arg-type]

    def test_screws_of_a_grid_broadcast(self):
        force = vector(np.ones((4, 1)), np.ones((1, 5)), np.zeros(()))
        wrench = Wrench(force, vectors(1, 5)).moved_to(vectors(4, 1))
        assert wrench.moment.shape == (4, 5, 3)
        assert wrench.reduced().pitch.shape == (4, 5)


class TestCrossProduct:
    def test_it_is_the_rate_of_a_screw_that_a_body_carries_along(self):
        # Carried by the turn R(t) about the origin and the displacement d(t) with the twist (w, v)
        # at t = 0; central difference, error t^2.
        w, v = vectors(), vectors()
        carried = DualVector(vectors(), vectors())
        step = 1e-5

        def after(t: float) -> DualVector:
            matrix = body_to_reference(
                about_x=w[:, 0] * t, about_y=w[:, 1] * t, about_z=w[:, 2] * t
            )
            return carried.rotated(matrix).moved_to(-v * t)

        ahead, behind = after(step), after(-step)
        product = DualVector(w, v).cross(carried)
        # three turns in a row depart from one about w by terms of t^2; the difference drops these
        for half in ("real", "dual"):
            rate = (getattr(ahead, half) - getattr(behind, half)) / (2 * step)
            np.testing.assert_allclose(rate, getattr(product, half), atol=1e-8)

    def test_without_the_cross_that_2_13_drops_it_is_not(self):
        one, other = DualVector(vectors(), vectors()), DualVector(vectors(), vectors())
        componentwise = np.cross(one.real, other.dual) - other.real * one.dual
        assert np.max(np.abs(componentwise - one.cross(other).dual)) > 1

    def test_it_is_antisymmetric_and_obeys_jacobi(self):
        a, b, c = (DualVector(vectors(), vectors()) for _ in range(3))
        turns = [a.cross(b.cross(c)), b.cross(c.cross(a)), c.cross(a.cross(b))]
        for half in ("real", "dual"):
            np.testing.assert_array_equal(getattr(a.cross(b), half), -getattr(b.cross(a), half))
            total = sum(getattr(turn, half) for turn in turns)
            np.testing.assert_allclose(total, 0, atol=1e-12)

    def test_it_does_not_depend_on_the_point(self):
        a, b, point = DualVector(vectors(), vectors()), DualVector(vectors(), vectors()), vectors()
        one = a.cross(b).moved_to(point)
        other = a.moved_to(point).cross(b.moved_to(point))
        np.testing.assert_allclose(one.dual, other.dual, atol=1e-12)

    def test_the_scalar_product_does_not_depend_on_the_point(self):
        a, b, point = DualVector(vectors(), vectors()), DualVector(vectors(), vectors()), vectors()
        here, there = a.dot(b), a.moved_to(point).dot(b.moved_to(point))
        np.testing.assert_allclose(there, here, atol=1e-12)


MAGNITUDES = [1e-300, 1e-160, 1.0, 1e160, 1e300]


class TestReduction:
    @pytest.mark.parametrize("force", MAGNITUDES)
    def test_it_survives_forces_of_any_size(self, force):
        F, r, p = vectors(), vectors(), RANDOM.normal(size=POINTS)
        r -= F * (dot(F, r) / dot(F, F))[..., None]
        M = np.cross(r, F) + p[..., None] * F
        at = Wrench(F * force, M * force).reduced()
        np.testing.assert_allclose(at.pitch, p, rtol=0, atol=1e-13)
        np.testing.assert_allclose(at.axis_point, r, rtol=0, atol=1e-13)
        assert np.all(at.has_axis)

    def test_it_does_not_change_with_a_power_of_two(self):
        F, M = vectors(), vectors()
        one = reduce_screw(F, M)
        for exponent in (-900, -500, 500, 1000, 1018):
            other = reduce_screw(np.ldexp(F, exponent), np.ldexp(M, exponent))
            np.testing.assert_array_equal(other.pitch, one.pitch)
            np.testing.assert_array_equal(other.axis_point, one.axis_point)

    @pytest.mark.parametrize("force", MAGNITUDES)
    @pytest.mark.parametrize("moment", MAGNITUDES)
    def test_it_gives_what_a_float_can_hold_and_infinity_beyond(self, force, moment):
        at = reduce_screw(np.array([0.0, 2 * force, 0.0]), np.array([0.0, moment, 2 * moment]))
        with np.errstate(over="ignore", under="ignore"):
            expected = np.float64(moment) / np.float64(2 * force)
        np.testing.assert_allclose(at.pitch, expected, rtol=4 * EPS)
        np.testing.assert_allclose(at.axis_point, [2 * expected, 0, 0], rtol=4 * EPS)

    @pytest.mark.parametrize("moment", [5e-324, *MAGNITUDES])
    def test_a_pure_couple_has_no_axis(self, moment):
        at = reduce_screw(np.zeros(3), np.array([0.0, moment, 0.0]))
        assert not at.has_axis
        assert np.isnan(at.pitch)
        assert np.isnan(at.axis_point).all()

    @pytest.mark.parametrize("force", [5e-324, 2.2e-308, 1.7e308])
    def test_a_force_at_the_ends_of_the_range_has_one(self, force):
        at = Wrench(np.array([force, 0.0, 0.0]), np.zeros(3)).reduced()
        assert at.has_axis
        assert at.pitch == 0
        np.testing.assert_array_equal(at.axis_point, 0)

    def test_moment_about_the_axis_is_pitch_times_force(self):
        wrench = Wrench(vectors(), vectors())
        at = wrench.reduced()
        there = wrench.moved_to(at.axis_point)
        scale = np.max(np.abs(at.axis_point), -1, keepdims=True) + np.abs(at.pitch)[:, None] + 1
        error = np.abs(there.moment - at.pitch[:, None] * wrench.force) / scale
        assert np.max(error) < 1e-14
        along = dot(at.axis_point, wrench.force) / scale[:, 0]
        assert np.max(np.abs(along)) < 1e-14

    def test_the_sign_printed_in_4_3_does_not_give_the_moment_back(self):
        F, M = np.array([0.0, 0.0, 2.0]), np.array([4.0, 0.0, 6.0])
        at = Wrench(F, M).reduced()
        printed = np.cross(M, F) / dot(F, F)
        np.testing.assert_array_equal(printed, -at.axis_point)
        np.testing.assert_array_equal(np.cross(at.axis_point, F) + at.pitch * F, M)
        wrong = np.cross(printed, F) + at.pitch * F
        np.testing.assert_array_equal(wrong, [-4.0, 0.0, 6.0])

    def test_a_screw_motion_has_its_axis_where_nothing_moves_but_along_it(self):
        # Turn at 2 rad/s about the axis through (1, 0, 0) along z, advance 3 m/s.
        twist = Twist(np.array([0.0, 0.0, 2.0]), np.array([0.0, -2.0, 3.0]))
        at = twist.reduced()
        np.testing.assert_array_equal(at.axis_point, [1.0, 0.0, 0.0])
        assert at.pitch == 1.5
        np.testing.assert_array_equal(twist.moved_to(at.axis_point).linear, [0.0, 0.0, 3.0])
