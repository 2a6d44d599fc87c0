"""What is declared of a quantity."""

from __future__ import annotations

import math
from dataclasses import dataclass


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

    @property
    def is_angle(self) -> bool:
        """Whether the value is degrees at the edge and radians inside."""
        return self.unit == "degree"


def length(symbol: str, label: str, description: str, example: str) -> Quantity:
    """Return a length that a study may give, above 0."""
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
    """Return an angle that a study may give, up to a limit on both sides."""
    return Quantity(
        "degree", symbol, label, description, -limit, limit, parameter=True, examples=(example,),
        usual=usual,
    )  # fmt: skip


def friction(symbol: str, label: str, description: str) -> Quantity:
    """Return a coefficient of friction that a study may give."""
    return Quantity(
        "1", symbol, label, description, 0.0, parameter=True, examples=("0.3",), usual=(0.01, 2.0)
    )


def acceleration(symbol: str, label: str, description: str) -> Quantity:
    """Return an acceleration."""
    return Quantity("m s-2", symbol, label, description)


def velocity(symbol: str, label: str, description: str) -> Quantity:
    """Return a velocity."""
    return Quantity("m s-1", symbol, label, description)


def force(symbol: str, label: str, description: str) -> Quantity:
    """Return a force."""
    return Quantity("N", symbol, label, description)


def number(symbol: str, label: str, description: str) -> Quantity:
    """Return a quantity without unit."""
    return Quantity("1", symbol, label, description)
