"""Words for units that studies are usually written in: one table, read without pint.

pint knows thousands more, and takes half a second to load; it agrees with this table (a test).
"""

from __future__ import annotations

import re
from fractions import Fraction
from functools import lru_cache
from types import MappingProxyType
from typing import Final

Dimensions = tuple[int, int, int, int, int]
"""Exponents of metre, kilogram, second, ampere and radian."""

PI: Final = Fraction("3.1415926535897932384626433832795028841971693993751")
"""pi to the digits of pint."""

_LENGTH = (1, 0, 0, 0, 0)
_MASS = (0, 1, 0, 0, 0)
_TIME = (0, 0, 1, 0, 0)
_RATE = (0, 0, -1, 0, 0)
_NONE = (0, 0, 0, 0, 0)
_ANGLE = (0, 0, 0, 0, 1)
_ANGULAR_RATE = (0, 0, -1, 0, 1)
_ACCELERATION = (1, 0, -2, 0, 0)
_FORCE = (1, 1, -2, 0, 0)
_PRESSURE = (-1, 1, -2, 0, 0)
_ENERGY = (2, 1, -2, 0, 0)
_POWER = (2, 1, -3, 0, 0)
_FIELD = (0, 1, -2, -1, 0)

_GROUPS: Final[tuple[tuple[Dimensions, dict[str, Fraction | str | int]], ...]] = (
    (_LENGTH, {"m": 1, "mm": "1e-3", "cm": "1e-2", "km": 1000, "um": "1e-6", "μm": "1e-6",
               "in": "0.0254", "inch": "0.0254"}),
    (_MASS, {"kg": 1, "g": "1e-3", "mg": "1e-6"}),
    (_TIME, {"s": 1, "ms": "1e-3", "us": "1e-6", "μs": "1e-6", "min": 60, "h": 3600}),
    (_RATE, {"Hz": 1, "kHz": 1000, "MHz": 10**6}),
    (_NONE, {"count": 1}),
    (_ANGLE, {"rad": 1, "mrad": "1e-3", "deg": PI / 180, "degree": PI / 180, "°": PI / 180}),
    (_ANGULAR_RATE, {"rpm": PI / 30}),
    (_ACCELERATION, {"standard_gravity": "9.80665", "millistandard_gravity": "9.80665e-3"}),
    (_FORCE, {"N": 1, "mN": "1e-3", "kN": 1000}),
    (_PRESSURE, {"Pa": 1, "kPa": 1000, "MPa": 10**6, "GPa": 10**9}),
    (_ENERGY, {"J": 1, "mJ": "1e-3"}),
    (_POWER, {"W": 1, "mW": "1e-3"}),
    (_FIELD, {"T": 1, "mT": "1e-3"}),
)  # fmt: skip

WORDS: Final = MappingProxyType(
    {word: (Fraction(size), kind) for kind, words in _GROUPS for word, size in words.items()}
)
"""Each word with its size in SI and its dimensions."""

_RECIPROCAL = re.compile(r"1(?=\s?/|$)")
_FACTOR = re.compile(r"(\s?[*/]\s?|\s)?([A-Za-zμ°_]+)(?:(?:\*\*|\^)(-?[1-9]))?")


def factor_between(text: str, own: str) -> Fraction | None:
    """Return the exact factor from one unit to another of the same dimensions, by `WORDS` alone.

    Both are in pint's notation, as in ``kg m**2/s``. None if a word is unknown, the notation is
    another (brackets), or the dimensions differ.
    """
    unit, goal = _read(text), _read(own)
    if unit is None or goal is None or unit[1] != goal[1]:
        return None
    return unit[0] / goal[0]


@lru_cache(512)
def _read(text: str) -> tuple[Fraction, Dimensions] | None:
    """Return the size of a unit in SI, and its dimensions; None if it is not in our words."""
    size, dimensions = Fraction(1), list(_NONE)
    start = 1 if _RECIPROCAL.match(text) else 0
    while start < len(text):
        match = _FACTOR.match(text, start)
        if match is None or match[2] not in WORDS or (not match[1]) != (start == 0):
            return None
        power = int(match[3] or 1) * (-1 if "/" in (match[1] or "") else 1)
        factor, exponents = WORDS[match[2]]
        size *= factor**power
        dimensions = [sum_ + power * each for sum_, each in zip(dimensions, exponents, strict=True)]
        start = match.end()
    length, mass, time, current, angle = dimensions
    return size, (length, mass, time, current, angle)
