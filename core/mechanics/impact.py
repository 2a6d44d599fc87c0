"""Laws of a rigid impact at one contact: normal and tangential impulse (theory 1.4, 5.2, 5.3, 8.1).

A law sees the Delassus numbers of the contact, the velocities with which it closes and slides, the
friction coefficient and the restitution. It knows no shape. The normal velocity `u_N` is negative
where the bodies approach; elsewhere the impulse is 0. All arrays broadcast.
"""

from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask

EPSILON = float(np.finfo(np.float64).eps)  # distance of 1 from the next float


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


class EdgeAction(NamedTuple):
    """The point of a touching line where the impulse acts.

    Attributes
    ----------
    share : ndarray
        Its distance from the first end of the line over the length, 0 to 1.
    unknown : ndarray of bool
        Where no single impulse describes the impact: an end approaches after it, so that another
        follows at once.
    """

    share: Array
    unknown: Mask


def frictionless(*, G_NN: Array, u_N: Array, restitution: Array) -> Array:
    """Return Newton's normal impulse -(1 + eps) u_N/G_NN, 0 where the bodies do not approach [N s].

    G_NN is the Delassus number, u_N the normal velocity before.
    """
    return (1 + restitution) * np.maximum(0.0, -u_N) / G_NN


def _arrest(
    G_NN: Array, G_NT: Array, G_TT: Array, u_N: Array, u_T: Array, friction: Array
) -> Impulse:
    # Compression: u_N becomes 0. On the line u_N' = 0 the tangential velocity grows strictly with
    # L_T, and the friction cone cuts an interval around L_T = 0 out of it, infinite on a side where
    # the cone does not meet it. The impulse is the one that sticks, moved to the nearest end if it
    # lies outside: exactly one solution for any friction.
    stopping_normal = -u_N / G_NN
    coupling = G_NT / G_NN
    sticking = -(u_T + G_NT * stopping_normal) / _positive_difference(G_TT - G_NT * coupling, G_TT)
    cone_forward, cone_backward = 1 - friction * coupling, 1 + friction * coupling  # s = +1, s = -1
    lowest = np.where(
        cone_forward > 0,
        -friction * stopping_normal / np.where(cone_forward > 0, cone_forward, 1.0),
        -np.inf,
    )
    highest = np.where(
        cone_backward > 0,
        friction * stopping_normal / np.where(cone_backward > 0, cone_backward, 1.0),
        np.inf,
    )
    tangential = np.clip(sticking, lowest, highest)
    slides = (sticking < lowest) | (sticking > highest)
    # In sliding the cone gives the normal impulse; the line would lose digits of |L_T| = mu L_N.
    on_line = stopping_normal - coupling * tangential
    safe_friction = np.where(friction > 0, friction, 1.0)
    normal = np.where(slides & (friction > 0), np.abs(tangential) / safe_friction, on_line)
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
    """Return Moreau's impulse, with one restitution for normal and sliding velocity, in one step.

    0 where the bodies do not approach (theory 5.3).
    """
    scale = 1 + restitution
    return _arrest(G_NN, G_NT, G_TT, scale * np.minimum(u_N, 0.0),
                   scale * _only_approaching(u_N, u_T), friction)  # fmt: skip


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
    """Return the impulse of compression and expansion at one contact, by Poisson's law.

    eps, the normal impulse of the expansion over that of the compression, is `restitution`. The law
    would let the expansion be larger where the contact would close again; a single contact never
    does (theory 5.3).
    """
    compression = _arrest(
        G_NN, G_NT, G_TT, np.minimum(u_N, 0.0), _only_approaching(u_N, u_T), friction
    )
    sliding_left = np.where(
        compression.sticks,
        0.0,
        _only_approaching(u_N, u_T) + G_NT * compression.normal + G_TT * compression.tangential,
    )
    expansion = restitution * compression.normal
    sticking = -(sliding_left + G_NT * expansion) / G_TT
    limit = friction * expansion
    tangential = np.clip(sticking, -limit, limit)
    # Without expansion the compression has the last word.
    sticks = np.where(expansion > 0, np.abs(sticking) <= limit, compression.sticks)
    return Impulse(compression.normal + expansion, compression.tangential + tangential, sticks)


def _positive_difference(difference: Array, term: Array) -> Array:
    # A difference of Delassus numbers, positive in exact numbers. With lever arms of 1e8 times a
    # body's size all digits cancel: any value within the rounding of the first term is then as good
    # as another, but 0 cannot divide and a negative one turns signs.
    return np.maximum(difference, EPSILON * term)


def _only_approaching(u_N: Array, sliding: Array) -> Array:
    return np.where(u_N < 0, sliding, 0.0)


def on_edge(
    *, G_11: Array, G_12: Array, G_22: Array, u_1: Array, u_2: Array, restitution: Array
) -> EdgeAction:
    """Return the point of a line of contact at which the resultant of both ends' impulses acts.

    Without friction. G_11, G_12, G_22 are the Delassus numbers of the ends 1 and 2, velocities per
    impulse [kg-1], u_1 and u_2 their normal velocities before [m s-1]. Of L >= 0 and
    G L + (1 + eps) u >= 0, at each end one is 0; G is positive definite, so that exactly one of the
    four combinations fits.
    """
    b_1, b_2 = (1 + restitution) * u_1, (1 + restitution) * u_2
    determinant = G_11 * G_22 - G_12 * G_12
    is_regular = determinant > 0
    safe_determinant = np.where(is_regular, determinant, 1.0)
    both_1 = (G_12 * b_2 - G_22 * b_1) / safe_determinant
    both_2 = (G_12 * b_1 - G_11 * b_2) / safe_determinant
    only_1, only_2 = np.maximum(0.0, -b_1) / G_11, np.maximum(0.0, -b_2) / G_22
    both_push = is_regular & (both_1 > 0) & (both_2 > 0)
    only_first = (only_1 > 0) & (G_12 * only_1 + b_2 >= 0)
    only_first |= (only_1 > 0) & ~is_regular & (b_1 <= b_2)
    L_1 = np.where(both_push, both_1, np.where(only_first, only_1, 0.0))
    L_2 = np.where(both_push, both_2, np.where(only_first, 0.0, only_2))
    slack = -1e-12 * (np.abs(u_1) + np.abs(u_2))
    after_1, after_2 = u_1 + G_11 * L_1 + G_12 * L_2, u_2 + G_12 * L_1 + G_22 * L_2
    total = L_1 + L_2
    approaches_again = (total > 0) & ((after_1 < slack) | (after_2 < slack))
    faster_end = np.where(u_2 < u_1, 1.0, 0.0)
    return EdgeAction(
        np.where(total > 0, L_2 / np.where(total > 0, total, 1.0), faster_end), approaches_again
    )


class SpatialDelassus(NamedTuple):
    """Delassus numbers of one contact in space, with two tangential directions 1 and 2."""

    NN: Array
    N1: Array
    N2: Array
    T11: Array
    T12: Array
    T22: Array


# Newton's steps for the sliding direction converge in about 8; the rest is for bisection.
MAX_STEPS = 100


def _in_cone(
    stiffness: tuple[Array, Array, Array],
    sliding: tuple[Array, Array],
    free_normal: Array,
    coupling: tuple[Array, Array],
    friction: Array,
) -> tuple[tuple[Array, Array], Mask]:
    # The tangential impulse L with c + S L = -z L and |L| <= mu (a - b.L), and where it sticks
    # (z = 0). S is `stiffness` [kg-1], c the velocity `sliding` without L, a - b.L the normal
    # impulse, a `free_normal` without L, b `coupling`. On the axes of S, L_k = -c_k/(s_k + z); the
    # root z of the `excess` mu (a - b.L)/|L| - 1, nearly linear in z, is bracketed by 0 and a bound
    # and found by Newton's method with bisection.
    S_11, S_12, S_22 = stiffness
    half_trace, half_difference = (S_11 + S_22) / 2, (S_11 - S_22) / 2
    s_1 = half_trace + np.hypot(half_difference, S_12)
    s_2 = _positive_difference((S_11 * S_22 - S_12 * S_12) / s_1, s_1)
    axes_angle = np.arctan2(S_12, half_difference) / 2
    cosine, sine = np.cos(axes_angle), np.sin(axes_angle)
    c_1, c_2 = cosine * sliding[0] + sine * sliding[1], cosine * sliding[1] - sine * sliding[0]
    b_1, b_2 = cosine * coupling[0] + sine * coupling[1], cosine * coupling[1] - sine * coupling[0]
    stick_1, stick_2 = -c_1 / s_1, -c_2 / s_2
    sticks = np.hypot(stick_1, stick_2) <= friction * (free_normal - b_1 * stick_1 - b_2 * stick_2)
    speed = np.hypot(c_1, c_2)
    slides = ~sticks & (friction * free_normal > 0)
    largest_friction = np.where(slides, friction * free_normal, 1.0)
    low = np.zeros(np.shape(slides))
    with np.errstate(over="ignore"):
        high = np.minimum(speed * (1 + friction * np.hypot(b_1, b_2)) / largest_friction, 1e300)
    z = np.where(slides, np.minimum(speed / largest_friction, high), 1.0) + low
    converged = np.zeros(np.shape(z), dtype=bool)
    for _ in range(MAX_STEPS):
        L_1, L_2 = -c_1 / (s_1 + z), -c_2 / (s_2 + z)
        length = np.where(slides, np.hypot(L_1, L_2), 1.0)
        normal = free_normal - b_1 * L_1 - b_2 * L_2
        excess = friction * normal / length - 1
        length_decay = (L_1 * L_1 / (s_1 + z) + L_2 * L_2 / (s_2 + z)) / (length * length)
        cone_growth = (b_1 * L_1 / (s_1 + z) + b_2 * L_2 / (s_2 + z)) + normal * length_decay
        slope = friction * cone_growth / length
        low, high = np.where(excess < 0, z, low), np.where(excess > 0, z, high)
        newton = z - excess / np.where(slope > 0, slope, 1.0)
        accepts_newton = (slope > 0) & (newton > low) & (newton < high)
        next_z = np.where(accepts_newton, newton, (low + high) / 2)
        next_z = np.where(slides & (excess != 0), next_z, z)
        # A cell that has converged stays: it must not depend on those that are computed beside it.
        next_z = np.where(converged, z, next_z)
        converged |= np.abs(next_z - z) <= 4e-16 * z
        z = next_z
        if np.all(converged):
            break
    L_1 = np.where(sticks, stick_1, np.where(slides, -c_1 / (s_1 + z), 0.0))
    L_2 = np.where(sticks, stick_2, np.where(slides, -c_2 / (s_2 + z), 0.0))
    return (cosine * L_1 - sine * L_2, sine * L_1 + cosine * L_2), sticks


def _arrest_in_space(
    G: SpatialDelassus, u_N: Array, u: tuple[Array, Array], friction: Array
) -> SpatialImpulse:
    # Compression: the normal velocity u_N becomes 0; friction stops the sliding velocities if it
    # can, and is mu times the normal impulse else.
    stopping_normal, coupling = -u_N / G.NN, (G.N1 / G.NN, G.N2 / G.NN)
    stiffness = (
        _positive_difference(G.T11 - G.N1 * coupling[0], G.T11),
        G.T12 - G.N1 * coupling[1],
        _positive_difference(G.T22 - G.N2 * coupling[1], G.T22),
    )
    tangential, sticks = _in_cone(
        stiffness,
        (u[0] + G.N1 * stopping_normal, u[1] + G.N2 * stopping_normal),
        stopping_normal,
        coupling,
        friction,
    )
    on_plane = stopping_normal - coupling[0] * tangential[0] - coupling[1] * tangential[1]
    safe_friction = np.where(friction > 0, friction, 1.0)
    on_cone = np.hypot(*tangential) / safe_friction
    return SpatialImpulse(np.where(sticks | (friction == 0), on_plane, on_cone), tangential, sticks)


def moreau_in_space(
    *, G: SpatialDelassus, u_N: Array, u: tuple[Array, Array], friction: Array, restitution: Array
) -> SpatialImpulse:
    """Return Moreau's impulse with a disc of friction, one restitution for all directions.

    Symbols as of `moreau`, with two tangents (theory 8.1).
    """
    scale = 1 + restitution
    approach = (scale * _only_approaching(u_N, u[0]), scale * _only_approaching(u_N, u[1]))
    return _arrest_in_space(G, scale * np.minimum(u_N, 0.0), approach, friction)


def pfeiffer_glocker_in_space(
    *, G: SpatialDelassus, u_N: Array, u: tuple[Array, Array], friction: Array, restitution: Array
) -> SpatialImpulse:
    """Return the impulse of compression and expansion at a contact in space, by Poisson's law.

    Friction may point in any direction of the tangential plane, with the size mu L_N at most
    (theory 8.1). NaN where the contact would close again in the expansion, which is not solved.
    """
    approach = (_only_approaching(u_N, u[0]), _only_approaching(u_N, u[1]))
    compression = _arrest_in_space(G, np.minimum(u_N, 0.0), approach, friction)
    L_1, L_2 = compression.tangential
    sliding_1 = np.where(
        compression.sticks, 0.0, approach[0] + G.N1 * compression.normal + G.T11 * L_1 + G.T12 * L_2
    )
    sliding_2 = np.where(
        compression.sticks, 0.0, approach[1] + G.N2 * compression.normal + G.T12 * L_1 + G.T22 * L_2
    )
    expansion = restitution * compression.normal
    zero = np.zeros_like(expansion)
    (E_1, E_2), sticks = _in_cone(
        (G.T11, G.T12, G.T22),
        (sliding_1 + G.N1 * expansion, sliding_2 + G.N2 * expansion),
        expansion,
        (zero, zero),
        friction,
    )
    closes_again = G.NN * expansion + G.N1 * E_1 + G.N2 * E_2 < 0
    return SpatialImpulse(
        np.where(closes_again, np.nan, compression.normal + expansion),
        (np.where(closes_again, np.nan, L_1 + E_1), np.where(closes_again, np.nan, L_2 + E_2)),
        np.where(expansion > 0, sticks, compression.sticks),
    )


def only_in_impact(value: Array, are_apart: Mask, unknown: Mask) -> Array:
    """Return a value; 0 where the bodies do not meet, NaN where the law has no answer."""
    return np.where(unknown, np.nan, np.where(are_apart, 0.0, value))
