"""The one walk through equations, from what is wanted back to what is given."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Protocol, TypeVar


class Step(Protocol):
    """An equation: it gives one quantity from others."""

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the quantities that the equation needs."""
        ...


class Giver(Step, Protocol):
    """A step that knows what it gives."""

    @property
    def gives(self) -> str:
        """Name of the quantity that the equation gives."""
        ...


Some = TypeVar("Some", bound=Step)
Known = TypeVar("Known", bound=Giver)


class CycleError(ValueError):
    """A quantity needs itself; `path` leads from it to itself."""

    def __init__(self, path: tuple[str, ...]):
        super().__init__(" needs ".join(path))
        self.path = path


def behind(
    wanted: Iterable[str],
    producer: Callable[[str], Some | None],
    enters: Callable[[Some], bool] = lambda step: True,
) -> Mapping[str, Some | None]:
    """Return the wanted quantities and all that they depend on, in order of computation.

    Parameters
    ----------
    wanted : iterable of str
        Names of quantities.
    producer : callable
        Takes the name of a quantity; returns the step that gives it, which has `inputs`; None if it
        has to be given from outside.
    enters : callable
        Takes a step; False stops there, without looking at its inputs.

    Returns
    -------
    mapping of str to Step or None
        The step that gives each quantity, in an order in which they can be computed.

    Raises
    ------
    CycleError
        If a quantity needs itself.
    """
    met: dict[str, Some | None] = {}

    def visit(name: str, path: tuple[str, ...]) -> None:
        """Add a quantity after all that it depends on; raise `CycleError` for a cycle."""
        if name in path:
            raise CycleError((*path, name))
        if name in met:
            return
        step = producer(name)
        if step is not None and enters(step):
            for needed in step.inputs:
                visit(needed, (*path, name))
        met[name] = step

    for name in wanted:
        visit(name, ())
    return met


def between(
    steps: Collection[Known], sources: Collection[str], targets: Collection[str]
) -> tuple[Known, ...]:
    """Return the equations that lead from some quantities to others, in order of computation.

    They are those that change if one of the `sources` changes, as far as the `targets` need them.
    """
    changes, way = {*sources}, []
    for one in behind(targets, {one.gives: one for one in steps}.get).values():
        if one is not None and one.gives not in sources and changes & {*one.inputs}:
            changes.add(one.gives)
            way.append(one)
    return tuple(way)
