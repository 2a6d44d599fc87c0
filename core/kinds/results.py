"""Studies of any kind carried out, and what their results say of themselves."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from vibrafeed.core import lazy  # whose modules load dask when they are needed
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.plan.labels import FAILED, LEFT_OUT
from vibrafeed.core.plan.pieces import carry_out
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.quantities import STATUSES
from vibrafeed.core.study.grid_study import Study
from vibrafeed.core.watch import Watch

if TYPE_CHECKING:
    import xarray


def prepare(study: Study) -> Prepared:
    """Return a prepared study; raise `StudyError` with every problem."""
    return KINDS[study.kind].prepare(study)


def tabulate(prepared: Prepared, watch: Watch | None = None) -> Table:
    """Compute a prepared study and return its labelled results; `watch` may stop it."""
    kind = KINDS[prepared.study.kind]
    return carry_out(prepared, kind.compute, kind.label, watch)


def run_study(study: Study, *, watch: Watch | None = None) -> "xarray.Dataset":
    """Compute a study and return its dataset; `watch` may stop it.

    Examples
    --------
    >>> from vibrafeed.core.intake import load_study
    >>> from vibrafeed.core.kinds import run_study
    >>> dataset = run_study(load_study("configs/figures/fig-5-1.toml"))
    """
    return tabulate(prepare(study), watch).to_xarray()


def open_lazily(prepared: Prepared) -> "xarray.Dataset":
    """Return the dataset of a study of any size, whose values dask computes when they are read.

    Raises
    ------
    StudyError
        If its cells cannot be computed one by one.
    """
    prepared.check_lazy("Leave it out, or carry out the study")
    return lazy.dataset.dataset(prepared, outline(prepared))


def outline(prepared: Prepared, watch: Watch | None = None) -> Table:
    """Return the result of the first cell of a study, with the attributes of the whole.

    Some cells are verified if the study asks for it, which `watch` may stop.
    """
    first_cell = dict.fromkeys(prepared.grid.axes, (0, 1))
    table = tabulate(prepared.within(first_cell).unverified()).with_price({})
    verified = KINDS[prepared.study.kind].verified(prepared, watch or Watch())
    study_attributes = {"study": prepared.study.canonical(), "study_sha256": prepared.study.key()}
    return replace(table, attributes={**table.attributes, **study_attributes, **verified})


def share_left_out(table: Table) -> float:
    """Return the share of cells, 0 to 1, of a result that were not computed before a stop.

    `table` is the result of a study, with a variable of statuses; 0 without one.
    """
    shares = (
        np.mean(table.variables[name].values == value)
        for name, value in STATUSES.items()
        if name in table.variables
    )
    return float(next(shares, 0.0))


def not_verified(table: Table) -> int:
    """Return the number of verified cells whose error exceeds the stated one."""
    return int(table.attributes.get(FAILED, 0))


def is_whole(table: Table) -> bool:
    """True if every cell of a result is computed and, if asked for, verified."""
    return not share_left_out(table) and LEFT_OUT not in table.attributes
