"""Prints what an atlas takes, holds and answers, judged by exact cells that it has not seen.

`python -m benchmarks.atlas` makes the full atlas first; `--atlas FILE` judges one that is there.
`--picture docs/generated/atlas-chart.png` draws the page of the book that docs/atlas.md shows.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.options import options
from benchmarks.timing import least
from vibrafeed.core.atlas.build import RESOLUTIONS, build
from vibrafeed.core.atlas.cells import exact
from vibrafeed.core.atlas.find import STATUS, AtlasValues, find
from vibrafeed.core.atlas.numbers import AXES, Numbers
from vibrafeed.core.atlas.practice import practical_numbers
from vibrafeed.core.atlas.read import open_atlas
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.plots.book_page import Chart, draw_page
from vibrafeed.core.plots.files import METADATA

CELLS = 10_000
TIMED = 100_000
REPEATS = 5
WITHIN_TEN = 10.0


def main() -> None:
    """Print how an atlas was made, how often it answers, how accurate and how fast it is."""
    arguments = options(
        __doc__,
        atlas=(Path, "an atlas that is there"),
        resolution=("full", ", ".join(RESOLUTIONS)),
        seed=0,
        picture=(Path, "draw a chart, and nothing else"),
    )
    if arguments.picture is not None:
        page = draw_page(Chart.of(0.3, 0.0))
        page.savefig(arguments.picture, dpi=100, metadata=METADATA["png"])
        return
    with tempfile.TemporaryDirectory() as folder:
        path = arguments.atlas or _made(Path(folder) / "atlas.nc", arguments.resolution)
        print(f"size: {path.stat().st_size / 1e6:.1f} MB")
        atlas = open_atlas(path)
    print(f"nodes: {' x '.join(map(str, atlas.shape))} = {atlas.patterns.size:,}")
    rng = np.random.default_rng(arguments.seed)
    print(f"\n{'cells':34}{'number':>8}{'answered':>10}{'stated: median':>16}{'99 %':>9}"
          f"{'true: median':>14}{'within':>9}{'ten times':>11}")  # fmt: skip
    numbers = _of_practice(rng)
    found, right = find(atlas, numbers), exact(numbers)
    level, one = numbers.slope_number == 0, numbers.friction_ratio == 1
    print_row("practical range", found, right.velocity, np.ones(CELLS, dtype=bool))
    print_row("  level track, one friction", found, right.velocity, level & one)
    print_row("  level track, two frictions", found, right.velocity, level & ~one)
    print_row("  slope, one friction", found, right.velocity, ~level & one)
    print_row("  slope, two frictions", found, right.velocity, ~level & ~one)
    answered = found.status == STATUS["answered"]
    print(f"  in another regime than stated: {(found.pattern != right.pattern)[answered].sum()}")
    for name in ("stick", "forward", "backward", "flight"):
        off = np.abs(getattr(found, name) - getattr(right, name))[answered]
        print(
            f"  {name}: within its stated error {np.mean(off <= found.share_error[answered]):.4f}"
        )
    numbers = _anywhere(rng)
    print_row("whole range, evenly", find(atlas, numbers), exact(numbers).velocity,
              np.ones(CELLS, dtype=bool))  # fmt: skip
    numbers = _of_practice(rng, TIMED)
    looked_up = least(REPEATS, lambda: find(atlas, numbers), time.process_time) / TIMED
    followed = least(REPEATS, lambda: exact(numbers), time.process_time) / TIMED
    print("\nprocessor time")
    print(f"  a look-up      {1e6 * looked_up:.2f} us")
    print(f"  an exact cell  {1e6 * followed:.2f} us, {followed / looked_up:.1f} times as much")


def print_row(
    name: str, found: AtlasValues, right: NDArray[np.float64], some: NDArray[np.bool_]
) -> None:
    """Print how some cells are answered, with errors in the unit of the velocity number."""
    answered = (found.status == STATUS["answered"]) & some
    off, stated = np.abs(found.velocity - right)[answered], found.error[answered]
    print(f"{name:34}{some.sum():8,}{answered.sum() / some.sum():10.3f}{np.median(stated):16.1e}"
          f"{np.quantile(stated, 0.99):9.1e}{np.median(off):14.1e}{np.mean(off <= stated):9.4f}"
          f"{np.mean(off <= WITHIN_TEN * stated):11.4f}")  # fmt: skip


def _made(path: Path, resolution: str) -> Path:
    """Make an atlas, print its times, and return its path."""
    began, spent = time.perf_counter(), time.process_time()
    table = build(resolution)
    built = time.perf_counter()
    print(f"made in {built - began:.1f} s, {time.process_time() - spent:.1f} s of processor time")
    write_netcdf(table, path)
    print(f"written in {time.perf_counter() - built:.1f} s")
    return path


def _of_practice(rng: np.random.Generator, count: int = CELLS) -> Numbers:
    """Return random atlas numbers of the practical range."""
    found = practical_numbers(rng.random((2 * count, 7)))
    return Numbers(*(values[:count] for values in found))


def _anywhere(rng: np.random.Generator) -> Numbers:
    """Return random numbers over the whole atlas; the angle number on a logarithmic scale."""
    fields = {name: rng.uniform(a.least, a.largest, CELLS) for name, a in AXES.items()}
    angle = AXES["angle_number"]
    fields["angle_number"] = np.exp(rng.uniform(np.log(angle.least), np.log(angle.largest), CELLS))
    return Numbers(**fields)


if __name__ == "__main__":
    main()
