"""Sums of tiles are exact, whatever their order; quantiles of many cells keep their error."""

from __future__ import annotations

import functools
import itertools
import math
import random
from collections.abc import Iterable
from fractions import Fraction

import numpy as np
import pytest

from vibrafeed.core.plan.lane_loop import DEPTH, TILE_CELLS, LaneOrder
from vibrafeed.core.plan.loop_source import UPDATES
from vibrafeed.core.reduce.arrays import binned_quantiles
from vibrafeed.core.reduce.boxes import exact_quantiles, values_of
from vibrafeed.core.reduce.kernels import others
from vibrafeed.core.reduce.kernels.folding import COUNT_BITS, fold_counts
from vibrafeed.core.reduce.lanes import GATHERED, BoxLanes, Totals
from vibrafeed.core.reduce.state import State, merge_states
from vibrafeed.core.reduce.sums import means

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


def gathered(
    table: np.ndarray, over: tuple[str, ...], box: dict | None = None, most: int = TILE_CELLS
) -> State:
    """Return what the cells of a table, or of a box of it, tell; its axes are a, b, and so on."""
    dims = "abcd"[: table.ndim]
    shape = dict(zip(dims, table.shape, strict=True))
    order = LaneOrder.of(dims[:-1], dims[-1:], shape, over, most)
    lanes = BoxLanes(order, dims, over, shape)
    ends = {name: (0, size) for name, size in shape.items()} | (box or {})
    slots = math.prod(ends[name][1] - ends[name][0] for name in dims if name not in over)
    totals = Totals(slots, 1)
    starts = np.array([ends[name][0] for name in dims])
    tiles = lanes.tiles(tuple(ends[name][1] - ends[name][0] for name in dims))
    for own, layout, offset in zip(tiles.ends, tiles.layouts, tiles.offsets, strict=True):
        held = {kind: lanes.buffer(kind, layout.lanes) for kind in GATHERED}
        tile = own + starts[:, None]
        cells = table[tuple(slice(*pair) for pair in tile)]
        lanes.gather(cells, tile[:, 0], layout, held)
        totals.fold_counts(held["counts"], layout, offset, 0, 1)
        totals.fold_sum("x", held["sum"], layout, offset, lanes.line)
        for kind in ("largest", "least"):
            values, at = held[f"first_{kind}"], held[f"{kind}_at"]
            totals.fold_extremes("x", kind, values, at, layout, offset)
    return totals.state("x", 0)


def mean_of(state: State) -> np.ndarray:
    finite = means(int(state["x.low"][0]), state["x.digits"], state["x.ends"][4])
    return finite + state["x.beyond"]


@pytest.mark.by_day(3)
@pytest.mark.parametrize("values", HARD.values(), ids=HARD)
def test_sums_of_single_cells_are_exact_however_they_are_joined(values: np.ndarray) -> None:
    """A tile of one cell adds nothing, so that what is left is the exact sum of tiles."""
    want = float(sum(map(Fraction, values.tolist())) / values.size)
    for seed in range(3):
        states = [gathered(np.array([[v]]), ("a", "b")) for v in values[:300].tolist()]
        order = np.random.default_rng(seed).permutation(len(states))
        total = states[order[0]]
        for k in order[1:]:
            total = merge_states(total, states[k])
        some = values[:300].tolist()
        assert mean_of(total)[0] == float(sum(map(Fraction, some)) / len(some))
    bound = (
        (DEPTH + 16) / 2**53 * float(sum(abs(Fraction(v)) for v in values.tolist()) / len(values))
    )
    assert abs(mean_of(gathered(values[:, None], ("a", "b")))[0] - want) <= bound + 5e-324


@pytest.mark.parametrize("values", HARD.values(), ids=HARD)
def test_every_slot_has_what_it_would_have_alone(values: np.ndarray) -> None:
    width = 5
    table = values[: values.size // width * width].reshape(-1, width)
    if not table.size:
        return
    state = gathered(table, ("a",))
    for slot in range(width):
        line = table[:, slot]
        ends = state["x.ends"][:, slot]
        assert values_of(ends[0:1])[0] == line.max()
        assert values_of(ends[2:3])[0] == line.min()
        assert (ends[1], ends[3], ends[4]) == (line.argmax(), line.argmin(), line.size)


def test_boxes_of_whole_tiles_join_to_the_same_bits() -> None:
    table = CHANCE.normal(size=(40, 30, 100))
    whole = gathered(table, ("a", "b", "c"))
    step = LaneOrder.of("ab", "c", {"a": 40, "b": 30, "c": 100}, "abc").steps["a"]
    parts = [
        gathered(table, ("a", "b", "c"), {"a": (at, min(at + step, 40))})
        for at in range(0, 40, step)
    ]
    joined = parts[-1]
    for part in parts[:-1]:
        joined = merge_states(joined, part)
    assert len(parts) > 2
    assert mean_of(joined).tobytes() == mean_of(whole).tobytes()


@pytest.mark.parametrize("over", ["a", "b", "c", "ab", "ac", "bc", "abc"])
def test_extremes_and_counts_do_not_depend_on_tiles(over: str) -> None:
    """Few values, so that many are equal; the last tiles of an axis are shorter than the others."""
    table = CHANCE.integers(-3, 3, (17, 23, 30)).astype(float)
    table[table == 0] = math.nan
    found = [gathered(table, tuple(over), most=most)["x.ends"] for most in (1, 7, 100, TILE_CELLS)]
    assert all(np.array_equal(ends, found[0]) for ends in found)


def test_cells_that_do_not_count_are_left_out() -> None:
    state = gathered(np.array([[3.0, math.nan, -0.0, 1.0]]), ("a", "b"))
    assert values_of(state["x.ends"][:, 0])[[0, 2]].tolist() == [3, 0]
    assert state["x.ends"][[1, 3, 4], 0].tolist() == [0, 2, 3]
    assert mean_of(state)[0] == 4 / 3
    empty = gathered(np.full((2, 3), math.nan), ("a", "b"))
    assert empty["x.ends"][4, 0] == 0
    assert math.isnan(mean_of(empty)[0])


@pytest.mark.parametrize(
    ("values", "want"),
    [((1, math.inf), math.inf), ((1, -math.inf), -math.inf), ((math.inf, -math.inf), math.nan)],
)
def test_means_of_infinite_values(values: tuple[float, ...], want: float) -> None:
    np.testing.assert_equal(mean_of(gathered(np.array([values]), ("a", "b")))[0], want)


def test_of_equal_cells_the_first_in_the_grid_counts() -> None:
    """Loops stand in another order than the axes, and -infinity is a value like any other."""
    for value in (1.0, -math.inf, math.inf):
        table = np.full((3, 4, 5), math.nan)
        table[1, 2:, 3:] = value
        table[2] = value
        ends = gathered(table, ("a", "b", "c"))["x.ends"]
        first = 1 * 20 + 2 * 5 + 3
        assert (ends[1, 0], ends[3, 0]) == (first, first)


def test_packed_counts_come_apart() -> None:
    packed = np.array([3.0 + 200.0 * 2**COUNT_BITS, float(DEPTH) * 2.0 ** (5 * COUNT_BITS)])
    counts = np.zeros((6, 1), np.int64)
    fold_counts(packed, np.array([1, 0]), np.array([0]), 0, counts)
    assert counts[:, 0].tolist() == [3, 200, 0, 0, 0, DEPTH]
    assert not packed.any()
    many = np.full(1000, sum(float(DEPTH) * 2.0 ** (k * COUNT_BITS) for k in range(6)))
    counts[:] = 0
    fold_counts(many, np.arange(1000), np.array([0]), 0, counts)
    assert counts[:, 0].tolist() == [1000 * DEPTH] * 6
    assert DEPTH < 1 << COUNT_BITS


@pytest.mark.parametrize("scale", [1e-300, 1e-3, 1.0, 1e200])
def test_quantiles_of_a_histogram_keep_their_error(scale: float) -> None:
    values = scale * np.random.default_rng(3).normal(loc=1, size=200_000)
    values[:1000] = math.nan
    counts = np.zeros(others.BINS, np.int64)
    regimes = np.zeros(values.size, np.int8)
    others.histogram(values, regimes, 1, counts)
    bins = np.flatnonzero(counts)
    ends = gathered(values[:, None], ("a", "b"))["x.ends"]
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
    ends = gathered(values[:, None], ("a", "b"))["x.ends"]
    found = binned_quantiles(bins, counts[bins], ends, (0.0, 0.5, 1.0))[:, 0]
    assert found.tolist() == [-math.inf, 1.0, math.inf]


def cells_of_lanes(
    order: LaneOrder, dims: str, shape: dict[str, int], over: tuple[str, ...]
) -> list[list[int]]:
    """Return the numbers of the cells of each lane of the first tile, as its loops take them."""
    lanes = BoxLanes(order, dims, over, shape)
    tile = {name: min(order.steps[name], shape[name]) for name in dims}
    layout = lanes.tiles(tuple(tile.values())).layouts[0]
    *strides, along = layout.strides.tolist()
    inner = [np.arange(tile[name]) * lanes.numbers.get(name, 0) for name in order.inner]
    row = functools.reduce(np.add.outer, inner).reshape(-1).tolist()
    taken: list[list[int]] = [[] for _ in range(layout.lanes)]
    for at in range(0, len(row), order.piece):
        for turns in itertools.product(*(range(tile[name]) for name in order.outer)):
            start = sum(stride * k for stride, k in zip(strides, turns, strict=True))
            start += at // order.period * along
            turn_of = zip(order.outer, turns, strict=True)
            number = sum(lanes.numbers.get(name, 0) * k for name, k in turn_of)
            for k, own in enumerate(row[at : at + order.piece]):
                taken[start + k].append(number + own)
    return taken


def test_cells_come_in_the_order_of_the_grid_where_a_loop_takes_it_so() -> None:
    chance = random.Random(36)
    rising = set()
    for _ in range(100):
        dims = "abcd"
        shape = {name: chance.choice([1, 2, 3, 40]) for name in dims}
        inner = dims[chance.choice([2, 3]) :]
        outer = chance.sample(dims[: -len(inner)], len(dims) - len(inner))
        over = tuple(name for name in dims if chance.random() < 0.7)
        order = LaneOrder.of(outer, inner, shape, over)
        rises = all(cells == sorted(cells) for cells in cells_of_lanes(order, dims, shape, over))
        assert order.is_in_grid_order(dims, over) == rises
        rising.add(rises)
    assert rising == {True, False}


@pytest.mark.parametrize("end", ["largest", "least"])
def test_a_lane_keeps_the_first_of_equal_extremes_in_any_order(end: str) -> None:
    """What a loop does is carried out as it is written, one cell after another."""
    is_better = float.__gt__ if end == "largest" else float.__lt__
    for values in itertools.product([-math.inf, math.nan, -1.0, 1.0, math.inf], repeat=4):
        first, at = math.nan, math.inf
        for number, value in enumerate(values):
            if value == value and (first != first or is_better(value, first)):
                first, at = value, number
        want = repr((first, at))
        assert repr(kept(f"next_{end}", enumerate(values))) == want
        for order in itertools.permutations(enumerate(values)):
            assert repr(kept(f"first_{end}", order)) == want


def kept(update: str, cells: Iterable[tuple[int, float]]) -> tuple[float, float]:
    """Return the extreme and the place that a lane keeps of numbered cells."""
    _, lines, _ = UPDATES[update]
    source = "\n".join(line.format("v", "at", value="x", number="n") for line in lines)
    code = compile(source, update, "exec")
    names = {
        "v": math.nan,
        "at": math.inf,
        "choose": lambda which, one, other: one if which else other,
    }
    for number, value in cells:
        names |= {"x": value, "n": number}
        exec(code, names)
    return names["v"], names["at"]
