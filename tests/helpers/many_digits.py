"""Numbers of many digits under mpmath's names, by MPFR: rounded right, in a third of the time.

Unlike mpmath's, they have no complex values (a root of -1 is nan), and 1/0 is infinite.
"""

import contextlib
import math
from collections.abc import Callable, Iterator
from typing import Any

import gmpy2
import mpmath

mpf = gmpy2.mpfr


class Functions:
    """What `mpmath.mp` has, as far as the tests ask for it; `workdps` sets the digits."""

    inf, nan = gmpy2.inf(), gmpy2.nan()
    sqrt, hypot = staticmethod(gmpy2.sqrt), staticmethod(gmpy2.hypot)
    sin, cos = staticmethod(gmpy2.sin), staticmethod(gmpy2.cos)
    atan, atan2 = staticmethod(gmpy2.atan), staticmethod(gmpy2.atan2)
    exp, log, log10 = staticmethod(gmpy2.exp), staticmethod(gmpy2.log), staticmethod(gmpy2.log10)
    sinh, cosh = staticmethod(gmpy2.sinh), staticmethod(gmpy2.cosh)
    isnan, isfinite = staticmethod(gmpy2.is_nan), staticmethod(gmpy2.is_finite)
    sign = staticmethod(gmpy2.sign)

    @property
    def pi(self) -> Any:
        return gmpy2.const_pi()

    @staticmethod
    def nstr(value: Any, digits: int) -> str:
        return f"{value:.{digits}g}"

    @staticmethod
    @contextlib.contextmanager
    def workdps(digits: int) -> Iterator[None]:
        bits = math.ceil((digits + 1) * math.log2(10))
        with gmpy2.context(precision=bits), mpmath.mp.workprec(bits):
            yield

    @staticmethod
    def findroot(function: Callable[[Any], Any], start: tuple[Any, ...], **options: Any) -> Any:
        """Return a root as mpmath's solvers find it."""
        found = mpmath.mp.findroot(
            lambda x: to_mpmath(function(from_mpmath(x))), [to_mpmath(x) for x in start], **options
        )
        return from_mpmath(found)


def root_between(function: Callable[[Any], Any], low: Any, high: Any) -> Any:
    """Return the root of a function with different signs at two ends, to all but 8 bits.

    The rule of Anderson and Bjoerck: a secant of which one end stays on the other side of the root.
    """
    at_low, at_high = function(low), function(high)
    assert at_low * at_high <= 0
    close = mpf(2) ** (8 - gmpy2.get_context().precision)
    for _ in range(500):
        if at_high == 0:
            return high
        new = high - at_high * (high - low) / (at_high - at_low)
        at_new, step = function(new), abs(new - high)
        if at_new * at_high < 0:
            low, at_low = high, at_high
        else:
            share = 1 - at_new / at_high
            at_low *= share if share > 0 else mpf(0.5)
        high, at_high = new, at_new
        if step <= close * abs(new):
            return new
    raise ArithmeticError("no root found")


def to_mpmath(value: Any) -> Any:
    """Return the same number as one of mpmath's."""
    if not gmpy2.is_finite(value):
        return mpmath.mpf(float(value))
    mantissa, exponent = value.as_mantissa_exp()
    return mpmath.mp.make_mpf(mpmath.libmp.from_man_exp(mantissa, int(exponent)))


def from_mpmath(value: Any) -> Any:
    """Return the same number as one of MPFR's."""
    if not mpmath.isfinite(value):
        return mpf(float(value))
    return (
        gmpy2.mul_2exp(mpf(value.man), value.exp)
        if value.exp >= 0
        else gmpy2.div_2exp(mpf(value.man), -value.exp)
    )


mp = Functions()
