"""The kinds of study and their models."""

from __future__ import annotations

from core.study.calibrate_study import CalibrateStudy
from core.study.optimise_study import OptimiseStudy
from core.study.sensitivity_study import SensitivityStudy
from core.study.simulate_study import SimulateStudy
from core.study.sweep_study import SweepStudy

Study = SweepStudy | SimulateStudy | OptimiseStudy | SensitivityStudy | CalibrateStudy
"""A study of any kind."""

STUDIES: dict[
    str,
    type[SweepStudy]
    | type[SimulateStudy]
    | type[OptimiseStudy]
    | type[SensitivityStudy]
    | type[CalibrateStudy],
] = {
    "sweep": SweepStudy,
    "simulate": SimulateStudy,
    "optimise": OptimiseStudy,
    "sensitivity": SensitivityStudy,
    "calibrate": CalibrateStudy,
}
