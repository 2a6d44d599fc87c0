"""What measured speeds tell of unknown parameters: a posterior on its grid, and the next run."""

from core.calibrate.calibration import Calibration
from core.calibrate.prepare import MOST_UNKNOWNS, further, prepare
from core.calibrate.run import calibrate, compute, label, tabulate

__all__ = [
    "MOST_UNKNOWNS",
    "Calibration",
    "calibrate",
    "compute",
    "further",
    "label",
    "prepare",
    "tabulate",
]
