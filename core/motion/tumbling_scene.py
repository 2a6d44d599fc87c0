"""Tumbling: a part that falls on a plane, strikes it with its corners, rocks and comes to rest.

Motion in the plane of the transport and the normal, with pitch (theory 2, 6); the plane may vibrate
and climb. The part is a rectangle, or a cylinder seen along its side (a rectangle with the
cylinder's moment of inertia). It is followed from event to event: free flight in closed form,
motion on one corner or on a side with the contact laws of accelerations (theory 2.3, 2.4) by
Runge-Kutta steps of order 4 in pitch and slide alone, so that nothing sinks; impacts, lift-off,
stick and slip, and tipping at their own time, found within the step; impacts by the law of Pfeiffer
and Glocker (theory 5.3). Endless series of ever smaller impacts, bounces as well as rocking, end
where the velocity off the plane falls below 1e-6 of sqrt(acceleration * half diagonal). After many
impacts with much restitution the motion is chaotic, and its details depend on the last digit.

All values are SI, not in the scales of the drive: the size enters, the plane may be at rest, and it
takes seconds, not periods. Its own scale is the time sqrt(half diagonal/gravity), the measure of
the step and of the tolerances.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, sine
from vibrafeed.core.motion import kernel_calls
from vibrafeed.core.motion.kernel_calls import run_cells
from vibrafeed.core.motion.method import (
    STATUS,
    TIME,
    Contacts,
    Method,
    Trajectory,
    TrajectoryRequest,
    table,
    where,
)
from vibrafeed.core.motion.scales import product
from vibrafeed.core.scenes import isolated
from vibrafeed.core.scenes.scene import (
    STANDARD_GRAVITY,
    STATIC_ABOVE_KINETIC,
    Equation,
    Scene,
    fields,
)
from vibrafeed.core.watch import Watch

STEPS_A_PERIOD = 64  # fewest steps a period of the drive
STEP_IN_FALLS = 0.02  # largest step, over sqrt(half diagonal/gravity)


class Body(NamedTuple):
    """The numbers of a part's motion (theory 2.1); `turning` is 0 of a ball, which has no sides."""

    half_diagonal: Array
    inertia_ratio: Array
    corner_angle: Array
    turning: Array


def rectangle(*, length: Array, height: Array) -> Body:
    """Return the rectangular part.

    At pitch 0 it lies on a side of its length.
    """
    h, b = np.asarray(length, dtype=float), np.asarray(height, dtype=float)
    return Body(
        isolated.half_diagonal(height=b, length=h),
        isolated.rectangle_inertia_ratio(),
        isolated.corner_angle(height=b, length=h),
        turning=np.ones(()),
    )


def cylinder(*, length: Array, diameter: Array) -> Body:
    """Return the cylindrical part, seen along its side.

    Its axis stays in the plane of motion, and it does not roll about it; its outline is a
    rectangle, on its long side at pitch 0 (theory 6).
    """
    h, d = np.asarray(length, dtype=float), np.asarray(diameter, dtype=float)
    direction = isolated.corner_direction(height=d, length=h)
    return Body(
        isolated.half_diagonal(height=d, length=h),
        isolated.cylinder_inertia_ratio(corner_direction=direction),
        isolated.corner_angle(height=d, length=h),
        turning=np.ones(()),
    )


class Throw(NamedTuple):
    """One part, or many, thrown on a plane: all that their tumbling depends on.

    The plane moves as amplitude * sin(2 pi frequency t) in the direction beta above itself, and
    climbs by gamma; velocities are relative to it. Scalars and arrays broadcast; lengths in m,
    times in s, angles in rad.

    Attributes
    ----------
    part : Body
        Shape and size.
    friction_kinetic, friction_static : array_like
        Coulomb friction in sliding and at rest; the latter, by default the same, may not be less.
        Impacts take the former.
    restitution : array_like
        From 0 to 1, as the impact law understands it (theory 5.3).
    duration : array_like
        Time after which the run ends; it ends earlier where the part rests for good.
    gap_normal : array_like
        Height of the lowest corner above the plane at the start.
    pitch, pitch_rate : array_like
        Pitch and its rate at the start, clockwise; 0 lies flat on side 1.
    velocity_along, velocity_upward : array_like
        Velocity of the centre at the start.
    """

    part: Body
    friction_kinetic: ArrayLike
    restitution: ArrayLike
    duration: ArrayLike
    friction_static: ArrayLike | None = None
    gravity: ArrayLike = STANDARD_GRAVITY
    gamma: ArrayLike = 0.0
    frequency: ArrayLike = 0.0
    amplitude: ArrayLike = 0.0
    beta: ArrayLike = 0.0
    gap_normal: ArrayLike = 0.0
    pitch: ArrayLike = 0.0
    velocity_along: ArrayLike = 0.0
    velocity_upward: ArrayLike = 0.0
    pitch_rate: ArrayLike = 0.0


def _throw(*, tumbling_part: Body, drop_height: Array, **numbers: Array) -> Throw:
    return Throw(part=tumbling_part, gap_normal=drop_height, **numbers)


THROWN = Equation(
    "throw",
    _throw,
    "theory 2.1",
    needs=(
        "tumbling_part", "friction_static", "friction_kinetic", "restitution", "duration",
        "gravity", "gamma", "frequency", "amplitude", "beta", "drop_height", "pitch",
        "velocity_along", "velocity_upward", "pitch_rate",
    ),
    says="Return the record of a tumbling part, the vibrating plane and the start, for its "
    "simulation.",
)  # fmt: skip


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
        Value of a `MOTION_STATUSES` entry: settled for good whatever the phase of the drive; moving
        at the end of the duration; limit_reached, on steps and impacts or beyond double precision;
        no_solution, where a corner slid and the contact laws have none, or several (theory 2.3).
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
    """Return the tumbling of the part from its start to the end of the duration.

    Wrong values, such as a restitution above 1, raise `ValueError`.
    """
    cells, shape = _cells(throw)
    columns = len(Tumble._fields) - 1
    table = np.full((len(cells), columns), np.nan)
    status = np.full(len(cells), STATUS["limit_reached"], dtype=np.int8)
    followable = _can_be_followed(cells)
    kernel = kernel_calls.tumbling.tumble_events
    table[followable], status[followable] = run_cells(
        kernel, cells[followable], piece=16, columns=columns, watch=watch
    )
    return Tumble._make([*(column.reshape(shape) for column in table.T), status.reshape(shape)])


def tumbling_path(throw: Throw, *, times: ArrayLike, watch: Watch | None = None) -> TumblePath:
    """Return the motion of one tumbling part at given ascending times, from 0 on [s].

    Every field of `throw` is a single value; its duration does not matter. NaN where `watch`
    stopped the work before. Raises `ValueError` if times do not ascend or a field is an array.
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
    rows = np.full((moments.size, kernel_calls.tumbling.PATH_COLUMNS), np.nan)
    if _can_be_followed(cells)[0]:
        with (watch or Watch()).flag() as stop:
            kernel_calls.tumbling.path_events(cells[0], moments, rows, stop)
    return TumblePath._make([moments, *rows.T[1:9].copy(), rows[:, 9:] == 1])


def _cells(throw: Throw) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    # The rows of the kernel, its columns `Cell`, from a `Throw` whose values are checked.
    for name in ("duration", "gravity"):
        if not np.all(np.asarray(getattr(throw, name)) > 0):
            raise ValueError(f"{name} has to be positive")
    if throw.friction_static is None:
        throw = throw._replace(friction_static=throw.friction_kinetic)
    part, *numbers = throw
    values = {
        name: np.asarray(number, dtype=float)
        for name, number in zip(Throw._fields[1:], numbers, strict=True)
    }
    circular_frequency = 2 * np.pi * values["frequency"]
    acceleration = values["amplitude"] * circular_frequency**2
    step_of_fall = STEP_IN_FALLS * np.sqrt(part.half_diagonal / values["gravity"])
    with np.errstate(divide="ignore"):
        step_of_drive = (
            2 * np.pi / STEPS_A_PERIOD / np.where(acceleration > 0, circular_frequency, 0.0)
        )
    inputs: dict[str, Any] = {
        **values,
        **part._asdict(),
        "pull_along": values["gravity"] * sine(values["gamma"]),
        "pull_normal": values["gravity"] * cosine(values["gamma"]),
        "drive_along": acceleration * cosine(values["beta"]),
        "drive_normal": acceleration * sine(values["beta"]),
        "circular_frequency": circular_frequency,
        "start_phase": 0.0,
        "time_step": np.minimum(step_of_fall, step_of_drive),
    }
    names = kernel_calls.tumbling.Cell._fields
    rows, shape = table(inputs[name] for name in names)
    columns = dict(zip(names, rows.T, strict=True))
    if not all(
        np.isfinite(columns[name]).all() for name in (*values, "turning") if name in columns
    ):
        raise ValueError("every argument has to be a finite number")
    for name in ("gap_normal", "friction_kinetic", "restitution"):
        if not np.all(columns[name] >= 0):
            raise ValueError(f"{name} may not be negative")
    if not np.all(columns["friction_static"] >= columns["friction_kinetic"]):
        raise ValueError("the argument friction_static has to be at least friction_kinetic")
    if not np.all(columns["restitution"] <= 1):
        raise ValueError("the argument restitution has to be at most 1")
    return rows, shape


def _can_be_followed(rows: NDArray[np.float64]) -> Mask:
    # Not where a computed number overflowed, or size, gravity onto the plane or time step is 0.
    columns = dict(zip(kernel_calls.tumbling.Cell._fields, rows.T, strict=True))
    positive = [columns[name] > 0 for name in ("half_diagonal", "pull_normal", "time_step")]
    return np.logical_and.reduce([np.isfinite(rows).all(axis=1), *positive])


def _trajectory(request: TrajectoryRequest, contacts: Contacts) -> Trajectory:
    # At equal times over the duration, or at those of the request.
    del contacts
    throw: Throw = request.arguments["throw"]
    times = np.array(request.samples)
    if isinstance(request.samples, int):
        times = np.linspace(0.0, np.asarray(throw.duration).item(), request.samples + 1)
    path = tumbling_path(throw, times=times, watch=request.watch)
    return {
        TIME: times,
        "path_along": path.along,
        "path_height": path.upward,
        "path_pitch": np.rad2deg(path.pitch),
        "path_gap": path.gap_normal,
        "path_corners": path.touching.sum(axis=1).astype(float),
    }


EVENTS = Method(
    name="events",
    follow=tumbling_motion,
    source="theory 2.3, 5.3",
    accuracy="of fourth order in the step while a corner or a side is on the plane, some 1e-8 of "
    "the energy; exact in flight; endless runs of impacts are cut off at 1e-6 of the fall's speed",
    seconds_a_cell=1e-3,
    course=_trajectory,
)


# --- the system


RESULTS = (
    *fields(
        "tumble",
        "theory 2.1",
        final_pitch=("pitch", "the pitch at the end, with all its turns [rad]"),
        resting_side=(
            "resting_side",
            "the side on the plane at the end, 0 if none [1]",
        ),
    ),
    *fields(
        "tumble",
        "theory 13.5",
        settling_time=(
            "settling_time",
            "the time after which the part stays at rest; NaN where it does not rest [s]",
        ),
    ),
    *fields(
        "tumble",
        "theory 13.4",
        impact_count=("impacts", "the number of impacts [1]"),
        largest_bounce=(
            "largest_bounce",
            "the largest height of the lowest corner after the first impact [m]",
        ),
    ),
    *fields(
        "tumble",
        "theory 13.8",
        drift_velocity=("velocity", "the displacement along the plane over the duration [m s-1]"),
    ),
    *fields(
        "tumble",
        "theory 5.3",
        specific_energy_lost=(
            "energy_lost",
            "the energy per mass that impacts and friction took [J kg-1]",
        ),
    ),
    product(
        "part_energy_lost", "specific_energy_lost", "mass", source="theory 5.3",
        says="the energy that impacts and friction took from a part [J]",
    ),
    *fields(
        "tumble",
        "theory 2.3",
        motion_status=("status", "how the run ended, as a status"),
    ),
)  # fmt: skip
ANY_RESULT = frozenset(equation.gives for equation in RESULTS) | {"regime"}

CONDITIONS = tuple(
    where(
        regime,
        f"the status is {status}",
        lambda *, tumble, status=status: tumble.status == STATUS[status],
        ANY_RESULT,
        otherwise,
    )
    for regime, status, otherwise in (
        ("no_solution", "no_solution", "unresolved"),
        ("rests", "settled", ""),
        ("tumbles", "moving", ""),
    )
)


def _scene(name: str, title: str, part: Callable[..., Body]) -> Scene:
    return Scene(
        name=name,
        title=title,
        source="theory 2, 13",
        validity="A rigid part moves in the vertical plane of the track, with one rotation. It "
        "strikes the plane with its corners, rocks, slides, and comes to rest on a side. After "
        "many impacts with high restitution, the details of the motion depend on rounding.",
        variants={
            "events": (
                Equation("tumbling_part", part, "theory 2.1"),
                THROWN,
                Equation("tumble", tumbling_motion, EVENTS.source),
                *RESULTS,
            )
        },
        default_variant="events",
        conditions={"events": CONDITIONS},
        defaults={
            "gamma": 0.0,
            "gravity": STANDARD_GRAVITY,
            "frequency": 0.0,
            "amplitude": 0.0,
            "beta": 0.0,
            "drop_height": 0.0,
            "pitch": 0.0,
            "pitch_rate": 0.0,
            "velocity_along": 0.0,
            "velocity_upward": 0.0,
        },
        constraints=(STATIC_ABOVE_KINETIC,),
        choice="method",
    )


SCENES = {
    name: _scene(name, title, part)
    for name, title, part in (
        ("rectangle-isolated", "Tumbling rectangular part on a plane", rectangle),
        ("cylinder-isolated", "Tumbling cylindrical part on a plane", cylinder),
    )
}
