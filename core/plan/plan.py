"""The plan: the equations of one scene that the asked outputs pull, in order, and no others."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.plan.verdicts import Verdict, verdicts_of
from vibrafeed.core.quantities import QUANTITIES, REGIMES
from vibrafeed.core.quantities.drive import DRIVE
from vibrafeed.core.quantities.flags import REGIME
from vibrafeed.core.quantities.motion import FEEDING, RESULTS
from vibrafeed.core.scenes import ALIASES, SCENES, Condition, Equation, Scene
from vibrafeed.core.scenes.aliases import ALTERNATIVES, BESIDE, NEEDS, NOT_OF_SHAPE, WRITTEN_AS
from vibrafeed.core.scenes.graph import behind
from vibrafeed.core.suggestions import Suggestions, by_synonym, suggestion


@dataclass(frozen=True)
class Plan:
    """The equations that run for a set of outputs.

    Attributes
    ----------
    scene : Scene
        The scene.
    variant : str
        The variant in force.
    outputs : tuple of str
        The asked outputs, without verdicts.
    equations : tuple of Equation
        The equations to run, each after those that it needs.
    verdicts : tuple of Verdict
        The flag variables of the result, each with the outputs that it judges; ``regime`` first.
    parameters : tuple of str
        The given parameters that the equations and conditions need.
    defaults : mapping of str to float
        Values that stand in for what is not given, SI units.
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
        return tuple(dict.fromkeys(one for verdict in self.verdicts for one in verdict.conditions))

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
        return next((one for one in self.verdicts if output in one.outputs), None)

    def only(self, output: str) -> Plan:
        """Return the plan of one output alone, with the equations and parameters that it needs.

        Plans are kept for the next call.
        """
        known = self._known_parts
        if output not in known:
            known[output] = _Walk(self.scene, self.variant, self.parameters, (output,)).plan()
        return known[output]

    def part(self, names: Collection[str]) -> Plan:
        """Return a smaller plan: the equations that some outputs and verdicts of this plan need.

        `names` are names of quantities and of verdicts. Parameters and defaults are limited to
        what these equations take.
        """
        verdicts = tuple(verdict for verdict in self.verdicts if verdict.name in names)
        outputs = tuple(name for name in names if name not in self.verdict_names)
        wanted = [*outputs, *(name for verdict in verdicts for name in verdict.inputs)]
        needed = behind(wanted, {e.gives: e for e in self.equations}.get)
        return replace(
            self,
            outputs=outputs,
            equations=tuple(e for e in self.equations if e.gives in needed),
            verdicts=verdicts,
            parameters=tuple(name for name in self.parameters if name in needed),
            defaults={name: value for name, value in self.defaults.items() if name in needed},
        )

    def depends_on(self, axes: Collection[str]) -> dict[str, frozenset[str]]:
        """Return the axes on which each quantity and each verdict of the plan depend, by name.

        `axes` are the parameters with several values. A quantity is computed over its own axes
        only, which saves most of the work on a large grid. Results are kept for the next call.
        """
        names = tuple(axes)
        if names not in self._known_axes:
            self._known_axes[names] = self._depends_on(names)
        return dict(self._known_axes[names])

    @cached_property
    def _known_parts(self) -> dict[str, Plan]:
        return {}

    @cached_property
    def _known_axes(self) -> dict[tuple[str, ...], dict[str, frozenset[str]]]:
        return {}

    def _depends_on(self, axes: Collection[str]) -> dict[str, frozenset[str]]:
        known = {name: frozenset({name} & set(axes)) for name in self.parameters}
        known.update(dict.fromkeys(self.defaults, frozenset()))
        for equation in self.equations:
            known[equation.gives] = frozenset().union(*(known[name] for name in equation.inputs))
        for verdict in self.verdicts:
            known[verdict.name] = frozenset().union(*(known[name] for name in verdict.inputs))
        return known


def find_scene(
    name: str, variant: str | None, scenes: Mapping[str, Scene] = SCENES
) -> tuple[Scene, str]:
    """Return the named scene and the chosen variant of its equations, the default one for None.

    `scenes` are those to look in, by name.

    Raises
    ------
    StudyError
        If there is no such scene or variant.
    """
    scene, variant, problems = choose_scene(name, variant, scenes)
    if problems:
        raise StudyError(problems)
    return scene, variant


def choose_scene(
    name: str, variant: str | None, scenes: Mapping[str, Scene] = SCENES
) -> tuple[Scene, str, list[Problem]]:
    """Return the named scene, the variant of its equations, and the problems of the variant's name.

    An unknown variant gives way to the default, so that the rest of a study can be checked.
    `scenes` are those to look in. Raises `StudyError` if there is no such scene.
    """
    scene = scenes.get(name)
    if scene is None:
        is_scene = name in SCENES
        message = f"'{name[:60]}' {'cannot be simulated' if is_scene else 'is not a scene'}"
        fix = f"Known: {', '.join(scenes)}" if is_scene else suggestion(name, scenes)
        raise StudyError([Problem("scene", message, fix)])
    if variant is None or variant in scene.variants:
        return scene, variant or scene.default_variant, []
    message = f"{scene.name} has no {scene.choice} '{variant[:60]}'"
    problem = Problem(scene.choice, message, suggestion(variant, scene.variants))
    return scene, scene.default_variant, [problem]


def make_plan(
    scene_name: str, variant: str | None, outputs: Collection[str], parameters: Collection[str]
) -> Plan:
    """Return the plan for outputs of a named scene, given the names of a study's parameters.

    Raises
    ------
    StudyError
        With every problem: unknown scene, variant or output, missing and unused parameters.
    """
    return plan_scene(*find_scene(scene_name, variant), outputs, parameters)


def plan_scene(
    scene: Scene, variant: str, outputs: Collection[str], parameters: Collection[str]
) -> Plan:
    """Return the plan for outputs of a scene, given the names of a study's parameters.

    Raises `StudyError` with every problem: unknown outputs, parameters that are missing, unused, or
    set twice.
    """
    scene = scene.fitted(parameters)
    gives, suggest = scene.outputs(variant), Suggestions()
    problems = [
        *(_unknown_output(scene, variant, name, suggest) for name in outputs if name not in gives),
    ]
    known_outputs = tuple(name for name in dict.fromkeys(outputs) if name in gives)
    walk = _Walk(scene, variant, parameters, known_outputs)
    problems += _doubled(parameters, walk.missing)
    problems += [_missing(scene, name, user) for name, user in walk.missing.items()]
    if known_outputs:  # otherwise nothing is known to be used, and every parameter would be blamed
        blamed = {problem.place.removeprefix("parameters.") for problem in problems}
        unused = (name for name in parameters if name not in walk.used | blamed)
        problems += [_unused(scene, variant, name, known_outputs) for name in unused]
    if problems:
        raise StudyError(problems)
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
        self.conditions = tuple(
            condition for condition in scene.conditions[variant] if condition.outputs & set(outputs)
        )
        for name in outputs:
            if name != REGIME:
                self.visit(name)
        for condition in self.conditions:
            for name in condition.inputs:
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
        equation = self._producer(name)
        if name in self.parameters:
            self.used.add(name)
        elif equation is not None:
            for needed in equation.inputs:
                self.visit(needed, name)
            self.equations.append(equation)
        elif name in self.scene_defaults:
            self.defaults[name] = self.scene_defaults[name]
        else:
            self.missing[name] = user

    def _producer(self, name: str) -> Equation | None:
        for alias in ALIASES:
            asked = {one for one in alias.inputs if QUANTITIES[one].parameter} - BESIDE
            if alias.gives == name and asked <= set(self.parameters):
                return alias
        equation = self.producers.get(name)
        if equation is not None and name in self.scene_defaults:
            # A default of a derived quantity: the equation runs only if the study speaks of it.
            spoken_of = name in self.outputs or set(equation.inputs) & set(self.parameters)
            return equation if spoken_of or self._tells(equation.inputs) else None
        return equation

    def _tells(self, names: Collection[str]) -> bool:
        parameters = set(self.parameters)
        followed = (self.producers.get(name) for name in names if QUANTITIES[name].parameter)
        return any(one is not None and set(one.inputs) <= parameters for one in followed)


def _unknown_output(scene: Scene, variant: str, name: str, suggest: Suggestions) -> Problem:
    others = [v for v in scene.variants if name in scene.outputs(v)]
    if others:
        return Problem(
            "outputs",
            f"the {scene.choice} '{variant}' of {scene.name} does not give '{name}'",
            f"Set {scene.choice} to {' or '.join(others)}",
            about=name,
        )
    elsewhere = _of_another_kind(scene, variant, name)
    if elsewhere is not None:
        return elsewhere
    return Problem(
        "outputs",
        f"{scene.name} has no output '{name[:60]}'",
        suggest(name, scene.outputs(variant)),
        about=name,
    )


def _of_another_kind(scene: Scene, variant: str, name: str) -> Problem | None:
    closed = SCENES.get(scene.name)
    if scene.choice == "method" and closed is not None:
        here, there, kind = "simulation", "sweep", "sweep"
        gives = name in closed.outputs(closed.default_variant)
    else:
        here, there, kind = "sweep", "simulation", "simulate"
        gives = name in RESULTS or name in FEEDING
    if not gives:
        return None
    other = by_synonym(name, scene.outputs(variant))
    message = f"a {there} gives {name}"
    if other is None:
        return Problem("outputs", f"{message}, a {here} does not", f'Set kind = "{kind}"', name)
    message += f"; a {here} gives {other}"
    return Problem("outputs", message, f'Ask for {other} in outputs, or set kind = "{kind}"', name)


def _doubled(parameters: Collection[str], missing: Collection[str]) -> list[Problem]:
    problems = []
    for name, others in ALTERNATIVES:
        doubled = [other for other in others if name in parameters and other in parameters]
        if doubled:
            problems.append(
                Problem(
                    f"parameters.{name}",
                    f"{name} and {' and '.join(doubled)} set the same quantity",
                    f"Give either {name} or {' and '.join(others)}",
                )
            )
    for name, (needed, message, example) in NEEDS.items():
        if name in parameters and needed not in {*parameters, *missing}:
            problems.append(Problem(f"parameters.{name}", message, f"Add {needed} = {example}"))
    return problems


def _missing(scene: Scene, name: str, needed_by: str) -> Problem:
    written = WRITTEN_AS.get(name, name)
    quantity = QUANTITIES[written]
    is_inner = needed_by not in QUANTITIES or QUANTITIES[needed_by].bundle
    needed = f"{scene.name} needs it"
    if not is_inner:
        needed = f"{needed_by.replace('_', ' ')} of {needed}"
    example = quantity.examples[0] if quantity.unit == "1" else f'"{quantity.examples[0]}"'
    return Problem(
        f"parameters.{written}",
        f"it is missing; {needed} ({quantity.description.removesuffix('.')})",
        f"Add, for example, {written} = {example}",
    )


def _unused(scene: Scene, variant: str, name: str, outputs: Collection[str]) -> Problem:
    if name in DRIVE and "wave" not in scene.producers(variant):
        fix = "Give amplitude, alpha and beta instead, or ask for the conveying_velocity of a part"
        message = (
            f"{scene.name} supports only the plain sine here, and {name} belongs to another drive"
        )
        return Problem(f"parameters.{name}", message, fix)
    if (variant, name) in NOT_OF_SHAPE:
        message, fix = NOT_OF_SHAPE[variant, name]
        return Problem(f"parameters.{name}", message, fix)
    takes_part = name in scene_parameters(scene, variant)
    what = f"{', '.join(outputs)} of {scene.name}" if takes_part else scene.name
    users = [one for one in scene.variants if name in scene_parameters(scene, one)]
    elsewhere = f", or set {scene.choice} to {' or '.join(users)}" if users else ""
    fix = "Remove it" + (elsewhere if not takes_part else "")
    return Problem(f"parameters.{name}", f"{name} is not used by {what}", fix)


def scene_parameters(scene: Scene, variant: str) -> tuple[str, ...]:
    """Return the names of the parameters that a study of a scene's variant can give.

    They are those that its equations or conditions use, and alternatives to them such as stroke for
    amplitude.
    """
    parts: tuple[Equation | Condition, ...] = (*scene.variants[variant], *scene.conditions[variant])
    needed = {name for part in parts for name in part.inputs}
    for alias in ALIASES:
        if alias.gives in needed:
            needed |= set(alias.inputs)
    return tuple(name for name in QUANTITIES if name in needed and QUANTITIES[name].parameter)
