"""On which face a part comes to rest: a bracket of two shares, let down and thrown.

Every orientation is as likely as any other. A part that is let down with negligible momentum ends
on the face that its centre is above: its share is the solid angle under which the centre sees the
face. A part that is thrown loses its energy in many small steps, and faces near its centre have
more of it. The truth lies between, by drop height and rebound: the distance of both shares is their
error.
"""

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, hypot, sine


def share_of_faces(along: Array, across: Array, apart: Array) -> Array:
    """Return the share of parts that come to rest on either of two opposite faces of a box [1].

    (2/pi) atan(a b/(c sqrt(a^2 + b^2 + c^2))) for faces of a by b that are c apart: the solid angle
    under which the centre sees them. The three shares of a box add up to 1.
    """
    diagonal = hypot(hypot(along, across), apart)
    # Each factor is at most 1 or a length over another: no product of lengths underflows.
    return 2 / np.pi * np.arctan2((along / diagonal) * (across / diagonal), apart / diagonal)


Shares = tuple[Array, ...]
"""A number for each aspect of a part, in the order of its shape."""


def box_shares(*, length: Array, width: Array, height: Array) -> Shares:
    """Return the shares of let-down boxes that rest flat, on their side, and on their end [1].

    Flat is the face `length` by `width`, on its side `length` by `height`, on its end `width` by
    `height` (theory 16.1).
    """
    return (
        share_of_faces(length, width, height),
        share_of_faces(length, height, width),
        share_of_faces(width, height, length),
    )


def box_centres(*, length: Array, width: Array, height: Array) -> Shares:
    """Return the heights of the centre of a box: flat, on its side, on its end [m]."""
    return height / 2, width / 2, length / 2


def weighted_box_shares(
    *, length: Array, width: Array, height: Array, centre_of_mass: Array
) -> Shares:
    """Return the shares of let-down boxes whose mass is off the middle of their height [1].

    Flat with the centre at the height z, on their side, on their end, and inverted with it at h -
    z. The faces are seen from the centre as those of the lower half of a box of the height 2 z and
    of the upper half of one of 2 (h - z). NaN with the centre outside of the box.
    """
    centre_above = height - centre_of_mass
    below, above = (
        box_shares(
            length=length, width=width, height=np.where(centre_above > 0, 2 * half_height, np.nan)
        )
        for half_height in (centre_of_mass, centre_above)
    )
    sides, ends = (below[k] / 2 + above[k] / 2 for k in (1, 2))
    return below[0] / 2, sides, ends, above[0] / 2


def weighted_box_centres(
    *, length: Array, width: Array, height: Array, centre_of_mass: Array
) -> Shares:
    """Return the heights of the centre: flat, on its side, on its end, inverted [m]."""
    return centre_of_mass, width / 2, length / 2, height - centre_of_mass


def cylinder_shares(*, length: Array, diameter: Array) -> Shares:
    """Return the shares of let-down cylinders that rest on their side, and on either end [1].

    l/sqrt(l^2 + d^2) and 1 - l/sqrt(l^2 + d^2): length l, diameter d.
    """
    diagonal = hypot(length, diameter)
    return length / diagonal, (diameter / diagonal) * (diameter / (diagonal + length))


def cylinder_centres(*, length: Array, diameter: Array) -> Shares:
    """Return the heights of the centre of a cylinder: on its side, on an end [m]."""
    return diameter / 2, length / 2


def prism_shares(*, sides: Array, length: Array, diameter: Array) -> Shares:
    """Return the shares of let-down prisms that rest on a side, and on either end [1].

    With n sides, length L, diameter d of the circle through the corners, k = L/sqrt(L^2 + d^2):
    both ends together have (n/pi) (pi/n - atan(k tan(pi/n))) (theory 16.1).
    """
    diagonal = hypot(length, diameter)
    k = length / diagonal
    one_minus_k = (diameter / diagonal) * (diameter / (diagonal + length))  # 1 - k
    tan_sector = np.tan(np.pi / sides)
    ends = np.arctan2(tan_sector * one_minus_k, 1 + tan_sector * tan_sector * k)
    return sides / np.pi * np.arctan2(tan_sector * length, diagonal), sides / np.pi * ends


def prism_centres(*, sides: Array, length: Array, diameter: Array) -> Shares:
    """Return the heights of the centre of a prism: on a side, on an end [m]."""
    return diameter / 2 * cosine(np.pi / sides), length / 2


# --- bodies of revolution between two ends of different size


def cone_centre(*, diameter: Array, small_diameter: Array, height: Array) -> Array:
    """Return the height of a truncated cone's centre above the end of `diameter` [m].

    H (R1^2 + 2 R1 R2 + 3 R2^2)/(4 (R1^2 + R1 R2 + R2^2)): height H, radii R1 of this end, R2 of the
    other.
    """
    r = small_diameter / diameter
    return height * (1 + r * (2 + 3 * r)) / (4 * (1 + r * (1 + r)))


def side_foot(
    *, diameter: Array, small_diameter: Array, height: Array, mass_height: Array
) -> Array:
    """Return the foot of the centre of mass on a part's side, over the length of the side [1].

    (z_c H + R1 (R1 - R2))/L_g^2 from the end of `diameter`: radii R1, R2 of the ends, height z_c of
    the centre, length L_g of the side. The part lies on its side only where this is between 0 and
    1.
    """
    radius_difference = (diameter - small_diameter) / 2
    generator = hypot(radius_difference, height)
    from_height = (mass_height / generator) * (height / generator)
    return from_height + (diameter / 2 / generator) * (radius_difference / generator)


def is_side_unstable(*, side_foot: Array) -> Mask:
    """True where a part does not lie on its side, but rolls on over a rim."""
    return (side_foot <= 0) | (side_foot >= 1)


def end_share(centre: Array, radius: Array) -> Array:
    """Return the share of parts that come to rest on an end, (1 - z/sqrt(z^2 + r^2))/2 [1].

    z is the height of the centre above this end, r its radius: the solid angle.
    """
    rim_distance = hypot(centre, radius)
    return (radius / rim_distance) * (radius / (rim_distance + centre)) / 2


def turned_shares(
    *, diameter: Array, small_diameter: Array, height: Array, mass_height: Array,
    side_foot: Array,
) -> Shares:  # fmt: skip
    """Return the shares of let-down turned parts that rest upright, on the side, and inverted [1].

    Upright a part stands on the end of `diameter`, inverted on that of `small_diameter`. Where the
    foot of the centre is outside of the side, its share goes to the end that the part rolls onto,
    beyond 1 the small one (theory 16.1).
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
    radius_difference = (diameter - small_diameter) / 2
    above_side = (diameter / 2 * height - mass_height * radius_difference) / hypot(
        radius_difference, height
    )
    return mass_height, above_side, height - mass_height


# --- thrown parts


def _depth_below_corner(centre: Array, horizontal: Array) -> Array:
    # R - h for a corner at the distance R = hypot(h, reach) from the centre [m].
    return horizontal * (horizontal / (hypot(centre, horizontal) + centre))


def box_depths(*, length: Array, width: Array, height: Array) -> Shares:
    """Return the depths of a box in each aspect: flat, on its side, on its end [m].

    R - h: the height h of the centre below its distance R from the farthest corner, the highest
    that it can be above the floor.
    """
    return (
        _depth_below_corner(height / 2, hypot(length, width) / 2),
        _depth_below_corner(width / 2, hypot(length, height) / 2),
        _depth_below_corner(length / 2, hypot(width, height) / 2),
    )


def weighted_box_depths(
    *, length: Array, width: Array, height: Array, centre_of_mass: Array
) -> Shares:
    """Return the depths R - h of a box whose mass is off the middle of its height [m].

    R is the distance of the centre from the farthest corner; aspects as of `weighted_box_centres`.
    """
    low, high = centre_of_mass, height - centre_of_mass
    larger, along, across = np.maximum(low, high), length / 2, width / 2
    corner_distance = hypot(hypot(along, across), larger)

    def depth(centre: Array, x: Array, y: Array, z: Array) -> Array:
        # R^2 - h^2 as sum of squares, without what cancels.
        return (x * x + y * y + z * z) / (corner_distance + centre)

    def lower_than_corner(centre: Array) -> Array:
        return np.sqrt((larger - centre) * (larger + centre))

    zero = 0.0 * low
    return (
        depth(low, along, across, lower_than_corner(low)),
        depth(across, along, larger, zero),
        depth(along, across, larger, zero),
        depth(high, along, across, lower_than_corner(high)),
    )


def cylinder_depths(*, length: Array, diameter: Array) -> Shares:
    """Return the depths R - h of a cylinder: on its side, on an end [m]."""
    return _depth_below_corner(diameter / 2, length / 2), _depth_below_corner(
        length / 2, diameter / 2
    )


def prism_depths(*, sides: Array, length: Array, diameter: Array) -> Shares:
    """Return the depths R - h of a prism: on a side, on an end [m]."""
    half, half_angle = diameter / 2, np.pi / sides
    side = _depth_below_corner(
        half * cosine(half_angle), hypot(length / 2, half * sine(half_angle))
    )
    return side, _depth_below_corner(length / 2, half)


def turned_depths(
    *, diameter: Array, small_diameter: Array, height: Array, mass_height: Array,
    side_foot: Array,
) -> Shares:  # fmt: skip
    """Return the depths R - h of a turned part: upright, on its side, inverted [m].

    R is the distance of the centre from the farther rim. The side's holds where the part can lie
    on it.
    """
    low, high = mass_height, height - mass_height
    base, top = (
        _depth_below_corner(low, diameter / 2),
        _depth_below_corner(high, small_diameter / 2),
    )
    generator = hypot((diameter - small_diameter) / 2, height)
    _, above_side, _ = turned_centres(
        diameter=diameter, small_diameter=small_diameter, height=height, mass_height=mass_height
    )
    farther_rim = generator * np.maximum(side_foot, 1 - side_foot)
    # On an end the rim of the other end may be the farther one: its R - h is that on its own end,
    # plus what the centre lies lower here.
    return (
        np.maximum(base, top + (high - low)),
        _depth_below_corner(above_side, farther_rim),
        np.maximum(top, base + (low - high)),
    )


def thrown_shares(*, let_down_shares: Shares, depths: Shares) -> Shares:
    """Return the shares of thrown parts that come to rest in each aspect [1].

    Each is as the solid angle, with what an aspect receives from unstable faces, times the square
    of its depth, Omega (R - h)^2 (theory 16.1): energy is lost in many small steps.
    """
    total = sum(depths[1:], depths[0])
    pairs = zip(let_down_shares, depths, strict=True)
    weights = [share * np.square(depth / total) for share, depth in pairs]
    weight_sum = sum(weights[1:], weights[0])
    return tuple(weight / weight_sum for weight in weights)


def long_side_share(*, length: Array, width: Array) -> Array:
    """Return the share of rectangles that turn their long side to a wall [1].

    Pushed against it without friction: (2/pi) atan(long/short).
    """
    return 2 / np.pi * np.arctan2(np.maximum(length, width), np.minimum(length, width))


# --- The toppling of a standing part: on a slope, at a sudden stop, by a pulse (theory 16.2).
#
# A part stands with half its base b along the push and its centre of mass at the height z_c. With R
# = hypot(b, z_c) and k its radius of gyration about the centre, it turns about an edge of its base
# with the moment of inertia m (k^2 + R^2). Arrays broadcast; SI units, angles in radians.

MAX_STEPS = 6
"""Newton's steps for the pulse: each at least squares the error, which is below 0.1 at the start.
The tests try pulses over twelve orders of magnitude."""

FAR = 10.0
"""Half base over the amplitude of the track, above which the amplitude counts as small."""

# --- how parts stand: half base along the push, height of the centre, gyration


def half(*, size: Array) -> Array:
    """Return half of a size [m]."""
    return size / 2


def box_gyration(*, length: Array, height: Array) -> Array:
    """Return the radius of gyration of a box about its width, sqrt((l^2 + h^2)/12) [m]."""
    return np.sqrt(np.square(hypot(length, height)) / 12)


def cylinder_gyration(*, length: Array, diameter: Array) -> Array:
    """Return the radius of gyration of a cylinder about a diameter, sqrt(r^2/4 + l^2/12) [m]."""
    return np.sqrt(np.square(diameter) / 16 + np.square(length) / 12)


def prism_base(*, sides: Array, diameter: Array) -> Array:
    """Return the distance of a prism's side from its axis, the least half base [m]."""
    return diameter / 2 * cosine(np.pi / sides)


def prism_gyration(*, sides: Array, length: Array, diameter: Array) -> Array:
    """Return the radius of gyration of a prism about a line across it [m].

    k^2 = R^2 (2 + cos(2 pi/n))/12 + L^2/12, R the radius of the circle through the corners.
    """
    radius_term = np.square(diameter / 2) * (2 + cosine(2 * np.pi / sides))
    return np.sqrt((radius_term + np.square(length)) / 12)


def cone_gyration(
    *, diameter: Array, small_diameter: Array, height: Array, mass_height: Array
) -> Array:
    """Return the radius of gyration of a truncated cone about a line across its axis [m].

    k^2 = 3 R1^2 (1 + r + r^2 + r^3 + r^4)/(20 q) + H^2 (1 + 3 r + 6 r^2)/(10 q) - z_c^2 with r =
    R2/R1, q = 1 + r + r^2: radii R1 and R2 of the ends, height H, centre of mass z_c above the end
    of R1.
    """
    r = small_diameter / diameter
    q = 1 + r * (1 + r)
    radius_term = 3 * (1 + r * (1 + r * (1 + r * (1 + r)))) / (80 * q)
    height_term = (1 + r * (3 + 6 * r)) / (10 * q)
    centre_fraction = mass_height / height
    return hypot(
        diameter * np.sqrt(radius_term),
        height * np.sqrt(height_term - centre_fraction * centre_fraction),
    )


def part_mass(*, part_volume: Array, part_density: Array) -> Array:
    """Return the mass of a part, density times volume [kg]."""
    return part_volume * part_density


# --- when it topples


def edge_distance(*, standing_base: Array, standing_centre: Array) -> Array:
    """Return the distance of the centre from the edge that the part turns about, R [m]."""
    return hypot(standing_base, standing_centre)


def topple_slope(*, standing_base: Array, standing_centre: Array) -> Array:
    """Return the slope on which a part topples, if it does not slide before, atan(b/z_c) [rad].

    b is half its base along the slope, z_c the height of its centre.
    """
    return np.arctan2(standing_base, standing_centre)


def rocking_friction(*, standing_base: Array, standing_centre: Array) -> Array:
    """Return the friction below which a part slides and never rocks, b/z_c [1].

    b is half its base along the push, z_c the height of its centre.
    """
    return standing_base / standing_centre


def rocking_rate(*, edge_distance: Array, gyration: Array, gravity: Array) -> Array:
    """Return the rate p at which a part falls from its edge, sqrt(g R/(k^2 + R^2)) [s-1].

    R is the distance of the centre from the edge, k the radius of gyration about the centre; tilts
    grow as exp(p t).
    """
    return np.sqrt(gravity * edge_distance) / hypot(gyration, edge_distance)


def topple_speed(
    *, standing_base: Array, standing_centre: Array, edge_distance: Array,
    gyration: Array, gravity: Array,
) -> Array:  # fmt: skip
    """Return the speed from which a part topples if its foot is stopped at once [m s-1].

    V = sqrt(2 g R (1 - cos alpha_c) (k^2 + R^2))/z_c, cos alpha_c = z_c/R: the angular momentum
    about the edge is kept, and lifts the centre above the edge. R - z_c is written as b^2/(R +
    z_c), b half the base.
    """
    speed_factor_squared = 2 * gravity / (edge_distance + standing_centre)
    edge_gyration = hypot(gyration, edge_distance)
    return standing_base / standing_centre * np.sqrt(speed_factor_squared) * edge_gyration


def pulse_angle(*, rocking_rate: Array, frequency: Array) -> Array:
    """Return the phase of a half-sine pulse at which a part begins to rock that just topples [rad].

    With q = p/w the root psi of q (exp(-q (pi - psi)) + cos psi) = sin psi, by Newton's method on
    psi = phi + asin(sin(phi) exp(-q (pi - psi))), phi = atan(q) (theory 16.2).
    """
    q = rocking_rate / (2 * np.pi * frequency)
    phi = np.arctan(q)
    sin_phi = q / np.sqrt(1 + q * q)
    psi = phi
    for _ in range(MAX_STEPS):
        sin_delay = sin_phi * np.exp(-q * (np.pi - psi))
        cos_delay = np.sqrt((1 - sin_delay) * (1 + sin_delay))
        psi = psi - (psi - phi - np.arctan2(sin_delay, cos_delay)) / (1 - q * sin_delay / cos_delay)
    return psi


def topple_acceleration(*, topple_slope: Array, pulse_angle: Array, gravity: Array) -> Array:
    """Return the peak of a half-sine pulse that just topples, alpha_c g/sin(psi) [m s-2].

    alpha_c is the slope on which the part topples, psi the phase at which it begins to rock.
    Rocking is taken as linear, and judged at the pulse's end.
    """
    return topple_slope * gravity / np.sin(pulse_angle)


def topple_margin(*, topple_speed: Array, frequency: Array, amplitude: Array, beta: Array) -> Array:
    """Return half the toppling speed less the track's speed, V/2 - A w cos(beta) [m s-1]."""
    return topple_speed / 2 - 2 * np.pi * frequency * amplitude * cosine(beta)


def push_over_load(
    *, frequency: Array, amplitude: Array, beta: Array, gamma: Array, gravity: Array
) -> Array:
    """Return the largest push along the track over the load on the floor in a period, |D|/n [1].

    A part at rest begins to rock, or to slide, only if this exceeds its limit. With s = sin(w t), D
    = P cos(beta) s - g sin(gamma) over n = g cos(gamma) - P sin(beta) s is monotonic in s, so that
    the ends s = -1 and 1 count. Infinite where the part leaves the floor.
    """
    drive = np.square(2 * np.pi * frequency) * amplitude
    drive_along, drive_normal = drive * cosine(beta), drive * sine(beta)
    gravity_along, gravity_normal = gravity * sine(gamma), gravity * cosine(gamma)
    stays_on_floor = gravity_normal > np.abs(drive_normal)
    least_load, largest_load = (
        np.where(stays_on_floor, gravity_normal - drive_normal, 1.0),
        np.where(stays_on_floor, gravity_normal + drive_normal, 1.0),
    )
    push = np.maximum(
        np.abs(drive_along - gravity_along) / least_load,
        np.abs(drive_along + gravity_along) / largest_load,
    )
    return np.where(stays_on_floor, push, np.inf)


def rocking_margin(
    *, rocking_friction: Array, friction_static: Array, push_over_load: Array
) -> Array:
    """Return the floor's push beyond that which rocks a part, min(mu_s, |D|/n) - b/z_c [1].

    Where it is not above 0, the part never rocks, however long the shaking lasts. A part that
    begins to rock need not topple.
    """
    return np.minimum(friction_static, push_over_load) - rocking_friction


def may_topple(*, topple_margin: Array, amplitude: Array, standing_base: Array) -> Mask:
    """True where shaking may topple a part: no margin, or an amplitude near half its base."""
    return (topple_margin <= 0) | (FAR * amplitude > standing_base)
