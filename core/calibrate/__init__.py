"""Unknown parameters from measured speeds: a posterior on its grid, and the next measurement."""

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

__all__ = [
    "KIND",
    "MAX_UNKNOWNS",
    "Calibration",
]

if TYPE_CHECKING:
    from vibrafeed.core.calibrate.calibration import Calibration
    from vibrafeed.core.calibrate.estimate import KIND
    from vibrafeed.core.calibrate.prepare import MAX_UNKNOWNS
else:
    __getattr__ = lazily(
        __name__,
        {
            "calibration": ("Calibration",),
            "estimate": ("KIND",),
            "prepare": ("MAX_UNKNOWNS",),
        },
    )
