"""Drive units: two masses on leaf springs, driven by a magnet or an unbalance (theory 15).

A moving mass m1 (trough or bowl) and a base m2, joined by guided leaf springs of stiffness k; the
base stands on feet. Small harmonic motion in its steady state, one harmonic, no resonance of leaf
or bowl by itself. The relative stroke s runs along the line that the leaves guide; amplitudes are
from zero to peak. Arrays broadcast; SI units, angles in radians.
"""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask, hypot

VACUUM_PERMEABILITY = 1.25663706127e-6  # N A-2, CODATA 2022
FIRST_MODE = 22.373285448061052  # of a beam clamped at both ends: cos(x) cosh(x) = 1, squared


def circular_frequency(*, frequency: Array) -> Array:
    """Return the circular frequency of the drive, w = 2 pi f [rad s-1]."""
    return 2 * np.pi * frequency


def leaf_stiffness(
    *, spring_count: Array, elastic_modulus: Array, spring_width: Array, spring_thickness: Array,
    spring_length: Array, clamp_factor: Array,
) -> Array:  # fmt: skip
    """Return the stiffness of all leaf springs together, k = c_k n E b (t/L)^3 [N m-1].

    n leaves of width b, thickness t and free length L between the clamps, whose ends stay parallel.
    A leaf clamped at both ends is two cantilevers of L/2: 12 E I/L^3 with I = b t^3/12. c_k
    (`clamp_factor`) is 1 for rigid clamps and less for real ones, which give.
    """
    slenderness = spring_thickness / spring_length
    cube = slenderness * slenderness * slenderness
    return clamp_factor * spring_count * elastic_modulus * spring_width * cube


def spring_stress(
    *, elastic_modulus: Array, spring_thickness: Array, spring_length: Array, stroke: Array
) -> Array:
    """Return the bending stress at the clamps of a leaf, sigma = 3 E t s/L^2 [Pa].

    t and L are thickness and free length of the leaf, s the amplitude of the stroke between its
    ends [m].
    """
    return 3 * elastic_modulus * (spring_thickness / spring_length) * (stroke / spring_length)


def leaf_frequency(
    *, elastic_modulus: Array, spring_density: Array, spring_thickness: Array, spring_length: Array
) -> Array:
    """Return the first natural frequency of a leaf by itself, clamped at both ends [Hz].

    f = x^2/(2 pi) (t/L^2) sqrt(E/(12 rho)): thickness t, free length L, density rho, and x =
    4.7300407 the first root of cos(x) cosh(x) = 1.
    """
    speed = np.sqrt(elastic_modulus / (12 * spring_density))
    return FIRST_MODE / (2 * np.pi) * (spring_thickness / spring_length) * (speed / spring_length)


def leaf_mass(
    *, spring_count: Array, spring_density: Array, spring_width: Array, spring_thickness: Array,
    spring_length: Array,
) -> Array:  # fmt: skip
    """Return the mass of the leaves that moves with their moving ends, 13/35 of all [kg].

    The other ends are held. Between its ends a leaf bends by 3 x^2 - 2 x^3 of the stroke, x from 0
    to 1; 13/35 is the mean square.
    """
    return 13 / 35 * spring_count * spring_density * spring_width * spring_thickness * spring_length


def stress_margin(*, allowable_stress: Array, spring_stress: Array) -> Array:
    """Return the rest up to the allowable stress; below 0 it is exceeded [Pa]."""
    return allowable_stress - spring_stress


def air_gap_margin(*, air_gap: Array, stroke: Array) -> Array:
    """Return the rest of the magnet's air gap at the end of the stroke [m]."""
    return air_gap - stroke


def unbalance_force(*, unbalance: Array, circular_frequency: Array) -> Array:
    """Return the amplitude of the force of a turning unbalance, F = m_u r w^2 [N]."""
    return unbalance * circular_frequency * circular_frequency


def magnet_force(*, flux_density: Array, pole_area: Array) -> Array:
    """Return the amplitude of a magnet's force at the drive's frequency, F = B^2 A/(4 mu_0) [N].

    B is the peak of the flux density in the gap [T], A the area of all poles [m2]. The pull B^2
    A/(2 mu_0) swings by half of itself, at twice the line's frequency (full wave) or at the line's
    (half wave).
    """
    return flux_density * flux_density * pole_area / (4 * VACUUM_PERMEABILITY)


def reduced_mass(*, moving_mass: Array, base_mass: Array) -> Array:
    """Return the reduced mass of the empty unit, m_r = m1 m2/(m1 + m2) [kg]."""
    return moving_mass * (base_mass / (moving_mass + base_mass))


def loaded_mass(*, moving_mass: Array, load_mass: Array) -> Array:
    """Return the moving mass with a load that keeps to the track, m1 + m_l [kg]."""
    return moving_mass + load_mass


def tuned_stiffness(*, ring_down_frequency: Array, generalised_mass: Array) -> Array:
    """Return the stiffness of the springs by a measured ring-down, k = (2 pi f_0)^2 m [N m-1].

    f_0 is the frequency with which the empty unit swings after a knock [Hz], m the mass that its
    stroke moves, base free (`generalised_mass`).
    """
    w = 2 * np.pi * ring_down_frequency
    return w * w * generalised_mass


def damping(*, damping_ratio: Array, spring_stiffness: Array, generalised_mass: Array) -> Array:
    """Return the damping coefficient of the springs, c = 2 zeta sqrt(k m) [N s m-1].

    zeta is the damping ratio, k the stiffness, m the mass that the stroke of the empty unit moves.
    """
    return 2 * damping_ratio * np.sqrt(spring_stiffness * generalised_mass)


def stroke(*, stroke_response: tuple[Array, ...]) -> Array:
    """Return the amplitude of the stroke between both masses, along the line of the leaves [m].

    The first two entries of `stroke_response` are real and imaginary part of the stroke [m].
    """
    return hypot(stroke_response[0], stroke_response[1])


def phase(*, stroke_response: tuple[Array, ...]) -> Array:
    """Return the phase of the stroke behind the force, from 0 to -pi [rad].

    The first two entries of `stroke_response` are real and imaginary part of the stroke [m].
    """
    return np.arctan2(stroke_response[1], stroke_response[0])


def amplification(*, stroke: Array, spring_stiffness: Array, drive_force: Array) -> Array:
    """Return the amplification k s/F: the stroke over that which a force at rest gives [1]."""
    return stroke * spring_stiffness / drive_force


def drive_unit_power(
    *, drive_force: Array, circular_frequency: Array, stroke_response: tuple[Array, ...]
) -> Array:
    """Return the mean power of the drive's force, -F w Im(s)/2 [W].

    Im(s) is the second entry of `stroke_response`: the stroke that lags the force by 90 degrees
    [m].
    """
    return -drive_force * circular_frequency * stroke_response[1] / 2


# --- a magnet on a half wave


def second_over_first(
    force_harmonic: Array, first: tuple[Array, Array], second: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Return sine and cosine part, at 2 tau, of a track's second harmonic over its first [1].

    tau is the phase in which the first harmonic of the displacement is A sin(tau). The magnet pulls
    the track back by F (cos(wt) + h cos(2wt)), h being `force_harmonic`. `first` and `second` are
    real and imaginary part of the displacement per force at w and 2w, G_1 and G_2 [m N-1]: (sine,
    cosine) = r (-sin psi, cos psi), r e^(i psi) = h G_2 conj(G_1)^2/|G_1|^3.
    """
    size = hypot(*first)
    cos, sin = first[0] / size, first[1] / size
    twice_cos, twice_sin = cos * cos - sin * sin, 2.0 * sin * cos
    real = (second[0] * twice_cos + second[1] * twice_sin) / size
    imag = (second[1] * twice_cos - second[0] * twice_sin) / size
    return -force_harmonic * imag, force_harmonic * real


def second_harmonic(*, track_harmonic: tuple[Array, Array]) -> Array:
    """Return the second harmonic of the track's acceleration over the first, 4 A_2/A_1 [1].

    `track_harmonic` is sine and cosine part of A_2/A_1, the harmonics of the displacement.
    """
    return 4.0 * hypot(*track_harmonic)


# --- where values hold


def is_at_resonance(*, natural_frequency: Array, frequency: Array, damping_ratio: Array) -> Mask:
    """True where the drive is within the damping ratio of the natural frequency."""
    return np.abs(natural_frequency / frequency - 1) < damping_ratio


def is_tuned_stiff(*, natural_frequency: Array, frequency: Array) -> Mask:
    """True where the unit is tuned above its drive."""
    return natural_frequency > frequency


def hits_magnet(*, air_gap_margin: Array) -> Mask:
    """True where the stroke closes the air gap."""
    return air_gap_margin <= 0


def is_overstressed(*, stress_margin: Array) -> Mask:
    """True where the leaves bend by more than they may."""
    return stress_margin < 0


def is_poorly_isolated(*, foot_frequency: Array, frequency: Array) -> Mask:
    """True where the unit rocks on its feet at more than a third of the drive's frequency."""
    return foot_frequency > frequency / 3
