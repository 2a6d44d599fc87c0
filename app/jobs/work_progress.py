"""Progress of the runner's work: lines in the log, and calls of observers that count or trace."""

from __future__ import annotations

import logging
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from app.jobs.ledger import Work

logger = logging.getLogger("vibrafeed.jobs")


class Witness(Protocol):
    """Is told how work goes on; its methods return at once."""

    def began(self, item: Work) -> Mapping[str, str]:
        """Take note that an item has been taken up; return what its log lines are to tell too."""

    def computed(self, item: Work, seconds: Sequence[float]) -> None:
        """Take note of blocks that are done, and of what each took."""

    def ended(self, item: Work, outcome: str, seconds: float) -> None:
        """Take note of how an item ended here, and how long after it was taken up."""


@dataclass
class _Started:
    """An item under way: its start [s, monotonic], its fields in the log, blocks done since."""

    at: float
    about: dict[str, object]
    computed: int = 0


class WorkProgress:
    """The course of the items that a runner has taken up.

    Attributes
    ----------
    witnesses : list of Witness
        Who is told; whoever wants to be adds itself.
    """

    def __init__(self) -> None:
        self.witnesses: list[Witness] = []
        self._courses: dict[str, _Started] = {}  # by claim

    def began(self, item: Work) -> None:
        """Tell that an item has been taken up."""
        about: dict[str, object] = {"key": item.key, "kind": item.process, "blocks": item.blocks}
        for witness in self.witnesses:
            about |= witness.began(item)
        self._courses[item.owner] = _Started(time.monotonic(), about)
        logger.info("work started", extra=about)

    def computed(self, item: Work, seconds: Sequence[float]) -> None:
        """Tell of blocks that are done, and what each took [s]."""
        if item.owner in self._courses:
            self._courses[item.owner].computed += len(seconds)
        for witness in self.witnesses:
            witness.computed(item, seconds)

    def ended(self, item: Work, outcome: str, title: str | None = None) -> None:
        """Report the end of an item here: ``done``, ``failed`` or ``given up``, once."""
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
