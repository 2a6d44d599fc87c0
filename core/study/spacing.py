"""Spaced values, each as a person would type it.

A float stands for the number that is typed for it: 5e-05 for five hundred-thousandths. Even steps
between two such numbers are computed exactly and rounded once, so that a step of a range is equal
to its number as typed, which numpy's linspace often misses by a bit.
"""

from __future__ import annotations

import functools
import math
from decimal import Decimal
from fractions import Fraction
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

EXACT: Final = 2**53
"""Whole numbers up to it are exact floats, so that numpy's division is rounded once."""
MAX_SLOW: Final = 1_000_000  # values that Python divides one by one, a tenth of a microsecond each
DIGITS: Final = 15  # decimals of so many digits or fewer have a float of their own
SIMPLE: Final = 1_000_000  # largest denominator of a number that is taken for a simple fraction


def as_typed(number: float) -> Fraction:
    """Return the number that a user typed for a float, exactly.

    It is the shortest decimal, or a simple fraction if that takes more digits than people type:
    50/3 for 1000 turns a minute in hertz.
    """
    decimal = Decimal(repr(float(number)))
    if len(decimal.as_tuple().digits) > DIGITS:
        simple = Fraction(number).limit_denominator(SIMPLE)
        if float(simple) == number:
            return simple
    return Fraction(decimal)


def evenly(
    first: float, last: float, size: int, start: int = 0, stop: int | None = None
) -> NDArray[np.float64]:
    """Return evenly spaced values from `first` to `last` inclusive, or a slice of them.

    Parameters
    ----------
    first, last : float
        The ends.
    size : int
        Number of all values, from 2 up.
    start, stop : int, optional
        Positions of the first value wanted, and of the one after the last.

    Returns
    -------
    ndarray
        Shape (stop - start,); a part has the bits of the whole.
    """
    stop = size if stop is None else stop
    offset, stride, divisor = _steps(first, last, size)
    if divisor <= EXACT and max(abs(offset), abs(offset + (size - 1) * stride)) <= EXACT:
        found = np.arange(start, stop, dtype=np.int64)
        found *= stride
        found += offset
        return found / divisor
    if size <= MAX_SLOW:
        each = ((offset + k * stride) / divisor for k in range(start, stop))
        return np.fromiter(each, np.float64, stop - start)
    return _approximately(first, last, size, start, stop)


def geometrically(
    first: float, last: float, size: int, start: int = 0, stop: int | None = None
) -> NDArray[np.float64]:
    """Return geometrically spaced values as numpy's geomspace, or a slice of them.

    `first` and `last` are the ends, `size` is the number of all values; the slice goes from
    position `start` to before `stop`.
    """
    stop = size if stop is None else stop
    ends = float(np.log10(first)), float(np.log10(last))
    values = np.power(10.0, _approximately(*ends, size, start, stop))
    if start == 0:
        values[:1] = first
    if stop == size:
        values[-1:] = last
    return values


@functools.lru_cache(maxsize=256)
def _steps(first: float, last: float, size: int) -> tuple[int, int, int]:
    """Return integers a, b, c such that value k of an evenly spaced axis is exactly (a + b k)/c.

    So the values are those that a user means: 0.1, 0.2, 0.3, without errors that add up. `first`
    and `last` are the ends, `size` is the number of values.
    """
    begin = as_typed(first)
    step = (as_typed(last) - begin) / (size - 1)
    common = begin.denominator * step.denominator
    offset, stride = (begin * common).numerator, (step * common).numerator
    shared = math.gcd(offset, stride, common)
    return offset // shared, stride // shared, common // shared


def _approximately(
    first: float, last: float, size: int, start: int, stop: int
) -> NDArray[np.float64]:
    """Return the values from `start` to before `stop` of numpy's linspace, bit by bit, shape (n,).

    The whole has `size` values from `first` to `last`; those that are not wanted are not computed.
    """
    values = np.arange(start, stop, dtype=np.float64)
    step = (last - first) / (size - 1)
    values = values * step if step else values / (size - 1) * (last - first)
    values += first
    if stop == size:
        values[-1:] = last
    return values
