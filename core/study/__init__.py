"""What a user writes: studies, their units and ranges, and reading them from TOML or JSON."""

from core.study.calibrate_study import CalibrateStudy
from core.study.grid_study import GridStudy
from core.study.load import load_study, parse_json, parse_study, parse_toml
from core.study.models import Study
from core.study.optimise_study import OptimiseStudy
from core.study.sensitivity_study import SensitivityStudy
from core.study.simulate_study import SimulateStudy
from core.study.sweep_study import SweepStudy
from core.study.values import Fixed, Points, Span, Values

__all__ = [
    "CalibrateStudy",
    "Fixed",
    "GridStudy",
    "OptimiseStudy",
    "Points",
    "SensitivityStudy",
    "SimulateStudy",
    "Span",
    "Study",
    "SweepStudy",
    "Values",
    "load_study",
    "parse_json",
    "parse_study",
    "parse_toml",
]
