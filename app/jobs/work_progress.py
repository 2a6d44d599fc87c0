"""Progress of the runner's work: lines in the log, and calls of observers that count or trace."""

from __future__ import annotations

import logging
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from vibrafeed.app.jobs.ledger import Work

logger = logging.getLogger("vibrafeed.jobs")


class Witness(Protocol):
    """An observer of work, such as metrics or traces; its methods return at once."""

    def began(self, item: Work) -> Mapping[str, str]:
        """Notice that an item of work was begun; return fields to add to its log lines."""

    def computed(self, item: Work, seconds: float) -> None:
        """Notice that a block of an item is done; `seconds` is its computing time [s]."""

    def ended(self, item: Work, outcome: str, seconds: float) -> None:
        """Notice that an item ended here, with its outcome and the time it was under way [s]."""


@dataclass
class _Started:
    """An item under way: its start [s, monotonic], its fields in the log, blocks done since."""

    at: float
    about: dict[str, object]
    computed: int = 0


class WorkProgress:
    """Reports the progress of the items that a runner has taken up, to the log and to observers.

    Attributes
    ----------
    witnesses : list of Witness
        The observers, such as metrics and traces; each adds itself.
    """

    def __init__(self) -> None:
        """Begin without witnesses and without items under way."""
        self.witnesses: list[Witness] = []
        self._courses: dict[str, _Started] = {}  # by claim

    def began(self, item: Work) -> None:
        """Report to the log and to all observers that this server has begun to compute a study.

        `item` is the item of work: the study that jobs wait for, and its blocks of cells. The time
        is kept, by the claim of the item, for the report of its end. Observers may add fields to
        the log line.
        """
        about: dict[str, object] = {"key": item.key, "kind": item.process, "blocks": item.blocks}
        for witness in self.witnesses:
            about |= witness.began(item)
        self._courses[item.owner] = _Started(time.monotonic(), about)
        logger.info("work started", extra=about)

    def computed(self, item: Work, seconds: float) -> None:
        """Report a finished block of an item of work to all observers, such as metrics.

        `seconds` is the computing time of the block [s].
        """
        if item.owner in self._courses:
            self._courses[item.owner].computed += 1
        for witness in self.witnesses:
            witness.computed(item, seconds)

    def ended(self, item: Work, outcome: str, title: str | None = None) -> None:
        """Report the end of an item of work to the log and to all witnesses, once.

        `outcome` is ``done``, ``failed``, ``given up`` or ``interrupted``; `title` is that of the
        problem if the item failed. A second report of the same item is ignored.
        """
        work_progress = self._courses.pop(item.owner, None)
        if work_progress is None:
            return
        seconds = time.monotonic() - work_progress.at
        extra = {
            **work_progress.about,
            "computed": work_progress.computed,
            "seconds": round(seconds, 3),
        }
        if title is not None:
            extra["title"] = title
        logger.info("work %s", outcome, extra=extra)
        for witness in self.witnesses:
            witness.ended(item, outcome, seconds)
