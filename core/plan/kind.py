"""The record of a kind of study, which its own package exports as `KIND`."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, NamedTuple

from vibrafeed.core.dataset.table import Table
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.plan.prepared import Chosen, Prepared
from vibrafeed.core.scenes import Scene
from vibrafeed.core.study.grid_study import Study
from vibrafeed.core.watch import Watch


class Sketch(NamedTuple):
    """The names in a study, or in content that is no sound study yet.

    `names` are the parameters that it gives or leaves open, wherever they stand.
    """

    scene: str
    variant: str | None
    method: str | None
    outputs: Collection[str]
    names: Collection[str]


@dataclass(frozen=True)
class Kind:
    """All that the rest of the program knows of a kind of study.

    Attributes
    ----------
    name : str
        The value of the key `kind`.
    title, description : str
        What lists of kinds show: a few words, and a sentence or two.
    model : type
        The model of its studies.
    scenes : tuple of mapping
        Where its scenes are; the first names all of them, others give further outputs.
    example : mapping
        A short study that is carried out at once.
    prepare : callable
        Takes a study; returns it prepared, or raises `StudyError` with every problem.
    choose : callable
        Takes a `Sketch`; returns the scene, the variant or method in force, and what is wrong with
        the one that is named. Raises `StudyError` without a scene.
    compute : callable
        Takes what `prepare` returns and a `Watch`; returns what was `Computed`.
    label : callable
        Takes what `prepare` returns, what was computed, and a `Watch` that may stop verifying;
        returns the `Table` of results.
    choices : mapping of str to iterable of str
        Values of keys that are no scenes, variants or outputs, and that the model does not list.
    is_measured : bool
        True if error against run time is measured for its studies (`vibrafeed.core.report`).
    verified : callable
        Takes what `prepare` returns and a `Watch`; returns the verification of random cells, which
        are computed alone, as attributes.
    compiles : mapping of str to tuple of mapping
        Studies that need every kernel of the kind; each group has its own.
    """

    name: str
    title: str
    description: str
    model: type[Study]
    scenes: tuple[Mapping[str, Scene], ...]
    example: Mapping[str, Any]
    prepare: Callable[[Any], Prepared]
    choose: Callable[[Sketch], Chosen]
    compute: Callable[[Any, Watch], Computed]
    label: Callable[[Any, Computed, Watch], Table]
    choices: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: MappingProxyType({}))
    is_measured: bool = False
    verified: Callable[[Any, Watch], Mapping[str, Any]] = lambda _prepared, _watch: {}
    compiles: Mapping[str, tuple[Mapping[str, Any], ...]] = field(
        default_factory=lambda: MappingProxyType({})
    )
