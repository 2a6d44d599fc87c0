"""An optimisation that can be carried out."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any

from vibrafeed.core.dataset.table import flag_attributes, quantity_attributes
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.method import Method
from vibrafeed.core.motion.prepare import other_method
from vibrafeed.core.motion.systems import methods_of
from vibrafeed.core.optimise.problem import OptimisationProblem, broken_names
from vibrafeed.core.optimise.search import expected_points
from vibrafeed.core.optimise.uncertain import NODES
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.labels import link_to_verdict
from vibrafeed.core.plan.prepared import MARGIN, Box, Prepared, Price, price
from vibrafeed.core.plan.statistics import INTERVAL
from vibrafeed.core.quantities import OPTIMUM_STATUSES, QUANTITIES, Flag
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.study.distributions import Distribution, nominal, tolerance
from vibrafeed.core.study.optimise_study import Limited, OptimiseStudy, Pareto, Target, Weighted
from vibrafeed.core.study.shown import ShownUnits
from vibrafeed.core.study.values import Between

SECONDS = {"exact": 2e-5, "search": 0.01, "scipy": 0.2}
"""Approximate time of a design by each method."""
MOTION_SECONDS = 0.2  # roughly, of a design of motions, besides what following them takes
RIVAL_SECONDS = 0.02  # roughly, of a design by the method that verifies

FLAGS = ("optimum_status", "regime", "knee")


@dataclass(frozen=True)
class Optimisation(Prepared):
    """An optimisation that can be carried out; the grid's last axis is the front, if any.

    Attributes
    ----------
    designs : Grid
        The grid without the front.
    problem : OptimisationProblem
        What is solved at each of its points.
    method : str
        A key of `METHODS`.
    """

    study: OptimiseStudy
    designs: Grid
    problem: OptimisationProblem
    method: str

    def with_nodes(self, values: Mapping[str, Array]) -> "Optimisation":
        """Return the study with further nodes of the uncertain parameters, SI units."""
        uncertain = self.problem.uncertain
        assert uncertain is not None
        return replace(self, problem=replace(self.problem, uncertain=uncertain.with_nodes(values)))

    @cached_property
    def attributes(self) -> dict[str, dict[str, Any]]:
        """The CF attributes of each variable of the result but the verdicts, in its order."""
        return _attributes(self)

    @cached_property
    def units(self) -> dict[str, str]:
        """The unit of each variable of an optimisation's result by name, in order, as in files."""
        units = {name: attributes.get("units", "1") for name, attributes in self.attributes.items()}
        return {**units, **dict.fromkeys(self.plan.verdict_names, "1")}

    @cached_property
    def dims(self) -> dict[str, tuple[str, ...]]:
        """The axes of each variable: all axes."""
        return dict.fromkeys(self.units, tuple(self.grid.axes))

    def facts(self) -> dict[str, Any]:
        """Return further facts on an optimisation for the document of its plan, as plain data.

        It is shown before the study is run: criterion in words, variables, method, and names of the
        constraints.
        """
        return {
            "criterion": criterion_in_words(self.problem),
            "variables": [*self.problem.names],
            "method": self.method,
            "kept": [constraint.name for constraint in self.problem.constraints],
        }

    @property
    def sentences(self) -> tuple[str, ...]:
        """Two sentences on an optimisation, to show before it is run: objective, constraints."""
        facts = self.facts()
        variables, constraints = (", ".join(facts[name]) for name in ("variables", "kept"))
        return (
            f"{facts['criterion']}, by the choice of {variables}; method {facts['method']}",
            f"kept: {constraints or 'nothing'}",
        )

    def _new_price(self) -> Price:
        node_factor = max(1.0, self.problem.nodes / NODES)
        if not self.problem.is_motion:
            return Price(0.0, MARGIN * SECONDS[self.method] * node_factor)
        method = methods_of(self.plan.scene.name)[self.plan.variant]
        motion = price(self.plan, self.designs, method.seconds_a_cell, self.problem.bounds)
        # One interval of nine nodes is in the price of a search; more nodes cost as much more.
        motions = node_factor * expected_points(len(self.problem.names))
        return Price(motion.start, MARGIN * MOTION_SECONDS + motions * motion.cell)

    @property
    def other_motion(self) -> Method | None:
        """The method that simulates optima again; None if the outputs are not those of a motion."""
        return other_method(self.plan, self.designs, self.problem.names)

    @property
    def verified_by(self) -> str:
        """The name of the method that verifies optima; empty if none can."""
        if not self.problem.is_motion:
            return super().verified_by
        return f"the method {self.other_motion.name}" if self.other_motion else ""

    @property
    def seconds_a_verified_cell(self) -> float:
        """The likely time to verify one design [s]: another method, and the outputs another way.

        0 if no other method can verify a motion.
        """
        if not self.problem.is_motion:
            return super().seconds_a_verified_cell + RIVAL_SECONDS
        other = self.other_motion
        return other.seconds_a_cell if other else 0.0

    @property
    def cut_axes(self) -> tuple[str, ...]:
        """The axes along which the study can be cut into pieces; a front stays whole."""
        return tuple(self.designs.axes)

    def within(self, box: Box) -> "Optimisation":
        """Return the study restricted to a part of its designs."""
        return replace(self, grid=self.grid.within(box), designs=self.designs.within(box))

    def width(self, name: str) -> int:
        """Return the bytes of one stored value of a variable."""
        flags = (*FLAGS, *self.plan.verdict_names)
        return 1 if name in flags or name.startswith("binds_") else 8


# --- the variables of the result


BINDS = {
    "free": Flag(0, "the constraint is not active"),
    "binds": Flag(1, "the constraint holds with equality"),
}
KNEE = {"point": Flag(0, "a point of the front"), "knee": Flag(1, "its knee")}


def _attributes(prepared: Optimisation) -> dict[str, dict[str, Any]]:
    problem, plan, study = prepared.problem, prepared.plan, prepared.study
    criterion, names = problem.criterion, problem.names
    unit = QUANTITIES[criterion.output].unit

    def attributes_of(name: str, **more: str) -> dict[str, Any]:
        return {**quantity_attributes(name, **link_to_verdict(plan, name)), **more}

    def binds(bound_name: str) -> dict[str, Any]:
        flags = flag_attributes("optimum_status", BINDS, tuple(BINDS))
        return {**flags, "long_name": f"Whether {bound_name} binds"}

    attributes = {
        f"best_{name}": {
            **quantity_attributes(name),
            "long_name": f"Best {in_sentence(QUANTITIES[name].label)}",
        }
        for name in names
    }
    note = " Over points that did not choose it." if problem.is_sampled else ""
    attributes["objective"] = attributes_of(
        "objective",
        units=unit,
        comment=f"At the optimum: {criterion_in_words(problem)}.{note}",
        criterion=criterion.kind,
        output=criterion.output,
        **link_to_verdict(plan, criterion.output),
    )
    if problem.states_error or problem.is_sampled:
        attributes["objective_error"] = attributes_of("objective_error", units=unit)
    if problem.is_sampled:
        attributes["objective_error"]["comment"] = INTERVAL
        attributes["objective_left_out"] = attributes_of("objective_left_out")
    for name in (*problem.judged_outputs, *study.outputs):
        if name != "regime":
            attributes[name] = attributes_of(name)
    for constraint in problem.constraints:
        bound_name = constraint.name.replace("_", " ")
        attributes[f"margin_{constraint.name}"] = {
            "units": QUANTITIES[constraint.output].unit,
            "long_name": f"Margin of {bound_name}",
            "comment": f"Distance of {constraint.output} from its bound; 0 where it binds.",
        }
        attributes[f"binds_{constraint.name}"] = binds(bound_name)
        if problem.uncertain is not None:
            label = f"robability that {bound_name} is broken"
            comment = "Over all distributions; a unit without a value breaks it."
            broken, error = broken_names(constraint.name)
            attributes[broken] = {"units": "1", "long_name": f"P{label}", "comment": comment}
            label = f"Error of the p{label}"
            attributes[error] = {"units": "1", "long_name": label, "comment": INTERVAL}
    for name, end in product(names, ("lower", "upper")):
        attributes[f"binds_{name}_{end}"] = binds(f"the {end} bound of {name}")
    attributes |= {name: attributes_of(name) for name in ("optimum_gap", "evaluations")}
    if isinstance(criterion, Pareto):
        attributes["knee"] = flag_attributes("knee", KNEE, tuple(KNEE))
        attributes["front_points"] = attributes_of("front_points")
    for name in problem.sensitive if study.sensitivities else ():
        attributes[f"sensitivity_{name}"] = {
            "units": "1",
            "long_name": f"Sensitivity to {in_sentence(QUANTITIES[name].label)}",
            "comment": f"d ln({criterion.output})/d ln({name}) at the optimum.",
        }
    attributes["optimum_status"] = flag_attributes(
        "optimum_status", OPTIMUM_STATUSES, tuple(OPTIMUM_STATUSES)
    )
    return attributes


# --- in words


def criterion_in_words(problem: OptimisationProblem) -> str:
    """Return the criterion in a few words."""
    words, uncertain = _criterion_of_exact_parameters(problem), problem.uncertain
    if uncertain is None:
        return words
    statistic = {"worst": "in the worst case", "mean": "on average"}.get(uncertain.how)
    statistic = statistic or f"of the {uncertain.quantile:g} quantile"
    names = (
        _range_in_words(name, distribution)
        for name, distribution in uncertain.distributions.items()
    )
    return f"{words}, {statistic} over {', '.join(names)}"


def _range_in_words(name: str, distribution: Distribution) -> str:
    lower, upper = (_in_words(name, end, 4) for end in tolerance(name, distribution))
    if isinstance(distribution, Between):
        return f"{name} from {lower} to {upper}"
    return f"{name} about {_in_words(name, nominal(distribution))} ({lower} to {upper})"


def _in_words(name: str, value: float, digits: int = 6) -> str:
    return ShownUnits().text(value, QUANTITIES[name].unit, digits)


def _criterion_of_exact_parameters(problem: OptimisationProblem) -> str:
    criterion = problem.criterion
    output, against = criterion.output, problem.against
    if isinstance(criterion, Weighted):
        return f"largest {output} - {criterion.weight:g} |{against}|"
    if isinstance(criterion, Limited):
        return (
            f"largest {output} with |{against}| <= {_in_words(criterion.against, criterion.limit)}"
        )
    if isinstance(criterion, Target):
        return f"{output} nearest to {_in_words(output, criterion.target)}"
    if isinstance(criterion, Pareto):
        return f"{output} high, |{against}| low: the whole front"
    return f"{'least' if problem.sign < 0 else 'largest'} {output}"
