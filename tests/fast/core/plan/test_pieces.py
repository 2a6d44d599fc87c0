"""A study carried out in pieces is the study carried out as a whole."""

from pathlib import Path

import numpy as np
import pytest

from night import spread
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


@pytest.fixture(scope="module")
def file_of(tmp_path_factory):
    """Return a function that gives the file of a study, whole or cut; equal cuts are made once."""
    path, known = tmp_path_factory.mktemp("files") / "file.nc", {}

    def content(study, cut=None):
        boxes = cut and repr([cut.box(index) for index in range(len(cut))])
        if (study, boxes) not in known:
            prepared = prepare_content(STUDIES[study])
            if cut is None:
                table = tabulate(prepared)
            else:
                table = KINDS[study].label(prepared, in_pieces(prepared, cut), Watch())
            write_netcdf(table, path)
            known[study, boxes] = path.read_bytes()
        return known[study, boxes]

    return content


@pytest.mark.by_day(2)
@pytest.mark.parametrize("cells", spread([7, 100, 1, 1000], 2))
@pytest.mark.parametrize("study", STUDIES)
def test_pieces_make_the_same_file(study, cells, file_of):
    cut = Cut(prepare_content(STUDIES[study]), cells)
    assert file_of(study, cut) == file_of(study)


@pytest.mark.parametrize("cells", [1, 7, 100, 1000, 10**6])
@pytest.mark.parametrize("study", STUDIES)
def test_boxes_cover_the_grid_once(study, cells):
    prepared = prepare_content(STUDIES[study])
    cut = Cut(prepared, cells)
    axes = prepared.cut_axes
    count = np.zeros([prepared.grid.shape[name] for name in axes], dtype=int)
    for index in range(len(cut)):
        box = cut.box(index)
        count[tuple(slice(*box[name]) if name in box else slice(None) for name in axes)] += 1
    assert (count == 1).all()


def test_pieces_are_no_larger_than_asked_and_not_much_smaller():
    prepared = prepare_content(STUDIES["sweep"])
    for cells in (9, 40, 63, 200, 5000):
        cut = Cut(prepared, cells)
        sizes = [prepared.within(cut.box(index)).cells for index in range(len(cut))]
        assert sum(sizes) == prepared.cells
        assert max(sizes) <= cells
        assert len(cut) <= 3 * prepared.cells / cells + 1


def test_a_course_in_time_is_one_piece():
    prepared = prepare(load_study(CONFIGS / "trajectory.toml"))
    cut = Cut(prepared, 1)
    computed = in_pieces(prepared, cut)
    assert len(cut) == 1
    assert "position_along" in KINDS["simulate"].label(prepared, computed, Watch()).variables
