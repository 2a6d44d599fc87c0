"""The best values of some parameters: closed forms, a search of all designs, and scipy's."""

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

__all__ = [
    "KIND",
    "METHODS",
    "Optimisation",
    "nearest",
    "ways",
]

if TYPE_CHECKING:
    from vibrafeed.core.optimise.methods import METHODS
    from vibrafeed.core.optimise.optima import KIND
    from vibrafeed.core.optimise.optimisation import Optimisation
    from vibrafeed.core.optimise.reach import nearest, ways
else:
    __getattr__ = lazily(
        __name__,
        {
            "optima": ("KIND",),
            "methods": ("METHODS",),
            "optimisation": ("Optimisation",),
            "reach": ("nearest", "ways"),
        },
    )
