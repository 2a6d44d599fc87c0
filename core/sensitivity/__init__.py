"""Parameters that are not known exactly: how outputs vary with them, and which one matters."""

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

__all__ = [
    "KIND",
    "Sensitivity",
]

if TYPE_CHECKING:
    from vibrafeed.core.sensitivity.prepare import Sensitivity
    from vibrafeed.core.sensitivity.sampling import KIND
else:
    __getattr__ = lazily(
        __name__,
        {
            "sampling": ("KIND",),
            "prepare": ("Sensitivity",),
        },
    )
