"""The study of outputs over parameters that are not known exactly, at each point of a grid."""

from typing import Annotated, ClassVar, Literal

from pydantic import AfterValidator, Field, field_validator

from vibrafeed.core.study.distributions import Distribution, Uncertain
from vibrafeed.core.study.grid_study import (
    MAX_OUTPUTS,
    DrivenStudy,
    Frozen,
    OpenLevel,
    OutputName,
    OutputNames,
    at_most,
    first_paths,
    parameters_in,
    refusal,
)
from vibrafeed.core.study.part_study import PART, Part

FEWEST_SAMPLES, MAX_SAMPLES = 256, 1 << 20
MAX_DEMANDS = 20
MAX_QUANTILES = 100
ANALYSES = ("distribution", "sobol", "budget")
Analysis = Literal["distribution", "sobol", "budget"]


class Demand(Frozen):
    """A demand on a part: an output within bounds, or a regime; the result is its probability."""

    output: OutputName | None = Field(None, description="The output.")
    at_least: OpenLevel = Field(None, description="Smallest acceptable value.")
    at_most: OpenLevel = Field(None, description="Largest acceptable value.")
    regime: str | None = Field(
        None, description="A regime instead of an output, such as hopping.", max_length=100
    )

    @property
    def name(self) -> str:
        """The name of the demand's probability in the result: its regime, or output and bound."""
        if self.regime is not None:
            return self.regime
        ends = [end for end in ("at_least", "at_most") if getattr(self, end) is not None]
        return f"{self.output}_{ends[0] if len(ends) == 1 else 'between'}"


class SensitivityStudy(DrivenStudy):
    """A study of outputs that vary with uncertain parameters, over a grid of the others."""

    bands_section: ClassVar[str] = "uncertain"
    kind: Literal["sensitivity"] = Field(description="The kind of study.")
    variant: str | None = Field(
        None,
        description="thesis (as printed), derived (errors corrected) or physical, of closed forms; "
        "the scene's default where left out.",
        max_length=100,
    )
    part: Part = PART
    method: str | None = Field(
        None,
        description="The method of motion in time, as in a simulation, where outputs are those of "
        "a motion.",
        max_length=100,
    )
    outputs: OutputNames = Field(
        description="Names of the outputs.", min_length=1, max_length=MAX_OUTPUTS
    )
    uncertain: Uncertain | None = Field(
        None,
        description="Parameters that are not known exactly, and their distributions; a range with "
        "low and high among the parameters is a uniform one.",
    )
    analyses: Annotated[
        tuple[Analysis, ...],
        at_most(len(ANALYSES)),
        AfterValidator(lambda names: tuple(name for name in ANALYSES if name in names)),
    ] = Field(
        ("distribution", "sobol", "budget"),
        description="The analyses: distribution (mean, standard deviation, quantiles, demands), "
        "sobol (share of the variance from each parameter), budget (effect of each tolerance).",
        min_length=1,
    )
    demands: Annotated[tuple[Demand, ...], at_most(MAX_DEMANDS)] = Field(
        (),
        description="Outputs within bounds, or regimes, whose probability is computed.",
        max_length=MAX_DEMANDS,
    )
    quantiles: Annotated[tuple[float, ...], at_most(MAX_QUANTILES)] = Field(
        (0.05, 0.5, 0.95),
        description="Shares of the parts; the result has the value that this share stays below.",
        min_length=1,
        max_length=MAX_QUANTILES,
    )
    samples: int = Field(
        4096,
        description="Number of points sampled from the distributions for each "
        "design, a power of two; Sobol "
        "indices take as many again for each parameter, and once more.",
        strict=True,
        ge=FEWEST_SAMPLES,
        le=MAX_SAMPLES,
    )
    seed: int = Field(0, description="Seed of the sampled points.", strict=True, ge=0, le=2**31 - 1)

    @field_validator("samples")
    @classmethod
    def _power_of_two(cls, value: int) -> int:
        if value & (value - 1):
            below = 1 << (value.bit_length() - 1)
            raise refusal(
                f"samples is {value:,}, which is not a power of two",
                f"Give {below:,} or {2 * below:,}",
            )
        return value

    @field_validator("analyses", mode="before")
    @classmethod
    def _without_morris(cls, value: object) -> object:
        if isinstance(value, list | tuple) and "morris" in value:
            raise refusal(
                "Morris's screening is no longer an analysis",
                "Write sobol (shares of the variance) or budget (the effect of each tolerance)",
            )
        return value

    @field_validator("quantiles")
    @classmethod
    def _ascending(cls, value: tuple[float, ...]) -> tuple[float, ...]:
        outside = [quantile for quantile in value if not 0 < quantile < 1]
        if outside:
            raise refusal(
                f"the quantile {outside[0]:g} is not between 0 and 1",
                "Write quantiles as shares, such as 0.05 for five per cent",
            )
        if list(value) != sorted(set(value)):
            raise refusal("they do not ascend", "Sort them, each once")
        return value

    def distributions(self) -> dict[str, Distribution]:
        """Return the uncertain parameters with their distributions, in order."""
        return parameters_in(self.uncertain)

    def asked(self) -> tuple[str, ...]:
        """Return every output that is needed, those of demands last."""
        demanded = (demand.output for demand in self.demands if demand.output is not None)
        return tuple(dict.fromkeys((*self.outputs, *demanded)))

    def places(self) -> dict[str, str]:
        """Return the paths of parameters outside `parameters`."""
        return {name: f"uncertain.{name}" for name in self.distributions()}

    def output_places(self) -> dict[str, str]:
        """Return the paths of outputs that stand in demands, by output, for messages."""
        return first_paths(
            (demand.output, f"demands.{number}.output")
            for number, demand in enumerate(self.demands)
            if demand.output is not None and demand.output not in self.outputs
        )
