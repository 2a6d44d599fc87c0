"""The cylinder on the floor, friction disc (theory 7.3, 12.2)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.mechanics import rolling
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.families.family import Family, Optimum
from vibrafeed.core.optimise.families.plane_physical import Candidate, fastest_slide
from vibrafeed.core.study.optimise_study import Maximise

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
        _turned,
        _held,
        _acceleration,
    )


def _turned(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    zero = np.zeros_like(k)
    exists = k > 0
    if not np.any(exists):
        return zero, zero, zero, np.asarray(exists)
    # Sampled first, since the value may have more than one maximum.
    samples = np.linspace(0.0, np.pi / 2, DIRECTIONS)
    best, best_number = np.full(k.shape, -np.inf), np.zeros(k.shape, dtype=np.int64)
    for number, psi in enumerate(samples):
        value, height = _value(np.full(k.shape, psi, dtype=complex), k, g, mu)
        better = (value.real > best) & (height.real < g)
        best, best_number = (
            np.where(better, value.real, best),
            np.where(better, number, best_number),
        )
    exists &= best_number > 0
    low = samples[np.maximum(best_number - 1, 0)]
    high = samples[np.minimum(best_number + 1, DIRECTIONS - 1)]
    step = 1e-30  # the derivative of an analytic function, without a difference
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        slope = _value(middle + 1j * step, k, g, mu)[0].imag
        rises = slope > 0
        low, high = np.where(rises, middle, low), np.where(rises, high, middle)
    psi = (low + high) / 2
    top, d_z = _value(psi + 0j, k, g, mu)
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


def _held(k: Array, g: Array, mu: Array, mu_s: Array) -> Candidate:
    zero = np.zeros_like(k)
    exists = (k > 0) & (mu_s > mu)
    if not np.any(exists):
        return zero, zero, zero, np.asarray(exists)
    inputs = (k, g, mu, mu_s)
    samples = np.linspace(0.0, np.pi / 2, DIRECTIONS)
    best, best_number = np.full(k.shape, -np.inf), np.zeros(k.shape, dtype=np.int64)
    for number, eta in enumerate(samples):
        value = _held_point(np.full(k.shape, eta), *inputs)[0]
        better = value > best
        best, best_number = np.where(better, value, best), np.where(better, number, best_number)
    exists &= best_number > 0
    low, high = (
        samples[np.maximum(best_number - 1, 0)],
        samples[np.minimum(best_number + 1, DIRECTIONS - 1)],
    )
    for _ in range(GOLDEN_SECTIONS):
        left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        falls = _held_point(left, *inputs)[0] > _held_point(right, *inputs)[0]
        low, high = np.where(falls, low, left), np.where(falls, right, high)
    value, Dx, Dy, n = _held_point((low + high) / 2, *inputs)
    exists &= value > 0
    alpha = np.where(exists, np.arctan2(Dy, np.where(exists, Dx + k, 1.0)), 0.0)
    beta = np.arcsin(np.where(exists, g - n, 0.0))
    return alpha, beta, zero + 1, np.asarray(exists)


def _value(
    psi: NDArray[np.complexfloating], k: Array, g: Array, mu: Array
) -> tuple[NDArray[np.complexfloating], NDArray[np.complexfloating]]:
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


def _held_point(
    eta: Array, k: Array, g: Array, mu: Array, mu_s: Array
) -> tuple[Array, Array, Array, Array]:
    along, across = mu_s * np.cos(eta), 3 * mu_s * np.sin(eta)
    a, b = 1 + along**2 + across**2, g - k * along
    left = b * b - a * (k * k + g * g - 1)
    n = (b + np.sqrt(np.maximum(left, 0.0))) / a
    meets = (left >= 0) & (n > 0) & (n <= g)
    n = np.where(meets, n, 1.0)
    D = (along * n, across * n)
    value = _acceleration(D, n, mu)[0]
    return np.where(meets, value, -np.inf), *D, n


def _acceleration(D: tuple[Array, Array], floor: Array, mu: Array) -> tuple[Array, Array]:
    friction: dict[str, Array] = {"friction_kinetic": mu, "floor_acceleration": floor}
    z = rolling.roll_root(
        in_plane_drive_x=D[0], in_plane_drive_y=D[1], friction_static=mu, **friction
    )
    return (
        rolling.slipping_acceleration_x(in_plane_drive_x=D[0], roll_root=z, **friction),
        rolling.slipping_acceleration_y(in_plane_drive_y=D[1], roll_root=z, **friction),
    )


FAMILY = Family(
    systems=(("cylinder-on-plane", "physical", "acceleration_x"),),
    closed={Maximise: cylinder_physical_fastest},
    contacts=frozenset({"floor_contact"}),
)
