"""A lazy dataset is that of the study in memory, block by block."""

import dask
import numpy as np
import pytest
import xarray

from large_studies import MOTION, TRACK, sweep_of
from refusals import places_of
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import open_lazily, tabulate
from vibrafeed.core.kinds.results import outline
from vibrafeed.core.lazy import dataset as module
from vibrafeed.core.lazy.dataset import chunks_of, dataset, fields_of


@pytest.mark.parametrize(
    ("content", "cells"), [(TRACK, None), (TRACK, 700), (MOTION, None), (MOTION, 54)]
)
def test_it_is_the_dataset_in_memory(content, cells, monkeypatch):
    prepared = prepare_content(content)
    lazy = dataset(prepared, outline(prepared), cells=cells)
    whole = tabulate(prepared).with_price({}).to_xarray()
    assert {lazy[name].dtype for name in prepared.plan.verdict_names} == {np.dtype(np.int8)}
    assert lazy.attrs.keys() - {"elapsed_seconds", "cells_per_second"} == whole.attrs.keys()
    for name, variable in whole.variables.items():
        told = lazy.variables[name].attrs
        assert told.keys() == variable.attrs.keys()
        assert all(np.array_equal(told[key], variable.attrs[key]) for key in told)
    followed = []
    evaluate = module.evaluate_at_once

    def evaluated(plan, grid, into, watch):
        followed.append(grid.cells)
        evaluate(plan, grid, into, watch)

    monkeypatch.setattr(module, "evaluate_at_once", evaluated)
    xarray.testing.assert_equal(lazy.compute(), whole)
    # A motion is followed once for all variables.
    assert sum(followed) == (prepared.cells if content is MOTION else 0)


def test_blocks_are_equal_but_for_the_last_and_hold_whole_axes_first():
    prepared = prepare_content(sweep_of(1000))
    field = fields_of(prepared)[0]
    chunks = chunks_of(prepared, field, 4_000_000, ["frequency", "alpha"])
    assert chunks["frequency"] == chunks["alpha"] == (1000,)
    assert chunks["beta"] == (4,) * 250
    for lengths in chunks_of(prepared, field, 70_000).values():
        assert len({*lengths[:-1]}) <= 1
        assert lengths[-1] <= lengths[0]


@pytest.mark.parametrize(
    ("change", "place"),
    [({"trajectory": 10}, "trajectory"), ({"sensitivities": ["beta"]}, "sensitivities")],
)
def test_what_is_computed_as_a_whole_is_refused(change, place):
    one = {"frequency": 50, "amplitude": 2e-4, "beta": 30, "friction": 0.4}
    assert places_of(
        lambda: open_lazily(prepare_content({**MOTION, "parameters": one, **change}))
    ) == [place]


def test_a_reduction_takes_no_cluster_that_nobody_has_named():
    """A service makes a client of Dask in its process; a reduction there once waited for it."""

    def never(*_, **__):
        raise AssertionError

    prepared = prepare_content({**MOTION, "reduce": {"over": ["beta"], "statistics": ["max"]}})
    with dask.config.set(scheduler=never):
        assert tabulate(prepared).variables["conveying_velocity_max"].values.shape == (2, 9, 2)
