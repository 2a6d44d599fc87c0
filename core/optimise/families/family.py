"""The record of a family: problems of one kind whose best angles are known (theory 12)."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from vibrafeed.core.optimise.families.optimum import Optimum, ParetoSet
from vibrafeed.core.optimise.kernels.columns import Kept
from vibrafeed.core.study.optimise_study import Criterion

Closed = Callable[..., Optimum | ParetoSet]
"""A closed form; its arguments are what it needs of a design."""


@dataclass(frozen=True)
class Family:
    """Problems of one kind whose best angles are known.

    Attributes
    ----------
    name : str
        Its name.
    systems : tuple
        Scene, variant and the output that is to be largest, of each problem.
    closed : mapping
        Closed forms by the criterion that they solve: both angles from 0 to 90 degrees.
    batch : tuple
        The criteria that the batch solver solves; of a front, each of its points.
    kernel : callable or None
        Makes the record by whose type compiled code finds the family; it holds the kept contacts.
    against : str or None
        The output whose absolute value can be kept low.
    contacts : frozenset of str
        Contacts that a study has to keep.
    """

    name: str
    systems: tuple[tuple[str, str, str], ...]
    closed: Mapping[type[Criterion], Closed] = field(hash=False)
    batch: tuple[type[Criterion], ...] = ()
    kernel: Callable[..., Kept] | None = None
    against: str | None = "acceleration_y"
    contacts: frozenset[str] = frozenset()

    def closed_optimum(
        self, criterion: Criterion, values: Mapping[str, Any]
    ) -> Optimum | ParetoSet:
        """Return the closed-form optimum of drive angles, or trade-off front, for a criterion.

        `values` has all inputs of the designs by name, arrays (cells,) in SI units; the formula
        takes those it needs.
        """
        form = self.closed[type(criterion)]
        parameters = inspect.signature(form).parameters.values()
        needed = [p.name for p in parameters if p.default is inspect.Parameter.empty]
        return form(**{name: values[name] for name in needed})
