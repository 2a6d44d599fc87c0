"""The description of a sweep in the service: its study, size, axes, outputs."""

from __future__ import annotations

from pydantic import BaseModel, Field

from vibrafeed.app.web.replies import Document


class SweepAxis(BaseModel):
    """An axis of a sweep."""

    name: str
    unit: str
    size: int


class SweepOutput(BaseModel):
    """An output of a sweep, with the axes that it depends on."""

    name: str
    unit: str
    label: str
    dims: list[str]
    source: str | None


class SweepDescription(BaseModel):
    """The description of a sweep."""

    id: str
    study: Document
    scene: str
    variant: str
    validity: str
    cells: int
    bytes: int
    axes: list[SweepAxis]
    outputs: list[SweepOutput]
    regimes: list[str]
    shared: bool
    links: dict[str, str]
    warnings: list[str] = Field(
        default=[], description="Of unusual values, in the reply to a study that was sent"
    )
