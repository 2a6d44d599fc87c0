"""Motion in time: stick, slide, hop, and the true mean velocity over whole grids."""

from core.motion.prepare import Simulation, further, prepare
from core.motion.result import Motion
from core.motion.run import compute, label, simulate, tabulate
from core.motion.systems import SYSTEMS

__all__ = [
    "SYSTEMS",
    "Motion",
    "Simulation",
    "compute",
    "further",
    "label",
    "prepare",
    "simulate",
    "tabulate",
]
