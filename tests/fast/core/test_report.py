"""Error against run time: what the curves of a study say, and studies without a witness."""

from dataclasses import replace

import numpy as np
import pytest
import xarray

from refusals import places_of
from vibrafeed.core import report as reports
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.plots.measured import draw_report
from vibrafeed.core.report import Report, check, measure
from vibrafeed.core.sweep.verify import EXTENDED
from vibrafeed.core.watch import Watch

TRACK = {
    "kind": "sweep",
    "scene": "rectangle-on-track",
    "outputs": ["transport_velocity", "starting_acceleration"],
    "parameters": {
        "frequency": {"start": 20, "stop": 60, "num": 11},
        "amplitude": "0.3 mm",
        "beta": 25,
        "friction": 0.3,
        "radius": "1e6 m",
        "distance": "0.15 mm",
    },
}
MOTION = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "parameters": {
        "frequency": 50,
        "amplitude": {"start": "0.1 mm", "stop": "0.3 mm", "num": 21},
        "beta": {"start": 20, "stop": 30, "num": 11},
        "friction": 0.4,
    },
}


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reports, "LEAST_SECONDS", 0.0)
    monkeypatch.setattr(reports, "MOTION_CELLS", 6)


def test_closed_forms_err_by_rounding_of_their_type_and_a_file_and_a_page_say_it(tmp_path):
    found = measure(prepare_content(TRACK))
    assert found.curves == tuple(TRACK["outputs"])
    assert found.settings == ("float32", "float64")
    assert (found.cells == 11).all()
    assert (found.seconds > 0).all()
    assert ((found.error[:, 0] > 1e-10) & (found.largest[:, 0] < 1e-4)).all()
    if EXTENDED:
        assert ((found.largest[:, 1] > 0) & (found.largest[:, 1] < 1e-13)).all()
    else:
        assert np.isnan(found.error[:, 1]).all()
        assert "no more digits" in found.notes["witness"]
    prepared = prepare_content(TRACK)
    found = Report.of(found.computed())
    path = tmp_path / "accuracy.nc"
    write_netcdf(found.table(prepared), path)
    with xarray.open_dataset(path, engine="netcdf4") as read:
        assert read.sizes == {"curve": 2, "setting": 2}
        assert read["curve"].attrs["flag_meanings"].split() == TRACK["outputs"]
        np.testing.assert_array_equal(read["error_largest"].values, found.largest)
        assert read["time_per_cell"].attrs["units"] == "s"
        assert {"machine", "date", "versions", "witness", "study"} <= read.attrs.keys()
    page = found.page([found.section("my study.toml", "A title", "picture.png")])
    assert "## A title (my study)" in page
    assert "![Error against run time](picture.png)" in page
    assert page.count("| transport_velocity |") == np.isfinite(found.error[0]).sum()
    fast = replace(found, seconds=np.full((2, 2), 2.5e-6))
    assert " 2.5 us |" in fast.section("my study.toml", "A title", None)
    points = draw_report(fast.table(prepared).to_xarray()).axes[0].lines[1]
    assert points.get_xdata() == pytest.approx([2.5, 2.5])


def test_a_motion_meets_its_witness_at_a_small_tolerance() -> None:
    found = measure(prepare_content(MOTION))
    assert set(found.curves) == {"sliding", "hopping"}
    assert found.cells.sum() == 6
    assert (found.largest[:, -1] < 1e-9).all()  # what the witness may be off by
    assert (found.error <= found.largest).all()
    assert "method reference" in found.notes["witness"]


def test_a_stop_leaves_settings_out_and_parts_at_rest_have_no_curve() -> None:
    stopped = Watch(stop=lambda: True)
    assert np.isnan(measure(prepare_content(TRACK), stopped).error).all()
    found = measure(prepare_content(MOTION), stopped)
    assert found.curves == ()
    assert "nothing is measured" in found.notes["witness"]
    still = {**MOTION, "parameters": {**MOTION["parameters"], "amplitude": [0.0, 1e-7]}}
    assert measure(prepare_content(still)).curves == ()


@pytest.mark.parametrize(
    ("content", "place"),
    [
        (
            {"kind": "optimise", "scene": "rectangle-on-plane",
             "criterion": {"kind": "maximise", "output": "acceleration_x"},
             "parameters": {"frequency": 50, "amplitude": "0.2 mm", "friction": 0.3}},
            "kind",
        ),
        (
            {"kind": "simulate", "scene": "rectangle-isolated", "outputs": ["settling_time"],
             "parameters": {"length": 0.02, "height": 0.01, "friction": 0.3,
                            "drop_height": 1e-3, "restitution": 0.3, "duration": 0.5}},
            "scene",
        ),
    ],
)  # fmt: skip
def test_a_study_without_a_witness_is_refused(content: dict, place: str) -> None:
    assert places_of(lambda: check(prepare_content(content))) == [place]
