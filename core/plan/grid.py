"""The grid of a sweep: axes and fixed parameters, and how large outputs on it are."""

import math
import random
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import refused
from vibrafeed.core.mechanics.arrays import radians
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.values import DESIGN, Band, Fixed, Paired, Points, Span, Values


def to_si(name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return values converted from the unit of studies to SI units and radians."""
    return np.deg2rad(values) if QUANTITIES[name].is_angle else values


def parameter_to_si(name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return parameter values in SI units, angles reduced by whole turns."""
    return radians(values) if QUANTITIES[name].is_angle else values


def from_si(name: str, values: NDArray[np.generic]) -> NDArray[np.generic]:
    """Return values converted from SI units and radians to the unit of files."""
    return np.rad2deg(values) if QUANTITIES[name].is_angle else values


@dataclass(frozen=True)
class Grid:
    """Ranged parameters, in order, and fixed ones, in the units of studies.

    `bands` has those of the fixed ones that are known within a band only, `paired` the parameters
    that share the axis of designs.
    """

    axes: Mapping[str, Points | Span]
    fixed: Mapping[str, float]
    bands: Mapping[str, Band] = field(default_factory=dict)
    paired: Mapping[str, Points] = field(default_factory=dict)

    @classmethod
    def of(cls, values: Mapping[str, Values]) -> "Grid":
        """Return the grid of a study's parameters: those with several values are axes.

        Raises `StudyError` if some have a value in more designs than others.
        """
        paired = {name: value for name, value in values.items() if isinstance(value, Paired)}
        sizes = {name: value.size for name, value in paired.items()}
        if len({*sizes.values()}) > 1:
            sizes_in_words = ", ".join(f"{size} of {name}" for name, size in sizes.items())
            message = f"the parameters have different numbers of values: {sizes_in_words}"
            raise refused("designs", message, "Give each of them one value a design")
        count = max(sizes.values(), default=0)
        axes = {
            name: value
            for name, value in values.items()
            if not isinstance(value, Fixed) and name not in paired
        }
        if count:
            axes[DESIGN] = Points(tuple(map(float, range(1, count + 1))))
        return cls(
            axes,
            {name: value.value for name, value in values.items() if isinstance(value, Fixed)},
            {name: value for name, value in values.items() if isinstance(value, Band)},
            paired,
        )

    @cached_property
    def along(self) -> dict[str, str]:
        """The axis along which each ranged parameter changes: its own, or that of designs."""
        return {
            **{name: name for name in self.axes if name != DESIGN},
            **dict.fromkeys(self.paired, DESIGN),
        }

    def values_of(self, name: str) -> Points | Span:
        """Return the values of a ranged parameter, along its axis."""
        return self.paired.get(name) or self.axes[name]

    @cached_property
    def shape(self) -> dict[str, int]:
        """The number of values on each axis."""
        return {name: axis.size for name, axis in self.axes.items()}

    @cached_property
    def cells(self) -> int:
        """The number of points of the whole grid."""
        return math.prod(self.shape.values())

    def dims(self, names: Iterable[str]) -> tuple[str, ...]:
        """Return the named axes, in the order of the grid."""
        wanted = set(names)
        return tuple(name for name in self.axes if name in wanted)

    def size(self, dims: Iterable[str]) -> int:
        """Return the number of points over the named axes."""
        return math.prod(self.shape[name] for name in dims)

    def within(self, box: Mapping[str, tuple[int, int]]) -> "Grid":
        """Return the part of the grid between start and stop on each axis named in `box`."""
        axes = {
            name: Points(tuple(axis.array(*box[name]))) if name in box else axis
            for name, axis in self.axes.items()
        }
        paired = self.paired
        if DESIGN in box:
            paired = {
                name: Points(values.values[slice(*box[DESIGN])]) for name, values in paired.items()
            }
        return replace(self, axes=axes, paired=paired)

    def piece(self, box: Mapping[str, tuple[int, int]], names: Iterable[str]) -> "Grid":
        """Return a smaller grid: the axes of a box, within its ends, with some fixed parameters."""
        ends = {name: (0, axis.size) for name, axis in self.axes.items()}
        shortened = {
            name: ends_in_box for name, ends_in_box in box.items() if ends_in_box != ends[name]
        }
        wanted_names = set(names)
        return Grid(
            {name: axis for name, axis in self.axes.items() if name in box},
            {name: value for name, value in self.fixed.items() if name in wanted_names},
            paired=self.paired if DESIGN in box else {},
        ).within(shortened)

    def coordinate(self, name: str) -> NDArray[np.float64]:
        """Return the values of an axis in the unit of studies, shape (size,)."""
        return self.axes[name].array()

    def bounds(self, name: str) -> tuple[float, float]:
        """Return the smallest and largest value of a parameter, SI units and radians."""
        if name in self.bands:
            ends = np.array([self.bands[name].low, self.bands[name].high])
        elif name in self.fixed:
            ends = np.array([self.fixed[name]])
        else:
            axis = self.values_of(name)
            ends = np.array([axis.start, axis.stop] if isinstance(axis, Span) else axis.values)
        ends = to_si(name, ends)
        return float(ends.min()), float(ends.max())

    def si(self) -> dict[str, NDArray[np.float64]]:
        """Return all parameters in SI units and radians, broadcastable over the grid.

        An axis has as many dimensions as the grid, of size 1 but for its own.
        """
        fixed = self.fixed.items()
        values = {name: parameter_to_si(name, np.asarray(value)) for name, value in fixed}
        positions = {name: position for position, name in enumerate(self.axes)}
        for name, axis in self.along.items():
            shape = [1] * len(self.axes)
            shape[positions[axis]] = -1
            values[name] = parameter_to_si(name, self.values_of(name).array()).reshape(shape)
        return values

    def at(
        self, positions: Mapping[str, NDArray[np.int64]], count: int, names: Iterable[str]
    ) -> dict[str, NDArray[np.float64]]:
        """Return the named parameters of some cells, SI units and radians, shape (count,) each.

        `positions` has, for each axis, the index of every cell on it. No axis is made as a whole:
        it may have a hundred million values.
        """
        wanted = set(names)
        cells = {
            name: np.array(
                [
                    self.values_of(name).array(int(index), int(index) + 1)[0]
                    for index in positions[axis]
                ]
            )
            for name, axis in self.along.items()
            if name in wanted
        }
        cells |= {
            name: np.full(count, value) for name, value in self.fixed.items() if name in wanted
        }
        return {name: parameter_to_si(name, values) for name, values in cells.items()}


def random_positions(grid: Grid, count: int, seed: int | str) -> dict[str, NDArray[np.int64]]:
    """Return the positions on each axis of random distinct cells, equal for equal seeds."""
    chosen = random.Random(seed).sample(range(grid.cells), min(count, grid.cells))
    return positions_of(grid.shape, np.array(chosen, dtype=np.int64))


def positions_of(shape: dict[str, int], numbers: NDArray[np.int64]) -> dict[str, NDArray[np.int64]]:
    """Return the positions on each axis of cells numbered from 0, the last axis fastest."""
    positions: dict[str, NDArray[np.int64]] = {}
    left = numbers
    for name, size in reversed(shape.items()):
        left, positions[name] = np.divmod(left, size)
    return positions


def spread(points: int, variables: int) -> NDArray[np.float64]:
    """Return evenly spread points of the unit box, shape (variables, points).

    The k-th point has the coordinates (1/2 + k r^-j) mod 1, j = 1 ... d, where d is the number of
    variables and r the root of r^(d + 1) = r + 1 (Roberts 2018).
    """
    root = 2.0
    for _ in range(40):
        root = (1 + root) ** (1 / (variables + 1))
    steps = root ** -np.arange(1.0, variables + 1)
    return (0.5 + steps[:, None] * np.arange(1, points + 1)) % 1.0
