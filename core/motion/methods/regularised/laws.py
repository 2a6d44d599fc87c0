"""Smooth laws of friction and of the floor, and the equation of motion of a part under them.

With slip speed s and a coefficient mu(v) that falls from static to kinetic, friction and floor are

    F = -mu(|v|) N v/sqrt(v^2 + s^2),    N = max(0, -k z - d min(1, -k z/onset) z').
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.mechanics.soft_contact import damping_of_restitution
from vibrafeed.core.motion.pieces import Piece, pieces_of
from vibrafeed.core.motion.waves import Wave, size

PEAK = 3.0
"""Speed of the static peak, and the limit of sticking, in slip speeds.

Up to here friction grows with speed and holds the part by creep. At 3 slip speeds the law without
a peak has 95 % of its final value.
"""


@dataclass(frozen=True)
class RegularisedLaws:
    """The regularised laws of one cell, all dimensionless.

    Attributes
    ----------
    friction_kinetic, friction_static : float
        Coefficients at large speeds and at the peak.
    slip_speed : float
        Speed below which friction gives way, in g/w.
    stiffness, damping : float
        Of the floor, over the mass, in w^2 and w.
    """

    friction_kinetic: float
    friction_static: float
    slip_speed: float
    stiffness: float
    damping: float

    @cached_property
    def onset(self) -> float:
        """The spring force, over the weight, above which the damper acts fully.

        It sets in over the depth to which the weight presses the spring. If it set in at once, the
        force would jump at a landing, and integrators end there: the step that their tolerance asks
        for is below the spacing of floating numbers. On floors stiffer than 1e8 that depth itself
        is passed in so short a time; there it is 1e-4 of the depth to which an impact at g/w (w = 2
        pi f) goes.
        """
        return max(1.0, 1e-4 * math.sqrt(self.stiffness))

    def friction(self, speed: float) -> tuple[float, float]:
        """Return friction over (normal force times speed), and its derivative by speed over speed.

        A steep function of the slip `speed` in g/w (w = 2 pi f) in place of a jump at 0, for
        implicit integrators. The coefficient falls from the static to the kinetic one as a Gaussian
        of the speed, whose height and width give the force its maximum, the static coefficient
        exactly, at `PEAK` slip speeds: shapes with a lower or higher peak would break loose at a
        wrong load however small the slip speed is.
        """
        square = speed * speed
        root = math.sqrt(square + self.slip_speed * self.slip_speed)
        value = self.friction_kinetic / root
        slope = -self.friction_kinetic / root**3
        if self.friction_static > self.friction_kinetic:
            peak = self.friction_static * math.sqrt(1 + PEAK**2) / PEAK
            extra = peak - self.friction_kinetic
            width = 2 * (1 + PEAK**2) * extra / peak  # square, in that of the speed of the peak
            width *= (PEAK * self.slip_speed) ** 2
            bump = extra * math.exp(((PEAK * self.slip_speed) ** 2 - square) / width)
            value += bump / root
            slope -= bump / root**3 + 2 * bump / (width * root)
        return value, slope

    def unclamped(self, height: float, velocity: float) -> float:
        """Return the force of spring and damper over the weight, which may pull (Kelvin-Voigt).

        `height` in g/w^2 (w = 2 pi f) is negative in the floor, `velocity` is that off the floor in
        g/w.
        """
        spring = -self.stiffness * height
        return spring - self.damping * min(1.0, spring / self.onset) * velocity

    def normal(self, height: float, velocity: float) -> tuple[float, float, float]:
        """Return the force of a stiff, damped floor over the weight, and its two derivatives.

        By `height` in g/w^2 (w = 2 pi f; negative in the floor) and by `velocity` off the floor in
        g/w; all 0 above the floor, and where the damper would make it pull. An implicit integrator
        needs the derivatives.
        """
        force = self.unclamped(height, velocity) if height < 0 else 0.0
        if force <= 0:
            return 0.0, 0.0, 0.0
        spring = -self.stiffness * height
        by_height = -self.stiffness
        if spring < self.onset:
            by_height += self.damping * self.stiffness * velocity / self.onset
        return force, by_height, -self.damping * min(1.0, spring / self.onset)


def damping_ratio(restitution: float, stiffness: float) -> float:
    """Return the damping ratio by which a floor without adhesion gives a restitution [1].

    With a damping ratio sin a an impact ends, when the force is 0, at the share exp(-(pi - 2a) tan
    a) of its speed; with cosh b at exp(-2b coth b). Both are independent of the speed, as Newton's
    law asks; with Hunt and Crossley's damper they are not. A restitution of 0 needs endless
    damping, which would let the part sink and rise slowly. The ratio stays below
    (stiffness^(1/2)/8)^(1/3), but at least 1: there a landing at g/(2 pi f) under the full weight
    ends without any rebound, and the floor still recovers in a time of order stiffness^(-1/3).
    `stiffness` is that of the floor over mass times (2 pi f)^2 [1].
    """
    most = max(1.0, (math.sqrt(stiffness) / 8) ** (1 / 3))
    return min(most, float(damping_of_restitution(restitution=np.asarray(restitution))))


def laws(
    friction_kinetic: float,
    friction_static: float,
    restitution: float,
    slip_speed: float,
    stiffness: float,
) -> RegularisedLaws:
    """Return the regularised laws of a cell, with the damping that gives its restitution.

    `slip_speed` in g/(2 pi f), `stiffness` of the floor over mass times (2 pi f)^2.
    """
    damping = 2 * damping_ratio(restitution, stiffness) * math.sqrt(stiffness)
    static = max(friction_static, friction_kinetic)
    return RegularisedLaws(friction_kinetic, static, slip_speed, stiffness, damping)


@dataclass(frozen=True)
class Cell:
    """One part on one track: the right-hand side of its motion and its Jacobian.

    The state is the position and the velocity, (x, z, u_x, u_z) in the plane and (x, y, z, u_x,
    u_y, u_z) in space, in g/w^2 and g/w.

    Attributes
    ----------
    laws
        Friction and floor.
    drive, gravity
        Amplitude and gravity in g: along the track, (across it,) and normal to the floor.
    wave
        The drive if it is no plain sine, else None.
    piece
        The stretch of the wave that is in force, else None.
    """

    laws: RegularisedLaws
    drive: tuple[float, ...]
    gravity: tuple[float, ...]
    wave: Wave | None = None
    piece: Piece | None = None

    @property
    def coordinates(self) -> int:
        """The number of coordinates: 2 in the plane, 3 in space."""
        return len(self.drive)

    def rest(self) -> Array:
        """Return the state at rest, sunk into the floor by the weight so that nothing bounces."""
        state = np.zeros(2 * self.coordinates)
        state[self.coordinates - 1] = -self.gravity[-1] / self.laws.stiffness
        return state

    def push(self, phase: float) -> list[float]:
        """Return the drive acceleration in g at a phase in rad: along, (across,) normal."""
        if self.piece is None:
            sine = math.sin(phase)
            return [d * sine for d in self.drive]
        along, across, normal = map(float, self.piece.push(phase))
        return [along, normal] if self.coordinates == 2 else [along, across, normal]

    def pieces(self, begin: float, end: float) -> Iterator[tuple[Cell, float]]:
        """Yield copies of the cell for the stretches between jumps of its drive, with end phases.

        From phase `begin` to `end` in rad; each copy has the smooth piece of the wave in force
        there. The cell itself, once, under a sine.
        """
        if self.wave is None:
            yield self, end
            return
        for piece, reached in pieces_of(self.wave, begin, end):
            yield replace(self, piece=piece), reached

    @property
    def swing(self) -> float:
        """An upper bound of the track's speed in the plane of the floor."""
        return math.hypot(*self.drive[:-1]) if self.wave is None else float(size(self.wave))

    @property
    def order(self) -> int:
        """The highest harmonic order of the drive."""
        return 1 if self.wave is None else max(1, int(self.wave.harmonics.shape[2]))

    def rate(self, phase: float, state: Array) -> list[float]:
        """Return the derivative of the state by the phase, for scipy's integrators (theory 13.1).

        `state` holds the coordinates, of which the last is the height, then their velocities, in
        g/w^2 and g/w (w = 2 pi f); `phase` is in rad. The forces are those of a stiff floor and of
        friction that grows steeply with the slip speed.
        """
        n = self.coordinates
        position, *velocity = state[n - 1 :].tolist()
        force, _, _ = self.laws.normal(position, velocity[-1])
        free = [p - g for p, g in zip(self.push(phase), self.gravity, strict=True)]
        free[-1] += force
        if force > 0:
            resistance = force * self.laws.friction(math.hypot(*velocity[:-1]))[0]
            for i in range(n - 1):
                free[i] -= resistance * velocity[i]
        return velocity + free

    def jacobian(self, phase: float, state: Array) -> Array:
        """Return the derivative of `rate` by the state, shape (2 n, 2 n) for n coordinates.

        scipy's implicit integrators need it. `state` holds coordinates and velocities in g/w^2 and
        g/w (w = 2 pi f); the `phase` does not matter.
        """
        del phase  # the drive does not depend on the state
        n = self.coordinates
        position, *velocity = state[n - 1 :].tolist()
        matrix = np.zeros((2 * n, 2 * n))
        matrix[range(n), range(n, 2 * n)] = 1.0
        force, by_height, by_climb = self.laws.normal(position, velocity[-1])
        if force > 0:
            sliding = np.array(velocity[:-1])
            value, slope = self.laws.friction(math.hypot(*velocity[:-1]))
            direction = np.append(-value * sliding, 1.0)  # of the contact force
            matrix[n:, n - 1] = by_height * direction
            matrix[n:, 2 * n - 1] = by_climb * direction
            matrix[n:-1, n:-1] -= force * (
                value * np.eye(n - 1) + slope * np.outer(sliding, sliding)
            )
        return matrix
