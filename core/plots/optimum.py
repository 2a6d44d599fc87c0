"""The optimisation that a dataset carries."""

from __future__ import annotations

from typing import Any

import xarray

from vibrafeed.core.intake import parse_json
from vibrafeed.core.optimise import Optimisation
from vibrafeed.core.optimise.prepare import prepare
from vibrafeed.core.plots.problem import PlotError
from vibrafeed.core.study import OptimiseStudy


def is_optimum(dataset: xarray.Dataset) -> bool:
    """True if a dataset is the result of an optimisation."""
    return "optimum_status" in dataset


def prepared_of(dataset: xarray.Dataset) -> Optimisation:
    """Return the optimisation, checked and planned again, of which a dataset is the result.

    The study is read from the dataset's attributes.

    Raises
    ------
    PlotError
        If the dataset is not the result of an optimisation.
    """
    text: Any = dataset.attrs.get("study", "")
    study = parse_json(text) if is_optimum(dataset) else None
    if not isinstance(study, OptimiseStudy):
        fix = "Draw what `vibrafeed run` wrote of a study of kind 'optimise'"
        raise PlotError("dataset", "the dataset is not the result of an optimisation", fix)
    return prepare(study)
