"""Motion in time: stick, slide, hop, and the true mean velocity over whole grids."""

from __future__ import annotations

from typing import TYPE_CHECKING

from core.lazy import lazily

__all__ = [
    "KIND",
    "SYSTEMS",
    "Motion",
    "Simulation",
]

if TYPE_CHECKING:
    from core.motion.kind import KIND
    from core.motion.prepare import Simulation
    from core.motion.result import Motion
    from core.motion.systems import SYSTEMS
else:
    __getattr__ = lazily(
        __name__,
        {
            "kind": ("KIND",),
            "prepare": ("Simulation",),
            "result": ("Motion",),
            "systems": ("SYSTEMS",),
        },
    )
