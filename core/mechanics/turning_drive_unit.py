"""A drive unit whose line misses its mass centres: trough and base turn together (theory 15.2)."""

from __future__ import annotations

import numpy as np

from core.mechanics.angles import cosine, sine
from core.mechanics.arrays import Array, hypot
from core.mechanics.drive_unit import second_over_first


def turning_mass_empty(
    *, moving_mass: Array, base_mass: Array, moving_inertia: Array, base_inertia: Array,
    offset_along: Array, offset_upward: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the mass that the stroke of the empty unit moves, m_r - m_r^2 (d x e)^2/I_t [kg].

    m_r = m1 m2/(m1 + m2) of trough and base. d (`offset_*`) leads from the base's mass centre to
    the trough's, e is the unit vector along the stroke at `spring_angle`; I_t = I1 + I2 + m_r d^2.
    """
    m_r = moving_mass * (base_mass / (moving_mass + base_mass))
    arm, inertia = _arm(
        m_r, moving_inertia, base_inertia, offset_along, offset_upward, spring_angle
    )
    return m_r * (1.0 - arm * arm * (m_r / inertia))


def turning_mass(
    *, loaded_mass: Array, base_mass: Array, moving_inertia: Array, base_inertia: Array,
    offset_along: Array, offset_upward: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the mass that the stroke of the loaded unit moves, load at the mass centre [kg].

    m_r - m_r^2 (d x e)^2/I_t, with m_r = m1 m2/(m1 + m2) of the loaded trough and the base; d
    (`offset_*`) leads from the base's mass centre to the trough's, e is the unit vector along the
    stroke; I_t = I1 + I2 + m_r d^2.
    """
    return turning_mass_empty(
        moving_mass=loaded_mass, base_mass=base_mass, moving_inertia=moving_inertia,
        base_inertia=base_inertia, offset_along=offset_along, offset_upward=offset_upward,
        spring_angle=spring_angle,
    )  # fmt: skip


def _arm(
    m_r: Array, i1: Array, i2: Array, along: Array, upward: Array, th: Array
) -> tuple[Array, Array]:
    """Return the lever d x e of the drive [m] and the total moment of inertia I_t [kg m2].

    d is (`along`, `upward`), from the base's mass centre to the trough's, e the unit vector at the
    angle `th`; `m_r` is the reduced mass, `i1` and `i2` are both moments of inertia: I_t = i1 + i2
    + m_r d^2.
    """
    arm = along * sine(th) - upward * cosine(th)
    return arm, i1 + i2 + m_r * (along * along + upward * upward)


def turning_frequency(*, spring_stiffness: Array, turning_mass: Array) -> Array:
    """Return the natural frequency of a unit that turns, sqrt(k/m)/(2 pi) [Hz]."""
    return np.sqrt(spring_stiffness / turning_mass) / (2 * np.pi)


def turning_response(
    *, drive_force: Array, circular_frequency: Array, spring_stiffness: Array, damping: Array,
    turning_mass: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Return real and imaginary part of the stroke, s = F/(k - m w^2 + i w c) [m].

    F is the drive's force, k and c stiffness and damping of the leaves, m the mass that the stroke
    moves (`turning_mass`), w the circular frequency.
    """
    w = circular_frequency
    real, imag = spring_stiffness - turning_mass * w * w, w * damping
    size = hypot(real, imag)
    share = drive_force / size
    return share * (real / size), -share * (imag / size)


def turning_harmonic(
    *, force_harmonic: Array, circular_frequency: Array, spring_stiffness: Array, damping: Array,
    turning_mass: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Return sine and cosine part, at 2 tau, of the track's second harmonic over its first [1].

    tau is the phase in which the first harmonic of the displacement is A sin(tau), `force_harmonic`
    the second harmonic of the magnet's force over its first. Both harmonics move a spot of the
    trough along one line: on a free base the turn goes with the stroke.
    """
    at = [
        turning_response(
            drive_force=1.0 + 0.0 * circular_frequency, circular_frequency=w,
            spring_stiffness=spring_stiffness, damping=damping, turning_mass=turning_mass,
        )
        for w in (circular_frequency, 2.0 * circular_frequency)
    ]  # fmt: skip
    return second_over_first(force_harmonic, *at)


def trough_turn(
    *, stroke: Array, loaded_mass: Array, base_mass: Array, moving_inertia: Array,
    base_inertia: Array, offset_along: Array, offset_upward: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the amplitude of the trough's turning, up in front, -(m_r/I_t) (d x e) s [rad].

    s is the stroke [m], m_r = m1 m2/(m1 + m2), d (`offset_*`) leads from the base's mass centre to
    the trough's, e is the unit vector along the stroke, I_t = I1 + I2 + m_r d^2.
    """
    m_r = loaded_mass * (base_mass / (loaded_mass + base_mass))
    arm, inertia = _arm(
        m_r, moving_inertia, base_inertia, offset_along, offset_upward, spring_angle
    )
    return -(m_r / inertia) * arm * stroke


def turning_track(
    *, stroke: Array, trough_turn: Array, loaded_mass: Array, base_mass: Array,
    offset_along: Array, offset_upward: Array, spot_along: Array, spot_upward: Array,
    spring_angle: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Return the amplitudes of a spot of the trough along the floor and upward, with sign [m].

    (m2/M) (s e + phi k x d) + phi k x b, with the mass m2 of the base and M of both, the stroke s
    along the leaves' direction e, and the turning phi, positive up in front (`trough_turn`); k is
    the unit vector to the left, about which it turns. The `offset` d leads from the base's mass
    centre to the trough's, the `spot` b from the trough's mass centre to the spot.
    """
    share, phi = base_mass / (loaded_mass + base_mass), trough_turn
    along = share * (stroke * cosine(spring_angle) - phi * offset_upward) - phi * spot_upward
    upward = share * (stroke * sine(spring_angle) + phi * offset_along) + phi * spot_along
    return along, upward


def turning_amplitude(*, track_motion: tuple[Array, Array]) -> Array:
    """Return the amplitude of the track at its place [m]."""
    return hypot(*track_motion)


def turning_angle(*, track_motion: tuple[Array, Array], gamma: Array) -> Array:
    """Return the angle of the vibration above the track at its place [rad]."""
    return np.arctan2(track_motion[1], track_motion[0]) - gamma
