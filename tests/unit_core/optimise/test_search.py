"""The global search on functions with known maxima, and on simulated conveying velocity."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.motions import planar_motion
from core.optimise.search import MESSAGES, search_maximum
from core.watch import Watch

BUDGET = 6000


def search(f, lower, upper, budget=BUDGET, **more):
    """Search; check what holds of every answer: the budget, the box, the value at the point."""
    spent = []

    def counted(points):
        assert points.shape[1] == len(lower)
        assert (points >= lower).all()
        assert (points <= upper).all()
        spent.append(len(points))
        return f(points)

    found = search_maximum(counted, lower, upper, budget=budget, **more)
    assert found.evaluations == sum(spent) <= budget
    assert found.levels == len(spent)
    assert found.message == MESSAGES[found.status]
    if math.isfinite(found.value):
        assert f(found.point[None])[0] == found.value
    return found


# --- functions with known maxima; each returns values at points (n, d)


def bowl(u):
    return -np.sum((u - 0.3712) ** 2, axis=1)


def hills(u):
    """Fifty hills and more; the highest, of width 0.1, at 0.637 (Rastrigin's function)."""
    x = (u - 0.637) * 10
    return -np.sum(x * x + 10 * (1 - np.cos(2 * np.pi * x)), axis=1)


def cliff(u):
    """A plane that breaks off along a slanted line; the largest values lie on the brink."""
    along = u[:, 0] - u[:, 1]
    return np.where(u.sum(axis=1) < 1.1234, u.sum(axis=1) - (along - 0.2) ** 2, 0.0)


def infeasible(u):
    """No value beyond a curve, values that rise towards it; the best at u0 = 0.62."""
    edge = 0.3 + 0.4 * u[:, 0] + 0.1 * np.sin(3 * u[:, 0])
    value = 5 * (u[:, 1] - edge) - 0.5 * (u[:, 0] - 0.62) ** 2
    return np.where(u[:, 1] <= edge, value, np.nan)


def corner(u):
    return u @ np.arange(1.0, u.shape[1] + 1)


@pytest.mark.parametrize("d", [1, 2, 3, 4])
def test_a_smooth_maximum(d):
    found = search(bowl, np.zeros(d), np.ones(d), budget=20_000)
    assert found.status == "converged"
    # The last cloud is smaller than 1e-6 of the box; its best is nearer than the cloud is wide.
    assert found.point == pytest.approx(np.full(d, 0.3712), abs=3e-6)


@pytest.mark.parametrize("d", [1, 2])
def test_the_highest_of_many_hills(d):
    found = search(hills, np.zeros(d), np.ones(d))
    assert found.point == pytest.approx(np.full(d, 0.637), abs=3e-6)


def test_a_maximum_at_a_jump_is_approached_from_the_better_side():
    found = search(cliff, np.zeros(2), np.ones(2))
    # The supremum, 1.1234, is not attained. The brink is not searched for beyond the tolerance.
    assert 1.1234 - 1e-5 <= found.value < 1.1234
    assert found.drop > 1


def test_a_maximum_at_the_edge_of_what_has_values():
    found = search(infeasible, np.zeros(2), np.ones(2), budget=20_000)
    assert -1e-5 <= found.value <= 0
    assert found.point[0] == pytest.approx(0.62, abs=5e-3)  # the value is flat there, 0.5 du^2
    assert found.drop == math.inf


@pytest.mark.parametrize("d", [1, 2, 3, 4])
def test_corners_and_edges_are_met_exactly(d):
    lower, upper = np.full(d, 0.1), np.full(d, 0.7)
    assert (search(corner, lower, upper).point == upper).all()
    assert (search(lambda u: -corner(u), lower, upper).point == lower).all()


def test_a_peak_on_an_edge_narrower_than_the_cells():
    # 0.004 wide; the cells of the grid of the box are 0.02 wide, those of the edge 0.003.
    found = search(
        lambda u: np.exp(-(((u[:, 0] - 0.4321) / 0.002) ** 2)) * u[:, 1], np.zeros(2), np.ones(2)
    )
    assert found.point == pytest.approx([0.4321, 1.0], abs=1e-6)


def test_a_flat_function():
    found = search(lambda u: np.full(len(u), 2.5), np.zeros(2), np.ones(2))
    assert (found.status, found.value, found.drop) == ("flat", 2.5, 0.0)


@pytest.mark.parametrize("nothing", [np.nan, np.inf, -np.inf])
def test_no_values_at_all(nothing):
    found = search(lambda u: np.full(len(u), nothing), np.zeros(2), np.ones(2))
    assert found.status == "no_value"
    assert math.isnan(found.value)
    assert np.isnan(found.point).all()


def test_a_box_of_one_point():
    found = search(bowl, np.full(3, 0.5), np.full(3, 0.5))
    assert found.evaluations == 1
    assert (found.point == 0.5).all()


def test_a_held_variable_costs_nothing():
    found = search(bowl, np.array([0.0, 0.5, 0.0]), np.array([1.0, 0.5, 1.0]))
    alone = search(lambda u: bowl(u) - (0.5 - 0.3712) ** 2, np.zeros(2), np.ones(2))
    assert found.point[[0, 2]] == pytest.approx(alone.point, abs=1e-12)
    assert found.point[1] == 0.5


# --- laws


def test_a_search_repeats_to_the_last_digit():
    one, two = (search(hills, np.zeros(2), np.ones(2)) for _ in range(2))
    assert (one.point == two.point).all()
    assert one[1:] == two[1:]


def test_what_keeps_the_order_of_values_keeps_the_answer():
    # After the grid only the order of values counts; a linear change keeps the grid's choice too.
    one = search(infeasible, np.zeros(2), np.ones(2))
    two = search(lambda u: 8 * infeasible(u), np.zeros(2), np.ones(2))
    assert (one.point == two.point).all()


@pytest.mark.parametrize("budget", [400, 1000, 3000, 20_000])
@pytest.mark.parametrize("d", [1, 2, 3, 4])
def test_the_budget_holds(budget, d):
    found = search(hills, np.zeros(d), np.ones(d), budget=budget)
    assert found.evaluations <= budget
    assert found.status in ("converged", "budget_spent")


def test_designs_side_by_side_are_those_alone():
    tops = np.array([[0.2, 0.3], [0.8, 0.1], [0.5, 0.99]])
    lower, upper = np.zeros((3, 2)), np.array([[1.0, 1.0], [1.2, 0.5], [0.6, 1.0]])

    def many(design, points):
        return hills(points - tops[design] + 0.637)

    together = search_many(many, lower, upper, budget=BUDGET)
    for number, found in enumerate(together):
        alone = search_maximum(
            lambda u, number=number: many(np.full(len(u), number), u),
            lower[number],
            upper[number],
            budget=BUDGET,
        )
        assert found.point == pytest.approx(alone.point, abs=1e-12)
        assert found.evaluations == alone.evaluations
        assert found.point == pytest.approx(np.minimum(tops[number], upper[number]), abs=5e-6)


def test_a_search_can_be_stopped():
    asked = []

    def stop():
        asked.append(0)
        return len(asked) > 3

    found = search(bowl, np.zeros(2), np.ones(2), watch=Watch(stop=stop))
    assert found.status == "stopped"
    assert math.isfinite(found.value)
    early = search(bowl, np.zeros(2), np.ones(2), watch=Watch(stop=lambda: True))
    assert (early.status, early.evaluations) == ("stopped", 0)
    assert math.isnan(early.value)


@pytest.mark.parametrize(("lower", "upper", "more"), [
    ([0.0], [1.0, 2.0], {}), ([1.0], [0.0], {}), ([0.0], [math.nan], {}),
    ([0.0] * 5, [1.0] * 5, {}),
    ([0.0], [1.0], {"budget": 10}), ([0.0], [1.0], {"tolerance": 0.0}),
])  # fmt: skip
def test_wrong_requests_are_refused(lower, upper, more):
    with pytest.raises(ValueError, match=r"shapes|order|variables|budget|tolerance"):
        search_maximum(bowl, lower, upper, **{"budget": BUDGET, **more})


def test_values_of_another_shape_are_refused():
    with pytest.raises(ValueError, match="shape"):
        search_maximum(lambda u: u, [0.0, 0.0], [1.0, 1.0], budget=BUDGET)


# --- simulated motion


def conveying(points):
    """Return the velocity in metres per second at beta and amplitude, at 60 Hz, up to throw 3."""
    beta, amplitude = points.T
    w, mu, gamma = 2 * math.pi * 60, 0.35, math.radians(2)
    drive = amplitude * w * w / 9.81
    kept = drive * np.sin(beta) <= 3 * math.cos(gamma)
    motion = planar_motion(
        drive_number_along=(drive * np.cos(beta))[kept],
        drive_number_normal=(drive * np.sin(beta))[kept],
        gravity_number_along=np.asarray(math.sin(gamma)),
        gravity_number_normal=np.asarray(math.cos(gamma)),
        friction_static=np.asarray(mu),
        friction_kinetic=np.asarray(mu),
        restitution=np.asarray(0.0),
        tolerance=np.asarray(1e-12),
        most_periods=np.asarray(1000.0),
    )
    values = np.full(len(points), np.nan)
    values[kept] = motion.velocity * 9.81 / w
    return values


def test_simulated_velocity_against_a_grid():
    lower, upper = np.array([math.radians(1), 2e-5]), np.array([math.radians(89), 2e-3])
    axes = np.linspace(lower, upper, 200).T
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    best = np.nanmax(conveying(grid))
    found = search(conveying, lower, upper, budget=8000)
    assert found.value >= best * (1 - 1e-3)  # the bar; the search is as a rule above the grid
    # No speed of the part exceeds that of the track.
    assert found.value <= found.point[1] * 2 * math.pi * 60 * math.cos(found.point[0])
