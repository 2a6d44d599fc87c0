"""The toppling of a standing part: on a slope, at a sudden stop, by a pulse (theory 16.2).

A part stands with half its base b along the push and its centre of mass at the height z_c. With
R = hypot(b, z_c) and k its radius of gyration about the centre, it turns about an edge of its base
with the moment of inertia m (k^2 + R^2). Arrays broadcast; SI units, angles in radians.
"""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics.angles import cosine, sine
from vibrafeed.core.mechanics.arrays import Array, Mask, hypot

MAX_STEPS = 6
"""Newton's steps for the pulse: each at least squares the error, which is below 0.1 at the start.
The tests try pulses over twelve orders of magnitude."""

FAR = 10.0
"""Half base over the amplitude of the track, above which the amplitude counts as small."""

# --- how parts stand: half base along the push, height of the centre, gyration


def box_base(*, length: Array) -> Array:
    """Return half the length of a box, which is pushed along it [m]."""
    return length / 2


def box_centre(*, height: Array) -> Array:
    """Return half the height of a box [m]."""
    return height / 2


def box_gyration(*, length: Array, height: Array) -> Array:
    """Return the radius of gyration of a box about its width, sqrt((l^2 + h^2)/12) [m]."""
    return np.sqrt(np.square(hypot(length, height)) / 12)


def round_base(*, diameter: Array) -> Array:
    """Return the radius of a round end [m]."""
    return diameter / 2


def end_centre(*, length: Array) -> Array:
    """Return half the length of a part that stands on its end [m]."""
    return length / 2


def cylinder_gyration(*, length: Array, diameter: Array) -> Array:
    """Return the radius of gyration of a cylinder about a diameter, sqrt(r^2/4 + l^2/12) [m]."""
    return np.sqrt(np.square(diameter) / 16 + np.square(length) / 12)


def prism_base(*, sides: Array, diameter: Array) -> Array:
    """Return the distance of a prism's side from its axis, the least half base [m]."""
    return diameter / 2 * cosine(np.pi / sides)


def prism_gyration(*, sides: Array, length: Array, diameter: Array) -> Array:
    """Return the radius of gyration of a prism about a line across it [m].

    k^2 = R^2 (2 + cos(2 pi/n))/12 + L^2/12, with n sides, length L and the radius R of the circle
    through the corners.
    """
    across = np.square(diameter / 2) * (2 + cosine(2 * np.pi / sides))
    return np.sqrt((across + np.square(length)) / 12)


def cone_gyration(
    *, diameter: Array, small_diameter: Array, height: Array, mass_height: Array
) -> Array:
    """Return the radius of gyration of a truncated cone about a line across its axis [m].

    The line passes through the centre of mass; the radius says how easily the standing cone
    topples. k^2 = 3 R1^2 (1 + r + r^2 + r^3 + r^4)/(20 q) + H^2 (1 + 3 r + 6 r^2)/(10 q) - z_c^2
    with r = R2/R1 and q = 1 + r + r^2: radii R1 and R2 of the ends, halves of `diameter` and
    `small_diameter`, `height` H, centre of mass z_c above the end of R1 (`mass_height`), all [m].
    """
    r = small_diameter / diameter
    q = 1 + r * (1 + r)
    turning = 3 * (1 + r * (1 + r * (1 + r * (1 + r)))) / (80 * q)
    along = (1 + r * (3 + 6 * r)) / (10 * q)
    z = mass_height / height
    return hypot(diameter * np.sqrt(turning), height * np.sqrt(along - z * z))


def turned_gyration(*, radius_of_gyration: Array) -> Array:
    """Return the radius of gyration of a turned part, as measured [m]."""
    return radius_of_gyration


def upright_centre(*, mass_height: Array) -> Array:
    """Return the height of the centre of a part that stands on the end of `diameter` [m]."""
    return mass_height


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

    V = sqrt(2 g R (1 - cos alpha_c) (k^2 + R^2))/z_c, cos alpha_c = z_c/R, with the height z_c of
    the centre, its distance R from the edge and the radius of gyration k: the angular momentum
    about the edge is kept, and lifts the centre above the edge. R - z_c is written as b^2/(R +
    z_c), b being half the base.
    """
    lift = 2 * gravity / (edge_distance + standing_centre)
    turning = hypot(gyration, edge_distance)
    return standing_base / standing_centre * np.sqrt(lift) * turning


def pulse_angle(*, rocking_rate: Array, frequency: Array) -> Array:
    """Return the phase of a half-sine pulse at which a part begins to rock that just topples [rad].

    It gives the least acceleration of a pulse of circular frequency w (`frequency` in Hz) that
    topples a standing part with `rocking_rate` p [rad s-1]: with q = p/w the root psi of q (exp(-q
    (pi - psi)) + cos psi) = sin psi, by Newton's method on psi = phi + asin(sin(phi) exp(-q (pi -
    psi))), phi = atan(q) (theory 16.2).
    """
    q = rocking_rate / (2 * np.pi * frequency)
    phi = np.arctan(q)
    sine = q / np.sqrt(1 + q * q)
    psi = phi
    for _ in range(MAX_STEPS):
        x = sine * np.exp(-q * (np.pi - psi))
        root = np.sqrt((1 - x) * (1 + x))
        psi = psi - (psi - phi - np.arctan2(x, root)) / (1 - q * x / root)
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

    A part at rest begins to rock, or to slide, only if this exceeds its limit. With s = sin(w t), P
    = A w^2 and w = 2 pi f, D = P cos(beta) s - g sin(gamma) over n = g cos(gamma) - P sin(beta) s
    is monotonic in s, so that the ends s = -1 and 1 count. Infinite where the part leaves the
    floor. Arguments in Hz, m, rad, rad and m s-2.
    """
    drive = np.square(2 * np.pi * frequency) * amplitude
    along, normal = drive * cosine(beta), drive * sine(beta)
    down, onto = gravity * sine(gamma), gravity * cosine(gamma)
    stays = onto > np.abs(normal)
    forth, back = np.where(stays, onto - normal, 1.0), np.where(stays, onto + normal, 1.0)
    push = np.maximum(np.abs(along - down) / forth, np.abs(along + down) / back)
    return np.where(stays, push, np.inf)


def rocking_margin(
    *, rocking_friction: Array, friction_static: Array, push_over_load: Array
) -> Array:
    """Return the floor's push beyond that which rocks a part, min(mu_s, |D|/n) - b/z_c [1].

    It is over the load: push |D|/n in a period (`push_over_load`), half base b and height z_c of
    the centre. Where it is not above 0, the part never rocks, however long the shaking lasts. A
    part that begins to rock need not topple.
    """
    return np.minimum(friction_static, push_over_load) - rocking_friction


def never_rocks(*, rocking_margin: Array) -> Mask:
    """True where a part does not even begin to rock."""
    return rocking_margin <= 0


def may_topple(*, topple_margin: Array, amplitude: Array, standing_base: Array) -> Mask:
    """True where shaking may topple a part: no margin, or an amplitude near half its base."""
    return (topple_margin <= 0) | (FAR * amplitude > standing_base)
