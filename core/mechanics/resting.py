"""On which face a part comes to rest: the solid angle under which its centre sees the face.

Every orientation is as likely as any other, and the part is let down with negligible momentum: it
ends on the face that its centre is above. A part that tumbles fast favours large faces more.
"""

from __future__ import annotations

import numpy as np

from core.mechanics.angles import cosine
from core.mechanics.arrays import Array, Mask, hypot


def share_of_faces(along: Array, across: Array, apart: Array) -> Array:
    """Return the share of parts that come to rest on either of two opposite faces of a box [1].

    (2/pi) atan(a b/(c sqrt(a^2 + b^2 + c^2))) for faces of a (`along`) by b (`across`) that are c
    (`apart`) from each other [m]: the solid angle under which the centre sees them. The three
    shares of a box add up to 1.
    """
    through = hypot(hypot(along, across), apart)
    # Each factor is at most 1 or a length over another: no product of lengths underflows.
    return 2 / np.pi * np.arctan2((along / through) * (across / through), apart / through)


def share_of_mantle(length: Array, diameter: Array) -> Array:
    """Return the share of cylinders that come to rest on their side, l/sqrt(l^2 + d^2) [1]."""
    return length / hypot(length, diameter)


def share_of_ends(length: Array, diameter: Array) -> Array:
    """Return the share of cylinders that come to rest on either end, 1 - l/sqrt(l^2 + d^2) [1]."""
    through = hypot(length, diameter)
    return (diameter / through) * (diameter / (through + length))


Shares = tuple[Array, ...]
"""A number for each aspect of a part, in the order of its shape."""


def box_shares(*, length: Array, width: Array, height: Array) -> Shares:
    """Return the shares of boxes that come to rest flat, on their side, and on their end [1].

    Tipped out in any orientation (theory 16.1). Flat is the face `length` by `width`, on its side
    `length` by `height`, on its end `width` by `height` [m].
    """
    return (
        share_of_faces(length, width, height),
        share_of_faces(length, height, width),
        share_of_faces(width, height, length),
    )


def box_centres(*, length: Array, width: Array, height: Array) -> Shares:
    """Return the heights of the centre of a box: flat, on its side, on its end [m]."""
    return height / 2, width / 2, length / 2


def cylinder_shares(*, length: Array, diameter: Array) -> Shares:
    """Return the resting shares of a cylinder: on its side, on either end [1]."""
    return share_of_mantle(length, diameter), share_of_ends(length, diameter)


def cylinder_centres(*, length: Array, diameter: Array) -> Shares:
    """Return the heights of the centre of a cylinder: on its side, on an end [m]."""
    return diameter / 2, length / 2


def prism_shares(*, sides: Array, length: Array, diameter: Array) -> Shares:
    """Return the shares of prisms that come to rest on a side, and on either end [1].

    Tipped out in any orientation (theory 16.1). Of n `sides`, `length` L and `diameter` d of the
    circle through the corners, with k = L/sqrt(L^2 + d^2): both ends together have (n/pi) (pi/n -
    atan(k tan(pi/n))), the sides the rest.
    """
    through = hypot(length, diameter)
    k = length / through
    less = (diameter / through) * (diameter / (through + length))  # 1 - k
    t = np.tan(np.pi / sides)
    ends = np.arctan2(t * less, 1 + t * t * k)
    return sides / np.pi * np.arctan2(t * length, through), sides / np.pi * ends


def prism_centres(*, sides: Array, length: Array, diameter: Array) -> Shares:
    """Return the heights of the centre of a prism: on a side, on an end [m]."""
    return diameter / 2 * cosine(np.pi / sides), length / 2


# --- bodies of revolution between two ends of different size


def cone_centre(*, diameter: Array, small_diameter: Array, height: Array) -> Array:
    """Return the height of a truncated cone's centre above the end of `diameter` [m].

    H (R1^2 + 2 R1 R2 + 3 R2^2)/(4 (R1^2 + R1 R2 + R2^2)): height H, radii R1 of this end and R2 of
    the other.
    """
    r = small_diameter / diameter
    return height * (1 + r * (2 + 3 * r)) / (4 * (1 + r * (1 + r)))


def turned_centre(*, centre_of_mass: Array) -> Array:
    """Return the height of a turned part's centre above the end of `diameter`, as measured [m]."""
    return centre_of_mass


def side_foot(
    *, diameter: Array, small_diameter: Array, height: Array, mass_height: Array
) -> Array:
    """Return the foot of the centre of mass on a part's side, over the length of the side [1].

    For a truncated cone: (z_c H + R1 (R1 - R2))/L_g^2, counted from the end of `diameter`: R1 and
    R2 are the radii of both ends, H the `height`, z_c (`mass_height`) that of the centre, L_g =
    hypot(R1 - R2, H) the length of the side [m]. The part lies on its side only where this is
    between 0 and 1.
    """
    apart = (diameter - small_diameter) / 2
    generator = hypot(apart, height)
    along = (mass_height / generator) * (height / generator)
    return along + (diameter / 2 / generator) * (apart / generator)


def is_side_unstable(*, side_foot: Array) -> Mask:
    """True where a part does not lie on its side, but rolls on over a rim."""
    return (side_foot <= 0) | (side_foot >= 1)


def has_centre_outside(*, height: Array, mass_height: Array) -> Mask:
    """True where the centre of mass is not between both ends."""
    return mass_height >= height


def end_share(centre: Array, radius: Array) -> Array:
    """Return the share of parts that come to rest on an end, (1 - z/sqrt(z^2 + r^2))/2 [1].

    z (`centre`) is the height of the centre of mass above this end, r (`radius`) that of the end
    [m]: the solid angle under which the centre sees it.
    """
    through = hypot(centre, radius)
    return (radius / through) * (radius / (through + centre)) / 2


def turned_shares(
    *, diameter: Array, small_diameter: Array, height: Array, mass_height: Array,
    side_foot: Array,
) -> Shares:  # fmt: skip
    """Return the shares of turned parts that come to rest upright, on the side, and inverted [1].

    Tipped out in any orientation (theory 16.1). Upright a part stands on the end of `diameter`,
    inverted on that of `small_diameter`; `height` and `mass_height` are its length and the height
    of its centre of mass, all [m]. `side_foot` is the foot of the centre on the side over its
    length [1]: outside 0 to 1 the side is unstable, and its share goes to the end that the part
    rolls onto, beyond 1 the small one.
    """
    low, high = mass_height, height - mass_height
    upright, inverted = end_share(low, diameter / 2), end_share(high, small_diameter / 2)
    # 1 less both ends, without the difference of what is nearly 1.
    side = low / hypot(low, diameter / 2) / 2 + high / hypot(high, small_diameter / 2) / 2
    stays = (side_foot > 0) & (side_foot < 1)
    return (
        upright + np.where(side_foot <= 0, side, 0.0),
        np.where(stays, side, 0.0),
        inverted + np.where(side_foot >= 1, side, 0.0),
    )


def turned_centres(
    *, diameter: Array, small_diameter: Array, height: Array, mass_height: Array
) -> Shares:
    """Return the heights of the centre of a turned part: upright, on its side, inverted [m]."""
    apart = (diameter - small_diameter) / 2
    across = (diameter / 2 * height - mass_height * apart) / hypot(apart, height)
    return mass_height, across, height - mass_height


# --- the second estimate


def second_shares(*, resting_shares: Shares, centre_heights: Shares) -> Shares:
    """Return a second estimate of the resting shares: solid angle over height of the centre [1].

    Each share is divided by the height of the centre in its aspect [m], then all are scaled to the
    sum 1 (Ngoi et al. 1995). The difference to the first estimate tells how far either may be
    trusted.
    """
    weights = [share / height for share, height in zip(resting_shares, centre_heights, strict=True)]
    total = sum(weights[1:], weights[0])
    return tuple(weight / total for weight in weights)


def share_errors(*, resting_shares: Shares, second_shares: Shares) -> Shares:
    """Return the difference between both estimates of the shares [1]."""
    both = zip(resting_shares, second_shares, strict=True)
    return tuple(np.abs(first - second) for first, second in both)


def long_side_share(*, length: Array, width: Array) -> Array:
    """Return the share of rectangles that turn their long side to a wall [1].

    Pushed against it without friction: (2/pi) atan(long/short).
    """
    return 2 / np.pi * np.arctan2(np.maximum(length, width), np.minimum(length, width))
