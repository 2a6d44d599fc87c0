"""The method `exact`: closed forms of the problems whose answer is known (theory 12).

All of the source's formulas are linear in the drive direction d = (cb ca, cb sa, sb): the optimum
is the highest point of a piece of the unit sphere that planes cut out, so that even the root of the
limit problem has a closed form. Those under the friction disc are in `best_angles`.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.mechanics.arrays import Array, ratio
from vibrafeed.core.optimise.best_angles import (
    BLOCK,
    CYLINDER,
    Family,
    Optimum,
    broadcast,
    optimum,
    statuses,
    valid_inputs,
)
from vibrafeed.core.optimise.problem import (
    LIMIT,
    STATUS,
    Optima,
    OptimisationProblem,
    chosen_cells,
    columns,
)
from vibrafeed.core.optimise.search import box_points, by_search
from vibrafeed.core.study.grid_study import DRIVE_ANGLES
from vibrafeed.core.study.optimise_study import Limited, Maximise, Pareto, Weighted
from vibrafeed.core.study.values import evenly
from vibrafeed.core.watch import Watch


def plane_thesis_limited(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    limit: ArrayLike,
    floor_contact: bool,
) -> Optimum:
    """Return the drive angles of the largest a_x with |a_y| <= limit on a plane, printed friction.

    The source's friction acts along x and y at once (theory 12.1). Without a limit alpha = 0, beta
    = atan(mu), or with `floor_contact` (the part stays on the floor) at most the lift-off angle
    asin(G/P). If asin(G/P) <= atan(mu): alpha = 0; beta is the lift-off angle, where a_y = 0, or
    without `floor_contact` sin(beta) = min((G + limit/mu)/P, sin(atan mu)). Else alpha = 0, beta =
    atan(mu) while a_y >= -limit there, then the point of a_y = -limit on the curve tan(beta) = mu
    (cos(alpha) + sin(alpha)). It lies within 90 deg while P sqrt(1 + mu^2) >= mu G - limit; else
    `infeasible`.

    `vibration_acceleration` is P, `gravity_along` and `gravity_normal` are gravity along -x and
    onto the floor, G, and `limit` is in m/s2, too; `friction_kinetic` is mu; they broadcast. The
    result has the angles [rad], a_x and a_y [m/s2] and a status.
    """
    P, c, G, mu, E = broadcast(
        vibration_acceleration, gravity_along, gravity_normal, friction_kinetic, limit
    )
    within = (P >= 0) & (G >= 0) & (mu >= 0) & (E >= 0)
    valid, driven, (P, c, G, mu) = valid_inputs(within, P, c, G, mu)
    E = np.where(valid, E, 0.0)
    scale = np.where(driven, P, 1.0)
    g, e, A = G / scale, E / scale, np.hypot(1.0, mu)
    lifts_off = mu >= g * A  # asin(G/P) <= atan(mu)
    lifting_sine = np.minimum(g + ratio(e, mu, np.inf), mu / A)
    sine = g if floor_contact else lifting_sine
    on_curve = ~lifts_off & (mu * mu / A < mu * g - e)
    infeasible = driven & on_curve & (mu * g - e > A)
    on_limit = on_curve & ~infeasible & driven
    alpha, beta = _angles_at_limit(np.where(on_limit, mu * g - np.where(on_limit, e, 0.0), 0.0), mu)
    alpha = np.where(on_limit, alpha, 0.0)
    beta = np.where(
        on_limit, beta, np.where(lifts_off, np.arcsin(np.minimum(sine, 1.0)), np.arctan(mu))
    )
    # Without drive a_y is -mu G at every angle.
    infeasible |= valid & ~driven & (mu * G > E)
    along, across = _printed_accelerations(P, c, G, mu, alpha, beta)
    return optimum(alpha, beta, along, across, statuses(valid, infeasible, driven, along))


def plane_thesis_weighted(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    weight: ArrayLike,
    floor_contact: bool,
) -> Optimum:
    """Return the drive angles of the largest a_x - w |a_y| on a plane with the printed friction.

    The source's friction acts along x and y at once (theory 12.1); the best angles are then a
    closed form. The objective is linear in the direction of the drive where a_y < 0, with the
    gradient (1, w, mu (1 + w)). If asin(G/P) > atan(mu), the best is tan(alpha) = w, tan(beta) = mu
    (cos(alpha) + sin(alpha)), up to the alpha at which a_y = 0. Else alpha = 0 and beta =
    max(asin(G/P), atan(mu (1 - w))).

    `vibration_acceleration` is P, `gravity_along` and `gravity_normal` are gravity along -x and
    onto the floor, G [m/s2], `friction_kinetic` is mu and `weight` w; they broadcast. With
    `floor_contact` the part has to stay on the floor, beta <= asin(G/P). The result has the angles
    [rad], a_x and a_y [m/s2] and a status.
    """
    P, c, G, mu, w = broadcast(
        vibration_acceleration, gravity_along, gravity_normal, friction_kinetic, weight
    )
    within = (P >= 0) & (G >= 0) & (mu >= 0) & (w >= 0)
    valid, driven, (P, c, G, mu, w) = valid_inputs(within, P, c, G, mu, w)
    g, A = G / np.where(driven, P, 1.0), np.hypot(1.0, mu)
    lifts_off = mu >= g * A  # asin(G/P) <= atan(mu)
    lift_off = np.arcsin(np.minimum(g, 1.0))
    lifting_beta = lift_off if floor_contact else np.maximum(lift_off, np.arctan(mu * (1 - w)))
    alpha = np.where(lifts_off, 0.0, np.minimum(np.arctan(w), _alpha_max(g, mu)))
    beta = np.where(lifts_off, lifting_beta, _curve_beta(alpha, mu))
    along, across = _printed_accelerations(P, c, G, mu, alpha, beta)
    status = statuses(valid, np.zeros_like(valid), driven, along)
    return optimum(alpha, beta, along, across, status)


def plane_thesis_pareto(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    floor_contact: bool,
    points: int,
) -> Optimum:
    """Return `points` points of the trade-off between a_x and |a_y| on a plane, printed friction.

    The source's friction acts along x and y at once (theory 12.1). Points go from the largest a_x
    to the least |a_y|. If asin(G/P) <= atan(mu), alpha = 0 and beta goes from atan(mu) down to
    asin(G/P), or with `floor_contact`, where a part must not lift off, is asin(G/P) in all points.
    Else they lie on the curve tan(beta) = mu (cos(alpha) + sin(alpha)), alpha evenly spaced from 0
    to where a_y = 0, or to 90 deg.

    `vibration_acceleration` is P, `gravity_along` and `gravity_normal` are gravity along -x and
    onto the floor, G [m/s2], `friction_kinetic` is mu; they broadcast. The result has the angles
    [rad], a_x and a_y [m/s2], the points along a last axis, and a status.
    """
    P, c, G, mu = (
        argument[..., np.newaxis]
        for argument in broadcast(
            vibration_acceleration, gravity_along, gravity_normal, friction_kinetic
        )
    )
    within = (P >= 0) & (G >= 0) & (mu >= 0)
    valid, driven, (P, c, G, mu) = valid_inputs(within, P, c, G, mu)
    g, A = G / np.where(driven, P, 1.0), np.hypot(1.0, mu)
    lifts_off = mu >= g * A  # asin(G/P) <= atan(mu)
    lift_off = np.arcsin(np.minimum(g, 1.0))
    fraction = evenly(0.0, 1.0, points)
    first_beta = lift_off if floor_contact else np.arctan(mu)
    alpha = np.where(lifts_off, 0.0, fraction * _alpha_max(g, mu))
    beta = np.where(
        lifts_off, first_beta + fraction * (lift_off - first_beta), _curve_beta(alpha, mu)
    )
    along, across = _printed_accelerations(P, c, G, mu, alpha, beta)
    status = statuses(valid, np.zeros_like(valid), driven, along[..., :1])
    return optimum(alpha, beta, along, across, status)._replace(status=status[..., 0])


def _printed_accelerations(
    P: Array, c: Array, G: Array, mu: Array, alpha: Array, beta: Array
) -> tuple[Array, Array]:
    # a_x and a_y of (3.11), with friction mu (G - P sin(beta)) against both.
    friction = mu * (G - P * np.sin(beta))
    push = P * np.cos(beta)
    return push * np.cos(alpha) - c - friction, push * np.sin(alpha) - friction


def _curve_beta(alpha: Array, mu: Array) -> Array:
    # On the curve tan(beta) = mu (cos(alpha) + sin(alpha)).
    return np.asarray(np.arctan(mu * (np.cos(alpha) + np.sin(alpha))))


def _angles_at_limit(limit_level: Array, mu: Array) -> tuple[Array, Array]:
    # The limit of a_y is a level of d_y + mu d_z, with the drive direction d: the highest point
    # over d_x + mu d_z of the circle that its plane cuts from the unit sphere is the foot of the
    # plane plus a step along the projected gradient.
    A2 = 1.0 + mu * mu
    A = np.hypot(1.0, mu)
    height = np.minimum(limit_level / A, 1.0)
    x = np.sqrt((1 - height) * (1 + height)) * np.sqrt(A2 / (1 + 2 * mu * mu))
    y = height / A - x * (mu * mu / A2)
    alpha = np.clip(np.arctan2(y, x), 0.0, np.pi / 2)
    return alpha, _curve_beta(alpha, mu)


def _alpha_max(g: Array, mu: Array) -> Array:
    # Where a_y = 0 on the curve; 90 deg where it stays negative.
    return _angles_at_limit(np.minimum(mu * g, np.hypot(1.0, mu)), mu)[0]


PLANE = Family(
    systems=tuple(
        (scene, variant, "acceleration_x")
        for scene in ("rectangle-on-plane", "cylinder-on-plane")
        for variant in ("thesis", "derived")
    ),
    closed={
        Maximise: plane_thesis_limited,
        Limited: plane_thesis_limited,
        Weighted: plane_thesis_weighted,
        Pareto: plane_thesis_pareto,
    },
)


def track_fastest(
    *,
    variant: Literal["thesis", "derived"],
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_across: ArrayLike,
    friction_kinetic: ArrayLike,
    wall_contact: bool,
) -> Optimum:
    """Return the drive angles of the largest K on the track, with the source's printed forces.

    K is the acceleration along the track at rest. tan(alpha) = mu, beta = 0: K = P sqrt(1 + mu^2) -
    c -+ mu g_y. There the wall has to pull unless g_y is large (theory 4.2, 12). With
    `wall_contact` it may not, W = P cos(beta) sin(alpha) <= g_y at rest, and alpha = min(atan(mu),
    asin(g_y/P)). The `thesis` variant prints the balance with the other sign, W <= -g_y, which no
    lean onto the wall allows: `infeasible`.

    `vibration_acceleration` is P, `gravity_along` is c, along -x, `gravity_across` g_y, towards the
    wall [m/s2], `friction_kinetic` is mu; they broadcast. The result has the angles [rad], K
    [m/s2] and a status.
    """
    P, c, gy, mu = broadcast(
        vibration_acceleration, gravity_along, gravity_across, friction_kinetic
    )
    within = (P >= 0) & (mu >= 0)
    valid, driven, (P, c, gy, mu) = valid_inputs(within, P, c, gy, mu)
    sign = 1.0 if variant == "derived" else -1.0
    wall_margin = sign * gy
    alpha = np.arctan(mu)
    infeasible = np.zeros_like(valid)
    if wall_contact:
        infeasible = valid & (wall_margin < 0)
        sine = np.clip(wall_margin / np.where(driven, P, 1.0), 0.0, 1.0)
        alpha = np.minimum(alpha, np.arcsin(sine))
    beta = np.zeros_like(alpha)
    K = P * (np.cos(alpha) + mu * np.sin(alpha)) - c - mu * wall_margin
    return optimum(alpha, beta, K, np.zeros_like(K), statuses(valid, infeasible, driven, K))


PRINTED_TRACK = Family(
    systems=(
        ("rectangle-on-track", "thesis", "acceleration_x"),
        ("rectangle-on-track", "thesis", "starting_acceleration"),
    ),
    closed={Maximise: partial(track_fastest, variant="thesis")},
    against=None,
)

DERIVED_TRACK = Family(
    systems=(
        ("rectangle-on-track", "derived", "acceleration_x"),
        ("rectangle-on-track", "derived", "starting_acceleration"),
        ("rectangle-on-track", "physical", "starting_acceleration"),
    ),
    closed={Maximise: partial(track_fastest, variant="derived")},
    against=None,
)


def track_physical_fastest(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_across: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    friction_static: ArrayLike,
) -> Optimum:
    """Return the drive angles of the largest a_x at rest on the track, with floor and wall kept.

    a_x = P cb ca - c - mu (g_z - P sb + g_y - P cb sa), where ca, sa, cb, sb are cosines and sines
    of azimuth alpha and elevation beta (theory 4.4, 12). Without bounds tan(alpha) = mu and
    tan(beta) = mu/sqrt(1 + mu^2); where that lifts the part off the wall, P cb sa = g_y and
    sin(beta) = mu sqrt((1 - g_y^2/P^2)/(1 + mu^2)); sin(beta) at most g_z/P in both.

    `vibration_acceleration` is P; `gravity_along`, `gravity_across` and `gravity_normal` are
    gravity along -x, c, towards the wall, g_y, and onto the floor, g_z [m/s2]; `friction_kinetic`
    is mu and `friction_static` mu_s >= mu; all broadcast. The status is `no_motion` if the same
    maximum with mu_s is not positive, `not_attained` if the best angles let the part stick: then
    angles are NaN. The result has the angles [rad], a_x [m/s2] and a status.
    """
    P, c, gy, gz, mu, mu_s = broadcast(
        vibration_acceleration,
        gravity_along,
        gravity_across,
        gravity_normal,
        friction_kinetic,
        friction_static,
    )
    within = (P >= 0) & (mu >= 0) & (mu_s >= mu)
    valid, driven, (P, c, gy, gz, mu, mu_s) = valid_inputs(within, P, c, gy, gz, mu, mu_s)
    infeasible = valid & ((gy < 0) | (gz < 0))
    scale = np.where(driven, P, 1.0)
    y, z = np.maximum(gy, 0.0) / scale, np.maximum(gz, 0.0) / scale
    alpha, beta = _best_angles_with_contacts(y, z, mu)
    starting_angles = _best_angles_with_contacts(y, z, mu_s)
    starting_value = _track_acceleration(P, c, gy, gz, mu_s, *starting_angles)
    K = _track_acceleration(P, c, gy, gz, mu, alpha, beta)
    stuck = _track_acceleration(P, c, gy, gz, mu_s, alpha, beta) <= 0
    moves = starting_value > 0
    status = statuses(valid, infeasible, driven, np.where(moves, 1.0, 0.0))
    at_edge = stuck & moves & (status == STATUS["optimal"])
    status = np.where(at_edge, STATUS["not_attained"], status).astype(np.int8)
    without_angles = at_edge | (status == STATUS["no_motion"])
    alpha, beta, K = (np.where(without_angles, np.nan, part) for part in (alpha, beta, K))
    return optimum(alpha, beta, K, np.where(without_angles, np.nan, 0.0), status)


def _best_angles_with_contacts(y: Array, z: Array, mu: Array) -> tuple[Array, Array]:
    # The angles of the largest d_x + mu (d_y + d_z) with d_y <= y and d_z <= z.
    d_y = np.minimum(y, 1.0)
    d_z_at_wall = np.minimum(mu * np.sqrt((1 - d_y) * (1 + d_y)) / np.hypot(1.0, mu), z)
    d_x_at_wall = np.sqrt(np.maximum((1 - d_z_at_wall) * (1 + d_z_at_wall) - d_y * d_y, 0.0))
    at_wall = (y < 1) & (d_y <= mu * d_x_at_wall)
    d_z_free = np.minimum(mu / np.sqrt(1 + 2 * mu * mu), z)
    alpha = np.where(at_wall, np.arctan2(d_y, d_x_at_wall), np.arctan(mu))
    return alpha, np.arcsin(np.where(at_wall, d_z_at_wall, d_z_free))


def _track_acceleration(
    P: Array, c: Array, gy: Array, gz: Array, mu: Array, alpha: Array, beta: Array
) -> Array:
    # K_0 (theory 4.4): the drive along x less gravity and friction on floor and wall.
    push = P * np.cos(beta)
    floor, wall = gz - P * np.sin(beta), gy - push * np.sin(alpha)
    return np.asarray(push * np.cos(alpha) - c - mu * (floor + wall))


TRACK = Family(
    systems=(("rectangle-on-track", "physical", "acceleration_x"),),
    closed={Maximise: track_physical_fastest},
    against=None,
    contacts=frozenset({"floor_contact", "wall_contact"}),
)


REST_POINTS = 81  # of the grid on which rest is looked for, where no choice moves the part


def by_exact(
    problem: OptimisationProblem,
    design: Mapping[str, Array],
    scales: Mapping[str, Array],
    watch: Watch,
) -> Optima:
    """Return the closed-form optimum of every design.

    Closed forms look for forward motion only. Without any, the best is a part that rests; where it
    slides back at every choice, `search` finds the best one, or that none keeps the limits. So it
    does at an edge of stick whose angles have no closed form.
    """
    optima = closed_optima(problem, design)
    assert optima.value is not None
    x, status, value = optima.x.copy(), optima.status.copy(), optima.value.copy()
    # Without motion, rest is the best: any point of the bounds that keeps the constraints.
    without_angles: NDArray[np.bool_] = np.asarray(np.isnan(x).any(axis=0))
    no_motion = np.flatnonzero((status == STATUS["no_motion"]) & without_angles)
    if no_motion.size:
        unit = box_points(len(problem.names), no_motion.size, REST_POINTS)
        arguments = (
            columns(chosen_cells(design, no_motion)),
            columns(chosen_cells(scales, no_motion)),
        )
        objective, violation, _ = problem.judged(problem.from_unit_box(unit)[:, None], *arguments)
        rests = (violation <= 0) & (objective >= 0)
        has_rest = rests.any(axis=1)
        x[:, no_motion[has_rest]] = problem.from_unit_box(unit[:, rests[has_rest].argmax(axis=1)])
        without_angles[no_motion[has_rest]] = False
    unsolved = np.flatnonzero(
        without_angles & np.isin(status, (STATUS["no_motion"], STATUS["not_attained"]))
    )
    if unsolved.size:
        arguments = chosen_cells(design, unsolved), chosen_cells(scales, unsolved)
        searched = by_search(problem, *arguments, replace(watch, progress=None))
        not_found = np.isnan(searched.x).any(axis=0)
        values = problem.judged(
            np.where(not_found, problem.lower[:, None], searched.x), *arguments
        )[0]
        x[:, unsolved], value[unsolved] = searched.x, np.where(not_found, np.nan, values)
        status[unsolved] = np.where(
            status[unsolved] == STATUS["not_attained"], STATUS["not_attained"], searched.status
        )
    watch.advance(1.0)
    return replace(optima, x=x, status=status, value=value)


def closed_optima(problem: OptimisationProblem, design: Mapping[str, Array]) -> Optima:
    """Return the closed-form optimum of every design as it is, NaN where a part does not move.

    `design` has the fixed parameters, SI units, shape (cells,).
    """
    best = _closed_optimum(problem, design)
    value = best.acceleration_x - problem.weight * np.abs(best.acceleration_y)
    return Optima(_ordered(problem, best.alpha, best.beta), best.status, value)


def closed_front(problem: OptimisationProblem, design: Mapping[str, Array], points: int) -> Optima:
    """Return the closed-form front of every design, shape (cells * points,).

    `points` is the number of points of a front, which follow one another.
    """
    front = _closed_optimum(problem, design, points)
    x = _ordered(problem, front.alpha.ravel(), front.beta.ravel())
    return Optima(x, np.repeat(front.status, points), front.acceleration_x.ravel())


def is_closed(problem: OptimisationProblem) -> bool:
    """True if the optimum of a problem has a closed form.

    Both angles of the drive are then variables with bounds from 0 to 90 degrees, and scene,
    criterion and constraints are among those that were solved.
    """
    family = _family_of(problem)
    has_full_range = (
        set(problem.names) == set(DRIVE_ANGLES)
        and bool(np.all(problem.lower == 0.0))
        and bool(np.all(problem.upper == np.pi / 2))
    )
    return family is not None and has_full_range and type(problem.criterion) in family.closed


def _family_of(problem: OptimisationProblem) -> Family | None:
    plan, criterion = problem.plan, problem.criterion
    family = FAMILIES.get((plan.scene.name, plan.variant, criterion.output))
    names = {constraint.name for constraint in problem.constraints}
    if family is None or problem.uncertain is not None or problem.sign < 0:
        return None
    if not family.contacts <= names <= {LIMIT, "floor_contact", "wall_contact"}:
        return None
    if problem.against not in (None, family.against):
        return None
    # The drive is as large in any direction: a vertical amplitude is not.
    if plan.depends_on({name: name for name in problem.names}).get("vibration_acceleration"):
        return None
    at_rest = "speed" not in plan.parameters and (
        plan.scene.name != "rectangle-on-track" or "centripetal_acceleration" in plan.defaults
    )
    return family if at_rest else None


def _closed_optimum(
    problem: OptimisationProblem, design: Mapping[str, Array], points: int = 0
) -> Optimum:
    family = _family_of(problem)
    assert family is not None
    # Any angles will do: none of the quantities below depends on them.
    quantities = problem.quantities(
        np.broadcast_to(problem.lower[:, None], (len(problem.names), 1)), design
    )
    names = ("vibration_acceleration", "gravity_along", "gravity_normal", "friction_kinetic")
    optional = (name for name in ("friction_static", "gravity_across") if name in quantities)
    cells = next(iter(design.values())).shape
    inputs = {
        name: np.broadcast_to(np.asarray(quantities[name], dtype=np.float64), cells)
        for name in (*names, *optional)
    }
    constraints = {constraint.name for constraint in problem.constraints}
    options = {
        "limit": design.get(LIMIT, np.inf),
        "weight": problem.weight,
        "floor_contact": "floor_contact" in constraints,
        "wall_contact": "wall_contact" in constraints,
        "friction_static": inputs["friction_kinetic"],
        "points": points,
    }
    return family.closed_optimum(problem.criterion, options | inputs)


def _ordered(problem: OptimisationProblem, alpha: Array, beta: Array) -> Array:
    angles = {"alpha": alpha, "beta": beta}
    return np.stack([np.broadcast_to(angles[name], alpha.shape) for name in problem.names])


FAMILIES = {
    system: family
    for family in (PLANE, BLOCK, CYLINDER, PRINTED_TRACK, DERIVED_TRACK, TRACK)
    for system in family.systems
}
"""The family of a scene, its variant and the output that is to be largest."""
