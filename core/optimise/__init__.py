"""The best values of some parameters: exact answers, a compiled batch solver, and optimisers."""

from core.optimise.methods import METHODS
from core.optimise.optimisation import Optimisation
from core.optimise.prepare import further, prepare
from core.optimise.run import compute, label, optimise, tabulate

__all__ = [
    "METHODS",
    "Optimisation",
    "compute",
    "further",
    "label",
    "optimise",
    "prepare",
    "tabulate",
]
