"""Studies as users write them, with their units and ranges."""

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

__all__ = [
    "CalibrateStudy",
    "Fixed",
    "OptimiseStudy",
    "Points",
    "SensitivityStudy",
    "SimulateStudy",
    "Span",
    "Study",
    "SweepStudy",
    "Values",
]

if TYPE_CHECKING:
    from vibrafeed.core.study.calibrate_study import CalibrateStudy
    from vibrafeed.core.study.grid_study import Study
    from vibrafeed.core.study.optimise_study import OptimiseStudy
    from vibrafeed.core.study.sensitivity_study import SensitivityStudy
    from vibrafeed.core.study.sweep_and_simulate import SimulateStudy, SweepStudy
    from vibrafeed.core.study.values import Fixed, Points, Span, Values
else:
    __getattr__ = lazily(
        __name__,
        {
            "calibrate_study": ("CalibrateStudy",),
            "grid_study": ("Study",),
            "optimise_study": ("OptimiseStudy",),
            "sensitivity_study": ("SensitivityStudy",),
            "sweep_and_simulate": ("SimulateStudy", "SweepStudy"),
            "values": ("Fixed", "Points", "Span", "Values"),
        },
    )
