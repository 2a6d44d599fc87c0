"""A lazy dataset is that of the study in memory, block by block."""

from __future__ import annotations

import tracemalloc
from typing import Any

import dask
import numpy as np
import pytest
import xarray

import vibrafeed
from large_studies import MOTION, TRACK, sweep_of
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import open_lazily, tabulate
from vibrafeed.core.kinds.results import outline
from vibrafeed.core.lazy.dataset import chunks_of, dataset, fields_of


@pytest.mark.parametrize("content", [TRACK, MOTION], ids=["sweep", "motion"])
@pytest.mark.parametrize("cells", [None, 100, 7])
def test_it_is_the_dataset_in_memory(content: dict[str, Any], cells: int | None) -> None:
    prepared = prepare_content(content)
    lazy = dataset(prepared, outline(prepared), cells=cells)
    whole = tabulate(prepared).with_price({}).to_xarray()
    assert {lazy[name].dtype for name in prepared.plan.verdict_names} == {np.dtype(np.int8)}
    xarray.testing.assert_equal(lazy.compute(), whole)
    assert lazy.attrs.keys() - {"elapsed_seconds", "cells_per_second"} == whole.attrs.keys()
    for name, variable in whole.variables.items():
        told = lazy.variables[name].attrs
        assert told.keys() == variable.attrs.keys()
        assert all(np.array_equal(told[key], variable.attrs[key]) for key in told)


def test_blocks_are_equal_but_for_the_last_and_hold_whole_axes_first() -> None:
    prepared = prepare_content(sweep_of(1000))
    field = fields_of(prepared)[0]
    chunks = chunks_of(prepared, field, 4_000_000, ["frequency", "alpha"])
    assert chunks["frequency"] == chunks["alpha"] == (1000,)
    assert chunks["beta"] == (4,) * 250
    for lengths in chunks_of(prepared, field, 70_000).values():
        assert len({*lengths[:-1]}) <= 1
        assert lengths[-1] <= lengths[0]


def test_slices_of_a_huge_one() -> None:
    lazy = open_lazily(prepare_content(sweep_of(1000)))
    assert lazy.acceleration_x.size == 10**12
    piece = lazy.transport_velocity.isel(amplitude=500, alpha=300)
    piece = piece.sel(frequency=[20, 120]).isel(beta=slice(None, None, 333)).load()
    parameters = TRACK["parameters"] | {
        name: piece.coords[name].values.tolist()
        for name in ("frequency", "amplitude", "alpha", "beta")
    }
    expected = tabulate(prepare_content({**TRACK, "parameters": parameters})).variables
    np.testing.assert_array_equal(piece.values, expected["transport_velocity"].values)


def test_a_reduction_needs_the_memory_of_a_few_blocks() -> None:
    lazy = open_lazily(prepare_content(sweep_of(100)))
    assert lazy.nbytes > 1.8e9
    lazy.throw_number.isel(frequency=0).max().compute()  # what is loaded and compiled once
    tracemalloc.start()
    try:
        with dask.config.set(num_workers=2):
            found = lazy.acceleration_x.isel(frequency=slice(4)).max(["alpha", "beta"]).compute()
        assert tracemalloc.get_traced_memory()[1] < 5e8
    finally:
        tracemalloc.stop()
    assert found.shape == (4, 100)


def test_motion_is_followed_once_for_all_variables(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[int] = []
    from vibrafeed.core.lazy import dataset as module

    evaluate = module.evaluate_at_once

    def counted(plan: Any, grid: Any, into: Any, watch: Any) -> None:
        calls.append(grid.cells)
        evaluate(plan, grid, into, watch)

    prepared = prepare_content(MOTION)
    lazy = dataset(prepared, outline(prepared), cells=54)
    monkeypatch.setattr(module, "evaluate_at_once", counted)
    lazy.compute()
    assert sum(calls) == prepared.cells


def test_a_lazy_simulation_from_keywords() -> None:
    lazy = vibrafeed.open_lazily(
        "rectangle-on-plane", kind="simulate", outputs=["conveying_velocity"], frequency=50,
        amplitude=np.linspace(1e-4, 7e-4, 5), beta=[20, 40], friction=0.4,
    )  # fmt: skip
    speeds = lazy.conveying_velocity
    assert speeds.chunks is not None
    whole = vibrafeed.simulate(
        "rectangle-on-plane", outputs=["conveying_velocity"], frequency=50,
        amplitude=np.linspace(1e-4, 7e-4, 5), beta=[20, 40], friction=0.4,
    )  # fmt: skip
    assert float(speeds.max()) == float(whole.conveying_velocity.max())


@pytest.mark.parametrize(
    ("change", "place"),
    [({"trajectory": 10}, "trajectory"), ({"sensitivities": ["beta"]}, "sensitivities")],
)
def test_what_is_computed_as_a_whole_is_refused(change: dict[str, Any], place: str) -> None:
    one = {"frequency": 50, "amplitude": 2e-4, "beta": 30, "friction": 0.4}
    prepared = prepare_content({**MOTION, "parameters": one, **change})
    with pytest.raises(StudyError) as refused:
        open_lazily(prepared)
    assert [problem.place for problem in refused.value.problems] == [place]


def test_a_reduction_takes_no_cluster_that_nobody_has_named() -> None:
    """A service makes a client of Dask in its process; a reduction there once waited for it."""

    def never(*_: Any, **__: Any) -> None:
        raise AssertionError

    prepared = prepare_content({**MOTION, "reduce": {"over": ["beta"], "statistics": ["max"]}})
    with dask.config.set(scheduler=never):
        assert tabulate(prepared).variables["conveying_velocity_max"].values.shape == (2, 9, 2)
