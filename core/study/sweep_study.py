"""The study of closed forms over a grid."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, field_validator

from vibrafeed.core.study.grid_study import MAX_OUTPUTS, OutputNames, Study
from vibrafeed.core.study.reduction import Reduction
from vibrafeed.core.study.sensitivities import Sensitivities


class SweepStudy(Study):
    """Closed-form equations of one scene over a grid of parameters."""

    kind: Literal["sweep"] = Field(description="The kind of study.")
    variant: str | None = Field(
        None,
        description="thesis (as printed), derived (errors corrected) or physical; the scene's "
        "default where left out.",
        max_length=100,
    )
    outputs: OutputNames = Field(
        description="Names of the outputs.", min_length=1, max_length=MAX_OUTPUTS
    )
    sensitivities: Sensitivities = None
    precision: Literal["double", "single"] | None = Field(
        None,
        description="double (64-bit floats, the default) or single: values are computed in double "
        "and stored in 32 bits, half the bytes, each rounded once more by at most 6e-8 of itself.",
    )
    reduce: Reduction | None = Field(
        None, description="Statistics over some axes instead of all cells: docs/reduce.md."
    )

    @field_validator("precision")
    @classmethod
    def _double_is_nothing(cls, value: str | None) -> str | None:
        """Drop the default precision, so that equal studies agree."""
        return None if value == "double" else value
