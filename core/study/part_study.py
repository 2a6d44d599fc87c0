"""The part of a study that comes from a file: what a user writes of it, and what is kept."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, ConfigDict, Field, WithJsonSchema

from vibrafeed.core.quantities.orienting import MAX_ASPECTS, PartAspect
from vibrafeed.core.study.grid_study import CARRY_OUT, FromFile

UNITS: Final[Mapping[str, float]] = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "inch": 0.0254, "in": 0.0254}
"""The units of coordinates, in metres."""
MAX_TEXT = 70_000_000
MAX_CORNERS = 1_000  # of a surface that pictures show
_Vector = tuple[float, float, float]
_Corner = Annotated[int, Field(ge=0, lt=MAX_CORNERS)]


class PartFile(BaseModel):
    """A file with the surface of a part, from which follows how it lies."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    file: Path | None = Field(
        None,
        description="Its STL, OBJ, PLY or STEP file, in the study's folder; over HTTP give data "
        "instead.",
    )
    data: str | None = Field(
        None,
        description="The text of an ASCII STL, OBJ or STEP file, or a binary STL file in Base64.",
        max_length=MAX_TEXT,
    )
    unit: Literal["mm", "cm", "m", "inch", "in"] | None = Field(
        None,
        description="Unit of the coordinates of an STL, OBJ or PLY file, which does not say it; a "
        "STEP file says its own.",
    )


class PartOfFile(BaseModel):
    """The numbers of a part from a file, in metres, which stand in the file's place.

    Its `inertia` is that of a part of density 1, about the centre of mass.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True, allow_inf_nan=False)

    name: str = Field(description="Name of the file.", max_length=300)
    sha256: str = Field(description="SHA-256 of the file's content.", pattern="^[0-9a-f]{64}$")
    volume: float = Field(description="Volume [m3].", gt=0)
    centre: _Vector = Field(description="Centre of mass, in the axes of the file [m].")
    inertia: tuple[_Vector, _Vector, _Vector] = Field(
        description="Moments of inertia about the centre of mass over the density [m5]."
    )
    aspects: Annotated[
        tuple[PartAspect, ...], WithJsonSchema({"type": "array", "items": {"type": "object"}})
    ] = Field(
        description="The ways in which it lies, the lowest centre of mass first.",
        min_length=1,
        max_length=MAX_ASPECTS,
    )
    corners: tuple[_Vector, ...] = Field(
        description="Of its surface, or of its hull, from the centre of mass [m]: for pictures.",
        max_length=MAX_CORNERS,
    )
    triangles: tuple[tuple[_Corner, _Corner, _Corner], ...] = Field(
        description="The numbers of their corners, from 0.", max_length=2 * MAX_CORNERS
    )


Part = Annotated[
    PartOfFile | None,
    FromFile(
        PartFile,
        PartOfFile,
        ("its file has not been read yet", CARRY_OUT),
        (
            "does not say how to read a part",
            'Write [part] with file = "bracket.stl" and unit = "mm"',
        ),
    ),
]
PART: Final[Any] = Field(
    None, description="A part from a file, for the variant mesh of resting-part, orienting-line."
)
"""The field of studies that may have one."""
