"""The headings of a table: names, units in brackets, in a row of their own, or as endings."""

import re
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Final

from vibrafeed.core.study.units import WORDS

_IN_BRACKETS = re.compile(r"(\[[^\[\]]*\]|[\[(][^\[\]()]*[\])])\Z")
_LETTERS = re.compile(r"[^\W\d_]+|[°%]")
UNIT_WORDS: Final = frozenset(
    (
        *WORDS,
        "G",
        "gn",
        "Gal",
        "sec",
        "Sec",
        "ns",
        "µm",
        "µs",
        "vpm",
        "spm",
        "parts",
        "%",
    )
)
"""Words that are units in a row below the names of columns."""
ENDINGS: Final[Mapping[str, str]] = MappingProxyType(
    {
        word: unit
        for unit, words in {
            "s": "s sec secs second seconds",
            "ms": "ms msec millis millisecond milliseconds",
            "us": "us µs μs usec micros microsecond microseconds",
            "ns": "ns nanos nanosecond nanoseconds",
            "min": "min minutes",
            "g": "g", "mg": "mg", "V": "v volt volts", "mV": "mv",
            "m/s2": "ms2 m_s2 mps2 m_s^2 m_s²", "mm/s2": "mms2 mm_s2 mmps2 mm_s^2 mm_s²",
            "m/s": "mps m_s", "mm/s": "mms mmps mm_s", "mm": "mm", "um": "um µm μm",
            "Hz": "hz", "rpm": "rpm", "deg": "deg", "rad": "rad", "kg": "kg",
        }.items()
        for word in words.split()
    }
)  # fmt: skip
"""Ends of the names of columns that are units, as in ``acc_x_g``, ``time_ms`` and ``ax / g``."""


def name_and_unit(heading: str) -> tuple[str, str]:
    """Return name and unit of a heading such as ``time (s)``; an empty unit without brackets.

    It takes no longer than reading the heading, whatever that holds.
    """
    heading = heading.strip()
    start = heading.rfind("[") if heading.endswith("]") else -1  # as in [J/(kg m)]
    start = start if start >= 0 else max(heading.rfind("["), heading.rfind("("))
    name = heading[: max(start, 0)].strip()
    if name and _IN_BRACKETS.match(heading, start):
        return name, heading[start + 1 : -1].strip()
    return heading, ""


def stem_and_unit(name: str) -> tuple[str, str]:
    """Return a name in small letters without the unit at its end, and that unit.

    ``timeMs``, ``t / ms`` and ``time_in_ms`` end in ms. A name that is such a word itself, as
    ``millis``, has no stem. The unit is empty if the name does not end in one.
    """
    normalised = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).casefold()
    normalised = re.sub(r"[\s.,:/\-_()]+", "_", normalised).strip("_")
    for word in sorted(ENDINGS, key=len, reverse=True):
        if normalised == word and len(word) > 2:
            return "", ENDINGS[word]
        if normalised.endswith("_" + word):
            return normalised.removesuffix("_" + word).removesuffix("_in"), ENDINGS[word]
    return normalised, ""


def is_row_of_units(cells: Sequence[str]) -> bool:
    """True if all cells of a row are units, in brackets or bare; some may be empty."""
    bare = [cell.strip() for cell in cells]
    return any(bare) and all(
        (cell[:1] in "[(" and cell[-1:] in ")]")
        or all(word in UNIT_WORDS for word in _LETTERS.findall(cell))
        for cell in bare
    )
