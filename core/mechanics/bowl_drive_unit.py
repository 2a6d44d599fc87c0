"""A drive unit of bowl and base, leaves on a circle of radius r_s, tilted by th (theory 15.3)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.angles import cosine, sine
from vibrafeed.core.mechanics.arrays import Array, hypot
from vibrafeed.core.mechanics.drive_unit import second_over_first


def bowl_mass_empty(
    *, moving_mass: Array, base_mass: Array, moving_inertia: Array, base_inertia: Array,
    spring_radius: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the moved mass of the empty unit, I_r (cos th/r_s)^2 + m_r sin^2 th [kg].

    The leaf springs stand on a circle of radius r_s (`spring_radius`), tilted by th
    (`spring_angle`). The bowl turns by Theta and lifts by r_s tan(th) Theta; the stroke of the
    leaves is s = r_s Theta/cos(th). m_r = m1 m2/(m1 + m2) of bowl and base, and I_r alike of their
    moments of inertia. With the stiffness k of the leaves, this mass gives the natural frequency.
    """
    return _bowl_mass(
        moving_mass, base_mass, moving_inertia, base_inertia, spring_radius, spring_angle
    )


def bowl_mass(
    *, loaded_mass: Array, base_mass: Array, loaded_inertia: Array, base_inertia: Array,
    spring_radius: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the moved mass of the loaded unit, I_r (cos th/r_s)^2 + m_r sin^2 th [kg].

    r_s and th are radius and tilt of the leaf springs (`spring_radius`, `spring_angle`); m_r = m1
    m2/(m1 + m2) of the loaded bowl and the base, and I_r alike of their moments of inertia.
    """
    return _bowl_mass(
        loaded_mass, base_mass, loaded_inertia, base_inertia, spring_radius, spring_angle
    )


def _bowl_mass(m1: Array, m2: Array, i1: Array, i2: Array, r_s: Array, th: Array) -> Array:
    """Return the mass that the stroke moves, I (cos th/r_s)^2 + m sin^2 th [kg].

    `m1`, `i1` are mass [kg] and moment of inertia [kg m2] of the bowl, `m2`, `i2` those of the
    base, `r_s` [m] and `th` [rad] radius and tilt of the leaves; m = m1 m2/(m1 + m2), I = i1 i2/(i1
    + i2).
    """
    turning, lifting = i1 * (i2 / (i1 + i2)), m1 * (m2 / (m1 + m2))
    return turning * np.square(cosine(th) / r_s) + lifting * np.square(sine(th))


def load_radius(*, radius: Array) -> Array:
    """Return the radius at which the load acts, equal to the part's radius by default [m]."""
    return radius


def loaded_inertia(*, moving_inertia: Array, load_mass: Array, load_radius: Array) -> Array:
    """Return the inertia with a load that keeps to the track, I1 + m_l R_l^2 [kg m2]."""
    return moving_inertia + load_mass * np.square(load_radius)


def bowl_frequency(*, spring_stiffness: Array, bowl_mass: Array) -> Array:
    """Return the natural frequency of the bowl, the base free, sqrt(k/m)/(2 pi) [Hz]."""
    return np.sqrt(spring_stiffness / bowl_mass) / (2 * np.pi)


def bowl_response(
    *, drive_force: Array, circular_frequency: Array, spring_stiffness: Array, damping: Array,
    loaded_mass: Array, base_mass: Array, loaded_inertia: Array, base_inertia: Array,
    load_damping: Array, load_radius: Array, spring_radius: Array, spring_angle: Array,
) -> tuple[Array, Array, Array, Array]:  # fmt: skip
    """Return the stroke of the leaf springs and the shares of turn and lift that the bowl makes.

    Four arrays: real and imaginary part of s in s e^(iwt) for the force F cos(wt) [m], then the
    bowl's share of the relative turn, |I2/(I1 + I2)|, and of the relative lift, |m2/(m1 + m2)| [1].
    The amplitude of the bowl follows from them.

    s = F/(k - m w^2 + i w c), m = I_r (cos th/r_s)^2 + m_r sin^2 th with the reduced masses and
    inertias of bowl (1) and base (2), spring stiffness k, damping c, leaves at radius r_s with tilt
    th. A damper c_l (`load_damping` [N s m-1]) from the load's radius R_l to the ground makes m1
    the mass m1 - i c_l/w, I1 the inertia I1 - i c_l R_l^2/w. Arguments in SI units, w in rad s-1
    (theory 15.3).
    """
    w = circular_frequency
    lost = load_damping / w
    turning, turning_lost, turn = _reduced(
        loaded_inertia, lost * np.square(load_radius), base_inertia
    )
    lifting, lifting_lost, lift = _reduced(loaded_mass, lost, base_mass)
    of_turn, of_lift = (
        np.square(cosine(spring_angle) / spring_radius),
        np.square(sine(spring_angle)),
    )
    real = spring_stiffness - (turning * of_turn + lifting * of_lift) * w * w
    imag = w * damping + (turning_lost * of_turn + lifting_lost * of_lift) * w * w
    size = hypot(real, imag)
    share = drive_force / size
    return share * (real / size), -share * (imag / size), turn, lift


def bowl_harmonic(
    *, force_harmonic: Array, circular_frequency: Array, spring_stiffness: Array, damping: Array,
    loaded_mass: Array, base_mass: Array, loaded_inertia: Array, base_inertia: Array,
    load_damping: Array, load_radius: Array, spring_radius: Array, spring_angle: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Return sine and cosine part of the track's second harmonic, over its first, of a bowl [1].

    The displacement is A (sin(tau) + s sin(2 tau) + c cos(2 tau)): the result is s and c, with
    which a part is driven by a magnet on a half wave. `force_harmonic` is the second harmonic of
    its force over the first; the other arguments are those of `bowl_response` in SI units. Turn and
    lift of the bowl are taken to keep one proportion in both harmonics: exact without a damper from
    track to ground (theory 15.5).
    """
    at = [
        bowl_response(
            drive_force=1.0 + 0.0 * circular_frequency, circular_frequency=w,
            spring_stiffness=spring_stiffness, damping=damping, loaded_mass=loaded_mass,
            base_mass=base_mass, loaded_inertia=loaded_inertia, base_inertia=base_inertia,
            load_damping=load_damping, load_radius=load_radius, spring_radius=spring_radius,
            spring_angle=spring_angle,
        )[:2]
        for w in (circular_frequency, 2.0 * circular_frequency)
    ]  # fmt: skip
    return second_over_first(force_harmonic, *at)


def _reduced(mass: Array, lost: Array, other: Array) -> tuple[Array, Array, Array]:
    """Return real part and loss of a reduced mass with a damper, and body 1's share of the motion.

    The reduced mass is m1 m2/(m1 + m2) = real part - i loss [kg, or kg m2 for inertias], with the
    complex m1 = `mass` - i `lost`, where `lost` = c/w of a damper c to the ground, and m2 =
    `other`; the share is |m2/(m1 + m2)| [1] (theory 15.3).
    """
    total = mass + other
    size = hypot(total, lost)
    share = other / size
    return share * (mass * (total / size) + lost * (lost / size)), share * share * lost, share


def bowl_turn(
    *, stroke: Array, stroke_response: tuple[Array, ...], spring_angle: Array, spring_radius: Array
) -> Array:
    """Return the amplitude of the bowl's own turning, s cos(th)/r_s I2/(I1 + I2) [rad].

    s is the stroke of the leaf springs [m], th and r_s their tilt and radius, and I2/(I1 + I2) the
    third entry of `stroke_response`: the bowl's share of the turn between bowl and base.
    """
    return stroke * cosine(spring_angle) / spring_radius * stroke_response[2]


def bowl_lift(*, stroke: Array, stroke_response: tuple[Array, ...], spring_angle: Array) -> Array:
    """Return the amplitude of the bowl's own lift, s sin(th) m2/(m1 + m2), at every radius [m].

    s is the stroke of the leaf springs [m], th their tilt, and m2/(m1 + m2) the fourth entry of
    `stroke_response`: the bowl's share of the lift between bowl and base.
    """
    return stroke * sine(spring_angle) * stroke_response[3]


def bowl_amplitude(*, radius: Array, bowl_turn: Array, bowl_lift: Array) -> Array:
    """Return the amplitude of the track at its radius, hypot(r Theta_1, z_1) [m]."""
    return hypot(radius * bowl_turn, bowl_lift)


def bowl_angle(*, radius: Array, bowl_turn: Array, bowl_lift: Array, gamma: Array) -> Array:
    """Return the angle of the vibration above the track, atan(z_1/(r Theta_1)) - gamma [rad].

    z_1 and Theta_1 are the amplitudes of the bowl's lift [m] and turn [rad], r the radius of the
    track and gamma its climb. It is the tilt of the leaf springs only where the base is held and r
    is theirs.
    """
    return np.arctan2(bowl_lift, radius * bowl_turn) - gamma


# --- The track of a bowl: stretches of spirals, one after another from its start to the exit.
#
# In a stretch the radius grows in proportion to the turned angle (spiral of Archimedes), and the
# track climbs at one angle. Its length is that of the turn, 2 pi n r/cos(gamma); what the growth of
# the radius adds, (dr/(2 pi n r))^2/2 of it, is left out: 1e-4 of a usual bowl (theory 15.6).


class Stretches(NamedTuple):
    """The stretches of a track, from its start to its exit; tuples with an entry a stretch.

    Attributes
    ----------
    start, end : tuple of ndarray
        Radius at both ends [m].
    length : tuple of ndarray
        Length along the track [m].
    """

    start: tuple[Array, ...]
    end: tuple[Array, ...]
    length: tuple[Array, ...]


def stretches_of(
    start_radius: Array, radii: Sequence[Array], turns: Sequence[Array], climbs: Sequence[Array]
) -> Stretches:
    """Return the stretches of a bowl's track: their radii at both ends and their lengths [m].

    `radii` are those at the end of each stretch [m]; a stretch begins where the one before ends,
    the first at `start_radius` [m]. `turns` are turns n about the bowl, `climbs` angles gamma
    [rad]. The length of a stretch from radius r_1 to r_2 is pi n (r_1 + r_2)/cos(gamma) (theory
    15.6).
    """
    starts = (start_radius, *radii[:-1])
    lengths = tuple(
        np.pi * count * (first + last) / cosine(climb)
        for first, last, count, climb in zip(starts, radii, turns, climbs, strict=True)
    )
    return Stretches(tuple(starts), tuple(radii), lengths)


def total_length(stretches: Stretches) -> Array:
    """Return the length of the track [m]."""
    total: Array = sum(stretches.length[1:], stretches.length[0])
    return total


def bounds(stretches: Stretches) -> list[Array]:
    """Return the shares of the track's length at which stretches begin, then 1 for the exit [1].

    From the lengths of the `stretches`, in the order of travel. One array more than there are
    stretches; the first is 0.
    """
    total, passed = total_length(stretches), [0.0 * stretches.length[0]]
    for length in stretches.length:
        passed.append(passed[-1] + length)
    return [one / total for one in passed[:-1]] + [np.ones_like(total)]


def radius_at(fraction: Array, stretches: Stretches) -> Array:
    """Return the radius of the track at a share of its length [m].

    `fraction` is that share, 0 at the start and 1 at the exit. On a stretch from radius r_1 to r_2,
    r^2 = r_1^2 + (r_2^2 - r_1^2) x at the share x of its own length, since dr ~ dphi and ds ~ r
    dphi.
    """
    ends = bounds(stretches)
    radii = []
    for first, last, low, high in zip(
        stretches.start, stretches.end, ends[:-1], ends[1:], strict=True
    ):
        x = np.clip((fraction - low) / (high - low), 0.0, 1.0)
        radii.append(np.sqrt(np.square(first) + (np.square(last) - np.square(first)) * x))
    return picked(fraction, stretches, radii)


def picked(fraction: Array, stretches: Stretches, values: Sequence[Array]) -> Array:
    """Return the value, of one a stretch, that holds at a place of a bowl's track.

    `fraction` is the place as a share of the track's length, 0 to 1; `values` has an array for each
    of the `stretches` (climb, friction, ...). Where two stretches meet, the later one holds.
    """
    value = values[0]
    for low, later in zip(bounds(stretches)[1:-1], values[1:], strict=True):
        value = np.where(fraction >= low, later, value)
    return np.asarray(value)
