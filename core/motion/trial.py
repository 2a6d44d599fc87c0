"""The price of a study of motion by a trial: some cells are followed before all are.

Whether a motion repeats, and how many events a period has, is not known beforehand. So some cells
are followed within a budget of time. Of a cell that takes longer than the budget, some periods are
followed, and the price by formula scales them to all periods.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from vibrafeed.core.errors import StoppedError
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.in_common import Families
from vibrafeed.core.motion.result import STATUS
from vibrafeed.core.plan.equations import run_equations
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.watch import Watch

TRIED_CELLS = 256
"""Most cells that a trial follows."""

LEAST, MOST, SHARE = 0.1, 0.3, 0.1
"""Budget of a trial: a share `SHARE` of the price of the study, from `LEAST` to `MOST` [s]."""

FIRST = 0.5
"""Longest time of the first periods of a cell that is longer than the budget [s]: what one period
takes is known by no formula within a factor of 3, how many there are is."""

PATIENCE = 20.0
"""Longest time by the clock over the budget of processor time: others use the core, too."""

ENOUGH = 8
"""Number of cells whose mean time is taken as it is; of fewer, the price by formula says how dear
they are beside the mean cell."""

GROWTH = 4
"""Ratio of the sizes of a batch and the one before."""

UNFINISHED = 1.3
"""Factor on the price of a motion that has not repeated by the end of its trial."""

BROKEN_OFF = 2.5
"""Factor on the time so far of cells that the budget breaks off."""

TELLING = 8.0
"""Number of periods from which on it counts that the motion has not repeated; after one it tells
nothing."""

TRUST = 0.9
"""Weight, as a power, of the time by some periods beside the price by formula."""

SURPRISE = 3.0
"""Ratio of time and price from which on cells of the first batches are followed again: they may
have loaded code."""

SURPRISING = 2
"""Number of batches that may have loaded code: motions that do not repeat have some of their own,
and the first cell may repeat."""

REPEATS = [STATUS[name] for name in ("periodic", "at_rest", "neutral")]

_loaded: set[tuple[str, str, int]] = set()
"""Scene, method and kind of the code that this process has loaded; to load it is not timed."""


class _Followed(NamedTuple):
    """The time of following some cells [s], whether all came to an end, and whether all repeat."""

    seconds: float
    ended: bool
    repeats: bool


@dataclass(frozen=True)
class Trial:
    """Some cells of a study of motion that can be followed.

    Attributes
    ----------
    plan : Plan
        Plan of the study.
    parameters : mapping of str to array
        Parameters of each cell, SI units, shape (count,), or a single value for all cells.
    kinds : ndarray of int, shape (count,)
        Kind of each cell: different kinds are followed by different code.
    price : callable
        Function of a number of periods, or None for all allowed periods, that returns the price by
        formula of each cell when followed for these [s], shape (count,).
    fewest_periods : int
        Least number of periods that the method can follow.
    families : Families or None
        Where cells of the study have landings in common: its `singles` are then the parameters.
    """

    plan: Plan
    parameters: Mapping[str, Any]
    kinds: Array
    price: Callable[[float | None], Array]
    fewest_periods: int = 1
    families: Families | None = None

    @property
    def count(self) -> int:
        """Number of cells."""
        return int(self.kinds.size)

    def seconds_a_cell(self, cells: float) -> float:
        """Return the mean time of a cell on one core [s], by following some of the cells.

        `cells` is the number of cells in the study, which limits the time spent on this.
        """
        self._load()
        each, done = self._seconds_alone(cells)
        return each if self.families is None or not done else each * self._in_common(each, done)

    def _seconds_alone(self, cells: float) -> tuple[float, int]:
        """Return the mean time of a cell [s], and how many were followed to their end for it.

        `cells` is the number of cells in the study.
        """
        prices = self.price(None)
        each, spent, done = float(prices.mean()), 0.0, 0
        batches: list[tuple[int, float]] = []
        if prices[0] > _budget(cells * each):
            outcome, each = self._some_periods(cells, prices)
            if not outcome.repeats:
                return each, 0
            spent, done = outcome.seconds, 1
            batches.append((1, outcome.seconds))
        while done < self.count:
            left = _budget(cells * each) - spent
            size = min(GROWTH * batches[-1][0] if batches else 1, self.count - done)
            # Of the first batches most is the call, which more cells do not lengthen.
            size = min(size, int((GROWTH if batches else 1.0) * left / each))
            if size < 1 or (batches and batches[-1][1] > left):
                break
            outcome = self._follow(done, done + size, None, left)
            dear = outcome.seconds > SURPRISE * prices[done : done + size].sum()
            if dear and len(batches) < SURPRISING:  # it may have loaded code
                outcome = self._follow(done, done + size, None, left)
            spent += outcome.seconds
            done += size
            if not outcome.ended:
                if done == 1:  # longer than its price: how long, some of its periods tell
                    each = self._some_periods(cells, prices)[1]
                return max(each, BROKEN_OFF * spent / done), 0
            batches.append((size, outcome.seconds))
            each = _slope(batches)
            if done < ENOUGH:
                each *= float(prices.mean() / prices[:done].mean())
        return each, done

    def _in_common(self, each: float, done: int) -> float:
        """Return the time of a cell beside all its siblings over its time alone, from 0 to 1.

        Some of the cells are followed alone and then with siblings: what these add is what each
        needs for itself, and the rest is found once for all. `each` is the time of a cell alone
        [s], and `done` the number of cells known to end.
        """
        families = self.families
        assert families is not None
        count = max(1, min(done, int(LEAST / (each * (1 + families.each)))))
        alone = self._follow(0, count, None, MOST)
        beside = self._follow(0, count * families.each, None, MOST, families.siblings)
        if not (alone.ended and beside.ended):
            return 1.0
        added = (beside.seconds - alone.seconds) / ((families.each - 1) * alone.seconds)
        own = float(np.clip(added, 0.0, 1.0))
        return own + (1.0 - own) / families.size

    def _some_periods(self, cells: float, prices: Array) -> tuple[_Followed, float]:
        """Follow the first cell for doubling numbers of periods, while the budget of time lasts.

        Where even one whole cell costs too much. Return the last outcome and the estimated mean
        time of a cell [s]; `cells` is the number of cells in the study, `prices` are the times by
        formula of those of the trial for all periods [s].
        """
        each = mean = float(prices.mean())
        scale = mean / float(prices[0])
        allowed = float(np.max(self._settings.get("max_periods", 0.0)))
        periods, spent = float(self.fewest_periods), 0.0
        outcome = _Followed(0.0, ended=False, repeats=False)
        while periods < allowed and (left := _budget(cells * each) - spent) > outcome.seconds:
            outcome = self._follow(0, 1, periods, left if spent else max(left, FIRST))
            spent += outcome.seconds
            if outcome.repeats:
                return outcome, outcome.seconds * scale
            more, most = float(prices[0] / self.price(periods)[0]), allowed / periods
            if not outcome.ended:  # a dear period may be the only one: half way to the formula
                told = outcome.seconds * min(more, most) * scale
                return outcome, max(each, float(np.sqrt(each * told)))
            told = outcome.seconds * min(more * _unfinished(periods), most) * scale
            each = told**TRUST * mean ** (1.0 - TRUST)
            periods *= 2.0
        return outcome, each

    @property
    def _settings(self) -> Mapping[str, Any]:
        return {**self.plan.defaults, **self.parameters}

    def _load(self) -> None:
        """Load the compiled code that the cells need, so that loading does not count as their time.

        Of each kind of cell not seen before in this process one is followed for the fewest periods,
        since different kinds run different code.
        """
        for kind in np.unique(self.kinds).tolist():
            name = (self.plan.scene.name, self.plan.variant, int(kind))
            if name not in _loaded:
                place = int(np.argmax(self.kinds == kind))
                self._follow(place, place + 1, float(self.fewest_periods), MOST)
                _loaded.add(name)

    def _follow(
        self,
        start: int,
        stop: int,
        periods: float | None,
        left: float,
        parameters: Mapping[str, Any] | None = None,
    ) -> _Followed:
        """Follow some cells of a study, to measure their time; return it with the outcome.

        The cells with indices from `start` to before `stop`. `periods` is the number of periods to
        follow, None for all allowed ones; `left` is the processor time after which the work is
        broken off [s]. `parameters` are those of other cells than the trial's own.
        """
        known = {
            name: value[start:stop] if np.ndim(value) else value
            for name, value in (parameters or self.parameters).items()
        }
        if periods is not None and "max_periods" in self._settings:
            known["max_periods"] = np.asarray(periods)
        since, busy = time.thread_time(), time.process_time()
        watch = Watch(
            threads=1,
            stop=lambda: time.process_time() - busy > left,
            deadline=time.monotonic() + PATIENCE * left,
        )
        try:
            outcome = run_equations(self.plan, known, watch)
        except (StoppedError, ValueError):  # such as fewer periods than the method follows
            return _Followed(time.thread_time() - since, ended=False, repeats=False)
        seconds = time.thread_time() - since
        long = (outcome[one.gives] for one in self.plan.equations if one.takes_long)
        statuses = [one.status for one in long if hasattr(one, "status")]
        if not statuses:
            return _Followed(seconds, not watch.stopped(), repeats=False)
        ended = not any((one == STATUS["not_computed"]).any() for one in statuses)
        return _Followed(seconds, ended, all(np.isin(one, REPEATS).all() for one in statuses))


def _unfinished(periods: float) -> float:
    """Return the factor on the price of a motion that has not repeated after some periods [1]."""
    return UNFINISHED ** float(np.clip(np.log(periods) / np.log(TELLING), 0.0, 1.0))


def _budget(price: float) -> float:
    """Return the budget of a trial [s] for a study of this price [s]."""
    return float(np.clip(SHARE * price, LEAST, MOST))


def _slope(batches: list[tuple[int, float]]) -> float:
    """Return the time of a cell [s] without that of a call, from times of batches of cells.

    `batches` holds size and time [s] of each batch, the sizes growing: every batch takes the time
    of a call, which more cells do not lengthen.
    """
    sizes, seconds = (np.array(column, dtype=float) for column in zip(*batches, strict=True))
    call = 0.0
    if sizes[-1] >= GROWTH:
        slope = (seconds[-1] - seconds[0]) / (sizes[-1] - sizes[0])
        call = float(np.clip(seconds[0] - slope, 0.0, 0.9 * seconds.min()))
    return float((seconds - call).sum() / sizes.sum())
