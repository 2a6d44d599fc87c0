"""The study of what measured speeds tell of parameters that nobody knows."""

from __future__ import annotations

import reprlib
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    AliasChoices,
    BeforeValidator,
    Field,
    WithJsonSchema,
    create_model,
)

from vibrafeed.core.quantities import QUANTITIES, Quantity
from vibrafeed.core.study.distributions import Normal, read_distribution
from vibrafeed.core.study.grid_study import PARAMETERS, Frozen, Parameters
from vibrafeed.core.study.levels import optional, refusal
from vibrafeed.core.study.observations import ROWS_SCHEMA, Run, parameters_of, spread_rows
from vibrafeed.core.study.simulate_study import FollowedStudy, MotionSettings
from vibrafeed.core.study.units import UnitError
from vibrafeed.core.study.values import Between, Values

STEMS = {"unknowns": "", "offsets": "offset_", "factors": "factor_"}
"""The tables of a study that hold unknowns, and the prefix of their names in results."""
Prior = Between | Normal
"""What is known of an unknown before: bounds, or a normal distribution that bounds may cut."""
FEWEST_POINTS, POINTS, MAX_POINTS = 1_000, 20_000, 1_000_000
"""Grid points of the unknowns: fewest, default and most."""

_SINGLE = {"anyOf": [{"type": "number"}, {"type": "string", "maxLength": 200}]}
_PRIOR_SCHEMA = {
    "type": "object",
    "properties": dict.fromkeys(("lower", "upper", "mean", "deviation"), _SINGLE),
    "anyOf": [{"required": ["lower", "upper"]}, {"required": ["mean", "deviation"]}],
    "additionalProperties": False,
}


def quantity_of(table: str, parameter: str) -> Quantity:
    """Return the declaration of an unknown of a calibration, with its unit and bounds.

    `table` is "unknowns" for the parameter itself, "offsets" for what is added to it, in the same
    unit and of any sign, or "factors" for what it is multiplied by, without unit. `parameter` is
    its name.
    """
    quantity = QUANTITIES[parameter]
    if table == "unknowns":
        return quantity
    free = replace(quantity, lower=-float("inf"), upper=float("inf"), strict=False)
    return free if table == "offsets" else replace(free, unit="1", lower=0.0, examples=("1.1",))


def _read_prior(table: str, parameter: str, raw: object) -> Prior:
    """Return the prior that a user wrote of an unknown: a range or a normal distribution.

    The prior is what is known before a calibration. `table` is "unknowns", "offsets" or "factors",
    and `parameter` the name in it. Raises `UnitError` for anything else.
    """
    of = {"offsets": "the offset of ", "factors": "the factor of "}.get(table, "")
    prior = read_distribution(of + parameter, raw, quantity_of(table, parameter))
    if not isinstance(prior, Prior):
        message = f"what is known of {of}{parameter} is neither a range nor a normal distribution"
        raise UnitError(
            message, "Write { lower = ..., upper = ... }, or { mean = ..., deviation = ... }"
        )
    return prior


def _table(table: str, doc: str) -> Any:
    """Return the pydantic model of a table of unknowns, with a field for each parameter.

    `table` is its name, `doc` the description in the schema.
    """
    fields = {
        name: optional(partial(_read_prior, table, name), lambda: _PRIOR_SCHEMA)
        for name in PARAMETERS
    }
    return create_model(table.capitalize(), __base__=Frozen, __doc__=doc, **fields)


if TYPE_CHECKING:

    class Unknowns(Frozen):
        """One optional field a parameter quantity."""

    class Offsets(Frozen):
        """One optional field a parameter quantity."""

    class Factors(Frozen):
        """One optional field a parameter quantity."""

else:
    Unknowns = _table("unknowns", "The unknown parameters, each with a range or a distribution.")
    Offsets = _table(
        "offsets", "Unknown offsets that are added to parameters, such as the error of an angle."
    )
    Factors = _table(
        "factors", "Unknown factors by which parameters, such as amplitudes, are multiplied."
    )


def _read_probability(raw: object) -> object:
    """Return a probability below 0.5; raise a refusal for anything else.

    It is that of an observed regime being wrong, as a user wrote it.
    """
    if isinstance(raw, int | float) and not isinstance(raw, bool) and 0 < raw < 0.5:
        return float(raw)
    fix = "Write a number above 0 and below 0.5, such as 0.01"
    raise refusal(
        f"{reprlib.repr(raw)[:40]} is not a probability between 0 and 0.5 that an observed "
        f"regime is wrong",
        fix,
    )


_PROBABILITY_SCHEMA = {"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 0.5}


class CalibrateStudy(MotionSettings, FollowedStudy):
    """A study that estimates unknown parameters from measured speeds."""

    kind: Literal["calibrate"] = Field(description="The kind of study.")
    observations: Annotated[
        tuple[Run, ...], BeforeValidator(spread_rows), WithJsonSchema(ROWS_SCHEMA)
    ] = Field(
        description="The runs: what differs between them, and what was measured; or the name of a "
        "CSV or XLSX file in the study's folder.",
        min_length=1,
    )
    error: float | Annotated[str, Field(max_length=200)] | None = Field(
        None,
        description="Standard deviation of the measured values, for runs that do not give their "
        "own: a number, text with a unit, or a share such as '5 %'.",
    )
    unknowns: Unknowns | None = Field(
        None,
        description="The unknown parameters: { lower, upper }, or { mean, deviation }.",
    )
    offsets: Offsets | None = Field(
        None, description="Unknown offsets of parameters, such as the mounting error of an angle."
    )
    factors: Factors | None = Field(
        None, description="Unknown factors of parameters, such as that of all amplitudes."
    )
    candidates: Parameters | None = Field(
        None,
        description="Drives that could be run next, as values or ranges; the result says which of "
        "them would add most.",
    )
    discrepancy: bool = Field(
        True,
        description="True if speeds may scatter by more than their errors, for effects that the "
        "model lacks.",
        strict=True,
    )
    outlier_probability: Annotated[
        float, BeforeValidator(_read_probability), WithJsonSchema(_PROBABILITY_SCHEMA)
    ] = Field(
        0.01,
        description="Probability that an observed regime is wrong.",
        validation_alias=AliasChoices("outlier_probability", "doubt"),  # as it was called before
    )
    points: int = Field(
        POINTS,
        description="Maximum number of grid points of the unknowns; each needs one motion per run.",
        strict=True,
        ge=FEWEST_POINTS,
        le=MAX_POINTS,
    )

    def priors(self) -> dict[str, Prior]:
        """Return the priors of all unknowns by name, such as ``friction`` or ``offset_beta``.

        A prior is what is known of an unknown before the calibration.
        """
        priors_of: dict[str, Prior] = {}
        for table in STEMS:
            given = getattr(self, table)
            if given is not None:
                names = [name for name in PARAMETERS if name in given.model_fields_set]
                priors_of |= {STEMS[table] + name: getattr(given, name) for name in names}
        return priors_of

    def asked_next(self) -> dict[str, Values]:
        """Return the parameters of candidate runs, among which the next one to measure is chosen.

        Empty if the study has no candidates.
        """
        if self.candidates is None:
            return {}
        given = self.candidates.model_fields_set
        return {name: getattr(self.candidates, name) for name in PARAMETERS if name in given}

    def places(self) -> dict[str, str]:
        """Return the paths of parameters that stand in measured runs or among the unknowns.

        They serve messages about a parameter.

        A parameter in both has the path in the runs.
        """
        origins: dict[str, str] = {}
        for run in self.observations:
            origins |= {name: f"observations, {name}" for name in parameters_of(run)}
        for table in STEMS:
            given = getattr(self, table)
            for name in PARAMETERS:
                if given is not None and name in given.model_fields_set:
                    origins.setdefault(name, f"{table}.{name}")
        return origins

    def content(self) -> dict[str, Any]:
        """Return the study as plain data, with ranges and units in canonical form."""
        content = super().content()
        if self.candidates is not None:
            told = self.asked_next().items()
            content["candidates"] = {name: values.canonical() for name, values in told}
        return content
