"""Statistics over some axes of a grid, of closed forms or motion, box by box; nothing is stored."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibrafeed.core.lazy import lazily

__all__ = ["arrays", "run"]

if TYPE_CHECKING:
    from vibrafeed.core.reduce import arrays, run
else:  # they load numba
    __getattr__ = lazily(__name__, {}, {"arrays": "arrays", "run": "run"})
