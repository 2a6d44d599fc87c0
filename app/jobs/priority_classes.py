"""Priority classes of work: a server takes up some long items, and some short ones besides."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Collection, Sequence
from typing import NamedTuple

from vibrafeed.app.jobs import learned
from vibrafeed.app.jobs.database import Database
from vibrafeed.app.jobs.ledger import Work
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.settings import Settings
from vibrafeed.core.kinds import KINDS

SHORT = 10  # in times of a block; items that take longer are long
REPORT_SECONDS = 60.0  # of a report, whose study says nothing of it
MAX_KNOWN = 1000  # items whose expected time is kept in memory


class _Price(NamedTuple):
    """The expected time of an item [s], that by formula alone [s], and its kind and method."""

    expected: float
    by_formula: float
    name: str


class PriorityClasses:
    """Chooses the next item among the work that waits.

    As many long items may be computed at a time as `concurrent_jobs` says, and as many short ones
    besides: short work does not wait until something long is over. On the workers they share time:
    see `vibrafeed.app.jobs.fair_queue`.

    Parameters
    ----------
    store : Store
        Where the studies are, from which the expected time follows.
    settings : Settings
        The service's.
    database : Database
        The ledger's, with what earlier studies took.
    """

    def __init__(self, store: Store, settings: Settings, database: Database):
        """Choose work by the expected times of stored studies."""
        self._store, self._database = store, database
        self._most = settings.concurrent_jobs
        self._short = SHORT * settings.block_seconds
        self._prices: OrderedDict[str, _Price] = OrderedDict()

    def next(self, waiting: Sequence[Work], active: Collection[str]) -> Work | None:
        """Return the item of work to begin next, out of those that wait; None if none may begin.

        Up to `concurrent_jobs` long items and as many short ones are under way at a time. `waiting`
        is in the order of arrival; `active` are the identifiers of the studies that this server
        computes.
        """
        for key in active:
            if key in self._prices:  # it is not forgotten while it runs
                self._prices.move_to_end(key)
        known = [self._prices[key].expected for key in active if key in self._prices]
        long = sum(expected > self._short for expected in known)
        short = len(active) - long
        if min(long, short) >= self._most:
            return None
        for item in waiting:
            is_long = self.price(item) > self._short
            if item.key not in active and (long if is_long else short) < self._most:
                return item
        return None

    def price(self, item: Work) -> float:
        """Return the expected time of computing a study on one core [s].

        Short studies get a higher priority by it. `item` is the item of work, which names the
        study. Times are kept in memory, so that a study is estimated once; the oldest are dropped.
        """
        return self._priced(item).expected

    def learn(self, item: Work, took: float) -> None:
        """Keep what an item took, summed over workers [s], for the prices of later ones."""
        price = self._priced(item)
        if price.name:
            learned.learn(self._database, price.name, price.by_formula, took)

    def _priced(self, item: Work) -> _Price:
        """Return the price of an item, kept in memory."""
        if item.key not in self._prices:
            self._prices[item.key] = self._new_price(item)
            while len(self._prices) > MAX_KNOWN:
                self._prices.popitem(last=False)
        return self._prices[item.key]

    def block_price(self, item: Work) -> float:
        """Return the expected time of one block of an item on one core [s]."""
        return self.price(item) / max(1, item.blocks)

    def _new_price(self, item: Work) -> _Price:
        """Return the price of an item: its expected time, by which work is ordered.

        `item` is the item of work, which names the study in the store. The time by formula is
        multiplied by what studies of this kind and method took beside it of late, which the ledger
        of jobs keeps. A report counts as a minute. The time is 0 if the study
        cannot be read, so that it holds up no other; the error shows when the item is carried out.
        """
        if item.process not in KINDS:
            return _Price(REPORT_SECONDS, 0.0, "")
        try:
            prepared = self._store.get(item.key)
        except Exception:  # it holds up no other: who carries it out says what is wrong with it
            return _Price(0.0, 0.0, "")
        name = f"{item.process} {prepared.plan.variant}"
        seconds = prepared.cells * prepared.seconds_a_cell
        return _Price(seconds * learned.factor(self._database, name), seconds, name)
