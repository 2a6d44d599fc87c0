"""Sums are exact, whatever the numbers and the order; quantiles of many keep their error."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest

from core.reduce.answers import binned_quantiles
from core.reduce.boxes import exact_quantiles, values_of
from core.reduce.kernels import others
from core.reduce.kernels.bits import LEAST, MOST
from core.reduce.kernels.rows import across_rows, along_rows
from core.reduce.sums import added, anchors, by_level, exponent_of, means, units_of

CHANCE = np.random.default_rng(16)
HARD = {
    "ordinary": CHANCE.normal(size=10_000),
    "cancelling": np.concatenate([x := CHANCE.normal(size=5_000) * 1e200, -x, [1e-300]]),
    "all sizes": CHANCE.normal(size=10_000) * 10.0 ** CHANCE.integers(-320, 280, 10_000),
    "tiny": np.full(9_999, 5e-324),
    "zeros": np.zeros(5_000),
    "one": np.array([0.1]),
    "near a power of 2": np.nextafter(np.full(5_000, 1024.0), 0),
}


def reduced(values: np.ndarray, kernel, slots: np.ndarray, length: int, count: int):
    regimes = np.zeros(values.size, np.int8)
    units = units_of(exponent_of(float(np.abs(values).max())))
    ends = np.zeros((5, count), np.int64)
    ends[0], ends[2] = LEAST, MOST
    sums = np.zeros((len(units), count), np.int64)
    assert not kernel(values, regimes, 1, slots, length, anchors(units), ends, sums)
    return ends, by_level(units, sums)


@pytest.mark.parametrize("values", HARD.values(), ids=HARD)
@pytest.mark.parametrize("parts", [1, 2, 7])
def test_means_are_exact_however_they_are_split(values: np.ndarray, parts: int) -> None:
    want = float(sum(map(Fraction, values.tolist())) / values.size)
    chance = np.random.default_rng(parts)
    shuffled = chance.permutation(values)
    total = None
    for piece in np.array_split(shuffled, parts):
        if piece.size:
            _, sums = reduced(piece, along_rows, np.zeros(1, np.int64), piece.size, 1)
            total = sums if total is None else added(total, sums)
    assert total is not None
    assert means(*total, np.array([values.size]))[0] == want


@pytest.mark.parametrize("values", HARD.values(), ids=HARD)
def test_rows_across_slots_give_what_rows_along_them_do(values: np.ndarray) -> None:
    width = 5
    table = values[: values.size // width * width].reshape(-1, width)
    if not table.size:
        return
    slots = np.zeros(len(table), np.int64)
    ends, sums = reduced(table.reshape(-1), across_rows, slots, width, width)
    for slot in range(width):
        line = np.ascontiguousarray(table[:, slot])
        own, alone = reduced(line, along_rows, np.zeros(1, np.int64), line.size, 1)
        np.testing.assert_array_equal(own[[0, 2, 4], 0], ends[[0, 2, 4], slot])
        assert own[1, 0] == ends[1, slot] // width == line.argmax()
        assert own[3, 0] == ends[3, slot] // width == line.argmin()
        assert values_of(own[0])[0] == line.max()
        assert values_of(own[2])[0] == line.min()
        count = np.array([line.size])
        column = sums[1][:, slot : slot + 1]
        assert means(*alone, count)[0] == means(sums[0], column, count)[0]


def test_cells_that_do_not_count_are_left_out() -> None:
    values = np.array([3.0, math.nan, 9.0, -0.0, 1.0])
    regimes = np.array([0, 0, 1, 0, 0], np.int8)
    ends = np.array([[LEAST], [0], [MOST], [0], [0]])
    units = units_of(2, 4)
    sums = np.zeros((4, 1), np.int64)
    one = np.zeros(1, np.int64)
    assert not along_rows(values, regimes, 1, one, 5, anchors(units), ends, sums)
    assert values_of(ends[0]) == 3
    assert values_of(ends[2]) == 0
    assert ends[[1, 3, 4], 0].tolist() == [0, 3, 3]
    assert means(*by_level(units, sums), np.array([3]))[0] == 4 / 3


@pytest.mark.parametrize("scale", [1e-300, 1e-3, 1.0, 1e200])
def test_quantiles_of_a_histogram_keep_their_error(scale: float) -> None:
    values = scale * np.random.default_rng(3).normal(loc=1, size=200_000)
    values[:1000] = math.nan
    counts = np.zeros(others.BINS, np.int64)
    regimes = np.zeros(values.size, np.int8)
    others.histogram(values, regimes, 1, counts)
    bins = np.flatnonzero(counts)
    ends = np.array([[LEAST], [0], [MOST], [0], [0]])
    along_rows(values, regimes, 1, np.zeros(1, np.int64), values.size, anchors([])[:0], ends, ends)
    quantiles = tuple(np.linspace(0, 1, 41))
    found = binned_quantiles(bins, counts[bins], ends, quantiles)[:, 0]
    want = np.quantile(values[1000:], quantiles)
    assert (np.abs(found / want - 1) < 1 / 512).all()
    np.testing.assert_array_equal(found[[0, -1]], want[[0, -1]])


def test_quantiles_of_infinite_values() -> None:
    lines = np.array([[1.0, math.inf, 2.0, math.nan], [math.nan] * 4])
    found = exact_quantiles(lines, (0.0, 0.5, 1.0))
    np.testing.assert_array_equal(found, [[1, math.nan], [2, math.nan], [math.inf, math.nan]])
    counts = np.zeros(others.BINS, np.int64)
    values = np.array([-math.inf, 1.0, math.inf])
    others.histogram(values, np.zeros(3, np.int8), 1, counts)
    bins = np.flatnonzero(counts)
    ends = np.array([[LEAST], [0], [MOST], [0], [0]])
    along_rows(
        values, np.zeros(3, np.int8), 1, np.zeros(1, np.int64), 3, anchors([])[:0], ends, ends
    )
    found = binned_quantiles(bins, counts[bins], ends, (0.0, 0.5, 1.0))[:, 0]
    assert found.tolist() == [-math.inf, 1.0, math.inf]
