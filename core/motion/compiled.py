"""The kernels that Python calls; each is loaded, and numba with it, when it is first asked for.

It stands outside of `kernels`: what is compiled there is kept for as long as what it imports stays
the same, and it imports none of this.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

__all__ = [
    "again",
    "cells",
    "flow",
    "rows",
    "solve",
    "track",
    "tumbling",
    "unrepeated",
    "wave",
]

if TYPE_CHECKING:
    from vibrafeed.core.motion.kernels import cells, rows, track, tumbling
    from vibrafeed.core.motion.kernels.planar import again, flow, solve, unrepeated, wave
else:
    _ONE_PACKAGE = ("cells", "rows", "track", "tumbling")
    _PLANAR = ("again", "flow", "solve", "unrepeated", "wave")
    __getattr__ = lazily(
        f"{__package__}.kernels",
        {},
        {name: name for name in _ONE_PACKAGE} | {name: f"planar.{name}" for name in _PLANAR},
    )
