"""The random cells of a study that are verified, and what is told of them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.grid import Grid, random_positions
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.quantities import QUANTITIES

LEFT_OUT = "verified_left_out"
"""The attribute with the number of cells that a stop left without verifying; absent if it left
none."""

FAILED = "verified_failed"
"""The attribute with the number of verified cells that are further off than their known error
allows; absent if there are none."""

Positions = Mapping[str, NDArray[np.int64]]


def chosen_positions(prepared: Prepared) -> tuple[Positions, int]:
    """Return the axis positions of the cells to verify, and their number.

    They are all different, and the same for equal studies.
    """
    grid, asked = prepared.grid, prepared.study.verify or 0
    return random_positions(grid, asked, prepared.study.key()), min(asked, grid.cells)


@dataclass(frozen=True)
class Sample:
    """The cells of a study that are verified.

    Attributes
    ----------
    grid : Grid
        The grid of the study.
    positions : mapping of str to ndarray
        Position of each cell on each axis.
    count : int
        Number of the cells.
    chosen : int
        Number of cells that were chosen, with those that a stop left without a value to verify.
    """

    grid: Grid
    positions: Positions
    count: int
    chosen: int

    def at(self, values: NDArray[np.generic], dims: Collection[str]) -> Array:
        """Return the values of an array at the sampled cells, shape (count,).

        `dims` are the axes of the array.
        """
        chosen = values[tuple(self.positions[name] for name in dims)]
        return np.broadcast_to(np.asarray(chosen, dtype=np.float64), self.count)

    def where(self, cell: int) -> str:
        """Return the position of a sampled cell in words: ``at frequency 50 Hz, beta 30 deg``.

        `cell` is its number in the sample.
        """
        parts = []
        for name, axis in self.grid.axes.items():
            k = int(self.positions[name][cell])
            unit = QUANTITIES[name].unit if name in QUANTITIES else "1"
            value = float(axis.array(k, k + 1)[0])
            parts.append(f"{name} {value:.12g}" + ("" if unit == "1" else f" {unit}"))
        return f"at {', '.join(parts)}" if parts else "at the only cell"

    def verification_attributes(
        self,
        against: str,
        worst: str = "",
        *,
        evaluated: int = 0,
        compared: int = 0,
        failed: int = 0,
    ) -> dict[str, str | int]:
        """Return the verification result as attributes of the dataset.

        Parameters
        ----------
        against : str
            The method by which the cells are evaluated again.
        worst : str
            A sentence about the largest error of the compared cells.
        evaluated, compared : int
            Number of cells that no stop left out, and of those with a value to compare.
        failed : int
            Number of cells whose values are further off than their known errors allow.
        """
        attributes: dict[str, str | int] = {"verified_cells": compared, "verified_against": against}
        if failed:
            attributes[FAILED] = failed
        left = self.chosen - evaluated
        if not left:
            return attributes | {"verified_worst": worst}
        stop = f"stopped before {left:,} of {self.chosen:,} cells could be verified"
        words = f"{worst}; {stop}" if worst else stop
        return attributes | {"verified_worst": words, LEFT_OUT: left}


def sample_of(
    prepared: Prepared,
    arrays: Mapping[str, NDArray[np.generic]],
    unfinished: tuple[str, int] | None = None,
) -> Sample:
    """Return the cells of a study that are to be verified: random ones, equal for equal studies.

    The result has the index of each cell on each axis of the grid, and the number of cells.

    Parameters
    ----------
    prepared : Prepared
        The study, which says how many cells.
    arrays : mapping of str to ndarray
        Its computed results.
    unfinished : (str, int), optional
        Name of a status among them, and its value in cells that a stop left without a result; these
        are taken out. None if no stop can leave any.
    """
    positions, chosen = chosen_positions(prepared)
    sample = Sample(prepared.grid, positions, chosen, chosen)
    if unfinished is None:
        return sample
    name, value = unfinished
    finished = sample.at(arrays[name], prepared.dims[name]) != value
    positions = {axis: position[finished] for axis, position in positions.items()}
    return replace(sample, positions=positions, count=int(finished.sum()))
