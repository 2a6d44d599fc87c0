"""Studies of any kind carried out, and what their results say of themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from core.dataset.table import Table
from core.kinds import KINDS
from core.plan.pieces import carry_out
from core.plan.prepared import Prepared
from core.plan.sample import FAILED, LEFT_OUT
from core.quantities import STATUSES
from core.study.grid_study import Study
from core.watch import Watch

if TYPE_CHECKING:
    import xarray


def prepare(study: Study) -> Prepared:
    """Return a study, ready to be carried out; raise `StudyError` with every problem."""
    return KINDS[study.kind].prepare(study)


def tabulate(prepared: Prepared, watch: Watch | None = None) -> Table:
    """Return the labelled results of a prepared study."""
    kind = KINDS[prepared.study.kind]
    return carry_out(prepared, kind.compute, kind.label, watch)


def run_study(study: Study, *, watch: Watch | None = None) -> xarray.Dataset:
    """Return the dataset of a study; `watch` may stop it early.

    Examples
    --------
    >>> from core.intake import load_study
    >>> from core.kinds import run_study
    >>> dataset = run_study(load_study("configs/figures/fig-5-1.toml"))
    """
    return tabulate(prepare(study), watch).to_xarray()


def share_left_out(table: Table) -> float:
    """Return the share of the cells of a result that a stop left without computing."""
    shares = (
        np.mean(table.variables[name].values == value)
        for name, value in STATUSES.items()
        if name in table.variables
    )
    return float(next(shares, 0.0))


def not_verified(table: Table) -> int:
    """Return the number of cells of a result that are further off than their error allows."""
    return int(table.attributes.get(FAILED, 0))


def is_whole(table: Table) -> bool:
    """True if no stop left a cell of a result without computing or verifying it."""
    return not share_left_out(table) and LEFT_OUT not in table.attributes
