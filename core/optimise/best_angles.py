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


def broadcast(*parts: ArrayLike) -> tuple[Array, ...]:
    """Return the arguments as float64 arrays broadcast to one shape."""
    return tuple(np.broadcast_arrays(*(np.asarray(part, dtype=np.float64) for part in parts)))


def valid_inputs(within: Mask, drive: Array, *parts: Array) -> tuple[Mask, Mask, tuple[Array, ...]]:
    """Return the valid cells, the driven cells, and the arguments with 0 in invalid cells.

    Valid is what is finite, and `within` its range; driven where the drive is above 0 there, too.
    The zeros spare warnings from NaN.
    """
    valid = np.asarray(within & np.all([np.isfinite(part) for part in (drive, *parts)], axis=0))
    return valid, valid & (drive > 0), tuple(np.where(valid, p, 0.0) for p in (drive, *parts))


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
    bad = (status == STATUS["infeasible"]) | (status == STATUS["invalid"])
    alpha, beta, along, across = (np.where(bad, np.nan, p) for p in (alpha, beta, along, across))
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
        form = self.closed[type(criterion)]
        parameters = inspect.signature(form).parameters.values()
        needed = [p.name for p in parameters if p.default is inspect.Parameter.empty]
        return form(**{name: values[name] for name in needed})


Candidate = tuple[Array, Array, Array, Mask]
"""alpha, beta, 1 where static friction still holds there, and whether it is a candidate."""

Accelerate = Callable[[tuple[Array, Array], Array, Array], tuple[Array, Array]]
"""Takes the drive in the plane less gravity, the floor's n0 and mu; returns a_x and a_y."""

Turned = Callable[[Array, Array, Array, Array], Candidate]
"""Takes k, g, mu and the static mu; returns the best drive from the side."""


def _straight(k: Array, g: Array, mu: Array, mu_s: Array) -> tuple[Candidate, Candidate]:
    # Two drives along the track: the best one that slips, and the edge of stick.
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


def fastest_slide(
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    friction_static: ArrayLike,
    turned: Turned,
    held: Turned,
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
    k, g = c / scale, G / scale
    candidates = (*_straight(k, g, mu, mu_s), turned(k, g, mu, mu_s), held(k, g, mu, mu_s))
    zero = np.zeros_like(P)
    alpha, beta, at_edge, across = zero, zero, zero, zero
    along = np.full_like(P, -np.inf)
    for a, b, holds, exists in candidates:
        floor = np.maximum(G - P * np.sin(b), 0.0)
        push = P * np.cos(b)
        ax, ay = accelerate((push * np.cos(a) - c, push * np.sin(a)), floor, mu)
        better = exists & driven & (ax > along)
        along, across = np.where(better, ax, along), np.where(better, ay, across)
        alpha, beta = np.where(better, a, alpha), np.where(better, b, beta)
        at_edge = np.where(better, holds, at_edge)
    # Without drive the part rests, or slides down the slope.
    slides = np.abs(c) > mu_s * G
    idle = np.where(slides, -c + np.sign(c) * mu * G, 0.0)
    status = statuses(valid, np.zeros_like(valid), driven, along)
    status = np.where((status == STATUS["optimal"]) & (at_edge > 0), STATUS["not_attained"], status)
    status = status.astype(np.int8)
    still = status == STATUS["no_motion"]
    flat = status == STATUS["flat"]
    along, across = np.where(flat, idle, along), np.where(flat, 0.0, across)
    alpha, beta, along, across = (
        np.where(still, np.nan, part) for part in (alpha, beta, along, across)
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
        _turned_block,
        _held_block,
        _block_acceleration,
    )


def _turned_block(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    # The best drive from the side, which turns friction away from the track (theory 12.2). The
    # direction of friction, x = cos(psi), is found by Newton's method.
    A = np.hypot(1.0, mu)
    p2 = (1 - k) * (1 + k)
    exists = (k > 0) & (p2 > 0) & (A * np.sqrt(np.maximum(p2, 0.0)) > mu * g)
    p2, k1 = np.where(exists, p2, 1.0), np.where(exists, k, 0.5)
    x = np.zeros_like(k1)
    for _ in range(MAX_STEPS):
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


def _held_block(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
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
    side = np.sqrt(np.where(exists, (q - Dx - k1) * (q + Dx + k1), 0.0))
    alpha = np.arctan2(side, np.where(exists, Dx + k1, 1.0))
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
        _turned_cylinder,
        _held_cylinder,
        _cylinder_acceleration,
    )


def _turned_cylinder(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    # The best drive of a contact that slips at an angle to the track, bisected to rounding.
    zero = np.zeros_like(k)
    exists = k > 0
    if not np.any(exists):
        return zero, zero, zero, np.asarray(exists)
    low, high, inside = _bracket(lambda psi: _slip_value(psi + 0j, k, g, mu), g)
    exists &= inside
    step = 1e-30  # the derivative of an analytic function, without a difference
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        slope = _slip_value(middle + 1j * step, k, g, mu)[0].imag
        rises = slope > 0
        low, high = np.where(rises, middle, low), np.where(rises, high, middle)
    psi = (low + high) / 2
    top, d_z = _slip_value(psi + 0j, k, g, mu)
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


def _held_cylinder(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    # The best drive at the limit of static friction, closed in on by golden sections.
    zero = np.zeros_like(k)
    exists = (k > 0) & (mu_s > mu)
    if not np.any(exists):
        return zero, zero, zero, np.asarray(exists)
    inputs = (k, g, mu, mu_s)
    low, high, inside = _bracket(lambda eta: (_held_point(eta, *inputs)[0], -np.inf), g)
    exists &= inside
    for _ in range(GOLDEN_SECTIONS):
        left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        falls = _held_point(left, *inputs)[0] > _held_point(right, *inputs)[0]
        low, high = np.where(falls, low, left), np.where(falls, right, high)
    value, Dx, Dy, n = _held_point((low + high) / 2, *inputs)
    exists &= value > 0
    alpha = np.where(exists, np.arctan2(Dy, np.where(exists, Dx + k, 1.0)), 0.0)
    beta = np.arcsin(np.where(exists, g - n, 0.0))
    return alpha, beta, zero + 1, np.asarray(exists)


def _slip_value(
    psi: NDArray[np.complexfloating], k: Array, g: Array, mu: Array
) -> tuple[NDArray[np.complexfloating], NDArray[np.complexfloating]]:
    # The largest a_x of a cylinder that slips along (cos psi, sin psi), -inf where no drive makes
    # it slip so, and the drive's d_z: the best elevation is a closed form. An imaginary step of psi
    # gives the derivative.
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


def _bracket(
    value_of: Callable[[Array], tuple[Any, Any]], below: Array
) -> tuple[Array, Array, Mask]:
    # Neighbours of the best sample, since the value may have more than one maximum, and whether it
    # is not the first one. The second result of `value_of`, the height, has to stay `below`.
    samples = np.linspace(0.0, np.pi / 2, DIRECTIONS)
    best, best_number = np.full(below.shape, -np.inf), np.zeros(below.shape, dtype=np.int64)
    for number, angle in enumerate(samples):
        value, height = (np.real(one) for one in value_of(np.full(below.shape, angle)))
        better = (value > best) & (height < below)
        best, best_number = np.where(better, value, best), np.where(better, number, best_number)
    low = samples[np.maximum(best_number - 1, 0)]
    return low, samples[np.minimum(best_number + 1, DIRECTIONS - 1)], best_number > 0


def _held_point(
    eta: Array, k: Array, g: Array, mu: Array, mu_s: Array
) -> tuple[Array, Array, Array, Array]:
    # a_x, D_x, D_y and n at the limit of static friction in the direction eta: the unit length of
    # the drive leaves a quadratic in n; a_x is a multiple of n, so that the larger root counts.
    along, across = mu_s * np.cos(eta), 3 * mu_s * np.sin(eta)
    a, b = 1 + along**2 + across**2, g - k * along
    left = b * b - a * (k * k + g * g - 1)
    n = (b + np.sqrt(np.maximum(left, 0.0))) / a
    meets = (left >= 0) & (n > 0) & (n <= g)
    n = np.where(meets, n, 1.0)
    D = (along * n, across * n)
    value = _cylinder_acceleration(D, n, mu)[0]
    return np.where(meets, value, -np.inf), *D, n


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
