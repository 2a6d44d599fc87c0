"""Exact answers to "a_x high, |a_y| low" for the angles of the drive (theory 12).

The forms hold for 0 <= alpha, beta <= 90 deg, any climb with `gravity_normal` >= 0, and a part at
rest. With other bounds use `core.optimise.newton`. All of the source's formulas are linear in the
drive direction d = (cb ca, cb sa, sb): what is sought is the highest point of a piece of the unit
sphere that planes cut out, so that even the root of the limit problem has a closed form.

Arguments broadcast; float64, SI units, radians. `gravity_along` is g sin(gamma), `gravity_normal`
g cos(gamma) (times cos(delta) on the track), `gravity_across` g cos(gamma) sin(delta). Inside,
everything is divided by the drive acceleration P.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.mechanics import rolling
from core.mechanics.arrays import Array, Mask, ratio
from core.quantities import Flag

OPTIMUM_STATUSES: dict[str, Flag] = {
    "optimal": Flag(0, "no other choice within the bounds does better"),
    "flat": Flag(1, "the choice does not matter, as without a drive"),
    "no_motion": Flag(2, "no choice within the bounds moves the part forwards"),
    "not_attained": Flag(
        3,
        "static friction still holds the part there; next to it the output jumps to the value",
    ),
    "infeasible": Flag(4, "no choice keeps the bounds, limits and contacts", valid=False),
    "invalid": Flag(5, "an argument is no number, or is out of its range", valid=False),
    "limit_reached": Flag(6, "the limit on steps came before the last digit", valid=False),
    "no_value": Flag(7, "the outputs have no value within the bounds", valid=False),
    "not_computed": Flag(8, "the study was stopped before this design", valid=False),
    "suboptimal": Flag(9, "a dense grid has a better point, which the search missed", valid=False),
}

STATUS: Mapping[str, int] = {name: flag.value for name, flag in OPTIMUM_STATUSES.items()}

ACTIVE: dict[str, int] = {
    "alpha_lower": 1,
    "alpha_upper": 2,
    "beta_lower": 4,
    "beta_upper": 8,
    "across_lower": 16,  # a_y = -limit
    "across_upper": 32,  # a_y = +limit
    "floor": 64,  # n0 = 0
    "wall": 128,  # wall force 0
    "start": 256,  # static friction just holds
}
"""Bits of `active`: constraints that hold with equality."""

TIGHT = 1e-10
"""A margin below this, relative to the accelerations of its formula, counts as none."""

Flags = NDArray[np.int16]
Statuses = NDArray[np.int8]

# Newton's steps for the tilted optimum; more are needed only where two roots all but meet.
MOST_STEPS = 60
# Friction directions at which the cylinder's value is sampled before its root is bisected.
DIRECTIONS = 129
BISECTIONS = 52
GOLDEN_SECTIONS = 40
GOLDEN = (math.sqrt(5.0) - 1) / 2


class PlaneOptimum(NamedTuple):
    """The best angles on a plane; all arrays have the broadcast shape.

    Attributes
    ----------
    alpha, beta : ndarray
        Azimuth and elevation of the drive [rad]; NaN where there are none.
    acceleration_x, acceleration_y : ndarray
        The accelerations there [m s-2].
    active : ndarray of int16
        Sum of the `ACTIVE` bits of the constraints that hold with equality.
    status : ndarray of int8
        Value of an `OPTIMUM_STATUSES` entry.
    """

    alpha: Array
    beta: Array
    acceleration_x: Array
    acceleration_y: Array
    active: Flags
    status: Statuses


class TrackOptimum(NamedTuple):
    """The best angles on the track; as `PlaneOptimum`, with K = a_x at rest [m s-2]."""

    alpha: Array
    beta: Array
    starting_acceleration: Array
    active: Flags
    status: Statuses


class ParetoSet(NamedTuple):
    """Points that no other angles beat in a_x and in |a_y|; a last axis counts the points.

    `status` has the broadcast shape without that axis.
    """

    alpha: Array
    beta: Array
    acceleration_x: Array
    acceleration_y: Array
    status: Statuses


def plane_thesis_fastest(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    floor_contact: bool,
) -> PlaneOptimum:
    """Return the angles of the largest a_x under the printed friction (theory 12.1).

    alpha = 0 and beta = atan(mu), or with `floor_contact` (n0 >= 0) the smaller of that and the
    lift-off angle asin(G/P). The second is the smaller from P = G sqrt(1 + mu^2)/mu on.
    """
    return plane_thesis_limited(
        vibration_acceleration=vibration_acceleration,
        gravity_along=gravity_along,
        gravity_normal=gravity_normal,
        friction_kinetic=friction_kinetic,
        limit=np.inf,
        floor_contact=floor_contact,
    )


def plane_thesis_limited(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    limit: ArrayLike,
    floor_contact: bool,
) -> PlaneOptimum:
    """Return the angles of the largest a_x with |a_y| <= limit, printed friction (theory 12.1).

    With asin(G/P) <= atan(mu) (case A): alpha = 0; beta is the lift-off angle, where a_y = 0, or
    without `floor_contact` sin(beta) = min((G + limit/mu)/P, sin(atan mu)). Else (case B):
    alpha = 0, beta = atan(mu) while a_y >= -limit there, then the point of a_y = -limit on the
    curve tan(beta) = mu (cos(alpha) + sin(alpha)), which has a closed form (`_on_curve`). It lies
    within 90 deg while P sqrt(1 + mu^2) >= mu G - limit; below that the status is `infeasible`.
    """
    P, c, G, mu, E = _broadcast(
        vibration_acceleration, gravity_along, gravity_normal, friction_kinetic, limit
    )
    valid = _finite(P, c, G, mu) & (P >= 0) & (G >= 0) & (mu >= 0) & (E >= 0)
    driven = valid & (P > 0)
    P, c, G, mu, E = _usable(valid, P, c, G, mu, E)
    scale = np.where(driven, P, 1.0)
    g, e, A = G / scale, E / scale, np.hypot(1.0, mu)
    lifts = mu >= g * A
    leaving = np.minimum(g + ratio(e, mu, np.inf), mu / A)
    sine = g if floor_contact else leaving
    on_curve = ~lifts & (mu * mu / A < mu * g - e)
    infeasible = driven & on_curve & (mu * g - e > A)
    held = on_curve & ~infeasible & driven
    alpha, beta = _on_curve(np.where(held, mu * g - np.where(held, e, 0.0), 0.0), mu)
    alpha = np.where(held, alpha, 0.0)
    beta = np.where(held, beta, np.where(lifts, np.arcsin(np.minimum(sine, 1.0)), np.arctan(mu)))
    # Without drive a_y is -mu G at every angle.
    infeasible |= valid & ~driven & (mu * G > E)
    along, across = _printed_accelerations(P, c, G, mu, alpha, beta)
    status = _statuses(valid, infeasible, driven, along)
    active = _bounds_active(alpha, beta) | _tight(ACTIVE["across_lower"], E + across, P + G)
    active |= _tight(ACTIVE["across_upper"], E - across, P + G)
    if floor_contact:
        active |= _tight(ACTIVE["floor"], G - P * np.sin(beta), P + G)
    return _plane(alpha, beta, along, across, active, status)


def plane_thesis_weighted(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    weight: ArrayLike,
    floor_contact: bool,
) -> PlaneOptimum:
    """Return the angles of the largest a_x - weight |a_y|, printed friction (theory 12.1).

    Where a_y < 0 the sum is linear in d with the gradient (1, w, mu (1 + w)), so that its top has
    tan(alpha) = w and tan(beta) = mu (cos(alpha) + sin(alpha)): a point of the Pareto set. Case B:
    alpha = min(atan(w), alpha_max); every w >= tan(alpha_max) ends in the kink a_y = 0. Case A:
    alpha = 0 and beta = max(asin(G/P), atan(mu (1 - w))); the kink is the lift-off angle, reached
    from w = 1 - tan(asin(G/P))/mu on, and with `floor_contact` for every w.
    """
    P, c, G, mu, w = _broadcast(
        vibration_acceleration, gravity_along, gravity_normal, friction_kinetic, weight
    )
    valid = _finite(P, c, G, mu, w) & (P >= 0) & (G >= 0) & (mu >= 0) & (w >= 0)
    driven = valid & (P > 0)
    P, c, G, mu, w = _usable(valid, P, c, G, mu, w)
    g, A = G / np.where(driven, P, 1.0), np.hypot(1.0, mu)
    lifts = mu >= g * A
    lift_off = np.arcsin(np.minimum(g, 1.0))
    leaving = lift_off if floor_contact else np.maximum(lift_off, np.arctan(mu * (1 - w)))
    alpha = np.where(lifts, 0.0, np.minimum(np.arctan(w), _alpha_max(g, mu)))
    beta = np.where(lifts, leaving, _curve_beta(alpha, mu))
    along, across = _printed_accelerations(P, c, G, mu, alpha, beta)
    status = _statuses(valid, np.zeros_like(valid), driven, along)
    kink = ACTIVE["across_lower"] | ACTIVE["across_upper"]
    active = _bounds_active(alpha, beta) | _tight(kink, across, P + G)
    if floor_contact:
        active |= _tight(ACTIVE["floor"], G - P * np.sin(beta), P + G)
    return _plane(alpha, beta, along, across, active, status)


def plane_thesis_pareto(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    floor_contact: bool,
    points: int,
) -> ParetoSet:
    """Return points of the trade-off between a_x and |a_y|, printed friction (theory 12.1).

    From the largest a_x to the least |a_y|. Case A with `floor_contact`: one point, repeated.
    Case A without: alpha = 0, beta from atan(mu) down to asin(G/P), evenly spaced in beta. Case B:
    the curve tan(beta) = mu (cos(alpha) + sin(alpha)), alpha evenly spaced from 0 to where a_y = 0,
    or to 90 deg where P sqrt(1 + mu^2) < mu G and a_y stays negative.
    """
    P, c, G, mu = (
        part[..., np.newaxis]
        for part in _broadcast(
            vibration_acceleration, gravity_along, gravity_normal, friction_kinetic
        )
    )
    valid = _finite(P, c, G, mu) & (P >= 0) & (G >= 0) & (mu >= 0)
    driven = valid & (P > 0)
    P, c, G, mu = _usable(valid, P, c, G, mu)
    g, A = G / np.where(driven, P, 1.0), np.hypot(1.0, mu)
    lifts = mu >= g * A
    lift_off = np.arcsin(np.minimum(g, 1.0))
    share = np.linspace(0.0, 1.0, points)
    first = lift_off if floor_contact else np.arctan(mu)
    alpha = np.where(lifts, 0.0, share * _alpha_max(g, mu))
    beta = np.where(lifts, first + share * (lift_off - first), _curve_beta(alpha, mu))
    along, across = _printed_accelerations(P, c, G, mu, alpha, beta)
    status = _statuses(valid, np.zeros_like(valid), driven, along[..., :1])[..., 0]
    bad = ~valid
    return ParetoSet(
        np.where(bad, np.nan, alpha),
        np.where(bad, np.nan, beta),
        np.where(bad, np.nan, along),
        np.where(bad, np.nan, across),
        status,
    )


def plane_thesis_least_across(
    *,
    vibration_acceleration: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    beta: ArrayLike,
) -> Array:
    """Return the alpha of the least |a_y| at given beta, printed friction (theory 12.1) [rad].

    sin(alpha) = mu (G - P sb)/(P cb), where a_y = 0; clipped to [0, 1]: 90 deg where a_y stays
    negative, 0 where it stays positive (beyond lift-off).
    """
    P, G, mu, b = _broadcast(vibration_acceleration, gravity_normal, friction_kinetic, beta)
    push, floor = P * np.cos(b), mu * (G - P * np.sin(b))
    inside = np.clip(floor, 0.0, push)
    return np.asarray(np.arcsin(ratio(inside, push, 0.0)))


def plane_physical_fastest(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    friction_static: ArrayLike,
) -> PlaneOptimum:
    """Return the angles of the largest a_x of a block on the floor, friction disc (theory 12.2).

    On a horizontal or falling track: alpha = 0, a_y = 0, beta = min(atan(mu_k), asin(G/P)); there
    is no trade-off. On a climbing track a drive close to the limit of motion does better from the
    side: it turns friction away from x. For a friction along -(cos psi, sin psi) the best a_x is

        V = cos psi [sqrt(1 + mu^2) sqrt(P^2 - c^2 sin^2 psi) - mu G - c cos psi],  c = g sin gamma,

    whose derivative by cos(psi) is convex, so that Newton's method from cos(psi) = 0 climbs to the
    one interior maximum; it is compared with alpha = 0. Motion is possible from
    P^2 > c^2 + mu_s^2 G^2/(1 + mu_s^2) on if c > 0 (alone along x only from
    P sqrt(1 + mu_s^2) > c + mu_s G on, which is later), else `no_motion`, with NaN.

    Where mu_s > mu_k and the best angles lie in stick, the best is at the edge of stick, as a limit
    (`not_attained`). `friction_static` is at least `friction_kinetic`.
    """
    P, c, G, mu, mu_s = _broadcast(
        vibration_acceleration, gravity_along, gravity_normal, friction_kinetic, friction_static
    )
    valid = _finite(P, c, G, mu, mu_s) & (P >= 0) & (G >= 0) & (mu >= 0) & (mu_s >= mu)
    driven = valid & (P > 0)
    P, c, G, mu, mu_s = _usable(valid, P, c, G, mu, mu_s)
    scale = np.where(driven, P, 1.0)
    k, g = c / scale, G / scale
    straight = _straight(k, g, mu, mu_s)
    turned = _turned_block(k, g, mu, mu_s)
    edge = _edge_block(k, g, mu, mu_s)
    found = (*straight, turned, edge)
    return _best_physical(P, c, G, mu, mu_s, valid, driven, found, _block_acceleration)


def cylinder_physical_fastest(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    friction_static: ArrayLike,
) -> PlaneOptimum:
    """Return the angles of the largest a_x of a cylinder on the floor (theory 7.3, 12.2).

    As for the block alpha = 0, beta = min(atan(mu_k), asin(G/P)), and a_y = 0. Here a drive from
    the side does better only on tracks much steeper than friction (c > 8 mu n at the limit of
    motion). For a contact slip along (cos psi, sin psi) the best a_x is again a closed form of psi;
    its maximum is sampled and then bisected to rounding, and on the edge of stick by golden
    sections, to 1e-7 rad.
    """
    P, c, G, mu, mu_s = _broadcast(
        vibration_acceleration, gravity_along, gravity_normal, friction_kinetic, friction_static
    )
    valid = _finite(P, c, G, mu, mu_s) & (P >= 0) & (G >= 0) & (mu >= 0) & (mu_s >= mu)
    driven = valid & (P > 0)
    P, c, G, mu, mu_s = _usable(valid, P, c, G, mu, mu_s)
    scale = np.where(driven, P, 1.0)
    k, g = c / scale, G / scale
    straight = _straight(k, g, mu, mu_s)
    turned = _turned_cylinder(k, g, mu, mu_s)
    found = (*straight, turned, _edge_cylinder(k, g, mu, mu_s))
    return _best_physical(P, c, G, mu, mu_s, valid, driven, found, _cylinder_acceleration)


def track_fastest(
    *,
    variant: Literal["thesis", "derived"],
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_across: ArrayLike,
    friction_kinetic: ArrayLike,
    wall_contact: bool,
) -> TrackOptimum:
    """Return the angles of the largest K of the track's printed forces (theory 4.2, 12).

    tan(alpha) = mu, beta = 0: K = P sqrt(1 + mu^2) - c -+ mu g_y. There the wall has to pull unless
    g_y is large. With `wall_contact` (at rest, W <= g_y): alpha = min(atan(mu), asin(g_y/P)). The
    `thesis` variant prints the balance with the other sign, W <= -g_y, which no lean onto the wall
    allows: `infeasible`.
    """
    P, c, gy, mu = _broadcast(
        vibration_acceleration, gravity_along, gravity_across, friction_kinetic
    )
    valid = _finite(P, c, gy, mu) & (P >= 0) & (mu >= 0)
    driven = valid & (P > 0)
    P, c, gy, mu = _usable(valid, P, c, gy, mu)
    sign = 1.0 if variant == "derived" else -1.0
    room = sign * gy
    alpha = np.arctan(mu)
    infeasible = np.zeros_like(valid)
    if wall_contact:
        infeasible = valid & (room < 0)
        sine = np.clip(room / np.where(driven, P, 1.0), 0.0, 1.0)
        alpha = np.minimum(alpha, np.arcsin(sine))
    beta = np.zeros_like(alpha)
    K = P * (np.cos(alpha) + mu * np.sin(alpha)) - c - mu * room
    active = _bounds_active(alpha, beta)
    if wall_contact:
        active |= _tight(ACTIVE["wall"], room - P * np.sin(alpha), P + np.abs(gy))
    return _track(alpha, beta, K, active, _statuses(valid, infeasible, driven, K))


def track_physical_fastest(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_across: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    friction_static: ArrayLike,
) -> TrackOptimum:
    """Return the angles of the largest a_x at rest with floor and wall kept (theory 4.4, 12).

    K_0 = P cb ca - c - mu (g_z - P sb + g_y - P cb sa). Without bounds tan(alpha) = mu and
    tan(beta) = mu/sqrt(1 + mu^2); where that lifts the part off the wall, P cb sa = g_y and
    sin(beta) = mu sqrt((1 - g_y^2/P^2)/(1 + mu^2)); sin(beta) at most g_z/P in both.

    The part starts if the same maximum with mu_s for mu is positive, else `no_motion`, with NaN.
    Where mu_s > mu_k and the best angles lie in stick, the answer is at the edge of stick
    (`not_attained`), a point of the same geometry with one more plane: `core.optimise.newton`
    finds it; here its angles are NaN. `friction_static` is at least `friction_kinetic`.
    """
    P, c, gy, gz, mu, mu_s = _broadcast(
        vibration_acceleration,
        gravity_along,
        gravity_across,
        gravity_normal,
        friction_kinetic,
        friction_static,
    )
    valid = _finite(P, c, gy, gz, mu, mu_s) & (P >= 0) & (mu >= 0) & (mu_s >= mu)
    driven = valid & (P > 0)
    P, c, gy, gz, mu, mu_s = _usable(valid, P, c, gy, gz, mu, mu_s)
    infeasible = valid & ((gy < 0) | (gz < 0))
    scale = np.where(driven, P, 1.0)
    y, z = np.maximum(gy, 0.0) / scale, np.maximum(gz, 0.0) / scale
    alpha, beta = _both_contacts(y, z, mu)
    easiest = _both_contacts(y, z, mu_s)
    start = _both_value(P, c, gy, gz, mu_s, *easiest)
    K = _both_value(P, c, gy, gz, mu, alpha, beta)
    stuck = _both_value(P, c, gy, gz, mu_s, alpha, beta) <= 0
    moves = start > 0
    active = _bounds_active(alpha, beta)
    active |= _tight(ACTIVE["wall"], gy - P * np.cos(beta) * np.sin(alpha), P + np.abs(gy))
    active |= _tight(ACTIVE["floor"], gz - P * np.sin(beta), P + np.abs(gz))
    status = _statuses(valid, infeasible, driven, np.where(moves, 1.0, 0.0))
    at_edge = stuck & moves & (status == STATUS["optimal"])
    status = np.where(at_edge, STATUS["not_attained"], status).astype(np.int8)
    hidden = at_edge | (status == STATUS["no_motion"])
    alpha, beta, K = (np.where(hidden, np.nan, part) for part in (alpha, beta, K))
    return _track(alpha, beta, K, np.where(hidden, 0, active).astype(np.int16), status)


# --- shared


def _broadcast(*parts: ArrayLike) -> tuple[Array, ...]:
    return tuple(np.broadcast_arrays(*(np.asarray(part, dtype=np.float64) for part in parts)))


def _finite(*parts: Array) -> Mask:
    return np.asarray(np.all([np.isfinite(part) for part in parts], axis=0))


def _usable(valid: Mask, *parts: Array) -> tuple[Array, ...]:
    """Return the arguments with 0 in place of what is not valid: no warnings from NaN."""
    return tuple(np.where(valid, part, 0.0) for part in parts)


def _statuses(valid: Mask, infeasible: Mask, driven: Mask, gain: Array) -> Statuses:
    status = np.where(gain > 0, STATUS["optimal"], STATUS["no_motion"])
    status = np.where(driven, status, STATUS["flat"])
    status = np.where(infeasible, STATUS["infeasible"], status)
    return np.asarray(np.where(valid, status, STATUS["invalid"]), dtype=np.int8)


def _tight(bit: int, margin: Array, scale: Array) -> Flags:
    return np.where(np.abs(margin) <= TIGHT * scale, bit, 0).astype(np.int16)


def _bounds_active(alpha: Array, beta: Array) -> Flags:
    one, right = np.ones_like(alpha), np.pi / 2
    return np.asarray(
        _tight(ACTIVE["alpha_lower"], alpha, one)
        | _tight(ACTIVE["alpha_upper"], right - alpha, one)
        | _tight(ACTIVE["beta_lower"], beta, one)
        | _tight(ACTIVE["beta_upper"], right - beta, one)
    )


def _hidden(status: Statuses) -> Mask:
    return np.asarray((status == STATUS["infeasible"]) | (status == STATUS["invalid"]))


def _plane(
    alpha: Array, beta: Array, along: Array, across: Array, active: Flags, status: Statuses
) -> PlaneOptimum:
    bad = _hidden(status)
    alpha, beta, along, across = (np.where(bad, np.nan, p) for p in (alpha, beta, along, across))
    return PlaneOptimum(
        alpha, beta, along, across, np.where(bad, 0, active).astype(np.int16), status
    )


def _track(alpha: Array, beta: Array, K: Array, active: Flags, status: Statuses) -> TrackOptimum:
    bad = _hidden(status)
    alpha, beta, K = (np.where(bad, np.nan, part) for part in (alpha, beta, K))
    return TrackOptimum(alpha, beta, K, np.where(bad, 0, active).astype(np.int16), status)


def _printed_accelerations(
    P: Array, c: Array, G: Array, mu: Array, alpha: Array, beta: Array
) -> tuple[Array, Array]:
    """Return a_x and a_y of (3.11)."""
    friction = mu * (G - P * np.sin(beta))
    push = P * np.cos(beta)
    return push * np.cos(alpha) - c - friction, push * np.sin(alpha) - friction


def _curve_beta(alpha: Array, mu: Array) -> Array:
    return np.asarray(np.arctan(mu * (np.cos(alpha) + np.sin(alpha))))


def _on_curve(level: Array, mu: Array) -> tuple[Array, Array]:
    """Return the point of the curve tan(beta) = mu (ca + sa) with d_y + mu d_z = level.

    It is the highest point over d_x + mu d_z of the circle that the plane of the level cuts from
    the unit sphere: the foot of the plane plus a step along the projected gradient.
    """
    A2 = 1.0 + mu * mu
    A = np.hypot(1.0, mu)
    s = np.minimum(level / A, 1.0)
    x = np.sqrt((1 - s) * (1 + s)) * np.sqrt(A2 / (1 + 2 * mu * mu))
    y = s / A - x * (mu * mu / A2)
    alpha = np.clip(np.arctan2(y, x), 0.0, np.pi / 2)
    return alpha, _curve_beta(alpha, mu)


def _alpha_max(g: Array, mu: Array) -> Array:
    """Return where a_y = 0 on the curve of case B; 90 deg where it stays negative."""
    return _on_curve(np.minimum(mu * g, np.hypot(1.0, mu)), mu)[0]


# --- friction disc; all in units of P: k = c/P, g = G/P

Candidate = tuple[Array, Array, Array, Mask]
"""alpha, beta, whether it is a candidate, and whether static friction still holds there."""


def _straight(k: Array, g: Array, mu: Array, mu_s: Array) -> tuple[Candidate, Candidate]:
    """Return alpha = 0 at the best angle of slip, and at the edge of stick."""
    zero = np.zeros_like(k)
    lift_off = np.arcsin(np.minimum(g, 1.0))
    beta = np.minimum(np.arctan(mu), lift_off)
    # At lift-off there is nothing to hold the part; g - sin(beta) is rounding there.
    floor = np.where(beta < lift_off, g - np.sin(beta), 0.0)
    slips = np.cos(beta) - k > mu_s * floor
    share = (k + mu_s * g) / np.hypot(1.0, mu_s)
    edge = np.arctan(mu_s) - np.arccos(np.clip(share, -1.0, 1.0))
    starts = ~slips & (share < 1) & (edge >= 0) & (edge < lift_off) & (mu_s > mu)
    return (zero, beta, zero, np.asarray(slips)), (zero, edge, zero + 1, np.asarray(starts))


def _turned_block(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    """Return the interior maximum over the direction of friction, x = cos(psi)."""
    A = np.hypot(1.0, mu)
    p2 = (1 - k) * (1 + k)
    exists = (k > 0) & (p2 > 0) & (A * np.sqrt(np.maximum(p2, 0.0)) > mu * g)
    p2, k1 = np.where(exists, p2, 1.0), np.where(exists, k, 0.5)
    x = np.zeros_like(k1)
    for _ in range(MOST_STEPS):
        root = np.sqrt(p2 + (k1 * x) ** 2)
        t = k1 * x / root
        slope = A * (p2 / root + 2 * k1 * x * t) - 2 * k1 * x - mu * g
        bend = k1 * (A * t * (3 - t * t) - 2)
        # A convex slope that no longer falls, or a root beyond 1: no maximum inside.
        exists &= (bend < 0) | (slope <= 0)
        ahead = x - slope / np.where(bend < 0, bend, -1.0)
        exists &= ahead < 1
        moving = exists & (ahead > x)
        if not np.any(moving):
            break
        x = np.where(moving, ahead, x)
    exists &= x > 0
    x = np.where(exists, x, 1.0)
    sine = np.sqrt((1 - x) * (1 + x))
    root = np.sqrt(np.maximum(1 - np.where(exists, k, 0.0) ** 2 * sine**2, 0.0))
    dx, dy = k * sine**2 + root * x / A, -k * sine * x + root * sine / A
    dz = root * mu / A
    exists &= dz < np.minimum(g, 1.0)
    excess = A * root - mu * g - k * x  # |D| - mu n
    exists &= (excess > (mu_s - mu) * (g - dz)) & (excess > 0) & (dy > 0)
    alpha = np.arctan2(np.where(exists, dy, 0.0), np.where(exists, dx, 1.0))
    beta = np.arcsin(np.where(exists, dz, 0.0))
    return alpha, beta, np.zeros_like(k), np.asarray(exists)


def _edge_block(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    """Return the best point of |D| = mu_s n with alpha > 0: a_x = D_x (1 - mu_k/mu_s) there.

    |D|^2 = q^2 - k^2 - 2 k D_x, q = cos(beta), so that D_x is largest where q^2 - (mu_s n)^2 is.
    """
    dz = g * (mu_s / np.hypot(1.0, mu_s)) ** 2
    q2 = (1 - dz) * (1 + dz)
    exists = (k > 0) & (q2 > 0) & (mu_s > mu)
    q = np.sqrt(np.where(exists, q2, 1.0))
    k1 = np.where(exists, k, 1.0)
    Dx = (q * q - k1 * k1 - (mu_s * (g - dz)) ** 2) / (2 * k1)
    exists &= (Dx > 0) & (Dx < q - k1)
    side = np.sqrt(np.where(exists, (q - Dx - k1) * (q + Dx + k1), 0.0))
    alpha = np.arctan2(side, np.where(exists, Dx + k1, 1.0))
    beta = np.arcsin(np.where(exists, dz, 0.0))
    return alpha, beta, np.ones_like(k), np.asarray(exists)


def _cylinder_value(
    psi: NDArray[np.complexfloating], k: Array, g: Array, mu: Array
) -> tuple[NDArray[np.complexfloating], NDArray[np.complexfloating]]:
    """Return the best a_x for a slip along psi, and d_z there."""
    s, x = np.sin(psi), np.cos(psi)
    w = s * (2 * mu * g * x - k)
    uv = -s * (1 - 2 * (mu * x) ** 2)
    v2 = 1 + (2 * mu * s * x) ** 2
    left = v2 - w * w
    root = np.sqrt(np.where(left.real > 0, left, 0.0))
    steep = np.sqrt(1 + mu * mu * (1 + 8 * s * s))
    value = (w * uv + root * x * steep) / v2 - k - mu * g * x
    vz = 2 * mu * s * x
    # d = w v/|v|^2 + root (u - (u.v) v/|v|^2)/(x steep), and u_z - ... = mu x (1 + 2 s^2)/|v|^2
    height = (w * vz + root * mu * (1 + 2 * s * s) / steep) / v2
    return np.where(left.real > 0, value, -np.inf), height


def _turned_cylinder(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    """Return the best point with a slip at an angle to x; sampled, then bisected."""
    zero = np.zeros_like(k)
    exists = k > 0
    if not np.any(exists):
        return zero, zero, zero, np.asarray(exists)
    samples = np.linspace(0.0, np.pi / 2, DIRECTIONS)
    best, place = np.full(k.shape, -np.inf), np.zeros(k.shape, dtype=np.int64)
    for number, psi in enumerate(samples):
        value, height = _cylinder_value(np.full(k.shape, psi, dtype=complex), k, g, mu)
        better = (value.real > best) & (height.real < g)
        best, place = np.where(better, value.real, best), np.where(better, number, place)
    exists &= place > 0
    low = samples[np.maximum(place - 1, 0)]
    high = samples[np.minimum(place + 1, DIRECTIONS - 1)]
    step = 1e-30  # the derivative of an analytic function, without a difference
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        slope = _cylinder_value(middle + 1j * step, k, g, mu)[0].imag
        rises = slope > 0
        low, high = np.where(rises, middle, low), np.where(rises, high, middle)
    psi = (low + high) / 2
    top, d_z = _cylinder_value(psi + 0j, k, g, mu)
    value, dz = np.asarray(top.real), np.asarray(d_z.real)
    exists &= (dz < np.minimum(g, 1.0)) & (dz > -1) & (value > 0)
    dz = np.where(exists, dz, 0.0)
    m = mu * (g - dz)
    Dx = np.where(exists, value, 0.0) + m * np.cos(psi)
    Dy = Dx * np.tan(psi) + 2 * m * np.sin(psi)
    exists &= np.hypot(Dx, Dy / 3) > mu_s * (g - dz)
    exists &= Dx / np.cos(psi) > m
    alpha = np.where(exists, np.arctan2(Dy, np.where(exists, Dx + k, 1.0)), 0.0)
    return alpha, np.where(exists, np.arcsin(dz), 0.0), zero, np.asarray(exists)


def _cylinder_edge_point(
    eta: Array, k: Array, g: Array, mu: Array, mu_s: Array
) -> tuple[Array, Array, Array, Array]:
    """Return a_x, D_x, D_y and n at D_x = mu_s n cos(eta), D_y = 3 mu_s n sin(eta).

    a_x is -inf where no drive gets there. The drive's unit length leaves a quadratic in n; a_x is
    a multiple of n, so the larger root.
    """
    along, across = mu_s * np.cos(eta), 3 * mu_s * np.sin(eta)
    a, b = 1 + along**2 + across**2, g - k * along
    left = b * b - a * (k * k + g * g - 1)
    n = (b + np.sqrt(np.maximum(left, 0.0))) / a
    meets = (left >= 0) & (n > 0) & (n <= g)
    n = np.where(meets, n, 1.0)
    D = (along * n, across * n)
    value = _cylinder_acceleration(D, n, mu)[0]
    return np.where(meets, value, -np.inf), *D, n


def _edge_cylinder(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    """Return the best point where static friction just holds; sampled, then by golden sections."""
    zero = np.zeros_like(k)
    exists = (k > 0) & (mu_s > mu)
    if not np.any(exists):
        return zero, zero, zero, np.asarray(exists)
    given = (k, g, mu, mu_s)
    samples = np.linspace(0.0, np.pi / 2, DIRECTIONS)
    best, place = np.full(k.shape, -np.inf), np.zeros(k.shape, dtype=np.int64)
    for number, eta in enumerate(samples):
        value = _cylinder_edge_point(np.full(k.shape, eta), *given)[0]
        better = value > best
        best, place = np.where(better, value, best), np.where(better, number, place)
    exists &= place > 0
    low, high = samples[np.maximum(place - 1, 0)], samples[np.minimum(place + 1, DIRECTIONS - 1)]
    for _ in range(GOLDEN_SECTIONS):
        left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        falls = _cylinder_edge_point(left, *given)[0] > _cylinder_edge_point(right, *given)[0]
        low, high = np.where(falls, low, left), np.where(falls, right, high)
    value, Dx, Dy, n = _cylinder_edge_point((low + high) / 2, *given)
    exists &= value > 0
    alpha = np.where(exists, np.arctan2(Dy, np.where(exists, Dx + k, 1.0)), 0.0)
    beta = np.arcsin(np.where(exists, g - n, 0.0))
    return alpha, beta, zero + 1, np.asarray(exists)


def _block_acceleration(D: tuple[Array, Array], floor: Array, mu: Array) -> tuple[Array, Array]:
    """Return D (1 - mu n/|D|), sliding from rest."""
    left = 1.0 - ratio(mu * floor, np.hypot(*D), 0.0)
    return D[0] * left, D[1] * left


def _cylinder_acceleration(D: tuple[Array, Array], floor: Array, mu: Array) -> tuple[Array, Array]:
    """Return the acceleration of a cylinder whose contact slips from rest (theory 7.3)."""
    friction: dict[str, Array] = {"friction_kinetic": mu, "floor_acceleration": floor}
    z = rolling.roll_root(
        in_plane_drive_x=D[0], in_plane_drive_y=D[1], friction_static=mu, **friction
    )
    return (
        rolling.slipping_acceleration_x(in_plane_drive_x=D[0], roll_root=z, **friction),
        rolling.slipping_acceleration_y(in_plane_drive_y=D[1], roll_root=z, **friction),
    )


def _best_physical(
    P: Array,
    c: Array,
    G: Array,
    mu: Array,
    mu_s: Array,
    valid: Mask,
    driven: Mask,
    candidates: tuple[Candidate, ...],
    accelerate: Callable[[tuple[Array, Array], Array, Array], tuple[Array, Array]],
) -> PlaneOptimum:
    """Return the candidate with the largest a_x."""
    zero = np.zeros_like(P)
    alpha, beta, held, across = zero, zero, zero, zero
    along = np.full_like(P, -np.inf)
    for a, b, at_edge, exists in candidates:
        floor = np.maximum(G - P * np.sin(b), 0.0)
        push = P * np.cos(b)
        ax, ay = accelerate((push * np.cos(a) - c, push * np.sin(a)), floor, mu)
        better = exists & driven & (ax > along)
        along, across = np.where(better, ax, along), np.where(better, ay, across)
        alpha, beta = np.where(better, a, alpha), np.where(better, b, beta)
        held = np.where(better, at_edge, held)
    # Without drive the part rests, or slides down the slope.
    slides = np.abs(c) > mu_s * G
    idle = np.where(slides, -c + np.sign(c) * mu * G, 0.0)
    status = _statuses(valid, np.zeros_like(valid), driven, along)
    status = np.where((status == STATUS["optimal"]) & (held > 0), STATUS["not_attained"], status)
    status = status.astype(np.int8)
    active = _bounds_active(alpha, beta) | _tight(ACTIVE["floor"], G - P * np.sin(beta), P + G)
    active |= np.where(held > 0, ACTIVE["start"], 0).astype(np.int16)
    still = status == STATUS["no_motion"]
    flat = status == STATUS["flat"]
    along, across = np.where(flat, idle, along), np.where(flat, 0.0, across)
    alpha, beta, along, across = (
        np.where(still, np.nan, part) for part in (alpha, beta, along, across)
    )
    return _plane(alpha, beta, along, across, np.where(still, 0, active).astype(np.int16), status)


# --- track, physical; y = g_y/P, z = g_z/P


def _both_contacts(y: Array, z: Array, mu: Array) -> tuple[Array, Array]:
    """Return the angles of the largest d_x + mu (d_y + d_z) with d_y <= y, d_z <= z."""
    kept = np.minimum(y, 1.0)
    wall = np.minimum(mu * np.sqrt((1 - kept) * (1 + kept)) / np.hypot(1.0, mu), z)
    across = np.sqrt(np.maximum((1 - wall) * (1 + wall) - kept * kept, 0.0))
    at_wall = (y < 1) & (kept <= mu * across)
    free = np.minimum(mu / np.sqrt(1 + 2 * mu * mu), z)
    alpha = np.where(at_wall, np.arctan2(kept, across), np.arctan(mu))
    return alpha, np.arcsin(np.where(at_wall, wall, free))


def _both_value(
    P: Array, c: Array, gy: Array, gz: Array, mu: Array, alpha: Array, beta: Array
) -> Array:
    """Return K_0 of theory 4.4."""
    push = P * np.cos(beta)
    floor, wall = gz - P * np.sin(beta), gy - push * np.sin(alpha)
    return np.asarray(push * np.cos(alpha) - c - mu * (floor + wall))
