"""Statistics over some axes of a grid of closed forms, box by box, without storing the grid."""

from __future__ import annotations

from typing import TYPE_CHECKING

from core.lazy import lazily

__all__ = ["answers", "run"]

if TYPE_CHECKING:
    from core.reduce import answers, run
else:  # they load numba
    __getattr__ = lazily(__name__, {}, {"answers": "answers", "run": "run"})
