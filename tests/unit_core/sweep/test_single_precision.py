"""Sweeps that are stored in 32 bits: rounded once, last, and said so."""

import numpy as np
import pytest
import xarray

from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import open_lazily, tabulate
from vibrafeed.core.kinds.results import outline
from vibrafeed.core.lazy import store
from vibrafeed.core.watch import Watch

STUDY = {
    "kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["acceleration_x", "throw_number"],
    "verify": 20,
    "parameters": {
        "frequency": {"start": 20, "stop": 90, "num": 30}, "amplitude": 1e-4, "friction": 0.3,
        "beta": {"start": 5, "stop": 60, "num": 40}, "gamma": [0, 2, 4],
    },
}  # fmt: skip
SINGLE = {**STUDY, "precision": "single"}


def test_values_are_those_in_double_rounded_once(tmp_path):
    double, single = (tabulate(prepare_content(one)) for one in (STUDY, SINGLE))
    write_netcdf(single, tmp_path / "single.nc")
    with xarray.open_dataset(tmp_path / "single.nc") as written:
        for name in STUDY["outputs"]:
            assert written[name].dtype == np.float32
            np.testing.assert_array_equal(
                written[name].values, double.variables[name].values.astype(np.float32)
            )
        assert written.regime.dtype == np.int8
        assert written.frequency.dtype == np.float64
        assert "6e-8 of each value" in written.attrs["accuracy"]
        # What is verified is what was computed, before it is rounded.
        assert "verified_failed" not in written.attrs
    assert prepare_content(SINGLE).bytes < 0.6 * prepare_content(STUDY).bytes


@pytest.mark.parametrize("name", ["blocks.nc", "blocks.zarr"])
def test_blocks_and_lazy_datasets_have_the_same_values(tmp_path, monkeypatch, name):
    monkeypatch.setattr(store, "STORED_CELLS", 1000)
    sweep = prepare_content(SINGLE, "sweep")
    whole = tabulate(sweep)
    if name.endswith(".nc"):
        store.store_netcdf(sweep, outline(sweep), tmp_path / name, Watch())
    else:
        group = store.ZarrStore(sweep, str(tmp_path / name))
        group.begin(outline(sweep))
        group.store(Watch())
        group.finish()
    opened = xarray.open_zarr if name.endswith(".zarr") else xarray.open_dataset
    with opened(tmp_path / name) as written:
        for output in STUDY["outputs"]:
            assert written[output].dtype == np.float32
            np.testing.assert_array_equal(written[output], whole.variables[output].values)
    lazy = open_lazily(prepare_content(SINGLE, "sweep"))
    assert lazy.acceleration_x.dtype == np.float32
    np.testing.assert_array_equal(lazy.acceleration_x, whole.variables["acceleration_x"].values)


def test_double_is_the_default_and_no_other_study():
    named = prepare_content({**STUDY, "precision": "double"})
    assert named.study.key() == prepare_content(STUDY).study.key()
    assert named.study.key() != prepare_content(SINGLE).study.key()


def test_answers_have_no_precision():
    with pytest.raises(StudyError) as caught:
        prepare_content({**SINGLE, "reduce": {"over": ["beta"], "statistics": ["max"]}})
    assert "precision" in [problem.place for problem in caught.value.problems]
    assert "Leave it out" in str(caught.value)
