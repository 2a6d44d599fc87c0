"""A sweep as a Zarr group that is evaluated on read: its chunks are pieces of the whole."""

import json
import math
import tracemalloc
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from large_studies import TRACK, sweep_of
from night import spread
from vibrafeed.core.intake import prepare_content, read_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.kinds.results import outline
from vibrafeed.core.lazy.view import ZarrView
from vibrafeed.core.study.values import Points, Span
from vibrafeed.core.sweep.kind import Sweep

CONFIGS = Path(__file__).parents[4] / "configs"
SWEEPS = {
    path.stem: content
    for path in sorted(CONFIGS.rglob("*.toml"))
    if (content := read_content(path))["kind"] == "sweep" and "reduce" not in content
}


def view_of(sweep: Sweep, **more: int) -> ZarrView:
    return ZarrView(sweep, outline(sweep.unverified()), **more)


def arrays_of(view: ZarrView) -> dict[str, dict]:
    """Return the documents of all arrays."""
    return json.loads(view.read("zarr.json"))["consolidated_metadata"]["metadata"]


def lengths_of(document: dict) -> list[int]:
    return document["chunk_grid"]["configuration"]["chunk_shape"]


def decode(view: ZarrView, name: str, index: tuple[int, ...]) -> np.ndarray:
    """Return a chunk as its document describes it, padding included."""
    document, key = arrays_of(view)[name], "/".join((name, "c", *map(str, index)))
    content = view.read(key)
    assert len(content) == view.length(key)
    dtype = np.dtype(document["data_type"]).newbyteorder("<")
    return np.frombuffer(content, dtype).reshape(lengths_of(document))


def check_every_chunk(sweep: Sweep, chunk_cells: int) -> None:
    view = view_of(sweep, chunk_cells=chunk_cells)
    table = tabulate(sweep)
    whole, arrays = {**table.coordinates, **table.variables}, arrays_of(view)
    assert list(arrays) == list(whole)
    for name, variable in whole.items():
        document = arrays[name]
        assert json.loads(view.read(f"{name}/zarr.json")) == document
        assert tuple(document["shape"]) == variable.values.shape
        assert tuple(document.get("dimension_names", ())) == variable.dims
        lengths = lengths_of(document)
        assert math.prod(lengths) <= chunk_cells
        counts = [-(-size // step) for size, step in zip(document["shape"], lengths, strict=True)]
        for index in product(*map(range, counts)):
            chunk = decode(view, name, index)
            box = [slice(i * c, (i + 1) * c) for i, c in zip(index, lengths, strict=True)]
            part = variable.values[tuple(box)]
            # Equal to the bit: the same operations run on each cell, whatever stands beside it.
            padded = np.full(chunk.shape, np.nan if chunk.dtype.kind == "f" else 0, chunk.dtype)
            padded[tuple(slice(n) for n in part.shape)] = part
            np.testing.assert_array_equal(chunk, padded, err_msg=name)


@pytest.mark.parametrize("name", spread(SWEEPS, 6))
def test_every_chunk_of_every_example_is_a_piece_of_the_whole(name):
    check_every_chunk(prepare_content(SWEEPS[name], files=True), chunk_cells=1500)


@pytest.mark.parametrize("change", [{"variant": "thesis"}, {"verify": 3}], ids=str)
def test_every_chunk_where_outputs_have_different_dimensions(change):
    sweep = prepare_content({**TRACK, **change})
    check_every_chunk(sweep, 200)
    # Verifying takes seconds a cell, and a view has only the first when it is opened.
    attributes = json.loads(view_of(sweep).read("zarr.json"))["attributes"]
    assert not [name for name in attributes if "verified" in name]


def test_a_study_without_axes_has_chunks_without_indices():
    fixed = {"frequency": 50, "amplitude": 5e-4, "alpha": 10, "beta": 15}
    sweep = prepare_content({**TRACK, "parameters": {**TRACK["parameters"], **fixed}})
    check_every_chunk(sweep, 100)
    assert view_of(sweep).length("acceleration_x/c") == 8


@pytest.mark.parametrize(
    "axis",
    [
        Span(20.0, 120.0, 1001), Span(-0.1, 0.7, 333), Span(1e-4, 1e-3, 2),
        Span(0.1, 7.3, 1001, "log"), Span(1e-9, 3e5, 77, "log"),
        Span(0.0, 5e-324, 4),  # the step is less than the least number
        Points((5.0, 3.0, 2.5)),
    ],
)  # fmt: skip
def test_pieces_of_an_axis_are_the_axis(axis):
    whole, size = axis.array(), axis.size
    for length in (1, 7, 64, size):
        pieces = [axis.array(k, min(k + length, size)) for k in range(0, size, length)]
        assert np.concatenate(pieces).tobytes() == whole.tobytes()


def test_the_document_of_the_group_says_how_arrays_are_stored():
    view = view_of(prepare_content(TRACK))
    regime = arrays_of(view)["regime"]
    assert (regime["data_type"], regime["fill_value"]) == ("int8", 0)
    for document in arrays_of(view).values():
        assert "_FillValue" not in document["attributes"]
        (codec,) = document["codecs"]
        assert codec["name"] == "bytes"
        if document["data_type"] != "int8":
            assert codec["configuration"] == {"endian": "little"}


@pytest.fixture(scope="module")
def track_view() -> ZarrView:
    return view_of(prepare_content(TRACK))


@pytest.mark.parametrize(
    "key",
    [
        "", "/", "zarr.json/", "/zarr.json", "./zarr.json", "../zarr.json", "c/0", "nothing/c/0",
        ".zgroup", "acceleration_x", "acceleration_x/", "acceleration_x/c", "acceleration_x/c/0",
        "acceleration_x/c/0/0/0/0/0", "acceleration_x/c/0/0/0/-1", "acceleration_x/c/0/0/0/00",
        "acceleration_x/c/0/0/0/1e0", "acceleration_x/c/0/0/0/+1", "acceleration_x/c/0/0/0/ 1",
        "acceleration_x/c/0/0/0/\u0661", "acceleration_x/c/0/0/0/" + "9" * 400,
        "acceleration_x/c/0/0/0/99", "acceleration_x/c.0.0.0.0", "acceleration_x//c/0/0/0/0",
        "acceleration_x/c/0/0/0/0/", "acceleration_x/c/0/0/0/0\n", "frequency/c", "friction/c/0",
        "friction/c/", "regime/c/../c/0/0/0/0", "acceleration_x\x00/zarr.json",
    ],
)  # fmt: skip
def test_other_keys_are_not_there(track_view, key):
    for ask in (track_view.read, track_view.length):
        with pytest.raises(KeyError):
            ask(key)


def test_nothing_of_the_size_of_the_sweep_is_allocated():
    study = sweep_of(1000)
    more = {"frequency": 10**8, "amplitude": 10**7}  # 10^21 cells; the frequencies alone 800 MB
    axes = {name: study["parameters"][name] | {"num": num} for name, num in more.items()}
    sweep = prepare_content({**study, "parameters": {**study["parameters"], **axes}})
    tracemalloc.start()
    view = view_of(sweep)
    for name, document in arrays_of(view).items():
        sizes = zip(document["shape"], lengths_of(document), strict=True)
        decode(view, name, tuple(size // length // 2 for size, length in sizes))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # A chunk is 512 KiB; evaluation holds some twenty arrays of half of that, and the axes.
    assert peak < 20e6


def test_a_chunk_of_a_huge_sweep_is_right():
    sweep = prepare_content(sweep_of(1000))
    view = view_of(sweep)
    index = (20, 62, 31, 3)  # at a border of regimes, and at the end of an axis
    lengths = lengths_of(arrays_of(view)["transport_velocity"])
    box = {
        dim: sweep.grid.coordinate(dim)[i * c : (i + 1) * c].tolist()
        for dim, i, c in zip(sweep.grid.axes, index, lengths, strict=True)
    }
    expected = tabulate(prepare_content({**TRACK, "parameters": {**TRACK["parameters"], **box}}))
    for name in ("transport_velocity", "regime"):
        values = expected.variables[name].values
        chunk = decode(view, name, index)[tuple(slice(n) for n in values.shape)]
        np.testing.assert_array_equal(chunk, values)
    assert len(set(expected.variables["regime"].values.ravel())) > 1
