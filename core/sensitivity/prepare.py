"""From a study of uncertain parameters to what can be carried out, and what comes of it."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import Problem, StudyError, given_twice, raise_any, refused
from vibrafeed.core.motion.prepare import choose_system
from vibrafeed.core.motion.systems import methods_of
from vibrafeed.core.optimise.prepare import choose_problem_scene, drive_refusal
from vibrafeed.core.plan.grid import to_si
from vibrafeed.core.plan.labels import ResultVariable
from vibrafeed.core.plan.pieces import Sketch
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.plan.prepared import Chosen, Prepared, Price, locate_problem, plan_study, price
from vibrafeed.core.plan.statistics import INTERVAL, LEVELS
from vibrafeed.core.quantities import FLAGS, QUANTITIES, REGIMES
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.sensitivity.budget import Budget
from vibrafeed.core.sensitivity.indices import MAX_INPUTS
from vibrafeed.core.study.distributions import Distribution, nominal, tolerance
from vibrafeed.core.study.sensitivity_study import Demand, SensitivityStudy
from vibrafeed.core.study.values import Fixed, Span, Values
from vibrafeed.core.suggestions import suggestion

UNCERTAIN = "uncertain"
"""The dimension of the uncertain parameters."""
QUANTILE = "quantile"
LEVEL = "level"
"""The dimension of the quantiles of which a whole distribution is drawn."""


def _variables_of_demand(demand: Demand) -> Iterator[ResultVariable]:
    name = f"probability_{demand.name}"
    label = f"robability of {in_words(demand)}"
    comment = "Points without a valid value count as not meeting it."
    yield ResultVariable(name, (), "1", f"P{label}", comment, demand.model_dump(exclude_none=True))
    yield ResultVariable(f"{name}_error", (), "1", f"Error of the p{label}", INTERVAL)


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


def _variables_of_output(study: SensitivityStudy, name: str) -> Iterator[ResultVariable]:
    quantity = QUANTITIES[name]
    unit, lowered_label = quantity.unit, in_sentence(quantity.label)

    def variable(
        part: str, words: str, comment: str, dim: str = "", unit: str = unit
    ) -> ResultVariable:
        dims = (dim,) if dim else ()
        return ResultVariable(
            f"{name}_{part}", dims, unit, f"{words} of the {lowered_label}", comment
        )

    def with_error(part: str, words: str, comment: str, dim: str = "", unit: str = unit) -> Any:
        yield variable(part, words, comment, dim, unit)
        error = f"Error of the {in_sentence(words)}"
        yield variable(f"{part}_error", error, INTERVAL, dim, unit)

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
            yield variable(
                f"at_{end}",
                f"Value at the {end} end",
                f"This parameter at the {end} end of its tolerance, the others nominal.",
                UNCERTAIN,
            )
        yield variable(
            "linear",
            "Linear change",
            "The derivative by this parameter, times half its tolerance; none at a kink.",
            UNCERTAIN,
        )
        yield variable(
            "variance_share",
            "Share of the variance",
            "Of this parameter in the variance of the linear budget; none at a kink.",
            UNCERTAIN,
            "1",
        )
        comment = "Over the box of all tolerances: of its corners, and of points inside."
        yield variable("least", "Least value", comment)
        yield variable("largest", "Largest value", comment)


MAX_VALUES = 10_000_000
"""Most values of one design: evaluations times outputs, which fill a few hundred megabytes."""
MAX_EVALUATIONS = 2_000_000_000
"""Most evaluations of a whole study."""
COUNT_SECONDS = 2e-7
"""Seconds for the statistics of a value, beside evaluating it."""


@dataclass(frozen=True)
class Sensitivity(Prepared):
    """A study of uncertain parameters that can be carried out; its grid is that of the designs."""

    study: SensitivityStudy

    @cached_property
    def uncertain(self) -> dict[str, Distribution]:
        """The uncertain parameters with their distributions."""
        return self.study.distributions()

    @cached_property
    def outputs(self) -> tuple[str, ...]:
        """The outputs of the result: those that the study asks for."""
        return tuple(name for name in self.plan.outputs if name in self.study.outputs)

    @cached_property
    def result_variables(self) -> dict[str, ResultVariable]:
        """Every variable of the result except the verdicts."""
        of_outputs = (_variables_of_output(self.study, name) for name in self.outputs)
        variables = chain(*map(_variables_of_demand, self.study.demands), *of_outputs)
        return {variable.name: variable for variable in variables}

    @cached_property
    def dims(self) -> dict[str, tuple[str, ...]]:
        """The names of the dimensions of each variable of the result, by the variable's name.

        They are the axes of the grid, in some with one more in front: uncertain parameters,
        quantiles or levels.
        """
        axes = tuple(self.grid.axes)
        dims = {name: (*variable.dims, *axes) for name, variable in self.result_variables.items()}
        return {**dims, **dict.fromkeys(self.plan.verdict_names, axes)}

    @cached_property
    def units(self) -> dict[str, str]:
        """The unit of each variable."""
        flags = dict.fromkeys(self.plan.verdict_names, "1")
        return {name: variable.unit for name, variable in self.result_variables.items()} | flags

    @property
    def sizes(self) -> Mapping[str, int]:
        """The length of each dimension."""
        quantiles = len(self.study.quantiles)
        own_sizes = {UNCERTAIN: len(self.uncertain), QUANTILE: quantiles, LEVEL: LEVELS}
        return {**own_sizes, **self.grid.shape}

    def in_files(self, name: str, values: NDArray[Any]) -> NDArray[Any]:
        """Return values unchanged: they are computed in the units of files."""
        return values

    @cached_property
    def budget(self) -> Budget:
        """The points of the tolerance budget; None if not asked for."""
        return Budget(self.uncertain, self.study.seed)

    @cached_property
    def evaluations(self) -> int:
        """The number of evaluations of each design."""
        return evaluations_of(self.study, self.budget)

    def _new_price(self) -> Price:
        # Motions are priced by some that are spread over the tolerances.
        untimed = None
        if any(equation.takes_long for equation in self.plan.equations):
            untimed = methods_of(self.plan.scene.name)[self.plan.variant].seconds_a_cell
        ends = {
            name: tuple(to_si(name, np.array(tolerance(name, distribution))).tolist())
            for name, distribution in self.uncertain.items()
        }
        price_of_motion = price(self.plan, self.grid, untimed, ends)
        counting = COUNT_SECONDS * len(self.plan.outputs)
        return Price(price_of_motion.start, self.evaluations * (price_of_motion.cell + counting))

    def what_fits(self, fraction: float) -> str:
        """Return a sentence that says how to shrink the study to a share of its size."""
        return super().what_fits(fraction) if self.grid.shape else "It fits with fewer outputs"


def evaluations_of(study: SensitivityStudy, budget: Budget) -> int:
    """Return the number of evaluations of one design that the analyses of a study need.

    Each analysis (distribution, Sobol, tolerance budget) has points of its own, besides the
    nominal one; `budget` has those of the last.
    """
    count, total = len(study.distributions()), 1
    if {"distribution", "sobol"} & set(study.analyses) or study.demands:
        total += study.samples * (count + 2 if "sobol" in study.analyses else 1)
    return total + (budget.size if "budget" in study.analyses else 0)


def prepare(study: SensitivityStudy) -> Sensitivity:
    """Return a study with uncertain parameters as checked and planned, ready to be computed."""
    uncertain, outputs = study.distributions(), study.asked()
    if not uncertain:
        raise refused(
            "uncertain",
            "no parameter is uncertain",
            "Add a parameter, for example friction = { mean = 0.3, deviation = 0.03 }",
        )
    problems = [*_problems_of(study)]
    parameters = (*study.values(), *uncertain)
    try:
        chosen = choose(Sketch(study.scene, study.variant, study.method, outputs, parameters))
    except StudyError as error:
        raise StudyError([*problems, *error.problems]) from None
    problems += drive_refusal(study, chosen[0])
    values = study.values()
    ranges = {
        name: _span(name, distribution)
        for name, distribution in uncertain.items()
        if name not in values
    }
    try:
        plan, grid = plan_study(study, outputs, chosen, ranges)
    except StudyError as error:
        all_problems = [*problems, *(locate_problem(problem, study) for problem in error.problems)]
        raise StudyError(all_problems) from None
    problems += _problems_of_regimes(study, plan)
    raise_any(problems)
    prepared = Sensitivity(study, plan, grid)
    raise_any(_problems_of_size(prepared))
    return prepared


def choose(sketch: Sketch) -> Chosen:
    """Return the scene of a study, its variant or method, and the problems of their names.

    It is the closed-form scene, or that of the motion in time if a method or an output asks for
    motion. `sketch` has what the user wrote: scene, variant, method, outputs and names of
    parameters.
    """
    if sketch.method is None:
        return choose_problem_scene(sketch.scene, sketch.variant, sketch.outputs, sketch.names)
    scene, chosen, problems = choose_system(sketch.scene, sketch.method, sketch.names)
    if sketch.variant is not None:
        problems = [
            *problems,
            Problem(
                "variant",
                "variant is given, but a simulated motion has no variants",
                "Remove variant or method",
            ),
        ]
    return scene, chosen, problems


def _span(name: str, distribution: Distribution) -> Values:
    lower, upper = tolerance(name, distribution)
    return Span(lower, upper, 2) if lower < upper else Fixed(nominal(distribution))


def _problems_of(study: SensitivityStudy) -> Iterable[Problem]:
    uncertain = study.distributions()
    yield from given_twice("uncertain", uncertain, "parameters", study.values())
    if len(uncertain) > MAX_INPUTS:
        yield Problem(
            "uncertain",
            f"{len(uncertain)} parameters are uncertain, at most {MAX_INPUTS} are allowed",
            "Keep those that matter most",
        )
    yield from (
        Problem(
            "outputs",
            f"the values of {name} are names, not numbers, so it has no statistics",
            'Request the probability of a regime: [[demands]] regime = "hopping"',
        )
        for name in study.outputs
        if name in FLAGS
    )
    if study.verify is not None:
        yield Problem(
            "verify",
            "a sensitivity study states the errors of its statistics and cannot be verified",
            "Remove verify",
        )
    yield from _problems_of_demands(study.demands)


def _problems_of_demands(demands: Sequence[Demand]) -> Iterable[Problem]:
    seen: set[str] = set()
    for number, demand in enumerate(demands):
        path = f"demands.{number}"
        fault = _fault_of_demand(demand)
        if fault is not None:
            yield Problem(path, *fault)
        if demand.output in FLAGS:
            yield Problem(
                f"{path}.output",
                f"the values of {demand.output} are names, not numbers, so it has no limits",
                'Give the regime instead, for example regime = "hopping"',
            )
        if demand.name in seen:
            about = demand.output or demand.regime
            yield Problem(
                path,
                f"two demands limit {about} on the same side",
                "Remove one of the two, or move it to another study",
            )
        seen.add(demand.name)


def _fault_of_demand(demand: Demand) -> tuple[str, str] | None:
    is_bounded = demand.at_least is not None or demand.at_most is not None
    if (demand.output is None) == (demand.regime is None):
        return "a demand needs either an output or a regime", "Give one of the two"
    if demand.regime is not None:
        return (
            (
                "a demand for a regime has no bounds",
                "Remove at_least and at_most: the result is the probability of the regime",
            )
            if is_bounded
            else None
        )
    if not is_bounded:
        return "the demand has no bound", "Add at_least, at_most or both"
    if demand.at_least is None or demand.at_most is None or demand.at_least <= demand.at_most:
        return None
    return "at_least is above at_most", "Swap the two values"


def _problems_of_regimes(study: SensitivityStudy, plan: Plan) -> Iterable[Problem]:
    for number, demand in enumerate(study.demands):
        if demand.regime is not None and demand.regime not in plan.regimes:
            message, fix = f"'{demand.regime}' is not a regime", suggestion(demand.regime, REGIMES)
            if demand.regime in REGIMES:
                fix = f"Choose one of {', '.join(plan.regimes)}"
                message += " of the requested outputs"
            yield Problem(f"demands.{number}.regime", message, fix)


def _problems_of_size(prepared: Sensitivity) -> Iterable[Problem]:
    outputs, each = len(prepared.plan.outputs), prepared.evaluations
    if each * outputs > MAX_VALUES:
        yield Problem(
            "samples",
            f"{each:,} evaluations of {outputs} outputs for each design are too many",
            f"Reduce samples or outputs: at most {MAX_VALUES:,} values per design are allowed",
        )
    elif each * prepared.cells > MAX_EVALUATIONS:
        yield Problem(
            "samples",
            f"{each:,} evaluations for each of {prepared.cells:,} designs are too many",
            f"Reduce designs or samples: at most {MAX_EVALUATIONS:,} evaluations are allowed",
        )
