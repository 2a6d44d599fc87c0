"""Laws of a rigid impact at one contact: normal and tangential impulse (theory 1.4, 5.2, 5.3, 8.1).

A law sees the Delassus numbers of the contact, the velocities with which it closes and slides, the
friction coefficient and the restitution. It knows no shape. The normal velocity `u_N` is negative
where the bodies approach; elsewhere the impulse is 0. All arrays broadcast.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from core.mechanics.arrays import Array, Mask


class Impulse(NamedTuple):
    """The impulse of one planar contact, on body 1.

    Attributes
    ----------
    normal, tangential : ndarray
        Components along n and along t.
    sticks : ndarray of bool
        Where the contact does not slide at the end of the impact, and friction is in its cone.
    """

    normal: Array
    tangential: Array
    sticks: Mask


class SpatialImpulse(NamedTuple):
    """The impulse of one contact in space, on body 1; two tangential components."""

    normal: Array
    tangential: tuple[Array, Array]
    sticks: Mask


class EdgeImpulse(NamedTuple):
    """Impulses at both ends of a line of contact without friction.

    Attributes
    ----------
    first, second : ndarray
        Normal impulses at the ends.
    again : ndarray of bool
        Where an end that got no impulse approaches after the impact: another impact follows at
        once, and this one does not tell the whole.
    """

    first: Array
    second: Array
    again: Mask


def frictionless(*, G_NN: Array, u_N: Array, restitution: Array) -> Array:
    """Return Newton's normal impulse -(1 + eps) u_N/G_NN, 0 where the bodies do not approach."""
    return (1 + restitution) * np.maximum(0.0, -u_N) / G_NN


def _arrest(
    G_NN: Array, G_NT: Array, G_TT: Array, u_N: Array, u_T: Array, friction: Array
) -> Impulse:
    """Return the impulse that brings u_N to 0 with Coulomb friction; u_N <= 0.

    On the line u_N' = 0 the tangential velocity grows strictly with L_T, and the friction cone
    cuts an interval around L_T = 0 out of the line, infinite on a side where the cone does not meet
    it. The impulse is the one that sticks, moved to the nearest end if it lies outside. There is
    therefore exactly one solution, for any friction coefficient.
    """
    arrest = -u_N / G_NN
    coupling = G_NT / G_NN
    sticking = -(u_T + G_NT * arrest) / (G_TT - G_NT * coupling)
    forward, backward = 1 - friction * coupling, 1 + friction * coupling  # s = +1, s = -1
    lowest = np.where(
        forward > 0, -friction * arrest / np.where(forward > 0, forward, 1.0), -np.inf
    )
    highest = np.where(
        backward > 0, friction * arrest / np.where(backward > 0, backward, 1.0), np.inf
    )
    tangential = np.clip(sticking, lowest, highest)
    slides = (sticking < lowest) | (sticking > highest)
    # In sliding the cone gives the normal impulse; the line would lose digits of |L_T| = mu L_N.
    along = arrest - coupling * tangential
    over = np.where(friction > 0, friction, 1.0)
    normal = np.where(slides & (friction > 0), np.abs(tangential) / over, along)
    return Impulse(normal, tangential, ~slides)


def moreau(
    *,
    G_NN: Array,
    G_NT: Array,
    G_TT: Array,
    u_N: Array,
    u_T: Array,
    friction: Array,
    restitution: Array,
) -> Impulse:
    """Return Moreau's impulse, restitution alike along n and t, in one step (theory 5.3)."""
    growth = 1 + restitution
    return _arrest(G_NN, G_NT, G_TT, growth * np.minimum(u_N, 0.0), growth * _met(u_N, u_T),
                   friction)  # fmt: skip


def pfeiffer_glocker(
    *,
    G_NN: Array,
    G_NT: Array,
    G_TT: Array,
    u_N: Array,
    u_T: Array,
    friction: Array,
    restitution: Array,
) -> Impulse:
    """Return the impulse of compression and expansion together, Poisson's restitution (theory 5.3).

    The normal impulse of the expansion is eps times that of the compression. The law would let it
    be larger where the contact would close again; a single contact never does (theory 5.3).
    """
    first = _arrest(G_NN, G_NT, G_TT, np.minimum(u_N, 0.0), _met(u_N, u_T), friction)
    sliding = np.where(
        first.sticks, 0.0, _met(u_N, u_T) + G_NT * first.normal + G_TT * first.tangential
    )
    normal = restitution * first.normal
    wanted = -(sliding + G_NT * normal) / G_TT
    limit = friction * normal
    tangential = np.clip(wanted, -limit, limit)
    # Without expansion the compression has the last word.
    sticks = np.where(normal > 0, np.abs(wanted) <= limit, first.sticks)
    return Impulse(first.normal + normal, first.tangential + tangential, sticks)


def _met(u_N: Array, u_T: Array) -> Array:
    """Return the sliding velocity where the bodies approach, 0 elsewhere."""
    return np.where(u_N < 0, u_T, 0.0)


def on_edge(
    *, G_11: Array, G_12: Array, G_22: Array, u_1: Array, u_2: Array, restitution: Array
) -> EdgeImpulse:
    """Return the impulses at two contacts: L >= 0, G L + (1+eps) u >= 0, one of them 0.

    G is positive definite, so that exactly one of the four combinations fits.
    """
    b_1, b_2 = (1 + restitution) * u_1, (1 + restitution) * u_2
    determinant = G_11 * G_22 - G_12 * G_12
    regular = determinant > 0
    over = np.where(regular, determinant, 1.0)
    both_1 = (G_12 * b_2 - G_22 * b_1) / over
    both_2 = (G_12 * b_1 - G_11 * b_2) / over
    only_1, only_2 = np.maximum(0.0, -b_1) / G_11, np.maximum(0.0, -b_2) / G_22
    both = regular & (both_1 > 0) & (both_2 > 0)
    first = (only_1 > 0) & (G_12 * only_1 + b_2 >= 0)
    first |= (only_1 > 0) & ~regular & (b_1 <= b_2)
    L_1 = np.where(both, both_1, np.where(first, only_1, 0.0))
    L_2 = np.where(both, both_2, np.where(first, 0.0, only_2))
    slack = -1e-12 * (np.abs(u_1) + np.abs(u_2))
    after_1, after_2 = u_1 + G_11 * L_1 + G_12 * L_2, u_2 + G_12 * L_1 + G_22 * L_2
    again = (L_1 + L_2 > 0) & ((after_1 < slack) | (after_2 < slack))
    return EdgeImpulse(L_1, L_2, again)
