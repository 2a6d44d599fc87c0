"""Gauss and Legendre's rule of twelve places, exact for polynomials up to the power 23."""

from __future__ import annotations

import numpy as np

NODES = np.array([
    0.1252334085114689, 0.3678314989981802, 0.5873179542866175, 0.7699026741943047,
    0.9041172563704749, 0.9815606342467192,
])  # fmt: skip
"""The nodes above 0, of the interval from -1 to 1; the others lie opposite."""

WEIGHTS = np.array([
    0.24914704581340277, 0.2334925365383548, 0.20316742672306592, 0.16007832854334622,
    0.10693932599531843, 0.04717533638651183,
])  # fmt: skip
"""Weights of these nodes; those of the opposite ones are equal."""
