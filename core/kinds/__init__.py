"""The kinds of study, each the record of its own module, and what holds for the results of all."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

from vibrafeed.core.deferred import Exported, lazily

if TYPE_CHECKING:
    from vibrafeed.core.kinds.results import (
        is_whole,
        not_verified,
        open_lazily,
        prepare,
        run_study,
        share_left_out,
        tabulate,
    )
    from vibrafeed.core.plan.pieces import Kind
else:
    __getattr__ = lazily(
        __name__,
        {
            "results": (
                "is_whole",
                "not_verified",
                "open_lazily",
                "prepare",
                "run_study",
                "share_left_out",
                "tabulate",
            )
        },
    )

__all__ = [
    "KINDS",
    "is_whole",
    "not_verified",
    "open_lazily",
    "prepare",
    "run_study",
    "share_left_out",
    "tabulate",
]

KINDS: "Final[Mapping[str, Kind]]" = Exported(
    "KIND",
    {
        "sweep": "vibrafeed.core.sweep.kind",
        "simulate": "vibrafeed.core.motion.simulate",
        "optimise": "vibrafeed.core.optimise.optima",
        "sensitivity": "vibrafeed.core.sensitivity.sampling",
        "calibrate": "vibrafeed.core.calibrate.estimate",
    },
)
"""Every kind of study, by the value of its key `kind`."""
