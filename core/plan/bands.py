"""Least and largest values of speeds over a parameter that is known within a band only.

A speed is continuous and piecewise smooth in friction, and not monotone. It is computed at
`SAMPLES` values of the parameter; where it is not monotone there, golden sections narrow the
brackets of its least and of its largest value. No cell is computed at more than `MAX_POINTS`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.bands import ENDS, UNSETTLED, band_in_words
from vibrafeed.core.dataset.table import flag_attributes
from vibrafeed.core.errors import Problem, raise_any
from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.plan.differences import Added, Dims, cells_of, over_axes
from vibrafeed.core.plan.grid import Grid, parameter_to_si
from vibrafeed.core.plan.labels import link_to_verdict
from vibrafeed.core.plan.plan import Plan, run_equations
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.flags import SIGNS
from vibrafeed.core.quantities.quantity import in_sentence
from vibrafeed.core.study.values import Band, Values
from vibrafeed.core.watch import Watch

SAMPLES: Final = 17
STEPS: Final = 11
"""Golden sections of a bracket."""
MAX_POINTS: Final = SAMPLES + 2 * STEPS
"""Most values of the parameter at which a cell is computed."""
GOLDEN: Final = (3 - 5**0.5) / 2
SIGNIFICANT: Final = 1e-9
"""Share of the largest speed of a cell below which speeds have no sign, and do not differ."""
BLOCK: Final = 1 << 14
"""Cells that are computed at once."""
SPEED_UNITS: Final = ("m s-1", "min-1")
CONVEYING: Final = ("conveying_velocity", "feed_rate", "line_feed_rate", "oriented_feed_rate")
"""Outputs of a motion with a band; the first has the least and the largest value of all."""
OF_PLATE: Final = ("velocity_x", "velocity_y", "travel_speed", "velocity_towards")
"""Outputs of a part on a plate with a band, each by itself."""

Compute = Callable[[Array, NDArray[np.intp]], Array]
"""Takes values of the parameter and the cells, shape (n,); returns outputs, shape (outputs, n)."""


class Extremes(NamedTuple):
    """Least and largest outputs over a parameter, shape (outputs, cells).

    `is_open` has True for cells in which some samples have no value.
    """

    least: Array
    most: Array
    is_open: Mask


def extremes(compute: Compute, low: float, high: float, cells: int) -> Extremes:
    """Return the least and the largest outputs of some cells over a parameter.

    The first output leads: its brackets are narrowed, and the others are taken along.
    Values that are not finite do not count.
    """
    points = np.linspace(low, high, SAMPLES)
    outputs_of_samples = compute(np.tile(points, cells), np.repeat(np.arange(cells), SAMPLES))
    values = np.where(np.isfinite(outputs_of_samples), outputs_of_samples, np.nan).reshape(
        len(outputs_of_samples), cells, SAMPLES
    )
    smallest, largest = np.fmin.reduce(values, axis=2), np.fmax.reduce(values, axis=2)
    is_open = np.isnan(values[0]).any(axis=1)
    cell, sign, sample = _brackets(values[0])
    best = sign * values[0, cell, sample]
    left, middle, right = (points[np.clip(sample + step, 0, SAMPLES - 1)] for step in (-1, 0, 1))
    # Golden-section search in all brackets at once; each point found may be an extreme of a cell.
    for _ in range(STEPS if cell.size else 0):
        is_right = right - middle > middle - left
        x = middle + GOLDEN * np.where(is_right, right - middle, left - middle)
        outputs = compute(x, cell)
        outputs = np.where(np.isfinite(outputs), outputs, np.nan)
        for row, value in enumerate(outputs):
            np.fmin.at(smallest[row], cell, value)
            np.fmax.at(largest[row], cell, value)
        is_better = sign * outputs[0] > best
        # The better of x and the old middle becomes the middle, the other one a bound.
        bound = np.where(is_better, middle, x)
        left = np.where(is_right == is_better, bound, left)
        right = np.where(is_right == is_better, right, bound)
        middle, best = np.where(is_better, x, middle), np.where(is_better, sign * outputs[0], best)
    return Extremes(smallest, largest, is_open)


def _brackets(values: Array) -> tuple[NDArray[np.intp], Array, NDArray[np.intp]]:
    # Cell, sign (1 for a maximum) and best sample of each extreme: none where the samples are
    # monotone, unless they flatten towards an end, beside which an extreme may lie.
    differences = np.diff(values)
    noise = SIGNIFICANT * np.fmax.reduce(np.abs(values), axis=1, keepdims=True)
    is_monotone = (differences >= -noise).all(axis=1) | (differences <= noise).all(axis=1)
    step_sizes = np.abs(differences)
    is_monotone &= (2 * step_sizes[:, [0, -1]] >= step_sizes[:, [1, -2]]).all(axis=1)
    (cell,) = np.nonzero(~is_monotone & np.isfinite(values).any(axis=1))
    smallest, largest = np.nanargmin(values[cell], axis=1), np.nanargmax(values[cell], axis=1)
    signs = np.repeat([-1.0, 1.0], cell.size)
    return np.tile(cell, 2), signs, np.concatenate([smallest, largest])


@dataclass(frozen=True)
class Bands(Added):
    """The outputs of a study that have a band, and the parameter over which they have it."""

    parameter: str
    band: Band
    groups: tuple[tuple[str, ...], ...]
    """Outputs that are computed together; the first of each leads."""
    judges: Mapping[str, Mapping[str, str]]
    """The CF attribute that names the verdict on each output."""

    @property
    def passes(self) -> int:
        """The largest number of times that a cell is computed."""
        return MAX_POINTS * len(self.groups)

    @cached_property
    def over(self) -> str:
        """The parameter and its ends in words: ``friction 0.2 to 0.4``."""
        return band_in_words(self.parameter, self.band.low, self.band.high)

    @cached_property
    def labels(self) -> dict[str, dict[str, Any]]:
        """The attributes of each variable, in order."""
        labels: dict[str, dict[str, Any]] = {}
        for output in self.outputs:
            quantity = QUANTITIES[output]
            for band_end, size_word in zip(ENDS, ("Least", "Largest"), strict=True):
                labels[f"{output}_{band_end}"] = {
                    "units": quantity.unit,
                    "long_name": f"{size_word} {in_sentence(quantity.label)}",
                    "comment": f"Over {self.over}; {output} is that at the middle.",
                    "output": output,
                    **self.judges[output],
                }
        labels[UNSETTLED] = flag_attributes("motion_status", SIGNS, tuple(SIGNS)) | {
            "long_name": f"Sign of the speed over {self.over}"
        }
        return labels

    def arrays(self, plan: Plan, grid: Grid, dims: Dims, watch: Watch) -> dict[str, NDArray[Any]]:
        """Return each variable of the bands over its axes, in the units of files."""
        arrays: dict[str, NDArray[Any]] = {}
        signs = np.zeros(tuple(grid.shape[axis] for axis in dims[UNSETTLED]), dtype=np.int8)
        for group in self.groups:
            group_plan = plan.part(group)
            axes = grid.dims({axis for name in group for axis in dims[f"{name}_{ENDS[0]}"]})
            group_grid = grid.piece(
                {axis: (0, grid.shape[axis]) for axis in axes}, group_plan.parameters
            )
            group_extremes = self._extremes(
                group_plan, group_grid, watch.part(1 / len(self.groups))
            )
            sign = _sign(group_extremes).reshape(tuple(group_grid.shape.values()))
            by_cell = {
                f"{name}_{end}": row
                for end, rows in zip(ENDS, group_extremes[:2], strict=True)
                for name, row in zip(group, rows, strict=True)
            }
            arrays |= over_axes(by_cell, group_grid, dims)
            # As many dimensions as `signs`, of size 1 on the axes that the group lacks.
            aligned = [slice(None) if axis in axes else np.newaxis for axis in dims[UNSETTLED]]
            signs = np.maximum(signs, sign[tuple(aligned)])
        return {**arrays, UNSETTLED: signs}

    def _extremes(self, plan: Plan, grid: Grid, watch: Watch) -> Extremes:
        cells = cells_of(plan, grid)
        low, high = parameter_to_si(self.parameter, np.array([self.band.low, self.band.high]))
        extremes_of_blocks = []
        starts = range(0, grid.cells, BLOCK)
        for start in starts:
            piece = {name: values[start : start + BLOCK] for name, values in cells.items()}
            compute = partial(self._compute, plan, piece, watch.part(0.0))
            extremes_of_blocks.append(extremes(compute, low, high, min(BLOCK, grid.cells - start)))
            watch.advance(1 / len(starts))
        return Extremes(
            *(np.concatenate(arrays, axis=-1) for arrays in zip(*extremes_of_blocks, strict=True))
        )

    def _compute(
        self,
        plan: Plan,
        cells: Mapping[str, Array],
        watch: Watch,
        parameter_values: Array,
        cell_numbers: NDArray[np.intp],
    ) -> Array:
        values = {name: values_of_cells[cell_numbers] for name, values_of_cells in cells.items()}
        results = run_equations(plan, {**values, self.parameter: parameter_values}, watch)
        return np.stack(
            [np.broadcast_to(results[name], parameter_values.shape) for name in plan.outputs]
        )


def _sign(extremes: Extremes) -> NDArray[np.int8]:
    smallest, largest = extremes.least[0], extremes.most[0]
    noise = SIGNIFICANT * np.fmax(np.abs(smallest), np.abs(largest))
    state = np.where(extremes.is_open, SIGNS["open"].value, SIGNS["settled"].value)
    is_unsettled = (smallest < -noise) & (largest > noise)
    return np.where(is_unsettled, SIGNS["unsettled"].value, state).astype(np.int8)


def bands_of(plan: Plan, grid: Grid) -> Bands | None:
    """Return the bands of the outputs of a study, None if no parameter has one.

    Raises `StudyError` if several parameters have a band, or no output that depends on it is a
    speed.
    """
    if not grid.bands:
        return None
    (name, band), *others = grid.bands.items()
    takes_long = any(equation.takes_long for equation in plan.equations)
    outputs = tuple(
        output
        for output in ((*CONVEYING, *OF_PLATE) if takes_long else plan.outputs)
        if output in plan.outputs
        if QUANTITIES[output].unit in SPEED_UNITS and QUANTITIES[output].is_derived
        if name in plan.part((output,)).parameters
    )
    problems = [
        Problem(
            f"parameters.{other}",
            f"both {name} and {other} have a band (low and high), but only one parameter can",
            f'Give one value of {other}, or study both with kind = "sensitivity"',
        )
        for other, _ in others
    ]
    if not outputs:
        problems.append(
            Problem(
                f"parameters.{name}",
                f"{name} has a band (low and high), but no requested output is a speed over it",
                f"Request {CONVEYING[0]}, or give one value of {name}",
            )
        )
    raise_any(problems)
    # Closed forms and speeds on a plate have extremes of their own: each is searched by itself.
    separate = OF_PLATE if takes_long else outputs
    grouped = tuple(output for output in outputs if output not in separate)
    groups = (
        *((grouped,) if grouped else ()),
        *((output,) for output in outputs if output in separate),
    )
    judges = {output: link_to_verdict(plan, output) for output in outputs}
    return Bands(outputs, name, band, groups, judges)


def problem_of_added(sensitivities: object, grid: Grid) -> Problem | None:
    """Return the problem with computing cells on reading; None without derivatives and bands."""
    if sensitivities:
        return Problem(
            "sensitivities",
            "a study with derivatives cannot be computed cell by cell",
            "Remove sensitivities",
        )
    if grid.bands:
        return Problem(
            f"parameters.{next(iter(grid.bands))}",
            "a study with a band (low and high) cannot be computed cell by cell",
            "Give one value",
        )
    return None


def problems_of_bands(values: Mapping[str, Values]) -> list[Problem]:
    """Return the problems of parameters with a band in a study that stores statistics only."""
    return [
        Problem(
            f"parameters.{name}",
            f"{name} has a band (low and high), which cannot be combined with reduce",
            f"Remove reduce, or give {name} as an axis with start, stop and num",
        )
        for name, value in values.items()
        if isinstance(value, Band)
    ]
