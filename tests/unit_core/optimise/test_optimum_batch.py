"""The compiled batch solver: against the exact forms, against searches, and under any bounds."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from vibrafeed.core.optimise import newton
from vibrafeed.core.optimise.codes import ACTIVE, STATUS
from vibrafeed.core.optimise.families.plane_physical import plane_physical_fastest
from vibrafeed.core.optimise.families.plane_thesis import plane_thesis_limited
from vibrafeed.core.optimise.families.track_physical import track_physical_fastest
from vibrafeed.core.optimise.families.track_printed import track_fastest
from vibrafeed.core.optimise.kernels import columns as kernel
from vibrafeed.core.optimise.newton import BATCHED, fastest
from vibrafeed.core.quantities import OPTIMUM_STATUSES

RANDOM = np.random.default_rng(51)
DESIGNS = 1000
GRAVITY = 9.81
RIGHT = np.pi / 2

CLIMB = RANDOM.uniform(-0.3, 0.5, DESIGNS)
LEAN = RANDOM.uniform(0.0, 0.5, DESIGNS)
P = GRAVITY * 10 ** RANDOM.uniform(-0.7, 1.2, DESIGNS)
MU = RANDOM.uniform(0.02, 1.2, DESIGNS)
MU_S = MU * np.where(RANDOM.random(DESIGNS) < 0.5, 1.0, RANDOM.uniform(1.0, 1.6, DESIGNS))
LIMIT = 10 ** RANDOM.uniform(-2, 1, DESIGNS)
PLANE = {
    "vibration_acceleration": P,
    "gravity_along": GRAVITY * np.sin(CLIMB),
    "gravity_normal": GRAVITY * np.cos(CLIMB),
    "friction_kinetic": MU,
}
TRACK = {
    **PLANE,
    "gravity_normal": GRAVITY * np.cos(CLIMB) * np.cos(LEAN),
    "gravity_across": GRAVITY * np.cos(CLIMB) * np.sin(LEAN),
}
ALPHAS = np.sort(RANDOM.uniform(-0.5, 1.7, (2, DESIGNS)), axis=0)
BETAS = np.sort(RANDOM.uniform(-0.2, 1.5, (2, DESIGNS)), axis=0)
BOUNDS = {
    "alpha_lower": ALPHAS[0],
    "alpha_upper": ALPHAS[1],
    "beta_lower": BETAS[0],
    "beta_upper": BETAS[1],
}


def agree(ours, theirs, value):
    """Assert that batch and exact answer agree."""
    np.testing.assert_array_equal(ours.status, theirs.status)
    found = np.isfinite(theirs.alpha)
    np.testing.assert_array_equal(np.isfinite(ours.alpha), found)
    np.testing.assert_array_equal(ours.active[found], theirs.active[found])
    np.testing.assert_allclose(ours.alpha, theirs.alpha, rtol=0, atol=1e-9)
    np.testing.assert_allclose(ours.beta, theirs.beta, rtol=0, atol=1e-9)
    gap = np.abs(ours.objective - value)[found] / P[found]
    assert gap.max(initial=0.0) < 1e-12
    # The first-order conditions in the code's own derivatives, not in those of the search.
    assert np.nanmax(ours.residual, initial=0.0) < 1e-9


@pytest.mark.parametrize("floor", [True, False])
@pytest.mark.parametrize("limit", [LIMIT, np.inf], ids=["limit", "no limit"])
def test_the_printed_plane_agrees_with_the_exact_forms(floor, limit):
    theirs = plane_thesis_limited(**PLANE, limit=limit, floor_contact=floor)
    ours = fastest("plane_thesis", **PLANE, limit=limit, floor_contact=floor)
    agree(ours, theirs, theirs.acceleration_x)
    np.testing.assert_allclose(ours.acceleration_y, theirs.acceleration_y, rtol=0, atol=1e-11)


@pytest.mark.parametrize("static", [MU, MU_S], ids=["one coefficient", "two"])
def test_the_physical_plane_agrees_with_the_exact_forms(static):
    theirs = plane_physical_fastest(**PLANE, friction_static=static)
    ours = fastest("plane_physical", **PLANE, friction_static=static)
    agree(ours, theirs, theirs.acceleration_x)


def test_the_search_agrees_with_the_exact_forms_without_its_short_cut():
    """Bounds just inside the default ones keep the kernel from the straight answer."""
    theirs = plane_physical_fastest(**PLANE, friction_static=MU_S)
    inside = {"alpha_lower": 1e-12, "alpha_upper": 1.5707}
    ours = fastest("plane_physical", **PLANE, friction_static=MU_S, **inside)
    np.testing.assert_array_equal(ours.status, theirs.status)
    np.testing.assert_allclose(ours.alpha, theirs.alpha, rtol=0, atol=1e-9)
    np.testing.assert_allclose(ours.beta, theirs.beta, rtol=0, atol=1e-9)
    np.testing.assert_allclose(ours.objective, theirs.acceleration_x, rtol=0, atol=1e-10)


def test_turned_drives_agree_with_the_exact_forms():
    """Close to the limit of motion on steep tracks there can be two maxima."""
    count = 20_000  # the rarer kinds of optimum are one in a thousand
    random = np.random.default_rng(8)
    steep, mu = random.uniform(0.0, 1.4, count), random.uniform(0.02, 1.2, count)
    mu_s = mu * np.where(random.random(count) < 0.3, 1.0, random.uniform(1.0, 1.6, count))
    needed = np.hypot(np.sin(steep), mu_s * np.cos(steep) / np.hypot(1.0, mu_s))
    given = {
        "vibration_acceleration": GRAVITY * needed * random.uniform(0.98, 1.5, count),
        "gravity_along": GRAVITY * np.sin(steep),
        "gravity_normal": GRAVITY * np.cos(steep),
        "friction_kinetic": mu,
        "friction_static": mu_s,
    }
    theirs = plane_physical_fastest(**given)
    ours = fastest("plane_physical", **given)
    assert np.sum(theirs.alpha > 0) > 5000
    assert np.sum((theirs.alpha > 0) & (theirs.status == STATUS["not_attained"])) > 20
    np.testing.assert_array_equal(ours.status, theirs.status)
    np.testing.assert_allclose(ours.objective, theirs.acceleration_x, rtol=0, atol=1e-12 * GRAVITY)
    # Where the maximum over alpha parts from alpha = 0 it is flat: 1e-9 off such a point, less at.
    off = np.abs(ours.alpha - theirs.alpha)
    assert np.nanquantile(off, 0.99) < 1e-9
    assert np.nanmax(off) < 1e-6


@pytest.mark.parametrize("variant", ["thesis", "derived"])
@pytest.mark.parametrize("contact", [True, False])
def test_the_track_agrees_with_the_exact_forms(variant, contact):
    given = {name: values for name, values in TRACK.items() if name != "gravity_normal"}
    theirs = track_fastest(variant=variant, **given, wall_contact=contact)
    ours = fastest(f"track_{variant}", **TRACK, wall_contact=contact)
    agree(ours, theirs, theirs.acceleration_x)


def test_the_physical_track_agrees_with_the_exact_forms():
    theirs = track_physical_fastest(**TRACK, friction_static=MU)
    ours = fastest("track_physical", **TRACK, friction_static=MU)
    agree(ours, theirs, theirs.acceleration_x)


def objective(problem, alpha, beta):
    """Return the objective, -inf outside the limits; the formulas of theory 3 and 4 once more."""
    p, c, mu, mu_s, limit = (part[:, None] for part in (P, TRACK["gravity_along"], MU, MU_S, LIMIT))
    G, gy = TRACK["gravity_normal"][:, None], TRACK["gravity_across"][:, None]
    x, y = p * np.cos(beta) * np.cos(alpha) - c, p * np.cos(beta) * np.sin(alpha)
    n, s = G - p * np.sin(beta), gy - y
    keeps = n >= 0
    if problem == "plane_thesis":
        value, keeps = x - mu * n, keeps & (np.abs(y - mu * n) <= limit)
    elif problem == "plane_physical":
        size = np.hypot(x, y)
        left = 1 - mu * n / size
        value = x * left
        keeps = keeps & (np.abs(y * left) <= limit) & (x > 0) & (size > mu_s * n)
    elif problem == "track_derived":
        value, keeps = x - mu * s, keeps & (s >= 0)
    else:
        value = x - mu * (n + s)
        keeps = keeps & (s >= 0) & (x > mu_s * (n + s))
    return np.where(keeps, value, -np.inf)


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    "problem", ["plane_thesis", "plane_physical", "track_derived", "track_physical"]
)
def test_under_any_bounds_no_random_or_nearby_point_is_better(problem):
    ours = fastest(problem, **TRACK, friction_static=MU_S, limit=LIMIT, **BOUNDS)
    low, high = np.stack([ALPHAS[0], BETAS[0]]), np.stack([ALPHAS[1], BETAS[1]])
    # 2000 points anywhere, 2000 around the answer at all scales.
    spread = RANDOM.random((2, DESIGNS, 2000))
    anywhere = low[..., None] + (high - low)[..., None] * spread
    top = np.nan_to_num(np.stack([ours.alpha, ours.beta]))[..., None]
    steps = 10 ** RANDOM.uniform(-7, 0, (1, DESIGNS, 2000)) * RANDOM.normal(size=(2, DESIGNS, 2000))
    nearby = np.clip(top + steps, low[..., None], high[..., None])
    best = np.full(DESIGNS, -np.inf)
    for points in (anywhere, nearby):
        best = np.maximum(best, objective(problem, *points).max(axis=1))
    found = np.isfinite(ours.alpha)
    assert 200 < found.sum() < DESIGNS
    assert np.all(np.isneginf(best[~found]))
    # Contacts are kept to rounding; a point that oversteps by it may gain as much.
    assert np.all(ours.objective[found] >= (best - 1e-12 * (P + GRAVITY))[found])
    inside = ours.alpha[found], ours.beta[found]
    assert np.all((inside[0] >= ALPHAS[0][found]) & (inside[0] <= ALPHAS[1][found]))
    assert np.all((inside[1] >= BETAS[0][found]) & (inside[1] <= BETAS[1][found]))
    kept = -1e-12 * (P + GRAVITY)
    assert np.all(ours.floor_margin[found] >= kept[found])
    if problem.startswith("plane"):
        assert np.all(ours.across_margin[found] >= 100 * kept[found])
    else:
        assert np.all(ours.wall_margin[found] >= kept[found])
    assert np.nanmax(ours.residual) < 1e-7


def test_multipliers_are_what_a_wider_limit_gains():
    """Differences of the optimum itself over the limit, the floor's and the wall's load."""
    step = 1e-5
    for problem in ("plane_thesis", "track_physical"):
        ours = fastest(problem, **TRACK, limit=LIMIT, **BOUNDS)
        for price, bits in (
            (ours.across_price, ACTIVE["across_lower"] | ACTIVE["across_upper"]),
            (ours.floor_price, ACTIVE["floor"]),
            (ours.wall_price, ACTIVE["wall"]),
        ):
            inactive = (ours.active & bits) == 0
            np.testing.assert_array_equal(price[inactive & np.isfinite(price)], 0.0)
        before, after = (
            fastest(problem, **TRACK, limit=LIMIT + side * step, **BOUNDS).objective
            for side in (-1, 1)
        )
        slope = (after - before) / (2 * step)
        # A change of the active set within the step shows as a kink.
        smooth = np.isfinite(slope) & (ours.across_margin > -1)
        off = np.abs(slope - ours.across_price)[smooth]
        # Second differences of order step/P, with rounding over the step.
        assert np.quantile(off, 0.97) < 1e-4
        if problem == "plane_thesis":
            assert np.sum(ours.across_price > 0) > 50


def test_answers_depend_on_neither_threads_nor_order_nor_shape():
    # More designs than one piece of the kernel takes.
    many = {name: np.tile(values, 3) for name, values in TRACK.items()}
    for problem in BATCHED:
        one = fastest(problem, **many, limit=5.0, threads=1)
        two = fastest(problem, **many, limit=5.0, threads=2)
        turned = fastest(problem, **{n: v[::-1].copy() for n, v in many.items()}, limit=5.0)
        square = fastest(problem, **{n: v.reshape(3, DESIGNS) for n, v in many.items()}, limit=5.0)
        for a, b, c, d in zip(one, two, turned, square, strict=True):
            np.testing.assert_array_equal(a, b)
            np.testing.assert_array_equal(a, c[::-1])
            np.testing.assert_array_equal(a.reshape(3, DESIGNS), d)
        single = fastest(problem, **{name: float(v[0]) for name, v in TRACK.items()}, limit=5.0)
        assert single.alpha.shape == ()
        np.testing.assert_array_equal(single.alpha, one.alpha[0])


def test_what_has_no_answer_says_why():
    given = {
        "vibration_acceleration": 20.0,
        "gravity_along": 1.0,
        "gravity_normal": 9.7,
        "gravity_across": 0.5,
        "friction_kinetic": 0.3,
    }

    def status(problem, **changes):
        return int(fastest(problem, **{**given, **changes}).status)

    for problem in BATCHED:
        lean = {"gravity_across": -0.5} if problem == "track_thesis" else {}
        assert status(problem, **lean) == STATUS["optimal"]
        assert status(problem, alpha_lower=1.0, alpha_upper=0.5, **lean) == STATUS["infeasible"]
        assert status(problem, beta_lower=1.5, beta_upper=1.57, **lean) == STATUS["infeasible"]
        assert status(problem, vibration_acceleration=0.0, **lean) == STATUS["flat"]
        assert status(problem, vibration_acceleration=1e-320, **lean) == STATUS["flat"]
        assert status(problem, vibration_acceleration=0.5, **lean) == STATUS["no_motion"]
        for name in given:
            assert status(problem, **{**lean, name: np.nan}) == STATUS["invalid"]
            assert status(problem, **{**lean, name: np.inf}) == STATUS["invalid"]
        assert status(problem, limit=-1.0) == STATUS["invalid"]
        assert status(problem, limit=np.nan) == STATUS["invalid"]
        assert status(problem, friction_static=0.2) == STATUS["invalid"]
        assert status(problem, alpha_lower=-3.0, alpha_upper=3.0) == STATUS["invalid"]
        assert status(problem, beta_upper=2.0) == STATUS["invalid"]
    assert status("plane_thesis", limit=0.1, beta_lower=0.9, floor_contact=False) == 4
    assert status("track_thesis") == STATUS["infeasible"]
    assert status("track_thesis", wall_contact=False) == STATUS["optimal"]


@pytest.mark.parametrize("problem", BATCHED)
def test_whatever_the_numbers_it_ends_with_a_status(problem):
    random = np.random.default_rng(7)
    odd = np.array([0.0, -1.0, 1e-300, 1e-12, 1.0, RIGHT, 1e12, 1e300, np.inf, np.nan])
    names = [*TRACK, "friction_static", "limit", *BOUNDS]
    ours = fastest(problem, **{name: random.choice(odd, 20_000) for name in names})
    assert set(np.unique(ours.status)) <= {flag.value for flag in OPTIMUM_STATUSES.values()}
    bad = np.isin(ours.status, [STATUS["infeasible"], STATUS["invalid"]])
    assert np.all(np.isnan(ours.alpha[bad]))
    still = (ours.status == STATUS["no_motion"]) & (problem in ("plane_physical", "track_physical"))
    np.testing.assert_array_equal(np.isfinite(ours.alpha), ~(bad | still))


def test_a_fixed_angle_is_kept():
    """Equal bounds leave one angle; a half-plane of directions must not become a whole plane."""
    fixed = RANDOM.uniform(0.0, 1.7, DESIGNS)
    for problem in ("plane_thesis", "plane_physical", "track_derived"):
        ours = fastest(problem, **TRACK, wall_contact=False, alpha_lower=fixed, alpha_upper=fixed)
        found = np.isfinite(ours.alpha)
        np.testing.assert_array_equal(ours.alpha[found], fixed[found])
    beta = np.arange(0.0, RIGHT, 1e-3)
    ours = fastest("plane_thesis", **TRACK, alpha_lower=fixed, alpha_upper=fixed)
    p, c, mu = (part[:, None] for part in (P, TRACK["gravity_along"], MU))
    n = TRACK["gravity_normal"][:, None] - p * np.sin(beta)
    a = p * np.cos(beta) * np.cos(fixed[:, None]) - c - mu * n
    best = np.where(n >= 0, a, -np.inf).max(axis=1)
    # Half a step from the top; at lift-off up to a step from it.
    assert np.all(ours.objective >= best - 1e-12 * (P + GRAVITY))
    assert np.all(ours.objective <= best + 2e-3 * P * (1 + MU))


def test_the_kernel_numbers_its_columns_as_the_tables_do():
    assert len(newton.BatchOptimum._fields) - 2 == kernel.COLUMNS
    others = {"no_value", "not_computed", "suboptimal", "only_backward"}  # of studies alone
    for name in STATUS.keys() - others:
        assert getattr(kernel, name.upper()) == STATUS[name]
    for name, bit in ACTIVE.items():
        assert 1 << (getattr(kernel, name.upper()) - 1) == bit  # a row of margins for each


def test_importing_the_solver_does_not_load_the_compiler():
    code = "import sys, vibrafeed.core.optimise.newton; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
