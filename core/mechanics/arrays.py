"""Array types, and functions of arrays that numpy lacks in a stable form.

Angles are degrees for people and radians inside, and no float is pi/2: its cosine is 6e-17. A part
on a plane would roll for that, and an infinite throw number be 8e15. Therefore an angle is reduced
while it is in degrees, where that is exact, and the float that a multiple of 90 degrees becomes
counts as that multiple. Every other float has numpy's sine and cosine, to the bit.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""float64 values; every function here broadcasts its arguments."""

Mask = NDArray[np.bool_]
"""Truth values."""


def compensated_sum(*terms: Array) -> Array:
    """Return the sum of the `terms`, arrays, with the rounding errors of the additions put back.

    As if with twice the working precision before the last rounding (Ogita, Rump and Oishi 2005,
    algorithm Sum2). Used where a sum is compared with zero.
    """
    total: Array = terms[0]
    error: Array | float = 0.0
    for term in terms[1:]:
        new_total = total + term
        # Knuth's two-sum: what the rounded sum lost of both, exactly.
        absorbed = new_total - total
        error = error + ((total - (new_total - absorbed)) + (term - absorbed))
        total = new_total
    return total + error


def ratio(numerator: Array, denominator: Array, limit: Array | float) -> Array:
    """Return ``numerator / denominator``, and `limit` where the denominator is 0."""
    zero = denominator == 0.0
    quotient = numerator / np.where(zero, 1.0, denominator)
    return np.where(zero, limit, quotient)


def hypot(x: Array, y: Array) -> Array:
    """Return sqrt(x^2 + y^2) without overflow, within 2 units in the last place.

    It is made of numpy's elementwise functions because `np.hypot` is slower: a call for each value.
    """
    x, y = np.abs(x), np.abs(y)
    y_is_less = x > y
    large, small = np.where(y_is_less, x, y), np.where(y_is_less, y, x)
    small_over_large = small / np.where(large > 0, large, 1.0)
    return large * np.sqrt(1.0 + small_over_large * small_over_large)


# --- Sines and cosines of angles, exact at whole multiples of 90 degrees.


QUARTER = np.pi / 2
TINY = 2.0**-200  # far below the distance of any other float from a multiple of 90 degrees


def radians(degrees: Array) -> Array:
    """Return angles in radians for angles in degrees.

    Whole turns go first, in degrees, where that is exact: the result lies between -pi and pi, and a
    multiple of 90 degrees becomes the float nearest to it.
    """
    turn = np.fmod(degrees, 360.0)
    turn = turn - np.where(np.abs(turn) > 180.0, np.copysign(360.0, turn), 0.0)
    return np.asarray(np.deg2rad(turn + 0.0))  # -0.0 is 0


def sine(angle: Array) -> Array:
    """Return sin(angle), exactly 0 at the floats that are nearest to multiples of pi."""
    nearest, offset, on_axis = _nearest_quarter(angle)
    slope = np.rint(np.cos(nearest))  # 1 or -1 at a multiple of pi, 0 halfway
    return np.where(on_axis & (slope != 0), 0.0 + slope * offset, np.sin(angle))


def cosine(angle: Array) -> Array:
    """Return cos(angle), exactly 0 at the floats that are nearest to odd multiples of pi/2."""
    nearest, offset, on_axis = _nearest_quarter(angle)
    slope = np.rint(np.sin(nearest))  # 1 or -1 at an odd multiple of pi/2, 0 elsewhere
    return np.where(on_axis & (slope != 0), 0.0 - slope * offset, np.cos(angle))


def _nearest_quarter(angle: Array) -> tuple[Array, Array, Mask]:
    # The nearest multiple of 90 degrees, the rest, and True where that float stands for it.
    nearest = np.rint(angle / QUARTER) * QUARTER
    offset = angle - nearest
    return nearest, offset, np.rint(offset / TINY) == 0


# --- Functions that are made of few steps: sums, products, quotients, roots and choices.
#
# numpy's logarithms and arcs are calls between two loops, and their last bits hang on the
# processor. An `Elementwise` function is a body of steps that are each exact or rounded once, so
# that arrays and compiled loops give the same bits everywhere, and a loop takes many cells at once.


MANTISSA_BITS, BIAS = 52, 1023
EXPONENT_MASK = 0x7FF << MANTISSA_BITS

# atanh(sqrt(w))/sqrt(w) by powers of w, interpolated with 60 digits at ten Chebyshev nodes within
# tan(pi/16)^2 of 0; the largest relative error there is 2.6e-18.
ARC_POWERS = (
    1.0, 0.3333333333333333, 0.19999999999997198, 0.14285714285711726, 0.11111111125428681,
    0.09090909103982231, 0.07692282091858109, 0.06666643291413155, 0.059010294883174816,
    0.052802109089613955,
)  # fmt: skip
# ln 2 and pi/4 in two parts; the first has 40 bits, so that its small multiples are exact.
LN_2 = (0.6931471805601177, -1.7239444525614835e-13)
EIGHTH = (0.7853981633970761, 3.7217737402433116e-13)
TAN_1, TAN_2, TAN_3 = 0.198912367379658, 0.41421356237309503, 0.6681786379192989  # of pi/16, ...
ROOT_2 = math.sqrt(2.0)

LOGARITHMIC = 0.25
"""Square above which `arc_quotient` goes by its second argument, the root, as the square loses
digits."""


class Elementwise:
    """A function of arrays that graphs and precise numbers treat as numpy's own.

    Objects that take numpy's functions by `__array_ufunc__` (a graph, a number of 50 digits) are
    handed this one; plain arrays run its body.

    Attributes
    ----------
    body : callable
        The function in steps of numpy.
    nin, nout : int
        Number of arguments and of results, as numpy names them.
    """

    nout = 1

    def __init__(self, body: Callable[..., Any]):
        self.body, self.nin = body, body.__code__.co_argcount
        self.__name__, self.__doc__ = body.__name__, body.__doc__

    def __call__(self, *inputs: Any) -> Any:
        """Return the function of arrays; hand it to an input that takes numpy's functions."""
        for value in inputs:
            ufunc_hook = getattr(type(value), "__array_ufunc__", None)
            if ufunc_hook is not None and ufunc_hook is not np.ndarray.__array_ufunc__:
                return value.__array_ufunc__(self, "__call__", *inputs)
        return self.body(*inputs)


@Elementwise
def binade(x: Array) -> Array:
    """Return the largest power of 2 that is not above |x|; for normal floats."""
    return (_bits(x) & EXPONENT_MASK).view(np.float64)


@Elementwise
def exponent(x: Array) -> Array:
    """Return the exponent of `binade`, as a float."""
    return ((_bits(x) & EXPONENT_MASK) >> MANTISSA_BITS) - float(BIAS)


def _bits(x: Array) -> Any:
    return np.asarray(x, dtype=np.float64).view(np.int64)


@Elementwise
def arc_series(square: Array) -> Array:
    """Return `arc_quotient` of a small square, at most tan(pi/16)^2 or 0.039, in few steps.

    It is a sum of powers of the square, with the coefficients `ARC_POWERS`. Pairs of terms are
    summed first, so that a processor need not wait for each.
    """
    w = square
    pairs = [low + w * high for low, high in zip(ARC_POWERS[::2], ARC_POWERS[1::2], strict=True)]
    ww = w * w
    fourth = ww * ww
    return (pairs[0] + ww * pairs[1]) + fourth * ((pairs[2] + ww * pairs[3]) + fourth * pairs[4])


@Elementwise
def arc_quotient(square: Array, root: Array) -> Array:
    """Return artanh(u)/u with u^2 = square, and arctan(u)/u with u^2 = -square below 0; 1 at 0.

    For closed forms that are trigonometric on one side of a limit and hyperbolic on the other.
    `square` is below 1; `root` is sqrt(1 - square), to its own last digits: near 1 the square has
    lost them. Half of the arc has the tangent y = u/(1 + root). Its nearest multiple of pi/8, or of
    ln 2 / 2 for artanh, is taken off in the same quotient; the rest is a series in y^2 or -y^2.
    Within 5 units in the last place.
    """
    u = np.sqrt(np.abs(square))
    is_hyperbolic = square > 0
    one_plus_root, one_plus_u = 1.0 + root, 1.0 + u
    # exp(artanh u) = (1 + u)/root, over its nearest power of 2.
    root_binade, exp_numerator = binade(root), ROOT_2 * one_plus_u
    falls_below = exp_numerator * root_binade < root
    lies_above = exp_numerator * root_binade >= 2.0 * root
    shift = np.where(lies_above, 1.0, np.where(falls_below, -1.0, 0.0))
    scaled_exp = one_plus_u * (
        root_binade * np.where(lies_above, 0.5, np.where(falls_below, 2.0, 1.0))
    )
    past_1_16, past_3_16 = u > TAN_1 * one_plus_root, u > TAN_3 * one_plus_root
    eighths = np.where(past_3_16, 2.0, np.where(past_1_16, 1.0, 0.0))
    tan_eighths = np.where(past_3_16, 1.0, np.where(past_1_16, TAN_2, 0.0))
    multiple = np.where(is_hyperbolic, shift - exponent(root), eighths)
    in_series = multiple == 0
    reduced_hyperbolic = is_hyperbolic & ~in_series
    numerator = np.where(reduced_hyperbolic, scaled_exp - root, u - tan_eighths * one_plus_root)
    denominator = np.where(reduced_hyperbolic, scaled_exp + root, one_plus_root + tan_eighths * u)
    # One quotient in place of numerator/denominator, 1/denominator and 1/u.
    safe_u = np.where(u > 0, u, 1.0)
    shared_inverse = 1.0 / (denominator * safe_u)
    y = numerator * (safe_u * shared_inverse)
    w = np.where(is_hyperbolic, y * y, -(y * y))
    series = arc_series(w)
    unit_high, unit_low = (
        np.where(is_hyperbolic, *parts) for parts in zip(LN_2, EIGHTH, strict=True)
    )
    arc = multiple * unit_high + (multiple * unit_low + 2.0 * y * series)
    return np.where(in_series, 2.0 * series * safe_u, arc * denominator) * shared_inverse


# --- Functions over their argument, with the limit 1 at 0.


def over_itself(function: Callable[[Array], Array], u: Array) -> Array:
    """Return function(u)/u, with the limit 1 at 0: of sin, tanh, log1p and the like."""
    return ratio(function(u), u, 1.0)


def expm1_quotient(s: Array) -> Array:
    """Return (1 - exp(-s))/s, with the limit 1 at s = 0."""
    return ratio(-np.expm1(-s), s, 1.0)
