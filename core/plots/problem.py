"""The error of this package."""

from __future__ import annotations

from vibrafeed.core.errors import Problem, VibrafeedError


class PlotError(VibrafeedError):
    """A picture cannot be drawn; `problem` says where, why, and what would do."""

    def __init__(self, place: str, message: str, fix: str):
        self.problem = Problem(place, message, fix)
        super().__init__(str(self.problem))


def unreadable(message: str) -> PlotError:
    """Return the error of a dataset that lacks what `vibrafeed run` writes."""
    return PlotError("dataset", message, "Draw a result file that `vibrafeed run` wrote")
