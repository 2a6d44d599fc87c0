"""Parameters that are not known exactly: how outputs vary with them, and which one matters."""

from core.sensitivity.labels import label
from core.sensitivity.prepare import Sensitivity, further, prepare
from core.sensitivity.run import compute

__all__ = ["Sensitivity", "compute", "further", "label", "prepare"]
