"""A drive unit whose line misses its mass centres: trough and base turn together (theory 15.2)."""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics.angles import cosine, sine
from vibrafeed.core.mechanics.arrays import Array, hypot
from vibrafeed.core.mechanics.drive_unit import second_over_first


def turning_mass_empty(
    *, moving_mass: Array, base_mass: Array, moving_inertia: Array, base_inertia: Array,
    offset_along: Array, offset_upward: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the mass that the stroke of the empty unit moves, m_r - m_r^2 (d x e)^2/I_t [kg].

    m_r - m_r^2 (d x e)^2/I_t = m_r (I1 + I2 + m_r (d.e)^2)/I_t, with m_r = m1 m2/(m1 + m2) of
    trough (1) and base (2), from which the natural frequency follows. d (`offset_along`,
    `offset_upward`, [m]) leads from the base's mass centre to the trough's, e is the unit vector
    along the stroke at `spring_angle` [rad]; I_t = I1 + I2 + m_r d^2 with the moments of inertia
    [kg m2] (theory 15.2).
    """
    m_r = moving_mass * (base_mass / (moving_mass + base_mass))
    _, inertia = _arm(m_r, moving_inertia, base_inertia, offset_along, offset_upward, spring_angle)
    # d^2 - (d x e)^2 = (d.e)^2: the difference cancels where the masses are light to turn.
    reach = offset_along * cosine(spring_angle) + offset_upward * sine(spring_angle)
    return m_r * ((moving_inertia + base_inertia + m_r * reach * reach) / inertia)


def turning_mass(
    *, loaded_mass: Array, base_mass: Array, moving_inertia: Array, base_inertia: Array,
    offset_along: Array, offset_upward: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the mass that the stroke of a loaded drive unit moves, if its masses turn [kg].

    m_r - m_r^2 (d x e)^2/I_t, less than the reduced mass m_r = m1 m2/(m1 + m2) of loaded trough (1)
    and base (2), as both also turn. d (`offset_along`, `offset_upward`, [m]) leads from the base's
    mass centre to the trough's; e is the unit vector along the stroke, at the angle `spring_angle`
    [rad]; I_t = I1 + I2 + m_r d^2 [kg m2]. The load is taken at the trough's mass centre (theory
    15.2).
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

    s in s e^(iwt) for the force F cos(wt): s = F/(k - m w^2 + i w c), with F the `drive_force` [N],
    k and c stiffness and damping of the leaves [N m-1, N s m-1], m the mass that the stroke moves
    (`turning_mass` [kg]), w the circular frequency [rad s-1] (theory 15.2).
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
    trough along one line: on a free base the turn goes with the stroke. `turning_mass` is the mass
    that the stroke moves [kg].
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

    Positive up in front: -(m_r/I_t) (d x e) s, with the `stroke` s [m] along the unit vector e at
    `spring_angle` [rad], m_r = m1 m2/(m1 + m2) of loaded trough and base [kg], d (`offset_along`,
    `offset_upward`, [m]) from the base's mass centre to the trough's, and I_t = I1 + I2 + m_r d^2
    [kg m2] (theory 15.2).
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
    """Return the amplitudes of a spot of a turning trough along the floor and upward, signed [m].

    (m2/M) (s e + phi k x d) + phi k x b, with the mass m2 of the base and M of both [kg], the
    `stroke` s [m] along e at the angle `spring_angle` [rad], and the trough's turning phi [rad],
    positive up in front; k is the unit vector to the left, about which it turns. The `offset` d
    leads from the base's mass centre to the trough's, the `spot` b from the trough's mass centre to
    the spot, both [m] (theory 15.2).
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
