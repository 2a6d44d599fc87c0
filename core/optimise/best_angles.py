"""Best angles of the drive in closed form: their records, and parts under the friction disc.

The forms hold for 0 <= alpha, beta <= 90 deg, any climb with `gravity_normal` >= 0, and a part at
rest. Arguments broadcast; float64, SI units, radians. `gravity_along` is g sin(gamma),
`gravity_normal` g cos(gamma) (times cos(delta) on the track), `gravity_across` g cos(gamma)
sin(delta). Inside, everything is divided by the drive acceleration P: k = c/P, g = G/P.

Block (theory 12.2) and cylinder (theory 7.3, 12.2) share `fastest_slide`.
"""

import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.mechanics import rolling
from vibrafeed.core.mechanics.arrays import Array, Mask, ratio
from vibrafeed.core.optimise.problem import STATUS
from vibrafeed.core.study.optimise_study import Criterion, Maximise

Statuses = NDArray[np.int8]
"""Values of `STATUS`."""


class Optimum(NamedTuple):
    """The best angles, or points of a front that no other angles beat in a_x and in |a_y|.

    All arrays have the broadcast shape; those of fronts a last axis that counts the points, without
    which `status` is.

    Attributes
    ----------
    alpha, beta : ndarray
        Azimuth and elevation of the drive [rad]; NaN where there are none.
    acceleration_x, acceleration_y : ndarray
        The accelerations there; on the track K = a_x at rest, and 0 [m s-2].
    status : ndarray of int8
        Value of an `OPTIMUM_STATUSES` entry.
    """

    alpha: Array
    beta: Array
    acceleration_x: Array
    acceleration_y: Array
    status: Statuses


def broadcast(*arguments: ArrayLike) -> tuple[Array, ...]:
    """Return the arguments as float64 arrays broadcast to one shape."""
    return tuple(
        np.broadcast_arrays(*(np.asarray(argument, dtype=np.float64) for argument in arguments))
    )


def valid_inputs(
    within: Mask, drive: Array, *arguments: Array
) -> tuple[Mask, Mask, tuple[Array, ...]]:
    """Return the valid cells, the driven cells, and the arguments with 0 in invalid cells.

    Valid is what is finite, and `within` its range; driven where the drive is above 0 there, too.
    The zeros spare warnings from NaN.
    """
    valid = np.asarray(
        within & np.all([np.isfinite(argument) for argument in (drive, *arguments)], axis=0)
    )
    cleared = tuple(np.where(valid, argument, 0.0) for argument in (drive, *arguments))
    return valid, valid & (drive > 0), cleared


def statuses(valid: Mask, infeasible: Mask, driven: Mask, gain: Array) -> Statuses:
    """Return the status of each optimum of the drive's angles, int8, from masks of the designs.

    All arrays have one shape: `valid` is True for inputs in range, `infeasible` where no angles
    keep the limits, `driven` where there is a drive; without one all angles are equal (flat).
    `gain` is positive where the part moves forwards.
    """
    status = np.where(gain > 0, STATUS["optimal"], STATUS["no_motion"])
    status = np.where(driven, status, STATUS["flat"])
    status = np.where(infeasible, STATUS["infeasible"], status)
    return np.asarray(np.where(valid, status, STATUS["invalid"]), dtype=np.int8)


def optimum(alpha: Array, beta: Array, along: Array, across: Array, status: Statuses) -> Optimum:
    """Return the record of an optimum; NaN where the status says that there is none.

    `along` and `across` are a_x and a_y there [m s-2].
    """
    without_optimum = (status == STATUS["infeasible"]) | (status == STATUS["invalid"])
    alpha, beta, along, across = (
        np.where(without_optimum, np.nan, values) for values in (alpha, beta, along, across)
    )
    return Optimum(alpha, beta, along, across, status)


Closed = Callable[..., Optimum]
"""A closed form; its arguments are what it needs of a design."""


@dataclass(frozen=True)
class Family:
    """Problems of one kind whose best angles are known.

    Attributes
    ----------
    systems : tuple
        Scene, variant and the output that is to be largest, of each problem.
    closed : mapping
        Closed forms by the criterion that they solve: both angles from 0 to 90 degrees.
    against : str or None
        The output whose absolute value can be kept low.
    contacts : frozenset of str
        Contacts that a study has to keep.
    """

    systems: tuple[tuple[str, str, str], ...]
    closed: Mapping[type[Criterion], Closed] = field(hash=False)
    against: str | None = "acceleration_y"
    contacts: frozenset[str] = frozenset()

    def closed_optimum(self, criterion: Criterion, values: Mapping[str, Any]) -> Optimum:
        """Return the closed-form optimum of drive angles, or trade-off front, for a criterion.

        `values` has all inputs of the designs by name, arrays (cells,) in SI units; the formula
        takes those it needs.
        """
        closed_form = self.closed[type(criterion)]
        parameters = inspect.signature(closed_form).parameters.values()
        needed = [
            parameter.name
            for parameter in parameters
            if parameter.default is inspect.Parameter.empty
        ]
        return closed_form(**{name: values[name] for name in needed})


Candidate = tuple[Array, Array, Array, Mask]
"""alpha, beta, 1 where static friction still holds there, and whether it is a candidate."""

Accelerate = Callable[[tuple[Array, Array], Array, Array], tuple[Array, Array]]
"""Takes the drive in the plane less gravity, the floor's n0 and mu; returns a_x and a_y."""

SidewaysDrive = Callable[[Array, Array, Array, Array], Candidate]
"""Takes k, g, mu and the static mu; returns the best drive from the side."""


def _drives_along_track(k: Array, g: Array, mu: Array, mu_s: Array) -> tuple[Candidate, Candidate]:
    # Two drives along the track: the best one that slips, and the edge of stick.
    zero = np.zeros_like(k)
    lift_off = np.arcsin(np.minimum(g, 1.0))
    beta = np.minimum(np.arctan(mu), lift_off)
    # At lift-off the normal force is 0: g - sin(beta) would leave rounding.
    normal_force = np.where(beta < lift_off, g - np.sin(beta), 0.0)
    slips = np.cos(beta) - k > mu_s * normal_force
    sine = (k + mu_s * g) / np.hypot(1.0, mu_s)
    # The edge of stick: cos(beta) - k = mu_s (g - sin(beta)).
    edge_beta = np.arctan(mu_s) - np.arccos(np.clip(sine, -1.0, 1.0))
    edge_exists = ~slips & (sine < 1) & (edge_beta >= 0) & (edge_beta < lift_off) & (mu_s > mu)
    slipping = zero, beta, zero, np.asarray(slips)
    return slipping, (zero, edge_beta, zero + 1, np.asarray(edge_exists))


def fastest_slide(
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    friction_static: ArrayLike,
    best_sideways: SidewaysDrive,
    stick_edge: SidewaysDrive,
    accelerate: Accelerate,
) -> Optimum:
    """Return the drive angles of the largest a_x on a plane: straight along x, or to the side.

    Arguments broadcast; values out of range get the status `invalid`. The result has the angles
    [rad], a_x and a_y [m/s2] and a status. All candidates are closed forms or
    iterations of few steps; the best in each cell is taken.
    """
    P, c, G, mu, mu_s = broadcast(
        vibration_acceleration, gravity_along, gravity_normal, friction_kinetic, friction_static
    )
    within = (P >= 0) & (G >= 0) & (mu >= 0) & (mu_s >= mu)
    valid, driven, (P, c, G, mu, mu_s) = valid_inputs(within, P, c, G, mu, mu_s)
    scale = np.where(driven, P, 1.0)
    k, g = c / scale, G / scale  # gravity along -x and onto the floor, over P
    candidates = (
        *_drives_along_track(k, g, mu, mu_s),
        best_sideways(k, g, mu, mu_s),
        stick_edge(k, g, mu, mu_s),
    )
    zero = np.zeros_like(P)
    alpha, beta, at_edge, across = zero, zero, zero, zero
    along = np.full_like(P, -np.inf)
    for candidate_alpha, candidate_beta, sticks, exists in candidates:
        normal_force = np.maximum(G - P * np.sin(candidate_beta), 0.0)
        in_plane = P * np.cos(candidate_beta)
        ax, ay = accelerate(
            (in_plane * np.cos(candidate_alpha) - c, in_plane * np.sin(candidate_alpha)),
            normal_force,
            mu,
        )
        better = exists & driven & (ax > along)
        along, across = np.where(better, ax, along), np.where(better, ay, across)
        alpha, beta = (
            np.where(better, candidate_alpha, alpha),
            np.where(better, candidate_beta, beta),
        )
        at_edge = np.where(better, sticks, at_edge)
    # Without a drive the part rests, or slides down the slope.
    undriven = np.where(np.abs(c) > mu_s * G, -c + np.sign(c) * mu * G, 0.0)
    status = statuses(valid, np.zeros_like(valid), driven, along)
    status = np.where((status == STATUS["optimal"]) & (at_edge > 0), STATUS["not_attained"], status)
    status = status.astype(np.int8)
    no_motion = status == STATUS["no_motion"]
    flat = status == STATUS["flat"]
    along, across = np.where(flat, undriven, along), np.where(flat, 0.0, across)
    alpha, beta, along, across = (
        np.where(no_motion, np.nan, values) for values in (alpha, beta, along, across)
    )
    return optimum(alpha, beta, along, across, status)


# Newton's steps for the tilted optimum; more are needed only where two roots all but meet.
MAX_STEPS = 60


def plane_physical_fastest(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    friction_static: ArrayLike,
) -> Optimum:
    """Return the drive angles of the largest a_x of a block on a plane with the friction disc.

    On a horizontal or falling track: alpha = 0, a_y = 0, beta = min(atan(mu_k), asin(G/P)), and
    there is no trade-off. On a climbing track a drive close to the limit of motion does better from
    the side: it turns friction away from x (theory 12.2). For a friction along -(cos psi, sin psi)
    the best a_x is

        V = cos psi [sqrt(1 + mu^2) sqrt(P^2 - c^2 sin^2 psi) - mu G - c cos psi],

    whose derivative by cos(psi) is convex, so that Newton's method from cos(psi) = 0 climbs to the
    one interior maximum; it is compared with alpha = 0.

    `vibration_acceleration` is P, `gravity_along` and `gravity_normal` are gravity along -x, c, and
    onto the floor, G [m/s2], `friction_kinetic` is mu and `friction_static` mu_s >= mu; all
    broadcast. The status is `no_motion` with NaN where no drive moves the part, `not_attained` at
    the edge of stick. The result has the angles [rad], a_x and a_y [m/s2] and a
    status.
    """
    return fastest_slide(
        vibration_acceleration,
        gravity_along,
        gravity_normal,
        friction_kinetic,
        friction_static,
        _sideways_block,
        _stick_edge_block,
        _block_acceleration,
    )


def _sideways_block(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    # The best drive from the side, which turns friction away from the track (theory 12.2). Newton's
    # method finds the direction of friction x = cos(psi) of the largest
    # V = x [A sqrt(1 - k^2 (1 - x^2)) - mu g - k x], A = sqrt(1 + mu^2).
    A = np.hypot(1.0, mu)
    p2 = (1 - k) * (1 + k)
    exists = (k > 0) & (p2 > 0) & (A * np.sqrt(np.maximum(p2, 0.0)) > mu * g)
    p2, k1 = np.where(exists, p2, 1.0), np.where(exists, k, 0.5)
    x = np.zeros_like(k1)
    for _ in range(MAX_STEPS):
        root = np.sqrt(p2 + (k1 * x) ** 2)
        t = k1 * x / root
        slope = A * (p2 / root + 2 * k1 * x * t) - 2 * k1 * x - mu * g
        slope_derivative = k1 * (A * t * (3 - t * t) - 2)
        # V' is convex: once it no longer falls, or its root is beyond 1, no maximum is inside.
        exists &= (slope_derivative < 0) | (slope <= 0)
        next_x = x - slope / np.where(slope_derivative < 0, slope_derivative, -1.0)
        exists &= next_x < 1
        advances = exists & (next_x > x)
        if not np.any(advances):
            break
        x = np.where(advances, next_x, x)
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


def _stick_edge_block(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    # The best drive from the side at the edge of stick, |D| = mu_s n: a_x = D_x (1 - mu_k/mu_s),
    # with D the drive in the plane less gravity and n the normal force per mass. As |D|^2 = q^2 -
    # k^2 - 2 k D_x with q = cos(beta), D_x is largest where q^2 - (mu_s n)^2 is.
    dz = g * (mu_s / np.hypot(1.0, mu_s)) ** 2
    q2 = (1 - dz) * (1 + dz)
    exists = (k > 0) & (q2 > 0) & (mu_s > mu)
    q = np.sqrt(np.where(exists, q2, 1.0))
    k1 = np.where(exists, k, 1.0)
    Dx = (q * q - k1 * k1 - (mu_s * (g - dz)) ** 2) / (2 * k1)
    exists &= (Dx > 0) & (Dx < q - k1)
    Dy = np.sqrt(np.where(exists, (q - Dx - k1) * (q + Dx + k1), 0.0))
    alpha = np.arctan2(Dy, np.where(exists, Dx + k1, 1.0))
    beta = np.arcsin(np.where(exists, dz, 0.0))
    return alpha, beta, np.ones_like(k), np.asarray(exists)


def _block_acceleration(D: tuple[Array, Array], floor: Array, mu: Array) -> tuple[Array, Array]:
    # D (1 - mu n/|D|) of a part that slides from rest.
    left = 1.0 - ratio(mu * floor, np.hypot(*D), 0.0)
    return D[0] * left, D[1] * left


BLOCK = Family(
    systems=(("rectangle-on-plane", "physical", "acceleration_x"),),
    closed={Maximise: plane_physical_fastest},
    contacts=frozenset({"floor_contact"}),
)


# Friction directions at which the value is sampled before its root is bisected.
DIRECTIONS = 129
BISECTIONS = 52
GOLDEN_SECTIONS = 40
GOLDEN = (math.sqrt(5.0) - 1) / 2


def cylinder_physical_fastest(
    *,
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    friction_static: ArrayLike,
) -> Optimum:
    """Return the drive angles of the largest a_x of a cylinder on the floor (theory 7.3, 12.2).

    As for a block alpha = 0, beta = min(atan(mu_k), asin(G/P)), and a_y = 0. A drive from the side
    does better only on tracks much steeper than friction (c > 8 mu n at the limit of motion, with
    the normal force n per mass). For a contact slip along (cos psi, sin psi) the best a_x is again
    a closed form of psi; its maximum is sampled and then bisected to rounding, and on the edge of
    stick by golden sections, to 1e-7 rad.

    `vibration_acceleration` is P, `gravity_along` and `gravity_normal` are gravity along -x, c, and
    onto the floor, G [m/s2], `friction_kinetic` is mu and `friction_static` at least that; they
    broadcast. The result has the angles [rad], a_x and a_y [m/s2] and a status.
    """
    return fastest_slide(
        vibration_acceleration,
        gravity_along,
        gravity_normal,
        friction_kinetic,
        friction_static,
        _sideways_cylinder,
        _stick_edge_cylinder,
        _cylinder_acceleration,
    )


def _sideways_cylinder(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    # The best drive of a contact that slips at an angle to the track, bisected to rounding.
    zero = np.zeros_like(k)
    exists = k > 0
    if not np.any(exists):
        return zero, zero, zero, np.asarray(exists)
    low, high, inside = _bracket(lambda psi: _largest_slip_acceleration(psi + 0j, k, g, mu), g)
    exists &= inside
    step = 1e-30  # complex step: f'(psi) = Im f(psi + i step)/step, only its sign is needed
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        slope = _largest_slip_acceleration(middle + 1j * step, k, g, mu)[0].imag
        is_rising = slope > 0
        low, high = np.where(is_rising, middle, low), np.where(is_rising, high, middle)
    psi = (low + high) / 2
    complex_value, complex_dz = _largest_slip_acceleration(psi + 0j, k, g, mu)
    value, dz = np.asarray(complex_value.real), np.asarray(complex_dz.real)
    exists &= (dz < np.minimum(g, 1.0)) & (dz > -1) & (value > 0)
    dz = np.where(exists, dz, 0.0)
    friction = mu * (g - dz)
    Dx = np.where(exists, value, 0.0) + friction * np.cos(psi)
    Dy = Dx * np.tan(psi) + 2 * friction * np.sin(psi)
    exists &= np.hypot(Dx, Dy / 3) > mu_s * (g - dz)
    exists &= Dx / np.cos(psi) > friction
    alpha = np.where(exists, np.arctan2(Dy, np.where(exists, Dx + k, 1.0)), 0.0)
    return alpha, np.where(exists, np.arcsin(dz), 0.0), zero, np.asarray(exists)


def _stick_edge_cylinder(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    # The best drive at the limit of static friction, closed in on by golden sections.
    zero = np.zeros_like(k)
    exists = (k > 0) & (mu_s > mu)
    if not np.any(exists):
        return zero, zero, zero, np.asarray(exists)
    inputs = (k, g, mu, mu_s)
    low, high, inside = _bracket(lambda eta: (_stick_edge_point(eta, *inputs)[0], -np.inf), g)
    exists &= inside
    for _ in range(GOLDEN_SECTIONS):
        inner_low, inner_high = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        is_falling = (
            _stick_edge_point(inner_low, *inputs)[0] > _stick_edge_point(inner_high, *inputs)[0]
        )
        low, high = np.where(is_falling, low, inner_low), np.where(is_falling, inner_high, high)
    value, Dx, Dy, n = _stick_edge_point((low + high) / 2, *inputs)
    exists &= value > 0
    alpha = np.where(exists, np.arctan2(Dy, np.where(exists, Dx + k, 1.0)), 0.0)
    beta = np.arcsin(np.where(exists, g - n, 0.0))
    return alpha, beta, zero + 1, np.asarray(exists)


def _largest_slip_acceleration(
    psi: NDArray[np.complexfloating], k: Array, g: Array, mu: Array
) -> tuple[NDArray[np.complexfloating], NDArray[np.complexfloating]]:
    # The largest a_x = d.u - k - mu g x of a cylinder whose contact slips along psi, over unit
    # drives d, with s, x = sin(psi), cos(psi) and u = (1, 0, mu x). It slips so where d.v = w with
    # v = (-s, x, 2 mu s x) (theory 7.3); -inf where no drive does that. Also the drive's d_z. An
    # imaginary step of psi gives the derivative. The largest d.u over unit drives d with d.v = w is
    # (w u.v + sqrt(|v|^2 - w^2) |u x v|)/|v|^2, and |u x v| is x times `cross_over_x`.
    s, x = np.sin(psi), np.cos(psi)
    w = s * (2 * mu * g * x - k)
    uv = -s * (1 - 2 * (mu * x) ** 2)
    v2 = 1 + (2 * mu * s * x) ** 2
    discriminant = v2 - w * w
    root = np.sqrt(np.where(discriminant.real > 0, discriminant, 0.0))
    cross_over_x = np.sqrt(1 + mu * mu * (1 + 8 * s * s))
    value = (w * uv + root * x * cross_over_x) / v2 - k - mu * g * x
    v_z = 2 * mu * s * x
    # d = w v/|v|^2 + root (u - (u.v) v/|v|^2)/(x cross_over_x): u_z - ... = mu x (1 + 2 s^2)/|v|^2
    d_z = (w * v_z + root * mu * (1 + 2 * s * s) / cross_over_x) / v2
    return np.where(discriminant.real > 0, value, -np.inf), d_z


def _bracket(
    value_of: Callable[[Array], tuple[Any, Any]], max_height: Array
) -> tuple[Array, Array, Mask]:
    # The neighbours of the best sample, since the value may have more than one maximum, and whether
    # it is not the first sample. `value_of` also returns a height, which has to stay below
    # `max_height`.
    samples = np.linspace(0.0, np.pi / 2, DIRECTIONS)
    best_value, best_number = (
        np.full(max_height.shape, -np.inf),
        np.zeros(max_height.shape, dtype=np.int64),
    )
    for number, angle in enumerate(samples):
        value, height = (np.real(part) for part in value_of(np.full(max_height.shape, angle)))
        better = (value > best_value) & (height < max_height)
        best_value, best_number = (
            np.where(better, value, best_value),
            np.where(better, number, best_number),
        )
    low = samples[np.maximum(best_number - 1, 0)]
    return low, samples[np.minimum(best_number + 1, DIRECTIONS - 1)], best_number > 0


def _stick_edge_point(
    eta: Array, k: Array, g: Array, mu: Array, mu_s: Array
) -> tuple[Array, Array, Array, Array]:
    # a_x, D_x, D_y and n at the limit of static friction in the direction eta: the drive's unit
    # length, (k + along n)^2 + (across n)^2 + (g - n)^2 = 1, is a quadratic in n; a_x is a multiple
    # of n, so that the larger root counts.
    along, across = mu_s * np.cos(eta), 3 * mu_s * np.sin(eta)
    quadratic, half_linear = 1 + along**2 + across**2, g - k * along
    discriminant = half_linear * half_linear - quadratic * (k * k + g * g - 1)
    n = (half_linear + np.sqrt(np.maximum(discriminant, 0.0))) / quadratic
    exists = (discriminant >= 0) & (n > 0) & (n <= g)
    n = np.where(exists, n, 1.0)
    D = (along * n, across * n)
    value = _cylinder_acceleration(D, n, mu)[0]
    return np.where(exists, value, -np.inf), *D, n


def _cylinder_acceleration(D: tuple[Array, Array], floor: Array, mu: Array) -> tuple[Array, Array]:
    friction: dict[str, Array] = {"friction_kinetic": mu, "floor_acceleration": floor}
    z = rolling.roll_root(
        in_plane_drive_x=D[0], in_plane_drive_y=D[1], friction_static=mu, **friction
    )
    return (
        rolling.slipping_acceleration_x(in_plane_drive_x=D[0], roll_root=z, **friction),
        rolling.slipping_acceleration_y(in_plane_drive_y=D[1], roll_root=z, **friction),
    )


CYLINDER = Family(
    systems=(("cylinder-on-plane", "physical", "acceleration_x"),),
    closed={Maximise: cylinder_physical_fastest},
    contacts=frozenset({"floor_contact"}),
)
