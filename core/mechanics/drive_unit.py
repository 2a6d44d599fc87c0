"""Drive units: two masses on leaf springs, driven by a magnet or an unbalance (theory 15).

A moving mass m1 (trough or bowl) and a base m2, joined by guided leaf springs of stiffness k; the
base stands on feet. Small harmonic motion in its steady state, one harmonic, no resonance of leaf
or bowl by itself. The relative stroke s runs along the line that the leaves guide; amplitudes are
from zero to peak. Arrays broadcast; SI units, angles in radians.
"""

from __future__ import annotations

import numpy as np

from core.mechanics.angles import cosine, sine
from core.mechanics.arrays import Array, Mask, hypot

VACUUM_PERMEABILITY = 1.25663706127e-6  # N A-2, CODATA 2022


def circular_frequency(*, frequency: Array) -> Array:
    """Return the circular frequency of the drive, w = 2 pi f [rad s-1]."""
    return 2 * np.pi * frequency


def leaf_stiffness(
    *, spring_count: Array, elastic_modulus: Array, spring_width: Array, spring_thickness: Array,
    spring_length: Array, clamp_factor: Array,
) -> Array:  # fmt: skip
    """Return the stiffness of leaves whose ends stay parallel, k = c_k n E b (t/L)^3 [N m-1].

    A leaf clamped at both ends is two cantilevers of L/2: 12 E I/L^3 with I = b t^3/12. The free
    length L is that between the clamps; c_k tells how much real clamps give.
    """
    slenderness = spring_thickness / spring_length
    cube = slenderness * slenderness * slenderness
    return clamp_factor * spring_count * elastic_modulus * spring_width * cube


def spring_stress(
    *, elastic_modulus: Array, spring_thickness: Array, spring_length: Array, stroke: Array
) -> Array:
    """Return the bending stress at the clamps of a leaf, sigma = 3 E t s/L^2 [Pa]."""
    return 3 * elastic_modulus * (spring_thickness / spring_length) * (stroke / spring_length)


def stress_margin(*, allowable_stress: Array, spring_stress: Array) -> Array:
    """Return what is left up to the allowable stress; below 0 it is exceeded [Pa]."""
    return allowable_stress - spring_stress


def air_gap_margin(*, air_gap: Array, stroke: Array) -> Array:
    """Return what is left of the magnet's air gap at the end of the stroke [m]."""
    return air_gap - stroke


def unbalance_force(*, unbalance: Array, circular_frequency: Array) -> Array:
    """Return the amplitude of the force of a turning unbalance, F = m_u r w^2 [N]."""
    return unbalance * circular_frequency * circular_frequency


def magnet_force(*, flux_density: Array, pole_area: Array) -> Array:
    """Return the force of a magnet at the drive's frequency, F = B^2 A/(4 mu_0) [N].

    B is the peak of the flux density in the gap, A the area of all poles. The pull B^2 A/(2 mu_0)
    swings by its half at twice the line's frequency (full wave), or at the line's (half wave).
    """
    return flux_density * flux_density * pole_area / (4 * VACUUM_PERMEABILITY)


def reduced_mass(*, moving_mass: Array, base_mass: Array) -> Array:
    """Return the reduced mass of the empty unit, m_r = m1 m2/(m1 + m2) [kg]."""
    return moving_mass * (base_mass / (moving_mass + base_mass))


def loaded_mass(*, moving_mass: Array, load_mass: Array) -> Array:
    """Return the moving mass with a load that keeps to the track, m1 + m_l [kg]."""
    return moving_mass + load_mass


def tuned_stiffness(*, ring_down_frequency: Array, generalised_mass: Array) -> Array:
    """Return the stiffness by the frequency f_0 of a ring-down, k = (2 pi f_0)^2 m [N m-1].

    The unit is empty. m is the mass that its stroke moves; the base stands free.
    """
    w = 2 * np.pi * ring_down_frequency
    return w * w * generalised_mass


def damping(*, damping_ratio: Array, spring_stiffness: Array, generalised_mass: Array) -> Array:
    """Return the damper beside the springs, c = 2 zeta sqrt(k m), m of the empty unit [N s m-1]."""
    return 2 * damping_ratio * np.sqrt(spring_stiffness * generalised_mass)


def natural_frequency(
    *, spring_stiffness: Array, foot_stiffness: Array, loaded_mass: Array, base_mass: Array
) -> Array:
    """Return the frequency of the mode that the springs make, without damping [Hz].

    The higher root of m1 m2 w^4 - (k (m1 + m2) + k_f m1) w^2 + k k_f = 0; with free feet
    w^2 = k (m1 + m2)/(m1 m2).
    """
    upper, _ = _squares(spring_stiffness, foot_stiffness, loaded_mass, base_mass)
    return np.sqrt(upper) / (2 * np.pi)


def foot_frequency(
    *, spring_stiffness: Array, foot_stiffness: Array, loaded_mass: Array, base_mass: Array
) -> Array:
    """Return the frequency of the whole unit on its feet, the lower root; 0 with free feet [Hz]."""
    _, lower = _squares(spring_stiffness, foot_stiffness, loaded_mass, base_mass)
    return np.sqrt(lower) / (2 * np.pi)


def _squares(k: Array, k_f: Array, m1: Array, m2: Array) -> tuple[Array, Array]:
    """Return the squares w^2 of both modes; the lower one from their product, k k_f/(m1 m2)."""
    half = (k * (m1 + m2) + k_f * m1) / 2
    product = (m1 * m2) * (k * k_f)
    # half^2 - product = (k (m1 + m2) - k_f m1)^2/4 + k k_f m1^2: never below 0.
    apart = (k * (m1 + m2) - k_f * m1) / 2
    root = hypot(apart, m1 * np.sqrt(k * k_f))
    upper = (half + root) / (m1 * m2)
    return upper, product / ((half + root) * (m1 * m2))


def stroke_response(
    *, drive_force: Array, circular_frequency: Array, spring_stiffness: Array, damping: Array,
    foot_stiffness: Array, foot_damping: Array, loaded_mass: Array, load_damping: Array,
    base_mass: Array,
) -> tuple[Array, Array, Array, Array]:  # fmt: skip
    """Return the strokes s (real and imaginary), X1 and X2 of both masses (sizes) [m].

    Force and stroke are the real parts of F e^(iwt) and s e^(iwt). With Z = k + i w c of the
    springs, Z_f = k_f + i w c_f of the feet, a = m1 w^2 - i w c_l of the moving mass and of the
    damper from it to the ground, b = m2 w^2, P = Z_f - b, Q = P - a:
    s = F Q/D, X1 = F P/D, X2 = F a/D, D = Z Q - a P.
    """
    w = circular_frequency
    a_real, a_imag = loaded_mass * w * w, -w * load_damping
    p_real, p_imag = foot_stiffness - base_mass * w * w, w * foot_damping
    q_real, q_imag = p_real - a_real, p_imag - a_imag
    z_real, z_imag = spring_stiffness, w * damping
    d_real = z_real * q_real - z_imag * q_imag - (a_real * p_real - a_imag * p_imag)
    d_imag = z_real * q_imag + z_imag * q_real - (a_real * p_imag + a_imag * p_real)
    size = hypot(d_real, d_imag)
    d_real, d_imag = d_real / size, d_imag / size
    share = drive_force / size
    return (
        share * (q_real * d_real + q_imag * d_imag),
        share * (q_imag * d_real - q_real * d_imag),
        share * hypot(p_real, p_imag),
        share * hypot(a_real, a_imag),
    )


def stroke(*, stroke_response: tuple[Array, ...]) -> Array:
    """Return the amplitude of the stroke between both masses, along the line of the leaves [m]."""
    return hypot(stroke_response[0], stroke_response[1])


def phase(*, stroke_response: tuple[Array, ...]) -> Array:
    """Return the phase of the stroke behind the force, from 0 to -pi [rad]."""
    return np.arctan2(stroke_response[1], stroke_response[0])


def amplification(*, stroke: Array, spring_stiffness: Array, drive_force: Array) -> Array:
    """Return the amplification, k s/F: the stroke over that of the same force at rest."""
    return stroke * spring_stiffness / drive_force


def second_harmonic(
    *, force_harmonic: Array, circular_frequency: Array, spring_stiffness: Array, damping: Array,
    foot_stiffness: Array, foot_damping: Array, loaded_mass: Array, load_damping: Array,
    base_mass: Array,
) -> Array:  # fmt: skip
    """Return the second harmonic of the track's acceleration over the first, 4 A_2/A_1 [1].

    Of a force whose second harmonic is F_2/F_1 of its first; the response is that at 2 w.
    """
    of_both = {
        "drive_force": 1.0 + 0.0 * circular_frequency, "spring_stiffness": spring_stiffness,
        "damping": damping, "foot_stiffness": foot_stiffness, "foot_damping": foot_damping,
        "loaded_mass": loaded_mass, "load_damping": load_damping, "base_mass": base_mass,
    }  # fmt: skip
    first = stroke_response(circular_frequency=circular_frequency, **of_both)[2]
    second = stroke_response(circular_frequency=2.0 * circular_frequency, **of_both)[2]
    return 4.0 * force_harmonic * (second / first)


def floor_force(
    *, stroke_response: tuple[Array, ...], circular_frequency: Array, foot_stiffness: Array,
    foot_damping: Array,
) -> Array:  # fmt: skip
    """Return the amplitude of the force of the feet on the floor, |k_f + i w c_f| X2 [N]."""
    return hypot(foot_stiffness, circular_frequency * foot_damping) * stroke_response[3]


def drive_unit_power(
    *, drive_force: Array, circular_frequency: Array, stroke_response: tuple[Array, ...]
) -> Array:
    """Return the mean power of the force, -F w Im(s)/2 [W]."""
    return -drive_force * circular_frequency * stroke_response[1] / 2


# --- linear: leaves tilted from the vertical by the angle of the line above the horizontal


def linear_amplitude(*, stroke_response: tuple[Array, ...]) -> Array:
    """Return the amplitude of the track, X1 [m]."""
    return stroke_response[2]


def linear_angle(*, spring_angle: Array, gamma: Array) -> Array:
    """Return the angle of the vibration above the track, th - gamma [rad]."""
    return spring_angle - gamma


# --- linear, where the line of action misses a mass centre: both masses turn, the base is free


def turning_mass_empty(
    *, moving_mass: Array, base_mass: Array, moving_inertia: Array, base_inertia: Array,
    offset_along: Array, offset_upward: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the mass of the stroke, m_r - m_r^2 (d x e)^2/I_t, of the empty unit [kg].

    d leads from the base's mass centre to the moving one's, e along the stroke;
    I_t = I1 + I2 + m_r d^2.
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
    """Return the mass of the stroke with a load at the mass centre [kg]."""
    return turning_mass_empty(
        moving_mass=loaded_mass, base_mass=base_mass, moving_inertia=moving_inertia,
        base_inertia=base_inertia, offset_along=offset_along, offset_upward=offset_upward,
        spring_angle=spring_angle,
    )  # fmt: skip


def _arm(
    m_r: Array, i1: Array, i2: Array, along: Array, upward: Array, th: Array
) -> tuple[Array, Array]:
    """Return d x e and I_t."""
    arm = along * sine(th) - upward * cosine(th)
    return arm, i1 + i2 + m_r * (along * along + upward * upward)


def turning_frequency(*, spring_stiffness: Array, turning_mass: Array) -> Array:
    """Return the natural frequency of a unit that turns, sqrt(k/m)/(2 pi) [Hz]."""
    return np.sqrt(spring_stiffness / turning_mass) / (2 * np.pi)


def turning_response(
    *, drive_force: Array, circular_frequency: Array, spring_stiffness: Array, damping: Array,
    turning_mass: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Return the stroke s = F/(k - m w^2 + i w c) of a unit that turns, real and imaginary [m]."""
    w = circular_frequency
    real, imag = spring_stiffness - turning_mass * w * w, w * damping
    size = hypot(real, imag)
    share = drive_force / size
    return share * (real / size), -share * (imag / size)


def trough_turn(
    *, stroke: Array, loaded_mass: Array, base_mass: Array, moving_inertia: Array,
    base_inertia: Array, offset_along: Array, offset_upward: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the amplitude of the turning, up in front, phi = -(m_r/I_t) (d x e) s [rad]."""
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
    """Return how a place of the trough moves, along the floor and upward [m].

    (m2/M) (s e + phi k x d) + phi k x (p - c1), p - c1 the place from the trough's mass centre.
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


# --- bowl: leaves on a circle of radius r_s, tilted by th from the vertical


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
    turning, lifting = i1 * (i2 / (i1 + i2)), m1 * (m2 / (m1 + m2))
    return turning * np.square(cosine(th) / r_s) + lifting * np.square(sine(th))


def loaded_inertia(*, moving_inertia: Array, load_mass: Array, radius: Array) -> Array:
    """Return the inertia with a load that keeps to the track, I1 + m_l r^2 [kg m2]."""
    return moving_inertia + load_mass * np.square(radius)


def bowl_frequency(*, spring_stiffness: Array, bowl_mass: Array) -> Array:
    """Return the natural frequency of the bowl, the base free, sqrt(k/m)/(2 pi) [Hz]."""
    return np.sqrt(spring_stiffness / bowl_mass) / (2 * np.pi)


def bowl_response(
    *, drive_force: Array, circular_frequency: Array, spring_stiffness: Array, damping: Array,
    loaded_mass: Array, base_mass: Array, loaded_inertia: Array, base_inertia: Array,
    load_damping: Array, radius: Array, spring_radius: Array, spring_angle: Array,
) -> tuple[Array, Array, Array, Array]:  # fmt: skip
    """Return the stroke s (real, imaginary) and the bowl's share of turn and lift (sizes) [m, 1].

    s = F/(k - m w^2 + i w c), m = I_r (cos th/r_s)^2 + m_r sin^2 th, as of two masses and inertias;
    a damper c_l from the track to the ground makes m1 the mass m1 - i c_l/w, I1 the inertia
    I1 - i c_l r^2/w. The shares are I2/(I1 + I2) and m2/(m1 + m2).
    """
    w = circular_frequency
    lost = load_damping / w
    turning, turning_lost, turn = _reduced(loaded_inertia, lost * np.square(radius), base_inertia)
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


def _reduced(one: Array, lost: Array, other: Array) -> tuple[Array, Array, Array]:
    """Return m m2/(m + m2) of m = m1 - i lost (real part, minus the imaginary), m2/|m + m2|."""
    total = one + other
    size = hypot(total, lost)
    share = other / size
    return share * (one * (total / size) + lost * (lost / size)), share * share * lost, share


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


# --- where values hold


def is_at_resonance(*, natural_frequency: Array, frequency: Array, damping_ratio: Array) -> Mask:
    """Return where the drive is within the damping ratio of the natural frequency."""
    return np.abs(natural_frequency / frequency - 1) < damping_ratio


def is_tuned_stiff(*, natural_frequency: Array, frequency: Array) -> Mask:
    """Return where the unit is tuned above its drive."""
    return natural_frequency > frequency


def hits_magnet(*, air_gap_margin: Array) -> Mask:
    """Return where the stroke closes the air gap."""
    return air_gap_margin <= 0


def is_overstressed(*, stress_margin: Array) -> Mask:
    """Return where the leaves bend by more than they may."""
    return stress_margin < 0


def is_poorly_isolated(*, foot_frequency: Array, frequency: Array) -> Mask:
    """Return where the unit rocks on its feet at more than a third of the drive's frequency."""
    return foot_frequency > frequency / 3
