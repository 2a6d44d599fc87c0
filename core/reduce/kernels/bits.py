"""Floats as integers, whose order and sums do not depend on how a loop is cut."""

from __future__ import annotations

from core.compiled import bits, borrowing

LEAST, MOST = -(2**63), 2**63 - 1
MAGNITUDE = 2**63 - 1
"""The bits of a float but for its sign."""


@borrowing
def key(value: float) -> int:
    """Return an integer in the order of floats; the same function inverts it on bits.

    Compilers vectorise the largest of integers, and not that of floats, which may be NaN. Zeros
    are one value if they are `value + 0.0`.
    """
    own: int = bits(value)
    return own ^ ((own >> 63) & MAGNITUDE)


@borrowing
def counted(value: float, regime: int, valid: int) -> bool:
    """True if a cell counts: its regime is in `valid` and its value is not NaN."""
    return ((valid >> regime) & 1 != 0) & (value == value)


__all__ = ["LEAST", "MAGNITUDE", "MOST", "bits", "counted", "key"]
