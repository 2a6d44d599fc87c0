"""The study of the best values of some parameters over a grid of the others."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field

from vibrafeed.core.quantities import Quantity
from vibrafeed.core.study.distributions import Distribution, Uncertain
from vibrafeed.core.study.grid_study import (
    DRIVE_ANGLES,
    MAX_OUTPUTS,
    NUMBER,
    DrivenStudy,
    Frozen,
    Level,
    OpenLevel,
    OutputName,
    OutputNames,
    at_most,
    by_parameter,
    first_paths,
    parameters_in,
)
from vibrafeed.core.study.part_study import PART, Part
from vibrafeed.core.study.values import Between, read_between


class _TwoOutputs(Frozen):
    output: OutputName = Field("acceleration_x", description="The output to maximise.")
    against: OutputName = Field(
        "acceleration_y", description="The output whose absolute value is to be small."
    )


class Weighted(_TwoOutputs):
    """The largest of the output less `weight` times the other's absolute value."""

    kind: Literal["weighted"] = "weighted"
    weight: float = Field(
        1.0, description="Weight of the other output.", strict=True, ge=0, allow_inf_nan=False
    )


class Limited(_TwoOutputs):
    """The largest output with the other's absolute value within a limit."""

    kind: Literal["limit"] = "limit"
    limit: Level = Field(description="Largest absolute value of the other output.")


class Pareto(_TwoOutputs):
    """The whole trade-off: what no other choice beats in both outputs."""

    kind: Literal["pareto"] = "pareto"
    points: int = Field(200, description="Number of points of the front.", ge=2, le=10_000)


class Maximise(Frozen):
    """The largest value of one output."""

    kind: Literal["maximise"] = "maximise"
    output: OutputName = Field("acceleration_x", description="The output.")


class Minimise(Frozen):
    """The least value of one output."""

    kind: Literal["minimise"] = "minimise"
    output: OutputName = Field("acceleration_x", description="The output.")


class Target(Frozen):
    """The value nearest to a target."""

    kind: Literal["reach"] = "reach"
    output: OutputName = Field("conveying_velocity", description="The output.")
    target: Level = Field(description="The value that the output is to reach.")


Criterion = Weighted | Limited | Pareto | Maximise | Minimise | Target
"""The criterion: which output is maximised or minimised."""


class OutputLimit(Frozen):
    """Bounds that an output has to keep."""

    output: OutputName = Field(description="The output.")
    lower: OpenLevel = Field(None, description="Smallest allowed value of the output.")
    upper: OpenLevel = Field(None, description="Largest allowed value of the output.")
    absolute: bool = Field(
        False, description="True if the bounds apply to the output's absolute value."
    )

    def ends(self) -> Iterable[tuple[str, float]]:
        """Yield name and value of each bound of the constraint: lower, upper or both.

        Names are ``<output>_lower`` and ``<output>_upper``; values are in the unit of studies.
        """
        name = f"{self.output}_absolute" if self.absolute else self.output
        if self.lower is not None:
            yield f"{name}_lower", self.lower
        if self.upper is not None:
            yield f"{name}_upper", self.upper


MAX_CONSTRAINTS = 20


def _bounds_schema(quantity: Quantity) -> dict[str, Any]:
    return {
        "title": quantity.label,
        "description": f"Bounds of the {quantity.label.lower()}, both included.",
        "type": "object",
        "properties": {"lower": NUMBER, "upper": NUMBER},
        "required": ["lower", "upper"],
        "additionalProperties": False,
    }


if TYPE_CHECKING:
    Variables = Frozen

else:
    Variables = by_parameter(
        "Variables",
        "Variables of the optimisation: parameters and their bounds.",
        read_between,
        _bounds_schema,
    )


ANGLES = {name: Between(0.0, 90.0) for name in DRIVE_ANGLES}
"""The variables of a study that names none."""


class OptimiseStudy(DrivenStudy):
    """The best values of some parameters, over a grid of the others."""

    bands_section: ClassVar[str] = "uncertain"
    kind: Literal["optimise"] = Field(description="The kind of study.")
    variant: str | None = Field(
        None,
        description="thesis (as printed), derived (errors corrected) or physical; the scene's "
        "default where left out.",
        max_length=100,
    )
    part: Part = PART
    method: str | None = Field(
        None,
        description="The optimiser; by default the exact answer if there is one, else the "
        "optimiser that was measured to be best.",
        max_length=100,
    )
    variables: Variables | None = Field(
        None,
        description="The variables with their bounds; alpha and beta from 0 to 90 degrees where "
        "left out, as far as they are not given and the outputs depend on them.",
    )
    criterion: Criterion = Field(
        description="The criterion: which output is maximised or minimised.", discriminator="kind"
    )
    constraints: Annotated[tuple[OutputLimit, ...], at_most(MAX_CONSTRAINTS)] = Field(
        (), description="Constraints: bounds that outputs must keep.", max_length=MAX_CONSTRAINTS
    )
    floor_contact: bool = Field(
        True, description="True if the part must stay on the floor, if the scene has one."
    )
    wall_contact: bool = Field(
        True, description="True if the part must stay on the wall, if the scene has one."
    )
    uncertain: Uncertain | None = Field(
        None,
        description="Parameters that are not known exactly, such as friction: their bounds, or "
        "their distributions; a range with low and high among the parameters is one of them.",
    )
    robust: Literal["worst", "mean", "quantile"] | None = Field(
        None,
        description="The aim under them: the best worst case (the default), the best mean, or "
        "the best quantile.",
    )
    quantile: float | None = Field(
        None,
        description="The quantile, 0 to 1, of the output that is optimised.",
        strict=True,
        gt=0,
        lt=1,
    )
    sensitivities: bool = Field(
        False,
        description="True to compute d ln(output)/d ln(parameter) at each optimum.",
        strict=True,
    )
    outputs: OutputNames = Field(
        (), description="Further outputs to compute at the optimum.", max_length=MAX_OUTPUTS
    )

    def intervals(self) -> dict[str, Distribution]:
        """Return the uncertain parameters with their distributions."""
        return parameters_in(self.uncertain)

    def bounds(self) -> dict[str, Between]:
        """Return the variables of the optimisation with their bounds, in the parameters' order."""
        return parameters_in(self.variables)

    def criterion_outputs(self) -> tuple[str, ...]:
        """Return the outputs in the criterion."""
        against = getattr(self.criterion, "against", None)
        return (self.criterion.output, *((against,) if against else ()))

    def places(self) -> dict[str, str]:
        """Return the paths of parameters outside `parameters`."""
        return {name: f"variables.{name}" for name in self.bounds()}

    def output_places(self) -> dict[str, str]:
        """Return the paths of outputs in constraints, else in the criterion, for messages."""
        in_criterion = zip(self.criterion_outputs(), ("output", "against"), strict=False)
        return first_paths(
            (
                *(
                    (constraint.output, f"constraints.{number}.output")
                    for number, constraint in enumerate(self.constraints)
                ),
                *((name, f"criterion.{key}") for name, key in in_criterion),
            )
        )
