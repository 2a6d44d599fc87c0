"""The block with the friction disc: its largest a_x over alpha and beta (theory 12.2).

At fixed beta a_x is concave in D_x, and its limits leave an interval of D_x (`best_across`,
Newton's method); over beta, the slope of that best value is known, and its sign changes are closed
in on between samples (`best_along`). With q = cos(beta), R = |D| has R^2 = q^2 - k^2 - 2 k D_x.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from vibrafeed.core.compiled import compiled
from vibrafeed.core.optimise.codes import TIGHT
from vibrafeed.core.optimise.kernels.columns import (
    ALONG,
    ALPHA_HI,
    ALPHA_LO,
    BETA_HI,
    BETA_LO,
    INFEASIBLE,
    KEPT,
    LIMIT,
    LIMIT_REACHED,
    MU_K,
    MU_S,
    NO_MOTION,
    NORMAL,
    NOT_ATTAINED,
    OPTIMAL,
    P_,
    Numbers,
)  # fmt: skip

RIGHT = math.pi / 2

STEPS = 6  # equal steps of beta, where alpha = 0 and 90 deg are allowed
STEPS_WITHIN = 64  # with other bounds, which can leave narrow windows
SPECIAL = 4  # angles added: of friction, where a turned drive starts first, and where it is best
SAMPLES = STEPS_WITHIN + SPECIAL + 1
RETREATS = 16  # equal steps of D_x on the way to a smaller a_y
MAX_INNER = 40  # Newton steps in D_x
MAX_OUTER = 160  # steps that close in on a sign change
HALVINGS = 20  # of an interval that hides a maximum
LAST_DIGIT = 2e-16
FLAT_SLOPE = 5e-16  # a slope over beta is a sum of terms of order 1, each rounded

# What holds D_x of the best at one beta.
FREE, NEAREST, FARTHEST, STICK_EDGE, ACROSS_LIMIT = range(5)  # nothing, a0, a1, stick, |a_y|


class Block(NamedTuple):
    """A design, in units of P.

    Attributes
    ----------
    k, g : float
        Gravity along -x and onto the floor.
    mu, mu_s : float
        Friction coefficients.
    e : float
        Largest |a_y|.
    a0, a1 : float
        Bounds of |alpha| [rad].
    """

    k: float
    g: float
    mu: float
    mu_s: float
    e: float
    a0: float
    a1: float


class BestAcross(NamedTuple):
    """The best at one beta.

    Attributes
    ----------
    slides : bool
        Whether the block can slide forwards there; nothing else counts where it cannot.
    value, slope : float
        a_x, and its slope over beta.
    drive : float
        D_x.
    held : int
        What holds D_x: `FREE` to `ACROSS_LIMIT`.
    """

    slides: bool
    value: float
    slope: float
    drive: float
    held: int


class Level(NamedTuple):
    """A block at one beta: q = cos(beta), the friction mu n and mu_s n, and slopes over beta."""

    q: float
    dq: float
    m: float
    dm: float
    ms: float
    dms: float


@compiled
def _level(beta: float, block: Block) -> Level:
    """Return q = cos(beta) and the friction mu_k n and mu_s n at one elevation, with slopes.

    beta is the elevation of the drive [rad], n the normal force per mass. All forces are in units
    of the drive acceleration P, and slopes are derivatives by beta. `block` has gravity onto the
    floor and the friction coefficients.
    """
    q, dq = math.cos(beta), -math.sin(beta)
    n = block.g - math.sin(beta)
    m, ms = block.mu * n, block.mu_s * n
    if n <= 1e-15 * (1 + block.g):  # at lift-off itself friction is 0, not its rounding
        m = ms = 0.0
    return Level(q, dq, m, -block.mu * q, ms, -block.mu_s * q)


@compiled
def _across(X: float, k: float, at: Level) -> float:
    """Return |a_y| of a part for a drive along the track less gravity D_x = X.

    `k` is gravity along -x; `at` has the drive's q = cos(beta) and kinetic friction m = mu n at one
    elevation beta. All are in units of the drive acceleration P. |a_y| = Y (1 - m/R), with the
    drive across Y^2 = q^2 - (X + k)^2 and R^2 = X^2 + Y^2; Y where R is 0.
    """
    q = at.q
    R = math.sqrt(max(q * q - k * k - 2 * k * X, 0.0))
    Y = math.sqrt(max((q - X - k) * (q + X + k), 0.0))
    return Y * (1.0 - at.m / R) if R > 0 else Y


@compiled
def _top_across(high: float, held: int, least: float, k: float, at: Level) -> tuple[float, int]:
    """Return the D_x at which a part accelerates most along the track, and what keeps D_x there.

    D_x is the drive along the track less gravity, in units of the drive acceleration P; it stands
    for the azimuth of the drive at one elevation beta. The acceleration is a_x = D_x (1 - m/R),
    with m the friction and R^2 = q^2 - k^2 - 2 k D_x. It is concave in D_x and so is its slope:
    Newton's steps from the right fall to the root of the slope.

    `high` is the largest D_x, `held` the code of what limits it there, `least` the smallest (0 if
    it is negative). `k` is gravity along -x; `at` has q = cos(beta) and m. The code returned is
    `held` where `high` is best, `FREE` for a maximum inside or at 0, `FARTHEST` for one at `least`.
    """
    q, m = at.q, at.m
    X, low = high, max(least, 0.0)
    for _ in range(MAX_INNER):
        R2 = q * q - k * k - 2 * k * X
        R = math.sqrt(R2)
        slope = 1.0 - m / R - m * k * X / (R * R2)
        if slope >= 0:
            break
        bend = -2 * m * k / (R * R2) - 3 * m * k * k * X / (R2 * R2 * R)
        ahead = X - slope / bend
        if ahead >= X:
            break
        X, held = ahead, FREE
        if low >= X:
            X, held = low, FARTHEST if least > 0 else FREE
            break
    return X, held


@compiled
def _retreat(X: float, low: float, k: float, at: Level, e: float) -> tuple[float, float]:
    """Return D_x before and after the first step down from X with |a_y| <= e; -1 if there is none.

    D_x is the drive along the track less gravity. 16 equal steps lead to `low`; they end where the
    part would stick. `k` is gravity along -x, `at` has drive and friction at one elevation beta,
    `e` is the limit of |a_y|. All are in units of the drive acceleration P.
    """
    for i in range(1, RETREATS + 1):
        trial = X + (low - X) * i / RETREATS
        if at.q * at.q - k * k - 2 * k * trial < at.ms * at.ms:
            break
        if _across(trial, k, at) <= e:
            return X + (low - X) * (i - 1) / RETREATS, trial
    return X, -1.0


@compiled
def _last_within(start: float, end: float, k: float, at: Level, e: float) -> float:
    """Return the D_x nearest to `start` at which |a_y| keeps its limit `e`, found from `end`.

    D_x is the drive along the track less gravity; `start` is a D_x beyond the limit and `end` one
    within. Secants with halved weights close in, every third step a halving. `k` is gravity along
    -x, `at` has drive and friction at one elevation beta. All are in units of the drive
    acceleration P.
    """
    over, under = _across(start, k, at) - e, _across(end, k, at) - e
    for step in range(MAX_OUTER):
        trial = (start * under - end * over) / (under - over)
        if step % 3 == 2 or not min(start, end) < trial < max(start, end):
            trial = (start + end) / 2
        if trial in (start, end):
            break
        excess = _across(trial, k, at) - e
        if excess > 0:
            start, over, under = trial, excess, under / 2
        else:
            done = end - trial if end > trial else trial - end
            end, under, over = trial, excess, over / 2
            if done <= LAST_DIGIT or excess == 0:
                break
    return end


@compiled
def _within_limit(X: float, low: float, high: float, k: float, at: Level, e: float) -> float:
    """Return the D_x nearest to X with |a_y| within its limit `e`; -1 if there is none.

    D_x is the drive along the track less gravity. On a climbing track (gravity `k` > 0 along -x)
    a_y falls as D_x grows towards `high`. On a falling one a_x is largest at X, and only beyond a
    maximum of a_y can a smaller D_x, down to `low`, keep the limit. `at` has drive and friction at
    one elevation beta. All are in units of the drive acceleration P.
    """
    start, end = X, high
    if k <= 0:
        start, end = _retreat(X, low, k, at, e)
        if end < 0:
            return -1.0
    elif _across(high, k, at) > e:
        return -1.0
    return _last_within(start, end, k, at, e)


@compiled
def _slope_along(X: float, held: int, at: Level, block: Block) -> float:
    """Return the slope over the elevation beta of the part's largest a_x, in units of P per rad.

    P is the drive acceleration, a_x the acceleration of the part along the track, the largest over
    the azimuths allowed; a search for the best beta needs its slope. D_x = X is the drive along
    less gravity that gives it. `held` is the code of what limits D_x: `NEAREST` or `FARTHEST`
    azimuth, `STICK_EDGE` where static friction would hold the part, `ACROSS_LIMIT` of |a_y|; else
    D_x is free and a_x has no slope by it. `at` has q = cos(beta), kinetic and static friction m
    and ms with their slopes dq, dm, dms, `block` gravity k along -x and the azimuths a0, a1 [rad].
    """
    k, q, dq, m, dm = block.k, at.q, at.dq, at.m, at.dm
    R2 = q * q - k * k - 2 * k * X
    R = math.sqrt(max(R2, 0.0))
    fX = 1.0 - m / R - m * k * X / (R * R2)
    fb = X * (-dm / R + m * q * dq / (R * R2))
    if held == NEAREST:
        return fb + fX * dq * math.cos(block.a0)
    if held == FARTHEST:
        return fb + fX * dq * math.cos(block.a1)
    if held == STICK_EDGE:
        return fb + fX * (q * dq - at.ms * at.dms) / k
    if held == ACROSS_LIMIT:
        Y = math.sqrt(max((q - X - k) * (q + X + k), 1e-300))
        rest = 1.0 - m / R
        ay_X = -(X + k) / Y * rest - Y * m * k / (R * R2)
        ay_b = q * dq / Y * rest + Y * (-dm / R + m * q * dq / (R * R2))
        return fb - fX * ay_b / ay_X if ay_X != 0 else fb
    return fb


@compiled
def _most_along(most: float, k: float, at: Level) -> tuple[float, int]:
    """Return the largest D_x with which a part slides, and its limit; -1 if there is none.

    D_x is the drive along the track less gravity, in units of the drive acceleration P. The part
    slides where R^2 = q^2 - k^2 - 2 k D_x exceeds (mu_s n)^2, with q = cos(beta), k gravity along
    -x and n the normal force per mass; both are in units of P. R falls with D_x on a climbing
    track, and grows on a falling one.

    `most` is D_x at the smallest azimuth, `at` has q and mu_s n at one beta. The limit is a code:
    `STICK_EDGE` if a larger D_x would let the part stick, else `NEAREST`, the bound of the azimuth.
    """
    free = at.q * at.q - k * k - at.ms * at.ms
    if k > 0 and free < 2 * k * most:
        return free / (2 * k), STICK_EDGE
    if k <= 0 and free - 2 * k * most < 0:
        return -1.0, NEAREST
    return most, NEAREST


@compiled
def best_across(beta: float, block: Block) -> BestAcross:
    """Return the best a_x at one elevation beta [rad], its slope over beta, and its D_x.

    D_x is the drive along the track less gravity, which stands for the azimuth; the best one keeps
    the bounds of the azimuth, the limit of |a_y|, and lets the part slide. `block` has gravity,
    friction and limits. All accelerations are in units of the drive acceleration P; the result says
    if the part slides at all, and what limits D_x. No D_x is given where the part does not slide.
    """
    k, e = block.k, block.e
    at = _level(beta, block)
    q, nowhere = at.q, BestAcross(False, 0.0, 0.0, 0.0, FREE)
    most, least = q * math.cos(block.a0) - k, q * math.cos(block.a1) - k
    low = max(least, 0.0)
    high, held = _most_along(most, k, at)
    if not (high > 0 and high >= low):
        return nowhere
    X = high
    if k > 0 and at.m > 0:
        X, held = _top_across(high, held, least, k, at)
    if _across(X, k, at) > e:
        end = _within_limit(X, low, high, k, at, e)
        if end < 0:
            return nowhere
        # An end at alpha = a0 stays there: the limit holds only up to rounding.
        held = NEAREST if end == X else ACROSS_LIMIT
        if k > 0 and end == high:
            held = NEAREST if high == most else STICK_EDGE
        X = end
    R = math.sqrt(max(q * q - k * k - 2 * k * X, 0.0))
    if R <= 0:
        return nowhere
    return BestAcross(True, X * (1.0 - at.m / R), _slope_along(X, held, at, block), X, held)


@compiled
def _turned_top(k: float, g: float, mu: float) -> float:
    """Return the elevation beta of the best drive from the side, without limits [rad]; 0 if none.

    On a climbing track such a drive may beat one along the track, as it turns friction away (theory
    12.2). The direction of friction, x = cos(psi), is found by Newton's method from 0: the slope of
    a_x is convex. `k` and `g` are gravity along -x and onto the floor over the drive acceleration,
    `mu` is kinetic friction.
    """
    A = math.hypot(1.0, mu)
    p2 = (1.0 - k) * (1.0 + k)
    if not (k > 0 and p2 > 0 and A * math.sqrt(p2) > mu * g):
        return 0.0
    x = 0.0
    for _ in range(MAX_INNER):
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
def _azimuths(lower: float, upper: float) -> tuple[float, float, float]:
    """Return the least and the largest |alpha| within bounds, and the sign of alpha (1 or -1).

    `lower` and `upper` are the bounds of alpha, the azimuth of the drive [rad]. On a plane a_x of a
    part depends on |alpha| alone. Of bounds on both sides of 0, the wider side is taken.
    """
    if lower > 0:
        return lower, upper, 1.0
    if upper < 0:
        return -upper, -lower, -1.0
    return 0.0, max(upper, -lower), 1.0 if upper >= -lower else -1.0


@compiled
def _sampled(
    first: float, last: float, steps: int, sideways: float, block: Block, betas: Numbers
) -> int:
    """Fill `betas` with the elevations to try in ascending order [rad], and return their number.

    They are `steps` equal steps from `first` to `last`, and between these angles at which the best
    drive may lie: those of friction, of the first drive from the side that moves the part, and
    `sideways`, that of the best such drive. `block` has gravity and friction.
    """
    mu, mu_s = block.mu, block.mu_s
    count = steps + 1
    for i in range(count):
        betas[i] = first + (last - first) * i / steps
    betas[steps] = last
    turned = min(block.g * mu_s * mu_s / (1 + mu_s * mu_s), 1.0)
    for special in (math.atan(mu), math.atan(mu_s), math.asin(turned), sideways):
        if first < special < last:
            i = count
            while betas[i - 1] > special:
                betas[i] = betas[i - 1]
                i -= 1
            betas[i] = special
            count += 1
    return count


@compiled
def _past_minimum(
    inner: float, slope: float, value: float, outer: float, outer_slope: float, block: Block
) -> tuple[float, float]:
    """Return an elevation beyond a maximum, with no minimum in between, and the slope of a_x there.

    a_x rises in the same direction at both ends, `inner` and `outer` [rad]: a maximum and a minimum
    lie between. The interval is halved until the minimum is outside, so that the maximum can be
    closed in on.

    `slope` and `value` are those of a_x at `inner`, `outer_slope` is that at `outer`; `block` has
    gravity, friction and limits.
    """
    start, height = inner, value
    for _ in range(HALVINGS):
        trial = (start + outer) / 2
        at = best_across(trial, block)
        if not at.slides:
            return trial, -slope
        if (at.slope > 0) != (slope > 0):
            return trial, at.slope
        if at.value > height:
            start, height = trial, at.value
        else:
            outer = trial
    return outer, outer_slope


@compiled
def _sign_change(a: float, fa: float, b: float, fb: float, block: Block) -> tuple[float, bool]:
    """Return the elevation beta where the slope of a_x is 0, and True if it is exact.

    Secants with halved weights (Illinois) close in; every third step halves, for slopes that jump.
    Where the part does not slide within its limits counts as past the change: the search then ends
    at the last beta at which it slides.

    `a` and `b` are elevations [rad] with slopes `fa` and `fb` of different signs, `block` has
    gravity, friction and limits.
    """
    t = a
    for step in range(MAX_OUTER):
        before = t
        t = (a + b) / 2 if step % 3 == 2 else (a * fb - b * fa) / (fb - fa)
        if not min(a, b) < t < max(a, b):
            t = (a + b) / 2
        if t in (a, b) or abs(b - a) <= LAST_DIGIT:
            return a, True
        at = best_across(t, block)
        if not at.slides:
            b, fb = t, -fa
            continue
        ft = at.slope
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
def _climbed(
    i: int, count: int, betas: Numbers, values: Numbers, rises: Numbers, block: Block
) -> tuple[float, bool]:
    """Return the elevation beta of the local maximum of a_x near a sample, and True if it is exact.

    The maximum lies between sample `i` and the neighbour towards which a_x rises, where the slope
    changes its sign; it is closed in on to the last digit.

    Parameters
    ----------
    betas, values, rises : ndarray, `count` samples
        Elevations of the drive [rad], the largest a_x there in units of the drive acceleration P,
        and its slope over beta; -inf where the part does not slide.
    block : Block
        Gravity, friction and limits.
    """
    inner, slope = betas[i], rises[i]
    j = i + 1 if slope > 0 else i - 1
    if slope == 0 or not 0 <= j < count:
        return inner, True
    slides = values[j] > -math.inf
    outer, outer_slope = betas[j], rises[j] if slides else -slope
    if slides and (outer_slope > 0) == (slope > 0):
        outer, outer_slope = _past_minimum(inner, slope, values[i], outer, outer_slope, block)
    if (outer_slope > 0) == (slope > 0):
        return outer, True
    return _sign_change(inner, slope, outer, outer_slope, block)


@compiled
def _azimuth(beta: float, at: BestAcross, block: Block) -> float:
    """Return the azimuth |alpha| of the best drive at one elevation beta [rad].

    `at` has its D_x, the drive along the track less gravity, and the code of what limits it;
    `block` has gravity and bounds.
    """
    if at.held == NEAREST:
        return block.a0
    if at.held == FARTHEST:
        return block.a1
    # Next to 0 alpha is a root of roundings; there it is 0.
    q, X, k = math.cos(beta), at.drive, block.k
    aside = q - X - k
    Y = math.sqrt(aside * (q + X + k)) if aside > KEPT else 0.0
    return max(math.atan2(Y, X + k), block.a0)


@compiled
def _is_held(beta: float, at: BestAcross, block: Block) -> bool:
    """True if static friction just holds the block at the best drive `at` of one beta."""
    q, X, k, g = math.cos(beta), at.drive, block.k, block.g
    R = math.sqrt(max(q * q - k * k - 2 * k * X, 0.0))
    return block.mu_s > block.mu and R - block.mu_s * (g - math.sin(beta)) < TIGHT * (1 + g)


@compiled
def _highest(
    count: int, betas: Numbers, values: Numbers, rises: Numbers, lift_off: float, side: float,
    block: Block, best: Numbers,
) -> int:  # fmt: skip
    """Return the status of a problem, and fill `best` with alpha and beta of its highest maximum.

    Each sample that is not below its neighbours is followed to the maximum near it.

    Parameters
    ----------
    count : int
        Number of samples.
    betas, values, rises : ndarray
        Samples: elevation beta of the drive [rad], the largest a_x there in units of the drive
        acceleration P (-inf where the part does not slide), and its slope over beta.
    lift_off : float
        The beta at which the part lifts off [rad].
    side : float
        Sign of the azimuth alpha.
    block : Block
        Gravity, friction and limits.
    best : ndarray, shape (2,) or more
        Filled with alpha and beta [rad].
    """
    top = -math.inf
    status = NO_MOTION
    for i in range(count):
        value = values[i]
        if value == -math.inf:
            continue
        if (i > 0 and values[i - 1] > value) or (i + 1 < count and values[i + 1] > value):
            continue
        peak, within = _climbed(i, count, betas, values, rises, block)
        if not within:
            status = LIMIT_REACHED
        at = best_across(peak, block)
        if not at.slides or at.value < value - KEPT:
            peak = betas[i]
            at = best_across(peak, block)
        if at.value > top:
            top = at.value
            best[0], best[1] = side * _azimuth(peak, at, block), peak
            if status != LIMIT_REACHED:
                held = _is_held(peak, at, block) and peak < lift_off
                status = NOT_ATTAINED if held else OPTIMAL
    return status if top > 0 else NO_MOTION


@compiled
def _slides_straight(beta: float, lift_off: float, block: Block) -> bool:
    """True if a drive straight along x moves the block: q - k > mu_s n."""
    floor = block.g - math.sin(beta) if beta < lift_off else 0.0
    return math.cos(beta) - block.k > block.mu_s * floor


@compiled
def _fill(count: int, betas: Numbers, values: Numbers, rises: Numbers, block: Block) -> None:
    """Fill the largest a_x at each of `count` angles `betas`, and its slope over beta.

    a_x is -inf where nothing slides.
    """
    for i in range(count):
        at = best_across(betas[i], block)
        values[i], rises[i] = (at.value, at.slope) if at.slides else (-math.inf, 0.0)


@compiled
def best_along(p: Numbers, betas: Numbers, values: Numbers, rises: Numbers, best: Numbers) -> int:
    """Return the status, and fill `best` with the best alpha and beta under the friction disc.

    It is for the largest a_x of a part on a plane (theory 12.2): elevations beta are sampled, and
    the maxima near the samples closed in on.

    Parameters
    ----------
    p : ndarray
        Inputs of a design in the columns `P_` to `BETA_HI`: drive, gravity, friction, limit and
        bounds, SI units and radians.
    betas, values, rises : ndarray, shape (SAMPLES,)
        Working arrays for the samples.
    best : ndarray, shape (2,) or more
        Filled with azimuth and elevation [rad].
    """
    k, g = p[ALONG] / p[P_], p[NORMAL] / p[P_]
    mu, mu_s = p[MU_K], p[MU_S]
    lift_off = math.asin(min(g, 1.0)) if g >= 0 else -10.0
    first, last = p[BETA_LO], min(p[BETA_HI], lift_off)
    if first > last:
        return INFEASIBLE
    steep = math.hypot(1.0, mu_s)
    least = math.hypot(k, mu_s * g / steep) if k > 0 else (k + mu_s * g) / steep
    if least >= 1.0:
        return NO_MOTION  # whatever the bounds (theory 12.2)
    a0, a1, side = _azimuths(p[ALPHA_LO], p[ALPHA_HI])
    block = Block(k, g, mu, mu_s, p[LIMIT] / p[P_], a0, a1)
    sideways = _turned_top(k, g, mu)
    whole = a1 >= RIGHT and first <= 0 and p[BETA_HI] >= min(math.atan(mu), last)
    if a0 == 0 and (k <= 0 or (whole and sideways == 0)):
        # Straight along x is best at every beta, or at the best beta.
        straight = min(max(math.atan(mu), first), last)
        if _slides_straight(straight, lift_off, block):
            best[0], best[1] = 0.0, straight
            return OPTIMAL
    steps = STEPS if a0 == 0 and a1 >= RIGHT else STEPS_WITHIN
    count = _sampled(first, last, steps, sideways, block, betas)
    _fill(count, betas, values, rises, block)
    return _highest(count, betas, values, rises, lift_off, side, block, best)
