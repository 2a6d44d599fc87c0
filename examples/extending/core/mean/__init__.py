"""The mean of closed forms over all cells of a grid."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

__all__ = ["KIND"]

if TYPE_CHECKING:
    from vibrafeed.core.mean.kind import KIND
else:
    __getattr__ = lazily(__name__, {"kind": ("KIND",)})
