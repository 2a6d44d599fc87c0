"""From event to event (theory 13.2 to 13.8); in space by power series (13.13).

In the plane of the track and its normal, in each mode of contact, the equation of motion is that of
one driven mass,

    u' = C sin(tau) - k,    v(tau) = v0 + C (cos tau0 - cos tau) - k (tau - tau0),

whose ends (lift-off, landing, stop, start of a slip) are isolated roots: exact up to rounding.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion import compiled, planar
from vibrafeed.core.motion.cells import run_cells
from vibrafeed.core.motion.course import Path, TrajectoryRequest, TrajectoryValues
from vibrafeed.core.motion.groups import Contacts, Groups, cells_of, groups_of, in_plane
from vibrafeed.core.motion.method import Follow, FollowCourse, Method
from vibrafeed.core.motion.result import STATUS, Energy, Motion, motion_of
from vibrafeed.core.quantities import MOTION_MODES
from vibrafeed.core.watch import Watch


class EventPath(NamedTuple):
    """The motion of one part at asked phases of its cycle, in the scales of `Motion`.

    Attributes
    ----------
    phase : ndarray, shape (n,)
        Phase of the drive, from the start of a period.
    along, height : ndarray, shape (n,)
        Position on the track, from that at the first phase, and distance from the floor.
    velocity_along, velocity_normal : ndarray, shape (n,)
        Velocities relative to the track.
    mode : ndarray of int8, shape (n,)
        Value of a `MOTION_MODES` entry.
    """

    phase: Array
    along: Array
    height: Array
    velocity_along: Array
    velocity_normal: Array
    mode: NDArray[np.int8]


def planar_motion(
    groups: Groups, *, tolerance: ArrayLike, max_periods: ArrayLike, watch: Watch | None = None
) -> Motion:
    """Return the motion of parts in the plane that start at rest on the floor, event by event.

    Exact but for rounding where the motion repeats: every flow is closed, every event is isolated
    (theory 13.2 to 13.8). `groups` are the dimensionless groups of the cells. `tolerance` bounds
    the error of the sliding velocity at the start of the cycle, as a share of the drive;
    `max_periods` bounds how long an aperiodic motion is followed; `watch` may stop the work. Equal
    cells are computed once; restitution does not count in a cell that never lifts off. Where it
    falls with speed, hops that never end pass for a stay on the floor once they are small; `error`
    holds what that leaves out.
    """
    lifts = np.abs(groups.drive_number_normal) > groups.gravity_number_normal
    plain = groups.flat()._replace(restitution=np.where(lifts, groups.restitution, 0.0))
    if np.any(groups.impact_damping):
        plain = plain._replace(impact_damping=np.where(lifts, groups.impact_damping, 0.0))
    cells, shape = cells_of(plain, tolerance=tolerance, max_periods=max_periods)
    return motion_of(*run_cells(planar.solve_cells, cells, watch=watch), shape)


def planar_path(
    groups: Groups,
    *,
    tolerance: float,
    max_periods: float,
    phases: Array,
    watch: Watch | None = None,
) -> EventPath:
    """Return the exact motion of one part in the plane at phases from the start of its cycle.

    Positions and velocities along and normal, in g/w^2 and g/w (w = 2 pi f), and modes.

    Parameters
    ----------
    groups : Groups
        Dimensionless groups of one part.
    tolerance, max_periods : float
        As in `planar_motion`.
    phases : ndarray, shape (n,)
        Phases in rad from the start of a period of the drive, at least 0; beyond the cycle's end
        the motion goes on with the next one. An aperiodic motion is shown over the last stretch
        that was followed, some periods long; beyond it all is NaN, and the mode is unknown.
    watch : Watch, optional
        May stop the work; all is NaN then.
    """
    (cell,), _ = cells_of(groups, tolerance=tolerance, max_periods=max_periods)
    with (watch or Watch()).flag() as stop:
        pieces, shift, way, repeats = planar.follow(cell, stop)
    samples = planar.sample(pieces, cell, shift, phases, repeats)
    return EventPath(
        phases,
        way * samples[:, 0],
        samples[:, 1],
        way * samples[:, 2],
        samples[:, 3],
        _modes(samples[:, 4], way),
    )


def _modes(values: Array, way: float) -> NDArray[np.int8]:
    """Return motion modes as integers, forward and backward exchanged if `way` is -1 (mirrored).

    `values` holds modes as floats, shape (n,). The kernel mirrors a sine so that its amplitudes
    along and normal are positive, and then `way` is -1 if the direction of the track is mirrored.
    """
    modes = values.astype(np.int8)
    forward, backward = MOTION_MODES["forward"].value, MOTION_MODES["backward"].value
    if way < 0:
        turned = {forward: backward, backward: forward}
        modes = np.array([turned.get(mode, mode) for mode in modes.tolist()], dtype=np.int8)
    return modes


# --- in space, by power series


MAX_TURNS = 100_000
"""Periods of the drive that a trajectory may show, as many as a study may follow a part."""


def spatial_motion(
    groups: Groups,
    contacts: Contacts,
    *,
    tolerance: ArrayLike,
    max_periods: ArrayLike,
    watch: Watch | None = None,
) -> Motion:
    """Return the motion of parts in space that start at rest on the floor, touching the wall.

    From event to event, by power series of each contact mode, until the state comes back (theory
    13.13). The field `error` is twice the difference to other runs (shorter series; with rebounds a
    slightly smaller restitution), plus the rest of the transient and 2e-10 of the drive's speed.

    Parameters
    ----------
    groups : Groups
        Dimensionless groups of the cells; those of the wall have no effect without a wall.
    contacts : Contacts
        What the part can touch, and m r^2/I of a cylinder.
    tolerance : array_like
        Of the state's return after a cycle, as a share of the drive's speed.
    max_periods : array_like
        Periods after which a motion counts as aperiodic.
    watch : Watch, optional
        May stop the work; cells not computed have the status `not_computed`.
    """
    cells, shape = cells_of(groups, tolerance=tolerance, max_periods=max_periods)

    def kernel(
        piece: NDArray[np.float64],
        rows: NDArray[np.float64],
        status: NDArray[np.int8],
        stop: NDArray[np.int8],
    ) -> None:
        """Run the kernel of motions in space on a piece of the cells."""
        compiled.track.solve_cells(
            contacts.wall, float(contacts.rolling), piece, rows, status, stop
        )

    return motion_of(*run_cells(kernel, cells, piece=32, watch=watch), shape)


def spatial_path(
    groups: Groups,
    contacts: Contacts,
    *,
    tolerance: float,
    max_periods: float,
    phases: Array,
    watch: Watch | None = None,
) -> tuple[Path, NDArray[np.int8]]:
    """Return positions and modes of one part at ascending phases from the start of its cycle.

    A motion that does not repeat is shown after as many periods as it is followed for. What the
    watch did not let it reach is NaN.

    Parameters
    ----------
    groups : Groups
        Dimensionless numbers of the part.
    contacts : Contacts
        What the part can touch, and if it rolls.
    tolerance : float
        Largest error of a periodic state, as a share of the drive.
    max_periods : float
        Most periods to follow.
    phases : ndarray
        Phases in rad.
    watch : Watch, optional
        May stop the work.

    Raises
    ------
    ValueError
        If phases are negative, do not ascend, or are beyond `MAX_TURNS` periods.
    """
    if phases.size and (phases[0] < 0.0 or np.any(np.diff(phases) < 0.0)):
        raise ValueError("the argument phases has to hold numbers of at least 0 in ascending order")
    if phases.size and phases[-1] > MAX_TURNS * 2 * np.pi:
        raise ValueError(f"phases reach beyond {MAX_TURNS:,} periods")
    (cell,), _ = cells_of(groups, tolerance=tolerance, max_periods=max_periods)
    with (watch or Watch()).flag() as stop:
        samples = compiled.track.follow(contacts.wall, float(contacts.rolling), cell, phases, stop)
    return Path(phases, samples[:, :3], samples[:, 3:6]), samples[:, 6].astype(np.int8)


def spatial_trajectory(
    asked: TrajectoryRequest, contacts: Contacts, *, tolerance: float, max_periods: float
) -> TrajectoryValues:
    """Return the trajectory of one part over a cycle, or at the times of the request.

    `asked` is the request, `contacts` what the part can touch, `tolerance` and `max_periods` are
    those of `spatial_path`.
    """
    settings = {"tolerance": tolerance, "max_periods": max_periods}
    _, phases = asked.times()
    path, modes = spatial_path(asked.groups, contacts, **settings, phases=phases, watch=asked.watch)
    start = path.position[0, 0]
    return asked.trajectory(path.position, path.velocity, modes, contacts.wall, start)


def motion_by_events(
    groups: Groups,
    contacts: Contacts,
    *,
    tolerance: ArrayLike,
    max_periods: ArrayLike,
    watch: Watch | None = None,
) -> Motion:
    """Return the motion of parts from rest: in closed form in the plane, by power series in space.

    Parameters
    ----------
    groups, contacts
        Dimensionless groups of the cells, and the surfaces that a part can touch. A cylinder that
        slides along its axis moves as a block does. In space there is no solution if restitution
        falls with speed.
    tolerance
        Error of the state at which a motion counts as repeating, as a share of the drive.
    max_periods
        Periods after which a motion counts as aperiodic.
    watch
        May stop the work; cells not computed have the status `not_computed`.
    """
    settings = {"tolerance": tolerance, "max_periods": max_periods}
    plane = in_plane(groups, contacts)
    if plane.all():
        return planar_motion(groups, **settings, watch=watch)
    if not plane.any():
        return _in_space(groups, contacts, **settings, watch=watch)
    rows, shape = cells_of(groups, **settings, plane=plane)
    flat = plane if plane.shape == shape else np.broadcast_to(plane, shape)
    where = flat.ravel()
    results = []
    for mask in (where, ~where):
        some, more = groups_of(rows[mask], groups.wave is not None, 3)
        given = dict(zip(settings, more, strict=False))
        results.append(
            planar_motion(some, **given, watch=watch)
            if mask is where
            else _in_space(some, contacts, **given, watch=watch)
        )
    fields = []
    for flat, spatial in zip(*results, strict=True):
        field = np.empty(where.size, dtype=flat.dtype)
        field[where], field[~where] = flat, spatial
        fields.append(field.reshape(shape))
    return Motion._make(fields)


def _in_space(
    groups: Groups,
    contacts: Contacts,
    *,
    tolerance: ArrayLike,
    max_periods: ArrayLike,
    watch: Watch | None = None,
) -> Motion:
    """Return the motion of parts in space; `no_solution` where restitution depends on speed.

    `groups`, `contacts` and the settings are those of `motion_by_events`; the kernel in space knows
    one constant restitution only.
    """
    settings = {"tolerance": tolerance, "max_periods": max_periods}
    motion = spatial_motion(groups, contacts, **settings, watch=watch)
    falls = np.not_equal(groups.impact_damping, 0.0)
    if not falls.any():
        return motion
    fields = {name: np.where(falls, np.nan, value) for name, value in motion._asdict().items()}
    status = np.where(falls, np.int8(STATUS["no_solution"]), motion.status)
    return Motion(**{**fields, "status": status})


def energy_by_events(
    groups: Groups,
    contacts: Contacts,
    motion: Motion,
    *,
    tolerance: ArrayLike,
    max_periods: ArrayLike,
    watch: Watch | None = None,
    averages: bool = False,
) -> Energy:
    """Return the mean powers of friction, impacts and drive over a cycle of motion, per mass.

    NaN for motions that do not repeat. In units of g^2/w, w = 2 pi f (theory 13.15).

    Parameters
    ----------
    groups, contacts
        Dimensionless groups of the cells, and the surfaces that a part can touch.
    motion
        Motion of the same groups and settings; its cycle is followed once more, in the plane
        exactly, in space to some 1e-10 of the drive's work.
    tolerance, max_periods
        Settings of the method.
    watch
        May stop the work.
    averages
        True for means over a long stretch of planar motions that do not repeat, which scatter by
        some per cent.
    """

    def in_space(
        piece: NDArray[np.float64],
        rows: NDArray[np.float64],
        status: NDArray[np.int8],
        stop: NDArray[np.int8],
    ) -> None:
        """Run the energy kernel for motion in space on a piece of the cells."""
        compiled.track.spend_cells(
            contacts.wall, float(contacts.rolling), piece, rows, status, stop
        )

    settings = {"tolerance": tolerance, "max_periods": max_periods}
    plane = in_plane(groups, contacts)
    wanders = averages & np.isin(motion.status, [STATUS["aperiodic"], STATUS["sensitive"]])
    rows, shape = cells_of(
        groups, **settings, plane=plane, repeats=motion.multiple > 0, wanders=wanders
    )
    some, (*columns, plane, repeats, wanders) = groups_of(rows, groups.wave is not None, 5)
    table = np.full((len(rows), len(Energy._fields)), np.nan)
    inputs = dict(zip(settings, columns, strict=True))
    for part, kernel, piece, here in (
        (some.flat(), planar.spend_cells, 256, plane * repeats),
        (some, in_space, 32, (1.0 - plane) * repeats),
        (some.flat(), planar.average_spent, 4, plane * wanders * (1.0 - repeats)),
    ):
        which = here > 0.0
        if which.any():
            cells, _ = cells_of(part, **inputs)
            table[which], _ = run_cells(
                kernel, cells[which], columns=table.shape[1], piece=piece, watch=watch
            )
    return Energy(*(np.ascontiguousarray(column).reshape(shape) for column in table.T))


def _follow(contacts: Contacts) -> Follow:
    """Return the function of the motion equation that follows parts from event to event.

    `contacts` are the surfaces that the part can touch. The function is part of the method
    `events`; it takes dimensionless groups and the settings of the method.
    """

    def motion(
        *, groups: Groups, tolerance: Array, max_periods: Array, watch: Watch | None = None
    ) -> Motion:
        """Return the motion from rest from event to event, theory 13.2 to 13.8, 13.13."""
        return motion_by_events(
            groups, contacts, tolerance=tolerance, max_periods=max_periods, watch=watch
        )

    return motion


def _energy(contacts: Contacts) -> Follow:
    """Return the function of the energy equation for parts that are followed by events.

    `contacts` are the surfaces that a part can touch. The function takes groups, motion and
    settings, and returns the mean powers over a cycle.
    """

    def energy(
        *,
        groups: Groups,
        motion: Motion,
        tolerance: Array,
        max_periods: Array,
        watch: Watch | None = None,
    ) -> Energy:
        """Return the work of friction, impacts and drive over a cycle (theory 13.15)."""
        silent = None if watch is None else replace(watch, progress=None)
        return energy_by_events(
            groups, contacts, motion, tolerance=tolerance, max_periods=max_periods, watch=silent
        )

    return energy


def _trajectory(contacts: Contacts) -> FollowCourse:
    """Return the function that computes the trajectory of a part at asked times, by events.

    `contacts` are the surfaces that the part can touch. In the plane the pieces of motion are known
    in closed form, in space they are power series.
    """

    def trajectory(asked: TrajectoryRequest) -> TrajectoryValues:
        """Return the trajectory of the part at the asked times."""
        settings = {name: asked.setting(name) for name in ("tolerance", "max_periods")}
        if not in_plane(asked.groups, contacts):
            return spatial_trajectory(asked, contacts, **settings)
        _, phases = asked.times()
        path = planar_path(asked.groups, **settings, phases=phases, watch=asked.watch)
        nothing = np.zeros_like(path.along)
        position = np.stack([path.along, nothing, path.height], axis=1)
        velocity = np.stack([path.velocity_along, nothing, path.velocity_normal], axis=1)
        return asked.trajectory(position, velocity, path.mode, contacts.wall)

    return trajectory


EVENTS = Method(
    name="events",
    follow=_follow,
    source="theory 13.2-13.8, 13.13",
    accuracy="rounding, where the motion repeats",
    seconds_a_cell=1e-4,
    defaults={"tolerance": 1e-12, "max_periods": 1000.0},
    course=_trajectory,
    energy=_energy,
    checked_by=("reference",),
)
