"""Motion in time: stick, slide, hop, and the true mean velocity over whole grids."""

from core.motion.motion import Motion
from core.motion.prepare import Simulation, prepare, prepare_content
from core.motion.run import compute, label, simulate, tabulate
from core.motion.systems import SYSTEMS

__all__ = [
    "SYSTEMS",
    "Motion",
    "Simulation",
    "compute",
    "label",
    "prepare",
    "prepare_content",
    "simulate",
    "tabulate",
]
