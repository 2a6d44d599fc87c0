"""What a reduced sweep costs, over the cost of its cells alone and over what a user would write.

    python -m benchmarks.reduce [--cells 1e9] [--runs 9] [--sizes 1e9 1e10]

Seven axes of the narrow track; the answers stay over two of them. In one run and in turn:

- the limit: the same cells computed by the compiled loop into one tile that stays in the cache,
  with the regime of each, which tells the cells that count;
- each answer alone, and several at once;
- what one would write with xarray and, where it is installed, numexpr, over fewer cells.

Each line has the median of the runs by the clock, and its ratio to the limit by the clock and in
seconds of the processor, which other processes disturb less. Then the bits of a smaller study are
compared for threads, boxes and parts. `--sizes` prints memory, and how well time is predicted.
"""

from __future__ import annotations

import itertools
import resource
import statistics
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from benchmarks.options import options
from vibrafeed.core.aligned import aligned
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.loops.lanes import LaneLoop
from vibrafeed.core.plan.loops.trace import traced
from vibrafeed.core.reduce.arrays import reduced_arrays
from vibrafeed.core.reduce.run import Units, cores
from vibrafeed.core.reduce.state import State, merge_states
from vibrafeed.core.sweep import ReducedSweep
from vibrafeed.core.watch import Watch

try:
    import numexpr
except ImportError:  # it is no part of vibrafeed
    numexpr = None

SPEED = "transport_velocity"
ASKED: dict[str, dict[str, Any]] = {
    "max": {"statistics": ["max"]},
    "mean": {"statistics": ["mean"]},
    "argmax": {"statistics": ["argmax"]},
    "max, mean, argmax, regimes": {"statistics": ["max", "mean", "argmax"], "regimes": True},
    "all statistics": {"statistics": ["max", "min", "mean", "argmax", "argmin"]},
    "share": {"shares": {"fast": ["regime == slip", f"{SPEED} >= 10 mm/s"]}},
}
BARS = {"max": 1.3, "mean": 1.3, "argmax": 1.3, "max, mean, argmax, regimes": 2.0}
"""What each may cost over the limit."""
PEER_BAR = 20.0
SLOW: dict[str, dict[str, Any]] = {
    "level": {"levels": {"reach": {"output": SPEED, "level": "10 mm/s", "along": "beta"}}},
    "median": {"quantiles": [0.5]},
}
"""What is read off stored boxes; over fewer cells."""
FEW, PEER_CELLS, BITS_CELLS = 30_000_000, 10_000_000, 3_000_000
TABLE = ("frequency", "amplitude")
SPANS = {
    "frequency": (20, 120),
    "amplitude": (2e-5, 2e-4),
    "alpha": (0, 60),
    "beta": (1, 30),
    "gamma": (0, 30),
    "friction": (0.1, 0.6),
    "distance": (1e-5, 1e-4),
}
RADIUS, GRAVITY = 0.8, 9.80665


def study(cells: float, asked: dict[str, Any], kept: tuple[str, ...] = TABLE) -> dict[str, Any]:
    """Return a study of about `cells` cells, reduced over all axes except some."""
    left = int(cells)
    axes = {}
    for done, (name, (start, stop)) in enumerate(SPANS.items()):
        size = max(2, round(left ** (1 / (len(SPANS) - done))))
        left = -(-left // size)
        axes[name] = {"start": start, "stop": stop, "num": size}
    return {
        "kind": "sweep",
        "scene": "rectangle-on-track",
        "outputs": [SPEED],
        "parameters": {**axes, "radius": f"{RADIUS} m"},
        "reduce": {"over": [name for name in SPANS if name not in kept], **asked},
    }


def prepared(content: dict[str, Any]) -> ReducedSweep:
    """Return a prepared study."""
    sweep = prepare_content(content)
    assert isinstance(sweep, ReducedSweep)
    return sweep


def limit(sweep: ReducedSweep) -> Callable[[], None]:
    """Return a function that computes all cells without reducing them, on all cores."""
    plan, grid = sweep.work.boxes[0].field.plan, sweep.grid
    plan = plan.part((SPEED, *plan.verdict_names))
    graph = traced(plan, grid.axes)
    assert graph is not None
    whole = grid.piece({name: (0, size) for name, size in grid.shape.items()}, plan.parameters)
    updates = [(SPEED, "store"), ("regime", "store")]
    loop = LaneLoop(plan, graph, whole, updates, tuple(grid.axes))
    loop.prepare()
    order, shape = loop.order, grid.shape
    axes, nowhere = (*order.outer, *order.inner), order.along_loops({})
    ends = [
        [
            (at, min(at + order.steps[name], shape[name]))
            for at in range(0, shape[name], order.steps[name])
        ]
        for name in axes
    ]
    tiles = order.ranges(axes, np.array(list(itertools.product(*ends))))

    def some(share: Iterable[NDArray[np.int64]]) -> None:
        """Compute a share of the tiles."""
        rows = [aligned((order.piece,)), aligned((order.piece,), np.int8)]
        for tile in share:
            loop.run(tile, nowhere, nowhere, rows)

    def run() -> None:
        """Compute all tiles on all cores."""
        with ThreadPoolExecutor(cores()) as pool:
            list(pool.map(some, (tiles[k :: cores()] for k in range(cores()))))

    return run


def by_xarray(grid: Grid) -> xarray.DataArray:
    """Return the largest speed per drive with xarray, as a user would write it."""
    at = {name: xarray.DataArray(grid.coordinate(name), dims=name) for name in grid.axes}
    alpha, beta, gamma = (np.deg2rad(at[name]) for name in ("alpha", "beta", "gamma"))
    push = at["amplitude"] * (2 * np.pi * at["frequency"]) ** 2 * np.cos(beta)
    friction = at["friction"]
    start = push * (np.cos(alpha) + friction * np.sin(alpha)) - GRAVITY * np.sin(gamma)
    decay = -np.expm1(-2 * friction * at["distance"] / RADIUS) * RADIUS / friction
    return np.sqrt(start.clip(0) * decay).max([name for name in at if name not in TABLE])


def by_numexpr(grid: Grid, *, is_prepared: bool) -> Any:
    """Return the largest speed per drive with numexpr, one drive at a time.

    The formula is one text; or, prepared by hand, sines and the like are computed before on their
    own small grids, and the text has what needs every cell.
    """
    at = {
        name: grid.coordinate(name).reshape([-1 if k == own else 1 for own in range(len(SPANS))])
        for k, name in enumerate(grid.axes)
    }
    at |= {name: np.deg2rad(at[name]) for name in ("alpha", "beta", "gamma")}
    push, weight = "push * cos(beta) * (cos(alpha) + friction * sin(alpha))", "g * sin(gamma)"
    decay = "-expm1(-2 * friction * distance / r) * r / friction"
    values = {**at, "g": GRAVITY, "r": RADIUS}
    if is_prepared:
        names = {
            "x": "cos(beta)",
            "y": "cos(alpha) + friction * sin(alpha)",
            "w": weight,
            "d": decay,
        }
        values = {name: numexpr.evaluate(text, values) for name, text in names.items()}
        push, weight, decay = "push * x * y", "w", "d"
    text = f"sqrt(where({push} > {weight}, {push} - {weight}, 0) * ({decay}))"
    drives = (at["amplitude"] * (2 * np.pi * at["frequency"]) ** 2).ravel()
    return [numexpr.evaluate(text, {**values, "push": one}).max() for one in drives]


def timed(run: Callable[[], object]) -> tuple[float, float]:
    """Return wall time and processor time of a call [s]."""
    clock, processor = time.perf_counter(), time.process_time()
    run()
    return time.perf_counter() - clock, time.process_time() - processor


def compare(cells: float, runs: int) -> None:
    """Print the cost of each reduction over the limit, and of peers over `max`."""
    sweeps = {name: prepared(study(cells, asked)) for name, asked in ASKED.items()}
    small = prepared(study(PEER_CELLS, ASKED["max"]))
    ways: dict[str, tuple[Callable[[], object], int]] = {
        "limit": (limit(sweeps["max"]), sweeps["max"].cells),
        **{name: (lambda s=s: tabulate(s), s.cells) for name, s in sweeps.items()},
        "xarray, max": (lambda: by_xarray(small.grid), small.cells),
    }
    if numexpr is not None:
        for name, how in (("numexpr, max", False), ("numexpr by hand, max", True)):
            ways[name] = (lambda how=how: by_numexpr(small.grid, is_prepared=how), small.cells)
    for run, _ in ways.values():
        run()  # loops are compiled
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in ways}
    for _ in range(runs):
        for name, (run, count) in ways.items():
            times[name].append(tuple(each / count * 1e9 for each in timed(run)))  # type: ignore[arg-type]
    print(f"{sweeps['max'].cells:,} cells, {cores()} cores, medians of {runs}")
    print(f"{'':28} ns a cell (least to most)   over limit: clock, processor   bar")
    lines = {
        name: [statistics.median(one[k] for one in own) for k in (0, 1)]
        for name, own in times.items()
    }
    for name, (clock, processor) in lines.items():
        spread = sorted(one[0] for one in times[name])
        over = [mine / of for mine, of in zip((clock, processor), lines["limit"], strict=True)]
        bar = f"at most {BARS[name]}" if name in BARS else ""
        if name.endswith(", max"):
            faster = [mine / of for mine, of in zip((clock, processor), lines["max"], strict=True)]
            bar = f"{faster[0]:.0f}, {faster[1]:.0f} times ours; bar {PEER_BAR:.0f}"
        print(
            f"{name:28} {clock:6.2f} ({spread[0]:.2f} to {spread[-1]:.2f})"
            f"{over[0]:16.2f} {over[1]:14.2f}   {bar}",
            flush=True,
        )


def slow_ones(runs: int) -> None:
    """Print the cost of reductions that need stored boxes."""
    for name, asked in SLOW.items():
        sweep = prepared(study(FEW, asked))
        times = [timed(lambda s=sweep: tabulate(s)) for _ in range(runs)]
        clock = [one[0] / sweep.cells * 1e9 for one in times]
        print(f"{name}: {statistics.median(clock):.1f} ns a cell of {sweep.cells:,}", flush=True)


def same_bits() -> None:
    """Print whether results have equal bits for all threads, boxes and parts."""
    asked = {**ASKED["all statistics"], "regimes": True}
    for kept in (TABLE, ("beta", "distance"), ("friction",), ()):
        sweep = prepared(study(BITS_CELLS, asked, kept))
        found = set()
        for threads, cells in ((1, None), (2, None), (2, 100_000), (1, 1)):
            units = Units(sweep.plan, sweep.grid, sweep.asked, cells)
            found.add(_bits(sweep, units, units.states(0, len(units), Watch(threads=threads))))
        ends = [round(k * len(sweep.work) / 64) for k in range(65)]
        states = (
            state
            for start, stop in itertools.pairwise(ends)
            if stop > start
            for state in sweep.work.states(start, stop, Watch(threads=2))
        )
        found.add(_bits(sweep, sweep.work, _joined(states)))
        by = " and ".join(kept) or "nothing"
        print(f"by {by}: {'the same bits' if len(found) == 1 else 'BITS DIFFER'}", flush=True)


def _bits(sweep: ReducedSweep, units: Units, states: Iterable[tuple[int, int, State]]) -> bytes:
    """Return the bytes of a reduction's variables."""
    arrays = reduced_arrays(units, sweep.grid, sweep.asked, states)
    return b"".join(arrays[name].tobytes() for name in sorted(arrays))


def _joined(states: Iterable[tuple[int, int, State]]) -> Iterable[tuple[int, int, State]]:
    """Return states joined by field and block."""
    known: dict[tuple[int, int], State] = {}
    for field, block, state in states:
        place = field, block
        known[place] = merge_states(known[place], state) if place in known else state
    return [(*place, state) for place, state in known.items()]


def sizes(cells: Iterable[float]) -> None:
    """Print time, price and memory of large studies."""
    for count in cells:
        sweep = prepared(study(count, ASKED["argmax"]))
        clock, _ = timed(lambda s=sweep: tabulate(s))
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(
            f"argmax, {sweep.cells:,} cells: {clock:.1f} s, {clock / sweep.cells * 1e9:.2f} ns a "
            f"cell, price {sweep.seconds_here:.1f} s; {memory:.0f} MiB at most",
            flush=True,
        )


def main() -> None:
    """Print all measurements."""
    asked = options(__doc__, cells=1e9, runs=9, sizes=[float])
    compare(asked.cells, asked.runs)
    slow_ones(min(asked.runs, 3))
    same_bits()
    sizes(asked.sizes)


if __name__ == "__main__":
    main()
