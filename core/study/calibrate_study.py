"""The study of what measured speeds tell of parameters that nobody knows."""

import reprlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import (
    AliasChoices,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainValidator,
    ValidationInfo,
    WithJsonSchema,
    create_model,
)

from vibrafeed.core.quantities import QUANTITIES, Quantity
from vibrafeed.core.study.distributions import Normal, read_distribution
from vibrafeed.core.study.grid_study import (
    MAX_RUNS,
    NUMBER,
    OBSERVED,
    PARAMETERS,
    Frozen,
    Parameters,
    by_parameter,
    first_paths,
    optional,
    parameters_in,
    read_level,
    refusal,
    refusing,
)
from vibrafeed.core.study.sweep_and_simulate import FollowedStudy, MotionSettings
from vibrafeed.core.study.units import UnitError, read_number, share_of
from vibrafeed.core.study.values import Between, Values
from vibrafeed.core.suggestions import suggestion

# --- Measurements, run by run: rows of a study, or of a CSV or XLSX file on this machine.

REGIMES_SEEN = {
    "hops": "the part leaves the floor in each cycle, or in some",
    "does not hop": "the part never leaves the floor",
    "does not start": "friction holds the part all the time",
    "moves forwards": "the part travels in the direction of transport",
    "moves backwards": "the part travels against the direction of transport",
}
"""What may have been seen of a run without measuring its speed."""

_WRITTEN = {"anyOf": [*NUMBER["anyOf"], {"type": "array", "items": NUMBER}]}


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
    percentage_error = share_of(value, raw, 'error = "5 %"')
    error = read_level(output, raw) if percentage_error is None else percentage_error
    if not error > 0:
        raise UnitError(
            f"the error {raw} of the measured value is not above 0",
            "Give the standard deviation of the measured value, or leave it out",
        )
    return error


def _none_or(read: Callable[[object], float], raw: object) -> float | None:
    return None if raw is None else read(raw)


def _observed_schema(name: str) -> dict[str, Any]:
    return {**_WRITTEN, "description": f"What was measured: {QUANTITIES[name].description}"}


@refusing
def _read_row_error(raw: object, info: ValidationInfo) -> object:
    measured = ((name, info.data.get(name)) for name in OBSERVED)
    output, value = next((pair for pair in measured if pair[1] is not None), (None, None))
    # What is wrong with the value is told there.
    return (
        read_error(output, raw, value) if raw is not None and output and value is not None else None
    )


def _read_regime(raw: object) -> str | None:
    if raw is None:
        return None
    text = " ".join(str(raw).replace("_", " ").split()).lower()
    if text not in REGIMES_SEEN:
        raise refusal(
            f"{str(raw)[:40]!r} is not a regime that can be observed",
            partial(suggestion, text, REGIMES_SEEN),
        )
    return text


class _Row(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)


if TYPE_CHECKING:

    class Run(_Row):
        """One optional field a parameter, what was measured, its error, and what was seen."""

        conveying_velocity: float | None = None
        feed_rate: float | None = None
        track_amplitude: float | None = None
        velocity_towards: float | None = None
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
            for name in PARAMETERS
        },
        **{
            name: optional(
                partial(_none_or, partial(read_level, name)), partial(_observed_schema, name)
            )
            for name in OBSERVED
        },
        error=(
            Annotated[
                float | None,
                BeforeValidator(_read_row_error),
                WithJsonSchema(
                    {**_WRITTEN, "description": "Standard deviation of the measured value."}
                ),
            ],
            None,
        ),
        regime=(
            Annotated[
                str | None,
                PlainValidator(_read_regime),
                WithJsonSchema({"type": "string", "enum": [*REGIMES_SEEN]}),
            ],
            Field(None, description="Observed behaviour of the part, such as hopping."),
        ),
    )


def parameters_of(run: Run) -> dict[str, float]:
    """Return the parameters of a run, in the units of studies."""
    return {name: value for name, value in parameters_in(run).items() if value is not None}


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
        raise refusal(
            "the file of observations has not been read yet",
            "Run the study, or load it by vibrafeed.load_study",
        )
    raw = [raw] if isinstance(raw, Mapping) else raw
    if not isinstance(raw, list | tuple):
        raise refusal(
            "observations is not a list of runs",
            "Write [[observations]] with the parameters of a run and its conveying_velocity",
        )
    rows: list[object] = []
    for number, entry in enumerate(raw, 1):
        rows += (
            map(_with_speed_from_time, _rows_of(entry, number))
            if isinstance(entry, Mapping)
            else [entry]
        )
        if len(rows) > MAX_RUNS:
            raise refusal(f"observations has more than {MAX_RUNS:,} runs", "Remove some runs")
    return rows


def _rows_of(entry: Mapping[str, Any], number: int) -> Iterator[dict[str, Any]]:
    lengths = {name: len(value) for name, value in entry.items() if isinstance(value, list | tuple)}
    if len({*lengths.values()}) > 1:
        lengths_in_words = ", ".join(
            f"{str(name)[:40]} {length}" for name, length in lengths.items()
        )
        raise refusal(
            f"the lists of entry {number} of the observations differ in length: {lengths_in_words}",
            "Give each as many values as there are runs, or one for all of them",
        )
    for row in range(next(iter(lengths.values()), 1)):
        yield {str(name): value[row] if name in lengths else value for name, value in entry.items()}


@refusing
def _with_speed_from_time(row: Mapping[str, Any]) -> Mapping[str, Any]:
    # Runs that were timed by stopwatch give distance and time instead of the speed.
    if row.get("distance") is None or row.get("time") is None or "conveying_velocity" in row:
        return row
    distance, time = (
        read_number(name, QUANTITIES[name], row[name]) for name in ("distance", "time")
    )
    if not time > 0.0:
        raise UnitError(
            f"the time of a part over the distance is {time:g} s, not above 0",
            "Give a time above 0",
        )
    others = {name: value for name, value in row.items() if name not in ("distance", "time")}
    return {**others, "conveying_velocity": distance / time}


STEMS = {"unknowns": "", "offsets": "offset_", "factors": "factor_"}
"""The tables of a study that hold unknowns, and the prefix of their names in results."""
Prior = Between | Normal
"""What is known of an unknown before: bounds, or a normal distribution that bounds may cut."""
FEWEST_POINTS, POINTS, MAX_POINTS = 1_000, 20_000, 1_000_000
"""Grid points of the unknowns: fewest, default and most."""

_PRIOR_SCHEMA = {
    "type": "object",
    "properties": dict.fromkeys(("lower", "upper", "mean", "deviation"), NUMBER),
    "anyOf": [{"required": ["lower", "upper"]}, {"required": ["mean", "deviation"]}],
    "additionalProperties": False,
}


def quantity_of(table: str, parameter: str) -> Quantity:
    """Return the declaration of an unknown of a calibration, with its unit and bounds.

    `table` is "unknowns" for the parameter itself, "offsets" for what is added to it, in the same
    unit and of any sign, or "factors" for what it is multiplied by, without unit. `parameter` is
    its name.
    """
    quantity = QUANTITIES[parameter]
    if table == "unknowns":
        return quantity
    unbounded = replace(quantity, lower=-float("inf"), upper=float("inf"), strict=False)
    return (
        unbounded
        if table == "offsets"
        else replace(unbounded, unit="1", lower=0.0, examples=("1.1",))
    )


def _read_prior(table: str, parameter: str, raw: object) -> Prior:
    prefix = {"offsets": "the offset of ", "factors": "the factor of "}.get(table, "")
    prior = read_distribution(prefix + parameter, raw, quantity_of(table, parameter))
    if not isinstance(prior, Prior):
        raise UnitError(
            f"the prior of {prefix}{parameter} is neither a range nor a normal distribution",
            "Write { lower = ..., upper = ... }, or { mean = ..., deviation = ... }",
        )
    return prior


if TYPE_CHECKING:
    Unknowns = Frozen
    Offsets = Frozen
    Factors = Frozen
else:
    Unknowns, Offsets, Factors = (
        by_parameter(table.capitalize(), doc, partial(_read_prior, table), lambda _: _PRIOR_SCHEMA)
        for table, doc in (
            ("unknowns", "The unknown parameters, each with a range or a distribution."),
            (
                "offsets",
                "Unknown offsets that are added to parameters, such as the error of an angle.",
            ),
            (
                "factors",
                "Unknown factors by which parameters, such as amplitudes, are multiplied.",
            ),
        )
    )


def _read_probability(raw: object) -> object:
    if isinstance(raw, int | float) and not isinstance(raw, bool) and 0 < raw < 0.5:
        return float(raw)
    raise refusal(
        f"{reprlib.repr(raw)[:40]} is not a probability between 0 and 0.5 that an observed "
        f"regime is wrong",
        "Write a number above 0 and below 0.5, such as 0.01",
    )


class CalibrateStudy(MotionSettings, FollowedStudy):
    """A study that estimates unknown parameters from measured speeds."""

    bands_section: ClassVar[str] = "unknowns"
    kind: Literal["calibrate"] = Field(description="The kind of study.")
    observations: Annotated[
        tuple[Run, ...],
        BeforeValidator(spread_rows),
        WithJsonSchema(
            {
                "anyOf": [
                    {"type": "string", "description": "A CSV or XLSX file in the study's folder."},
                    {
                        "type": "array",
                        "maxItems": MAX_RUNS,
                        "items": {"type": "object"},
                        "minItems": 1,
                    },
                ]
            }
        ),
    ] = Field(
        description="The runs: the parameters that differ between them and the measurements; or "
        "the name of a CSV or XLSX file in the study's folder.",
        min_length=1,
    )
    error: float | Annotated[str, Field(max_length=200)] | None = Field(
        None,
        description="Standard deviation of the measured values, for runs that do not give their "
        "own: a number, text with a unit, or a share such as '5 %'.",
    )
    unknowns: Unknowns | None = Field(
        None,
        description="The unknown parameters: { lower, upper }, or { mean, deviation }; a range "
        "with low and high among the parameters is one of them.",
    )
    offsets: Offsets | None = Field(
        None, description="Unknown offsets of parameters, such as the mounting error of an angle."
    )
    factors: Factors | None = Field(
        None, description="Unknown factors of parameters, such as that of all amplitudes."
    )
    candidates: Parameters | None = Field(
        None,
        description="Drives that could be run next, as values or ranges; the result says which of "
        "them would add most.",
    )
    discrepancy: bool = Field(
        True,
        description="True if speeds may scatter by more than their errors, for effects that the "
        "model lacks.",
        strict=True,
    )
    likelihood: Literal["normal", "student_t"] = Field(
        "normal",
        description="Distribution of the errors: normal, or student_t, whose tails let a few wrong "
        "runs count little.",
    )
    outlier_probability: Annotated[
        float,
        BeforeValidator(_read_probability),
        WithJsonSchema({"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 0.5}),
    ] = Field(
        0.01,
        description="Probability that an observed regime is wrong.",
        validation_alias=AliasChoices("outlier_probability", "doubt"),  # as it was called before
    )
    points: int = Field(
        POINTS,
        description="Maximum number of grid points of the unknowns; each needs one motion per run.",
        strict=True,
        ge=FEWEST_POINTS,
        le=MAX_POINTS,
    )

    def priors(self) -> dict[str, Prior]:
        """Return the priors of all unknowns by name, such as ``friction`` or ``offset_beta``.

        A prior is what is known of an unknown before the calibration.
        """
        return {
            stem + name: prior
            for table, stem in STEMS.items()
            for name, prior in parameters_in(getattr(self, table)).items()
        }

    def asked_next(self) -> dict[str, Values]:
        """Return the parameters of candidate runs, among which the next one to measure is chosen.

        Empty if the study has no candidates.
        """
        return parameters_in(self.candidates)

    def places(self) -> dict[str, str]:
        """Return the paths of parameters in measured runs, else of unknowns, for messages."""
        runs = (name for run in self.observations for name in parameters_of(run))
        return first_paths(
            (
                *((name, f"observations, {name}") for name in runs),
                *(
                    (name, f"{table}.{name}")
                    for table in STEMS
                    for name in parameters_in(getattr(self, table))
                ),
            )
        )

    def content(self) -> dict[str, Any]:
        """Return the study as plain data, with ranges and units in canonical form."""
        content = super().content()
        if self.candidates is not None:
            content["candidates"] = {
                name: values.canonical() for name, values in self.asked_next().items()
            }
        return content
