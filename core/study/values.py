"""The values of one parameter: one number, a list of points, or a span.

They are kept as the user wrote them, in the quantity's unit, and become an array only when asked
for: the size of a sweep is known, and checked, before anything is allocated.
"""

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from operator import gt, lt
from typing import Any, Final, Literal, TypeGuard

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core import materials
from vibrafeed.core.quantities import QUANTITIES, Quantity
from vibrafeed.core.study.shown import Shown, ShownUnits
from vibrafeed.core.study.units import UnitError, read_number, read_numbers
from vibrafeed.core.suggestions import suggestion

# --- Spaced values, each as a person would type it.
#
# A float stands for the number that is typed for it: 5e-05 for five hundred-thousandths. Even steps
# between two such numbers are computed exactly and rounded once, so that a step of a range is equal
# to its number as typed, which numpy's linspace often misses by a bit.

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
    # Value k is exactly (offset + k stride)/divisor; floats hold integers up to `EXACT` exactly.
    offset, stride, divisor = _integer_steps(first, last, size)
    if divisor <= EXACT and max(abs(offset), abs(offset + (size - 1) * stride)) <= EXACT:
        values = np.arange(start, stop, dtype=np.int64)
        values *= stride
        values += offset
        return values / divisor
    if size <= MAX_SLOW:
        values_of_slice = ((offset + index * stride) / divisor for index in range(start, stop))
        return np.fromiter(values_of_slice, np.float64, stop - start)
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
def _integer_steps(first: float, last: float, size: int) -> tuple[int, int, int]:
    # Integers a, b, c: value k of the axis is exactly (a + b k)/c, as a user means it.
    exact_first = as_typed(first)
    step = (as_typed(last) - exact_first) / (size - 1)
    denominator = exact_first.denominator * step.denominator
    offset, stride = (exact_first * denominator).numerator, (step * denominator).numerator
    divisor = math.gcd(offset, stride, denominator)
    return offset // divisor, stride // divisor, denominator // divisor


def _approximately(
    first: float, last: float, size: int, start: int, stop: int
) -> NDArray[np.float64]:
    # As `numpy.linspace`, or a slice of it; the last value is exact.
    values = np.arange(start, stop, dtype=np.float64)
    step = (last - first) / (size - 1)
    values = values * step if step else values / (size - 1) * (last - first)
    values += first
    if stop == size:
        values[-1:] = last
    return values


MAX_POINTS = 100_000_000  # values of one axis: more is a typing error, and would fill the memory
RANGE_KEYS = ("start", "stop", "num", "step", "spacing")
DESIGN = "design"  # the axis of designs, and the key of a parameter's values in them
BAND_KEYS, PAIR_KEYS = ("low", "high"), ("pair", "surface")


class NamedNumbers:
    """Numbers that a user names: bounds, or what makes a distribution."""

    def canonical(self) -> dict[str, Any]:
        """Return them as plain JSON, in the quantity's unit."""
        given = {name: value for name, value in vars(self).items() if value is not None}
        return {n: [*value] if isinstance(value, tuple) else value for n, value in given.items()}


@dataclass(frozen=True)
class Fixed:
    """One value; it makes no axis."""

    value: float

    def canonical(self) -> Any:
        """Return the value as plain JSON, in the quantity's unit."""
        return self.value


@dataclass(frozen=True)
class Band(Fixed):
    """The ends of a value that is not known better; the nominal value is the middle."""

    low: float
    high: float

    def canonical(self) -> Any:
        """Return the ends as plain JSON, in the quantity's unit."""
        return {"low": self.low, "high": self.high}


@dataclass(frozen=True)
class Points:
    """An axis of listed values, strictly increasing or decreasing."""

    values: tuple[float, ...]

    @property
    def size(self) -> int:
        """The number of values."""
        return len(self.values)

    def array(self, start: int = 0, stop: int | None = None) -> NDArray[np.float64]:
        """Return the values from index `start` to before `stop`; all by default."""
        return np.array(self.values[start:stop])

    def canonical(self) -> Any:
        """Return the list as plain JSON, in the quantity's unit."""
        return list(self.values)


@dataclass(frozen=True)
class Span:
    """An axis of `size` values from `start` to `stop`, both included."""

    start: float
    stop: float
    size: int
    spacing: Literal["linear", "log"] = "linear"

    def array(self, start: int = 0, stop: int | None = None) -> NDArray[np.float64]:
        """Return the values from index `start` to before `stop`; all by default.

        A part has the bits of the whole. Linear values are as typed (`evenly`).
        """
        return (geometrically if self.spacing == "log" else evenly)(
            self.start, self.stop, self.size, start, stop
        )

    def canonical(self) -> Any:
        """Return the range of a parameter as plain JSON in the quantity's unit, to store it.

        A study with equal values has an equal text, however the user wrote the range.
        """
        return {
            "start": self.start,
            "stop": self.stop,
            "num": self.size,
            "spacing": self.spacing,
        }


@dataclass(frozen=True)
class Paired(Points):
    """The value of a parameter in each design, in any order: all of them share one axis."""

    def canonical(self) -> Any:
        """Return the list as plain JSON, in the quantity's unit."""
        return {DESIGN: list(self.values)}


Values = Fixed | Points | Span


@dataclass(frozen=True)
class Between(NamedNumbers):
    """The bounds of what an optimiser may choose, both included."""

    lower: float
    upper: float


def read_between(name: str, raw: object, quantity: Quantity | None = None) -> Between:
    """Return the bounds that a user wrote for a variable, as numbers in its unit.

    `raw` has the keys lower and upper; `quantity` gives unit and limits where they are not those of
    the parameter `name`.

    Raises
    ------
    UnitError
        If they are no two values of that quantity, the lower one first.
    """
    quantity = quantity or QUANTITIES[name]
    if isinstance(raw, Between):
        return raw
    if not isinstance(raw, Mapping) or set(raw) != {"lower", "upper"}:
        shown = quantity.examples[0] if quantity.examples else "1"
        raise UnitError(
            f"{name} needs two bounds, lower and upper",
            f'Write {{ lower = ..., upper = "{shown}" }}',
        )
    lower, upper = (read_number(name, quantity, raw[end]) for end in ("lower", "upper"))
    if not lower < upper:
        raise UnitError(
            f"the upper bound of {name} ({upper:g}{quantity.suffix}) is not above its "
            f"lower bound ({lower:g}{quantity.suffix})",
            "Swap lower and upper, or give one value in [parameters]",
        )
    return Between(lower, upper)


def read_values(name: str, raw: object) -> Values:
    """Return the values that a user wrote for a parameter: one, a list, a range, or a band.

    A mapping with the key ``design`` has the value in each design.

    Numbers without a unit are in the quantity's own. `name` is the parameter, `raw` what the user
    wrote.

    Raises
    ------
    UnitError
        If they are no number, list, range or band of that quantity.
    """
    quantity = QUANTITIES[name]
    if isinstance(raw, Fixed | Points | Span):
        return raw
    if is_band(raw):
        return _read_band(name, quantity, raw)
    if isinstance(raw, Mapping):
        return _read_paired(name, raw) if set(raw) == {DESIGN} else _read_span(name, quantity, raw)
    if isinstance(raw, list | tuple):
        return _read_points(name, quantity, raw)
    if isinstance(raw, str) and "friction" in name and " on " in raw:
        fix = f'Write {name} = {{ pair = "{raw[:40]}" }}'
        raise UnitError(f"{raw[:60]!r} is not a number with a unit", fix)
    return Fixed(read_number(name, quantity, raw))


def position_on_axis(
    name: str, values: NDArray[np.float64], wanted: float, system: str = "si"
) -> int:
    """Return the index of a value on an axis, with a tolerance for texts such as 33.33333333.

    It may be missed by 1e-9 of the value or of the gap to its neighbour. `values` are those of the
    axis; `system` says in which units of `vibrafeed.core.study.shown` the error speaks. `wanted` is
    the value, in the unit of studies as the axis; `name` is the parameter.

    Raises
    ------
    UnitError
        If the axis does not have it; the nearest values are named.
    """
    if not math.isfinite(wanted):
        raise UnitError(f"{wanted} is not a value of the axis {name}", "Give a finite number")
    distance = np.abs(values - wanted)
    nearest = int(distance.argmin())
    gap = float(np.abs(np.diff(values)).min(initial=np.inf)) if values.size > 1 else 0.0
    if distance[nearest] <= 1e-9 * max(abs(wanted), abs(values[nearest]), gap):
        return nearest
    two_nearest = sorted(values[np.argsort(distance, kind="stable")[:2]])
    unit = QUANTITIES[name].unit
    shown_unit = Shown(1.0, {"1": "", "degree": "deg"}.get(unit, unit))
    # Angles are typed as deg, not with the sign of a degree.
    if system != "si" and not QUANTITIES[name].is_angle:
        shown_unit = ShownUnits(system).of(unit, abs(wanted))
    shown_value, *others = (f"{value * shown_unit.factor:.10g}" for value in (wanted, *two_nearest))
    shown = " and ".join(others) + f" {shown_unit.unit}".rstrip()
    raise UnitError(
        f"{shown_value} {shown_unit.unit}".rstrip() + f" is not a value of the axis {name}",
        f"The nearest are {shown}" if len(two_nearest) > 1 else f"Its only value is {shown}",
    )


def _read_points(name: str, quantity: Quantity, raw: list[object] | tuple[object, ...]) -> Points:
    if not raw:
        raise UnitError(f"the list of values of {name} is empty", "Give at least one value")
    values = read_numbers(name, quantity, raw)
    following = values[1:]
    if not (all(map(lt, values, following)) or all(map(gt, values, following))):
        repeated = next(
            (value for value, next_value in pairwise(values) if value == next_value), None
        )
        if repeated is not None:
            raise UnitError(f"{name} lists {repeated:g} twice", "List each value once")
        raise UnitError(
            f"the values of {name} are not in order",
            "Sort the values, and write decimals with a point",
        )
    return Points(values)


def _read_paired(name: str, raw: Mapping[str, Any]) -> Paired:
    values = raw[DESIGN]
    if not isinstance(values, list | tuple) or not values:
        raise UnitError(f"{name} has no value in any design", "Give a list of values")
    return Paired(read_numbers(name, QUANTITIES[name], values))


def _read_span(name: str, quantity: Quantity, raw: Mapping[str, object]) -> Span:
    unknown = [key for key in raw if key not in RANGE_KEYS]
    if unknown:
        raise UnitError(
            f"'{str(unknown[0])[:40]}' is not a key of the range of {name}",
            suggestion(str(unknown[0]), RANGE_KEYS),
        )
    if "start" not in raw or "stop" not in raw or ("num" in raw) == ("step" in raw):
        raise UnitError(
            f"the range of {name} is incomplete or ambiguous",
            "Give start and stop, and either num or step",
        )
    start = read_number(name, quantity, raw["start"])
    stop = read_number(name, quantity, raw["stop"])
    if stop == start:
        raise UnitError(
            f"start and stop of the range of {name} are both {start:g}{quantity.suffix}",
            "Give two ends, or one value",
        )
    spacing = raw.get("spacing", "linear")
    if spacing == "log":
        if min(start, stop) <= 0 or "step" in raw:
            raise UnitError(
                f"the logarithmic range of {name} needs ends above 0, and num instead of step",
                "Give start and stop above 0, and num",
            )
    elif spacing != "linear":
        raise UnitError(
            f"{str(spacing)[:40]!r} is not a spacing of the range of {name}",
            "Write spacing = 'linear' or 'log', or leave out spacing",
        )
    if "step" in raw:
        stop, size = _last_and_size(name, quantity, start, stop, raw["step"])
    else:
        size = _num(name, raw["num"])
    if size > MAX_POINTS:
        raise UnitError(
            f"{name} has {size:,} values",
            f"Give an axis at most {MAX_POINTS:,} values: take a larger step",
        )
    return Span(start, stop, size, "log" if spacing == "log" else "linear")


def is_band(raw: object) -> TypeGuard[Mapping[str, object]]:
    """True for what a user writes of a value that is known within a band only."""
    return isinstance(raw, Mapping) and not {*BAND_KEYS, *PAIR_KEYS}.isdisjoint(raw)


def _read_band(name: str, quantity: Quantity, raw: Mapping[str, object]) -> Band:
    if "pair" in raw and set(raw) <= {*PAIR_KEYS}:
        low, high = _published_friction(
            name, str(raw["pair"])[:100], str(raw.get("surface", ""))[:100]
        )
    elif set(raw) == {*BAND_KEYS}:
        low, high = (read_number(name, quantity, raw[end]) for end in BAND_KEYS)
    else:
        raise UnitError(
            f"{name} has the keys {', '.join(map(str, raw))}"[:200],
            'Write { low = 0.2, high = 0.4 }, or { pair = "steel on steel", surface = "dry" }',
        )
    if not low < high:
        raise UnitError(
            f"high ({high:g}{quantity.suffix}) of {name} is not above low "
            f"({low:g}{quantity.suffix})",
            "Swap low and high, or write one value without keys",
        )
    return Band(float((as_typed(low) + as_typed(high)) / 2), low, high)


def _published_friction(name: str, pair: str, surface: str) -> tuple[float, float]:
    # The ends of all published values for the pair.
    if "friction" not in name:
        raise UnitError(
            f"{name} is not a friction coefficient, so it has no pair", "Write low and high"
        )
    rows = materials.rows_of_pair(pair)
    if not rows:
        raise UnitError(
            f"the table of friction has no pair '{pair}'", suggestion(pair, materials.pairs())
        )
    matching = [row for row in rows if materials.has_surface(row, surface)]
    ends = [end for row in matching for end in materials.ends(row, "static" in name)]
    if not ends:
        known = ", ".join(dict.fromkeys(row["surface"] for row in rows if row["surface"]))
        raise UnitError(f"'{surface}' is not a surface of {pair}", f"Known: {known}")
    if min(ends) == max(ends):
        raise UnitError(
            f"the table has one value of {name} for {pair}, {ends[0]:g}, and no range",
            f"Write low and high around it, or {name} = {ends[0]:g}",
        )
    return min(ends), max(ends)


def _num(name: str, raw: object) -> int:
    if isinstance(raw, bool) or not isinstance(raw, int) or raw < 2:
        raise UnitError(
            f"num of {name} is {str(raw)[:40]!r}, not a number of values",
            "Give num as a whole number of at least 2",
        )
    return raw


def _last_and_size(
    name: str, quantity: Quantity, start: float, stop: float, raw: object
) -> tuple[float, int]:
    # Read as a difference: a step may be below the lower bound of the quantity.
    exact_start, step = (
        as_typed(start),
        as_typed(read_number(f"step of {name}", as_difference(quantity), raw)),
    )
    step = step if stop > start else -step
    steps = (as_typed(stop) - exact_start) / step
    if steps > MAX_POINTS:
        return stop, int(min(steps, Fraction(10**18))) + 1
    whole_steps = round(steps)
    # A stop without an exact decimal, such as radians in degrees, may just miss a whole step.
    is_reached = abs(steps - whole_steps) <= max(1e-9, 1e-12 * steps)
    whole_steps = whole_steps if is_reached else math.floor(steps)
    if whole_steps < 1:
        raise UnitError(f"the step of {name} is larger than its whole range", "Take a smaller step")
    return (stop if is_reached else float(exact_start + whole_steps * step)), whole_steps + 1


def as_difference(quantity: Quantity) -> Quantity:
    """Return the declaration of the difference of two values of a quantity: same unit, above 0.

    It is used to read a step of a range or a standard deviation, whose bounds are not the
    quantity's own.
    """
    return replace(quantity, lower=0.0, upper=math.inf, strict=True)
