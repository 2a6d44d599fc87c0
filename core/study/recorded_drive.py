"""The drive of a study that has been measured: what a user writes of it, and what is kept."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, WithJsonSchema
from pydantic_core import PydanticCustomError

from vibrafeed.core.errors import Problem

_TEXT = {"type": "string", "maxLength": 200}
_NUMBER = {"anyOf": [{"type": "number"}, _TEXT]}
_TRIPLE = {"type": "array", "minItems": 3, "maxItems": 3}
_MOUNTING = {
    "anyOf": [
        {**_TRIPLE, "items": _NUMBER},
        {**_TRIPLE, "items": {**_TRIPLE, "items": {"type": "number"}}},
    ]
}
_Column = Annotated[str, Field(max_length=200)]
# As a user writes them: whoever reads the recording reads these, and says what is wrong.
_Number = Annotated[Any, WithJsonSchema(_NUMBER)]
_Mounting = Annotated[Any, WithJsonSchema(_MOUNTING)]
_Count = Annotated[Any, WithJsonSchema({"type": "integer", "minimum": 1, "maximum": 10})]
_Finite = Annotated[float, Field(allow_inf_nan=False)]
_Share = Annotated[_Finite, Field(ge=0)]


class RecordedDrive(BaseModel):
    """A recording of an accelerometer, whose harmonics become parameters of the study."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    file: Path | None = Field(
        None, description="Its CSV file, in the study's folder; over HTTP give data instead."
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
        None, description="Of the columns, where their headers do not say: g, mg, m s-2, mm s-2."
    )
    rate: _Number = Field(None, description="Samples per second, if there is no time column.")
    time: _Column | None = Field(None, description="Time column; time or t is found automatically.")
    line_frequency: _Number = Field(
        None, description="True frequency of the drive; shows the error of the recorder's clock."
    )
    frequency: _Number = Field(
        None,
        description="Approximate frequency of the motion [Hz]; found automatically by default.",
    )
    harmonics: _Count = Field(
        None,
        description="Number of harmonic orders to fit; by default as many as the data support.",
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


def only_the_plain_sine(fix: str) -> Problem:
    """Return the problem of a measured drive in a study of closed forms; `fix` says the way out."""
    return Problem(
        "drive", "closed forms support only the plain sine of amplitude, alpha and beta", fix
    )


def names_recording(content: object) -> bool:
    """True if a study's content names a recording that has not been fitted."""
    drive = content.get("drive") if isinstance(content, Mapping) else None
    return isinstance(drive, Mapping) and "sha256" not in drive


def _fitted(raw: object) -> object:
    problem = None
    if isinstance(raw, Mapping) and "sha256" not in raw:
        problem = {
            "message": "its recording has not been fitted yet",
            "fix": "Carry the study out, or load it by vibrafeed.load_study",
        }
    elif not isinstance(raw, Mapping | MeasuredDrive | None):
        problem = {
            "message": f"{str(raw)[:40]!r} does not say how to read a recording",
            "fix": 'Write [drive] with file = "recording.csv" and the columns along and normal',
        }
    if problem is not None:
        raise PydanticCustomError("value", "{message}", problem)
    return raw


class _Written:
    """The JSON Schema of a study's `drive`, made when it is asked for."""

    def __get_pydantic_json_schema__(self, schema: object, handler: object) -> dict[str, Any]:
        del schema, handler
        source = {"oneOf": [{"required": ["file"]}, {"required": ["data"]}]}
        either = [
            RecordedDrive.model_json_schema() | source,
            MeasuredDrive.model_json_schema(),
            {"type": "null"},
        ]
        return {"anyOf": either, "default": None}


Drive = Annotated[MeasuredDrive | None, BeforeValidator(_fitted), _Written()]
