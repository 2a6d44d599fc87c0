"""Error against run time of one study, against a witness: `vibrafeed report`.

The closed forms of a sweep run in 32-bit and 64-bit floats, and are compared with the same
equations in extended precision (`numpy.longdouble`). The motions of a simulation are followed by
the method `events` over its tolerance, and are compared with the method `reference`, which shares
no code with it. Cells are drawn at random from the grid of the study; equal studies have equal
cells.
"""

import os
import platform
import statistics
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed import core
from vibrafeed.core.dataset.table import Table, TableVariable
from vibrafeed.core.errors import refused
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.evaluate import BLOCK_CELLS
from vibrafeed.core.plan.grid import random_positions
from vibrafeed.core.plan.labels import global_attributes
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.plan.plan import Plan, plan_scene, run_equations, scene_parameters
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.quantities import MOTION_STATUSES
from vibrafeed.core.sweep.verify import EXTENDED, outputs_in
from vibrafeed.core.watch import Watch

SEED = 2004
FORMULA_CELLS, MOTION_CELLS = 1000, 24
CANDIDATES = 8  # a motion wanted: those that do not repeat, or rest, are left out
TYPES = {"float32": np.float32, "float64": np.float64}
TOLERANCES = tuple(10.0**-k for k in (1, 2, 3, 4, 6, 8, 10, 12))
WITNESS = "reference"
OUTPUTS = ("conveying_velocity", "conveying_velocity_error", "flight_fraction", "drive_number",
           "velocity_scale", "motion_status")  # fmt: skip
ROUNDING = 1e-15  # of the drive's speed: what moves less is at rest
OTHER_MOTION = 1e-6  # of the drive's speed: two exact methods that differ by more fell into two
WITNESS_ERROR = 1e-9  # of the drive's speed: more, and the witness is none
REPEATS = 5
LEAST_SECONDS = 2e-3  # of one repeat: the clock and the start of a call do not matter then
LIBRARIES = ("numpy", "numba", "scipy", "netCDF4")


@dataclass(frozen=True)
class Report:
    """The curves of one study: error against run time over the settings of its method.

    Attributes
    ----------
    curves, settings : tuple of str
        Outputs of closed forms, or groups of motions; types of float, or tolerances.
    error, largest, seconds : ndarray, shape (curves, settings)
        Median and largest error, and time of one cell on one thread [s]; NaN where none is known.
    cells : ndarray of int, shape (curves,)
        Number of cells of each curve.
    notes : mapping of str to str
        `measured` (the scene and its method), `witness` (what is compared with what), `machine`,
        `date`, `versions`.
    """

    curves: tuple[str, ...]
    settings: tuple[str, ...]
    error: Array
    largest: Array
    seconds: Array
    cells: NDArray[np.int32]
    notes: Mapping[str, str]

    def computed(self) -> Computed:
        """Return the report as arrays and texts, as a block of a job is stored."""
        arrays = {name: getattr(self, name) for name in ("error", "largest", "seconds", "cells")}
        names = {"curves": " ".join(self.curves), "settings": " ".join(self.settings)}
        return Computed(arrays, {**self.notes, **names})

    @classmethod
    def of(cls, computed: Computed) -> "Report":
        """Return the report that `computed` was made of."""
        notes = dict(computed.notes)
        curves, settings = (tuple(notes.pop(name).split()) for name in ("curves", "settings"))
        arrays: dict[str, Any] = dict(computed.arrays)
        return cls(curves, settings, notes=notes, **arrays)

    def table(self, prepared: Prepared) -> Table:
        """Return the report as a table over `curve` and `setting`, flags with their meanings."""
        dims = ("curve", "setting")
        numbers = {
            "error": (self.error, "median error", "1"),
            "error_largest": (self.largest, "largest error", "1"),
            "time_per_cell": (self.seconds, "time of one cell", "s"),
        }
        cells = TableVariable(("curve",), self.cells, {"long_name": "cells measured", "units": "1"})
        return Table(
            {"curve": _flags("curve", self.curves), "setting": _flags("setting", self.settings)},
            {
                **{
                    name: TableVariable(dims, values, {"long_name": label, "units": unit})
                    for name, (values, label, unit) in numbers.items()
                },
                "cells": cells,
            },
            {**global_attributes(prepared, "error against run time"), **self.notes},
        )

    def section(self, name: str, title: str, picture: str | None) -> str:
        """Return the section of a page: notes, table, picture, as Markdown.

        `name` is the study's file, `title` its title, `picture` the file of its picture.
        """
        rows = (
            (curve, f"{self.cells[i]:,}", setting, *map(_number, (self.error[i, k],
             self.largest[i, k])), f"{_number(1e6 * self.seconds[i, k])} us")
            for i, curve in enumerate(self.curves)
            for k, setting in enumerate(self.settings)
            if np.isfinite(self.error[i, k])
        )  # fmt: skip
        columns = ("curve", "cells", "setting", "median error", "largest error", "time of a cell")
        parts = [
            f"## {title} ({Path(name).stem})",
            f"`vibrafeed report {name}`: {self.notes['measured']}. {self.notes['witness']}",
            "\n".join(markdown_table(columns, rows)),
            *([f"![Error against run time]({picture})"] if picture else []),
        ]
        return "\n\n".join(parts)

    def page(self, sections: Sequence[str]) -> str:
        """Return the page of several sections, with the machine and versions of this report."""
        head = (
            f"Error against run time. Machine: {self.notes['machine']}. Date: "
            f"{self.notes['date']}. Versions: {self.notes['versions']}. Times vary from run to "
            "run, errors do not: the cells are drawn with a fixed seed."
        )
        return "\n\n".join(("# Accuracy", head, *sections)) + "\n"


def measure(prepared: Prepared, watch: Watch | None = None) -> Report:
    """Measure error against run time of the method that computes a study.

    Parameters
    ----------
    prepared : Prepared
        A sweep or a simulation.
    watch : Watch, optional
        May stop it: settings that were not reached are NaN.

    Raises
    ------
    StudyError
        If the study has no witness: it is of another kind, or its parts have no mean velocity or
        no method `reference`.
    """
    check(prepared)
    watch = watch or Watch()
    facts = _facts()  # before the measurement adds to the load
    measured = _closed_forms if prepared.study.kind == "sweep" else _motions
    report = measured(prepared, watch)
    scene = f"{prepared.plan.scene.name}, {prepared.plan.scene.choice} {prepared.plan.variant}"
    return replace(report, notes={"measured": scene, **report.notes, **facts})


def check(prepared: Prepared) -> None:
    """Raise `StudyError` if there is nothing to compare a study with."""
    kind, scene = prepared.study.kind, prepared.plan.scene
    if kind not in ("sweep", "simulate"):
        raise refused(
            "kind",
            f"a report cannot be made of a study of kind '{kind}'",
            "Give a study of kind sweep or simulate; verify checks the results of others",
        )
    has_speed = "conveying_velocity" in scene.outputs(scene.default_variant)
    if kind == "simulate" and not (has_speed and WITNESS in scene.variants):
        raise refused(
            "scene",
            f"{scene.name} has no second method with which its mean velocity can be compared",
            "Give a study of one part on a plane or a track; verify checks others",
        )


def _closed_forms(prepared: Prepared, watch: Watch) -> Report:
    plan, grid = prepared.plan, prepared.grid
    count = min(FORMULA_CELLS, grid.cells)
    sample = grid.at(random_positions(grid, count, SEED), count, plan.parameters)
    shape = (len(plan.outputs), len(TYPES))
    error, largest, seconds = (np.full(shape, np.nan) for _ in range(3))
    cells = np.zeros(shape[0], dtype=np.int32)
    witness = np.longdouble if EXTENDED else np.float64
    for type_number, dtype in enumerate(TYPES.values()):
        with np.errstate(over="ignore"):
            rounded_sample = {name: values.astype(dtype) for name, values in sample.items()}
        # Values that overflow or vanish in the type are left out.
        is_representable = np.all(
            [
                np.isfinite(values) & ((values != 0) | (sample[name] == 0))
                for name, values in rounded_sample.items()
            ],
            0,
        )
        exact_outputs = {} if dtype is witness else outputs_in(plan, rounded_sample, witness)
        for output_number, name in enumerate(plan.outputs):
            if watch.stopped():
                break
            output_plan = plan.only(name)
            seconds[output_number, type_number] = _seconds_of(output_plan, rounded_sample, dtype)
            computed = outputs_in(output_plan, rounded_sample, dtype).get(name)
            if name in exact_outputs and computed is not None:
                errors = _relative(computed, exact_outputs[name])[is_representable]
                errors = errors[np.isfinite(errors)]
                if errors.size:
                    error[output_number, type_number] = np.median(errors)
                    largest[output_number, type_number] = errors.max()
                    cells[output_number] = max(cells[output_number], errors.size)
            watch.advance(1 / error.size)
    against = (
        "extended precision (numpy.longdouble), at the parameters as each type holds them"
        if EXTENDED
        else "float64: numpy.longdouble has no more digits on this machine"
    )
    words = (
        f"Error: share of the value, against the same equations in {against}; cells whose value "
        "is 0 or not finite are left out. Time: one thread, by numpy, blocks of "
        f"{BLOCK_CELLS:,} different cells; median of {REPEATS}."
    )
    return Report(plan.outputs, tuple(TYPES), error, largest, seconds, cells, {"witness": words})


def _seconds_of(plan: Plan, cells: Mapping[str, NDArray[Any]], dtype: Any) -> float:
    block = {name: np.resize(cells[name], BLOCK_CELLS) for name in plan.parameters}
    return _median_seconds(lambda: outputs_in(plan, block, dtype)) / BLOCK_CELLS


def _relative(computed: NDArray[Any], exact: NDArray[Any]) -> Array:
    with np.errstate(all="ignore"):
        error = np.abs(computed - exact) / np.abs(exact)
    error = np.where(np.isfinite(exact) & ~np.isfinite(computed), np.inf, error)
    return np.asarray(np.where(np.isfinite(exact) & (exact != 0), error, np.nan), dtype=np.float64)


@dataclass(frozen=True)
class _Means:
    velocity: Array  # mean, and its stated error, as shares of the drive's speed
    stated: Array
    periodic: NDArray[np.bool_]
    hops: NDArray[np.bool_]
    seconds: float  # of a cell


@dataclass(frozen=True)
class _Witnessed:
    cells: Mapping[str, Array]
    truth: _Means
    trusted: NDArray[np.bool_]
    tried: int

    def group(self, is_in_group: NDArray[np.bool_]) -> tuple[dict[str, Array], Array]:
        cells_of_group = {name: values[is_in_group] for name, values in self.cells.items()}
        return cells_of_group, self.truth.velocity[is_in_group]


def _motions(prepared: Prepared, watch: Watch) -> Report:
    # Error and time of the method events over its tolerance, of sliding and of hopping cells.
    study: Any = prepared.study
    limits = {name: value for name, value in study.settings().items() if name == "max_periods"}
    witnessed = _witnessed(prepared, limits, watch)
    hops = witnessed.truth.hops
    groups = {"sliding": witnessed.trusted & ~hops, "hopping": witnessed.trusted & hops}
    groups = {name: is_in_group for name, is_in_group in groups.items() if is_in_group.any()}
    shape = (len(groups), len(TOLERANCES))
    error, largest, seconds = (np.full(shape, np.nan) for _ in range(3))
    part_watch = watch.part(0.05 / max(1, 3 * error.size))
    for group_number, is_in_group in enumerate(groups.values()):
        cells, velocity = witnessed.group(is_in_group)
        for number, tolerance in enumerate(TOLERANCES):
            if watch.stopped():
                break
            settings = {**limits, "tolerance": tolerance}
            runs = [_run(prepared, "events", cells, settings, part_watch) for _ in range(3)]
            errors = np.abs(runs[0].velocity - velocity)
            error[group_number, number] = np.median(errors)
            largest[group_number, number] = errors.max()
            seconds[group_number, number] = min(run.seconds for run in runs)
    sizes = np.array([is_in_group.sum() for is_in_group in groups.values()], dtype=np.int32)
    names = tuple(f"{tolerance:.0e}" for tolerance in TOLERANCES)
    words = {"witness": _words_of(witnessed)}
    return Report(tuple(groups), names, error, largest, seconds, sizes, words)


def _words_of(known: _Witnessed) -> str:
    words = (
        "Error: of the mean velocity by the method events over its tolerance, as a share of the "
        "drive's speed A w, against the method reference, which shares no code with it"
    )
    if not known.trusted.any():
        return (
            f"{words}. No cell of {known.tried} random ones moves, repeats its motion and was "
            "followed by the witness in the time given: nothing is measured."
        )
    stated = float(known.truth.stated[known.trusted].max())
    return (
        f"{words}, takes {_number(1e3 * known.truth.seconds)} ms a cell and states an error of at "
        f"most {stated:.1e}. Random cells whose motion repeats; time: one thread, the fastest "
        "of three runs."
    )


def _witnessed(prepared: Prepared, limits: Mapping[str, float], watch: Watch) -> _Witnessed:
    scene, grid = prepared.plan.scene, prepared.grid
    used = {name for method in scene.variants for name in scene_parameters(scene, method)}
    names = [name for name in (*grid.axes, *grid.fixed) if name in used]
    count = min(CANDIDATES * MOTION_CELLS, grid.cells)
    sample = grid.at(random_positions(grid, count, SEED), count, names)
    first_cell = {name: values[:1] for name, values in sample.items()}
    _run(prepared, "events", first_cell, limits, watch.part(0.02))  # compiles
    results = _run(prepared, "events", sample, limits, watch.part(0.08))
    chosen = np.flatnonzero(results.periodic & (np.abs(results.velocity) > ROUNDING))
    if not chosen.size:
        return _Witnessed(sample, results, np.zeros(count, dtype=np.bool_), count)
    chosen = _both_kinds(chosen, results.hops, MOTION_CELLS)
    sampled = {name: values[chosen] for name, values in sample.items()}
    reference = _run(prepared, WITNESS, sampled, limits, watch.part(0.8))
    own_results = _run(
        prepared, "events", sampled, {**limits, "tolerance": 1e-12}, watch.part(0.05)
    )
    with np.errstate(invalid="ignore"):
        trusted = reference.periodic & (reference.stated < WITNESS_ERROR)
        # Where two exact methods differ by more, one of them found another motion.
        trusted &= np.abs(own_results.velocity - reference.velocity) < OTHER_MOTION
    return _Witnessed(sampled, reference, trusted, count)


def _run(
    prepared: Prepared,
    method: str,
    cells: Mapping[str, Array],
    settings: Mapping[str, float],
    watch: Watch,
) -> _Means:
    plan = plan_scene(prepared.plan.scene, method, OUTPUTS, tuple(cells))
    used_settings = {name: value for name, value in settings.items() if name in plan.defaults}
    plan = replace(plan, defaults={**plan.defaults, **used_settings})
    inputs = {name: cells[name] for name in plan.parameters}
    started = time.perf_counter()
    results = run_equations(plan, inputs, replace(watch, threads=1))
    seconds = time.perf_counter() - started
    count = next(iter(cells.values())).size
    drive = results["drive_number"] * results["velocity_scale"]  # the speed of the track, A w
    with np.errstate(divide="ignore", invalid="ignore"):  # a drive at rest has no share
        relative_speeds = [
            results[name] / drive for name in ("conveying_velocity", "conveying_velocity_error")
        ]
    velocity, stated = (np.broadcast_to(values, count) for values in relative_speeds)
    status = np.broadcast_to(results["motion_status"], count)
    hops = np.broadcast_to(results["flight_fraction"] > 0, count)
    return _Means(
        velocity, stated, status == MOTION_STATUSES["periodic"].value, hops, seconds / count
    )


def _both_kinds(candidates: NDArray[np.intp], hops: NDArray[np.bool_], count: int) -> Any:
    hopping, sliding = candidates[hops[candidates]], candidates[~hops[candidates]]
    half = count // 2
    extra = max(0, half - sliding.size), max(0, half - hopping.size)
    return np.sort(np.concatenate([hopping[: half + extra[0]], sliding[: half + extra[1]]]))


def _median_seconds(run: Callable[[], object]) -> float:
    # Each repeat makes so many calls that it takes some milliseconds.
    started = time.perf_counter()
    run()
    calls = max(1, int(LEAST_SECONDS / max(time.perf_counter() - started, 1e-7)))

    def repeat() -> float:
        started = time.perf_counter()
        for _ in range(calls):
            run()
        return (time.perf_counter() - started) / calls

    return statistics.median(repeat() for _ in range(REPEATS))


def _facts() -> dict[str, str]:
    libraries = ", ".join(f"{name} {version(name)}" for name in LIBRARIES)
    load = f", load {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
    return {
        "machine": f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores, "
        f"{platform.system()}{load}",
        "date": datetime.now(UTC).date().isoformat(),
        "versions": f"vibrafeed {core.__version__}, Python {platform.python_version()}, "
        f"{libraries}",
    }


def _flags(name: str, words: Sequence[str]) -> TableVariable:
    values = np.arange(len(words), dtype=np.int16)
    meanings = {"long_name": name, "flag_values": values, "flag_meanings": " ".join(words)}
    return TableVariable((name,), values, meanings)


def _number(value: float) -> str:
    return f"{float(f'{value:.2g}'):g}" if np.isfinite(value) else "-"


def markdown_table(columns: Sequence[str], rows: Iterable[Iterable[str]]) -> list[str]:
    """Return the lines of a Markdown table: headings, a rule, and the cells of each row.

    `columns` are the headings; `|` within cells is escaped, and line breaks become spaces.
    """
    cells = [[" ".join(cell.split()).replace("|", "\\|") for cell in row] for row in rows]
    lines = [columns, ["---"] * len(columns), *cells]
    return [f"| {' | '.join(line)} |" for line in lines]
