"""The search of all designs at once, by known maxima, and what it keeps of chance."""

import numpy as np
import pytest

from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.optimise.optima import designs_of
from vibrafeed.core.optimise.prepare import prepare
from vibrafeed.core.optimise.problem import STATUS, chosen_cells
from vibrafeed.core.optimise.search import Candidates, _trial_points, best_points, most_reliable
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


PLANE = {"scene": "rectangle-on-plane", "criterion": {"kind": "maximise"}}
DRIVE = {"frequency": 60, "amplitude": "0.5 mm"}
MOTION = {
    "scene": "cylinder-on-plane",
    "criterion": {"kind": "maximise", "output": "conveying_velocity"},
    "variables": {"beta": {"lower": 0, "upper": 90}},
}


def prepared(content, method="search"):
    """Return the problem of a study, its designs and their scales."""
    study = prepare(parse_study({"kind": "optimise", "method": method, **content}))
    design = designs_of(study.problem, study.designs)
    return study.problem, design, study.problem.scales(design)


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


def peak(u):
    return np.exp(-(((u[:, 0] - 0.4321) / 0.002) ** 2)) * u[:, 1]


def corner(u):
    return u @ np.arange(1.0, u.shape[1] + 1)


@pytest.mark.parametrize(
    ("function", "d", "place", "value"),
    [
        # A value that is equal to rounding ends the search: its square root in the point.
        *((bowl, d, np.full(d, 0.3712), 0.0) for d in (1, 2, 4)),
        *((hills, d, np.full(d, 0.637), 0.0) for d in (1, 3)),
        # 0.004 wide: next to none of the first points lies on it.
        (peak, 2, [0.4321, 1.0], 1.0),
    ],
)
def test_a_known_maximum(function, d, place, value):
    point, found, told = search(function, d)
    assert told.done.all()
    assert point[:, 0] == pytest.approx(place, abs=1e-6)
    assert found[0] == pytest.approx(value, abs=1e-9)


@pytest.mark.parametrize("d", [1, 4])
def test_corners_and_edges_are_met_exactly(d):
    assert (search(corner, d)[0] == 1).all()
    assert (search(lambda u: -corner(u), d)[0] == 0).all()


def test_a_maximum_at_a_jump_is_approached_from_the_better_side():
    _, value, _ = search(cliff, 2)
    assert 1.1234 - 1e-8 <= value[0] < 1.1234  # the supremum is not attained


def test_a_maximum_at_the_edge_of_what_has_values():
    point, value, _ = search(infeasible, 2)
    assert -1e-8 <= value[0] <= 0
    assert point[0, 0] == pytest.approx(0.62, abs=2e-4)  # the value is flat there, 0.5 du^2


def test_points_that_have_met_stay_where_they_are():
    met = Candidates(np.full((2, 3, 8), 0.4), *np.zeros((3, 3, 8)))
    assert _trial_points(met, np.random.default_rng(1)) == pytest.approx(met.unit)


def test_the_scale_of_an_output_is_its_largest_size_within_the_bounds():
    throw = {"criterion": {"kind": "maximise", "output": "throw_number"},
             "variables": {"amplitude": {"lower": "0.1 mm", "upper": "0.3 mm"}},
             "parameters": {"frequency": 50, "beta": 30, "friction": 0.3}}  # fmt: skip
    *_, scales = prepared({**PLANE, **throw})
    assert scales["throw_number"] == pytest.approx(3e-4 * (100 * np.pi) ** 2 / 2 / 9.80665)


@pytest.mark.parametrize("nothing", [np.nan, -np.inf])
def test_no_values_at_all(nothing):
    _, value, found = search(lambda u: np.full(len(u), nothing), 2)
    assert found.done.all()
    assert (value[0], found.best.violation[0, 0]) == (-np.inf, np.inf)


def test_a_search_repeats_to_the_last_digit_alone_and_among_others():
    alone, among = (search(hills, 2, cells=cells)[0] for cells in (1, 3))
    assert (alone == among).all()


def test_values_with_errors_are_chosen_by_the_caller():
    """Of all points that were judged; each such design is searched by itself."""

    def judge(unit, numbers):
        value = np.broadcast_to(-((unit[0] - 0.3) ** 2), unit.shape[1:])
        error = np.where((numbers == 1)[:, None], 1.0, np.zeros(value.shape))
        return Candidates(unit, np.zeros(value.shape), value, error)

    asked = []
    found = best_points(
        judge,
        1,
        3,
        Watch(),
        choose=lambda points, cell: asked.append((cell, points.value.size)) or 7,
    )
    assert asked == [(1, found.evaluations[1])]
    one, two, three = found.best.unit[0, :, 0]
    assert [one, three] == pytest.approx([0.3, 0.3], abs=1e-7)
    assert abs(two - 0.3) > 1e-3


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


def test_a_design_gets_the_same_bytes_alone_in_any_order_and_on_any_threads():
    problem, design, scales = prepared(
        {**PLANE, **MOTION, "parameters": {**DRIVE, "friction": [0.2, 0.5]}}
    )
    solve = METHODS["search"].solve
    found = solve(problem, design, scales, Watch())
    assert (found.status == STATUS["optimal"]).all()
    for order, threads in (([1, 0], 1), ([1], 3)):
        parts = chosen_cells(design, order), chosen_cells(scales, order)
        again = solve(problem, *parts, Watch(threads=threads))
        assert again.x.tobytes() == found.x[:, order].tobytes()
        assert (again.evaluations == found.evaluations[order]).all()


@pytest.mark.parametrize(
    ("more", "method"),
    [({}, "search"), (MOTION, "search"), (MOTION, "scipy")],
)
def test_a_search_that_is_stopped_amid_a_design_leaves_it_not_computed(more, method):
    """Its last points have no value, since they were not followed: nothing is known of it."""
    problem, design, scales = prepared(
        {**PLANE, **more, "parameters": {**DRIVE, "friction": 0.3}}, method
    )
    looks = iter([False] * 5)
    watch = Watch(stop=lambda: next(looks, True))
    found = METHODS[method].solve(problem, design, scales, watch)
    assert found.status.tolist() == [STATUS["not_computed"]]
    assert np.isnan(found.x).all()


NOISE = 0.2


class Noisy:
    """A hill, or other values, under noise below 0.85 and exactly known from there on."""

    lower, upper = np.zeros(1), np.ones(1)

    def __init__(self, true=lambda x: 1.0 - (x - 0.7) ** 2, noise=NOISE):
        self.true, self.noise = true, noise

    def from_unit_box(self, unit):
        return unit

    def longer(self, times):
        assert times > 1
        return Noisy(self.true, NOISE / 100)

    def judged(self, x, design, scales):
        del design, scales
        doubt = np.where(x[0] < 0.85, self.noise, 0.0)
        chance = np.random.default_rng(3).uniform(-1, 1, x[0].size) if self.noise == NOISE else 0.0
        return self.true(x[0]) + doubt * chance, np.zeros(x[0].size), doubt


def kept_of(problem, unit, beyond=None):
    """Return the values of all points, the place of the one that is kept, and its value."""
    value, within, doubt = problem.judged(unit, {}, {})
    judged = value, within if beyond is None else beyond, doubt
    return value, *most_reliable(problem, unit, judged, {}, {})


UNIT = np.linspace(0, 1, 2000)[None]


def test_the_luckiest_point_is_not_kept():
    problem = Noisy()
    value, place, kept = kept_of(problem, UNIT)
    assert value.max() > 1.1
    assert kept == problem.true(UNIT[0, place])
    # 32 niches of 2,000/128 points each: the best of them is near the top of the hill.
    assert kept > max(0.99, problem.true(UNIT[0, value.argmax()]))
    _, place, _ = kept_of(problem, UNIT, beyond=np.where(UNIT[0] > 0.4, 1.0, 0.0))
    assert UNIT[0, place] <= 0.4  # what breaks a constraint is not kept


def test_a_known_value_beats_lucky_ones_that_do_not_stand():
    value, place, kept = kept_of(Noisy(lambda x: np.where(x < 0.85, 0.5, 0.6)), UNIT)
    assert UNIT[0, value.argmax()] < 0.85 <= UNIT[0, place]
    assert kept == 0.6
