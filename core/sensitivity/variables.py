"""The variables of a sensitivity study's result, each with its dimensions, unit and label."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from vibrafeed.core.plan.statistics import INTERVAL
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.study.sensitivity_study import Demand, SensitivityStudy

UNCERTAIN = "uncertain"
"""The dimension of the uncertain parameters."""
QUANTILE = "quantile"
LEVEL = "level"
"""The dimension of the quantiles of which a whole distribution is drawn."""


@dataclass(frozen=True)
class ResultVariable:
    """A variable of the result.

    Attributes
    ----------
    name : str
        Its name.
    over : str
        Its dimension besides those of the grid; empty for none.
    unit : str
        Its unit.
    label, comment : str
        Short name and description.
    more : mapping
        Further attributes.
    """

    name: str
    over: str
    unit: str
    label: str
    comment: str
    more: Mapping[str, Any] = field(default_factory=dict)

    @property
    def attributes(self) -> Mapping[str, Any]:
        """The CF attributes of the variable."""
        return {"units": self.unit, "long_name": self.label, "comment": self.comment} | dict(
            self.more
        )


def result_variables(study: SensitivityStudy, outputs: tuple[str, ...]) -> Iterator[ResultVariable]:
    """Yield every variable of the result of a study with uncertain parameters, except `regime`.

    Those of demands come first, then those of each output, with name, unit and description.
    """
    for demand in study.demands:
        yield from _of_demand(demand)
    for name in outputs:
        yield from _of_output(study, name)


def _of_demand(demand: Demand) -> Iterator[ResultVariable]:
    """Yield the variables of a demand: the probability that it is met, and the error of that.

    They have names, units and comments, without values.
    """
    name = f"probability_{demand.name}"
    comment = "Points without a valid value count as not meeting it."
    yield ResultVariable(name, "", "1", f"Probability of {in_words(demand)}", comment,
                 demand.model_dump(exclude_none=True))  # fmt: skip
    error = f"Error of the probability of {in_words(demand)}"
    yield ResultVariable(f"{name}_error", "", "1", error, INTERVAL)


def in_words(demand: Demand) -> str:
    """Return a demand in words, such as ``acceleration along x at least 1 m s-2``.

    A demand is a regime, or an output with one or two bounds; these are in the unit of the output.
    """
    if demand.regime is not None:
        return f"the regime {demand.regime}"
    output = QUANTITIES[str(demand.output)]
    ends = [
        f"{words} {end:g}{output.suffix}"
        for words, end in (("at least", demand.at_least), ("at most", demand.at_most))
        if end is not None
    ]
    return f"{in_sentence(output.label)} {' and '.join(ends)}"


def _of_output(study: SensitivityStudy, name: str) -> Iterator[ResultVariable]:
    """Yield the variables of one output, with units and comments, by the study's analyses.

    `name` is the output. They are without values.
    """
    quantity = QUANTITIES[name]
    unit, what = quantity.unit, in_sentence(quantity.label)

    def variable(
        part: str, words: str, comment: str, over: str = "", unit: str = unit
    ) -> ResultVariable:
        """Return a variable of the output."""
        return ResultVariable(f"{name}_{part}", over, unit, f"{words} of the {what}", comment)

    def with_error(part: str, words: str, comment: str, over: str = "", unit: str = unit) -> Any:
        """Yield a variable of the output and its error."""
        yield variable(part, words, comment, over, unit)
        error = f"Error of the {in_sentence(words)}"
        yield variable(f"{part}_error", error, INTERVAL, over, unit)

    if "distribution" in study.analyses:
        yield from with_error("mean", "Mean", "Over the points that have a valid value.")
        yield from with_error("deviation", "Standard deviation", "Over the same points.")
        comment = "The value below which so large a share of the points lies."
        yield from with_error(QUANTILE, "Quantile", comment, QUANTILE)
        yield variable("distribution", "Distribution", comment, LEVEL)
    yield variable(
        "left_out", "Share left out", "Points that have no value, or in a regime where the values "
        "do not describe a real part.", unit="1",
    )  # fmt: skip
    if "sobol" in study.analyses:
        yield from with_error(
            "first", "First Sobol index", "Share of the variance that would vanish if "
            "this parameter alone were known.", UNCERTAIN, "1",
        )  # fmt: skip
        yield from with_error(
            "total", "Total Sobol index", "Share of the variance that would remain if "
            "all other parameters were known.", UNCERTAIN, "1",
        )  # fmt: skip
    if "budget" in study.analyses:
        yield variable("nominal", "Nominal value", "All parameters at their nominal values.")
        for end in ("lower", "upper"):
            comment = f"This parameter at the {end} end of its tolerance, the others nominal."
            yield variable(f"at_{end}", f"Value at the {end} end", comment, UNCERTAIN)
        comment = "The derivative by this parameter, times half its tolerance; none at a kink."
        yield variable("linear", "Linear change", comment, UNCERTAIN)
        comment = "Of this parameter in the variance of the linear budget; none at a kink."
        yield variable("variance_share", "Share of the variance", comment, UNCERTAIN, "1")
        comment = "Over the box of all tolerances: of its corners, and of points inside."
        yield variable("least", "Least value", comment)
        yield variable("largest", "Largest value", comment)
