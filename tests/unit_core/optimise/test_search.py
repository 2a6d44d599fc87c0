"""The global search on functions with known maxima, and on simulated conveying velocity."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.motions import planar_motion
from vibrafeed.core.intake import parse_study
from vibrafeed.core.optimise.codes import STATUS
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.optimise.prepare import prepare
from vibrafeed.core.optimise.problem import chosen_cells
from vibrafeed.core.optimise.run import designs_of
from vibrafeed.core.optimise.search import MESSAGES, search_maximum
from vibrafeed.core.watch import Watch

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
    # The last population is narrower than 1e-6 of the box, and the maximum lies within it or near.
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


def test_a_narrow_peak_on_an_edge():
    # 0.004 wide: next to none of the first points lies on it.
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
    # Only the order of values counts.
    one = search(infeasible, np.zeros(2), np.ones(2))
    two = search(lambda u: 8 * infeasible(u), np.zeros(2), np.ones(2))
    assert (one.point == two.point).all()


@pytest.mark.parametrize("budget", [400, 1000, 3000, 20_000])
@pytest.mark.parametrize("d", [1, 2, 3, 4])
def test_the_budget_holds(budget, d):
    found = search(hills, np.zeros(d), np.ones(d), budget=budget)
    assert found.evaluations <= budget
    assert found.status in ("converged", "budget_spent")


def test_other_random_numbers_find_the_same_maximum():
    one, two = (search(hills, np.zeros(2), np.ones(2), seed=seed) for seed in (0, 1))
    assert (one.point != two.point).any()
    assert one.point == pytest.approx(two.point, abs=3e-6)


@pytest.mark.parametrize(
    ("top", "upper"),
    [([0.2, 0.3], [1.0, 1.0]), ([0.8, 0.1], [1.2, 0.5]), ([0.5, 0.99], [0.6, 1.0])],
)
def test_hills_in_boxes_of_other_shapes(top, upper):
    found = search(lambda u: hills(u - top + 0.637), np.zeros(2), np.array(upper))
    assert found.point == pytest.approx(np.minimum(top, upper), abs=5e-6)


def conveyed(friction, method="search", **more):
    """Return the prepared study of the fastest motion, and its designs with their scales."""
    content = {
        "kind": "optimise",
        "scene": "cylinder-on-plane",
        "method": method,
        "criterion": {"kind": "maximise", "output": "conveying_velocity"},
        "variables": {"beta": {"lower": 0, "upper": 90}},
        "parameters": {"frequency": 60, "amplitude": "0.5 mm", "friction": friction, **more},
    }
    prepared = prepare(parse_study(content))
    design = designs_of(prepared.problem, prepared.designs)
    return prepared.problem, design, prepared.problem.scales(design)


def test_a_design_gets_the_same_bytes_alone_in_any_order_and_on_any_threads():
    problem, design, scales = conveyed([0.2, 0.35, 0.5])
    solve = METHODS["search"].solve
    found = solve(problem, design, scales, Watch())
    assert (found.status == STATUS["optimal"]).all()
    for order, threads in (([2, 0, 1], 1), ([1], 3)):
        parts = chosen_cells(design, order), chosen_cells(scales, order)
        again = solve(problem, *parts, Watch(threads=threads))
        assert again.x.tobytes() == found.x[:, order].tobytes()
        assert (again.evaluations == found.evaluations[order]).all()


def test_a_search_of_designs_that_is_stopped_keeps_those_that_are_finished():
    problem, design, scales = conveyed([0.2, 0.35])
    seen = []

    def stop():
        return sum(seen) > 0.51

    watch = Watch(stop=stop, progress=seen.append)  # the first is half
    found = METHODS["search"].solve(problem, design, scales, watch)
    assert found.status.tolist() == [STATUS["optimal"], STATUS["not_computed"]]
    assert 0.51 < sum(seen) < 1


@pytest.mark.parametrize("scene", ["rectangle-on-plane", "cylinder-on-plane"])
def test_a_search_that_is_stopped_amid_a_design_leaves_it_not_computed(scene):
    asked = []

    def stop():
        asked.append(0)
        return len(asked) > 5

    criterion = {"kind": "maximise"}
    if scene == "cylinder-on-plane":
        criterion["output"] = "conveying_velocity"
    content = {
        "kind": "optimise",
        "scene": scene,
        "method": "search",
        "criterion": criterion,
        "parameters": {"frequency": 60, "amplitude": "0.5 mm", "friction": 0.3},
    }
    if scene == "cylinder-on-plane":
        content["variables"] = {"beta": {"lower": 0, "upper": 90}}
    prepared = prepare(parse_study(content))
    design = designs_of(prepared.problem, prepared.designs)
    scales = prepared.problem.scales(design)
    found = METHODS["search"].solve(prepared.problem, design, scales, Watch(stop=stop))
    assert found.status.tolist() == [STATUS["not_computed"]]
    assert np.isnan(found.x).all()


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
    ([0.0] * 9, [1.0] * 9, {}),
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
        max_periods=np.asarray(1000.0),
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
