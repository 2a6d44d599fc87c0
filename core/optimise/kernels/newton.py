"""Compiled batch solver of the drive angles; see `core.optimise.newton`.

Everything is divided by the drive acceleration P. Two kinds of problems:

The printed formulas and the track are linear in the drive direction d, and so are all their limits,
contacts and bounds. The best d is then the top of the sphere, the top of one circle, or a corner of
two: the active set is looked for among these, and each is a closed form (`_top_of_pieces`).

The block with the friction disc is not. At fixed beta its a_x is concave in D_x, and its limits
leave an interval of D_x (`_best_across`, Newton's method); over beta, the slope of that best value
is known, and its sign changes are closed in on between samples (`_best_along`).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled

Numbers = NDArray[np.float64]

PLANE_THESIS, PLANE_PHYSICAL, TRACK_THESIS, TRACK_DERIVED, TRACK_PHYSICAL = 0, 1, 2, 3, 4

# Statuses and bits, as in the tables of `core.optimise.exact`.
OPTIMAL, FLAT, NO_MOTION, NOT_ATTAINED, INFEASIBLE, INVALID, LIMIT_REACHED = 0, 1, 2, 3, 4, 5, 6
ALPHA_LOWER, ALPHA_UPPER, BETA_LOWER, BETA_UPPER = 1, 2, 4, 8
ACROSS_LOWER, ACROSS_UPPER, FLOOR, WALL, START = 16, 32, 64, 128, 256

# Columns of the groups and of the results.
P_, ALONG, ACROSS, NORMAL, MU_K, MU_S, LIMIT, ALPHA_LO, ALPHA_HI, BETA_LO, BETA_HI = range(11)
GROUPS = 11
(
    ALPHA, BETA, VALUE, CROSS, MARGIN_ACROSS, MARGIN_FLOOR, MARGIN_WALL,
    PRICE_ACROSS, PRICE_FLOOR, PRICE_WALL, RESIDUAL,
) = range(11)  # fmt: skip
COLUMNS = 11

RIGHT = math.pi / 2
ROWS = 9  # most planes of one problem
KEPT = 1e-14  # a plane that a unit vector oversteps by less is kept: a few roundings
TIGHT = 1e-10  # a margin below this counts as none
TINY = 1e-290  # a drive below this share of gravity is none
NEAR_PARALLEL = 1e-20  # squared sine below which two planes have no corner

STEPS = 6  # equal steps of beta, where alpha = 0 and 90 deg are allowed
STEPS_WITHIN = 64  # with other bounds, which can leave narrow windows
SPECIAL = 4  # angles added: of friction, where a turned drive starts first, and where it is best
RETREATS = 16  # equal steps of D_x on the way to a smaller a_y
MOST_INNER = 40  # Newton steps in D_x
MOST_OUTER = 160  # steps that close in on a sign change
HALVINGS = 20  # of an interval that hides a maximum
LAST_DIGIT = 2e-16
FLAT_SLOPE = 5e-16  # a slope over beta is a sum of terms of order 1, each rounded


@compiled
def _kept(A: Numbers, b: Numbers, rows: int, x: float, y: float, z: float) -> bool:
    """Return whether a direction keeps all planes a.d <= b."""
    for i in range(rows):  # noqa: SIM110 - a generator would not compile
        if A[i, 0] * x + A[i, 1] * y + A[i, 2] * z > b[i] + KEPT:
            return False
    return True


@compiled
def _top_of_pieces(u: Numbers, A: Numbers, b: Numbers, rows: int, best: Numbers) -> bool:
    """Return whether a unit vector keeps a.d <= b; `best` becomes the one with the largest u.d.

    The rows of A are unit vectors. Where the top of the sphere oversteps a plane and the top of
    that plane's circle keeps all others, it is the answer: without the others nothing is higher.
    Else the answer is a corner, for on any other circle the way to the top of the sphere is free.
    """
    size = math.sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2])
    x, y, z = u[0] / size, u[1] / size, u[2] / size
    if _kept(A, b, rows, x, y, z):
        best[0], best[1], best[2] = x, y, z
        return True
    for i in range(rows):
        along = A[i, 0] * u[0] + A[i, 1] * u[1] + A[i, 2] * u[2]
        if along <= (b[i] + KEPT) * size:
            continue
        if b[i] < -1.0 - KEPT:
            return False
        px, py, pz = u[0] - along * A[i, 0], u[1] - along * A[i, 1], u[2] - along * A[i, 2]
        length = math.sqrt(px * px + py * py + pz * pz)
        if length <= 1e-10 * size:
            continue
        low = max(b[i], -1.0)
        step = math.sqrt((1.0 - low) * (1.0 + low)) / length
        x, y, z = low * A[i, 0] + step * px, low * A[i, 1] + step * py, low * A[i, 2] + step * pz
        if _kept(A, b, rows, x, y, z):
            best[0], best[1], best[2] = x, y, z
            return True
    found = False
    highest = -math.inf
    for i in range(rows):
        for j in range(i):
            nx = A[i, 1] * A[j, 2] - A[i, 2] * A[j, 1]
            ny = A[i, 2] * A[j, 0] - A[i, 0] * A[j, 2]
            nz = A[i, 0] * A[j, 1] - A[i, 1] * A[j, 0]
            square = nx * nx + ny * ny + nz * nz
            if square < NEAR_PARALLEL:
                continue
            # The corner line's point nearest to the origin: (b_i a_j - b_j a_i) x n/|n|^2.
            vx = b[i] * A[j, 0] - b[j] * A[i, 0]
            vy = b[i] * A[j, 1] - b[j] * A[i, 1]
            vz = b[i] * A[j, 2] - b[j] * A[i, 2]
            fx = (vy * nz - vz * ny) / square
            fy = (vz * nx - vx * nz) / square
            fz = (vx * ny - vy * nx) / square
            left = 1.0 - (fx * fx + fy * fy + fz * fz)
            if left < -KEPT:
                continue
            reach = math.sqrt(max(left, 0.0) / square)
            for sign in (-reach, reach):
                x, y, z = fx + sign * nx, fy + sign * ny, fz + sign * nz
                value = u[0] * x + u[1] * y + u[2] * z
                if value > highest and _kept(A, b, rows, x, y, z):
                    best[0], best[1], best[2] = x, y, z
                    highest = value
                    found = True
    return found


@compiled
def _plane(A: Numbers, b: Numbers, row: int, x: float, y: float, z: float, limit: float) -> int:
    """Put the plane (x, y, z).d <= limit into the next row, and return the number of rows."""
    size = math.sqrt(x * x + y * y + z * z)
    A[row, 0], A[row, 1], A[row, 2] = x / size, y / size, z / size
    b[row] = limit / size
    return row + 1


@compiled
def _linear(
    problem: int, floor: bool, wall: bool, p: Numbers, u: Numbers, A: Numbers, b: Numbers,
    best: Numbers,
) -> int:  # fmt: skip
    """Return the status of a linear problem; `best` becomes the direction."""
    P, k, y, g = p[P_], p[ALONG] / p[P_], p[ACROSS] / p[P_], p[NORMAL] / p[P_]
    mu, mu_s, e = p[MU_K], p[MU_S], p[LIMIT] / p[P_]
    a0, a1, b0, b1 = p[ALPHA_LO], p[ALPHA_HI], p[BETA_LO], p[BETA_HI]
    rows = _plane(A, b, 0, math.sin(a0), -math.cos(a0), 0.0, 0.0)
    rows = _plane(A, b, rows, -math.sin(a1), math.cos(a1), 0.0, 0.0)
    middle = (a0 + a1) / 2
    # Two half-planes back to back leave a whole plane: keep to the side between the bounds.
    rows = _plane(A, b, rows, -math.cos(middle), -math.sin(middle), 0.0, 0.0)
    rows = _plane(A, b, rows, 0.0, 0.0, -1.0, -math.sin(b0))
    top = math.sin(b1)
    if (floor or problem == TRACK_PHYSICAL) and g < top:
        top = g
    rows = _plane(A, b, rows, 0.0, 0.0, 1.0, top)
    u[0], u[1], u[2] = 1.0, 0.0, 0.0
    constant = -k
    if problem == PLANE_THESIS:
        u[2] = mu
        constant -= mu * g
        if e < math.inf:
            rows = _plane(A, b, rows, 0.0, 1.0, mu, mu * g + e)
            rows = _plane(A, b, rows, 0.0, -1.0, -mu, e - mu * g)
    else:
        u[1] = mu
        room = -y if problem == TRACK_THESIS else y
        constant -= mu * room
        if wall or problem == TRACK_PHYSICAL:
            rows = _plane(A, b, rows, 0.0, 1.0, 0.0, room)
    if problem == TRACK_PHYSICAL:
        u[2] = mu
        constant -= mu * g
        u[1] = u[2] = mu_s
        if not _top_of_pieces(u, A, b, rows, best):
            return INFEASIBLE
        needed = k + mu_s * (y + g)
        if best[0] + mu_s * (best[1] + best[2]) <= needed:
            return NO_MOTION
        u[1] = u[2] = mu
        if mu_s > mu:
            rows = _plane(A, b, rows, -1.0, -mu_s, -mu_s, -needed)
        _top_of_pieces(u, A, b, rows, best)
        held = needed - best[0] - mu_s * (best[1] + best[2])
        return NOT_ATTAINED if mu_s > mu and held > -TIGHT else OPTIMAL
    if not _top_of_pieces(u, A, b, rows, best):
        return INFEASIBLE
    value = u[0] * best[0] + u[1] * best[1] + u[2] * best[2] + constant
    return OPTIMAL if P * value > 0 else NO_MOTION


@compiled
def _across(X: float, k: float, q: float, m: float) -> float:
    """Return |a_y| at D_x = X."""
    R = math.sqrt(max(q * q - k * k - 2 * k * X, 0.0))
    Y = math.sqrt(max((q - X - k) * (q + X + k), 0.0))
    return Y * (1.0 - m / R) if R > 0 else Y


@compiled
def _best_across(
    beta: float, k: float, g: float, mu: float, mu_s: float, e: float, a0: float, a1: float,
    out: Numbers,
) -> bool:  # fmt: skip
    """Return whether the block can slide forwards at this beta; fill `out` with the best.

    `out` becomes a_x, its slope over beta, D_x, and 1 where alpha = a0 is best, 2 for a1, else 0.
    With q = cos(beta), R = |D| has R^2 = q^2 - k^2 - 2 k D_x.
    """
    q, dq = math.cos(beta), -math.sin(beta)
    n = g - math.sin(beta)
    m, dm, ms, dms = mu * n, -mu * q, mu_s * n, -mu_s * q
    if n <= 1e-15 * (1 + g):  # at lift-off itself friction is 0, not its rounding
        m = ms = 0.0
    most, least = q * math.cos(a0) - k, q * math.cos(a1) - k
    low, high = max(least, 0.0), most
    kind = 1  # what holds D_x: 0 nothing, 1 a0, 2 a1, 3 the edge of stick, 4 the limit of a_y
    free = q * q - k * k - ms * ms
    if k > 0 and free < 2 * k * high:
        high, kind = free / (2 * k), 3
    if not (high > 0 and high >= low):
        return False
    if k <= 0 and free - 2 * k * high < 0:
        return False
    X = high
    if k > 0 and m > 0:
        # a_x is concave in D_x and its slope too: Newton's steps from the right fall to the root.
        for _ in range(MOST_INNER):
            R2 = q * q - k * k - 2 * k * X
            R = math.sqrt(R2)
            slope = 1.0 - m / R - m * k * X / (R * R2)
            if slope >= 0:
                break
            bend = -2 * m * k / (R * R2) - 3 * m * k * k * X / (R2 * R2 * R)
            ahead = X - slope / bend
            if ahead >= X:
                break
            X, kind = ahead, 0
            if low >= X:
                X, kind = low, 2 if least > 0 else 0
                break
    if _across(X, k, q, m) > e:
        # Push more along x; a_y falls with D_x on a climbing track. On a falling one a_x is
        # largest at a0, and only beyond a maximum of a_y can less of D_x keep the limit.
        start, end = X, high
        if k <= 0:
            end, start = -1.0, X
            for i in range(1, RETREATS + 1):
                trial = X + (low - X) * i / RETREATS
                if q * q - k * k - 2 * k * trial < ms * ms:
                    break
                if _across(trial, k, q, m) <= e:
                    start, end = X + (low - X) * (i - 1) / RETREATS, trial
                    break
            if end < 0:
                return False
        elif _across(high, k, q, m) > e:
            return False
        over, under = _across(start, k, q, m) - e, _across(end, k, q, m) - e
        for step in range(MOST_OUTER):
            trial = (start * under - end * over) / (under - over)
            if step % 3 == 2 or not min(start, end) < trial < max(start, end):
                trial = (start + end) / 2
            if trial in (start, end):
                break
            excess = _across(trial, k, q, m) - e
            if excess > 0:
                start, over, under = trial, excess, under / 2
            else:
                done = end - trial if end > trial else trial - end
                end, under, over = trial, excess, over / 2
                if done <= LAST_DIGIT or excess == 0:
                    break
        # An end at alpha = a0 stays there: the limit holds only up to rounding.
        X, kind = (X, 1) if end == X else (end, 4)
        if k > 0 and end == high:
            kind = 1 if high == most else 3
    R2 = q * q - k * k - 2 * k * X
    R = math.sqrt(max(R2, 0.0))
    if R <= 0:
        return False
    fX = 1.0 - m / R - m * k * X / (R * R2)
    fb = X * (-dm / R + m * q * dq / (R * R2))
    if kind == 1:
        slope = fb + fX * dq * math.cos(a0)
    elif kind == 2:
        slope = fb + fX * dq * math.cos(a1)
    elif kind == 3:
        slope = fb + fX * (q * dq - ms * dms) / k
    elif kind == 4:
        Y = math.sqrt(max((q - X - k) * (q + X + k), 1e-300))
        rest = 1.0 - m / R
        ay_X = -(X + k) / Y * rest - Y * m * k / (R * R2)
        ay_b = q * dq / Y * rest + Y * (-dm / R + m * q * dq / (R * R2))
        slope = fb - fX * ay_b / ay_X if ay_X != 0 else fb
    else:
        slope = fb
    out[0], out[1], out[2], out[3] = X * (1.0 - m / R), slope, X, kind
    return True


@compiled
def _turned_top(k: float, g: float, mu: float) -> float:
    """Return beta of the best turned drive without limits; 0 if there is none (theory 12.2).

    Newton's method for the direction of friction, x = cos(psi), from 0: the slope is convex.
    """
    A = math.hypot(1.0, mu)
    p2 = (1.0 - k) * (1.0 + k)
    if not (k > 0 and p2 > 0 and A * math.sqrt(p2) > mu * g):
        return 0.0
    x = 0.0
    for _ in range(MOST_INNER):
        root = math.sqrt(p2 + (k * x) ** 2)
        t = k * x / root
        slope = A * (p2 / root + 2 * k * x * t) - 2 * k * x - mu * g
        bend = k * (A * t * (3 - t * t) - 2)
        if slope <= 0 or bend >= 0:
            break
        x -= slope / bend
        if x >= 1:
            return 0.0
    return math.asin(math.sqrt(p2 + (k * x) ** 2) * mu / A)


@compiled
def _best_along(
    p: Numbers, betas: Numbers, values: Numbers, rises: Numbers, out: Numbers, best: Numbers
) -> int:
    """Return the status of the block with the friction disc; `best` becomes alpha, beta."""
    k, g = p[ALONG] / p[P_], p[NORMAL] / p[P_]
    mu, mu_s, e = p[MU_K], p[MU_S], p[LIMIT] / p[P_]
    lift_off = math.asin(min(g, 1.0)) if g >= 0 else -10.0
    first, last = p[BETA_LO], min(p[BETA_HI], lift_off)
    # a_x depends on |alpha| alone.
    if p[ALPHA_LO] > 0:
        a0, a1, side = p[ALPHA_LO], p[ALPHA_HI], 1.0
    elif p[ALPHA_HI] < 0:
        a0, a1, side = -p[ALPHA_HI], -p[ALPHA_LO], -1.0
    else:
        side = 1.0 if p[ALPHA_HI] >= -p[ALPHA_LO] else -1.0
        a0, a1 = 0.0, max(p[ALPHA_HI], -p[ALPHA_LO])
    if first > last:
        return INFEASIBLE
    steep = math.hypot(1.0, mu_s)
    least = math.hypot(k, mu_s * g / steep) if k > 0 else (k + mu_s * g) / steep
    if least >= 1.0:
        return NO_MOTION  # whatever the bounds (theory 12.2)
    sideways = _turned_top(k, g, mu)
    whole = a1 >= RIGHT and first <= 0 and p[BETA_HI] >= min(math.atan(mu), last)
    if a0 == 0 and (k <= 0 or (whole and sideways == 0)):
        # Straight along x is best at every beta, or at the best beta.
        straight = min(max(math.atan(mu), first), last)
        floor = g - math.sin(straight) if straight < lift_off else 0.0
        if math.cos(straight) - k > mu_s * floor:
            best[0], best[1] = 0.0, straight
            return OPTIMAL
    steps = STEPS if a0 == 0 and a1 >= RIGHT else STEPS_WITHIN
    count = steps + 1
    for i in range(count):
        betas[i] = first + (last - first) * i / steps
    betas[steps] = last
    turned = min(g * mu_s * mu_s / (1 + mu_s * mu_s), 1.0)
    tops = (math.atan(mu), math.atan(mu_s), math.asin(turned), sideways)
    for special in tops:
        if first < special < last:
            i = count
            while betas[i - 1] > special:
                betas[i] = betas[i - 1]
                i -= 1
            betas[i] = special
            count += 1
    for i in range(count):
        kept = _best_across(betas[i], k, g, mu, mu_s, e, a0, a1, out)
        values[i], rises[i] = (out[0], out[1]) if kept else (-math.inf, 0.0)
    top = -math.inf
    status = NO_MOTION
    for i in range(count):
        value = values[i]
        if value == -math.inf:
            continue
        if (i > 0 and values[i - 1] > value) or (i + 1 < count and values[i + 1] > value):
            continue
        inner, slope = betas[i], rises[i]
        found = inner
        j = i + 1 if slope > 0 else i - 1
        if slope != 0 and 0 <= j < count:
            outer, away = betas[j], rises[j] if values[j] > -math.inf else -slope
            if values[j] > -math.inf and (away > 0) == (slope > 0):
                # A maximum and a minimum lie between: halve until the minimum is outside.
                start, height = inner, value
                for _ in range(HALVINGS):
                    trial = (start + outer) / 2
                    if not _best_across(trial, k, g, mu, mu_s, e, a0, a1, out):
                        away, outer = -slope, trial
                        break
                    if (out[1] > 0) != (slope > 0):
                        away, outer = out[1], trial
                        break
                    if out[0] > height:
                        start, height = trial, out[0]
                    else:
                        outer = trial
            if (away > 0) == (slope > 0):
                found = outer
            else:
                found, within = _sign_change(
                    inner, slope, outer, away, k, g, mu, mu_s, e, a0, a1, out
                )
                if not within:
                    status = LIMIT_REACHED
        if not _best_across(found, k, g, mu, mu_s, e, a0, a1, out) or out[0] < value - KEPT:
            found = inner
            _best_across(found, k, g, mu, mu_s, e, a0, a1, out)
        if out[0] > top:
            top = out[0]
            q, X, kind = math.cos(found), out[2], out[3]
            if kind == 1:
                alpha = a0
            elif kind == 2:
                alpha = a1
            else:
                # Next to 0 alpha is a root of roundings; there it is 0.
                aside = q - X - k
                Y = math.sqrt(aside * (q + X + k)) if aside > KEPT else 0.0
                alpha = max(math.atan2(Y, X + k), a0)
            best[0], best[1] = side * alpha, found
            R = math.sqrt(max(q * q - k * k - 2 * k * X, 0.0))
            held = mu_s > mu and R - mu_s * (g - math.sin(found)) < TIGHT * (1 + g)
            if status != LIMIT_REACHED:
                status = NOT_ATTAINED if held and found < lift_off else OPTIMAL
    return status if top > 0 else NO_MOTION


@compiled
def _sign_change(
    a: float, fa: float, b: float, fb: float, k: float, g: float, mu: float, mu_s: float,
    e: float, a0: float, a1: float, out: Numbers,
) -> tuple[float, bool]:  # fmt: skip
    """Return where the slope over beta changes sign, and whether the last digit was reached.

    Secants with halved weights (Illinois); every third step halves, for slopes that jump. Where the
    block does not slide within its limits counts as past the change: it ends at the last that does.
    """
    t = a
    for step in range(MOST_OUTER):
        before = t
        t = (a + b) / 2 if step % 3 == 2 else (a * fb - b * fa) / (fb - fa)
        if not min(a, b) < t < max(a, b):
            t = (a + b) / 2
        if t in (a, b) or abs(b - a) <= LAST_DIGIT:
            return a, True
        if not _best_across(t, k, g, mu, mu_s, e, a0, a1, out):
            b, fb = t, -fa
            continue
        ft = out[1]
        if abs(ft) <= FLAT_SLOPE or abs(t - before) <= LAST_DIGIT:
            return t, True
        if (ft > 0) == (fa > 0):
            a, fa = t, ft
            fb /= 2
        else:
            b, fb = t, ft
            fa /= 2
    return a, abs(b - a) <= 1e-12


@compiled
def _gradients(
    problem: int, p: Numbers, alpha: float, beta: float, F: Numbers, slopes: Numbers,
    margins: Numbers,
) -> None:  # fmt: skip
    """Fill value, a_y, their gradients and the margins of all constraints with theirs.

    F: a_x or K, a_y, n0, wall margin. `slopes` rows: 0 objective, then the constraints in the
    order of their bits; `margins` alike. In units of P.
    """
    k, y, g = p[ALONG] / p[P_], p[ACROSS] / p[P_], p[NORMAL] / p[P_]
    mu, mu_s, e = p[MU_K], p[MU_S], p[LIMIT] / p[P_]
    ca, sa, q, dz = math.cos(alpha), math.sin(alpha), math.cos(beta), math.sin(beta)
    dx, dy = q * ca, q * sa
    slopes[:] = 0.0
    margins[1], slopes[1, 0] = alpha - p[ALPHA_LO], 1.0
    margins[2], slopes[2, 0] = p[ALPHA_HI] - alpha, -1.0
    margins[3], slopes[3, 1] = beta - p[BETA_LO], 1.0
    margins[4], slopes[4, 1] = p[BETA_HI] - beta, -1.0
    n = g - dz
    margins[7], slopes[7, 1] = n, -q
    room = -y if problem == TRACK_THESIS else y
    margins[8], slopes[8, 0], slopes[8, 1] = room - dy, -dx, dz * sa
    margins[9] = math.inf
    F[2], F[3] = n, room - dy
    if problem == PLANE_PHYSICAL:
        X, Y, m = dx - k, dy, mu * n
        R = math.hypot(X, Y)
        Ra, Rb = k * Y / R, -dz * (q - k * ca) / R
        rest, rest_a = 1.0 - m / R, m * Ra / (R * R)
        rest_b = mu * q / R + m * Rb / (R * R)
        F[0], F[1] = X * rest, Y * rest
        slopes[0, 0], slopes[0, 1] = -dy * rest + X * rest_a, -dz * ca * rest + X * rest_b
        ay_a, ay_b = dx * rest + Y * rest_a, -dz * sa * rest + Y * rest_b
        if mu_s > mu:
            margins[9], slopes[9, 0], slopes[9, 1] = R - mu_s * n, Ra, Rb + mu_s * q
    elif problem == PLANE_THESIS:
        F[0], F[1] = dx - k - mu * n, dy - mu * n
        slopes[0, 0], slopes[0, 1] = -dy, -dz * ca + mu * q
        ay_a, ay_b = dx, -dz * sa + mu * q
    else:
        F[0], F[1] = dx - k - mu * (room - dy), 0.0
        slopes[0, 0], slopes[0, 1] = -dy + mu * dx, -dz * (ca + mu * sa)
        ay_a = ay_b = 0.0
        if problem == TRACK_PHYSICAL:
            F[0] -= mu * n
            slopes[0, 1] += mu * q
            if mu_s > mu:
                margins[9] = dx - k - mu_s * (n + room - dy)
                slopes[9, 0], slopes[9, 1] = -dy + mu_s * dx, -dz * (ca + mu_s * sa) + mu_s * q
    margins[5], slopes[5, 0], slopes[5, 1] = F[1] + e, ay_a, ay_b
    margins[6], slopes[6, 0], slopes[6, 1] = e - F[1], -ay_a, -ay_b


@compiled
def _prices(slopes: Numbers, active: NDArray[np.int64], count: int, prices: Numbers) -> float:
    """Return the residual of the conditions of an optimum, and fill the multipliers.

    The objective's gradient must be a combination, with no negative weight, of at most two of the
    active constraints' gradients, negated; the combination with the least remainder is taken.
    """
    fx, fy = slopes[0, 0], slopes[0, 1]
    least = math.hypot(fx, fy)
    prices[:] = 0.0
    one, two, w1, w2 = -1, -1, 0.0, 0.0
    for i in range(count):
        ax, ay = -slopes[active[i], 0], -slopes[active[i], 1]
        square = ax * ax + ay * ay
        if square <= 0:
            continue
        weight = (fx * ax + fy * ay) / square
        if weight >= 0:
            rest = math.hypot(fx - weight * ax, fy - weight * ay)
            # A second multiplier has to earn its place; so has the first.
            if rest < least - 1e-15:
                least, one, two, w1, w2 = rest, active[i], -1, weight, 0.0
    for i in range(count):
        ax, ay = -slopes[active[i], 0], -slopes[active[i], 1]
        for j in range(i):
            bx, by = -slopes[active[j], 0], -slopes[active[j], 1]
            area = ax * by - ay * bx
            if abs(area) <= 1e-12:
                continue
            v1, v2 = (fx * by - fy * bx) / area, (ax * fy - ay * fx) / area
            if v1 >= 0 and v2 >= 0:
                rest = math.hypot(fx - v1 * ax - v2 * bx, fy - v1 * ay - v2 * by)
                if rest < least - 1e-12:
                    least, one, two, w1, w2 = rest, active[i], active[j], v1, v2
    if one >= 0:
        prices[one] = w1
    if two >= 0:
        prices[two] = w2
    return least


@compiled
def _is_valid(p: Numbers) -> bool:
    """Return whether all groups are numbers within their range; only the limit may be infinite."""
    for i in range(GROUPS):
        if not math.isfinite(p[i]) and not (i == LIMIT and p[i] == math.inf):
            return False
    return (
        p[P_] >= 0
        and p[MU_K] >= 0
        and p[MU_S] >= p[MU_K]
        and p[LIMIT] >= 0
        and p[ALPHA_HI] - p[ALPHA_LO] <= 2 * RIGHT + KEPT
        and p[BETA_LO] >= -RIGHT
        and p[BETA_HI] <= RIGHT
    )


@compiled
def _idle(problem: int, floor: bool, wall: bool, p: Numbers, row: Numbers) -> int:
    """Return the status without drive, where every angle is as good; fill the row."""
    c, y, G, mu = p[ALONG], p[ACROSS], p[NORMAL], p[MU_K]
    room = -y if problem == TRACK_THESIS else y
    across = -mu * G if problem == PLANE_THESIS else 0.0
    physical = problem in (PLANE_PHYSICAL, TRACK_PHYSICAL)
    if problem == PLANE_THESIS:
        value = across - c
    elif problem == PLANE_PHYSICAL:
        value = -c + math.copysign(mu * G, c) if abs(c) > p[MU_S] * G else 0.0
    else:
        value = -c - mu * (room + (G if physical else 0.0))
    if (floor or physical) and G < 0:
        return INFEASIBLE
    if problem >= TRACK_THESIS and (wall or physical) and room < 0:
        return INFEASIBLE
    if problem <= PLANE_PHYSICAL and abs(across) > p[LIMIT]:
        return INFEASIBLE
    row[ALPHA], row[BETA], row[VALUE], row[CROSS] = p[ALPHA_LO], p[BETA_LO], value, across
    row[MARGIN_ACROSS], row[MARGIN_FLOOR] = p[LIMIT] - abs(across), G
    row[MARGIN_WALL] = room if problem >= TRACK_THESIS else math.nan
    row[PRICE_ACROSS] = row[PRICE_FLOOR] = row[PRICE_WALL] = row[RESIDUAL] = 0.0
    return FLAT


@compiled
def solve(
    problem: int, floor: bool, wall: bool, groups: Numbers, table: Numbers,
    active: NDArray[np.int16], status: NDArray[np.int8],
) -> None:  # fmt: skip
    """Fill table, bits and statuses for groups (n, GROUPS)."""
    A, b, u, best = np.empty((ROWS, 3)), np.empty(ROWS), np.empty(3), np.empty(3)
    samples = STEPS_WITHIN + SPECIAL + 1
    betas, values, rises = np.empty(samples), np.empty(samples), np.empty(samples)
    out, F = np.empty(4), np.empty(4)
    slopes, margins, prices = np.empty((10, 2)), np.empty(10), np.empty(10)
    tight = np.empty(10, dtype=np.int64)
    physical = problem in (PLANE_PHYSICAL, TRACK_PHYSICAL)
    for cell in range(groups.shape[0]):
        p = groups[cell]
        table[cell, :] = math.nan
        active[cell] = 0
        if not _is_valid(p):
            status[cell] = INVALID
            continue
        if p[ALPHA_LO] > p[ALPHA_HI] or p[BETA_LO] > p[BETA_HI]:
            status[cell] = INFEASIBLE
            continue
        if p[P_] <= TINY * (abs(p[ALONG]) + abs(p[ACROSS]) + abs(p[NORMAL])):
            status[cell] = _idle(problem, floor, wall, p, table[cell])
            continue
        if problem == PLANE_PHYSICAL:
            found = _best_along(p, betas, values, rises, out, best)
            alpha, beta = best[0], best[1]
        else:
            found = _linear(problem, floor, wall, p, u, A, b, best)
            alpha = math.atan2(best[1], best[0])
            beta = math.atan2(best[2], math.hypot(best[0], best[1]))
        status[cell] = found
        if found == INFEASIBLE or (physical and found == NO_MOTION):
            continue
        # Rounding, or a drive along the normal, where every alpha is the same direction.
        alpha = min(max(alpha, p[ALPHA_LO]), p[ALPHA_HI])
        beta = min(max(beta, p[BETA_LO]), p[BETA_HI])
        _gradients(problem, p, alpha, beta, F, slopes, margins)
        bits, count = 0, 0
        for i in range(1, 10):
            asked = (
                i <= 4
                or (i <= 6 and problem <= PLANE_PHYSICAL)
                or (i == 7 and (floor or physical))
                or (i == 8 and problem >= TRACK_THESIS and (wall or physical))
                or i == 9
            )
            if asked and margins[i] <= TIGHT * (1 + p[NORMAL] / p[P_]):
                bits |= 1 << (i - 1)
                tight[count] = i
                count += 1
        active[cell] = bits
        row = table[cell]
        row[RESIDUAL] = _prices(slopes, tight, count, prices)
        P = p[P_]
        row[ALPHA], row[BETA] = alpha, beta
        row[VALUE], row[CROSS] = P * F[0], P * F[1]
        row[MARGIN_ACROSS] = p[LIMIT] - abs(P * F[1])
        row[MARGIN_FLOOR] = P * F[2]
        row[MARGIN_WALL] = P * F[3] if problem >= TRACK_THESIS else math.nan
        row[PRICE_ACROSS] = prices[5] + prices[6]
        row[PRICE_FLOOR], row[PRICE_WALL] = prices[7], prices[8]
