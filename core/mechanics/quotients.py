"""Functions over their argument, with the limit 1 at 0: (1 - exp(-s))/s, log1p(z)/z, sin(u)/u."""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, ratio


def expm1_quotient(s: Array) -> Array:
    """Return (1 - exp(-s))/s, with the limit 1 at s = 0."""
    return ratio(-np.expm1(-s), s, 1.0)


def log1p_quotient(z: Array) -> Array:
    """Return log1p(z)/z, with the limit 1 at 0."""
    return ratio(np.log1p(z), z, 1.0)


def sin_quotient(u: Array) -> Array:
    """Return sin(u)/u, with the limit 1 at 0."""
    return ratio(np.sin(u), u, 1.0)


def sinh_quotient(u: Array) -> Array:
    """Return sinh(u)/u, with the limit 1 at 0."""
    return ratio(np.sinh(u), u, 1.0)


def tan_quotient(u: Array) -> Array:
    """Return tan(u)/u, with the limit 1 at 0."""
    return ratio(np.tan(u), u, 1.0)


def tanh_quotient(u: Array) -> Array:
    """Return tanh(u)/u, with the limit 1 at 0."""
    return ratio(np.tanh(u), u, 1.0)


def arctan_quotient(u: Array) -> Array:
    """Return atan(u)/u, with the limit 1 at 0."""
    return ratio(np.arctan(u), u, 1.0)
