"""The seam of motion: the groups that a method takes, the motion that it returns, its record.

The groups are dimensionless: lengths are in g/w^2, velocities in g/w and accelerations in g, where
w is the circular frequency of the drive (theory 13.8). Equal groups move alike, whatever their
size.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.motion.waves import ALONG, NORMAL, Wave, of_columns, position_at
from vibrafeed.core.quantities import MOTION_STATUSES
from vibrafeed.core.scenes import Constraint
from vibrafeed.core.scenes.scene import Condition
from vibrafeed.core.watch import Watch


class Motion(NamedTuple):
    """Motion over a period of the drive once it repeats, in the scales of the drive.

    All arrays have one shape, that of the arguments broadcast. Lengths are in g/w^2, velocities in
    g/w, times in 1/w, where w is the circular frequency (theory 13.8).

    Attributes
    ----------
    velocity : ndarray
        Mean velocity along the track; NaN where there is none.
    spread : ndarray
        Standard deviation of the means of runs from several phases, or of batches of periods; 0
        where the motion repeats.
    error : ndarray
        Estimate of the error of `velocity` by the method itself.
    stick, forward, backward, flight : ndarray
        Fractions of the period; they add up to 1.
    impacts : ndarray
        Impacts on the floor per period; a run of ever smaller hops counts as those resolved.
    landing_speed : ndarray
        Largest speed normal to the floor before an impact.
    hop_height : ndarray
        Largest distance from the floor.
    multiple : ndarray
        Periods of the drive after which the motion repeats; 0 where it does not.
    across : ndarray
        Mean velocity across the track, away from the wall; 0 where the part comes back to a wall,
        and of one that rolls, which keeps the speed that it happens to have.
    status : ndarray of int8
        Value of a `MOTION_STATUSES` entry.
    """

    velocity: Array
    spread: Array
    error: Array
    stick: Array
    forward: Array
    backward: Array
    flight: Array
    impacts: Array
    landing_speed: Array
    hop_height: Array
    multiple: Array
    across: Array
    status: NDArray[np.int8]

    def only(self, name: str) -> Mask:
        """True where a part moves in one way all the time; every other way has share 0.

        `name` is one of `SHARES`.
        """
        others = [getattr(self, other) for other in SHARES if other != name]
        moves = np.asarray(getattr(self, name) > 0)
        return np.logical_and.reduce([moves, *(other == 0 for other in others)])


class Energy(NamedTuple):
    """Means over the cycle of a motion that repeats, per mass, in g^2/w; NaN of any other motion.

    All arrays have the shape of the arguments broadcast.

    Attributes
    ----------
    friction : ndarray
        Energy that friction dissipates while contacts slip.
    impact : ndarray
        What impacts take, the friction in them included.
    drive : ndarray
        The work of the track: friction, impacts, and what lifts the part.
    swing : ndarray
        Mean of u.b', u the velocity relative to the track, b' the derivative of the push by the
        phase: what of the part swings with the track. NaN under a drive that is no plain sine.
    """

    friction: Array
    impact: Array
    drive: Array
    swing: Array


STATUS: Mapping[str, int] = {name: flag.value for name, flag in MOTION_STATUSES.items()}

ANSWERED = ("periodic", "at_rest", "aperiodic", "sensitive", "neutral", "weak_friction")
"""Statuses of cells that have a mean velocity."""

SHARES = ("stick", "forward", "backward", "flight")
"""The modes of motion; each has a share of the period, exactly 0 where it never came."""

COLUMNS = len(Motion._fields) - 1
"""Columns of a kernel's table, one a field of `Motion` in its order, without the status."""


def motion_of(
    table: NDArray[np.float64], status: NDArray[np.int8], shape: tuple[int, ...]
) -> Motion:
    """Return a kernel's result table as a `Motion` of arrays of a shape.

    `table` has a row a cell and a column a field, `status` one value a cell.
    """
    columns = [np.ascontiguousarray(column).reshape(shape) for column in table.T]
    return checked(Motion._make([*columns, status.reshape(shape)]))


def checked(motion: Motion) -> Motion:
    """Return the motion with NaN wherever the status says that there is no result.

    A cell with a value that is not finite, or that was in the air all along without landing, gets
    the status `limit_reached`. With this status all values are NaN, since a method may have got
    some way.
    """
    answered = np.isin(motion.status, [STATUS[name] for name in ANSWERED])
    finite = np.logical_and.reduce([np.isfinite(field) for field in motion[:-1]])
    on_floor = motion.stick + motion.forward + motion.backward
    never_landed = (motion.flight > 0) & (motion.impacts == 0) & (on_floor == 0)
    fails = answered & (~finite | never_landed)
    status = np.where(fails, np.int8(STATUS["limit_reached"]), motion.status)
    has_no_result = status == STATUS["limit_reached"]
    fields = [np.where(has_no_result, np.nan, field) for field in motion[:-1]]
    return with_whole_shares(Motion._make([*fields, status]))


def with_whole_shares(motion: Motion) -> Motion:
    """Return the motion with a share of exactly 1 where a part moves in one way only.

    The stretches of a period add up to the whole of it but for rounding, and rounding differs from
    one processor to the next.
    """
    whole = {name: np.where(motion.only(name), 1.0, getattr(motion, name)) for name in SHARES}
    return motion._replace(**whole)


def where(
    regime: str,
    says: str,
    holds: Callable[..., Mask],
    outputs: Collection[str],
    otherwise: str = "",
) -> Condition:
    """Return the condition of a regime; `says` is as one says after "True where"."""
    holds.__doc__ = f"True where {says}."
    return Condition(regime, holds, frozenset(outputs), otherwise)


def with_status(
    regime: str, names: tuple[str, ...], outputs: Collection[str], otherwise: str = ""
) -> Condition:
    """Return the condition of a regime in which the motion has one of some statuses."""
    values = [STATUS[name] for name in names]
    says = f"the status is {' or '.join(names)}"
    return where(regime, says, lambda *, motion: np.isin(motion.status, values), outputs, otherwise)


Numbers: TypeAlias = Any
"""An array of many parts, or the plain number of one."""


class Groups(NamedTuple):
    """The numbers that the motion of a part depends on; fields broadcast.

    What a scene has not is left at 0, which costs no array.

    Attributes
    ----------
    drive_number_along, drive_number_across, drive_number_normal : array_like
        Components of the drive's acceleration over g: A0 w^2/g times (cos(beta) cos(alpha),
        cos(beta) sin(alpha), sin(beta)).
    gravity_number_along, gravity_number_across, gravity_number_normal : array_like
        sin(gamma), cos(gamma) sin(delta), cos(gamma) cos(delta); the last with all that presses the
        part onto the floor at all times, as a magnet does.
    curvature_number : array_like
        g/(w^2 R); 0 for a straight track.
    friction_static, friction_kinetic : array_like
        Coefficients at the floor.
    wall_friction : array_like
        Coefficient at the wall.
    restitution, wall_restitution : array_like
        Of impacts on the floor and on the wall, 0 to 1.
    impact_damping : array_like
        Of a floor whose restitution falls with the speed of impact, by Hunt and Crossley's law, per
        g/w; `restitution` then plays no part.
    wave : Wave or None
        The drive where it is no plain sine; the drive numbers are then what its push does not
        exceed.
    """

    drive_number_along: Numbers
    drive_number_normal: Numbers
    gravity_number_along: Numbers
    gravity_number_normal: Numbers
    friction_static: Numbers
    friction_kinetic: Numbers
    restitution: Numbers = 0.0
    drive_number_across: Numbers = 0.0
    gravity_number_across: Numbers = 0.0
    curvature_number: Numbers = 0.0
    wall_friction: Numbers = 0.0
    wall_restitution: Numbers = 0.0
    impact_damping: Numbers = 0.0
    wave: Wave | None = None

    @property
    def numbers(self) -> tuple[Numbers, ...]:
        """All fields except the wave."""
        return self[:-1]

    @property
    def drive(self) -> tuple[Numbers, Numbers, Numbers]:
        """The drive numbers along, across and normal."""
        return self.drive_number_along, self.drive_number_across, self.drive_number_normal

    def flat(self) -> "Groups":
        """Return the groups with the numbers set to 0 that planar motion does not use."""
        nothing: dict[str, Any] = dict.fromkeys(ACROSS, 0.0)
        return self._replace(**nothing)

    def single(self) -> "Groups":
        """Return the groups of one part as plain numbers; raise if there are several cells."""
        (part,), _ = each(self)
        return part


ACROSS = (
    "drive_number_across", "gravity_number_across", "curvature_number", "wall_friction",
    "wall_restitution",
)  # fmt: skip
"""Fields that play no part where nothing pushes the part across the track."""


class Contacts(NamedTuple):
    """The surfaces that a part can touch, and how: no number of a cell but what a system is.

    A wall beside the floor, or none; rolling m r^2/I for a cylinder whose axis lies along the
    track, 0 for a block.
    """

    wall: bool = False
    rolling: float = 0.0


BLOCK_ON_FLOOR = Contacts()
SOLID_CYLINDER = 2.0  # m r^2/I of a solid cylinder about its axis


def in_plane(groups: Groups, contacts: Contacts) -> NDArray[np.bool_]:
    """Return a mask of the cells whose motion stays in the vertical plane along the track.

    Nothing pushes such a part across: no drive, no lean and, with a wall, no curve.
    """
    pushed_across = np.not_equal(groups.drive_number_across, 0.0) | np.not_equal(
        groups.gravity_number_across, 0.0
    )
    if contacts.wall:
        pushed_across = pushed_across | np.not_equal(groups.curvature_number, 0.0)
    return np.asarray(~pushed_across)


def table(columns: Iterable[ArrayLike]) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    """Return the columns broadcast to one row per cell, and the shape of the cells."""
    arrays = np.broadcast_arrays(*(np.asarray(column, dtype=np.float64) for column in columns))
    return np.stack([array.ravel() for array in arrays], axis=-1), arrays[0].shape


def cells_of(groups: Groups, **settings: ArrayLike) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    """Return the input of kernels, a row of numbers for each cell, and the shape of the cells.

    The columns are the `groups`, the `settings` of a method, as in `kernels.cells.Cell`, and those
    of the wave, if there is one; all are broadcast.
    """
    columns, wave = (*groups.numbers, *settings.values()), groups.wave
    if wave is None:
        return table(columns)
    rows, shape = table((*columns, np.zeros(wave.cells)))
    return np.concatenate([rows[:, :-1], wave.columns(shape)], axis=1), shape


def groups_of(
    rows: NDArray[np.float64], has_wave: bool, setting_count: int = 0
) -> tuple[Groups, NDArray[np.float64]]:
    """Return the groups of cells, and `setting_count` settings as arrays; inverse of `cells_of`."""
    numbers = len(Groups._fields) - 1
    columns = rows.T
    wave = of_columns(rows[:, numbers + setting_count :]) if has_wave else None
    return Groups._make((*columns[:numbers], wave)), columns[numbers : numbers + setting_count]


def each(groups: Groups) -> tuple[Iterator[Groups], tuple[int, ...]]:
    """Return an iterator over the groups of each cell as plain numbers, and the cells' shape."""
    rows, shape = cells_of(groups)
    whole, _ = groups_of(rows, groups.wave is not None)

    def of(cell: int) -> Groups:
        wave = None if whole.wave is None else Wave(*(array[..., cell] for array in whole.wave))
        return Groups._make((*(float(number[cell]) for number in whole.numbers), wave))

    return map(of, range(len(rows))), shape


def of_quantities(*, load_number: Array, **numbers: Any) -> Groups:
    """Return the groups from quantities of their names; `load_number` is gravity onto the floor."""
    return Groups(gravity_number_normal=load_number, **numbers)


def displacement(groups: Groups, axis: int, phases: Array) -> Array:
    """Return the displacement of the track along an axis, in g/w^2, of one part."""
    if groups.wave is None:
        return np.asarray(groups.drive[axis] * np.sin(phases))
    return position_at(groups.wave, axis, phases)


TIME = "cycle_time"
"""The axis of a trajectory."""

Follow = Callable[..., Any]
"""An equation: takes by keyword a part's numbers, the settings that it needs and a `watch`; returns
a `Motion`, or a `Tumble` of a part that tumbles, or the `Energy` of a motion."""

Trajectory = dict[str, NDArray[Any]]
"""By name `TIME` [s], and what the part does at these times, in SI units."""


class Path(NamedTuple):
    """Positions and velocities of one part relative to the track, at given phases.

    Attributes
    ----------
    phase : ndarray, shape (n,)
    position : ndarray, shape (n, 3)
        Along, across (from the wall) and normal to the floor, in g/w^2.
    velocity : ndarray, shape (n, 3)
        In g/w. NaN, as is the position, where the contact laws had no solution.
    """

    phase: Array
    position: Array
    velocity: Array


class Burst(NamedTuple):
    """The way of a part in a burst [g/w^2], and the phase from its end to the part's rest [rad].

    The way counts on the track; NaN where the part does not come to rest.
    """

    travel: Array
    coasting: Array


class TrajectoryRequest(NamedTuple):
    """The times at which a study asks for a trajectory, and the scales of it.

    Attributes
    ----------
    samples : int or tuple of float
        Equal steps of the cycle, or times [s].
    arguments : mapping
        Those of the equation that followed the part, each of one value.
    known : mapping
        Every quantity of the plan.
    watch : Watch
        May stop it; what was not reached is NaN.
    """

    samples: int | tuple[float, ...]
    arguments: Mapping[str, Any]
    known: Mapping[str, Any]
    watch: Watch

    @property
    def groups(self) -> Groups:
        """The dimensionless numbers of the part that is followed."""
        return self.arguments["groups"].single()

    def scale(self, name: str) -> float:
        """Return a scale of the drive in SI units by its name, such as `velocity_scale` [m s-1]."""
        return self.known[name].item()

    def times(self) -> tuple[Array, Array]:
        """Return the asked times [s] and drive phases [rad]; a number of them over one cycle."""
        circular_frequency = self.scale("velocity_scale") / self.scale("length_scale")
        if isinstance(self.samples, int):
            cycle = np.nan_to_num(self.known["motion"].multiple.item(), nan=1.0)
            phases = np.linspace(0.0, 2 * np.pi * max(1.0, cycle), self.samples + 1)
            return phases / circular_frequency, phases
        times = np.array(self.samples)
        return times, circular_frequency * times

    def trajectory(self, path: Path, modes: NDArray[np.int8], wall: bool) -> Trajectory:
        """Return the trajectory in SI units, with the displacement of the track.

        `modes` has one `MOTION_MODES` value a time. The distance from the wall is given if there is
        a `wall`.
        """
        times, phases = self.times()
        speed, length = self.scale("velocity_scale"), self.scale("length_scale")
        position, velocity = path.position, path.velocity
        along, normal = (
            length * displacement(self.groups, axis, phases) for axis in (ALONG, NORMAL)
        )
        values = {
            TIME: times,
            "position_along": position[:, 0] * length,
            "height_above_floor": position[:, 2] * length,
            "relative_velocity_along": velocity[:, 0] * speed,
            "relative_velocity_normal": velocity[:, 2] * speed,
            "track_along": along,
            "track_normal": normal,
        }
        if wall:
            values["distance_from_wall"] = position[:, 1] * length
        return {**values, "motion_mode": modes}


@dataclass(frozen=True)
class Method:
    """One way to follow the motion of a part: what it takes, costs, knows of its error, refuses.

    Attributes
    ----------
    name : str
        As a study names it.
    follow : callable
        Follows cells; its first sentence is that of the equation. It takes the `Contacts` of a
        conveying system, too.
    source : str
        Where the theory tells of it.
    accuracy : str
        What is known of its error, in words.
    seconds_a_cell : float
        Roughly the time of a cell on one core [s], for cells that it verifies, and where its code
        is not compiled yet; other prices are measured.
    defaults : mapping of str to float
        Its settings where a study leaves them out.
    course : callable or None
        Takes a `TrajectoryRequest` and the `Contacts` of a system; returns the `Trajectory` of one
        part. None if the method gives means only.
    energy : callable or None
        Gives the `Energy` of a `Motion`; takes the `Contacts` of a system, too. None if the method
        does not tell it.
    checked_by : tuple of str
        The methods by which it is verified, the most exact first.
    refuses : tuple of Constraint
        What a study must respect that asks for it.
    follows : callable
        Takes the `Contacts` of a system; returns whether the method can follow it.
    """

    name: str
    follow: Follow
    source: str
    accuracy: str
    seconds_a_cell: float
    defaults: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    course: Callable[[TrajectoryRequest, Contacts], Trajectory] | None = None
    energy: Follow | None = None
    checked_by: tuple[str, ...] = ()
    refuses: tuple[Constraint, ...] = ()
    follows: Callable[[Contacts], bool] = lambda contacts: True
