"""Time stepping of a part in space, with floor and wall, in a curve, rolling (theory 13.1, 13.9).

The midpoint rule of Moreau and Jean with Newton's impact law, over a step h from t to t + h:

    u(t + h) = u(t) + h a(t + h/2) + i,    q(t + h) = q(t) + h (u(t) + u(t + h))/2,

where the impulses i of the contacts that touch at t + h/2 obey the laws of impact and friction. It
is of first order in the step; planar motion has an exact method elsewhere. Where the push of the
drive jumps, a step ends and another begins: within a step the push is smooth, and what a jump tears
loose slips from there on. (A mean of the push over a step that holds a jump would give the right
impulse to a part that slides, but not to one that sticks up to the jump: its slip would begin too
fast or too slow by what a step changes.)
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion import compiled
from vibrafeed.core.motion.cells import run_cells
from vibrafeed.core.motion.course import TrajectoryRequest, TrajectoryValues
from vibrafeed.core.motion.groups import BLOCK_ON_FLOOR, Contacts, Groups, cells_of
from vibrafeed.core.motion.method import Follow, FollowCourse, Method
from vibrafeed.core.motion.path import Path
from vibrafeed.core.motion.result import SHARES, Motion, motion_of, with_whole_shares
from vibrafeed.core.motion.steps import drives_of, sines_at
from vibrafeed.core.motion.waves import TURN, of_columns
from vibrafeed.core.quantities import MOTION_MODES
from vibrafeed.core.watch import Watch

FEWEST = 8  # steps of a period, and periods
MAX_STEPS = 100_000_000
"""Most steps of a path, and most steps of a period times periods of a cell. More is refused: it is
probably a mistyped number, and would keep a processor busy for minutes."""


ROOM = 1_000_000
"""Most numbers in the drives of cells that are computed together, unless it is one cell."""

SLOW = 1e-9  # in g/w: normal velocity up to which a part counts as on the floor


def stepped_motion(
    groups: Groups,
    contacts: Contacts = BLOCK_ON_FLOOR,
    *,
    planar: bool = False,
    absolute_speed: bool = True,
    steps_per_period: int = 1000,
    max_periods: int = 200,
    tolerance: float = 1.0,
    watch: Watch | None = None,
) -> Motion:
    """Return the motion of parts on the floor, and at the wall if there is one, by time stepping.

    The part starts at rest on the floor, touching the wall, at phase 0. Each cell runs with n =
    `steps_per_period` steps and with 2n + 1. `velocity` and all else are those of the finer run,
    not extrapolated over the step: landings fall within steps at places that differ from run to
    run, so that the error, though of first order, is no smooth function of the step, and an
    extrapolation would amplify its irregular part. For the same reason there is a third run, with n
    steps from half a step earlier. `error` is three times the largest of the differences of the
    velocity to both coarser runs, the uncertainty of the transient's end, and `spread`; with hops a
    seventh of what a step changes is added, since all runs may agree by chance (theory 13.9).

    The motion is `periodic` if it comes back exactly, or over 16 periods to within a small part of
    what one step changes, or, after four times as many, to within what one step changes. A
    transient without hops that dies out slowly is extrapolated to its end. If it does not come
    back, means are over the last three quarters of the periods run, and `spread` is the standard
    deviation of the means of 16 batches of them.

    Without hops the planar method is of second order: slips start and stop within a step. With
    hops, in space and in a curve, it is of first order. Where static friction exceeds kinetic, a
    slip in space that nearly stops, nearer than a step can tell, is taken to stop.

    Parameters
    ----------
    groups : Groups
        Dimensionless groups of the cells. Static friction holds what sticks and what stops; those
        of the wall have no effect without one.
    contacts : Contacts
        The surfaces that a part can touch. Without a wall the position across is not carried. The
        contact of a cylinder slips across with the speed of the centre less that of the surface.
    planar : bool
        True if nothing across the track is carried at all: for a drive along it (alpha = 0), no
        wall and no lean. With these values either way finds the same numbers.
    absolute_speed : bool
        True if the centripetal acceleration is that of the speed in space; else of the speed
        relative to the track.
    steps_per_period : int
        Steps of the coarser run, at least 8.
    max_periods : int
        Periods after which a motion counts as aperiodic, at least 8.
    tolerance : float
        Largest difference of states that counts as coming back, over the largest change of velocity
        in one step.
    watch : Watch, optional
        May stop the work; cells not computed have the status `not_computed`.

    Returns
    -------
    Motion
        Arrays of the shape of the groups broadcast. `stick` is the share in which the floor contact
        does not move along the track; `flight` that in which the floor carries nothing.

    Raises
    ------
    ValueError
        If a count is out of its range.
    """
    _check(steps_per_period, max_periods, tolerance, contacts)
    cells, shape = cells_of(groups, tolerance=tolerance, max_periods=max_periods)
    fine = 2 * steps_per_period + 1  # odd, so that no middle of a step is one of both
    grids = ((steps_per_period, 0.0), (steps_per_period, -0.5), (fine, 0.0))
    sines = [sines_at(*grid) for grid in grids]
    if planar:
        scene, rolling, absolute_speed = compiled.stepping.PLANAR, 0.0, False
    else:
        scene, rolling = (
            compiled.stepping.WALL if contacts.wall else compiled.stepping.FLOOR,
            float(contacts.rolling),
        )

    def kernel(
        piece: NDArray[np.float64],
        rows: NDArray[np.float64],
        status: NDArray[np.int8],
        stop: NDArray[np.int8],
    ) -> None:
        """Run the time-stepping kernel on a piece of the cells."""
        numbers, columns = np.split(piece, [compiled.stepping.GROUPS], axis=1)
        coarse, shifted, finer = sines
        if columns.size:
            wave = of_columns(columns)
            coarse, shifted, finer = (drives_of(wave, n, TURN / n * shift) for n, shift in grids)
        compiled.stepping.step_cells(
            scene, rolling, absolute_speed, steps_per_period, coarse, shifted, finer,
            np.ascontiguousarray(numbers), rows, status, stop,
        )  # fmt: skip

    # A cell takes milliseconds: small pieces let a run be stopped soon and share out evenly.
    piece = 32 if groups.wave is None else max(1, min(32, ROOM // (28 * steps_per_period)))
    motion = motion_of(*run_cells(kernel, cells, piece=piece, watch=watch), shape)
    return without_landing_steps(motion, fine)


def without_landing_steps(motion: Motion, steps: int) -> Motion:
    """Return a motion by time stepping without the floor time of steps in which a part only lands.

    A landing takes one step of the `steps` a period, in which the floor pushes; in truth it takes
    no time. If no step of a period is on the floor but those of its impacts, the part hops after
    each impact: it is in the air all the time, and gets `flight` 1 and no other share.

    Both sides are counts over whole periods, kept as means: they are equal but for rounding, or
    apart by one in all steps of a path, which are `MAX_STEPS` at most.
    """
    floor = motion.stick + motion.forward + motion.backward
    room = 1.0 + 0.1 / MAX_STEPS
    lands = (motion.impacts > 0) & (floor * steps <= motion.impacts * room)
    others = {name: np.where(lands, 0.0, getattr(motion, name)) for name in SHARES}
    return with_whole_shares(motion._replace(**{**others, "flight": motion.flight}))


def stepped_path(
    groups: Groups,
    contacts: Contacts = BLOCK_ON_FLOOR,
    *,
    phases: ArrayLike,
    absolute_speed: bool = True,
    steps_per_period: int = 1000,
    position: Sequence[float] = (0.0, 0.0, 0.0),
    velocity: Sequence[float] = (0.0, 0.0, 0.0),
    spin: float = 0.0,
    watch: Watch | None = None,
) -> Path:
    """Return one part's positions at given phases, by time stepping from a given state.

    Parameters
    ----------
    groups, contacts
        Dimensionless groups of the part, and the surfaces that it can touch; the latter and
        `absolute_speed` (the speed in space, not that on the track, counts in a curve) as in
        `stepped_motion`.
    phases : array_like, shape (n,)
        Ascending, in rad; the steps, 2 pi/`steps_per_period` long, are counted from the first.
    position, velocity : sequence of 3 floats
        At the first phase, along, across and normal, in g/w^2 and g/w (w = 2 pi f).
    spin : float
        Velocity across that the spin of a cylinder gives its lowest point; rolling has minus the
        velocity across. Of a block 0.
    watch : Watch, optional
        May stop the work; positions that were not reached are NaN.

    Raises
    ------
    ValueError
        If phases are not finite and ascending, or need more than `MAX_STEPS` steps.
    """
    asked = np.atleast_1d(np.asarray(phases, dtype=np.float64))
    if asked.ndim != 1 or asked.size == 0 or not np.all(np.isfinite(asked)):
        raise ValueError("the argument phases has to be a one-dimensional array of finite numbers")
    if np.any(np.diff(asked) < 0.0):
        raise ValueError("phases must ascend")
    _check(steps_per_period, 8, 1.0, contacts)
    step = 2.0 * math.pi / steps_per_period
    steps = (asked[-1] - asked[0]) / step
    if steps > MAX_STEPS:
        raise ValueError(
            f"the phases take {steps:.3g} time steps; the limit is {MAX_STEPS:,}: give "
            "smaller phases, or fewer steps_per_period"
        )
    (row,), _ = cells_of(groups, tolerance=0.0, max_periods=0.0)
    cell, columns = np.split(row, [compiled.stepping.GROUPS])
    start = np.array([*position, *velocity, spin], dtype=np.float64)
    if start.size != 7 or not (np.all(np.isfinite(row)) and np.all(np.isfinite(start))):
        raise ValueError("groups, position (3 numbers) and velocity (3 numbers) have to be finite")
    wave, most = np.zeros((0, 0)), math.ceil(steps) + 1
    if columns.size:
        wave = drives_of(of_columns(columns[np.newaxis]), steps_per_period, asked[0])[0]
        most += math.ceil(most / steps_per_period) * (wave.shape[1] - steps_per_period)
    positions, speeds = np.full((asked.size, 3), np.nan), np.full((asked.size, 3), np.nan)
    with (watch or Watch()).flag() as stop:
        compiled.stepping.path(
            contacts.wall, float(contacts.rolling), absolute_speed, cell, asked, step,
            most, start, wave, positions, speeds, stop,
        )  # fmt: skip
    return Path(asked, positions, speeds)


def _check(steps_per_period: int, max_periods: int, tolerance: float, contacts: Contacts) -> None:
    """Raise ValueError if a setting of time stepping is out of range, or a cell takes too long.

    The counts must be at least `FEWEST`, 4 steps_per_period max_periods at most `MAX_STEPS`, and
    the other numbers finite and not negative. `tolerance` is the relative one of the state's
    return, `contacts.rolling` is m r^2/I of a cylinder.
    """
    if steps_per_period < FEWEST or max_periods < FEWEST:
        raise ValueError(
            f"the arguments steps_per_period and max_periods have to be at least {FEWEST}"
        )
    if 4 * steps_per_period * max_periods > MAX_STEPS:
        raise ValueError(
            "a cell takes steps_per_period * max_periods steps, and the limit is "
            f"{MAX_STEPS:,}: reduce one of the two"
        )
    rolling = contacts.rolling
    if not (tolerance >= 0.0 and rolling >= 0.0 and math.isfinite(tolerance + rolling)):
        raise ValueError("the arguments tolerance and rolling have to be finite and at least 0")


def _follow(contacts: Contacts) -> Follow:
    """Return the function of the motion equation by time steps, for parts with these contacts.

    It follows the motion in the plane if there is no wall, and neither drive nor gravity acts
    across.
    """

    def motion(
        *, groups: Groups, steps_per_period: Array, max_periods: Array, watch: Watch | None = None
    ) -> Motion:
        """Return the motion from rest by the midpoint rule of Moreau and Jean, theory 13.9."""
        return stepped_motion(
            groups,
            contacts,
            planar=not contacts.wall and groups.planar,
            steps_per_period=int(steps_per_period),
            max_periods=int(max_periods),
            watch=watch,
        )

    return motion


def _trajectory(contacts: Contacts) -> FollowCourse:
    """Return the function that computes a part's trajectory by time steps, for these contacts.

    The trajectory is shown after as many periods from rest as the study follows the part for; the
    steps are those of the finest run that gave its mean.
    """

    def trajectory(asked: TrajectoryRequest) -> TrajectoryValues:
        """Return the trajectory of the part at the asked times, after the transient."""
        _, phases = asked.times()
        steps = 2 * int(asked.setting("steps_per_period")) + 1
        before = 2 * np.pi * asked.setting("max_periods")
        path = stepped_path(
            asked.groups,
            contacts,
            steps_per_period=steps,
            phases=np.concatenate([[0.0], before + phases]),
            watch=asked.watch,
        )
        position, velocity = path.position[1:], path.velocity[1:]
        modes = _modes(asked.groups, position, velocity, steps)
        # A part in contact sinks in by a step of its fall.
        shown = np.column_stack([position[:, 0], np.maximum(position[:, 1:], 0.0)])
        return asked.trajectory(shown, velocity, modes, contacts.wall, shown[0, 0])

    return trajectory


def _modes(groups: Groups, position: Array, velocity: Array, steps: int) -> NDArray[np.int8]:
    """Return the motion mode of a part at each of n points of its path, shape (n,).

    Codes of stick, forward, backward and flight, judged by velocity and height; `unknown` where the
    position is NaN. `position` and `velocity`, shape (n, 3), along, across and normal, are in g/w^2
    and g/w (w = 2 pi f); `steps` is the number of time steps a period, whose length sets the height
    that counts as contact.
    """
    # On the floor the normal velocity is 0; gaps below what the drive covers in a step are the
    # method's own.
    gap = abs(groups.drive_number_normal) * (2 * np.pi / steps) ** 2
    flies = (np.abs(velocity[:, 2]) > SLOW) | (position[:, 2] > gap)
    slides = np.where(velocity[:, 0] > 0, "forward", "backward")
    modes = np.where(flies, "flight", slides)
    modes = np.where((modes != "flight") & (velocity[:, 0] == 0), "stick", modes)
    modes = np.where(np.isnan(position[:, 0]), "unknown", modes)
    return np.array([MOTION_MODES[mode].value for mode in modes.tolist()], dtype=np.int8)


TIME_STEPPING = Method(
    name="time-stepping",
    follow=_follow,
    source="theory 13.1, 13.9",
    accuracy="of first order in the step; of second for a planar motion without hops",
    seconds_a_cell=0.05,
    defaults={"steps_per_period": 1000.0, "max_periods": 200.0},
    course=_trajectory,
    most_steps=MAX_STEPS,
    checked_by=("events", "reference"),
)
