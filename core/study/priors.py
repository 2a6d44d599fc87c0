"""What is known of an unknown before a calibration: bounds, and a normal distribution within them.

Unknowns are parameters, offsets of parameters that vary from run to run, or factors of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from core.quantities import QUANTITIES, Quantity
from core.study.units import UnitError, read_number

MOST_DEVIATIONS = 5.0  # from the mean to a bound that is left out
KEYS = ("lower", "upper", "mean", "deviation")


@dataclass(frozen=True)
class Prior:
    """Bounds of an unknown, both included, in the quantity's unit.

    Attributes
    ----------
    lower, upper : float
        The bounds.
    mean, deviation : float or None
        Of the normal distribution within them; None where every value is as likely.
    """

    lower: float
    upper: float
    mean: float | None = None
    deviation: float | None = None

    def canonical(self) -> Any:
        """Return the plain JSON form, in the quantity's unit."""
        bounds = {"lower": self.lower, "upper": self.upper}
        if self.mean is None:
            return bounds
        return {**bounds, "mean": self.mean, "deviation": self.deviation}


def read_prior(name: str, raw: object) -> Prior:
    """Return what a user wrote of the unknown parameter `name`; raise `UnitError` if it is none."""
    return _read(name, QUANTITIES[name], raw)


def read_offset(name: str, raw: object) -> Prior:
    """Return what a user wrote of the offset of a parameter, in its unit.

    Raises
    ------
    UnitError
        If it is no such distribution.
    """
    return _read(f"the offset of {name}", _free(QUANTITIES[name]), raw)


def read_factor(name: str, raw: object) -> Prior:
    """Return what a user wrote of the factor of a parameter; raise `UnitError` if it is none."""
    free = replace(_free(QUANTITIES[name]), unit="1", lower=0.0, examples=("1.1",))
    return _read(f"the factor of {name}", free, raw)


READERS: Mapping[str, Callable[[str, object], Prior]] = {
    "unknowns": read_prior,
    "offsets": read_offset,
    "factors": read_factor,
}
"""What reads each table of unknowns."""


def _free(quantity: Quantity) -> Quantity:
    """Return a quantity for differences: it may be negative."""
    return replace(quantity, lower=-float("inf"), upper=float("inf"), strict=False)


def _read(name: str, quantity: Quantity, raw: object) -> Prior:
    if isinstance(raw, Prior):
        return raw
    shown = quantity.examples[-1] if quantity.examples else "1"
    how = f'Write {{ lower = ..., upper = "{shown}" }}, or {{ mean = ..., deviation = ... }}'
    if not isinstance(raw, Mapping):
        raise UnitError(f"{name} is unknown, and has no range", how)
    wrong = [key for key in raw if key not in KEYS]
    if wrong:
        fix = f"Its keys are {', '.join(KEYS)}"
        raise UnitError(f"'{str(wrong[0])[:40]}' is not a key of an unknown", fix)
    if ("mean" in raw) != ("deviation" in raw) or not ({"mean"} <= {*raw} or _bounded(raw)):
        raise UnitError(f"the range of {name} is incomplete", how)
    if "mean" not in raw:
        lower, upper = (read_number(name, quantity, raw[end]) for end in ("lower", "upper"))
        _check_order(name, quantity, lower, upper)
        return Prior(lower, upper)
    mean = read_number(name, _free(quantity), raw["mean"])
    deviation = read_number(f"the deviation of {name}", _free(quantity), raw["deviation"])
    if deviation <= 0:
        raise UnitError(f"the deviation of {name} is not above 0", "Give a positive one")
    far = MOST_DEVIATIONS * deviation
    least = quantity.lower + (1e-3 * deviation if quantity.strict else 0.0)
    lower, upper = max(mean - far, least), min(mean + far, quantity.upper)
    if "lower" in raw:
        lower = read_number(name, quantity, raw["lower"])
    if "upper" in raw:
        upper = read_number(name, quantity, raw["upper"])
    _check_order(name, quantity, lower, upper)
    return Prior(lower, upper, mean, deviation)


def _bounded(keys: Iterable[str]) -> bool:
    return {"lower", "upper"} <= {*keys}


def _check_order(name: str, quantity: Quantity, lower: float, upper: float) -> None:
    if not lower < upper:
        unit = "" if quantity.unit == "1" else f" {quantity.unit}"
        raise UnitError(
            f"the upper bound of {name} ({upper:g}{unit}) is not above the lower one "
            f"({lower:g}{unit})",
            "Swap them, or give one value among the parameters",
        )
