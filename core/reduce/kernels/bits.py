"""Floats as integers, whose order and sums do not depend on how a loop is cut."""

from __future__ import annotations

from vibrafeed.core.compiled import bits, borrowing

LEAST, MOST = -(2**63), 2**63 - 1
MAGNITUDE = 2**63 - 1
"""The bits of a float but for its sign."""


@borrowing
def key(value: float) -> int:
    """Return an integer with the order of floats, so that larger floats have larger keys.

    Compilers vectorise the largest of integers, and not that of floats, which may be NaN. Zeros of
    both signs have one key if `value + 0.0` is given. The same steps on the bits of a key give back
    the float.
    """
    own: int = bits(value)
    return own ^ ((own >> 63) & MAGNITUDE)


@borrowing
def counted(value: float, regime: int, valid: int) -> bool:
    """True if a cell counts: its regime is in `valid` and its value is not NaN.

    `valid` has a bit for each number of a regime.
    """
    return ((valid >> regime) & 1 != 0) & (value == value)


__all__ = ["LEAST", "MAGNITUDE", "MOST", "bits", "counted", "key"]
