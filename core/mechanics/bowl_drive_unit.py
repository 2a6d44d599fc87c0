"""A drive unit of bowl and base, leaves on a circle of radius r_s, tilted by th (theory 15.3)."""

from __future__ import annotations

import numpy as np

from core.mechanics.angles import cosine, sine
from core.mechanics.arrays import Array, hypot
from core.mechanics.drive_unit import second_over_first


def bowl_mass_empty(
    *, moving_mass: Array, base_mass: Array, moving_inertia: Array, base_inertia: Array,
    spring_radius: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the mass of the stroke, I_r (cos th/r_s)^2 + m_r sin^2 th, of the empty unit [kg].

    The bowl turns by Theta and lifts by r_s tan(th) Theta; its stroke at the leaves is
    s = r_s Theta/cos(th). I_r and m_r are reduced, as of two masses.
    """
    return _bowl_mass(
        moving_mass, base_mass, moving_inertia, base_inertia, spring_radius, spring_angle
    )


def bowl_mass(
    *, loaded_mass: Array, base_mass: Array, loaded_inertia: Array, base_inertia: Array,
    spring_radius: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the mass of the stroke with the load, I_r (cos th/r_s)^2 + m_r sin^2 th [kg]."""
    return _bowl_mass(
        loaded_mass, base_mass, loaded_inertia, base_inertia, spring_radius, spring_angle
    )


def _bowl_mass(m1: Array, m2: Array, i1: Array, i2: Array, r_s: Array, th: Array) -> Array:
    """Return the mass of the stroke, I (cos th/r_s)^2 + m sin^2 th, I and m reduced [kg]."""
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
    """Return the stroke s (real, imaginary) and the bowl's share of turn and lift (sizes) [m, 1].

    s = F/(k - m w^2 + i w c), m = I_r (cos th/r_s)^2 + m_r sin^2 th, as of two masses and inertias;
    a damper c_l from the load's place to the ground makes m1 the mass m1 - i c_l/w, I1 the inertia
    I1 - i c_l R_l^2/w. The shares are I2/(I1 + I2) and m2/(m1 + m2).
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
    """Return the second harmonic of the track over its first, as sine and cosine at 2 tau [1].

    Turn and lift keep their proportion, on a free base to what a damper from the track takes.
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
    """Return the reduced mass of m1 - i lost and m2 (real part, loss), and |m2/(m + m2)|."""
    total = mass + other
    size = hypot(total, lost)
    share = other / size
    return share * (mass * (total / size) + lost * (lost / size)), share * share * lost, share


def bowl_turn(
    *, stroke: Array, stroke_response: tuple[Array, ...], spring_angle: Array, spring_radius: Array
) -> Array:
    """Return the amplitude of the bowl's own turning, s cos(th)/r_s I2/(I1 + I2) [rad]."""
    return stroke * cosine(spring_angle) / spring_radius * stroke_response[2]


def bowl_lift(*, stroke: Array, stroke_response: tuple[Array, ...], spring_angle: Array) -> Array:
    """Return the amplitude of the bowl's own lift, s sin(th) m2/(m1 + m2), at every radius [m]."""
    return stroke * sine(spring_angle) * stroke_response[3]


def bowl_amplitude(*, radius: Array, bowl_turn: Array, bowl_lift: Array) -> Array:
    """Return the amplitude of the track at its radius, hypot(r Theta_1, z_1) [m]."""
    return hypot(radius * bowl_turn, bowl_lift)


def bowl_angle(*, radius: Array, bowl_turn: Array, bowl_lift: Array, gamma: Array) -> Array:
    """Return the angle of the vibration above the track, atan(z_1/(r Theta_1)) - gamma [rad].

    tan = (r_s/r) tan(th) m2/(m1 + m2) (I1 + I2)/I2: that of the leaves only where the base is held.
    """
    return np.arctan2(bowl_lift, radius * bowl_turn) - gamma
