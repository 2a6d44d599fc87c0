"""A study carried out in pieces is the study carried out as a whole."""

from pathlib import Path

import numpy as np
import pytest

from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.intake import load_study, prepare_content
from vibrafeed.core.kinds import KINDS, prepare, tabulate
from vibrafeed.core.plan.pieces import Cut, join
from vibrafeed.core.watch import Watch

CONFIGS = Path(__file__).parents[4] / "configs"
STUDIES = {
    "sweep": {
        "kind": "sweep",
        "scene": "rectangle-on-track",
        "outputs": ["acceleration_x", "floor_force", "transport_velocity"],
        "parameters": {
            "frequency": {"start": 20, "stop": 120, "num": 11},
            "mass": [0.01, 0.02],
            "amplitude": ["0.35 mm", "0.5 mm", "1 mm"],
            "alpha": {"start": 0, "stop": 20, "num": 7},
            "beta": {"start": 0, "stop": 40, "num": 9},
            "delta": 10,
            "friction": 0.3,
            "radius": 0.8,
            "distance": "0.2 mm",
        },
    },
    "simulate": {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "outputs": ["conveying_velocity", "flight_fraction"],
        "parameters": {
            "frequency": [30, 50],
            "amplitude": {"start": "0.05 mm", "stop": "0.75 mm", "num": 13},
            "beta": {"start": 5, "stop": 60, "num": 5},
            "friction": 0.4,
        },
    },
    "optimise": {
        "kind": "optimise",
        "scene": "cylinder-on-plane",
        "criterion": {
            "kind": "pareto",
            "output": "acceleration_x",
            "against": "acceleration_y",
            "points": 5,
        },
        "parameters": {
            "frequency": {"start": 20, "stop": 60, "num": 3},
            "amplitude": "0.5 mm",
            "friction": [0.2, 0.3, 0.4],
        },
    },
}


def in_pieces(prepared, cut):
    compute = KINDS[prepared.study.kind].compute
    boxes = [cut.box(index) for index in range(len(cut))]
    return join(prepared, ((box, compute(prepared.within(box), Watch())) for box in boxes))


@pytest.mark.parametrize("study", STUDIES)
def test_pieces_make_the_same_file(study, tmp_path):
    def written(table):
        write_netcdf(table, tmp_path / "file.nc")
        return (tmp_path / "file.nc").read_bytes()

    prepared = prepare_content(STUDIES[study])
    whole = written(tabulate(prepared))
    cut = Cut(prepared, {"sweep": 100, "simulate": 20, "optimise": 2}[study])
    joined = in_pieces(prepared, cut)
    assert written(KINDS[study].label(prepared, joined, Watch())) == whole


@pytest.mark.parametrize("cells", [1, 7, 100, 1000, 10**6])
@pytest.mark.parametrize("study", STUDIES)
def test_boxes_cover_the_grid_once_and_are_no_larger_than_asked(study, cells):
    prepared = prepare_content(STUDIES[study])
    cut, axes = Cut(prepared, cells), prepared.cut_axes
    count = np.zeros([prepared.grid.shape[name] for name in axes], dtype=int)
    for index in range(len(cut)):
        box = cut.box(index)
        count[tuple(slice(*box[name]) if name in box else slice(None) for name in axes)] += 1
        assert prepared.within(box).cells <= max(cells, prepared.cells // count.size)
    assert (count == 1).all()
    assert len(cut) <= 3 * max(1, prepared.cells / cells)


def test_a_course_in_time_is_one_piece():
    prepared = prepare(load_study(CONFIGS / "trajectory.toml"))
    cut = Cut(prepared, 1)
    computed = in_pieces(prepared, cut)
    assert len(cut) == 1
    assert "position_along" in KINDS["simulate"].label(prepared, computed, Watch()).variables
