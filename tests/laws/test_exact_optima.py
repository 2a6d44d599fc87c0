"""The exact optima against searches that know nothing of them, and the laws they must obey."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from scipy import optimize

from vibrafeed.core.mechanics import floor, rolling, wall
from vibrafeed.core.optimise.best_angles import cylinder_physical_fastest, plane_physical_fastest
from vibrafeed.core.optimise.exact import (
    plane_thesis_limited,
    plane_thesis_pareto,
    plane_thesis_weighted,
    track_fastest,
    track_physical_fastest,
)
from vibrafeed.core.optimise.problem import STATUS
from vibrafeed.core.quantities import OPTIMUM_STATUSES

RANDOM = np.random.default_rng(1204)
DESIGNS = 1000
GRAVITY = 9.81
RIGHT = np.pi / 2
TOUCHING = 1e-12  # at the lift-off angle n0 is a rounding of either sign [m s-2]

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
# A drive close to the limit of motion on a climbing track: where the best drive may be turned.
STEEP = RANDOM.uniform(0.0, 1.4, DESIGNS)
STEEP_LIMIT = np.hypot(np.sin(STEEP), MU_S * np.cos(STEEP) / np.hypot(1.0, MU_S))
CLIMBING = {
    "vibration_acceleration": GRAVITY * STEEP_LIMIT * RANDOM.uniform(0.98, 1.5, DESIGNS),
    "gravity_along": GRAVITY * np.sin(STEEP),
    "gravity_normal": GRAVITY * np.cos(STEEP),
    "friction_kinetic": MU,
}


def without(given, *names):
    return {name: values for name, values in given.items() if name not in names}


def drive(given, alpha, beta):
    """Return D_x, D_y and n0 with the designs along the first axis of the angles."""
    extra = (1,) * (np.ndim(alpha) - 1)
    column = {name: values.reshape(-1, *extra) for name, values in given.items()}
    push = column["vibration_acceleration"] * np.cos(beta)
    return (
        push * np.cos(alpha) - column["gravity_along"],
        push * np.sin(alpha),
        column["gravity_normal"] - column["vibration_acceleration"] * np.sin(beta),
        column,
    )


def printed(given, alpha, beta):
    """Return a_x, a_y and n0 under the printed friction, from the formulas of the scenes."""
    x, y, n0, column = drive(given, alpha, beta)
    with_floor = {"friction_kinetic": column["friction_kinetic"], "normal_acceleration": n0}
    return (
        floor.per_axis_acceleration_x(in_plane_drive_x=x, **with_floor),
        floor.per_axis_acceleration_y(in_plane_drive_y=y, **with_floor),
        n0,
    )


def block(given, alpha, beta):
    """Return a_x of the friction disc, -inf without forward sliding on the floor."""
    x, y, n0, column = drive(given, alpha, beta)
    left = floor.sliding_fraction(
        in_plane_drive=np.hypot(x, y),
        friction_static=column["friction_static"],
        friction_kinetic=column["friction_kinetic"],
        floor_acceleration=np.maximum(n0, 0.0),
    )
    return np.where((n0 >= -TOUCHING) & (left > 0) & (x > 0), x * left, -np.inf)


def cylinder(given, alpha, beta):
    """Return a_x of the slipping cylinder, -inf without forward sliding on the floor."""
    x, y, n0, column = drive(given, alpha, beta)
    state = {
        "friction_kinetic": column["friction_kinetic"],
        "floor_acceleration": np.maximum(n0, 0),
    }
    z = rolling.roll_root(
        in_plane_drive_x=x, in_plane_drive_y=y, friction_static=column["friction_static"], **state
    )
    a = rolling.slipping_acceleration_x(in_plane_drive_x=x, roll_root=z, **state)
    return np.where((n0 >= -TOUCHING) & (z > 0) & (x > 0), a, -np.inf)


def searched(function, *, grid=61, rounds=22):
    """Return the best value of a grid over both angles, then of finer ones around the best."""
    low = np.zeros((2, DESIGNS))
    high = np.full((2, DESIGNS), RIGHT)
    best = np.full(DESIGNS, -np.inf)
    for number in range(rounds):
        steps = np.linspace(0.0, 1.0, grid if number == 0 else 13)
        at = low[..., None] + (high - low)[..., None] * steps
        values = function(at[0][:, :, None], at[1][:, None, :]).reshape(DESIGNS, -1)
        place = values.argmax(axis=1)
        best = np.maximum(best, values[np.arange(DESIGNS), place])
        i, j = np.unravel_index(place, (steps.size, steps.size))
        top = np.stack([at[0][np.arange(DESIGNS), i], at[1][np.arange(DESIGNS), j]])
        reach = (high - low) * (0.05 if number == 0 else 0.3)
        low, high = np.maximum(top - reach, 0.0), np.minimum(top + reach, RIGHT)
    return best


# A sum of half a dozen terms of the size of P or of gravity: some roundings.
ROUNDING = 1e-13 * (P + GRAVITY)


@pytest.mark.parametrize("floor", [True, False])
def test_no_point_of_a_search_beats_the_limited_optimum(floor):
    found = plane_thesis_limited(**PLANE, limit=LIMIT, floor_contact=floor)

    def inside(alpha, beta):
        a_x, a_y, n0 = printed(PLANE, alpha, beta)
        kept = (np.abs(a_y) <= LIMIT[:, None, None]) & ((n0 >= 0) | (not floor))
        return np.where(kept, a_x, -np.inf)

    best = searched(inside)
    infeasible = found.status == STATUS["infeasible"]
    assert np.all(np.isneginf(best[infeasible]))
    good = ~infeasible
    assert 100 < good.sum() < DESIGNS
    a_x, a_y, n0 = printed(PLANE, found.alpha, found.beta)
    np.testing.assert_array_less(np.abs(a_y[good]), (LIMIT + ROUNDING)[good])
    assert np.all(a_x[good] >= (best - ROUNDING)[good])
    np.testing.assert_allclose(found.acceleration_x[good], a_x[good], rtol=0, atol=ROUNDING.max())
    np.testing.assert_array_equal(found.status[good] == STATUS["no_motion"], a_x[good] <= 0)
    if floor:
        assert np.all(n0[good] >= -ROUNDING[good])


@pytest.mark.parametrize("floor", [True, False])
def test_no_random_step_improves_the_limited_optimum(floor):
    found = plane_thesis_limited(**PLANE, limit=LIMIT, floor_contact=floor)
    good = found.status != STATUS["infeasible"]
    size = 10 ** RANDOM.uniform(-7, 0, (DESIGNS, 1000))
    alpha = np.clip(found.alpha[:, None] + size * RANDOM.normal(size=size.shape), 0, RIGHT)
    beta = np.clip(found.beta[:, None] + size * RANDOM.normal(size=size.shape), 0, RIGHT)
    a_x, a_y, n0 = printed(PLANE, alpha, beta)
    kept = (np.abs(a_y) <= LIMIT[:, None]) & ((n0 >= 0) | (not floor))
    gain = np.where(kept, a_x, -np.inf) - found.acceleration_x[:, None]
    assert np.all(gain[good] <= ROUNDING[good, None])


def test_scipy_finds_no_more_on_the_epigraph_form():
    """SLSQP on max a_x with a_y <= E and a_y >= -E, from six starts."""
    found = plane_thesis_limited(**PLANE, limit=LIMIT, floor_contact=True)
    chosen = np.flatnonzero(found.status != STATUS["infeasible"])[:25]
    starts = [(a, b) for a in (0.1, 0.8, 1.4) for b in (0.1, 0.7)]
    for i in chosen:
        one = {name: values[i : i + 1] for name, values in PLANE.items()}

        def at(angles, one=one):
            return np.ravel(printed(one, angles[:1], angles[1:]))

        best = -np.inf
        for start in starts:
            answer = optimize.minimize(
                lambda angles, at=at, i=i: -at(angles)[0] / P[i],
                start,
                method="SLSQP",
                bounds=[(0, RIGHT)] * 2,
                constraints={
                    "type": "ineq",
                    "fun": lambda angles, at=at, i=i: (
                        np.array(
                            [LIMIT[i] - at(angles)[1], LIMIT[i] + at(angles)[1], at(angles)[2]]
                        )
                        / P[i]
                    ),
                },
                options={"ftol": 1e-14, "maxiter": 200},
            )
            a_x, a_y, n0 = at(np.clip(answer.x, 0, RIGHT))
            # What SLSQP oversteps by a millionth of P it may gain in a_x.
            if abs(a_y) <= LIMIT[i] + 1e-7 * P[i] and n0 >= -1e-7 * P[i]:
                best = max(best, a_x)
        # Its own tolerance, both ways: differences for gradients leave about 1e-6.
        assert abs(best - found.acceleration_x[i]) <= 1e-5 * P[i]


def test_the_closed_form_of_case_b_is_the_root_that_the_theory_states():
    found = plane_thesis_limited(**PLANE, limit=LIMIT, floor_contact=True)
    G = PLANE["gravity_normal"]
    chosen = np.flatnonzero((found.alpha > 0) & (found.status != STATUS["infeasible"]))
    assert chosen.size > 100
    with mpmath.workdps(40):
        for i in chosen[:60]:
            p, g, m, e = (mpmath.mpf(float(v[i])) for v in (P, G, MU, LIMIT))

            def left(a, p=p, g=g, m=m, e=e):
                ca, sa = mpmath.cos(a), mpmath.sin(a)
                top = p * (sa + m * m * (ca + sa))
                return top / mpmath.sqrt(1 + m * m * (1 + mpmath.sin(2 * a))) - m * g + e

            root = mpmath.findroot(left, (mpmath.mpf(0), mpmath.pi / 2), solver="anderson")
            elevation = mpmath.atan(m * (mpmath.cos(root) + mpmath.sin(root)))
            # At 90 deg the left side is flat: the root's condition is its slope's inverse.
            slope = abs(float(mpmath.diff(left, root) / p))
            assert abs(found.alpha[i] - float(root)) <= 1e-14 * (1 + (G / P)[i]) / slope
            assert abs(found.beta[i] - float(elevation)) <= 1e-14 * (1 + (G / P)[i])


def test_the_limit_gives_more_the_wider_it_is():
    limits = np.linspace(0.0, 15.0, 61)
    wide = {name: values[:, None] for name, values in PLANE.items()}
    found = plane_thesis_limited(**wide, limit=limits, floor_contact=False)
    a_x = np.where(found.status == STATUS["infeasible"], -np.inf, found.acceleration_x)
    later, earlier = a_x[:, 1:], a_x[:, :-1]
    assert np.all((later >= earlier - ROUNDING[:, None]) | np.isneginf(earlier))
    widest = plane_thesis_limited(**PLANE, limit=np.inf, floor_contact=False)
    np.testing.assert_array_less(a_x[:, -1], widest.acceleration_x + ROUNDING)


def test_angles_do_not_depend_on_the_scale_of_accelerations():
    for scale in (0.25, 64.0):  # powers of two: exactly the same numbers
        small = {
            name: values if name == "friction_kinetic" else values * scale
            for name, values in PLANE.items()
        }
        for function, extra in (
            (plane_thesis_limited, {"limit": LIMIT, "floor_contact": True}),
            (plane_physical_fastest, {"friction_static": MU_S}),
            (cylinder_physical_fastest, {"friction_static": MU_S}),
        ):
            here = function(**PLANE, **extra)
            if "limit" in extra:
                extra = {**extra, "limit": LIMIT * scale}
            there = function(**small, **extra)
            np.testing.assert_array_equal(here.alpha, there.alpha)
            np.testing.assert_array_equal(here.beta, there.beta)
            np.testing.assert_array_equal(here.status, there.status)
            np.testing.assert_array_equal(here.acceleration_x * scale, there.acceleration_x)


def test_the_switch_to_lift_off_is_where_the_theory_has_it():
    G, mu = 9.8, 0.35
    switch = G * np.sqrt(1 + mu * mu) / mu
    strong = np.array([0.999, 1.001]) * switch
    found = plane_thesis_limited(
        vibration_acceleration=strong,
        gravity_along=0.0,
        gravity_normal=G,
        friction_kinetic=mu,
        limit=np.inf,
        floor_contact=True,
    )
    np.testing.assert_allclose(found.beta, [np.arctan(mu), np.arcsin(G / strong[1])], rtol=1e-15)
    np.testing.assert_allclose(found.acceleration_x[1], np.sqrt(strong[1] ** 2 - G * G), rtol=1e-14)
    np.testing.assert_allclose(found.acceleration_y[1], 0.0, atol=1e-14)


@pytest.mark.parametrize("floor", [True, False])
def test_pareto_points_are_the_limited_optima_of_their_own_a_y(floor):
    front = plane_thesis_pareto(**PLANE, floor_contact=floor, points=21)
    a_x, a_y = front.acceleration_x, np.abs(front.acceleration_y)
    # None beats another in both: a_x falls along the set and so does |a_y|.
    assert np.all(np.diff(a_x, axis=1) <= ROUNDING[:, None])
    assert np.all(np.diff(a_y, axis=1) <= ROUNDING[:, None])
    wide = {name: values[:, None] for name, values in PLANE.items()}
    found = plane_thesis_limited(**wide, limit=a_y + ROUNDING[:, None], floor_contact=floor)
    assert np.all(found.acceleration_x >= a_x - ROUNDING[:, None])
    # The least |a_y| that can be, at 90 deg, is flat over alpha: there the slack shows as its root.
    inner = front.alpha < RIGHT - 1e-9
    for ours, theirs in ((found.alpha, front.alpha), (found.beta, front.beta)):
        np.testing.assert_allclose(ours[inner], theirs[inner], rtol=0, atol=1e-8)
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-5)


def test_pareto_sets_end_where_a_y_is_least():
    front = plane_thesis_pareto(**PLANE, floor_contact=True, points=5)
    reached = P * np.hypot(1.0, MU) >= MU * PLANE["gravity_normal"]
    last = front.acceleration_y[:, -1]
    np.testing.assert_allclose(last[reached], 0.0, atol=ROUNDING.max())
    assert np.all(last[~reached] < 0)
    np.testing.assert_allclose(front.alpha[~reached, -1], RIGHT, rtol=1e-7)
    # a_y = 0 at sin(alpha) = mu (G - P sb)/(P cb); 90 deg where it stays negative.
    push, lift = P * np.cos(front.beta[:, -1]), P * np.sin(front.beta[:, -1])
    least = np.arcsin(np.clip(MU * (PLANE["gravity_normal"] - lift), 0.0, push) / push)
    np.testing.assert_allclose(least, front.alpha[:, -1], rtol=0, atol=2e-7)


@pytest.mark.parametrize("floor", [True, False])
def test_no_point_of_a_search_beats_the_weighted_optimum(floor):
    weight = np.where(RANDOM.random(DESIGNS) < 0.2, 0.0, 10 ** RANDOM.uniform(-2, 1, DESIGNS))
    found = plane_thesis_weighted(**PLANE, weight=weight, floor_contact=floor)

    def value(alpha, beta):
        a_x, a_y, n0 = printed(PLANE, alpha, beta)
        w = weight.reshape(-1, *(1,) * (np.ndim(alpha) - 1))
        return np.where((n0 >= -TOUCHING) | (not floor), a_x - w * np.abs(a_y), -np.inf)

    got = found.acceleration_x - weight * np.abs(found.acceleration_y)
    slack = ROUNDING * (1 + weight)
    best = searched(value)
    assert np.all(got >= best - slack)
    np.testing.assert_allclose(value(found.alpha, found.beta), got, rtol=0, atol=slack.max())
    front = plane_thesis_pareto(**PLANE, floor_contact=floor, points=301)
    on_front = front.acceleration_x - weight[:, None] * np.abs(front.acceleration_y)
    assert np.all(got[:, None] >= on_front - slack[:, None])
    # It lies on the set: between two of its points, a 300th of its length away at most.
    near = np.hypot(front.alpha - found.alpha[:, None], front.beta - found.beta[:, None])
    assert np.all(near.min(axis=1) <= RIGHT / 300)


@pytest.mark.by_day(1)
@pytest.mark.parametrize("given", [PLANE, CLIMBING], ids=["any", "near the limit"])
@pytest.mark.parametrize(
    ("part", "function"),
    [(block, plane_physical_fastest), (cylinder, cylinder_physical_fastest)],
    ids=["block", "cylinder"],
)
def test_no_point_of_a_search_beats_the_physical_optimum(given, part, function):
    found = function(**given, friction_static=MU_S)
    given = {**given, "friction_static": MU_S}
    best = searched(lambda alpha, beta: part(given, alpha, beta), grid=41, rounds=14)
    moves = found.status != STATUS["no_motion"]
    assert np.all(np.isneginf(best[~moves]))
    assert np.all(found.acceleration_x[moves] >= (best - ROUNDING)[moves])
    assert np.all(np.isnan(found.alpha[~moves]))
    # It is attained, but at the edge of stick, where a_x is the limit from the sliding side.
    attained = found.status == STATUS["optimal"]
    at = part(given, found.alpha, found.beta)
    np.testing.assert_allclose(at[attained], found.acceleration_x[attained], rtol=1e-10, atol=1e-12)


def test_a_climbing_block_starts_from_the_side_before_it_starts_straight():
    """The limit of motion for a drive of any azimuth, and for alpha = 0, by a search over beta."""
    moved = plane_physical_fastest(**CLIMBING, friction_static=MU_S)
    push, c, G = (CLIMBING[name] for name in list(CLIMBING)[:3])
    beta = np.linspace(0, RIGHT, 20001)[:, None]
    floor = G - push * np.sin(beta)
    # A friction that points sideways leaves all of x to gravity: D_x -> 0, D_y = sqrt(q^2 - c^2).
    side = (push * np.cos(beta)) ** 2 - (MU_S * floor) ** 2 - c * c
    straight = push * np.cos(beta) - c - MU_S * floor
    from_side = np.max(np.where(floor >= 0, side, -np.inf), axis=0) > 0
    along = np.max(np.where(floor >= 0, straight, -np.inf), axis=0) > 0
    np.testing.assert_array_equal(moved.status != STATUS["no_motion"], from_side)
    assert np.all(from_side[along])
    assert (from_side & ~along).sum() > 100
    assert np.all(moved.alpha[from_side & ~along] > 0)


def test_a_horizontal_or_falling_block_has_no_trade_off():
    flat = {**PLANE, "gravity_along": -np.abs(PLANE["gravity_along"])}
    found = plane_physical_fastest(**flat, friction_static=MU)
    moves = found.status == STATUS["optimal"]
    np.testing.assert_array_equal(found.alpha[moves], 0.0)
    np.testing.assert_array_equal(found.acceleration_y[moves], 0.0)
    lift_off = np.arcsin(np.minimum(1.0, flat["gravity_normal"] / P))
    np.testing.assert_array_equal(found.beta[moves], np.minimum(np.arctan(MU), lift_off)[moves])


@pytest.mark.by_day(2)
@pytest.mark.parametrize("variant", ["thesis", "derived"])
@pytest.mark.parametrize("contact", [True, False])
def test_no_point_of_a_search_beats_the_track(variant, contact):
    given = without(TRACK, "gravity_normal")
    found = track_fastest(variant=variant, **given, wall_contact=contact)
    balance = wall.printed_wall_balance if variant == "thesis" else wall.derived_wall_balance
    start = (
        wall.printed_starting_acceleration
        if variant == "thesis"
        else wall.derived_starting_acceleration
    )

    def value(alpha, beta):
        x, y, _, column = drive(TRACK, alpha, beta)
        K = start(
            drive_along=x + column["gravity_along"],
            drive_across=y,
            gravity_along=column["gravity_along"],
            gravity_across=column["gravity_across"],
            friction_kinetic=column["friction_kinetic"],
        )
        room = balance(
            centripetal_acceleration=np.zeros(()),
            gravity_across=column["gravity_across"],
            drive_across=y,
        )
        return np.where((room >= -TOUCHING) | (not contact), K, -np.inf)

    best = searched(value)
    if variant == "thesis" and contact:
        assert np.all(found.status == STATUS["infeasible"])
        assert np.all(np.isneginf(best))
        return
    assert np.all(found.acceleration_x >= best - ROUNDING)
    at = value(found.alpha, found.beta)
    np.testing.assert_allclose(at, found.acceleration_x, rtol=0, atol=ROUNDING.max())
    np.testing.assert_array_equal(found.beta, 0.0)
    walled = TRACK["vibration_acceleration"] * np.sin(found.alpha) >= TRACK["gravity_across"] - 1e-9
    assert np.any(walled) or not contact


def test_no_point_of_a_search_beats_the_physical_track():
    found = track_physical_fastest(**TRACK, friction_static=MU_S)

    def value(alpha, beta):
        x, y, n, column = drive({**TRACK, "friction_static": MU_S}, alpha, beta)
        s = column["gravity_across"] - y
        held = x <= column["friction_static"] * (n + s)
        a = x - column["friction_kinetic"] * (n + s)
        return np.where((n >= -TOUCHING) & (s >= -TOUCHING) & ~held, a, -np.inf)

    best = searched(value)
    moves = found.status == STATUS["optimal"]
    np.testing.assert_array_equal(np.isfinite(best), found.status != STATUS["no_motion"])
    assert np.all(found.acceleration_x[moves] >= (best - ROUNDING)[moves])
    at = value(found.alpha, found.beta)[moves]
    np.testing.assert_allclose(at, found.acceleration_x[moves], rtol=0, atol=1e-11)
    _, across, floor, column = drive(TRACK, found.alpha, found.beta)
    for margin in (column["gravity_across"] - across, floor):
        assert 0 < (np.abs(margin[moves]) < 1e-9).sum() < moves.sum()


def test_what_has_no_answer_says_why():
    one = {"vibration_acceleration": 20.0, "gravity_along": 0.0, "gravity_normal": 9.8}
    mu, floor = {"friction_kinetic": 0.3}, {"floor_contact": True}
    limited = plane_thesis_limited

    def status(result):
        return int(result.status)

    assert status(limited(**one, **mu, **floor, limit=1.0)) == STATUS["optimal"]
    assert status(limited(**one, **mu, **floor, limit=-1.0)) == STATUS["invalid"]
    assert status(limited(**one, **mu, **floor, limit=np.nan)) == STATUS["invalid"]
    weak = {**one, "vibration_acceleration": 2.0}
    assert status(limited(**weak, **mu, **floor, limit=9.0)) == STATUS["no_motion"]
    assert status(limited(**weak, **mu, **floor, limit=0.1)) == STATUS["infeasible"]
    off = {**one, "vibration_acceleration": 0.0}
    assert status(limited(**off, **mu, **floor, limit=9.0)) == STATUS["flat"]
    assert status(limited(**off, **mu, **floor, limit=1.0)) == STATUS["infeasible"]
    smooth = limited(**one, friction_kinetic=0.0, **floor, limit=0.0)
    assert (float(smooth.alpha), float(smooth.beta)) == (0.0, 0.0)
    assert float(smooth.acceleration_x) == 20.0
    front = plane_thesis_pareto(**one, friction_kinetic=0.0, **floor, points=3)
    np.testing.assert_array_equal(front.alpha, 0.0)  # without friction a single point
    for function in (plane_physical_fastest, cylinder_physical_fastest):
        static = {"friction_static": 0.5}
        assert status(function(**one, **mu, **static)) == STATUS["optimal"]
        assert status(function(**weak, **mu, **static)) == STATUS["no_motion"]
        assert status(function(**off, **mu, **static)) == STATUS["flat"]
        assert status(function(**one, **mu, friction_static=0.2)) == STATUS["invalid"]
        sticky = {**one, "vibration_acceleration": 4.4}
        assert status(function(**sticky, **mu, friction_static=0.5)) == STATUS["not_attained"]
    away = {**one, **mu, "gravity_across": -1.0}
    assert status(track_physical_fastest(**away, friction_static=0.3)) == STATUS["infeasible"]
    assert len({flag.value for flag in OPTIMUM_STATUSES.values()}) == len(STATUS)
