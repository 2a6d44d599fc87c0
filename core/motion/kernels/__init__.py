"""Compiled kernels, a package a method; of ours they import each other and flags only.

A module is loaded, and numba with it, when its name is first asked for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from core.lazy import lazily

__all__ = ["cells", "planar", "stepping", "track", "tumbling"]

if TYPE_CHECKING:
    from core.motion.kernels import cells, planar, stepping, track, tumbling
else:
    __getattr__ = lazily(__name__, {}, ("cells", "planar", "stepping", "track", "tumbling"))
