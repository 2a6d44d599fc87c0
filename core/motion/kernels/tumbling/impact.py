"""Impacts of one corner, or of a side."""

from __future__ import annotations

import numpy as np

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.arrays import Floats, copy
from vibrafeed.core.motion.kernels.tumbling.geometry import (
    corner_at,
    corner_count,
    gap_of,
    gap_rate_of,
    kinetic,
    slip_of,
    speed_scale,
)
from vibrafeed.core.motion.kernels.tumbling.tables import SLOW, STATE, TOUCH, Cell


@compiled
def delassus(cell: Cell, s: float, c: float) -> tuple[float, float, float]:
    """Return the Delassus numbers G_nn, G_nt, G_tt of a corner: its velocity per impulse and mass.

    1 + kappa cos^2 s, kappa sin s cos s and 1 + kappa sin^2 s, with the inertia ratio kappa; `s`
    and `c` are sine and cosine of the corner's angle (theory 1.3).
    """
    kappa = cell.inertia_ratio
    return 1.0 + kappa * c * c, kappa * s * c, 1.0 + kappa * s * s


@compiled
def push(cell: Cell, state: Floats, s: float, c: float, normal: float, tangential: float) -> None:
    """Change the velocities in `state` of a tumbling part by an impulse per mass at one corner.

    x' + i_t, y' + i_n and xi' - kappa (i_n cos s + i_t sin s)/rho, with i_n = `normal` and i_t =
    `tangential` in m/s, velocities x', y' of the centre along and normal to the plane, pitch rate
    xi', inertia ratio kappa and half diagonal rho of the part in `cell` (theory 2.2). `s` and `c`
    are sine and cosine of the corner's angle s at the centre.
    """
    state[STATE.along_rate] += tangential
    state[STATE.up_rate] += normal
    state[STATE.pitch_rate] -= (
        cell.inertia_ratio * (normal * c + tangential * s) / cell.half_diagonal
    )


@compiled
def arrest(
    nn: float, nt: float, tt: float, u_n: float, u_t: float, friction: float
) -> tuple[float, float]:
    """Return the impulse per mass that stops the approach of a corner, with Coulomb friction.

    The compression phase of an impact (theory 5.3): (i_n, i_t) in m/s, normal and tangential. `nn`,
    `nt`, `tt` are the corner's Delassus numbers G (velocity per impulse per mass, [1]), `u_n` <= 0
    and `u_t` its velocities off and along the plane in m/s, `friction` is mu. i_n = (-u_n - G_nt
    i_t)/G_nn, with the i_t that stops the slip, u_t + G_nt i_n + G_tt i_t = 0, if |i_t| <= mu i_n;
    else with i_t at that limit.
    """
    stop = -u_n / nn
    coupling = nt / nn
    tangential = -(u_t + nt * stop) / (tt - nt * coupling)
    forward, backward = 1.0 - friction * coupling, 1.0 + friction * coupling
    lowest = -friction * stop / forward if forward > 0.0 else -np.inf
    highest = friction * stop / backward if backward > 0.0 else np.inf
    if lowest <= tangential <= highest:
        return max(stop - coupling * tangential, 0.0), tangential
    tangential = lowest if tangential < lowest else highest
    # In sliding the cone gives the normal impulse; the line would lose digits.
    normal = abs(tangential) / friction if friction > 0.0 else stop
    return normal, tangential


@compiled
def compress(
    cell: Cell, state: Floats, right: int, left: int, after: Floats
) -> tuple[float, float, float]:
    """Set `after` to the state in which no touching corner approaches; return the impulses for it.

    The compression phase of an impact (theory 5.3). The results are normal impulses per mass at the
    right and left corner, and that of friction, in m/s. `right` is the corner, or the right one of
    two that touch together; `left` is -1 for one corner. On a side both corners slide alike, so
    that friction is one force. States have the columns of `STATE` (SI), `cell` holds the part's
    numbers.
    """
    rho, kappa, mu = cell.half_diagonal, cell.inertia_ratio, cell.friction_kinetic
    copy(state, after)
    u_right = gap_rate_of(cell, state, right)
    s_r, c_r = corner_at(cell, right, state[STATE.pitch])
    slack = 1e-12 * (abs(u_right) + rho * abs(state[STATE.pitch_rate]))
    if left >= 0:
        s_l, c_l = corner_at(cell, left, state[STATE.pitch])
        u_left = gap_rate_of(cell, state, left)
        slack += 1e-12 * abs(u_left)
        half, height = rho * (c_r - c_l) / 2, rho * s_r
        spin = (u_left - u_right) / (2.0 * half)
        total = -(u_left + u_right) / 2
        if total > 0.0:
            # Both at rest: no pitch rate and no rise remain.
            wanted = -(slip_of(cell, state, right) + height * spin)
            friction = min(max(wanted, -mu * total), mu * total)
            tilt = (spin * rho * rho / kappa - height * friction) / half
            if abs(tilt) <= total:
                push(cell, after, s_r, c_r, (total + tilt) / 2, friction)
                push(cell, after, s_l, c_l, (total - tilt) / 2, 0.0)
                return (total + tilt) / 2, (total - tilt) / 2, friction
        # One of them alone, if the other does not approach then.
        if u_left < 0.0:
            nn, nt, tt = delassus(cell, s_l, c_l)
            normal, friction = arrest(nn, nt, tt, u_left, slip_of(cell, state, left), mu)
            push(cell, after, s_l, c_l, normal, friction)
            if gap_rate_of(cell, after, right) >= -slack or u_right >= 0.0:
                return 0.0, normal, friction
            copy(state, after)
    if u_right >= 0.0:
        return 0.0, 0.0, 0.0
    nn, nt, tt = delassus(cell, s_r, c_r)
    normal, friction = arrest(nn, nt, tt, u_right, slip_of(cell, state, right), mu)
    push(cell, after, s_r, c_r, normal, friction)
    return normal, 0.0, friction


@compiled
def strike(cell: Cell, state: Floats, after: Floats) -> bool:
    """Apply an impact of the touching corners of a part to its state; True if there was one.

    There is none if no touching corner approaches the plane. By the law of Pfeiffer and Glocker a
    compression first stops the approach, and an expansion follows with eps times the normal
    impulses, and friction that may stop the slip (theory 5.3). If a corner still approaches, as may
    be with two corners, further compressions follow.

    `cell` holds the numbers of the part, `state` the columns of `STATE` (SI), changed
    in place, with the kinetic energy lost per mass added; `after` is a work array of the same size.
    """
    touch, slow = TOUCH * cell.half_diagonal, SLOW * speed_scale(cell)
    right = left = -1
    approach = 0.0
    for corner in range(corner_count(cell)):
        gap = gap_of(cell, state, corner)
        if gap <= touch:
            approach = min(approach, gap_rate_of(cell, state, corner))
            if right < 0:
                right = corner
            elif left < 0:
                left = corner
    if approach >= -slow:
        return False
    if left >= 0:
        _, c_r = corner_at(cell, right, state[STATE.pitch])
        _, c_l = corner_at(cell, left, state[STATE.pitch])
        if c_r < c_l:
            right, left = left, right
    before = kinetic(cell, state)
    eps = cell.restitution
    first, second, _ = compress(cell, state, right, left, after)
    copy(after, state)
    s, c = corner_at(cell, right, state[STATE.pitch])
    push(cell, state, s, c, eps * first, 0.0)
    rate = right
    if left >= 0:
        s_l, c_l = corner_at(cell, left, state[STATE.pitch])
        push(cell, state, s_l, c_l, eps * second, 0.0)
        if first == 0.0:
            rate, s, c = left, s_l, c_l
    limit = cell.friction_kinetic * eps * (first + second)
    _, _, tt = delassus(cell, s, c)
    wanted = -slip_of(cell, state, rate) / tt
    push(cell, state, s, c, 0.0, min(max(wanted, -limit), limit))
    for _ in range(20):
        least = gap_rate_of(cell, state, right)
        if left >= 0:
            least = min(least, gap_rate_of(cell, state, left))
        if least >= -slow:
            break
        compress(cell, state, right, left, after)
        copy(after, state)
    state[STATE.lost] += before - kinetic(cell, state)
    return True
