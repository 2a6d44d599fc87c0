"""The support of the part after an event: what carries it, and whether it still does."""

from __future__ import annotations

from core.compiled import compiled
from core.motion.kernels.arrays import Floats
from core.motion.kernels.tumbling.carry import settle_on
from core.motion.kernels.tumbling.forces import (
    corner_force,
    flat_force,
    free_corner,
    holding_force,
    response_of,
    side_forces,
)
from core.motion.kernels.tumbling.geometry import (
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
from core.motion.kernels.tumbling.impact import delassus, push
from core.motion.kernels.tumbling.tables import (
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
    """True if the state still fits its support and direction of slip.

    No other corner in the plane, normal force n >= 0, |t| <= mu_s n if held (`sigma` 0), sigma g_T'
    >= 0 and m tau > 0 if it slips, with the friction force t, slip g_T' and response m tau of the
    corner. `support` is a corner's number, `FLAT` or `FREE`; `time` in s (theory 2.3, 2.4).
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

    Off the plane by -u_n/G_nn, or with the slip (`slip_too`) by G^-1 (-u_n, -u_t), with the
    Delassus numbers G, det G = 1 + kappa.
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
    """Return support and slip direction if the corner `corner` alone touches without approaching.

    Held (0) if n_0 >= 0 and |t_0| <= mu_s n_0 for the force (n_0, t_0) that keeps it at rest; else
    free if its normal acceleration without force, chi, is above 0, or it slips against t_0;
    `PARADOX` if m tau <= 0 (theory 2.3, 2.4). `time` is in s.
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
    """Return support and slip direction after an event, and put the state onto the support.

    The support is a corner's number, `FLAT`, `FREE` or `PARADOX`; the direction 1, -1, or 0 if
    held. From the touching corners that neither approach nor leave: the contact laws of
    accelerations decide, for two by `flat_force` and `side_forces`, for one by `choose_corner`
    (theory 2.3, 2.4). `time` is in s.
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
    ends of the swing: neither slip nor tipping to either side. g is the pull, P the drive, half and
    height are those of the side that lies flat. `support` is a corner's number, `FLAT` or `FREE`;
    `sigma` the direction of slip, 0 if held.
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
