"""Measurements, run by run: rows of a study, or of a CSV or XLSX file on this machine."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainValidator,
    ValidationInfo,
    WithJsonSchema,
    create_model,
)

from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.levels import optional, read_level, refusal
from vibrafeed.core.study.section_names import MAX_RUNS, OBSERVED
from vibrafeed.core.study.units import UnitError, read_number, share_of
from vibrafeed.core.suggestions import suggestion

REGIMES_SEEN = {
    "hops": "the part leaves the floor in each cycle, or in some",
    "does not hop": "the part never leaves the floor",
    "does not start": "friction holds the part all the time",
    "moves forwards": "the part travels in the direction of transport",
    "moves backwards": "the part travels against the direction of transport",
}
"""What may have been seen of a run without measuring its speed."""

_PARAMETERS = tuple(name for name, quantity in QUANTITIES.items() if quantity.parameter)
_TEXT = {"type": "string", "maxLength": 200}
_NUMBER = {"anyOf": [{"type": "number"}, _TEXT]}
_WRITTEN = {"anyOf": [{"type": "number"}, _TEXT, {"type": "array", "items": _NUMBER}]}


def read_error(output: str, raw: object, value: float) -> float:
    """Return the standard deviation of a measured value, in the output's unit.

    Parameters
    ----------
    output : str
        What was measured.
    raw : object
        A number, text with a unit, or a share of the value such as ``"5 %"``.
    value : float
        What was measured, in the output's unit.

    Raises
    ------
    UnitError
        If it is not a valid error.
    """
    error = share_of(value, raw, 'error = "5 %"')
    if error is None:
        error = read_level(output, raw)
    if not error > 0:
        fix = "Give the standard deviation of the measured value, or leave it out"
        raise UnitError(f"the error {raw} of the measured value is not above 0", fix)
    return error


def _none_or(read: Callable[[object], float], raw: object) -> float | None:
    """Return a value in its quantity's unit, as `read` has it; None for none."""
    return None if raw is None else read(raw)


def _observed_schema(name: str) -> dict[str, Any]:
    """Return the JSON Schema of a measured output."""
    return {**_WRITTEN, "description": f"What was measured: {QUANTITIES[name].description}"}


def _read_row_error(raw: object, info: ValidationInfo) -> object:
    """Return the standard deviation of a run's measured value, in the output's unit, or None.

    `raw` is what the user wrote, `info` has the measured value. None without a valid value or
    error; raises a refusal for a text that is no error.
    """
    given = {name: info.data.get(name) for name in OBSERVED}
    output, value = next(((n, v) for n, v in given.items() if v is not None), (None, None))
    if raw is None or output is None or value is None:
        return None  # what is wrong with the value is told there
    try:
        return read_error(output, raw, value)
    except UnitError as error:
        raise refusal(error.message, error.fix) from error


def _read_regime(raw: object) -> str | None:
    """Return an observed regime that a user wrote, in small letters; raise a refusal if unknown.

    Regimes that can be seen are those of `REGIMES_SEEN`, such as "hopping"; None stands for none.
    """
    if raw is None:
        return None
    text = " ".join(str(raw).replace("_", " ").split()).lower()
    if text not in REGIMES_SEEN:
        fix = partial(suggestion, text, REGIMES_SEEN)
        raise refusal(f"{str(raw)[:40]!r} is not a regime that can be observed", fix)
    return text


class _Row(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)


_RowError = Annotated[
    float | None,
    BeforeValidator(_read_row_error),
    WithJsonSchema({**_WRITTEN, "description": "Standard deviation of the measured value."}),
]
_Seen = Annotated[
    str | None,
    PlainValidator(_read_regime),
    WithJsonSchema({"type": "string", "enum": [*REGIMES_SEEN]}),
]

if TYPE_CHECKING:

    class Run(_Row):
        """One optional field a parameter, what was measured, its error, and what was seen."""

        conveying_velocity: float | None = None
        feed_rate: float | None = None
        error: float | None = None
        regime: str | None = None

else:
    Run = create_model(
        "Run",
        __base__=_Row,
        __doc__="A run: parameters of its own, what was measured with its error, what was seen.",
        **{
            name: optional(
                partial(_none_or, partial(read_number, name, QUANTITIES[name])), lambda: _WRITTEN
            )
            for name in _PARAMETERS
        },
        **{
            name: optional(
                partial(_none_or, partial(read_level, name)), partial(_observed_schema, name)
            )
            for name in OBSERVED
        },
        error=(_RowError, None),
        regime=(_Seen, Field(None, description="Observed behaviour of the part, such as hopping.")),
    )


def parameters_of(run: Run) -> dict[str, float]:
    """Return the parameters of a run, in the units of studies."""
    given = {name: getattr(run, name) for name in _PARAMETERS if name in run.model_fields_set}
    return {name: value for name, value in given.items() if value is not None}


def spread_rows(raw: object) -> object:
    """Return the measured runs of a study as rows, each with single values.

    `raw` is what the user wrote: a table whose lists become one row per value, or a list of such
    tables.

    Raises
    ------
    PydanticCustomError
        If lists have different lengths, if there are too many runs, or if it is no table.
    """
    if isinstance(raw, str):
        fix = "Run the study, or load it by vibrafeed.load_study"
        raise refusal("the file of observations has not been read yet", fix)
    if isinstance(raw, Mapping):
        raw = [raw]
    if not isinstance(raw, list | tuple):
        fix = "Write [[observations]] with the parameters of a run and its conveying_velocity"
        raise refusal("observations is not a list of runs", fix)
    rows: list[object] = []
    for number, entry in enumerate(raw, 1):
        rows += _rows_of(entry, number) if isinstance(entry, Mapping) else [entry]
        if len(rows) > MAX_RUNS:
            raise refusal(f"observations has more than {MAX_RUNS:,} runs", "Remove some runs")
    return rows


def _rows_of(entry: Mapping[str, Any], number: int) -> Iterator[dict[str, Any]]:
    """Yield the runs of one entry of a study's observations: one for each value of its lists.

    Other values are repeated. `number` is that of the entry, for messages. Raises a refusal if
    lists differ in length.
    """
    lengths = {name: len(value) for name, value in entry.items() if isinstance(value, list | tuple)}
    if not lengths:
        yield {str(name): value for name, value in entry.items()}
        return
    if len({*lengths.values()}) > 1:
        told = ", ".join(f"{str(name)[:40]} {length}" for name, length in lengths.items())
        fix = "Give each as many values as there are runs, or one for all of them"
        raise refusal(
            f"the lists of entry {number} of the observations differ in length: {told}", fix
        )
    for k in range(next(iter(lengths.values()))):
        yield {str(n): value[k] if n in lengths else value for n, value in entry.items()}


ROWS_SCHEMA: dict[str, Any] = {
    "anyOf": [
        {"type": "string", "description": "A CSV or XLSX file in the study's folder."},
        {"type": "array", "maxItems": MAX_RUNS, "items": {"type": "object"}, "minItems": 1},
    ]
}
