"""All measurements of one study, and the dataset of them."""

from __future__ import annotations

import math
import os
import platform
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from vibrafeed import core
from vibrafeed.core.assurance.accuracy import closed_forms, model, motion, optimisers, storage
from vibrafeed.core.assurance.accuracy.curves import Measured, tabulate_curves
from vibrafeed.core.assurance.accuracy.families import SECONDS, families_of
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.kinds import share_left_out, tabulate
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.labels import global_attributes
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.study.values import Points
from vibrafeed.core.sweep import Sweep
from vibrafeed.core.watch import Watch

MAX_CELLS = 400_000  # of a result that is stored; a larger grid is thinned
MAX_CELLS_MOTION = 2_000  # of one whose cells take milliseconds
LIBRARIES = ("numpy", "numba", "scipy", "mpmath", "netCDF4")


@dataclass(frozen=True)
class ReportPart:
    """The measurements of one study.

    Attributes
    ----------
    name : str
        The study as the user named it: the path of its file.
    title, scene : str
        Its title, and its scene with variant or method.
    measured : tuple of Measured
        One a family.
    table : Table
        All points as one dataset.
    """

    name: str
    title: str
    scene: str
    measured: tuple[Measured, ...]
    table: Table


def measure_study(
    prepared: Prepared,
    *,
    name: str,
    watch: Watch | None = None,
    seconds: float = SECONDS,
    only: Collection[str] = (),
) -> ReportPart:
    """Measure the accuracy and time of the methods that a study could use, for a report.

    Parameters
    ----------
    prepared : Prepared
        The study.
    name : str
        Name of the study, which the report prints within commands.
    watch : Watch, optional
        Takes the progress and may stop the measurement; families that are done are kept.
    seconds : float
        Time after which a family of measurements starts nothing new [s].
    only : collection of str
        Names of the families to measure, such as `optimisers`; by default all that the study has.

    Raises
    ------
    StudyError
        If `only` names a family that the study does not have.
    """
    watch = watch or Watch()
    families = families_of(prepared, only)
    measured = []
    for family in families:
        if watch.stopped():
            break
        share = watch.part(1 / len(families))
        measurement = measure_family(prepared, family, share, seconds)
        if measurement is not None:
            measured.append(measurement)
    return part_of(prepared, name, measured, machine())


def measure_family(
    prepared: Prepared, family: str, watch: Watch, seconds: float = SECONDS
) -> Measured | None:
    """Measure one family of a study's accuracy, such as "storage"; None if it does not apply.

    Parameters
    ----------
    prepared : Prepared
        The study.
    family : str
        A key of `FAMILIES`.
    watch : Watch
        May stop it; what was measured by then is kept.
    seconds : float
        Time after which nothing new is started [s].
    """
    ends = min(time.monotonic() + seconds, watch.deadline or math.inf)
    return _measure(family, prepared, replace(watch, deadline=ends), seconds)


def part_of(
    prepared: Prepared, name: str, measured: Sequence[Measured], facts: Mapping[str, str]
) -> ReportPart:
    """Return the accuracy measurements of a study with the facts they depend on.

    Parameters
    ----------
    prepared, name : Prepared, str
        The study, and what it is called in commands: the path of its file.
    measured : sequence of Measured
        The families of measurements.
    facts : mapping of str to str
        Machine, date and versions, stored as attributes of the table of all points.
    """
    plan = prepared.plan
    return ReportPart(
        name,
        prepared.study.title or plan.scene.title,
        f"{plan.scene.name}, {plan.scene.choice} {plan.variant}",
        tuple(measured),
        tabulate_curves(measured, {**global_attributes(prepared, "accuracy report"), **facts}),
    )


def machine() -> dict[str, str]:
    """Return facts on the environment of measurements, which the report on accuracy prints.

    The keys are `machine` (processor, cores, operating system, load), `date` (ISO, UTC) and
    `versions` (of vibrafeed, Python and libraries); times depend on them.
    """
    libraries = ", ".join(f"{name} {version(name)}" for name in LIBRARIES)
    return {
        "machine": f"{_processor()}, {os.cpu_count()} cores, {platform.system()}{_load()}",
        "date": datetime.now(UTC).date().isoformat(),
        "versions": f"vibrafeed {core.__version__}, Python {platform.python_version()}, "
        f"{libraries}",
    }


def _processor() -> str:
    """Return the name of this computer's processor, for the report on accuracy.

    Linux lists it in /proc/cpuinfo; elsewhere it is what Python finds.
    """
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def _load() -> str:
    """Return the number of other busy processes, if the system tells it."""
    if not hasattr(os, "getloadavg"):
        return ""
    return f", load {os.getloadavg()[0]:.1f} over the last minute"


def _measure(family: str, prepared: Any, watch: Watch, seconds: float) -> Measured | None:
    """Measure one family of a study's accuracy by the function for it; None if it does not apply.

    `seconds` is the time that methods of optimisation share [s]; all others end by the deadline of
    `watch`. `prepared` is a study of a kind that has the family.
    """
    measures: dict[str, Callable[[], Measured | None]] = {
        "closed_forms": lambda: closed_forms.measure(prepared, watch),
        "model": lambda: _model(prepared, watch),
        "motion": lambda: _motion(prepared, watch),
        "optimisers": lambda: optimisers.measure(prepared, watch, seconds),
        "storage": lambda: _storage(prepared, watch),
    }
    return measures[family]()


def _model(prepared: Sweep, watch: Watch) -> Measured | None:
    """Return the deviations of a sweep's closed forms from the simulated motion of the same cells.

    `prepared` is the sweep; `watch` may stop the measurement and takes its progress. The result has
    a note and no measurements if scene and parameters do not define a motion in time.
    """
    moving = model.motion_of_sweep(prepared)
    if moving is None:
        note = "Scene and parameters of this sweep do not define a motion in time."
        return Measured("model", (), (note,))
    return model.measure(prepared, moving, watch)


def _motion(prepared: Prepared, watch: Watch) -> Measured | None:
    """Measure error and time of the methods that simulate the motion of a study.

    A sweep of closed forms is simulated with its scene and parameters; the result is None if these
    define no motion. For tumbling parts, which have no mean velocity, there is only a note.
    `prepared` is the study; `watch` may stop the measurement.
    """
    moving: Any = prepared
    if prepared.plan.scene.choice == "method":  # it is a motion itself
        if not motion.is_point_part(prepared.plan.scene):
            note = "A tumbling part has no mean velocity to compare."
            return Measured("motion", (), (note,))
    else:
        moving = model.motion_of_sweep(moving)
    return None if moving is None else motion.measure(moving, watch)


def _storage(prepared: Prepared, watch: Watch) -> Measured:
    """Measure error, size and time of storage formats for the result of a study.

    Half of the time until the deadline of `watch` is for computing the result, half for writing it.
    Axes of the study (`prepared`) are thinned to a size that can be computed in that time; cells
    that are missing by then are NaN, and notes say so.
    """
    is_fast = prepared.not_lazy is None or prepared.plan.variant == "events"
    most = MAX_CELLS if is_fast else MAX_CELLS_MOTION
    half = watch.part(0.5)
    # Half of the time to compute the result, half to write it; what is missing by then is NaN.
    first = half
    if half.deadline is not None:
        now = time.monotonic()
        first = replace(half, deadline=now + (half.deadline - now) / 2)
    smaller = replace(prepared, grid=thinned(prepared.grid, most))
    table = tabulate(smaller.unverified(), first)
    measured = storage.measure(table, half)
    notes = []
    if smaller.cells < prepared.cells:
        notes.append(
            f"{smaller.cells:,} of the study's {prepared.cells:,} cells: axes are thinned evenly."
        )
    missing = share_left_out(table)
    if missing:
        notes.append(f"The time given ran out: {missing:.0%} of these cells have no value.")
    return replace(measured, notes=(*notes, *measured.notes))


def thinned(grid: Grid, most: int) -> Grid:
    """Return a grid with fewer values on its longest axes, so that it has at most `most` cells.

    The values that are kept lie evenly along an axis, both ends among them.
    """
    sizes = dict(grid.shape)
    while math.prod(sizes.values()) > most:
        longest = max(sizes, key=lambda name: sizes[name])
        others = math.prod(sizes.values()) // sizes[longest]
        second = max((size for name, size in sizes.items() if name != longest), default=1)
        sizes[longest] = max(1, most // others, min(second, sizes[longest] - 1))
    axes = {}
    for name, axis in grid.axes.items():
        if sizes[name] == axis.size:
            axes[name] = axis
            continue
        places = {round(k * (axis.size - 1) / max(1, sizes[name] - 1)) for k in range(sizes[name])}
        values = (float(axis.array(k, k + 1)[0]) for k in sorted(places))
        axes[name] = Points(tuple(values))
    return Grid(axes, grid.fixed)
