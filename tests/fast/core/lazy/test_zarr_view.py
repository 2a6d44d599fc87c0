"""A sweep as a Zarr group that is evaluated on read: its chunks are pieces of the whole."""

from __future__ import annotations

import json
import math
import tomllib
import tracemalloc
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from night import spread
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.kinds.results import outline
from vibrafeed.core.lazy import view as view_module
from vibrafeed.core.study.values import Points, Span
from vibrafeed.core.sweep import Sweep

CONFIGS = Path(__file__).parents[4] / "configs"
SWEEPS = {
    path.stem: content
    for path in sorted(CONFIGS.rglob("*.toml"))
    if (content := tomllib.loads(path.read_text()))["kind"] == "sweep" and "reduce" not in content
}
TRACK = {
    "kind": "sweep",
    "scene": "rectangle-on-track",
    "outputs": ["acceleration_x", "transport_velocity", "throw_number", "vibration_acceleration"],
    "parameters": {
        "frequency": {"start": "20 Hz", "stop": "120 Hz", "num": 11},
        "amplitude": {"start": "0.1 mm", "stop": "1 mm", "num": 7, "spacing": "log"},
        "alpha": {"start": 0, "stop": 90, "num": 13},
        "beta": [80, 41, 40, 15, 0],
        "friction": 0.3,
        "radius": "0.8 m",
        "distance": "0.2 mm",
    },
}


def huge(**sizes: int) -> Sweep:
    """Return a sweep over frequency and three more axes, of 10^12 cells where not said."""
    ends = {"frequency": (20, 120), "amplitude": (1e-4, 1e-3), "alpha": (0, 90), "beta": (0, 90)}
    axes = {
        name: {"start": start, "stop": stop, "num": sizes.get(name, 1000)}
        for name, (start, stop) in ends.items()
    }
    return prepare_content({**TRACK, "parameters": {**TRACK["parameters"], **axes}})


def ZarrView(sweep: Sweep, **more: Any) -> view_module.ZarrView:
    return view_module.ZarrView(sweep, outline(sweep.unverified()), **more)


def chunks_of(view: Any) -> dict[str, tuple[int, ...]]:
    """Return the number of chunks along each dimension of every array."""
    arrays = json.loads(view.read("zarr.json"))["consolidated_metadata"]["metadata"]
    return {
        name: tuple(
            -(-size // length)
            for size, length in zip(
                one["shape"], one["chunk_grid"]["configuration"]["chunk_shape"], strict=True
            )
        )
        for name, one in arrays.items()
    }


def decode(view: Any, name: str, index: tuple[int, ...]) -> np.ndarray[Any, Any]:
    """Return a chunk as its document describes it, padding included."""
    document = json.loads(view.read(f"{name}/zarr.json"))
    dtype = np.dtype(document["data_type"]).newbyteorder("<")
    shape = document["chunk_grid"]["configuration"]["chunk_shape"]
    content = view.read("/".join((name, "c", *map(str, index))))
    assert len(content) == view.length("/".join((name, "c", *map(str, index))))
    return np.frombuffer(content, dtype).reshape(shape)


def check_every_chunk(sweep: Sweep, chunk_cells: int) -> None:
    view = ZarrView(sweep, chunk_cells=chunk_cells)
    table = tabulate(sweep)
    whole = {**table.coordinates, **table.variables}
    assert list(chunks_of(view)) == list(whole)
    for name, variable in whole.items():
        document = json.loads(view.read(f"{name}/zarr.json"))
        assert tuple(document["shape"]) == variable.values.shape
        assert tuple(document.get("dimension_names", ())) == variable.dims
        lengths = document["chunk_grid"]["configuration"]["chunk_shape"]
        assert math.prod(lengths) <= chunk_cells
        for index in product(*map(range, chunks_of(view)[name])):
            chunk = decode(view, name, index)
            part = variable.values[
                tuple(slice(i * c, (i + 1) * c) for i, c in zip(index, lengths, strict=True))
            ]
            inside = tuple(slice(n) for n in part.shape)
            # Equal to the bit: the same operations run on each cell, whatever stands beside it.
            assert chunk[inside].tobytes() == part.astype(chunk.dtype).tobytes(), (name, index)
            padding = np.ones(chunk.shape, dtype=bool)
            padding[inside] = False
            assert np.all(
                np.isnan(chunk[padding]) if chunk.dtype.kind == "f" else chunk[padding] == 0
            )


@pytest.mark.parametrize("name", spread(SWEEPS, 6))
def test_every_chunk_of_every_example_is_a_piece_of_the_whole(name):
    check_every_chunk(prepare_content(SWEEPS[name]), chunk_cells=1500)


@pytest.mark.parametrize("change", [{"variant": "thesis"}, {"verify": 3}], ids=str)
def test_every_chunk_where_outputs_have_different_dimensions(change):
    sweep = prepare_content({**TRACK, **change})
    check_every_chunk(sweep, 200)
    # Verifying takes seconds a cell, and a view has only the first when it is opened.
    assert "verified" not in ZarrView(sweep).read("zarr.json").decode()


def test_a_study_without_axes_has_chunks_without_indices():
    fixed = {"frequency": 50, "amplitude": 5e-4, "alpha": 10, "beta": 15}
    sweep = prepare_content({**TRACK, "parameters": {**TRACK["parameters"], **fixed}})
    check_every_chunk(sweep, 100)
    assert ZarrView(sweep).length("acceleration_x/c") == 8


@pytest.mark.parametrize(
    "axis",
    [
        Span(20.0, 120.0, 1001),
        Span(-0.1, 0.7, 333),
        Span(1e-4, 1e-3, 2),
        Span(0.1, 7.3, 1001, "log"),
        Span(1e-9, 3e5, 77, "log"),
        Span(0.0, 5e-324, 4),  # the step is less than the least number
        Points((5.0, 3.0, 2.5)),
    ],
)
def test_pieces_of_an_axis_are_the_axis(axis):
    whole = axis.array()
    for length in (1, 7, 64, axis.size):
        pieces = [
            axis.array(start, min(start + length, axis.size))
            for start in range(0, axis.size, length)
        ]
        assert np.concatenate(pieces).tobytes() == whole.tobytes()


def test_the_document_of_the_group_holds_those_of_its_arrays():
    view = ZarrView(prepare_content(TRACK))
    group = json.loads(view.read("zarr.json"))
    assert group["attributes"]["Conventions"] == "CF-1.11"
    inside = group["consolidated_metadata"]["metadata"]
    for name in chunks_of(view):
        assert json.loads(view.read(f"{name}/zarr.json")) == inside[name]
    regime = inside["regime"]
    assert (regime["data_type"], regime["fill_value"]) == ("int8", 0)
    assert regime["attributes"]["flag_values"]
    for document in inside.values():
        assert "_FillValue" not in document["attributes"]
        (codec,) = document["codecs"]
        assert codec["name"] == "bytes"
        if document["data_type"] != "int8":
            assert codec["configuration"] == {"endian": "little"}


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
def test_other_keys_are_not_there(key):
    view = ZarrView(prepare_content(TRACK))
    with pytest.raises(KeyError):
        view.read(key)
    with pytest.raises(KeyError):
        view.length(key)


def test_nothing_of_the_size_of_the_sweep_is_allocated():
    sweep = huge(frequency=10**8, amplitude=10**7)  # 10^21 cells; the frequencies alone 800 MB
    tracemalloc.start()
    view = ZarrView(sweep)
    view.read("zarr.json")
    for name, chunks in chunks_of(view).items():
        decode(view, name, tuple(n // 2 for n in chunks))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # A chunk is 512 KiB; evaluation holds some twenty arrays of half of that, and the axes.
    assert peak < 20e6


def test_a_chunk_of_a_huge_sweep_is_right():
    sweep = huge()
    view = ZarrView(sweep)
    index = (20, 62, 31, 3)  # at a border of regimes, and at the end of an axis
    lengths = json.loads(view.read("transport_velocity/zarr.json"))["chunk_grid"]["configuration"][
        "chunk_shape"
    ]
    box = {
        dim: sweep.grid.coordinate(dim)[i * c : (i + 1) * c].tolist()
        for dim, i, c in zip(sweep.grid.axes, index, lengths, strict=True)
    }
    parameters = {**TRACK["parameters"], **box}
    expected = tabulate(prepare_content({**TRACK, "parameters": parameters}))
    for name in ("transport_velocity", "regime"):
        values = expected.variables[name].values
        chunk = decode(view, name, index)[tuple(slice(n) for n in values.shape)]
        np.testing.assert_array_equal(chunk, values)
    assert len(set(expected.variables["regime"].values.ravel())) > 1


def test_only_what_an_output_needs_is_evaluated(monkeypatch):
    view = ZarrView(prepare_content(TRACK))
    ran = []
    monkeypatch.setattr(
        "vibrafeed.core.lazy.view.evaluate",
        lambda plan, grid: (
            ran.append(plan) or {"throw_number": np.zeros(tuple(grid.shape.values()))}
        ),
    )
    view.read("throw_number/c/0/0/0")
    assert ran[0].conditions == ()
    assert [e.gives for e in ran[0].equations][-1] == "throw_number"
    assert not {"alpha", "friction", "radius"} & set(ran[0].parameters)
