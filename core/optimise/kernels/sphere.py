"""The highest point of a piece of the unit sphere that planes cut out (theory 12).

The printed formulas and the track are linear in the drive direction d, and so are all their limits,
contacts and bounds. The best d is then the top of the sphere, the top of one circle, or a corner of
two: the active set is looked for among these, and each is a closed form.
"""

from __future__ import annotations

import math

from vibrafeed.core.compiled import compiled
from vibrafeed.core.optimise.kernels.columns import (
    ALPHA_HI,
    ALPHA_LO,
    BETA_HI,
    BETA_LO,
    INFEASIBLE,
    KEPT,
    NO_MOTION,
    NORMAL,
    OPTIMAL,
    P_,
    Best,
    Numbers,
    Work,
)  # fmt: skip

ROWS = 9  # most planes of one problem
NEAR_PARALLEL = 1e-20  # squared sine below which two planes have no corner


@compiled
def _kept(A: Numbers, b: Numbers, rows: int, x: float, y: float, z: float) -> bool:
    """True if a direction of the drive keeps all limits, which are planes that cut the unit sphere.

    A limit is a.d <= b, up to rounding, for the direction d = (x, y, z); the first `rows` rows of
    A, shape (rows, 3), and of b count.
    """
    for i in range(rows):  # noqa: SIM110 - a generator would not compile
        if A[i, 0] * x + A[i, 1] * y + A[i, 2] * z > b[i] + KEPT:
            return False
    return True


@compiled
def _highest_corner(u: Numbers, A: Numbers, b: Numbers, rows: int, best: Numbers) -> bool:
    """True if two limits of a drive direction meet on the unit sphere within all others.

    Limits are planes a.d <= b, the first `rows` rows of A, shape (rows, 3), and of b. `best` is
    filled with the corner of the largest u.d: `u`, shape (3,), is what the objective weighs d with.
    The best drive is there if it is neither the top of the sphere nor that of one limit's circle.
    """
    exists = False
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
                    exists = True
    return exists


@compiled
def top_of_pieces(u: Numbers, A: Numbers, b: Numbers, rows: int, best: Numbers) -> bool:
    """True if a drive direction keeps all limits; `best` is filled with the one of the largest u.d.

    The limits are planes a.d <= b; the first `rows` rows of A, unit vectors, shape (rows, 3), and
    of b count. `u`, shape (3,), of any length, is what the objective weighs the direction d with.

    Where the top of the sphere oversteps a plane and the top of that plane's circle keeps all
    others, it is the optimum: without the others nothing is higher. Else it is a corner, for on any
    other circle the way to the top of the sphere is free.
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
    return _highest_corner(u, A, b, rows, best)


@compiled
def plane(A: Numbers, b: Numbers, row: int, x: float, y: float, z: float, limit: float) -> int:
    """Add a limit of the drive direction d, (x, y, z).d <= limit, to the planes A and b.

    It becomes row `row` of A, shape (rows, 3), and of b, with a unit vector; the result is the
    number of rows then.
    """
    size = math.sqrt(x * x + y * y + z * z)
    A[row, 0], A[row, 1], A[row, 2] = x / size, y / size, z / size
    b[row] = limit / size
    return row + 1


@compiled
def angles_within(p: Numbers, floor: bool, A: Numbers, b: Numbers) -> int:
    """Write the bounds of a drive's angles as planes a.d <= b into A and b; return their number.

    Here d is the direction of the drive; A has rows of unit vectors, shape (rows, 3). `p` are the
    inputs of a design, in the columns `P_` to `BETA_HI`; with `floor` the drive may not lift the
    part, which is one more limit of d_z.
    """
    a0, a1, b0, b1 = p[ALPHA_LO], p[ALPHA_HI], p[BETA_LO], p[BETA_HI]
    rows = plane(A, b, 0, math.sin(a0), -math.cos(a0), 0.0, 0.0)
    rows = plane(A, b, rows, -math.sin(a1), math.cos(a1), 0.0, 0.0)
    middle = (a0 + a1) / 2
    # Two half-planes back to back leave a whole plane: keep to the side between the bounds.
    rows = plane(A, b, rows, -math.cos(middle), -math.sin(middle), 0.0, 0.0)
    rows = plane(A, b, rows, 0.0, 0.0, -1.0, -math.sin(b0))
    top, g = math.sin(b1), p[NORMAL] / p[P_]
    if floor and g < top:
        top = g
    return plane(A, b, rows, 0.0, 0.0, 1.0, top)


@compiled
def angles_of(d: Numbers) -> tuple[float, float]:
    """Return azimuth and elevation of a direction d [rad]."""
    return math.atan2(d[1], d[0]), math.atan2(d[2], math.hypot(d[0], d[1]))


@compiled
def highest(P: float, constant: float, rows: int, work: Work) -> Best:
    """Return status, alpha and beta of the drive direction d with the largest u.d + constant.

    It keeps all limits, which are planes a.d <= b. `work` has u and the first `rows` planes. Times
    P, the drive acceleration, the value is the acceleration of the part, which has to be positive
    for a motion. The result says, too, if there are such angles [rad].
    """
    u, d = work.upwards, work.direction
    if not top_of_pieces(u, work.planes, work.levels, rows, d):
        return Best(INFEASIBLE, False, math.nan, math.nan)
    value = u[0] * d[0] + u[1] * d[1] + u[2] * d[2] + constant
    alpha, beta = angles_of(d)
    return Best(OPTIMAL if P * value > 0 else NO_MOTION, True, alpha, beta)
