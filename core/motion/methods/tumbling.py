"""Tumbling: a part that falls on a plane, strikes it with its corners, rocks and comes to rest.

Motion in the plane of the transport and the normal, with pitch (theory 2, 6); the plane may vibrate
and climb. The part is a rectangle, a cylinder seen along its side (a rectangle with the cylinder's
moment of inertia) or a ball. It is followed from event to event: free flight in closed form, motion
on one corner or on a side with the contact laws of accelerations (theory 2.3, 2.4) by Runge-Kutta
steps of order 4 in pitch and slide alone, so that nothing sinks; impacts, lift-off, stick and slip,
and tipping at their own time, found within the step; impacts by the law of Pfeiffer and Glocker
(theory 5.3). Endless series of ever smaller impacts, bounces as well as rocking, end where the
velocity off the plane falls below 1e-6 of sqrt(acceleration * half diagonal). After many impacts
with much restitution the motion is chaotic, and its details depend on the last digit.

All values are SI. Other motions of this package come in the scales of the drive; tumbling does not:
its size enters, the plane may be at rest, and it takes seconds, not periods. Its own scale is the
time sqrt(half diagonal/gravity), the measure of the default step and of the tolerances: two parts
of one shape and one ratio of drive to that scale tumble alike.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, sine
from vibrafeed.core.motion import compiled
from vibrafeed.core.motion.cells import run_cells
from vibrafeed.core.motion.course import TrajectoryRequest, TrajectoryValues
from vibrafeed.core.motion.groups import Contacts, table
from vibrafeed.core.motion.method import Follow, FollowCourse, Method
from vibrafeed.core.motion.result import STATUS
from vibrafeed.core.scenes import isolated
from vibrafeed.core.scenes.scene import STANDARD_GRAVITY
from vibrafeed.core.watch import Watch


class Body(NamedTuple):
    """The numbers of a part's motion (theory 2.1); `turning` is 0 of a ball, which has no sides."""

    half_diagonal: Array
    inertia_ratio: Array
    corner_angle: Array
    turning: Array


class TumblingRectangle(NamedTuple):
    """A rectangular part; at pitch 0 it lies on a side of its length [m]."""

    length: ArrayLike
    height: ArrayLike

    def body(self) -> Body:
        """Return half diagonal [m], inertia ratio [1] and corner angle [rad] of the rectangle.

        With them a tumbling part is simulated (theory 2.1); the fourth number, 1, says that it has
        corners.
        """
        h, b = (np.asarray(side, dtype=float) for side in self)
        return Body(
            isolated.half_diagonal(height=b, length=h),
            isolated.rectangle_inertia_ratio(),
            isolated.corner_angle(height=b, length=h),
            np.ones(()),
        )


class TumblingCylinder(NamedTuple):
    """A cylindrical part whose axis stays in the plane of motion; at pitch 0 it lies on its side.

    Its rim strikes the plane; it does not roll about its axis [m].
    """

    length: ArrayLike
    diameter: ArrayLike

    def body(self) -> Body:
        """Return half diagonal [m], inertia ratio [1] and corner angle [rad] of the part's outline.

        The outline is a rectangle, on its long side or standing. With them a tumbling part is
        simulated (theory 6); the fourth number, 1, says that it has corners.
        """
        h, d = (np.asarray(side, dtype=float) for side in self)
        direction = isolated.corner_direction(height=d, length=h)
        return Body(
            isolated.half_diagonal(height=d, length=h),
            isolated.cylinder_inertia_ratio(corner_direction=direction),
            isolated.corner_angle(height=d, length=h),
            np.ones(()),
        )


class Ball(NamedTuple):
    """A ball, whose one contact lies below its centre [m]."""

    radius: ArrayLike

    def body(self) -> Body:
        """Return the radius of the ball and its inertia ratio m R^2/I = 5/2; it has no corners."""
        radius = np.asarray(self.radius, dtype=float)
        return Body(radius, np.full((), 2.5), np.full((), np.pi / 2), np.zeros(()))


Part = TumblingRectangle | TumblingCylinder | Ball


STEPS_A_PERIOD = 64  # fewest default steps a period of the drive
STEP_IN_FALLS = 0.02  # largest default step, over sqrt(half diagonal/gravity)

_DERIVED = frozenset({
    "half_diagonal", "inertia_ratio", "corner_angle", "pull_along", "pull_normal", "drive_along",
    "drive_normal", "circular_frequency", "time_step",
})  # fmt: skip
"""Numbers of a cell that are computed from the inputs."""


class Throw(NamedTuple):
    """One part, or many, thrown on a plane: all that their tumbling depends on.

    The plane moves as amplitude * sin(2 pi frequency t + start_phase) in the direction beta above
    itself; velocities are relative to it. Scalars and arrays broadcast; lengths in m, times in s,
    angles in rad.

    Attributes
    ----------
    part : Rectangle, Cylinder or Ball
        Shape and size.
    friction_kinetic, friction_static : array_like
        Coulomb friction in sliding and at rest; the latter, by default the same, may not be less.
        Impacts take the former.
    restitution : array_like
        From 0 to 1, as the impact law understands it (theory 5.3).
    duration : array_like
        Time after which the run ends; it ends earlier where the part rests for good.
    gravity, gamma : array_like
        Gravity and climb angle of the plane.
    frequency, amplitude, beta, start_phase : array_like
        Drive; no drive by default.
    gap_normal : array_like
        Height of the lowest corner above the plane at the start.
    pitch, pitch_rate : array_like
        Pitch and its rate at the start, clockwise; 0 lies flat on side 1.
    velocity_along, velocity_upward : array_like
        Velocity of the centre at the start.
    time_step : array_like, optional
        Largest step; by default 1/50 of sqrt(half diagonal/gravity), 1/64 of a period at most.
        Steps are shorter where the part turns fast.
    """

    part: Part
    friction_kinetic: ArrayLike
    restitution: ArrayLike
    duration: ArrayLike
    friction_static: ArrayLike | None = None
    gravity: ArrayLike = STANDARD_GRAVITY
    gamma: ArrayLike = 0.0
    frequency: ArrayLike = 0.0
    amplitude: ArrayLike = 0.0
    beta: ArrayLike = 0.0
    start_phase: ArrayLike = 0.0
    gap_normal: ArrayLike = 0.0
    pitch: ArrayLike = 0.0
    velocity_along: ArrayLike = 0.0
    velocity_upward: ArrayLike = 0.0
    pitch_rate: ArrayLike = 0.0
    time_step: ArrayLike | None = None


class Tumble(NamedTuple):
    """The tumbling of parts; all arrays have the shape of the arguments broadcast, SI and radians.

    Attributes
    ----------
    pitch : ndarray
        Pitch at the end, clockwise, with all its turns.
    resting_side : ndarray
        Side that lies on the plane at the end: 1 at pitch 0, 2 at 90 degrees, 3 at 180, 4 at 270;
        0 if none. A ball that touches without bouncing lies on side 1.
    settling_time : ndarray
        Time from which the part lies at rest for good; NaN unless the status is settled.
    impacts : ndarray
        Impacts, those of both ends of a side at once counting as one.
    largest_bounce : ndarray
        Largest height of the lowest corner above the plane at the end of a step after the first
        impact.
    velocity : ndarray
        Displacement of the centre relative to the plane over the duration; where there was no
        solution, over the time until then.
    energy_lost : ndarray
        Energy per mass that impacts and friction took, relative to the plane [J kg-1].
    status : ndarray of int8
        Value of a `MOTION_STATUSES` entry: settled, at rest for good whatever the phase of the
        drive; moving, at the end of the duration; limit_reached, stopped earlier by the limit on
        steps and impacts; no_solution,
        a corner slid where the contact laws have no solution or several (theory 2.3).
    """

    pitch: Array
    resting_side: Array
    settling_time: Array
    impacts: Array
    largest_bounce: Array
    velocity: Array
    energy_lost: Array
    status: NDArray[np.int8]


class TumblePath(NamedTuple):
    """The motion of one part, an array a quantity over the times asked for, SI and radians.

    After the end of a run that found no solution all but `time` are NaN, and no corner touches.

    Attributes
    ----------
    time, along, upward, pitch : ndarray, shape (n,)
        Time, place of the centre along and above the plane, pitch.
    velocity_along, velocity_upward, pitch_rate : ndarray, shape (n,)
        Their rates, relative to the plane.
    energy_lost : ndarray, shape (n,)
        Energy per mass lost so far.
    gap_normal : ndarray, shape (n,)
        Height of the lowest corner above the plane.
    touching : ndarray of bool, shape (n, 4)
        Corners that carry the part: lower right, lower left, upper left, upper right at pitch 0.
        A ball has the first only.
    """

    time: Array
    along: Array
    upward: Array
    pitch: Array
    velocity_along: Array
    velocity_upward: Array
    pitch_rate: Array
    energy_lost: Array
    gap_normal: Array
    touching: Mask


def tumbling_motion(throw: Throw, *, watch: Watch | None = None) -> Tumble:
    """Return the tumbling of parts on a plane from the start to the end of the duration.

    Wrong values, such as a restitution above 1, raise ValueError. Where a computed number is
    outside double precision, such as an acceleration that overflows, the status is `limit_reached`.

    Parameters
    ----------
    throw : Throw
        The parts, the plane and the start.
    watch : Watch, optional
        Shows progress, and may stop the work.
    """
    cells, shape = _cells(throw)
    columns_of_all = len(Tumble._fields) - 1
    table = np.full((len(cells), columns_of_all), np.nan)
    status = np.full(len(cells), STATUS["limit_reached"], dtype=np.int8)
    known = _can_be_followed(cells)
    table[known], status[known] = run_cells(
        compiled.tumbling.tumble_events,
        cells[known],
        piece=16,
        columns=columns_of_all,
        watch=watch,
    )
    columns = [column.reshape(shape) for column in table.T]
    return Tumble(**dict(zip(Tumble._fields, columns, strict=False)), status=status.reshape(shape))


def tumbling_path(throw: Throw, *, times: ArrayLike, watch: Watch | None = None) -> TumblePath:
    """Return the motion of one tumbling part at given ascending times, from 0 on [s].

    Every field of `throw`, the record of part, plane and start, is a single value; its duration
    does not matter. After the part has come to rest for good its state stays. NaN where `watch`
    stopped the work before. Raises ValueError if times do not ascend or a field is an
    array.
    """
    moments = np.atleast_1d(np.asarray(times, dtype=float))
    if moments.ndim != 1 or not moments.size or moments[0] < 0 or np.any(np.diff(moments) < 0):
        raise ValueError("the argument times has to hold ascending numbers, the first at least 0")
    end = max(moments[-1], np.finfo(float).tiny)
    cells, shape = _cells(throw._replace(duration=end))
    if shape != ():
        raise ValueError(
            "the path of one part takes single values: every argument has to be a "
            "number, not an array"
        )
    rows = np.full((moments.size, compiled.tumbling.PATH_COLUMNS), np.nan)
    if _can_be_followed(cells)[0]:
        with (watch or Watch()).flag() as stop:
            compiled.tumbling.path_events(cells[0], moments, rows, stop)
    numbers = dict(zip(TumblePath._fields[1:9], rows.T[1:9].copy(), strict=True))
    return TumblePath(time=moments, **numbers, touching=rows[:, 9:] == 1)


def _step_of(throw: Throw) -> ArrayLike:
    """Return the largest time step of a simulation of tumbling parts [s].

    The step given in `throw`, the record of part, plane and start; by default 1/50 of sqrt(half
    diagonal/gravity), and at most 1/64 of a period of the drive.
    """
    if throw.time_step is not None:
        return throw.time_step
    frequency = np.asarray(throw.frequency, dtype=float)
    step = STEP_IN_FALLS * np.sqrt(
        throw.part.body().half_diagonal / np.asarray(throw.gravity, dtype=float)
    )
    circular_frequency = 2 * np.pi * frequency
    acceleration = np.asarray(throw.amplitude, dtype=float) * circular_frequency**2
    rate = np.where(acceleration > 0, circular_frequency, 0.0)
    with np.errstate(divide="ignore"):
        return np.minimum(step, 2 * np.pi / STEPS_A_PERIOD / rate)


def _cells(throw: Throw) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    """Return the kernel's input for tumbling parts, a row of numbers a cell, and the cells' shape.

    `throw` is the record of part, plane and start, whose fields are broadcast; the rows have the
    columns of `Cell`, SI. Raises ValueError if a field is out of its range.
    """
    for name, values in {"duration": throw.duration, "gravity": throw.gravity}.items():
        if not np.all(np.asarray(values) > 0):
            raise ValueError(f"{name} has to be positive")
    body = throw.part.body()
    circular_frequency = 2 * np.pi * np.asarray(throw.frequency, dtype=float)
    acceleration = np.asarray(throw.amplitude, dtype=float) * circular_frequency**2
    weight = np.asarray(throw.gravity, dtype=float)
    inputs: dict[str, Any] = {
        **throw._asdict(),
        **body._asdict(),
        "pull_along": weight * sine(np.asarray(throw.gamma, dtype=float)),
        "pull_normal": weight * cosine(np.asarray(throw.gamma, dtype=float)),
        "drive_along": acceleration * cosine(np.asarray(throw.beta, dtype=float)),
        "drive_normal": acceleration * sine(np.asarray(throw.beta, dtype=float)),
        "circular_frequency": circular_frequency,
        "friction_static": (
            throw.friction_kinetic if throw.friction_static is None else throw.friction_static
        ),
        "time_step": _step_of(throw),
    }
    rows, shape = table(inputs[name] for name in compiled.tumbling.Cell._fields)
    named = dict(zip(compiled.tumbling.Cell._fields, rows.T, strict=True))
    given_themselves = [name for name in compiled.tumbling.Cell._fields if name not in _DERIVED]
    if not all(np.all(np.isfinite(named[name])) for name in given_themselves):
        raise ValueError("every argument has to be a finite number")
    for name in ("gap_normal", "friction_kinetic", "restitution"):
        if not np.all(named[name] >= 0):
            raise ValueError(f"{name} may not be negative")
    if not np.all(named["friction_static"] >= named["friction_kinetic"]):
        raise ValueError("the argument friction_static has to be at least friction_kinetic")
    if not np.all(named["restitution"] <= 1):
        raise ValueError("the argument restitution has to be at most 1")
    return rows, shape


def _can_be_followed(rows: NDArray[np.float64]) -> Mask:
    """Return a mask of the cells of tumbling parts that can be simulated.

    False where a computed number overflowed, or the size, gravity onto the plane or time step is 0.
    `rows` has a row of numbers for each cell, with the columns of the kernel's `Cell`.
    """
    named = dict(zip(compiled.tumbling.Cell._fields, rows.T, strict=True))
    valid: Mask = np.asarray(np.isfinite(rows).all(axis=1))
    for name in ("half_diagonal", "pull_normal", "time_step"):
        valid &= named[name] > 0
    return valid


def _follow(contacts: Contacts) -> Follow:
    """Return the tumbling equation's function, which does not need the `contacts`."""
    del contacts

    def tumble(*, throw: Throw, watch: Watch | None = None) -> Tumble:
        """Return the tumbling of the part from its start to the end of the duration."""
        return tumbling_motion(throw, watch=watch)

    return tumble


def _trajectory(contacts: Contacts) -> FollowCourse:
    """Return the function that computes a tumbling part's trajectory at asked times.

    Methods are built by such functions from the `contacts` of a system, which a tumbling part does
    not need.
    """
    del contacts

    def trajectory(asked: TrajectoryRequest) -> TrajectoryValues:
        """Return the trajectory of the part at the asked times."""
        throw: Throw = asked.arguments["throw"]
        duration, samples = np.asarray(throw.duration).item(), asked.samples
        if isinstance(samples, int):
            times = np.linspace(0.0, duration, samples + 1)
        else:
            times = np.array(samples)
        path = tumbling_path(throw, times=times, watch=asked.watch)
        values = {
            "path_along": path.along,
            "path_height": path.upward,
            "path_pitch": np.rad2deg(path.pitch),
            "path_gap": path.gap_normal,
            "path_corners": path.touching.sum(axis=1).astype(float),
        }
        return TrajectoryValues(times, values, {})

    return trajectory


EVENTS = Method(
    name="events",
    follow=_follow,
    source="theory 2.3, 5.3",
    accuracy="of fourth order in the step while a corner or a side is on the plane, some 1e-8 of "
    "the energy; exact in flight; endless runs of impacts are cut off at 1e-6 of the fall's speed",
    seconds_a_cell=1e-3,
    course=_trajectory,
)
