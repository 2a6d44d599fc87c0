"""On which face a part comes to rest: the solid angle under which its centre sees the face.

Every orientation is as likely as any other, and the part is let down with negligible momentum: it
ends on the face that its centre is above. A part that tumbles fast favours large faces more.
"""

from __future__ import annotations

import numpy as np

from core.mechanics.arrays import Array, hypot


def share_of_faces(along: Array, across: Array, apart: Array) -> Array:
    """Return the share of two opposite faces of a box [1].

    (2/pi) atan(a b/(c sqrt(a^2 + b^2 + c^2))): faces a by b, a distance of c apart. The three
    shares of a box add up to 1.
    """
    through = hypot(hypot(along, across), apart)
    # Each factor is at most 1 or a length over another: no product of lengths underflows.
    return 2 / np.pi * np.arctan2((along / through) * (across / through), apart / through)


def share_of_mantle(length: Array, diameter: Array) -> Array:
    """Return the share of the round side of a cylinder, l/sqrt(l^2 + d^2) [1]."""
    return length / hypot(length, diameter)


def share_of_ends(length: Array, diameter: Array) -> Array:
    """Return the share of both ends of a cylinder, 1 - l/sqrt(l^2 + d^2) [1]."""
    through = hypot(length, diameter)
    return (diameter / through) * (diameter / (through + length))
