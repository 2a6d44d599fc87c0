"""The support of the part after an event: what carries it, and whether it still does."""

from __future__ import annotations

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.arrays import Floats
from vibrafeed.core.motion.kernels.tumbling.carry import settle_on
from vibrafeed.core.motion.kernels.tumbling.forces import (
    corner_force,
    flat_force,
    free_corner,
    holding_force,
    response_of,
    side_forces,
)
from vibrafeed.core.motion.kernels.tumbling.geometry import (
    corner_at,
    corner_count,
    gap_of,
    gap_rate_of,
    kinetic,
    side_below,
    side_shape,
    slip_of,
    speed_scale,
)
from vibrafeed.core.motion.kernels.tumbling.impact import delassus, push
from vibrafeed.core.motion.kernels.tumbling.tables import (
    DEEP,
    FLAT,
    FREE,
    OVERLAP,
    PARADOX,
    SLOW,
    STATE,
    TOUCH,
    Cell,
)


@compiled
def holds(cell: Cell, support: int, sigma: int, state: Floats, time: float) -> bool:
    """True if the state of a tumbling part still fits its support and direction of slip.

    No other corner is in the plane, the normal force n is >= 0, |t| <= mu_s n if the support is
    held (`sigma` 0), and sigma g_T' >= 0 and m tau > 0 if it slips, with the friction force t, the
    slip velocity g_T', and m tau, the normal acceleration over the force. `support` is a corner's
    number, `FLAT` or `FREE`; `state` has the columns of `STATE` (SI), `time` in s gives the phase
    of the drive (theory 2.3, 2.4).
    """
    overlap, deep = OVERLAP * cell.half_diagonal, DEEP * cell.half_diagonal
    if support == FLAT:
        normal, friction = flat_force(cell, sigma, time)
        right, left = side_forces(cell, side_below(state[STATE.pitch]), normal, friction)
        if normal < 0.0 or right < 0.0 or left < 0.0:
            return False
        slip = state[STATE.along_rate]
    else:
        for corner in range(corner_count(cell)):
            gap = gap_of(cell, state, corner)
            # A corner that has just been struck may rise from a rounding below the plane.
            falls = gap < -deep or gap_rate_of(cell, state, corner) < 0.0
            if corner != support and gap < -overlap and falls:
                return False
        if support == FREE:
            return True
        s, c = corner_at(cell, support, state[STATE.pitch])
        if sigma != 0 and response_of(cell, s, c, sigma) <= 0.0:
            return False
        normal, friction = corner_force(
            cell, support, sigma, time, state[STATE.pitch], state[STATE.pitch_rate]
        )
        if normal < 0.0:
            return False
        slip = slip_of(cell, state, support)
    if sigma == 0:
        return abs(friction) <= cell.friction_static * normal
    if cell.friction_static == 0.0:
        return True
    return sigma * slip >= -1e-5 * SLOW * speed_scale(cell)


@compiled
def stop_corner(cell: Cell, state: Floats, corner: int, slip_too: bool) -> None:
    """Remove a small remaining velocity of a corner by an impulse, which cannot add energy.

    Before a corner counts as support. Off the plane alone by -u_n/G_nn, or with the slip if
    `slip_too` is True by G^-1 (-u_n, -u_t), with its velocities u_n, u_t and Delassus numbers G,
    det G = 1 + kappa, kappa the inertia ratio. `state` (columns of `STATE`, SI) is changed.
    """
    s, c = corner_at(cell, corner, state[STATE.pitch])
    nn, nt, tt = delassus(cell, s, c)
    u_n = gap_rate_of(cell, state, corner)
    if slip_too:
        u_t = slip_of(cell, state, corner)
        determinant = 1.0 + cell.inertia_ratio
        normal, tangential = (nt * u_t - tt * u_n), (nt * u_n - nn * u_t)
        push(cell, state, s, c, normal / determinant, tangential / determinant)
    else:
        push(cell, state, s, c, -u_n / nn, 0.0)


@compiled
def choose_corner(cell: Cell, state: Floats, time: float, corner: int) -> tuple[int, int]:
    """Return support and slip direction of a part of which only the corner `corner` touches.

    (corner, 0) if the corner is held: its slip is 0, and the force (n_0, t_0) that keeps it at rest
    has n_0 >= 0 and |t_0| <= mu_s n_0. Else (`FREE`, 0) if its normal acceleration without force,
    chi, is above 0, or (corner, 1 or -1) for a slip, from rest against t_0; `PARADOX` if m tau <=
    0, the normal acceleration over the force, where contact laws have no single solution (theory
    2.3, 2.4).

    `state` (columns of `STATE`, SI) is put onto the corner; `time` in s gives the phase of the
    drive.
    """
    slow = SLOW * speed_scale(cell)
    stop_corner(cell, state, corner, False)
    slip = slip_of(cell, state, corner)
    stops = abs(slip) <= slow and cell.friction_static > 0.0
    if stops:
        stop_corner(cell, state, corner, True)
    settle_on(cell, state, corner, 1)
    s, c = corner_at(cell, corner, state[STATE.pitch])
    chi, along = free_corner(cell, time, s, c, state[STATE.pitch_rate])
    if stops:
        normal, friction = holding_force(cell, s, c, chi, along)
        if normal >= 0.0 and abs(friction) <= cell.friction_static * normal:
            return corner, 0
        if chi > 0.0:
            return FREE, 0
        sigma = -1 if friction > 0.0 else 1
    else:
        sigma = 1 if slip > 0.0 else -1
    if response_of(cell, s, c, sigma) <= 0.0:
        return PARADOX, 0
    if chi > 0.0:
        return FREE, 0
    return corner, sigma


@compiled
def choose(cell: Cell, state: Floats, time: float) -> tuple[int, int]:
    """Return the support of a tumbling part and its slip direction after an event.

    The support is a corner's number, `FLAT` for a side, `FREE` for none, or `PARADOX` if the
    contact laws have no single solution; the direction 1, -1, or 0 if held. Corners that touch and
    neither approach nor leave take part, and the laws of contact decide by the accelerations: for
    two corners a side that may tip over one of them, for one as in `choose_corner` (theory 2.3,
    2.4).

    `state` (columns of `STATE`, SI) is put exactly onto the support; `time` in s gives the phase of
    the drive.
    """
    touch, slow = TOUCH * cell.half_diagonal, SLOW * speed_scale(cell)
    first = second = -1
    for corner in range(corner_count(cell)):
        near = gap_of(cell, state, corner) <= touch
        if near and abs(gap_rate_of(cell, state, corner)) <= slow:
            if first < 0:
                first = corner
            elif second < 0:
                second = corner
    if first < 0:
        return FREE, 0
    before = kinetic(cell, state)
    sigma = 0
    if second >= 0:
        settle_on(cell, state, FLAT, 1)
        if abs(state[STATE.along_rate]) > slow:
            sigma = 1 if state[STATE.along_rate] > 0.0 else -1
        else:
            state[STATE.along_rate] = 0.0
        normal, friction = flat_force(cell, sigma, time)
        if sigma == 0 and abs(friction) > cell.friction_static * normal:
            sigma = -1 if friction > 0.0 else 1
            normal, friction = flat_force(cell, sigma, time)
        quarter_turns = side_below(state[STATE.pitch])
        right, left = side_forces(cell, quarter_turns, normal, friction)
        if normal < 0.0:
            support = FREE
        elif right >= 0.0 and left >= 0.0:
            support = FLAT
        else:  # it tips over the end that is pressed
            corner = (1 - quarter_turns) % 4 if right < 0.0 else -quarter_turns % 4
            support, sigma = choose_corner(cell, state, time, corner)
    else:
        support, sigma = choose_corner(cell, state, time, first)
    settle_on(cell, state, support, sigma)
    state[STATE.lost] += before - kinetic(cell, state)
    return support, sigma


@compiled
def rests_for_ever(cell: Cell, support: int, sigma: int, state: Floats) -> bool:
    """True if the part is at rest and no phase of the drive can move it.

    g_y >= |P_y| and, with m = min(mu_s, half/height), m (g_y - P_y sin) >= |g_x - P_x sin| at both
    ends of the swing: neither slip nor tipping to either side. g is the pull, P the drive (both in
    m/s^2), half and height are half the length of the side that lies flat and the height of the
    centre above it. `state` has the columns of `STATE`; `support` is a corner's number, `FLAT` or
    `FREE`; `sigma` is the direction of slip, 0 if held.
    """
    if sigma != 0:
        return False
    g, drive = cell.pull_normal, cell.drive_normal
    if support >= 0 and cell.turning == 0.0:
        turning = cell.half_diagonal * abs(state[STATE.pitch_rate])
        at_rest = turning <= SLOW * speed_scale(cell)
        return at_rest and cell.pull_along == 0.0 and cell.drive_along == 0.0 and g >= abs(drive)
    if support != FLAT or g < abs(drive):
        return False
    half, height = side_shape(cell, side_below(state[STATE.pitch]))
    # Neither slip nor tipping to either side: share * normal +- friction >= 0 at every phase.
    share = min(cell.friction_static, half / height)
    along, swing = cell.pull_along, cell.drive_along
    uphill = share * g - along >= abs(share * drive - swing)
    return uphill and share * g + along >= abs(share * drive + swing)
