"""Verdicts: the flag variables of a result, one for all outputs that share a validity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.quantities.flags import REGIME
from vibrafeed.core.scenes import EXACT, Condition


@dataclass(frozen=True)
class Verdict:
    """A flag variable of a result: the regime of the outputs that share a validity.

    Attributes
    ----------
    name : str
        ``regime``, or ``regime_<output>`` after the first of its outputs.
    outputs : tuple of str
        The outputs that it judges; none of `EXACT`, which hold in every regime.
    conditions : tuple of Condition
        The conditions in the order of the scene; the first that holds names the regime.
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
        said = [condition.otherwise for condition in self.conditions if condition.otherwise]
        more = [name for name in said if name != "contact"]
        return (more or said or ["not_assessed"])[-1]

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """The names of the quantities that its conditions need."""
        return tuple(dict.fromkeys(name for one in self.conditions for name in one.inputs))

    @cached_property
    def doubts(self) -> bool:
        """True if one of the regimes does not describe a real part."""
        return not all(REGIMES[name].valid for name in self.regimes)


def verdicts_of(conditions: Sequence[Condition], outputs: Sequence[str]) -> tuple[Verdict, ...]:
    """Return the verdicts on outputs, that on the contact first; always at least one.

    Outputs share a verdict if the same conditions judge them. A condition judges if its regime is
    not valid or speaks of single outputs; one that tells the state of the part, such as stick,
    parts no outputs. What holds in every regime (`EXACT`) has no verdict of its own.

    Parameters
    ----------
    conditions : sequence of Condition
        The conditions of the scene.
    outputs : sequence of str
        The outputs in the order of the scene; ``regime`` among them stands for the contact.
    """
    of_contact = {*_judging(conditions, REGIME)}
    concerned = [name for name in outputs if any(name in one.outputs for one in conditions)]
    groups: dict[tuple[Condition, ...], list[str]] = {}
    for name in concerned:
        if name not in EXACT:
            groups.setdefault(_judging(conditions, name), []).append(name)
    if not groups:
        groups[()] = concerned or list(outputs)
    # The one nearest to the contact: it shares most with it, and asks least besides.
    first = max(groups, key=lambda one: (len(of_contact & {*one}), -len({*one} - of_contact)))
    ordered = {first: groups.pop(first), **groups}
    return tuple(
        Verdict(
            REGIME if judging is first else f"{REGIME}_{names[0]}",
            tuple(name for name in names if name not in (REGIME, *EXACT)),
            tuple(one for one in conditions if one.outputs & set(names)),
        )
        for judging, names in ordered.items()
    )


def _judging(conditions: Sequence[Condition], output: str) -> tuple[Condition, ...]:
    concerned = (one for one in conditions if output in one.outputs)
    return tuple(one for one in concerned if REGIMES[one.regime].judges)
