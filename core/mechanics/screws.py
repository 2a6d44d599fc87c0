"""Wrenches as screws, and a cylinder that rolls and yaws on a level plane (theory 1.6, 9).

A screw is a resultant and a moment about a point. Sources disagree on which half comes first, so
halves have names. Halves are arrays of shape (..., 3) that broadcast against each other. A type
does not know its reference point and axes: whoever combines two answers for that.

Axes: n upwards (the source's E1), eta in rolling direction (E2), sigma along the axis (E3). Angles
are counted from sigma towards eta, as the source does; theory 9.2 says what that means in the axes
of the track. Pure rolling about mid-length, with angular velocity theta' n + phi' sigma and the
centre's velocity r phi' eta. SI units, angles in radians; wrenches are about the centre, in the
axes n, eta, sigma.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, hypot, ratio, sine
from vibrafeed.core.mechanics.floor import over_load
from vibrafeed.core.mechanics.rolling import is_rolling


def vector(first: Array, second: Array, third: Array) -> Array:
    """Return the components as one array, on a new last axis."""
    return np.stack(np.broadcast_arrays(first, second, third), axis=-1)


def dot(a: Array, b: Array) -> Array:
    """Return the scalar product over the last axis."""
    return np.asarray(np.sum(a * b, axis=-1))


@dataclass(frozen=True, eq=False)
class Wrench:
    """Resultant of a force system.

    Attributes
    ----------
    force, moment : ndarray
        Resultant force f [N]; moment m_P about the reference point P [N m].
    """

    force: Array
    moment: Array


@dataclass(frozen=True, eq=False)
class ScrewReduction:
    """A screw as pitch and axis: moment = axis_point x resultant + pitch resultant.

    Attributes
    ----------
    pitch : ndarray
        Moment along the axis over the resultant [m]; NaN where there is no axis.
    axis_point : ndarray
        From the reference point to the nearest point of the axis [m]; NaN where there is none.
    has_axis : ndarray of bool
        False of a pure couple, or of nothing.
    """

    pitch: Array
    axis_point: Array
    has_axis: Mask


def reduce_screw(resultant: Array, moment: Array) -> ScrewReduction:
    """Return pitch S.S0/S^2 and axis S x S0/S^2 of a screw, (2.9), (4.1).

    `resultant` is S, `moment` is S0 about the reference point, shape (..., 3). Both are scaled by
    powers of two first, so that no square leaves the range of floats; a result beyond that range is
    infinite. The source prints the axis of a wrench with the opposite sign, (4.3), (4.5), (4.6),
    which contradicts (2.9) and does not give back M in (4.7).
    """
    F, M = np.broadcast_arrays(
        np.asarray(resultant, dtype=np.float64), np.asarray(moment, dtype=np.float64)
    )
    f, f_exponent = _scaled(F)
    m, m_exponent = _scaled(M)
    has_force = np.any(F != 0, axis=-1)
    square = np.where(has_force, dot(f, f), 1.0)
    exponent_change = m_exponent - f_exponent
    with np.errstate(over="ignore", under="ignore"):
        pitch = np.ldexp(dot(f, m) / square, exponent_change)
        axis = np.ldexp(np.cross(f, m) / square[..., None], exponent_change[..., None])
    return ScrewReduction(
        np.where(has_force, pitch, np.nan), np.where(has_force[..., None], axis, np.nan), has_force
    )


def _scaled(half: Array) -> tuple[Array, NDArray[np.intc]]:
    _, exponent = np.frexp(np.max(np.abs(half), axis=-1))
    return np.ldexp(half, -exponent[..., None]), exponent


def rolling_drive(
    *, vibration_acceleration: Array, alpha: Array, beta: Array, axis_yaw: Array
) -> Array:
    """Return the drive at its peak along eta, D_eta = P cos(beta) sin(alpha + theta) [m s-2]."""
    return vibration_acceleration * cosine(beta) * sine(alpha + axis_yaw)


def axial_drive(
    *, vibration_acceleration: Array, alpha: Array, beta: Array, axis_yaw: Array
) -> Array:
    """Return the drive's peak along sigma, D_sigma = P cos(beta) cos(alpha + theta) [m s-2]."""
    return vibration_acceleration * cosine(beta) * cosine(alpha + axis_yaw)


def axial_friction_acceleration(
    *, axial_drive: Array, diameter: Array, spin_rate: Array, yaw_rate: Array
) -> Array:
    """Return the friction per mass along the axis, D_sigma - r phi' theta', (4.16) [m s-2]."""
    return axial_drive - diameter / 2 * spin_rate * yaw_rate


def rolling_friction(*, mass: Array, rolling_drive: Array) -> Array:
    """Return the friction force that rolls the cylinder, m D_eta/3, (4.15) [N]."""
    return mass * rolling_drive / 3


def axial_friction(*, mass: Array, axial_friction_acceleration: Array) -> Array:
    """Return the friction force along the axis, m (D_sigma - r phi' theta'), (4.16) [N]."""
    return mass * axial_friction_acceleration


def spin_acceleration(*, rolling_drive: Array, diameter: Array) -> Array:
    """Return the spin acceleration, phi'' = 4 D_eta/(3 d), (4.19) [rad s-2]."""
    return 4 * rolling_drive / (3 * diameter)


def yaw_acceleration(
    *, mass: Array, diameter: Array, length: Array, drilling_moment: Array
) -> Array:
    """Return the yaw acceleration, M_z/I1 with I1 = m (3 r^2 + L^2)/12; 0 in (4.18) [rad s-2].

    M_z is the drilling moment of the floor.
    """
    return 12 * drilling_moment / (mass * (0.75 * np.square(diameter) + np.square(length)))


def printed_yaw_rate(*, axial_drive: Array, diameter: Array, spin_rate: Array) -> Array:
    """Return the yaw rate as printed, theta' = 4 D_sigma/(3 d phi'), (4.20) [rad s-1].

    It follows only if the floor's resultant is held at mid-length. Without spin it has no value, as
    at every start from rest, and its time derivative contradicts (4.18).
    """
    with np.errstate(over="ignore"):
        return ratio(4 * axial_drive, 3 * diameter * spin_rate, np.nan)


def pressure_offset_axial(
    *,
    axial_drive: Array,
    diameter: Array,
    spin_rate: Array,
    yaw_rate: Array,
    normal_acceleration: Array,
) -> Array:
    """Return the shift of the floor's normal force, r (D_sigma - (3/2) r phi' theta')/n0 [m].

    Friction along the axis tilts the cylinder and the yaw of its spin resists; the floor balances
    both. The source leaves it out. NaN in flight.
    """
    tilting = axial_drive - 0.75 * diameter * spin_rate * yaw_rate
    return diameter / 2 * over_load(tilting, normal_acceleration, np.nan)


def required_friction(
    *, rolling_drive: Array, axial_friction_acceleration: Array, normal_acceleration: Array
) -> Array:
    """Return the least static friction with which the cylinder rolls, hypot(F_eta, F_sigma)/N [1].

    F_eta and F_sigma are the friction forces in rolling direction and along the axis; infinite in
    flight.
    """
    friction = hypot(rolling_drive / 3, axial_friction_acceleration)
    return over_load(friction, normal_acceleration, np.inf)


def cone_margin(
    *,
    mass: Array,
    friction_static: Array,
    rolling_drive: Array,
    axial_friction_acceleration: Array,
    normal_acceleration: Array,
) -> Array:
    """Return the margin of static friction, mu_s N - hypot(F_eta, F_sigma) [N].

    F_eta and F_sigma are as of `required_friction`; below 0 the cylinder slips.
    """
    friction = hypot(rolling_drive / 3, axial_friction_acceleration)
    return mass * (friction_static * normal_acceleration - friction)


def floor_wrench(
    *,
    mass: Array,
    diameter: Array,
    spin_rate: Array,
    yaw_rate: Array,
    drilling_moment: Array,
    rolling_friction: Array,
    axial_friction: Array,
    floor_force: Array,
) -> Wrench:
    """Return the wrench of the floor about the centre, in the axes n, eta, sigma [N, N m].

    The force is (N, -F_eta, -F_sigma), the moment (M_z, -I3 theta' phi', r F_eta): drilling moment
    M_z, then what turns the spin phi' with the yaw rate theta', I3 = m r^2/2.
    """
    force = vector(floor_force, -rolling_friction, -axial_friction)
    precession = _precession_moment(mass, diameter, spin_rate, yaw_rate)
    return Wrench(force, vector(drilling_moment, precession, diameter / 2 * rolling_friction))


def force_wrench(
    *,
    mass: Array,
    diameter: Array,
    spin_rate: Array,
    yaw_rate: Array,
    drilling_moment: Array,
    rolling_drive: Array,
    rolling_friction: Array,
) -> Wrench:
    """Return the wrench of drive, gravity and floor together about the centre, (4.12), (4.13).

    In the axes n, eta, sigma; drive and gravity act at the centre. What (4.15) to (4.17) cancel is
    left out instead of subtracted: along n nothing remains, along sigma m r phi' theta'.
    """
    axial_force = mass * (diameter / 2) * spin_rate * yaw_rate
    force = vector(np.zeros(()), mass * rolling_drive * (2 / 3), axial_force)
    precession = _precession_moment(mass, diameter, spin_rate, yaw_rate)
    return Wrench(force, vector(drilling_moment, precession, diameter / 2 * rolling_friction))


def reduction(*, wrench: Wrench) -> ScrewReduction:
    """Return pitch F.M/F^2 and axis F x M/F^2 of a wrench, force F and moment M."""
    return reduce_screw(wrench.force, wrench.moment)


def printed_reduction(*, wrench: Wrench) -> ScrewReduction:
    """Return pitch and axis of a wrench with the sign of (4.3), (4.5), (4.6)."""
    reduced = reduce_screw(wrench.force, wrench.moment)
    return replace(reduced, axis_point=-reduced.axis_point)


def slips(
    *,
    rolling_drive: Array,
    axial_friction_acceleration: Array,
    friction_static: Array,
    normal_acceleration: Array,
) -> Mask:
    """True where a rolling and yawing cylinder needs more friction than there is.

    hypot(F_eta, F_sigma) > mu_s N; in rolling direction a solid cylinder needs a third of the
    drive.
    """
    return ~is_rolling(
        in_plane_drive_x=axial_friction_acceleration,
        in_plane_drive_y=rolling_drive,
        friction_static=friction_static,
        floor_acceleration=normal_acceleration,
    )


def has_no_force_axis(*, force_reduction: ScrewReduction) -> Mask:
    """True where the force system has no axis: it is a pure couple, or nothing."""
    return ~force_reduction.has_axis


def _precession_moment(mass: Array, diameter: Array, spin_rate: Array, yaw_rate: Array) -> Array:
    # Moment about eta that turns the spin, -I3 theta' phi', I3 = m r^2/2 [N m].
    return -mass * np.square(diameter) / 8 * spin_rate * yaw_rate
