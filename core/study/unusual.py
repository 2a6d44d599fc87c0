"""Numbers that are allowed and hardly meant: half a metre of amplitude, radians for degrees.

One table of usual values, that of `vibrafeed.core.quantities`, judges what is typed, what stands in
a table of observations, and what was fitted to a recording.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Any, Final

from vibrafeed.core.quantities import QUANTITIES, Quantity
from vibrafeed.core.study.shown import ShownUnits
from vibrafeed.core.study.units import UnitError, read_number, read_numbers

SLIPS: Final[Mapping[str, str]] = {
    "m": "mm",
    "degree": "rad",
    "Hz": "rpm",
    "kg": "g",
    "m s-1": "mm/s",
    "m s-2": "mm/s^2",
}
"""For the unit of a quantity, the unit in which an unusual number without a unit was probably
meant."""

PARTS: Final = ("parameters", "variables", "uncertain", "unknowns", "candidates")
TIMES: Final[Mapping[str, float]] = {"ms": 1e3, "us": 1e6, "ns": 1e9, "min": 1.0 / 60.0}
"""For units of time, the factor of a frequency that was fitted to such times as if to seconds."""

ENDS: Final = ("start", "stop", "lower", "upper", "mean", "most_likely", "median")


VERTICAL: Final = {
    "vertical_amplitude": "amplitude",
    "vertical_peak_to_peak": "peak_to_peak",
}
"""Vertical amplitudes, and what they make along the drive, divided by sin(beta)."""


def questions(content: object) -> list[str]:
    """Return a question for each parameter value of a study that is allowed but unusual.

    Such are half a metre of amplitude, or radians taken for degrees. `content` is the study as the
    user wrote it, a mapping or anything else, with the numbers of the files that it names in their
    place: those of a fitted drive, and rows of observations. A number that is written with its unit
    is not asked about for being small.
    """
    if not isinstance(content, Mapping):
        return []
    fitted = _fitted(content)
    found = questions_of_drive(fitted, str(content["drive"].get("name"))) if fitted else []
    sections = {section: content.get(section) for section in PARTS}
    sections["observations"] = _columns(content.get("observations"))
    for section, values in sections.items():
        for name, raw in values.items() if isinstance(values, Mapping) else ():
            quantity = QUANTITIES.get(str(name))
            is_fitted = section == "parameters" and name in fitted
            if is_fitted or quantity is None or quantity.usual is None:
                continue
            question = _question(str(name), quantity, quantity.usual, [*leaves_of(raw)])
            found += [question] if question else []
    return found or _questions_of_vertical(content)


def questions_of_drive(numbers: Mapping[str, float], name: str) -> list[str]:
    """Return a question for each number of a fitted drive that no usual feeder has.

    `numbers` are parameters by name, `name` is that of the recording. An unusual frequency makes
    all amplitudes unusual: it alone is asked about, with the unit of times that is likely.
    """
    found = []
    for parameter, value in sorted(numbers.items(), key=lambda item: item[0] != "frequency"):
        quantity = QUANTITIES[parameter]
        low, high = quantity.usual or (-math.inf, math.inf)
        if low <= value <= high or value == 0.0:
            continue
        shown = ShownUnits().of(quantity.unit, value)
        ends = f"{low * shown.factor:,.6g} to {high * shown.factor:,.6g} {shown.unit}"
        question = "Are the unit of the accelerations and that of the times right?"
        if parameter == "frequency":
            unit = likely_unit_of_times(value)
            question = "Is the unit of the times, or the rate, right?"
            question += (
                f" With times in {unit} it would be {value * TIMES[unit]:.4g} Hz." if unit else ""
            )
        found.append(
            f"{parameter} = {value * shown.factor:,.6g} {shown.unit}, fitted to {name}, is "
            f"unusual; usual values are {ends}. {question}"
        )
        if parameter == "frequency":
            break
    return found


def likely_unit_of_times(frequency: float) -> str | None:
    """Return the unit of times that were probably taken for seconds; None if none is likely.

    `frequency` was fitted to them [Hz]; in the right unit it is a usual one.
    """
    low, high = QUANTITIES["frequency"].usual or (0.0, 0.0)
    return next((unit for unit, by in TIMES.items() if low <= by * frequency <= high), None)


def _fitted(content: Mapping[Any, Any]) -> dict[str, float]:
    # The numbers of a fitted drive that the parameters have unchanged.
    drive, parameters = content.get("drive"), content.get("parameters")
    numbers = drive.get("numbers") if isinstance(drive, Mapping) else None
    if not isinstance(numbers, Mapping) or not isinstance(parameters, Mapping):
        return {}
    return {
        name: value
        for name, value in numbers.items()
        if name in QUANTITIES and isinstance(value, float) and parameters.get(name) == value
    }


def _columns(rows: object) -> dict[str, list[Any]]:
    columns: dict[str, list[Any]] = {}
    for row in [rows] if isinstance(rows, Mapping) else rows if isinstance(rows, list) else ():
        for name, raw in row.items() if isinstance(row, Mapping) else ():
            columns.setdefault(str(name), []).extend(leaves_of(raw))
    return columns


def _questions_of_vertical(content: object) -> list[str]:
    smallest_sine = min(
        (abs(math.sin(math.radians(angle))) for angle in _values_of(content, "beta")), default=0.0
    )
    found = []
    for name, along in VERTICAL.items():
        low, high = QUANTITIES[along].usual or (0.0, math.inf)
        largest = max(map(abs, _values_of(content, name)), default=0.0)
        if largest > high * smallest_sine > 0:
            shown = ShownUnits().of(QUANTITIES[along].unit, high)
            size, *ends = (
                f"{value * shown.factor:,.6g}" for value in (largest / smallest_sine, low, high)
            )
            found.append(
                f"{name} and beta make {along} = {size} {shown.unit} along the drive; usual values "
                f"are {' to '.join(ends)} {shown.unit}. Is that what you mean?"
            )
    return found


def _values_of(content: object, name: str) -> list[float]:
    sections = (
        [content.get(section_name) for section_name in PARTS]
        if isinstance(content, Mapping)
        else []
    )
    raw_values = [
        section[name] for section in sections if isinstance(section, Mapping) and name in section
    ]
    leaves = [leaf for raw_value in raw_values for leaf in leaves_of(raw_value)]
    return [*read_numbers(name, QUANTITIES[name], leaves)] if leaves else []


def leaves_of(raw: object) -> Iterator[Any]:
    """Yield the single values that a user wrote for a parameter, to look at each.

    `raw` may be a value, a list, or a mapping: a range or a distribution, with its ends and values.
    """
    if isinstance(raw, Mapping):
        yield from (raw[end] for end in ENDS if end in raw)
        yield from raw.get("values", ())
    elif isinstance(raw, list | tuple):
        yield from raw
    else:
        yield raw


def _question(
    name: str, quantity: Quantity, usual: tuple[float, float], leaves: list[Any]
) -> str | None:
    if not leaves:  # what is uncertain may come from a file
        return None
    sizes = [abs(value) for value in read_numbers(name, quantity, leaves)]
    largest, (low, high) = max(sizes), usual
    written_value = leaves[sizes.index(largest)]
    is_bare = not isinstance(written_value, str)
    if largest <= high and not (is_bare and 0 < largest < low):
        return None
    shown = ShownUnits().of(quantity.unit, largest)
    unit = f" {shown.unit}" if shown.unit else ""
    meaning = f"means {largest * shown.factor:,.6g}{unit}" if unit and is_bare else "is unusual"
    ends = f"{low * shown.factor:,.6g} to {high * shown.factor:,.6g}{unit}"
    shown_value = written_value if is_bare else f'"{written_value}"'
    correction = _likely_correction(name, quantity, usual, written_value) if is_bare else None
    question = f"Did you mean {correction}?" if correction else "Is that what you mean?"
    return f"{name} = {shown_value} {meaning}; usual values are {ends}. {question}"


def _likely_correction(
    name: str, quantity: Quantity, usual: tuple[float, float], written_value: Any
) -> str | None:
    unit = SLIPS.get(quantity.unit)
    if unit is None:  # of a share, per cent
        text, value = f"{written_value / 100:g}", written_value / 100
    else:
        text = f"{written_value} {unit}"
        try:
            value = read_number(name, quantity, text)
        except UnitError:
            return None
        text = f'"{text}"'
    return text if usual[0] <= abs(value) <= usual[1] else None
