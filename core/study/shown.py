"""Units in which a person reads values: those of the trade, SI, or those that were asked for.

Files and replies hold the units of `vibrafeed.core.quantities`; screens and pictures show these.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final

from vibrafeed.core.quantities import QUANTITIES, Quantity
from vibrafeed.core.study.units import UnitError, unit_factor

SYSTEMS: Final = ("trade", "si")

SI: Final[Mapping[str, str]] = MappingProxyType(
    {
        "1": "",
        "degree": "°",
        "m s-1": "m/s",
        "m s-2": "m/s²",
        "m s-3": "m/s³",
        "rad s-1": "rad/s",
        "rad s-2": "rad/s²",
        "N m": "N m",
        "N s": "N s",
        "N m-1": "N/m",
        "N s m-1": "N s/m",
        "s-1": "1/s",
        "s m-1": "s/m",
        "kg m2": "kg m²",
        "kg m2 s-1": "kg m²/s",
        "kg-1": "1/kg",
        "W kg-1": "W/kg",
        "J kg-1": "J/kg",
        "J kg-1 m-1": "J/(kg m)",
        "J m-1": "J/m",
        "min-1": "parts/min",
    }
)
"""How the units of quantities are written; a unit that is not here is written as it is."""

TRADE: Final[Mapping[str, tuple[float, str]]] = MappingProxyType(
    {
        "m": (1e3, "mm"),
        "m s-1": (1e3, "mm/s"),
        "Pa": (1e-6, "MPa"),
        "N m-1": (1e-3, "N/mm"),
    }
)
"""Factor and unit in which designers of feeders read a quantity, however large its values are."""

SMALLER: Final[Mapping[str, tuple[float, str]]] = MappingProxyType(
    {
        "s": (1e3, "ms"),
        "kg": (1e3, "g"),
        "N": (1e3, "mN"),
        "N s": (1e3, "mN s"),
        "N m": (1e3, "mN m"),
        "J": (1e3, "mJ"),
        "J m-1": (1e3, "mJ/m"),
        "W": (1e3, "mW"),
    }
)
"""Factor and unit in which small values of a quantity are read."""
SMALL: Final = 0.1
"""Values are read in the unit of `SMALLER` if the largest is below this."""


@dataclass(frozen=True)
class Shown:
    """A unit in which values are read.

    Attributes
    ----------
    factor : float
        What a value in the quantity's own unit is multiplied by.
    unit : str
        How the unit is written; empty without one.
    """

    factor: float
    unit: str


@dataclass(frozen=True)
class ShownUnits:
    """The units that somebody wants to read.

    Attributes
    ----------
    system : str
        One of `SYSTEMS`, for what `wanted` does not hold.
    wanted : mapping of str to Shown
        For units of quantities, such as ``m s-1``, what they are read in.
    """

    system: str = "trade"
    wanted: Mapping[str, Shown] = field(default_factory=dict)

    def of(self, unit: str, largest: float) -> Shown:
        """Return the unit in which a reader sees values, and the factor to it.

        `unit` is the unit of the values, as in files, such as ``"m s-1"``. `largest` is the largest
        size among the values: small forces and times are shown in smaller units. What the reader
        asked for comes first.
        """
        if unit in self.wanted:
            return self.wanted[unit]
        if self.system == "trade" and unit in TRADE:
            return Shown(*TRADE[unit])
        if self.system == "trade" and unit in SMALLER and 0 < largest < SMALL:
            return Shown(*SMALLER[unit])
        return Shown(1.0, SI.get(unit, unit))

    def text(self, value: float, unit: str, digits: int = 3) -> str:
        """Return a value with a readable unit; `unit` is the value's own."""
        shown = self.of(unit, abs(value))
        gap = "" if shown.unit in ("", "°") else " "
        return f"{shown.factor * value:.{digits}g}{gap}{shown.unit}"


def read_shown(words: Iterable[str]) -> ShownUnits:
    """Return the units in which a reader wants to see values, from words.

    A word is a system, ``trade`` or ``si``, or a unit such as ``m/min``, which then stands for all
    quantities of its kind.

    Raises
    ------
    UnitError
        If a word is no unit of a quantity, or two are of one kind.
    """
    system, wanted = "trade", {}
    for word in (word.strip() for word in words):
        if word.lower() in SYSTEMS:
            system = word.lower()
            continue
        unit, shown = _unit_of_word(word)
        if unit in wanted:
            raise UnitError(
                f"'{word}' is a second unit for the same quantity",
                "Give only one unit for each kind of quantity",
            )
        wanted[unit] = shown
    return ShownUnits(system, MappingProxyType(wanted))


def _unit_of_word(word: str) -> tuple[str, Shown]:
    # The unit of the quantities that the word can measure, and the factor to it.
    units = dict.fromkeys(quantity.unit for quantity in QUANTITIES.values())
    for unit in sorted(units, key=lambda unit: unit == "m s-2"):  # "g" is the gram here
        if unit == "1":
            continue
        try:
            factor = unit_factor("units", Quantity(unit, "", "units", "", examples=(unit,)), word)
        except UnitError:
            continue
        return unit, Shown(float(1 / factor), word)
    raise UnitError(
        f"'{word[:40]}' is not a unit that vibrafeed knows",
        "Write trade, si, or units such as mm/s, m/min, mm or rad",
    )
