"""Base classes of all studies: frozen models without unknown keys, of files and requests."""

import hashlib
import html
import json
import reprlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial, wraps
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Final, Literal, Self

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainValidator,
    ValidationInfo,
    WithJsonSchema,
    create_model,
    model_validator,
)
from pydantic_core import PydanticCustomError, core_schema

from vibrafeed.core.errors import Problem
from vibrafeed.core.quantities import QUANTITIES, WORDS, Quantity
from vibrafeed.core.study.shown import read_shown
from vibrafeed.core.study.units import UnitError, read_number
from vibrafeed.core.study.values import DESIGN, Band, Values, is_band, read_values

# --- The drive of a study that has been measured: what a user writes of it, and what is kept.


TEXT: Final = {"type": "string", "maxLength": 200}
NUMBER: Final[dict[str, Any]] = {"anyOf": [{"type": "number"}, TEXT]}
"""JSON Schema of a text with a unit, and of a number or such a text."""
_TRIPLE = {"type": "array", "minItems": 3, "maxItems": 3}
_Column = Annotated[str, Field(max_length=200)]
# As a user writes them: whoever reads the recording reads these, and says what is wrong.
_Number = Annotated[Any, WithJsonSchema(NUMBER)]
_Mounting = Annotated[
    Any,
    WithJsonSchema(
        {
            "anyOf": [
                {**_TRIPLE, "items": NUMBER},
                {**_TRIPLE, "items": {**_TRIPLE, "items": {"type": "number"}}},
            ]
        }
    ),
]
_Finite = Annotated[float, Field(allow_inf_nan=False)]
_Share = Annotated[_Finite, Field(ge=0)]
MAX_SAMPLES_ONCE: Final = 20_000
_Samples = Annotated[tuple[_Finite, ...], Field(min_length=2, max_length=MAX_SAMPLES_ONCE)]


class RecordedDrive(BaseModel):
    """A recording of an accelerometer, whose harmonics become parameters of the study."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    file: Path | None = Field(
        None,
        description="Its file, in the study's folder: CSV, XLSX, LVM, MAT, WAV, TDMS or UFF; over "
        "HTTP give data instead.",
    )
    data: str | None = Field(None, description="The text of the CSV.")
    along: _Column | None = Field(
        None, description="Column of the acceleration along the track; -ax reverses it."
    )
    across: _Column | None = Field(None, description="Across the track, to the left.")
    normal: _Column | None = Field(None, description="Normal to the track, upwards.")
    sensor: tuple[_Column, ...] | None = Field(
        None,
        description="Instead: columns of the sensor's own axes x, y, z.",
        min_length=3,
        max_length=3,
    )
    mounting: _Mounting = Field(
        None, description="Yaw, pitch and roll of the sensor on the track, or its rotation matrix."
    )
    unit: _Column | None = Field(
        None,
        description="Of the columns, instead of that in their headings: g, mg, m s-2, mm s-2; mm/s "
        "of velocities; mm or um of displacements; V or mV with a sensitivity.",
    )
    sensitivity: _Column | None = Field(
        None, description="Of a sensor whose columns are voltages or counts: 100 mV/g."
    )
    scale: _Column | None = Field(None, description="Full scale of a WAV file: 8 g.")
    rate: _Number = Field(None, description="Samples per second, if there is no time column.")
    time: _Column | None = Field(None, description="Time column; time or t is found automatically.")
    line_frequency: _Number = Field(
        None, description="True frequency of the drive; shows the error of the recorder's clock."
    )
    frequency: _Number = Field(
        None,
        description="Approximate frequency of the motion [Hz]; found automatically by default.",
    )
    once: bool = Field(
        False,
        strict=True,
        description="Follow the recording as it is, from rest to rest, instead of its harmonics: "
        "for burst_displacement.",
    )
    harmonics: Annotated[Any, WithJsonSchema({"type": "integer", "minimum": 1, "maximum": 10})] = (
        Field(
            None,
            description="Number of harmonic orders to fit; by default as many as the data support.",
        )
    )


class MeasuredDrive(BaseModel):
    """The origin of the numbers of a measured drive.

    It stands in the place of the recording once that has been fitted: in the study that a dataset
    holds, for example.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    name: str = Field(description="Name of the recording's file.", max_length=300)
    sha256: str = Field(description="SHA-256 of the recording's content.", pattern="^[0-9a-f]{64}$")
    left_over: dict[Literal["along", "across", "normal"], _Share] = Field(
        description="Rms residual of the fit for each axis, as a share of the drive's rms."
    )
    clock_error: _Finite | None = Field(
        None, description="Error of the recorder's clock; a slow one has a positive error."
    )
    numbers: dict[Annotated[str, Field(max_length=100)], _Finite] = Field(
        description="The parameters as they were fitted.", max_length=100
    )
    samples: dict[Literal["time", "along", "across", "normal"], _Samples] | None = Field(
        None,
        description="Of a recording followed once: times [s], and accelerations [m s-2] or "
        "velocities [m s-1].",
    )
    derivative: Literal[1, 2] | None = Field(
        None, description="1 if the samples are velocities, 2 if they are accelerations."
    )
    constant: dict[Literal["along", "across", "normal"], _Finite] | None = Field(
        None,
        description="Of a recording followed once: its mean acceleration [m s-2], which is left "
        "out so that the track ends at rest.",
    )

    @model_validator(mode="after")
    def _check_samples(self) -> Self:
        times = (self.samples or {}).get("time", ())
        is_rising = all(before < after for before, after in pairwise(times))
        lengths = {len(values) for values in (self.samples or {}).values()}
        if self.samples is not None and (
            lengths != {len(times)} or times[0] != 0.0 or not is_rising
        ):
            message = "the samples of the drive are not values at times that increase from 0"
            raise refusal(message, CARRY_OUT)
        return self


def only_the_plain_sine(fix: str) -> Problem:
    """Return the problem of a measured drive in a study of closed forms; `fix` says the way out."""
    return Problem(
        "drive",
        "closed forms cannot use a recorded drive, only a plain sine (amplitude, alpha, beta)",
        fix,
    )


def names_recording(content: object) -> bool:
    """True if a study's content names a recording that has not been fitted."""
    drive = content.get("drive") if isinstance(content, Mapping) else None
    return isinstance(drive, Mapping) and "sha256" not in drive


class FromFile:
    """The annotation of a section that names a file, until its numbers stand in its place.

    `written` is the model that a user writes, with `file` or `data`; of `kept`, with the `sha256`
    of the file, is the value. `unread` and `unclear` are message and fix where the file has not
    been read, and of what is no section.
    """

    def __init__(
        self,
        written: type[BaseModel],
        kept: type[BaseModel],
        unread: tuple[str, str],
        unclear: tuple[str, str],
    ) -> None:
        self.written, self.kept, self.unread, self.unclear = written, kept, unread, unclear

    def read(self, raw: object) -> object:
        """Return a section that was read; refuse another."""
        if isinstance(raw, Mapping) and "sha256" not in raw:  # the digest of the file
            raise refusal(*self.unread)
        if not isinstance(raw, Mapping | self.kept | None):
            raise refusal(f"{str(raw)[:40]!r} {self.unclear[0]}", self.unclear[1])
        return raw

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """Return pydantic's schema of the value, with the check before it."""
        return core_schema.no_info_before_validator_function(self.read, handler(source))

    def __get_pydantic_json_schema__(self, *_: object) -> dict[str, Any]:
        """Return the JSON Schema of what may be written, made when it is asked for."""
        source = {"oneOf": [{"required": ["file"]}, {"required": ["data"]}]}
        written, kept = self.written.model_json_schema(), self.kept.model_json_schema()
        return {"anyOf": [written | source, kept, {"type": "null"}], "default": None}


CARRY_OUT: Final = "Run the study, or load it with vibrafeed.load_study"
Drive = Annotated[
    MeasuredDrive | None,
    FromFile(
        RecordedDrive,
        MeasuredDrive,
        ("the recording of the drive has not been fitted yet", CARRY_OUT),
        (
            "does not say how to read a recording",
            'Write [drive] with file = "recording.csv" and the columns along and normal',
        ),
    ),
]

# --- Names and sizes in sections of a study.

CRITERIA: Final = ("weighted", "limit", "pareto", "maximise", "minimise", "reach")
"""The kinds of criterion of an optimisation."""

DRIVE_ANGLES: Final = ("alpha", "beta")
"""The variables of an optimisation that names none."""

OBSERVED: Final = ("conveying_velocity", "feed_rate", "track_amplitude", "velocity_towards")
"""Outputs that may have been measured."""

MAX_RUNS: Final = 1_000
"""Runs of a study that has observations."""


# --- Values of outputs that a study compares with: a number, or text in the output's unit.


def refusal(message: str, fix: str | Callable[[], str]) -> PydanticCustomError:
    """Return the validation error of a wrong value; a function `fix` is called for few of many."""
    return PydanticCustomError("value", "{message}", {"message": message, "fix": fix})


def refusing(read: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function whose `UnitError` pydantic tells as a refusal."""

    @wraps(read)
    def reads(*written: object) -> Any:
        try:
            return read(*written)
        except UnitError as error:
            raise refusal(error.message, error.fix) from error

    return reads


@dataclass(frozen=True)
class Reader:
    """A field of a study for pydantic, read by one function that may raise `UnitError`.

    pydantic's own validators inspect signatures and types, which takes long for hundreds of fields
    at every start. `schema` returns the JSON Schema of what may be written.
    """

    read: Callable[[object], Any]
    schema: Callable[[], dict[str, Any]]

    def __get_pydantic_core_schema__(self, *_: object) -> Any:
        """Return the functions that read the field, and write it as plain JSON."""
        return core_schema.no_info_plain_validator_function(
            refusing(self.read),
            serialization=core_schema.plain_serializer_function_ser_schema(
                lambda value: value.canonical() if hasattr(value, "canonical") else value
            ),
        )

    def __get_pydantic_json_schema__(self, *_: object) -> dict[str, Any]:
        """Return the JSON Schema of the field."""
        return self.schema()


def optional(read: Callable[[object], Any], schema: Callable[[], dict[str, Any]]) -> Any:
    """Return type and default of a field that a function reads, and that is None if left out."""
    return Annotated[Any, Reader(read, schema)], None


def at_most(count: int) -> BeforeValidator:
    """Return a validator that refuses longer lists before pydantic checks each of their entries."""

    def check(raw: object) -> object:
        if isinstance(raw, list | tuple) and len(raw) > count:
            raise refusal(f"it has {len(raw):,} entries", f"Give at most {count:,}")
        return raw

    return BeforeValidator(check)


def read_level(name: str, raw: object) -> float:
    """Return a value to compare the output `name` with in its unit; raise `UnitError` for none."""
    quantity = QUANTITIES[name]
    # A limit to compare with may lie outside the bounds of the quantity itself.
    examples = quantity.examples or ("1" if quantity.unit == "1" else f"1 {quantity.unit}",)
    infinity = float("inf")
    return read_number(
        name,
        replace(quantity, lower=-infinity, upper=infinity, strict=False, examples=examples),
        raw,
    )


@refusing
def _read_level(raw: object, info: ValidationInfo) -> object:
    output = info.data.get("against") or info.data.get("output")
    if raw is None or str(output) not in QUANTITIES:  # an unknown output is told of elsewhere
        return raw if raw is None or isinstance(raw, int | float) else 0.0
    return read_level(str(output), raw)


Level = Annotated[float, BeforeValidator(_read_level), WithJsonSchema(NUMBER)]
"""A value of the output that an earlier field names."""
OpenLevel = Annotated[float | None, BeforeValidator(_read_level), WithJsonSchema(NUMBER)]
"""The same, or none."""

PARAMETERS = tuple(name for name, quantity in QUANTITIES.items() if quantity.parameter)


def _tidy(schema: dict[str, Any]) -> None:
    # Drops titles that repeat the names, and null as default; adds the words of angles.
    required, properties = schema.get("required", ()), schema.get("properties", {})
    for name, field in properties.items():
        if field.get("title", "").lower() == name.replace("_", " "):
            del field["title"]
        if name not in required and field.get("default", 0) is None:
            del field["default"]
    for word, letter in WORDS.items():
        if letter in properties:
            properties[word] = properties[letter] | {"description": f"Another name of {letter}."}


class Frozen(BaseModel):
    """A model that cannot be changed and knows all its keys."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        defer_build=True,
        arbitrary_types_allowed=True,
        json_schema_extra=_tidy,
    )


def by_parameter(
    name: str,
    doc: str,
    read: Callable[[str, object], Any],
    schema: Callable[[Quantity], dict[str, Any]],
) -> Any:
    """Return the model of a section with optional fields for parameters.

    `read` takes the name and what a user wrote, `schema` the quantity.
    """
    fields = {
        parameter: optional(partial(read, parameter), partial(schema, QUANTITIES[parameter]))
        for parameter in PARAMETERS
    }
    # In the module of the caller, where pickle looks for the class.
    return create_model(name, __base__=Frozen, __module__=schema.__module__, __doc__=doc, **fields)


def parameters_in(section: BaseModel | None) -> dict[str, Any]:
    """Return the parameters that a section of a study gives, in the order of the declaration."""
    named = section.model_fields_set if section is not None else ()
    return {name: getattr(section, name) for name in PARAMETERS if name in named}


def bands_moved_to(section: str, content: object) -> object:
    """Return the content of a study with the bands of its parameters as bounds in a section.

    Faulty bands stay, for the reader of parameters to refuse them.
    """
    parameters = content.get("parameters") if isinstance(content, Mapping) else None
    if not isinstance(content, Mapping) or not isinstance(parameters, Mapping):
        return content
    section_content = content.get(section) or {}
    bounds = {
        parameter: ends
        for parameter, raw in parameters.items()
        if parameter in PARAMETERS and (ends := _bounds(parameter, raw))
    }
    if (
        not bounds
        or not isinstance(section_content, Mapping)
        or not bounds.keys().isdisjoint(section_content)
    ):
        return content
    others = {name: raw for name, raw in parameters.items() if name not in bounds}
    return {**content, "parameters": others, section: {**section_content, **bounds}}


def _bounds(name: str, raw: object) -> dict[str, float] | None:
    try:
        band = raw if isinstance(raw, Band) else read_values(name, raw) if is_band(raw) else None
    except UnitError:
        return None
    return {"lower": band.low, "upper": band.high} if isinstance(band, Band) else None


def first_paths(pairs: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Return the first path of each name."""
    return dict(reversed([*pairs]))


_PAIR: Final = {
    "type": "object",
    "properties": {"pair": TEXT, "surface": TEXT},
    "required": ["pair"],
    "additionalProperties": False,
}


def _values_schema(quantity: Quantity) -> dict[str, Any]:
    number: dict[str, Any] = {"type": "number"}
    if quantity.lower > -float("inf"):
        number["exclusiveMinimum" if quantity.strict else "minimum"] = quantity.lower
    if quantity.upper < float("inf"):
        number["maximum"] = quantity.upper
    value = {"anyOf": [number, TEXT]}
    range_schema = {
        "type": "object",
        "properties": {
            "start": value,
            "stop": value,
            "num": {"type": "integer", "minimum": 2},
            "step": {"anyOf": [{"type": "number", "exclusiveMinimum": 0}, {"type": "string"}]},
            "spacing": {"enum": ["linear", "log"], "default": "linear"},
        },
        "required": ["start", "stop"],
        "oneOf": [{"required": ["num"]}, {"required": ["step"]}],
        "additionalProperties": False,
    }
    band_schema = {
        "type": "object",
        "properties": {"low": value, "high": value},
        "required": ["low", "high"],
        "additionalProperties": False,
    }
    unit = "" if quantity.unit == "1" else f" A bare number is in {quantity.unit}."
    return {
        "title": quantity.label,
        "description": quantity.description + unit,
        "anyOf": [
            number,
            {"type": "string"},
            {"type": "array", "items": value, "minItems": 1},
            range_schema,
            band_schema,
            {
                "type": "object",
                "properties": {DESIGN: {"type": "array", "items": value, "minItems": 1}},
                "required": [DESIGN],
                "additionalProperties": False,
            },
            *([_PAIR] if "friction" in quantity.label.lower() else []),
        ],
        "examples": list(quantity.examples),
    }


if TYPE_CHECKING:
    Parameters = Frozen

else:
    Parameters = by_parameter(
        "Parameters",
        "Values of the parameters: a number, text with a unit, a list, a range, or a band.",
        read_values,
        _values_schema,
    )


MAX_SHOWN = 8  # units that a study may name: looking one up takes long


@refusing
def _read_units(raw: object) -> tuple[str, ...] | None:
    if raw is None:
        return None
    words = (raw,) if isinstance(raw, str) else tuple(raw) if isinstance(raw, list) else raw
    if (
        not isinstance(words, tuple)
        or len(words) > MAX_SHOWN
        or not all(isinstance(word, str) for word in words)
    ):
        raise refusal(
            f"{reprlib.repr(raw)[:40]} is neither a unit nor a list of units",
            'Write "si", or a list such as ["m/min"]',
        )
    read_shown(words)
    return words


_SINGLE_WORD = {"type": "string", "maxLength": 100}


MAX_OUTPUTS = 100
OutputName = Annotated[str, Field(max_length=100)]
OutputNames = Annotated[tuple[OutputName, ...], at_most(MAX_OUTPUTS)]


_CELL: Final = {"type": "object", "additionalProperties": NUMBER}
_DESIGNS: Final = {
    "anyOf": [
        {"type": "array", "items": _CELL, "minItems": 1},
        {
            "type": "object",
            "properties": {
                "file": {"type": "string"},
                "rows": {"type": "array", "items": _CELL, "minItems": 1},
                "zip": {"type": "array", "items": {"type": "string"}, "minItems": 1},
            },
            "minProperties": 1,
            "maxProperties": 1,
            "additionalProperties": False,
        },
        {"type": "null"},
    ],
    "default": None,
}


def _refuse_designs(raw: object) -> None:
    if raw is not None:
        raise refusal(
            "they are neither a table nor lists of parameters",
            'Write file = "designs.csv", rows = [...], or zip = ["frequency", "amplitude"]',
        )


class Study(Frozen):
    """The fields of every kind of study: a scene, and parameters that may range over a grid."""

    bands_section: ClassVar[str] = ""
    """The section in which a kind keeps bands of parameters as bounds; empty for `parameters`."""

    kind: str = Field(description="The kind of study.")
    scene: str = Field(
        description="Name of a scene; `vibrafeed scenes` lists them.", max_length=100
    )
    parameters: Parameters = Field(description="Fixed or ranged parameters.")
    designs: Annotated[None, PlainValidator(_refuse_designs), WithJsonSchema(_DESIGNS)] = Field(
        None,
        description="Designs, one a row, instead of all combinations: rows of parameters, a file "
        "with such rows, or zip, the names of parameters whose lists belong together. They "
        "become values of the parameters along the axis design.",
    )
    title: str | None = Field(None, description="Title of the dataset.", max_length=500)
    notes: str | None = Field(
        None, description="Notes that are stored in the dataset.", max_length=5000
    )
    verify: int | None = Field(
        None,
        description="Number of random cells to evaluate again, in extended precision or by "
        "another method; the result states the worst of them.",
        strict=True,
        ge=1,
        le=10_000,
    )
    units: Annotated[
        tuple[str, ...] | None,
        PlainValidator(_read_units),
        WithJsonSchema(
            {
                "anyOf": [
                    _SINGLE_WORD,
                    {"type": "array", "items": _SINGLE_WORD, "maxItems": MAX_SHOWN},
                    {"type": "null"},
                ]
            }
        ),
    ] = Field(
        None,
        description="Units that screens and pictures show: trade (the default), si, or units such "
        "as m/min, each for its kind. Files hold SI.",
    )

    @model_validator(mode="before")
    @classmethod
    def _with_bands(cls, content: object) -> object:
        return bands_moved_to(cls.bands_section, content) if cls.bands_section else content

    def values(self) -> dict[str, Values]:
        """Return the parameters that are set, in one order: equal studies agree."""
        return parameters_in(self.parameters)

    def places(self) -> dict[str, str]:
        """Return the paths of parameters that are not under `parameters`."""
        return {}

    def output_places(self) -> dict[str, str]:
        """Return the paths of outputs that are not under `outputs`."""
        return {}

    def content(self) -> dict[str, Any]:
        """Return the study as plain values, with ranges and units in canonical form."""
        content = self.model_dump(exclude_none=True, exclude={"parameters"})
        content["parameters"] = {name: values.canonical() for name, values in self.values().items()}
        return content

    def without_defaults(self) -> dict[str, Any]:
        """Return the kind and the content without the fields that have their default values."""
        fields = type(self).model_fields
        return {
            name: value
            for name, value in self.content().items()
            if name == "kind" or name not in fields or value != fields[name].get_default()
        }

    def __repr__(self) -> str:
        """Return the study as the Python call that makes it, without defaults."""
        words = (
            f"{name}={value!r}" for name, value in self.without_defaults().items() if name != "kind"
        )
        return f"{type(self).__name__}({', '.join(words)})"

    __str__ = __repr__

    def _repr_html_(self) -> str:
        """Return the study as an HTML table for notebooks, a row for each field that is set."""
        rows: list[tuple[str, object]] = []
        for name, value in self.without_defaults().items():
            section = value.items() if isinstance(value, dict) else None
            rows += (
                [(f"{name}.{key}", entry) for key, entry in section] if section else [(name, value)]
            )
        cells = "".join(
            f"<tr><td>{html.escape(name)}</td><td>{html.escape(str(value))}</td></tr>"
            for name, value in rows
        )
        return f"<table>{cells}</table>"

    def canonical(self) -> str:
        """Return the study as canonical JSON: equal studies give equal texts."""
        return json.dumps(
            self.content(), separators=(",", ":"), ensure_ascii=False, allow_nan=False
        )

    def key(self) -> str:
        """Return the SHA-256 of the canonical JSON, in hexadecimal."""
        return hashlib.sha256(self.canonical().encode()).hexdigest()


class DrivenStudy(Study):
    """The further fields of studies of motion in time: a drive that may have been measured."""

    drive: Drive = Field(
        None,
        description="A measured drive: the recording of an accelerometer. Its harmonics are "
        "parameters, as far as the study does not give them itself.",
    )
