"""The record of a scene: equations by variant, defaults, and the conditions of its regimes."""

import inspect
import math
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from types import MappingProxyType
from typing import Any

from vibrafeed.core.errors import SceneError
from vibrafeed.core.quantities import QUANTITIES, REGIMES
from vibrafeed.core.quantities.orienting import NUMBERED, PartAspect

Function = Callable[..., Any]

_UNIT = re.compile(r" \[[A-Za-z0-9 -]+\](?=[.,;:]|$)")
_VERB = re.compile(r"^(?:Return|True) ")


def arguments_of(function: Function) -> tuple[str, ...]:
    """Return the quantities that a function takes: its arguments without default."""
    parameters = inspect.signature(function).parameters.values()
    return tuple(each.name for each in parameters if each.default is inspect.Parameter.empty)


def _summary(says: str | None) -> str:
    # A description for users: without the first word ("Return", "True"), the units, which the
    # catalogue has beside it, and marks of code.
    paragraph = (says or "").split("\n\n")[0]
    text = _VERB.sub("", _UNIT.sub("", " ".join(paragraph.split()).replace("`", "")))
    return text[:1].upper() + text[1:]


@dataclass(frozen=True)
class Equation:
    """A pure array function, the quantity it gives, and where it comes from.

    Attributes
    ----------
    gives : str
        The quantity that it gives.
    function : callable
        The function; arrays in by keyword, array out.
    source : str
        Equation numbers of the source.
    variant : str
        The variant whose formula it is, where variants differ; else ``all``. What hangs on it is
        of that variant too (`Scene.variant_of`).
    needs : tuple of str, optional
        The quantities that it needs; the argument names of its function if left out.
    says : str, optional
        What it gives, in words; the docstring of its function if left out.
    """

    gives: str
    function: Function
    source: str
    variant: str = "all"
    needs: tuple[str, ...] | None = None
    says: str = ""

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """The names of the quantities that the equation needs, each once."""
        needs = arguments_of(self.function) if self.needs is None else self.needs
        return tuple(dict.fromkeys(needs))

    @cached_property
    def takes_long(self) -> bool:
        """True if the function simulates motion: it takes a `Watch` and has a trajectory."""
        return "watch" in inspect.signature(self.function).parameters

    @property
    def summary(self) -> str:
        """A sentence on what the equation gives, from its description."""
        return _summary(self.says or inspect.getdoc(self.function))


def _follow_path(bundle: str, path: tuple[Any, ...], **values: Any) -> Any:
    value = values[bundle]
    for step in path:
        value = getattr(value, step) if isinstance(step, str) else value[step]
    return value


def field_of(
    bundle: str, path: tuple[Any, ...], gives: str, says: str, source: str, variant: str = "all"
) -> Equation:
    """Return the equation that takes a quantity out of a bundle, one quantity of several results.

    Parameters
    ----------
    bundle : str
        The quantity that it needs, such as ``"motion"``.
    path : tuple
        The way to the field: names of fields, and places in tuples or arrays; none for a quantity
        that is another.
    gives, says, source, variant : str
        As in `Equation`; `says` as one says after "Return".
    """
    function = partial(_follow_path, bundle, path)
    return Equation(gives, function, source, variant, needs=(bundle,), says=f"Return {says}.")


def _call_renamed(function: Function, names: Mapping[str, str], **values: Any) -> Any:
    return function(**{argument: values[name] for argument, name in names.items()})


def under_names(
    gives: str, function: Function, source: str, says: str, variant: str = "all", **names: str
) -> Equation:
    """Return an equation whose arguments have the `names` of other quantities.

    One function serves several bodies or instants so. Inputs are in the order of `names`, then of
    the function; `says` is as one says after "Return".
    """
    names |= {name: name for name in arguments_of(function) if name not in names}
    renamed, needs = partial(_call_renamed, function, names), tuple(names.values())
    return Equation(gives, renamed, source, variant, needs, f"Return {says}.")


def fields(bundle: str, source: str, variant: str = "all", **rows: Any) -> tuple[Equation, ...]:
    """Return equations that take quantities out of a bundle, as `field_of` does.

    For each quantity by name, a row has the names of the fields that lead to it, and last its
    description. `source` (of the theory) and `variant` are those of all.
    """
    return tuple(
        field_of(bundle, row[:-1], gives, row[-1], source, variant) for gives, row in rows.items()
    )


@dataclass(frozen=True)
class Condition:
    """The condition of a regime, and the outputs for which it matters.

    The conditions of a scene are tried in order; the first that holds names the regime of a cell.

    Attributes
    ----------
    regime : str
        The regime where the condition holds.
    function : callable
        Returns truth values; the argument names are the quantities that it needs.
    outputs : frozenset of str
        The outputs whose meaning depends on it. If none of them is asked for, it is left out.
    otherwise : str
        The regime of the cells for which no condition holds, once this one has been tried. The
        last condition tried has the last word, but ``contact`` gives way to anything that says
        more. Empty: it says nothing about them.
    needs, says : optional
        As of an `Equation`.
    """

    regime: str
    function: Function
    outputs: frozenset[str]
    otherwise: str = ""
    needs: tuple[str, ...] | None = None
    says: str = ""

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """The names of the quantities that the condition needs."""
        return arguments_of(self.function) if self.needs is None else self.needs

    @property
    def summary(self) -> str:
        """A sentence on where the condition holds, from its description."""
        return _summary(self.says or inspect.getdoc(self.function))


STANDARD_GRAVITY = 9.80665
EXACT = ("throw_number",)
"""Outputs of which conditions are assessed, and that hold whatever these say."""


@dataclass(frozen=True)
class Constraint:
    """A relation between parameters that a study must respect.

    Attributes
    ----------
    parameters : tuple of str
        The parameters it relates; it is checked if all of them are given.
    holds : callable
        Takes the least and the largest value of each parameter, in that order, SI units, and
        returns whether the study may go on.
    message, fix : str
        What is wrong if it does not, and what would be right.
    variant : str
        The only variant that it concerns; empty for all.
    """

    parameters: tuple[str, ...]
    holds: Callable[..., bool]
    message: str
    fix: str
    variant: str = ""


STATIC_ABOVE_KINETIC = Constraint(
    ("friction_static", "friction_kinetic"),
    lambda least_static, _, __, largest_kinetic: least_static >= largest_kinetic,
    "friction_static falls below friction_kinetic",
    "Static friction is at least the kinetic one; raise it or lower the other",
)


@dataclass(frozen=True)
class MeshPart:
    """A part from a file: its volume [m3], and its aspects, the lowest centre of mass first."""

    volume: float
    aspects: tuple[PartAspect, ...]


_NOWHERE = (math.nan, math.nan, math.nan)
UNREAD = MeshPart(
    math.nan, (PartAspect(*(math.nan,) * 10, down=_NOWHERE, along=_NOWHERE),) * NUMBERED
)
"""The part of a study whose file is not known."""

MESH = "mesh"
"""The variant of a scene for a part from a file."""


@dataclass(frozen=True)
class Scene:
    """A part and its support: the equations and contacts of one system, and no others.

    Attributes
    ----------
    name, title, source, validity : str
        Name in studies, one line for people, section of the thesis, and what the model leaves out.
    variants : mapping of str to tuple of Equation
        The equations of each variant, all of them.
    default_variant : str
        The variant of a study that names none.
    conditions : mapping of str to tuple of Condition
        The conditions of each variant, most serious first.
    defaults : mapping of str to float
        Values of quantities that a study may leave out, SI units. A default of a quantity that an
        equation gives stands only where the study gives no parameter of that equation.
    constraints : tuple of Constraint
        Relations between parameters, beyond the bounds of each.
    choice : str
        The key by which a study chooses among the variants.
    variant_defaults : mapping
        Defaults of single variants, over those of all.
    seconds_a_cell : float
        Roughly what a point takes on one core by the closed forms.
    rounding_bound : int or None
        Largest error of an output in ulps over its condition number, if one is known; the tests
        hold every output to it, at random, extreme and threshold points.
    fit : callable, optional
        Of a scene whose parts are listed in the study, such as the devices of a line: takes it and
        the names of the given parameters, and returns it with those parts.
    part : MeshPart
        The part from a file, for the variant `MESH`.
    """

    name: str
    title: str
    source: str
    validity: str
    variants: Mapping[str, tuple[Equation, ...]]
    default_variant: str
    conditions: Mapping[str, tuple[Condition, ...]]
    defaults: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    constraints: tuple[Constraint, ...] = (STATIC_ABOVE_KINETIC,)
    choice: str = "variant"
    variant_defaults: Mapping[str, Mapping[str, float]] = field(
        default_factory=lambda: MappingProxyType({})
    )
    seconds_a_cell: float = 1e-8
    rounding_bound: int | None = None
    fit: "Callable[[Scene, Collection[str]], Scene] | None" = None
    part: MeshPart = UNREAD

    def fitted(self, names: Collection[str], part: MeshPart | None = None) -> "Scene":
        """Return the scene fitted to a study's parameters, and to its part from a file."""
        scene = self if part is None else replace(self, part=part)
        return scene if self.fit is None else self.fit(scene, names)

    def defaults_of(self, variant: str) -> dict[str, float]:
        """Return the default values of a variant's parameters."""
        return {**self.defaults, **self.variant_defaults.get(variant, {})}

    def __post_init__(self) -> None:
        if self.default_variant not in self.variants or set(self.conditions) != set(self.variants):
            raise SceneError(f"{self.name}: variants, default and conditions do not match")
        for variant in self.variants:
            self._check(variant)

    def producers(self, variant: str) -> dict[str, Equation]:
        """Return the equation that gives each quantity of a variant."""
        return {equation.gives: equation for equation in self.variants[variant]}

    def outputs(self, variant: str) -> tuple[str, ...]:
        """Return the outputs of a variant, `regime` last."""
        quantities = {name: QUANTITIES[name] for name in self.producers(variant)}
        outputs = (n for n, each in quantities.items() if not (each.bundle or each.parameter))
        return (*outputs, "regime")

    def variant_of(self, variant: str, output: str) -> str:
        """Return the variant whose formula an output uses when `variant` is chosen.

        The physical variant has no law of its own for the velocity after a distance, for example,
        and takes the derived one.
        """
        # What an equation of one variant needs is of that variant too: it is not looked at.
        steps = behind(
            (output,), self.producers(variant).get, lambda equation: equation.variant == "all"
        )
        variants = {step.variant for step in steps.values() if step is not None} - {"all"}
        return variants.pop() if len(variants) == 1 else variant

    def _check(self, variant: str) -> None:
        place = f"{self.name} ({variant})"
        for names, message in self._misplaced_names(variant):
            if names:
                raise SceneError(f"{place}: {message.format(sorted(names))}")
        gives = [equation.gives for equation in self.variants[variant]]
        try:
            behind(gives, self.producers(variant).get)
        except CycleError as error:
            raise SceneError(f"{place}: {error}") from None

    def _misplaced_names(self, variant: str) -> Iterator[tuple[set[str], str]]:
        """Yield names that are wrong, and a message with a place for them; the set may be empty."""
        equations, conditions = self.variants[variant], self.conditions[variant]
        gives = [equation.gives for equation in equations]
        yield {name for name in gives if gives.count(name) > 1}, "two equations give {}"
        parts: tuple[Equation | Condition, ...] = (*equations, *conditions)
        needed = {name for part in parts for name in part.inputs}
        undeclared = (needed | set(gives)) - set(QUANTITIES)
        undeclared |= {condition.regime for condition in conditions} - set(REGIMES)
        yield undeclared, "{} are not declared"
        parameters = {name for name, quantity in QUANTITIES.items() if quantity.parameter}
        parameters |= {*self.defaults_of(variant)}
        yield needed - set(gives) - parameters, "nothing gives {}"
        concerned = {name for condition in conditions for name in condition.outputs}
        outputs = {name for each in self.variants for name in self.outputs(each)}
        yield concerned - outputs, "conditions name {}, which no variant gives"


class CycleError(ValueError):
    """A quantity needs itself."""


def behind(
    wanted: Iterable[str],
    producer: Callable[[str], Equation | None],
    enters: Callable[[Equation], bool] = lambda equation: True,
) -> Mapping[str, Equation | None]:
    """Return the wanted quantities and all that they depend on, in order of computation.

    Each has the equation that `producer` returns for its name, or None if it has to be given from
    outside. The inputs of equations that `enters` refuses are not looked at.

    Raises
    ------
    CycleError
        If a quantity needs itself.
    """
    steps: dict[str, Equation | None] = {}

    def visit(name: str, path: tuple[str, ...]) -> None:
        if name in path:
            raise CycleError(" needs ".join((*path, name)))
        if name in steps:
            return
        step = producer(name)
        if step is not None and enters(step):
            for needed in step.inputs:
                visit(needed, (*path, name))
        steps[name] = step

    for name in wanted:
        visit(name, ())
    return steps


def between(
    steps: Collection[Equation], sources: Collection[str], targets: Collection[str]
) -> tuple[Equation, ...]:
    """Return the equations that lead from some quantities to others, in order of computation.

    They are those that change if one of the `sources` changes, as far as the `targets` need them.
    """
    changed, path = {*sources}, []
    for step in behind(targets, {step.gives: step for step in steps}.get).values():
        if step is not None and step.gives not in sources and changed & {*step.inputs}:
            changed.add(step.gives)
            path.append(step)
    return tuple(path)
