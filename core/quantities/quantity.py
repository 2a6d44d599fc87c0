"""The record of a quantity (unit, symbol, label, bounds), and words for the angles' letters."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from vibrafeed.core.errors import Problem
from vibrafeed.core.quantities.flags import Flag


@dataclass(frozen=True)
class Quantity:
    """A named physical variable.

    Attributes
    ----------
    unit : str
        UDUNITS name of the unit in studies, files and replies.
    symbol : str
        The source's symbol.
    label : str
        Short name for axes and tables; `long_name` in files.
    description : str
        What it is, in one sentence.
    lower, upper : float
        Bounds, in `unit`; both included.
    strict : bool
        True if the lower bound itself is excluded.
    parameter : bool
        True if a study may give it a value.
    examples : tuple of str
        How a user may write it.
    bundle : bool
        True for several arrays that one equation hands on together, such as both components of an
        impulse; equations read them, files do not hold them.
    usual : tuple of float, optional
        Least and largest size of values that feeders have, in `unit`; others are asked about.
    flags : mapping of str to Flag, optional
        The states of a flag, by name: its values are names and no numbers.
    count : bool
        True for what is counted: it does not change inside a regime.
    error_of : str
        The quantity whose error, or spread, this one is.
    compared : bool
        False for what each method of motion has of its own.
    words : mapping of int to str
        What whole numbers stand for.
    other_words : str
        The words for those that are not among them; empty if all numbers are values.
    """

    unit: str
    symbol: str
    label: str
    description: str
    lower: float = -math.inf
    upper: float = math.inf
    strict: bool = False
    parameter: bool = False
    examples: tuple[str, ...] = ()
    bundle: bool = False
    usual: tuple[float, float] | None = None
    flags: Mapping[str, Flag] | None = field(default=None, hash=False)
    count: bool = False
    error_of: str = ""
    compared: bool = True
    words: Mapping[int, str] = field(default_factory=dict, hash=False)
    other_words: str = ""

    @property
    def width(self) -> int:
        """The bytes of one stored value."""
        return 8 if self.flags is None else 1

    @property
    def suffix(self) -> str:
        """The unit after a number in a text, with a blank before it; empty without a unit."""
        return "" if self.unit == "1" else f" {self.unit}"

    @property
    def is_derived(self) -> bool:
        """True if the quantity has derivatives: flags, counts and errors have none."""
        return self.flags is None and not self.count and not self.error_of

    @property
    def is_angle(self) -> bool:
        """True if the value is in degrees in studies and files, but in radians in the code."""
        return self.unit == "degree"


def length(symbol: str, label: str, description: str, example: str) -> Quantity:
    """Return the declaration of a parameter that is a length above 0 [m].

    `symbol` is its sign in formulas, `label` its name on axes of pictures, `example` a value as
    users write it.
    """
    return Quantity(
        "m", symbol, label, description, 0.0, strict=True, parameter=True, examples=(example,),
        usual=(1e-5, 5.0),
    )  # fmt: skip


def angle(
    symbol: str,
    label: str,
    description: str,
    limit: float,
    example: str,
    usual: tuple[float, float] | None = None,
) -> Quantity:
    """Return the declaration of a parameter that is an angle, with a limit both ways [degree].

    `symbol` is its sign in formulas, `label` its name on axes of pictures; `usual` are the ends of
    what is found in practice; `example` is a value as users write it.
    """
    return Quantity(
        "degree", symbol, label, description, -limit, limit, parameter=True, examples=(example,),
        usual=usual,
    )  # fmt: skip


def friction(symbol: str, label: str, description: str) -> Quantity:
    """Return the quantity of a friction coefficient, as a parameter."""
    return Quantity(
        "1", symbol, label, description, 0.0, parameter=True, examples=("0.3",), usual=(0.01, 2.0)
    )


def acceleration(symbol: str, label: str, description: str) -> Quantity:
    """Return the quantity of an acceleration [m s-2]."""
    return Quantity("m s-2", symbol, label, description)


def velocity(symbol: str, label: str, description: str) -> Quantity:
    """Return the quantity of a velocity [m s-1]."""
    return Quantity("m s-1", symbol, label, description)


def force(symbol: str, label: str, description: str) -> Quantity:
    """Return the quantity of a force [N]."""
    return Quantity("N", symbol, label, description)


def number(symbol: str, label: str, description: str) -> Quantity:
    """Return a dimensionless quantity."""
    return Quantity("1", symbol, label, description)


def flag(label: str, description: str, flags: Mapping[str, Flag], symbol: str = "") -> Quantity:
    """Return the quantity of a flag: its values are names of states."""
    return Quantity("1", symbol, label, description, flags=flags, compared=False)


def in_sentence(label: str) -> str:
    """Return a label as it stands within a sentence: its first letter is small."""
    return label[:1].lower() + label[1:]


WORDS: Final[Mapping[str, str]] = {
    "azimuth": "alpha",
    "elevation": "beta",
    "climb": "gamma",
    "lean": "delta",
}
"""Each word, and the parameter that it names."""
WORD_OF: Final[Mapping[str, str]] = {letter: word for word, letter in WORDS.items()}
"""The word for each of these parameters."""


def letter_of(name: Any) -> Any:
    """Return the parameter that a word names; any other name as it is."""
    return WORDS.get(name, name)


def by_letters(
    written: Mapping[Any, Any], within: str = ""
) -> tuple[dict[Any, Any], list[Problem]]:
    """Return values by parameter, the words for angles replaced by their letters, and problems.

    A problem is a word beside its own letter. `written` has values by the names that a user wrote;
    `within` is the start of their places, such as ``parameters.``.
    """
    problems = [
        Problem(
            f"{within}{word}",
            f"{word} and {letter} are the same angle, and both are given",
            f"Leave out {word} or {letter}",
        )
        for word, letter in WORDS.items()
        if word in written and letter in written
    ]
    return {letter_of(name): value for name, value in written.items()}, problems
