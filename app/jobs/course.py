"""What the runner tells of its work: a line in the log, and word to whoever counts or traces."""

from __future__ import annotations

import logging
import time
from collections.abc import Sequence
from typing import Protocol

from app.jobs.ledger import Work

logger = logging.getLogger("vibrafeed.jobs")


class Witness(Protocol):
    """Is told how work goes on; its methods return at once."""

    def began(self, item: Work) -> None:
        """Take note that an item has been taken up."""

    def computed(self, item: Work, seconds: Sequence[float]) -> None:
        """Take note of blocks that are done, and of what each took."""

    def ended(self, item: Work, outcome: str, seconds: float) -> None:
        """Take note of how an item ended here, and how long after it was taken up."""


class Course:
    """The course of the items that a runner has taken up.

    Attributes
    ----------
    witnesses : list of Witness
        Who is told; whoever wants to be adds itself.
    """

    def __init__(self) -> None:
        self.witnesses: list[Witness] = []
        self._began: dict[str, tuple[float, int]] = {}  # by claim: when [s], and blocks since

    def began(self, item: Work) -> None:
        """Tell that an item has been taken up."""
        self._began[item.owner] = time.monotonic(), 0
        logger.info("work started", extra=_about(item))
        for witness in self.witnesses:
            witness.began(item)

    def computed(self, item: Work, seconds: Sequence[float]) -> None:
        """Tell of blocks that are done, and what each took [s]."""
        if item.owner in self._began:
            began, blocks = self._began[item.owner]
            self._began[item.owner] = began, blocks + len(seconds)
        for witness in self.witnesses:
            witness.computed(item, seconds)

    def ended(self, item: Work, outcome: str, title: str | None = None) -> None:
        """Tell how an item ended here: ``done``, ``failed`` or ``given up``; only once counts."""
        if item.owner not in self._began:
            return
        began, blocks = self._began.pop(item.owner)
        seconds = time.monotonic() - began
        extra = {**_about(item), "computed": blocks, "seconds": round(seconds, 3)}
        if title is not None:
            extra["title"] = title
        logger.info("work %s", outcome, extra=extra)
        for witness in self.witnesses:
            witness.ended(item, outcome, seconds)


def _about(item: Work) -> dict[str, object]:
    return {"key": item.key, "kind": item.process, "blocks": item.blocks}
