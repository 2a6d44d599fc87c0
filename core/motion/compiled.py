"""The kernels that Python calls; each is loaded, and numba with it, when it is first asked for.

It stands outside of `kernels`: what is compiled there is kept for as long as what it imports stays
the same, and it imports none of this.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibrafeed.core.lazy import lazily

__all__ = ["flow", "inputs", "plane_cells", "rows", "track", "tumbling", "wave"]

if TYPE_CHECKING:
    from vibrafeed.core.motion.kernels import inputs, rows, track, tumbling
    from vibrafeed.core.motion.kernels.planar import flow, plane_cells, wave
else:
    _TOP = ("inputs", "rows", "track", "tumbling")
    _PLANAR = ("flow", "plane_cells", "wave")
    __getattr__ = lazily(
        f"{__package__}.kernels",
        {},
        {name: name for name in _TOP} | {name: f"planar.{name}" for name in _PLANAR},
    )
