"""The search of all designs at once: known maxima, and simulated conveying velocity."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.motions import planar_motion
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.optimise.optima import designs_of
from vibrafeed.core.optimise.prepare import prepare
from vibrafeed.core.optimise.problem import STATUS, chosen_cells
from vibrafeed.core.optimise.search import Candidates, best_points
from vibrafeed.core.watch import Watch


def search(f, d, *, watch=None, jumps=True, cells=1):
    """Return the best points (d, cells), their values, and what the search says."""

    def judge(unit, numbers):
        assert numbers.max() < cells
        assert ((unit >= 0) & (unit <= 1)).all()
        values = f(unit.reshape(d, -1).T).reshape(unit.shape[1:])
        lost = ~np.isfinite(values)
        return Candidates(unit, np.where(lost, np.inf, 0.0), np.where(lost, -np.inf, values),
                      np.zeros(values.shape))  # fmt: skip

    found = best_points(judge, d, cells, watch or Watch(), jumps=jumps)
    return found.best.unit[:, :, 0], found.best.value[:, 0], found


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
    point, value, found = search(bowl, d)
    assert found.done.all()
    # A value that is equal to rounding ends the search: its square root in the point.
    assert point[:, 0] == pytest.approx(np.full(d, 0.3712), abs=1e-7)
    assert value[0] == pytest.approx(0.0, abs=1e-14)


@pytest.mark.parametrize("d", [1, 2, 3])
def test_the_highest_of_many_hills(d):
    point, _, _ = search(hills, d)
    assert point[:, 0] == pytest.approx(np.full(d, 0.637), abs=1e-7)


def test_a_maximum_at_a_jump_is_approached_from_the_better_side():
    _, value, _ = search(cliff, 2)
    assert 1.1234 - 1e-8 <= value[0] < 1.1234  # the supremum is not attained


def test_a_maximum_at_the_edge_of_what_has_values():
    point, value, _ = search(infeasible, 2)
    assert -1e-8 <= value[0] <= 0
    assert point[0, 0] == pytest.approx(0.62, abs=2e-4)  # the value is flat there, 0.5 du^2


@pytest.mark.parametrize("d", [1, 2, 3, 4])
def test_corners_and_edges_are_met_exactly(d):
    assert (search(corner, d)[0] == 1).all()
    assert (search(lambda u: -corner(u), d)[0] == 0).all()


def test_a_narrow_peak_on_an_edge():
    # 0.004 wide: next to none of the first points lies on it.
    point, _, _ = search(lambda u: np.exp(-(((u[:, 0] - 0.4321) / 0.002) ** 2)) * u[:, 1], 2)
    assert point[:, 0] == pytest.approx([0.4321, 1.0], abs=1e-6)


@pytest.mark.parametrize("nothing", [np.nan, np.inf, -np.inf])
def test_no_values_at_all(nothing):
    _, value, found = search(lambda u: np.full(len(u), nothing), 2)
    assert found.done.all()
    assert value[0] == -np.inf
    assert found.best.beyond[0, 0] == np.inf


def test_a_search_repeats_to_the_last_digit_alone_and_among_others():
    alone, among = (search(hills, 2, cells=cells)[0] for cells in (1, 3))
    assert (alone == among).all()


def test_what_keeps_the_order_of_values_keeps_the_answer():
    one, two = (search(lambda u, k=k: k * infeasible(u), 2)[0] for k in (1, 8))
    assert (one == two).all()


def test_values_with_errors_are_chosen_by_the_caller():
    """Of all points that were judged; each such design is searched by itself."""

    def judge(unit, numbers):
        value = np.broadcast_to(-((unit[0] - 0.3) ** 2), unit.shape[1:])
        error = np.where((numbers == 1)[:, None], 1.0, np.zeros(value.shape))
        return Candidates(unit, np.zeros(value.shape), value, error)

    asked = []

    def choose(points, cell):
        asked.append((cell, points.value.size))
        return 7

    found = best_points(judge, 1, 3, Watch(), choose=choose)
    assert found.best.unit[0, [0, 2], 0] == pytest.approx([0.3, 0.3], abs=1e-7)
    ((cell, count),) = asked
    assert cell == 1
    assert count == found.evaluations[1]
    assert abs(found.best.unit[0, 1, 0] - 0.3) > 1e-3


@pytest.mark.parametrize("variant", ["thesis", "physical"])
def test_the_search_agrees_with_the_closed_forms(variant):
    scene = "rectangle-on-plane" if variant == "thesis" else "rectangle-on-track"
    content = {
        "kind": "optimise", "scene": scene, "variant": variant, "criterion": {"kind": "maximise"},
        "parameters": {
            "frequency": 60, "amplitude": ["0.1 mm", "0.3 mm"], "friction": [0.2, 0.5], "gamma": 3,
            **({} if variant == "thesis" else {"delta": 15}),
        },
    }  # fmt: skip
    exact, found = (
        run_study(parse_study({**content, "method": method})) for method in ("exact", "search")
    )
    assert (exact.optimum_status == found.optimum_status).all()
    np.testing.assert_allclose(found.objective, exact.objective, rtol=1e-11)
    assert np.abs(found.optimum_gap).max() < 1e-11  # what checks it is the closed form


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


@pytest.mark.by_day(2)
def test_simulated_velocity_against_a_grid():
    lower, upper = np.array([math.radians(1), 2e-5]), np.array([math.radians(89), 2e-3])
    axes = np.linspace(lower, upper, 200).T
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    best = np.nanmax(conveying(grid))
    point, value, _ = search(lambda u: conveying(lower + u * (upper - lower)), 2)
    assert value[0] >= best
    # No speed of the part exceeds that of the track.
    beta, amplitude = lower + point[:, 0] * (upper - lower)
    assert value[0] <= amplitude * 2 * math.pi * 60 * math.cos(beta)
