"""A part on a floor: drive, gravity and Coulomb friction in track axes (theory 0, 1.5).

Axes: x along the track in transport direction, z normal to the floor, y = z cross x, off the wall.
All functions take and return broadcastable float64 arrays, SI units, angles in radians.
"""

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask, compensated_sum, cosine, hypot, ratio, sine

# Between them a square is a float with all its digits.
FAR_BELOW, FAR_ABOVE = 1e-150, 1e150


def amplitude(*, peak_to_peak: Array) -> Array:
    """Return the amplitude, zero to peak [m]."""
    return peak_to_peak / 2


def amplitude_of_vertical(*, vertical_amplitude: Array, beta: Array) -> Array:
    """Return the amplitude along the drive, A0 = A_v/|sin(beta)|; NaN for beta = 0 [m]."""
    return ratio(vertical_amplitude, np.abs(sine(beta)), np.nan)


def amplitude_of_vertical_stroke(*, vertical_peak_to_peak: Array, beta: Array) -> Array:
    """Return the amplitude along the drive, half of the stroke 2 A_v/|sin(beta)| [m]."""
    return amplitude_of_vertical(vertical_amplitude=vertical_peak_to_peak / 2, beta=beta)


def vibration_acceleration(*, frequency: Array, amplitude: Array) -> Array:
    """Return the amplitude of the drive acceleration, P = A0 (2 pi f)^2 [m s-2]."""
    w = 2 * np.pi * frequency
    # Of a far frequency the square alone is no float, though P may be one.
    in_range = (w > FAR_BELOW) & (w < FAR_ABOVE)
    extreme = np.where(in_range, 1.0, w)
    return np.where(
        in_range, amplitude * np.square(np.where(in_range, w, 1.0)), amplitude * extreme * extreme
    )


def drive_along(*, vibration_acceleration: Array, alpha: Array, beta: Array) -> Array:
    """Return the drive acceleration at its peak along +x, P cos(beta) cos(alpha) [m s-2]."""
    return vibration_acceleration * cosine(beta) * cosine(alpha)


def drive_across(*, vibration_acceleration: Array, alpha: Array, beta: Array) -> Array:
    """Return the drive acceleration at its peak along +y, W = P cos(beta) sin(alpha) [m s-2]."""
    return vibration_acceleration * cosine(beta) * sine(alpha)


def drive_normal(*, vibration_acceleration: Array, beta: Array) -> Array:
    """Return the drive acceleration at its peak along +z, P sin(beta) [m s-2]."""
    return vibration_acceleration * sine(beta)


def gravity_along(*, gravity: Array, gamma: Array) -> Array:
    """Return gravity along -x, g sin(gamma) [m s-2]."""
    return gravity * sine(gamma)


def gravity_normal(*, gravity: Array, gamma: Array) -> Array:
    """Return gravity onto the floor of a track without lean, g cos(gamma) [m s-2]."""
    return gravity * cosine(gamma)


def leaning_gravity_normal(*, gravity: Array, gamma: Array, delta: Array) -> Array:
    """Return gravity onto the floor of a leaning track, g cos(gamma) cos(delta) [m s-2]."""
    return gravity * cosine(gamma) * cosine(delta)


def gravity_across(*, gravity: Array, gamma: Array, delta: Array) -> Array:
    """Return gravity towards the wall, g_y = g cos(gamma) sin(delta) [m s-2]."""
    return gravity * cosine(gamma) * sine(delta)


def normal_acceleration(*, gravity_normal: Array, drive_normal: Array) -> Array:
    """Return the floor's normal force per mass on a part held on the floor, n0 [m s-2].

    It is gravity less drive, both normal to the floor; negative values mean that the part has left
    the floor.
    """
    return gravity_normal - drive_normal


def throw_number(*, drive_normal: Array, gravity_normal: Array) -> Array:
    """Return the throw number, Gamma = P sin(beta) / gravity onto the floor [1]."""
    return throw(drive_normal, gravity_normal)


def throw(drive: Array, gravity: Array) -> Array:
    """Return drive over gravity, both normal to the floor: the throw number [1].

    On an upright floor, where gravity is 0, it is infinite with the sign of the drive, and NaN
    without drive; the regime there is `flight`.
    """
    drive_on_upright = np.where(gravity == 0, drive, 1.0)  # the sign matters there only
    limit = np.where(drive_on_upright > 0, np.inf, np.where(drive_on_upright < 0, -np.inf, np.nan))
    return ratio(drive, gravity, limit)


def in_plane_drive_x(*, drive_along: Array, gravity_along: Array) -> Array:
    """Return drive less gravity along x, D_x [m s-2]."""
    return drive_along - gravity_along


def in_plane_drive(*, in_plane_drive_x: Array, in_plane_drive_y: Array) -> Array:
    """Return the magnitude |D| of drive less gravity in the floor plane [m s-2]."""
    return hypot(in_plane_drive_x, in_plane_drive_y)


def has_left_floor(*, normal_acceleration: Array) -> Mask:
    """True where the part has left the floor: n0 <= 0."""
    return normal_acceleration <= 0


def lift_off_acceleration(*, normal_acceleration: Array) -> Array:
    """Return the acceleration off the floor: 0 in contact, -n0 in flight [m s-2]."""
    return np.maximum(0.0, -normal_acceleration)


def supported_acceleration(*, normal_acceleration: Array) -> Array:
    """Return the floor normal force per mass of a floor that cannot pull, max(0, n0) [m s-2]."""
    return np.maximum(0.0, normal_acceleration)


def rotated_acceleration_x(*, acceleration_x: Array, acceleration_y: Array, yaw: Array) -> Array:
    """Return the acceleration along the turned x axis, (3.10), (3.12) [m s-2]."""
    return compensated_sum(cosine(yaw) * acceleration_x, sine(yaw) * acceleration_y)


def rotated_acceleration_y(*, acceleration_x: Array, acceleration_y: Array, yaw: Array) -> Array:
    """Return the acceleration along the turned y axis, (3.10), (3.12) [m s-2]."""
    return compensated_sum(cosine(yaw) * acceleration_y, -sine(yaw) * acceleration_x)


def velocity_bound(*, frequency: Array, amplitude: Array, alpha: Array, beta: Array) -> Array:
    """Return the largest speed of the track along x, v_b = A0 w cos(beta) cos(alpha) [m s-1]."""
    return np.abs(2 * np.pi * frequency * amplitude * cosine(beta) * cosine(alpha))


def floor_force(*, mass: Array, floor_acceleration: Array) -> Array:
    """Return the floor normal force, N = m n [N]."""
    return mass * floor_acceleration


def no_acceleration_z() -> Array:
    """Return the value 0: the source assumes that the part stays on the floor [m s-2]."""
    return np.zeros(())


# --- Friction: per axis as the source prints it, and as one disc (theory 1.5).


def per_axis_acceleration_x(
    *, in_plane_drive_x: Array, friction_kinetic: Array, normal_acceleration: Array
) -> Array:
    """Return the acceleration along x as printed, D_x - mu n0, (3.9), (3.11), (3.36) [m s-2].

    The source lets friction act along -x whatever the sliding direction, and does not check n0:
    after lift-off (n0 < 0) this friction drives the part.
    """
    return in_plane_drive_x - friction_kinetic * normal_acceleration


def per_axis_acceleration_y(
    *, in_plane_drive_y: Array, friction_kinetic: Array, normal_acceleration: Array
) -> Array:
    """Return the acceleration along y as printed, D_y - mu n0, (3.9), (3.11), (3.36) [m s-2].

    Friction acts along -y even where nothing pushes sideways; see `per_axis_acceleration_x`.
    """
    return in_plane_drive_y - friction_kinetic * normal_acceleration


def is_stuck(*, in_plane_drive: Array, friction_static: Array, floor_acceleration: Array) -> Mask:
    """True where static friction holds a part at rest: |D| <= mu_s n, n > 0."""
    return (in_plane_drive <= friction_static * floor_acceleration) & (floor_acceleration > 0)


def sliding_fraction(
    *,
    in_plane_drive: Array,
    friction_static: Array,
    friction_kinetic: Array,
    floor_acceleration: Array,
) -> Array:
    """Return the share of the drive that accelerates: stick 0, slip 1 - mu_k n/|D|, flight 1 [1].

    From rest: friction opposes the impending sliding velocity, which is along D.
    """
    stuck = is_stuck(
        in_plane_drive=in_plane_drive,
        friction_static=friction_static,
        floor_acceleration=floor_acceleration,
    )
    resisting = np.where(stuck, 0.0, friction_kinetic * floor_acceleration)
    return np.where(stuck, 0.0, 1.0 - ratio(resisting, in_plane_drive, 0.0))


def disc_acceleration_x(*, in_plane_drive_x: Array, sliding_fraction: Array) -> Array:
    """Return the acceleration along x from rest, both axes sharing one friction disc [m s-2]."""
    return in_plane_drive_x * sliding_fraction


def pressure_offset_x(
    *,
    height: Array,
    in_plane_drive_x: Array,
    in_plane_drive: Array,
    friction_static: Array,
    friction_kinetic: Array,
    floor_acceleration: Array,
) -> Array:
    """Return the offset along x of the floor's resultant that balances friction's moment [m].

    A part of the height b tips where it exceeds half the length. Friction acts b/2 below the
    centre, so that the offset is b/2 times friction along x over the normal force; NaN in flight.
    """
    stuck = is_stuck(
        in_plane_drive=in_plane_drive,
        friction_static=friction_static,
        floor_acceleration=floor_acceleration,
    )
    in_stick = ratio(
        np.where(stuck, in_plane_drive_x, 0.0), np.where(stuck, floor_acceleration, 1.0), 0.0
    )
    in_slip = friction_kinetic * ratio(in_plane_drive_x, in_plane_drive, 0.0)
    friction_over_load = np.where(
        floor_acceleration > 0, np.where(stuck, in_stick, in_slip), np.nan
    )
    return height / 2 * friction_over_load


def tips_x(*, pressure_offset_x: Array, length: Array) -> Mask:
    """True where the floor resultant leaves the base along x: the part tips."""
    return np.abs(pressure_offset_x) > length / 2


def tips_y(*, pressure_offset_y: Array, width: Array) -> Mask:
    """True where the floor resultant leaves the base along y: the part tips."""
    return np.abs(pressure_offset_y) > width / 2


def over_load(value: Array, load: Array, otherwise: float) -> Array:
    """Return a value over the floor's force, both per mass, and `otherwise` in flight."""
    in_contact = load > 0
    return np.where(in_contact, value / np.where(in_contact, load, 1.0), otherwise)
