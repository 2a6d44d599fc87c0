"""Distributions of parameters that are not known exactly, one form for all kinds of study.

All are cut at the bounds of the quantity, such as a friction of 0, and scaled so that what is left
is the whole: nothing that is drawn is impossible. Numbers are in the unit of studies.
"""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.quantities import QUANTITIES, Quantity
from vibrafeed.core.study.grid_study import Frozen, by_parameter
from vibrafeed.core.study.units import UnitError, read_number, share_of
from vibrafeed.core.study.values import Between, NamedNumbers, as_difference, read_between
from vibrafeed.core.suggestions import suggestion

OUTSIDE = 0.00135
"""Share beyond either end of the tolerance of a distribution without ends, as three standard
deviations leave."""
CALIBRATION = "calibration"
"""The key that names the result of a calibration in place of numbers."""
MAX_TABULATED = 10_000
FEWEST_TABULATED = 2


@dataclass(frozen=True)
class Normal(NamedNumbers):
    """A bell around a mean; two thirds lie within a deviation of it. Bounds may cut it."""

    mean: float
    deviation: float
    lower: float | None = None
    upper: float | None = None

    def within(self, quantity: Quantity) -> tuple[float, float]:
        """Return the range of its values: its own bounds, and those of the quantity."""
        return (
            quantity.lower if self.lower is None else max(self.lower, quantity.lower),
            quantity.upper if self.upper is None else min(self.upper, quantity.upper),
        )


@dataclass(frozen=True)
class Triangular(NamedNumbers):
    """From a lower to an upper end, most likely in between."""

    lower: float
    most_likely: float
    upper: float


@dataclass(frozen=True)
class Lognormal(NamedNumbers):
    """A bell on a logarithmic scale: two thirds lie between median / factor and median * factor."""

    median: float
    factor: float


@dataclass(frozen=True)
class Tabulated(NamedNumbers):
    """A density that is linear between listed values, such as what a calibration leaves."""

    values: tuple[float, ...]
    densities: tuple[float, ...]


Distribution = Between | Normal | Triangular | Lognormal | Tabulated
"""How sure a value is; `Between` is uniform."""

FORMS: Final[Mapping[str, tuple[str, ...]]] = {
    "uniform": ("lower", "upper"),
    "normal": ("mean", "deviation"),
    "triangular": ("lower", "most_likely", "upper"),
    "lognormal": ("median", "factor"),
    "tabulated": ("values", "densities"),
}
"""The keys of each distribution; they tell which it is. A normal one may have bounds besides."""
_WIDTH: Final = re.compile(r"(?P<value>[^+±]{1,40})(?:\+-|\+/-|±)(?P<width>[^+±]{1,40})")
"""A value with a width, as drawings have it; at most 40 letters each, so that it is said whole."""


def read_distribution(name: str, raw: object, quantity: Quantity | None = None) -> Distribution:
    """Return the distribution that a user wrote for a parameter, by the keys of the table `raw`.

    `name` is the parameter; `quantity` gives unit and bounds where it is that of an offset or a
    factor.

    Raises
    ------
    UnitError
        If it is none, or has values that are none of that quantity.
    """
    if isinstance(raw, Distribution):
        return raw
    quantity = quantity or QUANTITIES[name]
    keys = frozenset(map(str, raw)) if isinstance(raw, Mapping) else frozenset()
    if keys == {CALIBRATION}:
        raise UnitError(
            f"the service cannot read the file for {name}; the command line and Python can",
            "Give the lists values and densities instead of calibration",
        )
    if isinstance(raw, str) and (width := _WIDTH.fullmatch(raw)):
        value, deviation = (text.strip() for text in width.groups())
        normal = f'{{ mean = "{value}", deviation = "{deviation}" }}'
        raise UnitError(
            f"'{value} +- {deviation}' may mean limits or a standard deviation",
            f"Write {{ lower = ..., upper = ... }} for limits, or {normal} for a deviation",
        )
    form = "normal" if {"mean", "deviation"} <= keys <= {*Normal.__match_args__} else ""
    form = next((form_name for form_name, form_keys in FORMS.items() if keys == {*form_keys}), form)
    if not form or not isinstance(raw, Mapping):
        raise _unknown_form(name, keys)
    readers: dict[str, Callable[..., Distribution]] = {
        "uniform": read_between,
        "normal": _normal,
        "triangular": _triangular,
        "lognormal": _lognormal,
        "tabulated": _tabulated,
    }
    return readers[form](name, raw, quantity)


def _unknown_form(name: str, keys: frozenset[str]) -> UnitError:
    known = {key for form in FORMS.values() for key in form}
    unknown = sorted(keys - known)
    if unknown:
        shown = unknown[0][:40]
        return UnitError(f"'{shown}' is not a key of a distribution", suggestion(shown, known))
    forms = [f"{{ {', '.join(f'{key} = ...' for key in form)} }}" for form in FORMS.values()]
    subject = f"{', '.join(sorted(keys))} alone make" if keys else "this is"
    return UnitError(f"{name}: {subject} no distribution", f"Write one of {', '.join(forms[:-1])}")


def _triangular(name: str, raw: Mapping[str, object], quantity: Quantity) -> Triangular:
    lower, likely, upper = (read_number(name, quantity, raw[key]) for key in FORMS["triangular"])
    if not (lower <= likely <= upper and lower < upper):
        raise UnitError(
            f"{name} has {lower:g}, {likely:g} and {upper:g} as lower, most_likely and upper",
            "Write lower, most_likely and upper in ascending order",
        )
    return Triangular(lower, likely, upper)


def _normal(name: str, raw: Mapping[str, Any], quantity: Quantity) -> Normal:
    mean = read_number(name, quantity, raw["mean"])
    written = share_of(mean, raw["deviation"], 'deviation = "5 %"')
    written = raw["deviation"] if written is None else written
    deviation = read_number(f"deviation of {name}", as_difference(quantity), written)
    normal = Normal(
        mean,
        deviation,
        **{key: read_number(name, quantity, raw[key]) for key in FORMS["uniform"] if key in raw},
    )
    lower, upper = normal.within(quantity)
    if not lower < upper:
        raise UnitError(
            f"the upper bound of {name} ({upper:g}) is not above the lower one ({lower:g})",
            "Swap them",
        )
    if not lower <= mean <= upper:
        raise UnitError(
            f"the mean of {name} ({mean:g}) is not between its bounds ({lower:g}, {upper:g})",
            "Change mean, lower or upper of this distribution",
        )
    return normal


def _lognormal(name: str, raw: Mapping[str, Any], quantity: Quantity) -> Lognormal:
    median, factor = read_number(name, quantity, raw["median"]), raw["factor"]
    if median <= 0:
        raise UnitError(
            f"the median of {name} is {median:g}, and a lognormal value is above 0",
            "Write a normal distribution, with the keys mean and deviation",
        )
    is_number = isinstance(factor, int | float) and not isinstance(factor, bool)
    if not (is_number and 1 < factor <= 1000):
        raise UnitError(
            f"the factor of {name} is {str(factor)[:40]}",
            "Give a factor above 1, such as 1.2 for 20 % more or less",
        )
    return Lognormal(median, float(factor))


def _tabulated(name: str, raw: Mapping[str, Any], quantity: Quantity) -> Tabulated:
    columns = [raw["values"], raw["densities"]]
    if not all(isinstance(value, list | tuple) for value in columns):
        raise UnitError(
            f"values and densities of {name} are not both lists", "Write two lists of numbers"
        )
    count = len(columns[0])
    if len(columns[1]) != count or not FEWEST_TABULATED <= count <= MAX_TABULATED:
        raise UnitError(
            f"{name} has {count:,} values and {len(columns[1]):,} densities",
            f"Give {FEWEST_TABULATED} to {MAX_TABULATED:,} values, and a density for each",
        )
    values = tuple(read_number(name, quantity, value) for value in columns[0])
    if any(after <= before for before, after in pairwise(values)):
        raise UnitError(
            f"the values of {name} are not in ascending order",
            "Sort the values, and give each once",
        )
    density_quantity = Quantity("1", "", "Density", "", 0.0, examples=("1",))
    densities = tuple(
        read_number(f"a density of {name}", density_quantity, value) for value in columns[1]
    )
    if not any(densities):
        raise UnitError(f"all densities of {name} are 0", "Give one above 0")
    return Tabulated(values, densities)


def quantiles(name: str, distribution: Distribution, fractions: ArrayLike) -> NDArray[Any]:
    """Return quantiles of a parameter's distribution, to sample it or to state its range.

    `fractions` are of the values below, 0 to 1; 0 and 1 give the ends, infinite where there are
    none. The result has their shape, in the unit of studies; the distribution is cut at the bounds
    of the parameter `name`.
    """
    fractions = np.asarray(fractions, dtype=np.float64)
    if isinstance(distribution, Between):
        lower, upper = distribution.lower, distribution.upper
        return np.asarray(lower + (upper - lower) * fractions)
    if isinstance(distribution, Tabulated):
        return _quantiles_of_table(distribution, fractions)
    continuous, quantity = _scipy_distribution(distribution), QUANTITIES[name]
    bounds = quantity.lower, quantity.upper
    lower, upper = distribution.within(quantity) if isinstance(distribution, Normal) else bounds
    probability_below, probability_above = continuous.cdf([lower, upper])
    return np.asarray(
        np.clip(
            continuous.ppf(probability_below + (probability_above - probability_below) * fractions),
            lower,
            upper,
        )
    )


def _scipy_distribution(distribution: Normal | Triangular | Lognormal) -> Any:
    import scipy  # slow to import, and only samples need it

    if isinstance(distribution, Normal):
        return scipy.stats.norm(distribution.mean, distribution.deviation)
    if isinstance(distribution, Lognormal):
        return scipy.stats.lognorm(math.log(distribution.factor), scale=distribution.median)
    lower, likely, upper = distribution.lower, distribution.most_likely, distribution.upper
    return scipy.stats.triang((likely - lower) / (upper - lower), loc=lower, scale=upper - lower)


def _quantiles_of_table(table: Tabulated, fractions: NDArray[Any]) -> NDArray[Any]:
    x, density = np.array(table.values), np.array(table.densities)
    width = np.diff(x)
    cumulative = np.concatenate([[0.0], np.cumsum(width * (density[1:] + density[:-1]) / 2)])
    target = fractions * cumulative[-1]
    interval = np.clip(np.searchsorted(cumulative, target, side="right") - 1, 0, width.size - 1)
    remainder, density_at_start = target - cumulative[interval], density[interval]
    slope = (density[interval + 1] - density_at_start) / width[interval]
    # Solve density_at_start * step + slope * step^2 / 2 = remainder without cancellation.
    root = np.sqrt(np.maximum(density_at_start**2 + 2 * slope * remainder, 0.0))
    with np.errstate(invalid="ignore", divide="ignore"):
        step = np.where(remainder > 0, 2 * remainder / (density_at_start + root), 0.0)
    return np.asarray(x[interval] + np.clip(np.nan_to_num(step), 0.0, width[interval]))


def nominal(distribution: Distribution) -> float:
    """Return the nominal value of a parameter with a distribution, in the unit of studies.

    It is the middle of an interval, the mean, the most likely value or the median.
    """
    match distribution:
        case Between(lower, upper):
            return (lower + upper) / 2
        case Normal(mean):
            return mean
        case Triangular(_, most_likely, _):
            return most_likely
        case Lognormal(median, _):
            return median
        case Tabulated(values, densities):
            return values[densities.index(max(densities))]


def tolerance(name: str, distribution: Distribution) -> tuple[float, float]:
    """Return both ends of a parameter's tolerance, in the unit of studies.

    They are the ends of the distribution; for one without ends those between which 99.73 % lie, as
    three standard deviations are on either side of a mean. `name` is the parameter, at whose bounds
    a distribution is cut.
    """
    if isinstance(distribution, Between | Triangular):
        return distribution.lower, distribution.upper
    if isinstance(distribution, Tabulated):
        return distribution.values[0], distribution.values[-1]
    lower, upper = quantiles(name, distribution, [OUTSIDE, 1 - OUTSIDE]).tolist()
    return lower, upper


def deviation(name: str, distribution: Distribution) -> float:
    """Return the standard deviation of a parameter's distribution, in the unit of studies.

    The distribution is cut at the bounds of the parameter `name`.
    """
    nodes, weights = np.polynomial.legendre.leggauss(64)
    # Integrate over the angle, fraction = (1 - cos(angle))/2: smooth, though tails are infinite.
    angle = np.pi * (nodes + 1) / 2
    fractions, weights = (1 - np.cos(angle)) / 2, weights * np.sin(angle) * np.pi / 4
    values = quantiles(name, distribution, fractions)
    return float(np.sqrt(weights @ (values - float(weights @ values)) ** 2))


# --- The section `uncertain` of studies: parameters and their distributions.


def _uncertain_schema(quantity: Quantity) -> dict[str, Any]:
    # Short, since there is one for each of many parameters: docs/sensitivity.md says the rest.
    number: dict[str, Any] = {"type": ["number", "string"]}
    list_of_values = {"type": "array", "items": number, "minItems": 2, "maxItems": MAX_TABULATED}
    schemas = {"values": list_of_values, "densities": list_of_values, "factor": {"type": "number"}}
    return {
        "title": quantity.label,
        "type": "object",
        "properties": {key: schemas.get(key, number) for keys in FORMS.values() for key in keys},
        "additionalProperties": False,
        "minProperties": 2,
    }


if TYPE_CHECKING:
    Uncertain = Frozen

else:
    Uncertain = by_parameter(
        "Uncertain",
        "Uncertain parameters and their distributions.",
        read_distribution,
        _uncertain_schema,
    )
