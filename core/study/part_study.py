"""The part of a study that comes from a file: what a user writes of it, and what is kept."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from vibrafeed.core.quantities.orienting import MAX_ASPECTS, PartAspect
from vibrafeed.core.study.grid_study import refusal

UNITS: Final[Mapping[str, float]] = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "inch": 0.0254, "in": 0.0254}
"""The units of coordinates, in metres."""
MAX_TEXT, MAX_CORNERS = 70_000_000, 500
_Vector = tuple[float, float, float]


class PartFile(BaseModel):
    """A file with the surface of a part, from which follows how it lies."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    file: Path | None = Field(
        None,
        description="Its STL, OBJ or PLY file, in the study's folder; over HTTP give data instead.",
    )
    data: str | None = Field(
        None,
        description="The text of an ASCII STL or OBJ file, or a binary STL file in Base64.",
        max_length=MAX_TEXT,
    )
    unit: Literal["mm", "cm", "m", "inch", "in"] = Field(
        description="Unit of the coordinates, which the file does not say."
    )


class PartOfFile(BaseModel):
    """The numbers of a part from a file, in metres, which stand in the file's place.

    Its `inertia` is that of a part of density 1, about the centre of mass.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    name: str = Field(description="Name of the file.", max_length=300)
    sha256: str = Field(description="SHA-256 of the file's content.", pattern="^[0-9a-f]{64}$")
    volume: float = Field(description="Volume [m3].", gt=0)
    centre: _Vector = Field(description="Centre of mass, in the axes of the file [m].")
    inertia: tuple[_Vector, _Vector, _Vector] = Field(
        description="Moments of inertia about the centre of mass over the density [m5]."
    )
    aspects: tuple[PartAspect, ...] = Field(
        description="The ways in which it lies, the lowest centre of mass first.",
        min_length=1,
        max_length=MAX_ASPECTS,
    )
    corners: tuple[_Vector, ...] = Field(
        description="Corners of its hull, from the centre of mass [m].", max_length=MAX_CORNERS
    )


def _was_read(raw: object) -> object:
    if raw is None or isinstance(raw, PartOfFile) or (isinstance(raw, Mapping) and "sha256" in raw):
        return raw
    if isinstance(raw, Mapping):
        raise refusal(
            "its file has not been read yet",
            "Carry the study out, or load it by vibrafeed.load_study",
        )
    raise refusal(
        f"{str(raw)[:40]!r} does not say how to read a part",
        'Write [part] with file = "bracket.stl" and unit = "mm"',
    )


class _Written:
    """The JSON Schema of a study's `part`, made when it is asked for."""

    def __get_pydantic_json_schema__(self, *_: object) -> dict[str, Any]:
        source = {"oneOf": [{"required": ["file"]}, {"required": ["data"]}]}
        kept = PartOfFile.model_json_schema()
        kept["properties"]["aspects"]["items"] = kept.pop("$defs")["PartAspect"]
        return {
            "anyOf": [PartFile.model_json_schema() | source, kept, {"type": "null"}],
            "default": None,
        }


Part = Annotated[PartOfFile | None, BeforeValidator(_was_read), _Written()]
PART: Final[Any] = Field(
    None, description="A part from a file, for the variant mesh of resting-part, orienting-line."
)
"""The field of studies that may have one."""
