"""Drive units: two masses on leaf springs, driven by a magnet or an unbalance (theory 15).

A moving mass m1 (trough or bowl) and a base m2, joined by guided leaf springs of stiffness k; the
base stands on feet. Small harmonic motion in its steady state, one harmonic, no resonance of leaf
or bowl by itself. The relative stroke s runs along the line that the leaves guide; amplitudes are
from zero to peak. Arrays broadcast; SI units, angles in radians.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, cosine, hypot, sine

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

    n leaves of width b, thickness t and free length L, whose ends stay parallel: two cantilevers of
    L/2 each. c_k is 1 for rigid clamps and less for real ones, which give.
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

    f = x^2/(2 pi) (t/L^2) sqrt(E/(12 rho)), x = 4.7300407 the first root of cos(x) cosh(x) = 1.
    """
    wave_speed = np.sqrt(elastic_modulus / (12 * spring_density))
    return (
        FIRST_MODE / (2 * np.pi) * (spring_thickness / spring_length) * (wave_speed / spring_length)
    )


def leaf_mass(
    *, spring_count: Array, spring_density: Array, spring_width: Array, spring_thickness: Array,
    spring_length: Array,
) -> Array:  # fmt: skip
    """Return the mass of the leaves that moves with their moving ends, 13/35 of all [kg].

    Between its ends a leaf bends by 3 x^2 - 2 x^3 of the stroke, x from 0 to 1; 13/35 is the mean
    square.
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

    B is the peak of the flux density in the gap, A the area of all poles. The pull B^2 A/(2 mu_0)
    swings by half of itself, at twice the line's frequency (full wave) or at the line's (half
    wave).
    """
    return flux_density * flux_density * pole_area / (4 * VACUUM_PERMEABILITY)


def voltage_force(
    *, drive_voltage: Array, measured_voltage: Array, force_exponent: Array,
    measured_amplitude: Array, measured_response: Array,
) -> Array:  # fmt: skip
    """Return the force at a voltage from one measured amplitude, F = A_m/G_m (U/U_m)^n [N].

    A_m is the amplitude of the empty track at the voltage U_m, G_m (`measured_response`) that which
    1 N gives at the frequency of the measurement [m N-1]. n is 2 for a magnet whose flux is
    proportional to its voltage.
    """
    voltage_ratio_power = np.exp(force_exponent * np.log(drive_voltage / measured_voltage))
    return measured_amplitude / measured_response * voltage_ratio_power


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
    """Return the amplitude of the stroke between both masses, along the line of the leaves [m]."""
    return hypot(stroke_response[0], stroke_response[1])


def phase(*, stroke_response: tuple[Array, ...]) -> Array:
    """Return the phase of the stroke behind the force, from 0 to -pi [rad]."""
    return np.arctan2(stroke_response[1], stroke_response[0])


def amplification(*, stroke: Array, spring_stiffness: Array, drive_force: Array) -> Array:
    """Return the amplification k s/F: the stroke over that which a force at rest gives [1]."""
    return stroke * spring_stiffness / drive_force


def drive_unit_power(
    *, drive_force: Array, circular_frequency: Array, stroke_response: tuple[Array, ...]
) -> Array:
    """Return the mean power of the drive's force, -F w Im(s)/2 [W].

    Im(s), the stroke that lags the force by 90 degrees, is the second entry of `stroke_response`.
    """
    return -drive_force * circular_frequency * stroke_response[1] / 2


# --- a magnet on a half wave


def second_over_first(
    force_harmonic: Array, first: tuple[Array, Array], second: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Return sine and cosine part, at 2 tau, of a track's second harmonic over its first [1].

    tau is the phase in which the first harmonic of the displacement is A sin(tau). The magnet pulls
    by F (cos(wt) + h cos(2wt)), h `force_harmonic`; `first` and `second` are the displacements per
    force at w and 2w, G_1 and G_2 [m N-1]: (sine, cosine) = r (-sin psi, cos psi), r e^(i psi) = h
    G_2 conj(G_1)^2/|G_1|^3.
    """
    first_size = hypot(*first)
    cos_phase, sin_phase = first[0] / first_size, first[1] / first_size
    cos_double, sin_double = (
        cos_phase * cos_phase - sin_phase * sin_phase,
        2.0 * sin_phase * cos_phase,
    )
    real = (second[0] * cos_double + second[1] * sin_double) / first_size
    imag = (second[1] * cos_double - second[0] * sin_double) / first_size
    return -force_harmonic * imag, force_harmonic * real


def second_harmonic(*, track_harmonic: tuple[Array, Array]) -> Array:
    """Return the second harmonic of the track's acceleration over the first, 4 A_2/A_1 [1].

    `track_harmonic` is sine and cosine part of A_2/A_1, the harmonics of the displacement.
    """
    return 4.0 * hypot(*track_harmonic)


# --- where values hold


# --- Bowl and base, leaves on a circle of radius r_s, tilted by th (theory 15.3).


def bowl_mass(
    *, moving_mass: Array, base_mass: Array, moving_inertia: Array, base_inertia: Array,
    spring_radius: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the moved mass of the empty unit, I_r (cos th/r_s)^2 + m_r sin^2 th [kg].

    The bowl turns by Theta and lifts by r_s tan(th) Theta; the stroke of the leaves, on a circle of
    radius r_s and tilted by th, is s = r_s Theta/cos(th). m_r = m1 m2/(m1 + m2) of bowl and base,
    and I_r alike of their moments of inertia.
    """
    mass_1, mass_2, inertia_1, inertia_2 = moving_mass, base_mass, moving_inertia, base_inertia
    turned_inertia, lifted_mass = (
        inertia_1 * (inertia_2 / (inertia_1 + inertia_2)),
        mass_1 * (mass_2 / (mass_1 + mass_2)),
    )
    return turned_inertia * np.square(
        cosine(spring_angle) / spring_radius
    ) + lifted_mass * np.square(sine(spring_angle))


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

    s = F/(k - m w^2 + i w c), m as of `bowl_mass`. A damper c_l from the load's radius R_l to the
    ground makes m1 the mass m1 - i c_l/w, I1 the inertia I1 - i c_l R_l^2/w (theory 15.3).
    """
    w = circular_frequency
    c_l_over_w = load_damping / w
    inertia, inertia_loss, turn_fraction = _reduced(
        loaded_inertia, c_l_over_w * np.square(load_radius), base_inertia
    )
    mass, mass_loss, lift_fraction = _reduced(loaded_mass, c_l_over_w, base_mass)
    turn_per_stroke_squared, lift_per_stroke_squared = (
        np.square(cosine(spring_angle) / spring_radius),
        np.square(sine(spring_angle)),
    )
    real = (
        spring_stiffness
        - (inertia * turn_per_stroke_squared + mass * lift_per_stroke_squared) * w * w
    )
    imag = (
        w * damping
        + (inertia_loss * turn_per_stroke_squared + mass_loss * lift_per_stroke_squared) * w * w
    )
    stiffness_size = hypot(real, imag)
    amplitude = drive_force / stiffness_size
    return (
        amplitude * (real / stiffness_size),
        -amplitude * (imag / stiffness_size),
        turn_fraction,
        lift_fraction,
    )


def bowl_measured(
    *, measured_frequency: Array, measured_radius: Array, spring_stiffness: Array, damping: Array,
    moving_mass: Array, base_mass: Array, moving_inertia: Array, base_inertia: Array,
    spring_radius: Array, spring_angle: Array,
) -> Array:  # fmt: skip
    """Return the amplitude of the empty bowl at a radius by a force of 1 N [m N-1]."""
    zero = 0.0 * measured_frequency
    response = bowl_response(
        drive_force=1.0 + zero, circular_frequency=2 * np.pi * measured_frequency,
        spring_stiffness=spring_stiffness, damping=damping, loaded_mass=moving_mass,
        base_mass=base_mass, loaded_inertia=moving_inertia, base_inertia=base_inertia,
        load_damping=zero, load_radius=measured_radius, spring_radius=spring_radius,
        spring_angle=spring_angle,
    )  # fmt: skip
    amplitude = stroke(stroke_response=response)
    turn = bowl_turn(
        stroke=amplitude, stroke_response=response, spring_angle=spring_angle,
        spring_radius=spring_radius,
    )  # fmt: skip
    lift = bowl_lift(stroke=amplitude, stroke_response=response, spring_angle=spring_angle)
    return bowl_amplitude(radius=measured_radius, bowl_turn=turn, bowl_lift=lift)


def bowl_harmonic(
    *, force_harmonic: Array, circular_frequency: Array, spring_stiffness: Array, damping: Array,
    loaded_mass: Array, base_mass: Array, loaded_inertia: Array, base_inertia: Array,
    load_damping: Array, load_radius: Array, spring_radius: Array, spring_angle: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Return sine and cosine part of the track's second harmonic, over its first, of a bowl [1].

    As of `second_over_first`. Turn and lift of the bowl are taken to keep one proportion in both
    harmonics: exact without a damper from track to ground (theory 15.5).
    """
    responses = [
        bowl_response(
            drive_force=1.0 + 0.0 * circular_frequency, circular_frequency=w,
            spring_stiffness=spring_stiffness, damping=damping, loaded_mass=loaded_mass,
            base_mass=base_mass, loaded_inertia=loaded_inertia, base_inertia=base_inertia,
            load_damping=load_damping, load_radius=load_radius, spring_radius=spring_radius,
            spring_angle=spring_angle,
        )[:2]
        for w in (circular_frequency, 2.0 * circular_frequency)
    ]  # fmt: skip
    return second_over_first(force_harmonic, *responses)


def _reduced(mass: Array, loss: Array, other: Array) -> tuple[Array, Array, Array]:
    # The reduced mass m1 m2/(m1 + m2) = real part - i loss, m1 = `mass` - i `loss`, loss = c/w of a
    # damper c to the ground, m2 = `other`; and the share |m2/(m1 + m2)|.
    total_mass = mass + other
    total_size = hypot(total_mass, loss)
    fraction = other / total_size
    return (
        fraction * (mass * (total_mass / total_size) + loss * (loss / total_size)),
        fraction * fraction * loss,
        fraction,
    )


def bowl_turn(
    *, stroke: Array, stroke_response: tuple[Array, ...], spring_angle: Array, spring_radius: Array
) -> Array:
    """Return the amplitude of the bowl's own turning, s cos(th)/r_s I2/(I1 + I2) [rad].

    I2/(I1 + I2) is the third entry of `stroke_response`.
    """
    return stroke * cosine(spring_angle) / spring_radius * stroke_response[2]


def bowl_lift(*, stroke: Array, stroke_response: tuple[Array, ...], spring_angle: Array) -> Array:
    """Return the amplitude of the bowl's own lift, s sin(th) m2/(m1 + m2), at every radius [m].

    m2/(m1 + m2) is the fourth entry of `stroke_response`.
    """
    return stroke * sine(spring_angle) * stroke_response[3]


def bowl_amplitude(*, radius: Array, bowl_turn: Array, bowl_lift: Array) -> Array:
    """Return the amplitude of the track at its radius, hypot(r Theta_1, z_1) [m]."""
    return hypot(radius * bowl_turn, bowl_lift)


def bowl_angle(*, radius: Array, bowl_turn: Array, bowl_lift: Array, gamma: Array) -> Array:
    """Return the angle of the vibration above the track, atan(z_1/(r Theta_1)) - gamma [rad].

    It is the tilt of the leaf springs only where the base is held and r is theirs.
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

    A stretch begins where the one before ends. `radii` are those at the ends, `turns` n turns about
    the bowl, `climbs` angles gamma [rad]: a stretch from r_1 to r_2 is pi n (r_1 + r_2)/cos(gamma)
    long (theory 15.6).
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

    One array more than there are stretches.
    """
    total, distances = total_length(stretches), [0.0 * stretches.length[0]]
    for length in stretches.length:
        distances.append(distances[-1] + length)
    return [distance / total for distance in distances[:-1]] + [np.ones_like(total)]


def radius_at(fraction: Array, stretches: Stretches) -> Array:
    """Return the radius of the track at a share of its length [m].

    `fraction` is that share. On a stretch from radius r_1 to r_2, r^2 = r_1^2 + (r_2^2 - r_1^2) x
    at the share x of its own length, since dr ~ dphi and ds ~ r dphi.
    """
    stretch_bounds = bounds(stretches)
    radii = []
    for first, last, stretch_start, stretch_end in zip(
        stretches.start, stretches.end, stretch_bounds[:-1], stretch_bounds[1:], strict=True
    ):
        stretch_fraction = np.clip(
            (fraction - stretch_start) / (stretch_end - stretch_start), 0.0, 1.0
        )
        radii.append(
            np.sqrt(np.square(first) + (np.square(last) - np.square(first)) * stretch_fraction)
        )
    return picked(fraction, stretches, radii)


def picked(fraction: Array, stretches: Stretches, values: Sequence[Array]) -> Array:
    """Return the value, of one a stretch, that holds at a place of a bowl's track.

    `fraction` is the place as a share of the track's length. Where two stretches meet, the later
    one holds.
    """
    value = values[0]
    for stretch_start, later_value in zip(bounds(stretches)[1:-1], values[1:], strict=True):
        value = np.where(fraction >= stretch_start, later_value, value)
    return np.asarray(value)
