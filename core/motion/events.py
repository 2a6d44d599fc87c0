"""From event to event (theory 13.2 to 13.8); in space by power series (13.13).

In the plane of the track and its normal, in each mode of contact, the equation of motion is that of
one driven mass,

    u' = C sin(tau) - k,    v(tau) = v0 + C (cos tau0 - cos tau) - k (tau - tau0),

whose ends (lift-off, landing, stop, start of a slip) are isolated roots: exact up to rounding.

Each kernel is compiled when it is first called, for a sine and for other waves apart, and together
they take half a minute: cells under a sine do not wait for what other waves need, nor those that
repeat for those that do not. What a sine earns: see `kernels.planar`.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion import kernel_calls
from vibrafeed.core.motion.kernel_calls import run_cells
from vibrafeed.core.motion.kernels.constants import RESULTS, UNREPEATED
from vibrafeed.core.motion.method import (
    STATUS,
    Contacts,
    Energy,
    Groups,
    Method,
    Motion,
    Path,
    Trajectory,
    TrajectoryRequest,
    cells_of,
    groups_of,
    in_plane,
    motion_of,
)
from vibrafeed.core.quantities import MOTION_MODES
from vibrafeed.core.watch import Watch

# --- kernels in the plane, under the drive of each cell

NEARLY = 1.0 + 2.0**-30  # factor up to which two numbers may have the same first 32 bits
FEWEST_EQUAL = 0.125  # share of cells with an equal drive from which on an order repays its time
OTHER_FACTORS = {"gravity_number_normal": 1.0, "restitution": 1e2, "impact_damping": 1e4}
"""Factors of the numbers, beside the drive's, that set the motion normal to the floor, in a sum by
which cells are sorted. Where two sums are equal by chance it costs time, and changes nothing."""


def waves_of(groups: NDArray[np.float64]) -> Any:
    """Return a buffer for the wave behind each cell's numbers, empty for a sine.

    Its type selects the compiled kernel.
    """
    if groups.shape[-1] > kernel_calls.inputs.GROUPS:
        return kernel_calls.wave.WaveTable(np.zeros(kernel_calls.wave.TABLE))
    return kernel_calls.flow.NO_WAVES


def solve_cells(
    groups: NDArray[np.float64],
    table: NDArray[np.float64],
    status: NDArray[np.int8],
    stop: NDArray[np.int8],
) -> None:
    """Fill table (columns of a `Motion`) and statuses of cells; rows hold `Cell` and a wave."""
    order = _order_by_landings(groups)
    if order is None:
        kernel_calls.plane_cells.solve_cells(groups, waves_of(groups), table, status, stop)
        _average_unrepeated(groups, table, status, stop)
        return
    ordered_groups, ordered_table, ordered_status = groups[order], table[order], status[order]
    kernel_calls.plane_cells.solve_cells(
        ordered_groups, waves_of(ordered_groups), ordered_table, ordered_status, stop
    )
    _average_unrepeated(ordered_groups, ordered_table, ordered_status, stop)
    table[order], status[order] = ordered_table, ordered_status


def _average_unrepeated(
    groups: NDArray[np.float64],
    table: NDArray[np.float64],
    status: NDArray[np.int8],
    stop: NDArray[np.int8],
) -> None:
    # Cells without a cycle get the means of long runs, in the same rows.
    (cells,) = np.nonzero(status == UNREPEATED)
    if cells.size:
        means = np.full((cells.size, RESULTS), np.nan)
        new_status = np.full(cells.size, STATUS["not_computed"], dtype=np.int8)
        kernel_calls.plane_cells.average_cells(
            groups[cells], waves_of(groups), means, new_status, stop
        )
        table[cells, :RESULTS], status[cells] = means, new_status


def _order_by_landings(groups: NDArray[np.float64]) -> NDArray[np.intp] | None:
    # The order in which cells that land at the same times follow each other: their motion normal
    # to the floor is found once for all (`kernels.planar.cycle` and, to 32 bits, `landings`).
    drives = groups[:, Groups._fields.index("drive_number_normal")]
    # To sort numbers takes a third of the time of an order, which is then seldom for nothing.
    sorted_drives = np.sort(drives)
    # Those below 0 pass for unequal: they are few, and to find them takes as long again.
    if np.count_nonzero(sorted_drives[1:] <= NEARLY * sorted_drives[:-1]) < FEWEST_EQUAL * len(
        groups
    ):
        return None
    by_drive = np.argsort(drives, kind="stable")
    sort_key = np.zeros(len(groups))
    for name, factor in OTHER_FACTORS.items():
        sort_key += factor * groups[:, Groups._fields.index(name)]
    return by_drive[np.argsort(sort_key[by_drive], kind="stable")]


def follow(
    row: NDArray[np.float64], stop: NDArray[np.int8]
) -> tuple[NDArray[np.float64], float, float, bool]:
    """Return one cell's motion pieces, phase shift, direction sign, and True if they repeat.

    `row` holds `Cell` and a wave; see the kernel `plane_cells.follow`.
    """
    table, status = np.empty((1, RESULTS)), np.full(1, STATUS["not_computed"], dtype=np.int8)
    solve_cells(row[np.newaxis], table, status, stop)
    return kernel_calls.plane_cells.follow(row, waves_of(row), int(status[0]), stop)


# --- in the plane, in closed form


def planar_motion(
    groups: Groups, *, tolerance: ArrayLike, max_periods: ArrayLike, watch: Watch | None = None
) -> Motion:
    """Return the motion of parts in the plane that start at rest on the floor, event by event.

    `tolerance` bounds the error of the sliding velocity at the start of the cycle, as a share of
    the drive; `max_periods` bounds how long an aperiodic motion is followed. Restitution does not
    count in a cell that never lifts off. Where it falls with speed, hops that never end pass for a
    stay on the floor once they are small; `error` holds what that leaves out.
    """
    lifts = np.abs(groups.drive_number_normal) > groups.gravity_number_normal
    planar_groups = groups.flat()._replace(restitution=np.where(lifts, groups.restitution, 0.0))
    if np.any(groups.impact_damping):
        planar_groups = planar_groups._replace(
            impact_damping=np.where(lifts, groups.impact_damping, 0.0)
        )
    cells, shape = cells_of(planar_groups, tolerance=tolerance, max_periods=max_periods)
    return motion_of(*run_cells(solve_cells, cells, watch=watch), shape)


def planar_path(
    groups: Groups,
    *,
    tolerance: float,
    max_periods: float,
    phases: Array,
    watch: Watch | None = None,
) -> tuple[Path, NDArray[np.int8]]:
    """Return the exact motion of one part in the plane, and its modes, at phases (n,) in rad.

    They count from the start of its cycle; beyond its end the motion goes on with the next one. An
    aperiodic motion is shown over the last stretch that was followed, some periods long; beyond it,
    and after a stop by the watch, all is NaN, and the mode is unknown.
    """
    (cell,), _ = cells_of(groups, tolerance=tolerance, max_periods=max_periods)
    with (watch or Watch()).flag() as stop:
        pieces, shift, direction, repeats = follow(cell, stop)
    samples = kernel_calls.plane_cells.sample(pieces, cell, waves_of(cell), shift, phases, repeats)
    modes = samples[:, 4].astype(np.int8)
    if direction < 0:  # the kernel mirrors a sine so that its amplitudes are positive
        forward, backward = MOTION_MODES["forward"].value, MOTION_MODES["backward"].value
        mirrored_modes = np.arange(len(MOTION_MODES), dtype=np.int8)
        mirrored_modes[forward], mirrored_modes[backward] = backward, forward
        modes = mirrored_modes[modes]
    across = np.zeros(len(samples))
    position = np.stack([direction * samples[:, 0], across, samples[:, 1]], axis=1)
    velocity = np.stack([direction * samples[:, 2], across, samples[:, 3]], axis=1)
    return Path(phases, position, velocity), modes


# --- in space, by power series


MAX_TURNS = 100_000
"""Periods of the drive that a trajectory may show, as many as a study may follow a part."""


def _in_space(kernel: Callable[..., Any], contacts: Contacts) -> Callable[..., Any]:
    return partial(kernel, contacts.wall, float(contacts.rolling))


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
    `tolerance` is that of the state's return after a cycle, as a share of the drive's speed. No
    solution where restitution falls with speed.
    """
    cells, shape = cells_of(groups, tolerance=tolerance, max_periods=max_periods)
    kernel = _in_space(kernel_calls.track.solve_cells, contacts)
    motion = motion_of(*run_cells(kernel, cells, piece=32, watch=watch), shape)
    falls = np.not_equal(groups.impact_damping, 0.0)
    if not falls.any():
        return motion
    fields = {name: np.where(falls, np.nan, value) for name, value in motion._asdict().items()}
    status = np.where(falls, np.int8(STATUS["no_solution"]), motion.status)
    return Motion(**{**fields, "status": status})


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
    watch did not let it reach is NaN. Raises `ValueError` if phases are negative, do not ascend, or
    are beyond `MAX_TURNS` periods.
    """
    if phases.size and (phases[0] < 0.0 or np.any(np.diff(phases) < 0.0)):
        raise ValueError("the argument phases has to hold numbers of at least 0 in ascending order")
    if phases.size and phases[-1] > MAX_TURNS * 2 * np.pi:
        raise ValueError(f"phases reach beyond {MAX_TURNS:,} periods")
    (cell,), _ = cells_of(groups, tolerance=tolerance, max_periods=max_periods)
    with (watch or Watch()).flag() as stop:
        samples = _in_space(kernel_calls.track.follow, contacts)(cell, phases, stop)
    return Path(phases, samples[:, :3], samples[:, 3:6]), samples[:, 6].astype(np.int8)


# --- in the plane or in space


def motion_by_events(
    groups: Groups,
    contacts: Contacts,
    *,
    tolerance: ArrayLike,
    max_periods: ArrayLike,
    watch: Watch | None = None,
) -> Motion:
    """Return the motion from rest from event to event, theory 13.2 to 13.8, 13.13.

    In closed form in the plane, by power series in space. A cylinder that slides along its axis
    moves as a block does. `tolerance` is the error of the state at which a motion counts as
    repeating, as a share of the drive; after `max_periods` it counts as aperiodic.
    """
    settings = {"tolerance": tolerance, "max_periods": max_periods}
    plane = in_plane(groups, contacts)
    if plane.all():
        return planar_motion(groups, **settings, watch=watch)
    if not plane.any():
        return spatial_motion(groups, contacts, **settings, watch=watch)
    rows, shape = cells_of(groups, **settings, plane=plane)
    is_planar = np.broadcast_to(plane, shape).ravel()
    results = []
    for mask in (is_planar, ~is_planar):
        part_groups, columns = groups_of(rows[mask], groups.wave is not None, 3)
        part_settings = dict(zip(settings, columns, strict=False))
        results.append(
            planar_motion(part_groups, **part_settings, watch=watch)
            if mask is is_planar
            else spatial_motion(part_groups, contacts, **part_settings, watch=watch)
        )
    fields = []
    for planar, spatial in zip(*results, strict=True):
        field = np.empty(is_planar.size, dtype=planar.dtype)
        field[is_planar], field[~is_planar] = planar, spatial
        fields.append(field.reshape(shape))
    return Motion._make(fields)


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
    """Return the work of friction, impacts and drive over a cycle (theory 13.15).

    Mean powers per mass, in units of g^2/w, w = 2 pi f; NaN for motions that do not repeat. The
    cycle of `motion`, of the same groups and settings, is followed once more: in the plane exactly,
    in space to some 1e-10 of the drive's work. With `averages`, means over a long stretch of planar
    motions that do not repeat, which scatter by some per cent.
    """
    watch = None if watch is None else replace(watch, progress=None)
    settings = {"tolerance": tolerance, "max_periods": max_periods}
    plane = in_plane(groups, contacts)
    wanders = averages & np.isin(motion.status, [STATUS["aperiodic"], STATUS["sensitive"]])
    rows, shape = cells_of(
        groups, **settings, plane=plane, repeats=motion.multiple > 0, wanders=wanders
    )
    groups_again, (*columns, plane, repeats, wanders) = groups_of(rows, groups.wave is not None, 5)
    table = np.full((len(rows), len(Energy._fields)), np.nan)
    inputs = dict(zip(settings, columns, strict=True))
    of_plane, of_space = kernel_calls.plane_cells, kernel_calls.track
    for part_groups, kernel, piece, weight in (
        (groups_again.flat(), partial(_with_waves, of_plane.power_cells), 256, plane * repeats),
        (groups_again, _in_space(of_space.power_cells, contacts), 32, (1.0 - plane) * repeats),
        (groups_again.flat(), partial(_with_waves, of_plane.average_power_cells), 4,
         plane * wanders * (1.0 - repeats)),
    ):  # fmt: skip
        is_computed = weight > 0.0
        if is_computed.any():
            cells, _ = cells_of(part_groups, **inputs)
            table[is_computed], _ = run_cells(
                kernel, cells[is_computed], columns=table.shape[1], piece=piece, watch=watch
            )
    return Energy(*(np.ascontiguousarray(column).reshape(shape) for column in table.T))


def _with_waves(kernel: Callable[..., Any], groups: NDArray[np.float64], *outputs: Any) -> None:
    kernel(groups, waves_of(groups), *outputs)


def path_of(request: TrajectoryRequest, contacts: Contacts) -> tuple[Path, NDArray[np.int8]]:
    """Return positions and modes of one part at the asked times, in the plane or in space."""
    settings: dict[str, Any] = {"phases": request.times()[1], "watch": request.watch}
    for name in ("tolerance", "max_periods"):
        settings[name] = np.asarray(request.arguments[name]).item()
    if in_plane(request.groups, contacts):
        return planar_path(request.groups, **settings)
    path, modes = spatial_path(request.groups, contacts, **settings)
    path.position[:, 0] -= path.position[0, 0]  # it starts at 0, as in the plane
    return path, modes


def _trajectory(request: TrajectoryRequest, contacts: Contacts) -> Trajectory:
    return request.trajectory(*path_of(request, contacts), contacts.wall)


EVENTS = Method(
    name="events",
    follow=motion_by_events,
    source="theory 13.2-13.8, 13.13",
    accuracy="rounding, where the motion repeats",
    seconds_a_cell=1e-4,
    defaults={"tolerance": 1e-12, "max_periods": 1000.0},
    course=_trajectory,
    energy=energy_by_events,
    checked_by=("reference",),
)
