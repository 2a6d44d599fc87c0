"""One result, in every format, and its numbers as rows."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from vibrafeed.core.dataset.formats import FORMATS, write_result
from vibrafeed.core.dataset.frame import Frame
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate

MOTION = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity", "throw_number"],
    "parameters": {
        "frequency": "50 Hz",
        "amplitude": {"start": "0.1 mm", "stop": "0.5 mm", "num": 5},
        "beta": [20, 30, 45],
        "friction": 0.4,
    },
}


def table_of_motion() -> Table:
    """Return a small result: three outputs and their flags over two axes."""
    return tabulate(prepare_content(MOTION))


def written(table: Table, folder: Path) -> dict[str, Path]:
    """Write a table in every format; return the files by suffix."""
    places = {suffix: folder / f"result{suffix}" for suffix in FORMATS}
    for place in places.values():
        write_result(table, str(place), history="2026-11-23 a test")
    return places


def rows(table: Table, *, with_units: bool = False) -> dict[str, list[object]]:
    """Return what the columns of a table hold, by name or by heading."""
    frame = Frame.of(table)
    (whole,) = frame.pieces(frame.rows)
    if with_units:
        whole.columns = frame.headings
    return whole.to_dict("list")


def check_same(found: Mapping[str, object], expected: Mapping[str, object]) -> None:
    """Compare columns: the same numbers to the bit, and the same words."""
    assert list(found) == list(expected)
    for name, values in expected.items():
        got = np.asarray(found[name])
        if got.dtype.kind == "f":
            np.testing.assert_array_equal(got, np.asarray(values, dtype=float), err_msg=name)
        else:
            assert got.tolist() == np.asarray(values).tolist(), name
