"""How arrays are cut into chunks and tiles: small enough, not too small, all of the array once."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vibrafeed.core.dataset.layout import CHUNK_CELLS, TILE_CELLS, Layout, chunk_shape

SHAPES = [(), (1,), (7,), (200_003,), (6,) * 7, (101, 3, 91, 91), (300, 300, 40), (3,) * 14]


@given(st.lists(st.integers(1, 10**8), max_size=9).map(tuple))
def test_chunks_are_small_and_not_too_small(shape):
    lengths = chunk_shape(shape, CHUNK_CELLS)
    assert all(1 <= c <= n for c, n in zip(lengths, shape, strict=True))
    cells = math.prod(lengths)
    assert cells <= CHUNK_CELLS
    # Rounding down, then sharing out evenly, at most halves an axis; what is lost by a short axis
    # goes to the next, so that only the last two or three count.
    assert cells >= min(math.prod(shape), CHUNK_CELLS) / 8


def test_the_chunks_of_usual_grids():
    assert chunk_shape((1000,) * 4, CHUNK_CELLS) == (16, 16, 16, 16)
    assert chunk_shape((10**6, 10**6), CHUNK_CELLS) == (256, 256)
    assert chunk_shape((101, 3, 91, 91), CHUNK_CELLS) == (34, 3, 23, 23)
    assert chunk_shape((), CHUNK_CELLS) == ()


@pytest.mark.parametrize("values", [5, 7, 11, 13, 14, 26, 31])
@pytest.mark.parametrize("axes", [5, 6, 7])
def test_chunks_of_many_short_axes_hold_little_padding(values, axes):
    layout = Layout.of((values,) * axes)
    assert layout.stored <= 1.25 * values**axes


@pytest.mark.parametrize("shape", SHAPES)
def test_tiles_are_whole_chunks_and_hold_every_value_once(shape, monkeypatch):
    monkeypatch.setattr("vibrafeed.core.dataset.layout.TILE_CELLS", 300_000)
    layout = Layout.of(shape)
    assert math.prod(layout.tile) <= 300_000
    assert all(t % c == 0 for t, c in zip(layout.tile, layout.chunk, strict=True))
    seen = np.zeros(shape, dtype=np.int8)
    for index in range(layout.tiles):
        box = layout.box(index)
        here = np.zeros(shape, dtype=np.int8)
        for chunk in layout.chunks(box):
            assert all(start % c == 0 for (start, _), c in zip(chunk, layout.chunk, strict=True))
            here[tuple(slice(*ends) for ends in chunk)] += 1
        assert here[tuple(slice(*ends) for ends in box)].all()
        assert here.sum() == math.prod(stop - start for start, stop in box)
        seen += here
    assert (seen == 1).all()


def test_tiles_of_a_huge_array_are_found_at_once():
    layout = Layout.of((1000,) * 4)
    assert math.prod(layout.tile) >= TILE_CELLS / 2
    assert layout.tiles * math.prod(layout.tile) >= 10**12
    assert layout.box(layout.tiles - 1)[0][1] == 1000


def test_an_axis_without_values_has_no_tiles():
    layout = Layout.of((0, 3))
    assert (layout.tiles, layout.stored) == (0, 0)
    assert min(layout.chunk) >= 1
