"""The exact optima against searches that know nothing of them, and the laws they must obey."""

import numpy as np
import pytest

import night
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

RANDOM = np.random.default_rng(1204)
DESIGNS = night.count(100, 1000)
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
    assert 0.1 * DESIGNS < good.sum() < DESIGNS
    a_x, a_y, n0 = printed(PLANE, found.alpha, found.beta)
    np.testing.assert_array_less(np.abs(a_y[good]), (LIMIT + ROUNDING)[good])
    assert np.all(a_x[good] >= (best - ROUNDING)[good])
    np.testing.assert_allclose(found.acceleration_x[good], a_x[good], rtol=0, atol=ROUNDING.max())
    np.testing.assert_array_equal(found.status[good] == STATUS["no_motion"], a_x[good] <= 0)
    if floor:
        assert np.all(n0[good] >= -ROUNDING[good])


@pytest.mark.parametrize("scale", [0.25, 64.0])  # powers of two: exactly the same numbers
@pytest.mark.parametrize(
    ("function", "extra"),
    [
        (plane_thesis_limited, {"limit": LIMIT, "floor_contact": True}),
        (plane_physical_fastest, {"friction_static": MU_S}),
        (cylinder_physical_fastest, {"friction_static": MU_S}),
    ],
)
def test_angles_do_not_depend_on_the_scale_of_accelerations(function, extra, scale):
    here = function(**PLANE, **extra)
    given = {**PLANE, **extra}
    for name in {"vibration_acceleration", "gravity_along", "gravity_normal", "limit"} & set(given):
        given[name] = given[name] * scale
    there = function(**given)
    for name in ("alpha", "beta", "status"):
        np.testing.assert_array_equal(getattr(here, name), getattr(there, name))
    np.testing.assert_array_equal(here.acceleration_x * scale, there.acceleration_x)


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


@pytest.mark.parametrize("variant", ["thesis", "derived"])
@pytest.mark.parametrize("contact", [True, False])
def test_no_point_of_a_search_beats_the_track(variant, contact):
    given = {name: values for name, values in TRACK.items() if name != "gravity_normal"}
    found = track_fastest(variant=variant, **given, wall_contact=contact)
    forms = {
        "thesis": (wall.printed_wall_balance, wall.printed_starting_acceleration),
        "derived": (wall.derived_wall_balance, wall.derived_starting_acceleration),
    }
    balance, start = forms[variant]

    def value(alpha, beta):
        x, y, _, column = drive(TRACK, alpha, beta)
        lean = {"gravity_across": column["gravity_across"], "drive_across": y}
        K = start(
            drive_along=x + column["gravity_along"], gravity_along=column["gravity_along"],
            friction_kinetic=column["friction_kinetic"], **lean,
        )  # fmt: skip
        room = balance(centripetal_acceleration=np.zeros(()), **lean)
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


FLOOR = {"friction_kinetic": 0.3, "floor_contact": True}


@pytest.mark.parametrize(
    ("function", "P", "more", "status"),
    [
        (plane_thesis_limited, 20.0, {**FLOOR, "limit": 1.0}, "optimal"),
        (plane_thesis_limited, 20.0, {**FLOOR, "limit": -1.0}, "invalid"),
        (plane_thesis_limited, 20.0, {**FLOOR, "limit": np.nan}, "invalid"),
        (plane_thesis_limited, 2.0, {**FLOOR, "limit": 9.0}, "no_motion"),
        (plane_thesis_limited, 2.0, {**FLOOR, "limit": 0.1}, "infeasible"),
        (plane_thesis_limited, 0.0, {**FLOOR, "limit": 9.0}, "flat"),
        (plane_thesis_limited, 0.0, {**FLOOR, "limit": 1.0}, "infeasible"),
        (track_physical_fastest, 20.0,
         {"friction_kinetic": 0.3, "friction_static": 0.3, "gravity_across": -1.0}, "infeasible"),
        *((function, P, {"friction_kinetic": 0.3, "friction_static": static}, status)
          for function in (plane_physical_fastest, cylinder_physical_fastest)
          for P, static, status in ((20.0, 0.5, "optimal"), (2.0, 0.5, "no_motion"),
                                    (0.0, 0.5, "flat"), (20.0, 0.2, "invalid"),
                                    (4.4, 0.5, "not_attained"))),
    ],
)  # fmt: skip
def test_what_has_no_answer_says_why(function, P, more, status):
    found = function(vibration_acceleration=P, gravity_along=0.0, gravity_normal=9.8, **more)
    assert int(found.status) == STATUS[status]


def test_without_friction_there_is_a_single_point():
    one = {"vibration_acceleration": 20.0, "gravity_along": 0.0, "gravity_normal": 9.8}
    one |= {"friction_kinetic": 0.0, "floor_contact": True}
    smooth = plane_thesis_limited(**one, limit=0.0)
    assert (float(smooth.alpha), float(smooth.beta), float(smooth.acceleration_x)) == (0, 0, 20)
    np.testing.assert_array_equal(plane_thesis_pareto(**one, points=3).alpha, 0.0)
