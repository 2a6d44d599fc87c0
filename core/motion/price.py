"""The likely and the largest time for some cells, estimated before any is followed.

A motion that repeats is followed for some tens of periods whatever the study allows, one that does
not for all of them. Which it will be nobody knows before; where a part hops and rebounds much it
seldom repeats. Prices are seconds of one core, by measurements that `benchmarks.prices` repeats.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.motion.groups import Contacts, Groups, in_plane
from vibrafeed.core.plan.equations import run
from vibrafeed.core.plan.grid import Grid, random_positions
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.scenes.graph import behind

CELLS = 32
"""Most cells of a study from which its time is estimated."""

LEAST, MOST = 1e-7, 1e9  # s: bounds of the estimated time of a cell
RESTING = 3.0
"""Periods after which a part that rests is known to."""
REBOUNDS = 0.2, 0.5
"""Restitutions up to which hops mostly repeat, and from which on they mostly do not."""


class Price(NamedTuple):
    """Seconds of a cell on one core: the likely time, and one that hardly any cell exceeds."""

    likely: Array
    most: Array


@dataclass(frozen=True)
class Priced:
    """Some cells of a study, whose computing time a method estimates.

    Attributes
    ----------
    known
        Inputs of the equation that takes long: `groups` or `throw`, and settings.
    contacts
        What the parts can touch.
    """

    known: Mapping[str, Any]
    contacts: Contacts

    @property
    def groups(self) -> Groups:
        """The dimensionless groups of the parts."""
        groups: Groups = self.known["groups"]
        return groups

    def setting(self, name: str) -> Array:
        """Return a setting in force by its name, such as `tolerance`."""
        return np.asarray(self.known[name], dtype=np.float64)

    @property
    def hops(self) -> Array:
        """A mask of the parts that lift off the floor."""
        g = self.groups
        return np.greater(np.abs(g.drive_number_normal), g.gravity_number_normal)

    @property
    def restless(self) -> Array:
        """The probability, 0 to 1, that a part's motion does not repeat.

        0 up to a restitution of 0.2, rising to 1 at 0.5, for parts that lift off.
        """
        few, many = REBOUNDS
        rebounds = np.maximum(self.groups.restitution, self.groups.wall_restitution)
        return np.where(self.hops, np.clip((rebounds - few) / (many - few), 0.0, 1.0), 0.0)

    @property
    def rests(self) -> Mask:
        """A mask of the parts that friction holds for certain, under a plain sine."""
        g = self.groups
        if g.wave is not None:
            return np.zeros(np.shape(self.hops), dtype=np.bool_)
        pushed = np.hypot(g.drive_number_along, g.drive_number_across)
        pulled = np.hypot(g.gravity_number_along, g.gravity_number_across)
        weight = np.asarray(g.gravity_number_normal) - np.abs(g.drive_number_normal)
        return np.less(pushed + pulled, np.asarray(g.friction_static) * weight)

    @property
    def across(self) -> Mask:
        """A mask of the parts that leave the vertical plane of the track."""
        return ~in_plane(self.groups, self.contacts)

    @property
    def orders(self) -> float:
        """The highest harmonic order of the drive: 1 for steps, 0 for the plain sine."""
        wave = self.groups.wave
        return 0.0 if wave is None else float(max(1, wave.harmonics.shape[2]))

    @property
    def steps(self) -> int:
        """The number of steps of the drive in a period."""
        wave = self.groups.wave
        return 0 if wave is None else wave.steps.shape[1]

    def periods(self, usual: float) -> Array:
        """Return the likely number of periods to simulate; `usual` if the motion repeats.

        The mean of `usual` and `max_periods`, weighted by the probability that it does not repeat;
        a few of a part that rests.
        """
        allowed, share = self.setting("max_periods"), self.restless
        moves = share * allowed + (1.0 - share) * np.minimum(allowed, usual)
        return np.where(self.rests, np.minimum(allowed, RESTING), moves)


Pricing = Callable[[Priced], Price]
"""Tells the price of cells."""


def prices_of(price: float | Pricing, cells: Callable[[], Priced]) -> Price:
    """Return the likely and the largest time to compute each of some cells [s], or one for all.

    `price` is a method's time for a cell [s], or the function that estimates it from the settings
    and numbers of the cells; these are made by calling `cells`, only if they are needed.
    """
    if not callable(price):
        return Price(np.asarray(price), np.asarray(price))
    with np.errstate(all="ignore"):
        return Price._make(np.clip(np.nan_to_num(part), LEAST, MOST) for part in price(cells()))


def seconds_of(price: float | Pricing, cells: Callable[[], Priced]) -> tuple[float, float]:
    """Return the mean price of some cells [s]: as is likely, and at most."""
    means = [float(np.mean(part)) for part in prices_of(price, cells)]
    return means[0], max(means)


def sampled_parameters(
    plan: Plan, grid: Grid, free: Mapping[str, tuple[float, float]], most: int = CELLS
) -> tuple[dict[str, Array], int]:
    """Return parameters of some cells of a study, evenly chosen, SI units, and their number.

    For estimates of computing times. The cells are the same for equal grids.

    Parameters
    ----------
    plan, grid : Plan, Grid
        The plan of the study, and its parameters with their ranges.
    free : mapping of str to (float, float)
        Parameters that are not on the grid, and between which values they lie, SI units.
    most : int
        Largest number of cells.
    """
    count = most if free else min(most, grid.cells)
    on_grid = grid.at(random_positions(grid, count, 0), min(count, grid.cells), plan.parameters)
    chosen = {name: np.resize(values, count) for name, values in on_grid.items()}
    random = np.random.default_rng(0)
    for name, (low, high) in free.items():
        chosen[name] = random.uniform(low, high, count)
    return chosen, count


def some_cells(
    plan: Plan, chosen: Mapping[str, Any], settings: Mapping[str, float], contacts: Contacts
) -> Priced:
    """Return cells with chosen parameters, in the form from which methods estimate their times.

    The equations that the long one needs are run, so that the dimensionless groups are known.

    Parameters
    ----------
    plan
        Plan of a method; those of other methods have the same numbers of a part.
    chosen
        Parameters by name, arrays (cells,), SI units.
    settings
        Settings of the method in force, by name.
    contacts
        The surfaces that the parts can touch.
    """
    by_name = {equation.gives: equation for equation in plan.equations}
    long = next(equation for equation in plan.equations if equation.takes_long)
    needed = behind([n for n in long.inputs if n in by_name], by_name.get)
    known: dict[str, Any] = {name: np.asarray(value) for name, value in plan.defaults.items()}
    known |= {name: np.asarray(value) for name, value in settings.items()}
    equations = [equation for equation in plan.equations if equation.gives in needed]
    with np.errstate(all="ignore"):
        found = run(equations, known | dict(chosen))
    if "slip_groups" in long.inputs:  # the slip of a round part is followed as a block with these
        found = {**found, "groups": found["slip_groups"]}
    return Priced(found, contacts)
