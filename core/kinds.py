"""The kinds of study, and what carries each of them out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from core import motion, optimise, sweep
from core.dataset.table import Table
from core.optimise.exact import OPTIMUM_STATUSES
from core.quantities import MOTION_STATUSES
from core.study.load import parse_study
from core.study.models import Study
from core.sweep.pieces import Computed, carry_out
from core.sweep.prepare import Prepared
from core.sweep.verify import LEFT_OUT
from core.watch import Watch


@dataclass(frozen=True)
class Kind:
    """How studies of one kind are checked and carried out.

    Attributes
    ----------
    prepare_content : callable
        Takes what stands in a file or request; raises `StudyError` with every problem.
    prepare : callable
        The same for a study that has been read.
    compute : callable
        Takes what the first two return and a `Watch`; returns what was `Computed`.
    label : callable
        Takes what the first two return, what was computed, and a `Watch` that may stop verifying;
        returns the `Table` of results.
    """

    prepare_content: Callable[[object], Prepared]
    prepare: Callable[[Any], Prepared]
    compute: Callable[[Any, Watch], Computed]
    label: Callable[[Any, Computed, Watch], Table]


KINDS: dict[str, Kind] = {
    "sweep": Kind(sweep.prepare_content, sweep.prepare, sweep.compute, sweep.label),
    "simulate": Kind(motion.prepare_content, motion.prepare, motion.compute, motion.label),
    "optimise": Kind(optimise.prepare_content, optimise.prepare, optimise.compute, optimise.label),
}
"""Every kind of study, by the value of its key `kind`."""


STATUSES = {
    "motion_status": MOTION_STATUSES["not_computed"].value,
    "optimum_status": OPTIMUM_STATUSES["not_computed"].value,
}
"""Variables that tell of each cell whether it was computed, and their value where it was not."""


def prepare_content(content: object) -> Prepared:
    """Return the study that the content of a file or request describes, ready to be carried out.

    Raises
    ------
    StudyError
        With every problem, those of single values and those of the study as a whole.
    """
    name = content.get("kind") if isinstance(content, Mapping) else None
    kind = KINDS.get(name) if isinstance(name, str) else None
    return kind.prepare_content(content) if kind else prepare(parse_study(content))


def prepare(study: Study) -> Prepared:
    """Return a study, ready to be carried out; raise `StudyError` with every problem."""
    return KINDS[study.kind].prepare(study)


def tabulate(prepared: Prepared, watch: Watch | None = None) -> Table:
    """Return the labelled results of a prepared study."""
    kind = KINDS[prepared.study.kind]
    return carry_out(prepared, kind.compute, kind.label, watch)


def share_left_out(table: Table) -> float:
    """Return the share of the cells of a result that a stop left without computing."""
    shares = (
        np.mean(table.variables[name].values == value)
        for name, value in STATUSES.items()
        if name in table.variables
    )
    return float(next(shares, 0.0))


def is_whole(table: Table) -> bool:
    """Return whether no stop left a cell of a result without computing or verifying it."""
    return not share_left_out(table) and LEFT_OUT not in table.attributes
