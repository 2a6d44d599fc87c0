"""The study models: frozen, no unknown keys, one model for files, requests and the JSON Schema."""

from __future__ import annotations

import hashlib
import json
import reprlib
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    PlainSerializer,
    PlainValidator,
    WithJsonSchema,
    create_model,
    field_validator,
)
from pydantic_core import PydanticCustomError

from core.quantities import QUANTITIES, Quantity
from core.study.drive import Drive
from core.study.levels import Level, OpenLevel, at_most, refusal
from core.study.reduction import Reduction
from core.study.shown import read_shown
from core.study.units import UnitError
from core.study.values import Between, Values, read_between, read_values

PARAMETERS = tuple(name for name, quantity in QUANTITIES.items() if quantity.parameter)


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)


def _values_schema(name: str, quantity: Quantity) -> dict[str, Any]:
    number: dict[str, Any] = {"type": "number"}
    if quantity.lower > -float("inf"):
        number["exclusiveMinimum" if quantity.strict else "minimum"] = quantity.lower
    if quantity.upper < float("inf"):
        number["maximum"] = quantity.upper
    one = {"anyOf": [number, {"type": "string", "maxLength": 200}]}
    span = {
        "type": "object",
        "properties": {
            "start": one,
            "stop": one,
            "num": {"type": "integer", "minimum": 2},
            "step": {"anyOf": [{"type": "number", "exclusiveMinimum": 0}, {"type": "string"}]},
            "spacing": {"enum": ["linear", "log"], "default": "linear"},
        },
        "required": ["start", "stop"],
        "oneOf": [{"required": ["num"]}, {"required": ["step"]}],
        "additionalProperties": False,
    }
    unit = "" if quantity.unit == "1" else f" A bare number is in {quantity.unit}."
    return {
        "title": quantity.label,
        "description": quantity.description + unit,
        "anyOf": [number, {"type": "string"}, {"type": "array", "items": one, "minItems": 1}, span],
        "examples": list(quantity.examples),
    }


def _canonical(values: Values | None) -> Any:
    return None if values is None else values.canonical()


def _parameter_field(name: str, quantity: Quantity) -> Any:
    def read(raw: object) -> Values:
        try:
            return read_values(name, raw)
        except UnitError as error:
            raise refusal(error.message, error.fix) from error

    return (
        Annotated[
            Values | None,
            PlainValidator(read),
            PlainSerializer(_canonical),
            WithJsonSchema(_values_schema(name, quantity)),
        ],
        None,
    )


if TYPE_CHECKING:

    class Parameters(_Frozen):
        """One optional field a parameter quantity."""

else:
    Parameters = create_model(
        "Parameters",
        __base__=_Frozen,
        __doc__="Values of the parameters: a number, text with a unit, a list, or a range.",
        **{name: _parameter_field(name, QUANTITIES[name]) for name in PARAMETERS},
    )


def _between_field(name: str, quantity: Quantity) -> Any:
    def read(raw: object) -> Between:
        try:
            return read_between(name, raw)
        except UnitError as error:
            raise refusal(error.message, error.fix) from error

    one = {"anyOf": [{"type": "number"}, {"type": "string", "maxLength": 200}]}
    schema = {
        "title": quantity.label,
        "description": f"Bounds of the {quantity.label.lower()}, both included.",
        "type": "object",
        "properties": {"lower": one, "upper": one},
        "required": ["lower", "upper"],
        "additionalProperties": False,
    }
    return (
        Annotated[
            Between | None,
            PlainValidator(read),
            PlainSerializer(lambda bounds: None if bounds is None else bounds.canonical()),
            WithJsonSchema(schema),
        ],
        None,
    )


if TYPE_CHECKING:

    class Variables(_Frozen):
        """One optional field a parameter quantity."""

else:
    Variables = create_model(
        "Variables",
        __base__=_Frozen,
        __doc__="What the optimiser may choose: parameters and their bounds.",
        **{name: _between_field(name, QUANTITIES[name]) for name in PARAMETERS},
    )


MOST_SHOWN = 8  # to look a unit up takes long


def _read_units(raw: object) -> tuple[str, ...] | None:
    """Return the words that say which units are shown, without saying so if none is."""
    if raw is None:
        return None
    words = (raw,) if isinstance(raw, str) else tuple(raw) if isinstance(raw, list) else raw
    if (
        not isinstance(words, tuple)
        or len(words) > MOST_SHOWN
        or not all(isinstance(word, str) for word in words)
    ):
        raise refusal(
            f"{reprlib.repr(raw)[:40]} are not units", 'Write "si", or a list such as ["m/min"]'
        )
    try:
        read_shown(words)
    except UnitError as error:
        raise refusal(error.message, error.fix) from error
    return words


_ONE_WORD = {"type": "string", "maxLength": 100}
_UNITS_SCHEMA = {
    "anyOf": [
        _ONE_WORD,
        {"type": "array", "items": _ONE_WORD, "maxItems": MOST_SHOWN},
        {"type": "null"},
    ]
}


class GridStudy(_Frozen):
    """What every kind of study has: a scene, and parameters that may range over a grid."""

    kind: str = Field(description="The kind of study.")
    scene: str = Field(
        description="Name of a scene; `vibrafeed scenes` lists them.", max_length=100
    )
    parameters: Parameters = Field(description="Fixed or ranged parameters.")
    title: str | None = Field(None, description="Title of the dataset.", max_length=500)
    notes: str | None = Field(
        None, description="Remarks that go into the dataset.", max_length=5000
    )
    verify: int | None = Field(
        None,
        description="Evaluate so many random cells again, with 50 digits or by another method, and "
        "tell the worst of them.",
        strict=True,
        ge=1,
        le=10_000,
    )
    units: Annotated[
        tuple[str, ...] | None, PlainValidator(_read_units), WithJsonSchema(_UNITS_SCHEMA)
    ] = Field(
        None,
        description="Units that screens and pictures show: trade (the default), si, or units such "
        "as m/min, each for its kind. Files hold SI.",
    )

    def values(self) -> dict[str, Values]:
        """Return the given parameters and their values, in the order of the declaration.

        The order in which a user writes them does not matter: equal studies have equal axes.
        """
        given = self.parameters.model_fields_set
        return {name: getattr(self.parameters, name) for name in PARAMETERS if name in given}

    def content(self) -> dict[str, Any]:
        """Return the study as plain values, ranges and units in one form."""
        content = self.model_dump(exclude_none=True, exclude={"parameters"})
        content["parameters"] = {name: values.canonical() for name, values in self.values().items()}
        return content

    def canonical(self) -> str:
        """Return the study as JSON that equal studies share to the letter."""
        return json.dumps(
            self.content(), separators=(",", ":"), ensure_ascii=False, allow_nan=False
        )

    def key(self) -> str:
        """Return the SHA-256 of the canonical form, in hexadecimal."""
        return hashlib.sha256(self.canonical().encode()).hexdigest()


class DrivenStudy(GridStudy):
    """What studies of motion in time have besides: a drive that may have been measured."""

    drive: Drive = Field(
        None,
        description="A measured drive: the recording of an accelerometer. Its harmonics are "
        "parameters, as far as the study does not give them itself.",
    )


MOST_SAMPLES = 100_000
LATEST = 1e6  # s, of a course in time: eleven days, and floats still tell a microsecond
_TRAJECTORY_SCHEMA = {
    "anyOf": [
        {"type": "integer", "minimum": 2, "maximum": MOST_SAMPLES},
        {
            "type": "array",
            "items": {"type": "number", "minimum": 0},
            "minItems": 1,
            "maxItems": MOST_SAMPLES,
        },
        {"type": "null"},
    ]
}


def _read_trajectory(raw: object) -> int | tuple[float, ...] | None:
    """Return a number of steps, or times in seconds."""
    whole = isinstance(raw, int) and not isinstance(raw, bool)
    if raw is None or (whole and 2 <= raw <= MOST_SAMPLES):  # type: ignore[operator]
        return raw  # type: ignore[return-value]
    if isinstance(raw, list | tuple) and 0 < len(raw) <= MOST_SAMPLES:
        numbers = [x for x in raw if isinstance(x, int | float) and not isinstance(x, bool)]
        rises = all(before < after for before, after in pairwise(numbers))
        if len(numbers) == len(raw) and rises and numbers[0] >= 0 and numbers[-1] <= LATEST:
            return tuple(float(number) for number in numbers)
    raise PydanticCustomError(
        "value",
        "{message}",
        {
            "message": f"{reprlib.repr(raw)[:40]} is neither a number of steps nor a list of times",
            "fix": f"Write a whole number from 2 to {MOST_SAMPLES:,}, or times in seconds that rise"
            " from 0 or later",
        },
    )


MOST_OUTPUTS = 100
_Outputs = Annotated[tuple[Annotated[str, Field(max_length=100)], ...], at_most(MOST_OUTPUTS)]


class SweepStudy(GridStudy):
    """Closed-form equations of one scene over a grid of parameters."""

    kind: Literal["sweep"] = Field(description="The kind of study.")
    variant: str | None = Field(
        None,
        description="thesis (as printed), derived (errors corrected) or physical; the scene's "
        "default where left out.",
        max_length=100,
    )
    outputs: _Outputs = Field(
        description="Names of the outputs.", min_length=1, max_length=MOST_OUTPUTS
    )
    precision: Literal["double", "single"] | None = Field(
        None,
        description="double (64-bit floats, the default) or single: values are computed in double "
        "and stored in 32 bits, half the bytes, each rounded once more by at most 6e-8 of itself.",
    )
    reduce: Reduction | None = Field(
        None, description="Answers over some axes in place of all cells: docs/reduce.md."
    )

    @field_validator("precision")
    @classmethod
    def _double_is_nothing(cls, value: str | None) -> str | None:
        """Leave the default out, so that equal studies are equal to the letter."""
        return None if value == "double" else value


FEWEST_PERIODS = 8  # no fewer tell a motion that repeats over some from one that does not
MOST_PERIODS = 100_000  # half an hour at 50 Hz: what has not repeated by then does not
SETTINGS = ("tolerance", "most_periods", "steps_per_period", "slip_speed", "contact_stiffness")


class SimulateStudy(DrivenStudy):
    """Motion in time of one scene over a grid of parameters."""

    kind: Literal["simulate"] = Field(description="The kind of study.")
    method: str | None = Field(
        None,
        description="events (from event to event, exact), time-stepping, reference (of high order, "
        "slow) or regularised (stiff, for comparison); where left out events on a plane with "
        "alpha = 0, else time-stepping.",
        max_length=100,
    )
    outputs: _Outputs = Field(
        ("conveying_velocity",),
        description="Names of the outputs.",
        min_length=1,
        max_length=MOST_OUTPUTS,
    )
    # Near 100 roundings of a state nothing is told apart any more, and integrators give up.
    tolerance: float | None = Field(
        None,
        description="Largest error of a periodic state, as a share of the drive.",
        ge=1e-13,
        le=1,
    )
    most_periods: int | None = Field(
        None,
        description="Most periods of the drive that one point is followed for.",
        strict=True,
        ge=FEWEST_PERIODS,
        le=MOST_PERIODS,
    )
    steps_per_period: int | None = Field(
        None,
        description="Time steps in a period, of time-stepping; steps times periods are 25 million "
        "at most.",
        strict=True,
        ge=8,
        le=100_000,
    )
    slip_speed: float | None = Field(
        None,
        description="Speed below which regularised friction gives way, in g/w.",
        ge=1e-12,
        le=1,
    )
    contact_stiffness: float | None = Field(
        None, description="Stiffness of the regularised floor, over m w^2.", ge=100, le=1e16
    )
    trajectory: Annotated[
        int | tuple[float, ...] | None,
        PlainValidator(_read_trajectory),
        WithJsonSchema(_TRAJECTORY_SCHEMA),
    ] = Field(
        None,
        description="Also give the motion in time of the one point of the study: at so many equal "
        "steps of its cycle, or at these times in seconds since the start of a period.",
    )

    def settings(self) -> dict[str, float]:
        """Return the settings that the study gives, by their names among the quantities."""
        given = {name: getattr(self, name) for name in SETTINGS}
        return {name: float(value) for name, value in given.items() if value is not None}


_Output = Annotated[str, Field(max_length=100)]


class _TwoOutputs(_Frozen):
    output: _Output = Field("acceleration_x", description="The output that is to be high.")
    against: _Output = Field(
        "acceleration_y", description="The output whose absolute value is to be low."
    )


class Weighted(_TwoOutputs):
    """The largest of the output less `weight` times the other's absolute value."""

    kind: Literal["weighted"] = "weighted"
    weight: float = Field(1.0, description="Weight of the other output.", ge=0, allow_inf_nan=False)


class Limited(_TwoOutputs):
    """The largest output with the other's absolute value within a limit."""

    kind: Literal["limit"] = "limit"
    limit: Level = Field(description="Largest absolute value of the other output.")


class Pareto(_TwoOutputs):
    """The whole trade-off: what no other choice beats in both outputs."""

    kind: Literal["pareto"] = "pareto"
    points: int = Field(200, description="Number of points of the front.", ge=2, le=10_000)


class Maximise(_Frozen):
    """The largest value of one output."""

    kind: Literal["maximise"] = "maximise"
    output: _Output = Field("acceleration_x", description="The output.")


class Minimise(_Frozen):
    """The least value of one output."""

    kind: Literal["minimise"] = "minimise"
    output: _Output = Field("acceleration_x", description="The output.")


Criterion = Weighted | Limited | Pareto | Maximise | Minimise
"""What is looked for."""

CRITERIA = ("weighted", "limit", "pareto", "maximise", "minimise")


class OutputLimit(_Frozen):
    """Bounds that an output has to keep."""

    output: _Output = Field(description="The output.")
    lower: OpenLevel = Field(None, description="Its least value.")
    upper: OpenLevel = Field(None, description="Its largest value.")
    absolute: bool = Field(False, description="Whether the bounds are those of its absolute value.")


MOST_CONSTRAINTS = 20


class OptimiseStudy(DrivenStudy):
    """The best values of some parameters, over a grid of the others."""

    kind: Literal["optimise"] = Field(description="The kind of study.")
    variant: str | None = Field(
        None,
        description="thesis (as printed), derived (errors corrected) or physical; the scene's "
        "default where left out.",
        max_length=100,
    )
    method: str | None = Field(
        None,
        description="The optimiser; where left out, the exact answer if there is one, else what "
        "was measured to be best.",
        max_length=100,
    )
    variables: Variables | None = Field(
        None,
        description="What may be chosen, between bounds; alpha and beta from 0 to 90 degrees where "
        "left out, as far as they are not given and the outputs depend on them.",
    )
    criterion: Criterion = Field(description="What is looked for.", discriminator="kind")
    constraints: Annotated[tuple[OutputLimit, ...], at_most(MOST_CONSTRAINTS)] = Field(
        (), description="Bounds that outputs have to keep.", max_length=MOST_CONSTRAINTS
    )
    floor_contact: bool = Field(
        True, description="Whether the part is to stay on the floor, where the scene has one."
    )
    wall_contact: bool = Field(
        True, description="Whether the part is to stay on the wall, where the scene has one."
    )
    uncertain: Variables | None = Field(
        None,
        description="One parameter that is known within an interval only, such as friction.",
    )
    robust: Literal["worst", "mean"] | None = Field(
        None,
        description="What is looked for over that interval: the best worst case (where left out), "
        "or the best mean.",
    )
    sensitivities: bool = Field(
        False,
        description="Also give d ln(output)/d ln(parameter) at each optimum.",
        strict=True,
    )
    outputs: _Outputs = Field(
        (), description="Further outputs to tell at the optimum.", max_length=MOST_OUTPUTS
    )

    def intervals(self) -> dict[str, Between]:
        """Return the uncertain parameters and their intervals."""
        if self.uncertain is None:
            return {}
        given = self.uncertain.model_fields_set
        return {name: getattr(self.uncertain, name) for name in PARAMETERS if name in given}

    def bounds(self) -> dict[str, Between]:
        """Return the given variables and their bounds, in the order of the declaration."""
        if self.variables is None:
            return {}
        given = self.variables.model_fields_set
        return {name: getattr(self.variables, name) for name in PARAMETERS if name in given}


Study = SweepStudy | SimulateStudy | OptimiseStudy
"""A study of any kind."""

STUDIES: dict[str, type[SweepStudy] | type[SimulateStudy] | type[OptimiseStudy]] = {
    "sweep": SweepStudy,
    "simulate": SimulateStudy,
    "optimise": OptimiseStudy,
}
