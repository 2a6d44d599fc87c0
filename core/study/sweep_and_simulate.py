"""The study of motion in time over a grid."""

import reprlib
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import AliasChoices, Field, PlainValidator, WithJsonSchema

from vibrafeed.core.study.grid_study import (
    MAX_OUTPUTS,
    DrivenStudy,
    Frozen,
    OutputNames,
    Study,
    refusal,
)
from vibrafeed.core.study.part_study import PART, Part
from vibrafeed.core.study.reduction import Reduction

# --- The key `sensitivities` of sweeps and simulations: what outputs are derived by.


MAX_PARAMETERS = 30


def _read_sensitivities(raw: object) -> bool | tuple[str, ...] | None:
    if raw is None or isinstance(raw, bool):
        return raw or None
    names = tuple(raw) if isinstance(raw, list | tuple) else ()
    if 0 < len(names) <= MAX_PARAMETERS and all(isinstance(name, str) for name in names):
        return tuple(dict.fromkeys(names))
    raise refusal(
        f"{reprlib.repr(raw)[:40]} is neither true nor a list of parameter names",
        'Write true for all parameters that the study gives, or a list such as ["friction"]',
    )


Sensitivities = Annotated[
    bool | tuple[str, ...] | None,
    PlainValidator(_read_sensitivities),
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "boolean"},
                {
                    "type": "array",
                    "items": {"type": "string", "maxLength": 100},
                    "minItems": 1,
                    "maxItems": MAX_PARAMETERS,
                },
                {"type": "null"},
            ]
        }
    ),
    Field(
        description="Also give the derivative of each output by these parameters, and its "
        "elasticity d ln(output)/d ln(parameter): true for all that the study gives, or a list of "
        "names."
    ),
]

MAX_SAMPLES = 100_000
LATEST = 1e6  # s, latest time of a trajectory: eleven days, to which floats resolve a microsecond


def _are_times(raw: Sequence[object]) -> bool:
    numbers = [x for x in raw if isinstance(x, int | float) and not isinstance(x, bool)]
    if not 0 < len(raw) <= MAX_SAMPLES or len(numbers) < len(raw):
        return False
    rises = all(before < after for before, after in pairwise(numbers))
    return rises and numbers[0] >= 0 and numbers[-1] <= LATEST


def _read_trajectory(raw: object) -> int | tuple[float, ...] | None:
    is_whole_number = isinstance(raw, int) and not isinstance(raw, bool)
    if raw is None or (is_whole_number and 2 <= raw <= MAX_SAMPLES):  # type: ignore[operator]
        return raw  # type: ignore[return-value]
    if isinstance(raw, list | tuple) and _are_times(raw):
        return tuple(float(number) for number in raw)
    raise refusal(
        f"{reprlib.repr(raw)[:40]} is neither a number of steps nor a list of times",
        f"Write a whole number from 2 to {MAX_SAMPLES:,}, or times in seconds that rise"
        " from 0 or later",
    )


FEWEST_PERIODS = 8  # fewer do not show whether a motion repeats over several periods
MAX_PERIODS = 100_000  # half an hour at 50 Hz: a motion that has not repeated by then will not
SETTINGS = ("tolerance", "max_periods")


class FollowedStudy(DrivenStudy):
    """The fields of studies that follow a part in time."""

    method: str | None = Field(
        None,
        description="events (from event to event, exact) or reference (of high order, slow, to "
        "check events); events where left out.",
        max_length=100,
    )


class MotionSettings(Frozen):
    """The settings of methods."""

    # Near 100 roundings of a state nothing is told apart any more, and integrators give up.
    tolerance: float | None = Field(
        None,
        description="Largest accepted error of a periodic motion, relative to the motion of the "
        "drive. From 0.001 on, the method events simulates an aperiodic motion in the plane only "
        "until its mean velocity has this relative error.",
        strict=True,
        ge=1e-13,
        le=1,
    )
    max_periods: int | None = Field(
        None,
        description="Maximum number of drive periods that are simulated for one set of values.",
        strict=True,
        ge=FEWEST_PERIODS,
        le=MAX_PERIODS,
        validation_alias=AliasChoices("max_periods", "most_periods"),  # as it was called before
    )

    def settings(self) -> dict[str, float]:
        """Return the settings in the study, by their names as quantities."""
        return {n: float(one) for n in SETTINGS if (one := getattr(self, n)) is not None}


class _Asked(FollowedStudy):
    outputs: OutputNames = Field(
        ("conveying_velocity",),
        description="Names of the outputs.",
        min_length=1,
        max_length=MAX_OUTPUTS,
    )
    sensitivities: Sensitivities = None


class SimulateStudy(MotionSettings, _Asked):
    """Motion in time of one scene over a grid of parameters."""

    kind: Literal["simulate"] = Field(description="The kind of study.")
    trajectory: Annotated[
        int | tuple[float, ...] | None,
        PlainValidator(_read_trajectory),
        WithJsonSchema(
            {
                "anyOf": [
                    {"type": "integer", "minimum": 2, "maximum": MAX_SAMPLES},
                    {
                        "type": "array",
                        "items": {"type": "number", "minimum": 0},
                        "minItems": 1,
                        "maxItems": MAX_SAMPLES,
                    },
                    {"type": "null"},
                ]
            }
        ),
    ] = Field(
        None,
        description="Also give the motion in time of the one point of the study: at this number of "
        "equal steps of its cycle, or at these times in seconds since the start of a period.",
    )
    reduce: Reduction | None = Field(
        None, description="Statistics over some axes instead of all cells: docs/scale.md."
    )


# --- The study of closed forms over a grid.


class SweepStudy(Study):
    """Closed-form equations of one scene over a grid of parameters."""

    kind: Literal["sweep"] = Field(description="The kind of study.")
    variant: str | None = Field(
        None,
        description="thesis (as printed), derived (errors corrected) or physical; the scene's "
        "default where left out.",
        max_length=100,
    )
    part: Part = PART
    outputs: OutputNames = Field(
        description="Names of the outputs.", min_length=1, max_length=MAX_OUTPUTS
    )
    sensitivities: Sensitivities = None
    reduce: Reduction | None = Field(
        None, description="Statistics over some axes instead of all cells: docs/scale.md."
    )
