"""The laws of motion of one part in each mode of contact, as smooth equations (theory 13.1).

For rectangle and cylinder on floor and wall, relative to the track: the free part has

    dx = p_x(phase) - g_x,    dy = p_y(phase) - g_y - k (u_x + v_x(phase))^2,
    dz = p_z(phase) - g_z,

where p is the push of the drive and v the speed of the track (of the plain sine c sin and c cos),
and every contact adds its normal force and friction, by whether it sticks or slips. Phases and
what belongs to them may be arrays.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.method import Contacts, Groups, Numbers
from vibrafeed.core.motion.record import Ramp, Record
from vibrafeed.core.motion.waves import ALONG, ENDS, TURN, step_speeds

SOON = 1e-6
"""Phase in rad after which a push that passes through zero has a direction."""

Three = tuple[Numbers, Numbers, Numbers]


@dataclass(frozen=True)
class Sine:
    """The plain sine of a drive; `numbers` are its amplitudes along, across and normal, in g."""

    numbers: tuple[float, float, float]
    order = 1

    def push(self, phase: Numbers) -> Three:
        """Return the push along, across and normal at a phase in rad, in g."""
        sine = np.sin(phase)
        along, across, normal = self.numbers
        return along * sine, across * sine, normal * sine

    def speed(self, phase: Numbers) -> Numbers:
        """Return the velocity of the track along at a phase."""
        return self.numbers[ALONG] * np.cos(phase)

    @property
    def steepest(self) -> float:
        """An upper bound of the push's slope."""
        return math.hypot(*self.numbers)


@dataclass(frozen=True)
class Piece:
    """A stretch of a wave without a jump: its harmonics, and one level of its steps.

    Attributes
    ----------
    harmonics
        Coefficients of sin(k tau) and cos(k tau) on three axes in g, shape (3, 2, orders).
    level
        Push of the step on three axes in g.
    start, track
        A phase in rad, and the velocity that the steps give the track along there, in g/w.
    """

    harmonics: Array
    level: tuple[float, float, float] = (0.0, 0.0, 0.0)
    start: float = 0.0
    track: float = 0.0

    @cached_property
    def orders(self) -> Array:
        """The harmonic orders in the drive."""
        return np.arange(1.0, self.order + 1.0)

    def push(self, phase: Numbers) -> Three:
        """Return the drive acceleration along, across and normal at a phase in rad, in g.

        Of one smooth piece of the drive: sums of sines, plus its constant level. `phase` may be an
        array; the three results have its shape.
        """
        if not self.order:
            along, across, normal = (level + 0.0 * phase for level in self.level)
            return along, across, normal
        angles = np.multiply.outer(self.orders, phase)
        waves = np.tensordot(self.harmonics, [np.sin(angles), np.cos(angles)], ([1, 2], [0, 1]))
        along, across, normal = (
            wave + level for wave, level in zip(waves, self.level, strict=True)
        )
        return along, across, normal

    def speed(self, phase: Numbers) -> Numbers:
        """Return the velocity of the track along itself at a phase in rad, in g/w.

        Here w = 2 pi f, f being the frequency of the drive.
        """
        angles = np.multiply.outer(self.orders, phase)
        sine, cosine = self.harmonics[ALONG] / self.orders
        waves = np.tensordot(sine, np.cos(angles), 1) - np.tensordot(cosine, np.sin(angles), 1)
        return waves + self.track - self.level[ALONG] * (phase - self.start)

    @property
    def order(self) -> int:
        """The highest harmonic order of the drive."""
        return int(self.harmonics.shape[2])

    @property
    def steepest(self) -> float:
        """An upper bound of the push's slope."""
        return float(np.hypot(*np.moveaxis(self.harmonics, 1, 0)).sum(axis=0) @ self.orders)


def pieces(groups: Groups, begin: float, end: float) -> Iterator[tuple[Sine | Piece, float]]:
    """Yield the drive of one part between its jumps, with the phase of each end.

    From the phase `begin` to `end` in rad; each piece is smooth up to both its ends, as an
    integrator needs it. A drive without steps is a single piece.
    """
    wave = groups.wave
    if wave is None or not wave.steps.shape[1]:
        yield (Sine(groups.drive) if wave is None else Piece(wave.harmonics)), end
        return
    ends, speeds = wave.steps[ENDS].tolist(), step_speeds(wave, ALONG).tolist()
    levels = [tuple(level) for level in wave.steps[:ENDS].T.tolist()]
    turn = math.floor(begin / TURN)
    while True:
        for index, level in enumerate(levels):
            start = turn * TURN + (ends[index - 1] if index else 0.0)
            stop = turn * TURN + ends[index]
            if stop > max(begin, start):
                yield Piece(wave.harmonics, level, start, speeds[index]), min(stop, end)
                if stop >= end:
                    return
        turn += 1


X, Y, Z, UX, UY, UZ, SPIN = range(7)  # places in a state: position, velocity, spin


class Mode(NamedTuple):
    """The contacts that carry, and whether they slip; both do or neither."""

    floor: bool
    wall: bool
    slips: bool


class Forces(NamedTuple):
    """Normal forces of floor and wall in units of the weight, and the rates of the velocities.

    `rates` are those of u_x, u_y, u_z and of the spin, in g.
    """

    normal: Numbers
    side: Numbers
    rates: tuple[Numbers, Numbers, Numbers, Numbers]


class ReferenceLaws:
    """The laws of one part: its forces in each mode, and the equations that integrate them.

    Parameters
    ----------
    groups : Groups
        Of one part, as plain numbers.
    contacts : Contacts
        What it can touch.
    drive : Sine, Piece or Ramp, optional
        The drive, as far as it is smooth; of a wave in steps its first piece.
    record : Record, optional
        The drive of a recording, in place of that of the groups.
    """

    def __init__(
        self,
        groups: Groups,
        contacts: Contacts,
        drive: Sine | Piece | Ramp | None = None,
        record: Record | None = None,
    ) -> None:
        self.groups, self.contacts, self.record = groups, contacts, record
        self.drive = drive or next(self._drives(0.0, TURN))[0]
        self.response = 1.0 + contacts.rolling

    def pieces(self, begin: float, end: float) -> "Iterator[tuple[ReferenceLaws, float]]":
        """Yield the laws for each stretch between jumps of the drive, with the phase of its end.

        From phase `begin` to `end` in rad; each laws object has the drive that is smooth there.
        """
        for drive, reached in self._drives(begin, end):
            yield ReferenceLaws(self.groups, self.contacts, drive, self.record), reached

    def _drives(self, begin: float, end: float) -> Iterator[tuple[Sine | Piece | Ramp, float]]:
        if self.record is None:
            return pieces(self.groups, begin, end)
        return self.record.pieces(self.groups.drive, begin, end)

    def free(self, phase: Numbers, ux: Numbers) -> tuple[Numbers, Numbers, Numbers]:
        """Return the acceleration of a free part relative to the track in g (theory 13.1).

        Along, across and normal. `phase` is that of the drive, `ux` the velocity along in g/w (w =
        2 pi f): in a curve it acts across. Both may be arrays.
        """
        groups, (along, across, normal) = self.groups, self.drive.push(phase)
        across = across - groups.gravity_number_across
        if groups.curvature_number:
            speed = ux + self.drive.speed(phase)
            across = across - groups.curvature_number * speed * speed
        return along - groups.gravity_number_along, across, normal - groups.gravity_number_normal

    def forces(self, phase: Numbers, mode: Mode, ux: Numbers, e: tuple[Numbers, Numbers]) -> Forces:
        """Return contact forces and rates of the velocities of a part in a mode of contact.

        Forces in units of the weight, rates of u_x, u_y, u_z and spin in g, by the phase. `phase`
        is in rad, `mode` says which contacts carry the part and if they slip, `ux` is the velocity
        along in g/w (w = 2 pi f), `e` the direction of slip (two components). All may be arrays
        over phases.
        """
        groups, (free_x, free_y, free_z) = self.groups, self.free(phase, ux)
        if mode.floor and mode.wall:
            if not mode.slips:
                return Forces(-free_z, -free_y, (0.0, 0.0, 0.0, 0.0))
            mu_floor, mu_wall, e_2 = groups.friction_kinetic, groups.wall_friction, e[1]
            normal = (-free_z + mu_wall * e_2 * free_y) / (1.0 + mu_wall * mu_floor * e_2 * e_2)
            side = -free_y + mu_floor * e_2 * normal
            drag = mu_floor * normal + mu_wall * side
            return Forces(
                normal, side, (free_x - drag * e[0], 0.0, 0.0, -self.contacts.rolling * drag * e_2)
            )
        if mode.floor:
            if mode.slips:
                friction_x, friction_y = (
                    groups.friction_kinetic * free_z * component for component in e
                )
            else:
                friction_x, friction_y = -free_x, -free_y / self.response
            return Forces(
                -free_z,
                0.0,
                (free_x + friction_x, free_y + friction_y, 0.0, self.contacts.rolling * friction_y),
            )
        if mode.wall:
            if mode.slips:
                friction_x, friction_z = (
                    groups.wall_friction * free_y * component for component in e
                )
            else:
                friction_x, friction_z = -free_x, -free_z / self.response
            return Forces(
                0.0,
                -free_y,
                (
                    free_x + friction_x,
                    0.0,
                    free_z + friction_z,
                    -self.contacts.rolling * friction_z,
                ),
            )
        return Forces(0.0, 0.0, (free_x, free_y, free_z, 0.0))

    def slip(self, mode: Mode, state: Array) -> tuple[float, float]:
        """Return the two components of the slip at the contacts of a mode, in g/w (w = 2 pi f).

        Along, and across on the floor, normal at the wall, spin at both. `mode` holds the contacts
        that carry the part, `state` position (3), velocity (3) and spin.
        """
        if mode.floor and mode.wall:  # the floor has (u_x, spin), the wall (u_x, -spin)
            return float(state[UX]), float(state[SPIN])
        if mode.floor:
            return float(state[UX]), float(state[UY] + state[SPIN])
        return float(state[UX]), float(state[UZ] - state[SPIN])

    def sliding(
        self, phase: Numbers, mode: Mode, size: Numbers, angle: Numbers
    ) -> tuple[Numbers, Numbers]:
        """Return the rate of a slip's size in g, and the rate of its angle times its size, in g.

        Both by the phase, from the forces on a part that slips with the `size` in g/w (w = 2 pi f)
        in the direction `angle` in rad, at the `phase` in rad; all may be arrays. `mode` holds the
        contacts, which determine the two axes of the slip.
        """
        direction = np.cos(angle), np.sin(angle)
        rate_x, rate_y, rate_z, spin = self.forces(
            phase, mode, size * direction[0], direction
        ).rates
        second = (
            spin if mode.floor and mode.wall else rate_y + spin if mode.floor else rate_z - spin
        )
        return direction[0] * rate_x + direction[1] * second, direction[0] * second - direction[
            1
        ] * rate_x

    def impending(self, phase: Numbers, mode: Mode) -> tuple[Numbers, Numbers, Numbers, Numbers]:
        """Return the push on a part at rest (two components), kinetic and static friction, in g.

        A slip begins where the push exceeds static friction. The components are those in the two
        directions in which the contacts of `mode` may slip: along, and across on the floor, normal
        at the wall, 0 at both. `phase` is in rad, or an array of phases.
        """
        groups, (free_x, free_y, free_z) = self.groups, self.free(phase, 0.0)
        if mode.floor and mode.wall:
            wall_friction = -groups.wall_friction * free_y
            return (
                free_x,
                0.0,
                -groups.friction_kinetic * free_z + wall_friction,
                -groups.friction_static * free_z + wall_friction,
            )
        if mode.floor:
            return (
                free_x,
                free_y,
                -groups.friction_kinetic * free_z,
                -groups.friction_static * free_z,
            )
        return free_x, free_z, -groups.wall_friction * free_y, -groups.wall_friction * free_y

    def excess(self, phase: Numbers, mode: Mode) -> Numbers:
        """Return the push squared minus static friction squared, in g^2; slip begins above 0."""
        first, second, _, static_friction = self.impending(phase, mode)
        return first * first + (second / self.response) ** 2 - static_friction * static_friction

    def onset_direction(self, phase: float, mode: Mode) -> tuple[float, float]:
        """Return the direction in which a slip begins at `phase` in rad: a unit vector (2).

        The slip follows the push less kinetic friction, whose direction is the slip's own
        (`secular`, theory 7.3). `mode` holds the contacts that carry the part, which determine the
        two axes of the slip. Without any push at this phase, that shortly afterwards is taken.
        """
        first, second, kinetic_friction, _ = self.impending(phase, mode)
        if first == 0.0 == second:  # without friction slip begins before there is a push
            first, second, kinetic_friction, _ = self.impending(phase + SOON, mode)
        return self.secular(first, second, kinetic_friction)

    def secular(self, first: float, second: float, friction: float) -> tuple[float, float]:
        """Return the direction of a slip under a push and kinetic friction, a unit vector.

        `first` and `second` are the components of the push or slip without friction, `friction` the
        friction in the same unit. e = (first/(z + slide), second/(z + r slide)) with the z >= 0
        that makes it a unit vector, and the response r of the second component, which is not 1 for
        a cylinder (theory 7.3).
        """
        response, size = self.response, math.hypot(first, second)
        if response == 1.0:
            return first / size, second / size
        low, high = 0.0, size
        for _ in range(200):  # halving: slow, and nothing of the kernels
            z = 0.5 * (low + high)
            if z in (low, high):
                break
            if math.hypot(first / (z + friction), second / (z + response * friction)) > 1.0:
                low = z
            else:
                high = z
        e = first / (high + friction), second / (high + response * friction)
        return e[0] / math.hypot(*e), e[1] / math.hypot(*e)

    def stopping(self, first: float, second: float, limit: float) -> tuple[float, float]:
        """Return the two components of the friction impulse that stops a slip.

        If it exceeds `limit`, the impulse has this size, against the slip that remains (`secular`).

        `first` and `second` are the components of the slip before; all in g/w (w = 2 pi f), per
        mass. An impulse changes the second by `response` times itself, as spin takes part.
        """
        if math.hypot(first, second / self.response) <= limit:
            return -first, -second / self.response
        direction = self.secular(first, second, limit)
        return -limit * direction[0], -limit * direction[1]
