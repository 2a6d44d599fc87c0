"""The plan: the equations of one scene that the asked outputs pull, in order, and no others.

With it go running them on arrays and its verdicts: the flag variables of a result, one for all
outputs that share a validity.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import Problem, raise_any, refused
from vibrafeed.core.quantities import QUANTITIES, REGIMES
from vibrafeed.core.quantities.drives import DRIVE
from vibrafeed.core.quantities.flags import REGIME
from vibrafeed.core.quantities.motion import FEEDING, RESULTS
from vibrafeed.core.scenes import (
    ALIASES,
    ALTERNATIVES,
    BESIDE,
    EXACT,
    NEEDS,
    NOT_OF_SHAPE,
    SCENES,
    WRITTEN_AS,
    Condition,
    Equation,
    Scene,
)
from vibrafeed.core.scenes.scene import behind
from vibrafeed.core.suggestions import Suggestions, by_synonym, suggestion
from vibrafeed.core.watch import Watch


@dataclass(frozen=True)
class Verdict:
    """A flag variable of a result: the regime of the outputs that share a validity.

    It is called ``regime``, or ``regime_<output>`` after the first of its outputs, of which none is
    of `EXACT`. The first of its conditions that holds names the regime.
    """

    name: str
    outputs: tuple[str, ...]
    conditions: tuple[Condition, ...]

    @cached_property
    def regimes(self) -> tuple[str, ...]:
        """The regimes that cells can have, by value."""
        names = {condition.regime for condition in self.conditions} | {self.otherwise}
        return tuple(sorted(names, key=lambda name: REGIMES[name].value))

    @cached_property
    def otherwise(self) -> str:
        """The regime of cells in which no condition holds."""
        regimes = [condition.otherwise for condition in self.conditions if condition.otherwise]
        without_contact = [name for name in regimes if name != "contact"]
        return (without_contact or regimes or ["not_assessed"])[-1]

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """The names of the quantities that its conditions need."""
        return tuple(
            dict.fromkeys(name for condition in self.conditions for name in condition.inputs)
        )

    @cached_property
    def doubts(self) -> bool:
        """True if one of the regimes does not describe a real part."""
        return not all(REGIMES[name].valid for name in self.regimes)


@dataclass(frozen=True)
class Plan:
    """The equations that run for a set of outputs, each after those that it needs.

    Of the verdicts ``regime`` comes first; `parameters` are the given ones that are needed, and
    `defaults` stand in for what is not given, SI units.
    """

    scene: Scene
    variant: str
    outputs: tuple[str, ...]
    equations: tuple[Equation, ...]
    verdicts: tuple[Verdict, ...]
    parameters: tuple[str, ...]
    defaults: Mapping[str, float]

    @cached_property
    def conditions(self) -> tuple[Condition, ...]:
        """The conditions of all verdicts, each once."""
        return tuple(
            dict.fromkeys(
                condition for verdict in self.verdicts for condition in verdict.conditions
            )
        )

    @cached_property
    def regimes(self) -> tuple[str, ...]:
        """The regimes that cells can have by any verdict, by value."""
        names = {name for verdict in self.verdicts for name in verdict.regimes}
        return tuple(sorted(names, key=lambda name: REGIMES[name].value))

    @cached_property
    def verdict_names(self) -> tuple[str, ...]:
        """The names of the flag variables, ``regime`` first."""
        return tuple(verdict.name for verdict in self.verdicts)

    def verdict_on(self, output: str) -> Verdict | None:
        """Return the verdict that judges an output; None for one that holds in every regime."""
        return next((verdict for verdict in self.verdicts if output in verdict.outputs), None)

    def only(self, output: str) -> "Plan":
        """Return the plan of one output alone, with the equations and parameters that it needs.

        Plans are kept for the next call, since every slice asks for one.
        """
        if output not in self._known:
            self._known[output] = _Walk(self.scene, self.variant, self.parameters, (output,)).plan()
        return self._known[output]

    def part(self, names: Collection[str]) -> "Plan":
        """Return a smaller plan: the equations that some outputs and verdicts of this plan need."""
        verdicts = tuple(verdict for verdict in self.verdicts if verdict.name in names)
        outputs = tuple(name for name in names if name not in self.verdict_names)
        wanted = [*outputs, *(name for verdict in verdicts for name in verdict.inputs)]
        needed = behind(wanted, {equation.gives: equation for equation in self.equations}.get)
        return replace(
            self,
            outputs=outputs,
            equations=tuple(equation for equation in self.equations if equation.gives in needed),
            verdicts=verdicts,
            parameters=tuple(name for name in self.parameters if name in needed),
            defaults={name: value for name, value in self.defaults.items() if name in needed},
        )

    def depends_on(self, along: Mapping[str, str]) -> dict[str, frozenset[str]]:
        """Return the axes on which each quantity and each verdict of the plan depend, by name.

        A quantity is computed over its own axes only, which saves most of the work on a large grid.
        `along` has the axis of each ranged parameter.
        """
        axis_of_parameter = tuple(along.items())
        if axis_of_parameter not in self._known:
            depends = {
                name: frozenset(axis for parameter, axis in axis_of_parameter if parameter == name)
                for name in self.parameters
            }
            depends |= dict.fromkeys(self.defaults, frozenset())
            inputs_of = {equation.gives: equation.inputs for equation in self.equations}
            inputs_of |= {verdict.name: verdict.inputs for verdict in self.verdicts}
            for name, inputs in inputs_of.items():
                depends[name] = frozenset().union(*(depends[needed] for needed in inputs))
            self._known[axis_of_parameter] = depends
        return dict(self._known[axis_of_parameter])

    @cached_property
    def _known(self) -> dict[Any, Any]:  # by output and by axes
        return {}


def verdicts_of(conditions: Sequence[Condition], outputs: Sequence[str]) -> tuple[Verdict, ...]:
    """Return the verdicts on outputs, that on the contact first; always at least one.

    Outputs share a verdict if the same conditions judge them. A condition judges if its regime is
    not valid or speaks of single outputs; one that tells the state of the part, such as stick,
    parts no outputs. What holds in every regime (`EXACT`) has no verdict of its own.
    """
    of_contact = {*_judging_conditions(conditions, REGIME)}
    judged = [
        name for name in outputs if any(name in condition.outputs for condition in conditions)
    ]
    groups: dict[tuple[Condition, ...], list[str]] = {}
    for name in judged:
        if name not in EXACT:
            groups.setdefault(_judging_conditions(conditions, name), []).append(name)
    if not groups:
        groups[()] = judged or list(outputs)
    # The verdict on the contact: the group that shares most conditions with those of the contact,
    # and has fewest others.
    contact_group = max(
        groups,
        key=lambda group: (len(of_contact & {*group}), -len({*group} - of_contact)),
    )
    ordered = {contact_group: groups.pop(contact_group), **groups}
    return tuple(
        Verdict(
            REGIME if group is contact_group else f"{REGIME}_{names[0]}",
            tuple(name for name in names if name not in (REGIME, *EXACT)),
            tuple(condition for condition in conditions if condition.outputs & set(names)),
        )
        for group, names in ordered.items()
    )


def _judging_conditions(conditions: Sequence[Condition], output: str) -> tuple[Condition, ...]:
    return tuple(
        condition
        for condition in conditions
        if output in condition.outputs and REGIMES[condition.regime].judges
    )


def find_scene(
    name: str, variant: str | None, scenes: Mapping[str, Scene] = SCENES
) -> tuple[Scene, str]:
    """Return the named scene and variant, the default one for None; raise `StudyError` without."""
    scene, variant, problems = choose_scene(name, variant, scenes)
    raise_any(problems)
    return scene, variant


def choose_scene(
    name: str, variant: str | None, scenes: Mapping[str, Scene] = SCENES
) -> tuple[Scene, str, list[Problem]]:
    """Return the named scene, the variant of its equations, and the problems of the variant's name.

    An unknown variant gives way to the default. Raises `StudyError` if there is no such scene.
    """
    scene = scenes.get(name)
    if scene is None:
        is_scene = name in SCENES
        raise refused(
            "scene",
            f"'{name[:60]}' {'cannot be simulated' if is_scene else 'is not a scene'}",
            f"Known: {', '.join(scenes)}" if is_scene else suggestion(name, scenes),
        )
    if variant is None or variant in scene.variants:
        return scene, variant or scene.default_variant, []
    problem = Problem(
        scene.choice,
        f"{scene.name} has no {scene.choice} '{variant[:60]}'",
        suggestion(variant, scene.variants),
    )
    return scene, scene.default_variant, [problem]


def plan_scene(
    scene: Scene,
    variant: str,
    outputs: Collection[str],
    parameters: Collection[str],
    optional: Collection[str] = (),
) -> Plan:
    """Return the plan for outputs of a scene, given the names of a study's parameters.

    Those among `optional` may be parameters of the scene that the outputs do not use. Raises
    `StudyError` with every problem.
    """
    scene = scene.fitted(parameters)
    known, suggestions = scene.outputs(variant), Suggestions()
    unknown = (name for name in outputs if name not in known)
    problems = [_unknown_output(scene, variant, name, suggestions) for name in unknown]
    known_outputs = tuple(name for name in dict.fromkeys(outputs) if name in known)
    walk = _Walk(scene, variant, parameters, known_outputs)
    problems += _problems_of_alternatives(parameters, walk.missing)
    problems += [_problem_of_missing(scene, name, user) for name, user in walk.missing.items()]
    if known_outputs:  # otherwise nothing is known to be used, and every parameter would be blamed
        reported = {problem.place.removeprefix("parameters.") for problem in problems}
        reported |= {*optional} & {*scene_parameters(scene, variant)}
        unused = (name for name in parameters if name not in walk.used | reported)
        problems += [_problem_of_unused(scene, variant, name, known_outputs) for name in unused]
    raise_any(problems)
    return walk.plan()


class _Walk:
    def __init__(
        self, scene: Scene, variant: str, parameters: Collection[str], outputs: tuple[str, ...]
    ):
        self.scene, self.variant = scene, variant
        self.parameters, self.outputs = parameters, outputs
        self.scene_defaults = scene.defaults_of(variant)
        self.producers = scene.producers(variant)
        self.equations: list[Equation] = []
        self.defaults: dict[str, float] = {}
        self.used: set[str] = set()
        self.missing: dict[str, str] = {}  # parameter: who needs it
        self.visited: set[str] = set()
        for name in outputs:
            if name != REGIME:
                self.visit(name)
        for condition in scene.conditions[variant]:
            for name in condition.inputs if condition.outputs & set(outputs) else ():
                self.visit(name, condition.regime)

    def plan(self) -> Plan:
        ordered = [name for name in self.scene.outputs(self.variant) if name in self.outputs]
        return Plan(
            self.scene,
            self.variant,
            tuple(name for name in self.outputs if name != REGIME),
            tuple(self.equations),
            verdicts_of(self.scene.conditions[self.variant], ordered),
            tuple(name for name in self.parameters if name in self.used),
            self.defaults,
        )

    def visit(self, name: str, user: str = "") -> None:
        if name in self.visited:
            return
        self.visited.add(name)
        if name in self.parameters:
            self.used.add(name)
        elif (equation := self._producer(name)) is not None:
            for needed in equation.inputs:
                self.visit(needed, name)
            self.equations.append(equation)
        elif name in self.scene_defaults:
            self.defaults[name] = self.scene_defaults[name]
        else:
            self.missing[name] = user

    def _producer(self, name: str) -> Equation | None:
        # An alternative parameter of the study, such as a stroke for an amplitude, comes first.
        parameters = set(self.parameters)
        for alias in ALIASES:
            required = {needed for needed in alias.inputs if QUANTITIES[needed].parameter} - BESIDE
            if alias.gives == name and required <= parameters:
                return alias
        equation = self.producers.get(name)
        if equation is None or name not in self.scene_defaults:
            return equation
        # A default of a derived quantity: the equation runs only if the study asks for it, or sets
        # one of its inputs, or an alternative to one.
        input_producers = (
            self.producers.get(needed) for needed in equation.inputs if QUANTITIES[needed].parameter
        )
        is_given_by_alias = any(
            producer is not None and set(producer.inputs) <= parameters
            for producer in input_producers
        )
        is_needed = name in self.outputs or parameters & {*equation.inputs} or is_given_by_alias
        return equation if is_needed else None


def _unknown_output(scene: Scene, variant: str, name: str, suggestions: Suggestions) -> Problem:
    texts = _where_output_exists(scene, variant, name)
    if texts is None:
        texts = (
            f"{scene.name} has no output '{name[:60]}'",
            suggestions(name, scene.outputs(variant)),
        )
    return Problem("outputs", *texts, about=name)


def _where_output_exists(scene: Scene, variant: str, name: str) -> tuple[str, str] | None:
    # Message and fix if another variant or kind of study has the output; None if none has.
    variants = [variant_ for variant_ in scene.variants if name in scene.outputs(variant_)]
    if variants:
        return (
            f"the {scene.choice} '{variant}' of {scene.name} has no output '{name}'",
            f"Set {scene.choice} to {' or '.join(variants)}",
        )
    closed = SCENES.get(scene.name)
    if scene.choice == "method" and closed is not None:
        here, there, kind = "simulation", "sweep", "sweep"
        exists = name in closed.outputs(closed.default_variant)
    else:
        here, there, kind = "sweep", "simulation", "simulate"
        exists = name in RESULTS or name in FEEDING
    if not exists:
        return None
    other = by_synonym(name, scene.outputs(variant))
    if other is None:
        return f"{name} is an output of a {there}, not of a {here}", f'Set kind = "{kind}"'
    return (
        f"{name} is an output of a {there}, not of a {here}",
        f'Request {other}, or set kind = "{kind}"',
    )


def _problems_of_alternatives(
    parameters: Collection[str], missing: Collection[str]
) -> Iterator[Problem]:
    for name, others in ALTERNATIVES:
        also_given = [other for other in others if name in parameters and other in parameters]
        if also_given:
            yield Problem(
                f"parameters.{name}",
                f"{name} and {' and '.join(also_given)} set the same quantity",
                f"Give either {name} or {' and '.join(others)}",
            )
    for name, (needed, message, example) in NEEDS.items():
        if name in parameters and needed not in {*parameters, *missing}:
            yield Problem(f"parameters.{name}", message, f"Add {needed} = {example}")


def _problem_of_missing(scene: Scene, name: str, needed_by: str) -> Problem:
    written = WRITTEN_AS.get(name, name)
    quantity = QUANTITIES[written]
    needed = f"{scene.name} needs it"
    if needed_by in QUANTITIES and not QUANTITIES[needed_by].bundle:  # users know it
        needed = f"{needed_by.replace('_', ' ')} of {needed}"
    example = quantity.examples[0] if quantity.unit == "1" else f'"{quantity.examples[0]}"'
    return Problem(
        f"parameters.{written}",
        f"it is missing; {needed} ({quantity.description.removesuffix('.')})",
        f"Add, for example, {written} = {example}",
    )


def _problem_of_unused(scene: Scene, variant: str, name: str, outputs: Collection[str]) -> Problem:
    path = f"parameters.{name}"
    if name in DRIVE and "wave" not in scene.producers(variant):
        return Problem(
            path,
            f"{scene.name} supports only a plain sine for these outputs, but {name} describes "
            "another drive",
            "Give amplitude, alpha and beta instead, or request conveying_velocity",
        )
    if (variant, name) in NOT_OF_SHAPE:
        return Problem(path, *NOT_OF_SHAPE[variant, name])
    if name in scene_parameters(scene, variant):
        return Problem(
            path, f"{name} is not used by {', '.join(outputs)} of {scene.name}", f"Remove {name}"
        )
    users = [variant_ for variant_ in scene.variants if name in scene_parameters(scene, variant_)]
    elsewhere = f", or set {scene.choice} to {' or '.join(users)}" if users else ""
    return Problem(path, f"{name} is not used by {scene.name}", f"Remove {name}{elsewhere}")


def scene_parameters(scene: Scene, variant: str) -> tuple[str, ...]:
    """Return the parameters that a study of a variant can give, with alternatives to them."""
    parts: tuple[Equation | Condition, ...] = (*scene.variants[variant], *scene.conditions[variant])
    needed = {name for part in parts for name in part.inputs}
    for alias in ALIASES:
        if alias.gives in needed:
            needed |= set(alias.inputs)
    return tuple(name for name in QUANTITIES if name in needed and QUANTITIES[name].parameter)


Known = dict[str, Any]
"""Quantities by name: arrays that broadcast, SI units, and bundles of them."""


def too_large_is_data() -> np.errstate:
    """Return a context in which overflow gives infinity without a warning.

    What hangs on it may be no number; the compiled loops of large sweeps say nothing of it either.
    """
    return np.errstate(over="ignore", invalid="ignore")


def run_equations(plan: Plan, parameters: Mapping[str, Any], watch: Watch | None = None) -> Known:
    """Compute all equations of a plan on whole arrays; return every quantity, SI units.

    Equations that take long, such as motions, ask `watch` whether to stop.
    """
    defaults: Known = {name: np.asarray(value) for name, value in plan.defaults.items()}
    return run(plan.equations, defaults | dict(parameters), watch)


def run(equations: Iterable[Equation], quantities: Known, watch: Watch | None = None) -> Known:
    """Compute equations one after another; add their results to `quantities`, and return it."""
    with too_large_is_data():
        for equation in equations:
            watched = {"watch": watch} if equation.takes_long else {}
            quantities[equation.gives] = equation.function(
                **{name: quantities[name] for name in equation.inputs}, **watched
            )
    return quantities


def regimes(plan: Plan, quantities: Mapping[str, Any]) -> dict[str, NDArray[np.int8]]:
    """Return the regimes of the cells by each verdict of a plan, by the name of the verdict."""
    return {
        name: np.asarray(values) for name, values in regimes_of(plan.verdicts, quantities).items()
    }


def regimes_of(verdicts: Sequence[Verdict], quantities: Mapping[str, Any]) -> dict[str, Any]:
    """Return the number of each cell's regime by each verdict: the first condition that holds.

    A condition of several verdicts is looked at once. The results are int8.
    """
    results: dict[str, Any] = {}
    with too_large_is_data():
        holds = {
            condition: condition.function(**{name: quantities[name] for name in condition.inputs})
            for condition in dict.fromkeys(
                condition for verdict in verdicts for condition in verdict.conditions
            )
        }
        for verdict in verdicts:
            regime: Any = np.int8(REGIMES[verdict.otherwise].value)
            for condition in reversed(verdict.conditions):
                regime = np.where(
                    holds[condition], np.int8(REGIMES[condition.regime].value), regime
                )
            results[verdict.name] = regime
    return results
