"""Motion in time: stick, slide, hop, and the true mean velocity over whole grids."""

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

__all__ = [
    "KIND",
    "SYSTEMS",
    "Motion",
    "Simulation",
]

if TYPE_CHECKING:
    from vibrafeed.core.motion.method import Motion
    from vibrafeed.core.motion.prepare import Simulation
    from vibrafeed.core.motion.simulate import KIND
    from vibrafeed.core.motion.systems import SYSTEMS
else:
    __getattr__ = lazily(
        __name__,
        {
            "simulate": ("KIND",),
            "prepare": ("Simulation",),
            "result": ("Motion",),
            "systems": ("SYSTEMS",),
        },
    )
