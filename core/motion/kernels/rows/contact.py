"""Contact of parts in a row (17.2) and its stop (theory 17.6); the drive is told by its type.

Gauss's principle for parts that touch at one velocity is to minimise sum m (u' - a)^2/2 under
u'_1 <= u'_2 <= ..., a the acceleration of each part by itself: isotonic regression.
"""

from collections import namedtuple
from collections.abc import Callable
from typing import Any, TypeAlias

from vibrafeed.core.compiled import borrowing, by_type
from vibrafeed.core.motion.kernels.rows import row_sine, row_state, row_wave
from vibrafeed.core.motion.kernels.rows.row_sine import RESOLVED
from vibrafeed.core.motion.kernels.rows.row_state import IN_SPACE, NO_STOP, ON_TRACK, Drive, Row
from vibrafeed.core.motion.kernels.rows.row_wave import RowWave

Driven: TypeAlias = Drive | RowWave
"""Both have the largest pushes, gravity, `ends` and `levels`."""


def _by_drive(for_sine: Any, for_wave: Any) -> Any:
    # compiled code sees by the type of `drive` which one is meant
    return by_type("drive", {Drive: for_sine, RowWave: for_wave})(for_sine.py_func)


pushes: Callable[[Driven, float, float], tuple[float, float]] = _by_drive(
    row_sine.pushes, row_wave.pushes
)

lift_off: Callable[[Driven, float], float] = _by_drive(row_sine.lift_off, row_wave.lift_off)

is_lifted: Callable[[Driven, float], bool] = _by_drive(row_sine.is_lifted, row_wave.is_lifted)

flight: Callable[[Driven, float], tuple[float, float]] = _by_drive(row_sine.flight, row_wave.flight)

backward_speed: Callable[[Driven], float] = _by_drive(
    row_state.backward_speed, row_wave.backward_speed
)

first_rise: Callable[[Driven, int, int, float, float, float, float], float] = _by_drive(
    row_sine.first_rise, row_wave.first_rise
)


# --- parts

set_acceleration: Callable[[Row, Driven, int, bool, float, float], None] = _by_drive(
    row_sine.set_acceleration, row_wave.set_acceleration
)

at_phase: Callable[[Driven, float], Any] = _by_drive(row_sine.at_phase, row_wave.at_phase)

stop_until: Callable[[Row, Driven, int, Any, float], float] = _by_drive(
    row_sine.stop_until, row_wave.stop_until
)

contact_until: Callable[[Row, Driven, int, Any, float], float] = _by_drive(
    row_sine.contact_until, row_wave.contact_until
)

relative_push: Callable[[Row, Driven, int, float], float] = _by_drive(
    row_sine.relative_push, row_wave.relative_push
)

drive_integrals: Callable[[Driven, float, float], Any] = _by_drive(
    row_sine.drive_integrals, row_wave.drive_integrals
)

change_over_span: Callable[[Row, Driven, int, Any, float], tuple[float, float]] = _by_drive(
    row_sine.change_over_span, row_wave.change_over_span
)

drive_double_integrals: Callable[[Driven, float, float], Any] = _by_drive(
    row_sine.drive_double_integrals, row_wave.drive_double_integrals
)

gap_integral_of_drive: Callable[[Row, Driven, int, Any], float] = _by_drive(
    row_sine.gap_integral_of_drive, row_wave.gap_integral_of_drive
)


# --- forces on a stop

push_sizes: Callable[[Driven], tuple[float, float]] = _by_drive(
    row_sine.push_sizes, row_wave.push_sizes
)

positive_impulse: Callable[[Driven, int, float, float, float, float, float], float] = _by_drive(
    row_sine.positive_impulse, row_wave.positive_impulse
)

largest_force: Callable[[Driven, int, float, float, float, float, float], float] = _by_drive(
    row_sine.largest_force, row_wave.largest_force
)


@borrowing
def pool_means(row: Row, first: int, end: int, slack: float = 0.0) -> int:
    """Pool neighbouring values of a row into non-decreasing means; return the number of blocks.

    min sum m (y - v)^2 under y_i <= y_(i+1), isotonic regression of the values v =
    `row.value[first:end]` with the masses m (theory 17.2). Each becomes its block's mean;
    `row.last[b]` is the last part of block b.
    """
    blocks = 0
    for i in range(first, end):
        mean, mass = row.value[i], row.mass[i]
        while blocks > 0 and row.value[row.last[blocks - 1]] >= mean - slack:
            previous = row.last[blocks - 1]
            joined_mass = row.weight[previous] + mass
            mean = row.value[previous] + (mean - row.value[previous]) * (mass / joined_mass)
            mass = joined_mass
            blocks -= 1
        row.value[i], row.weight[i], row.last[blocks] = mean, mass, i
        blocks += 1
    begin = first
    for b in range(blocks):
        mean = row.value[row.last[b]]
        for i in range(begin, row.last[b] + 1):
            row.value[i] = mean
        begin = row.last[b] + 1
    return blocks


@borrowing
def chain_end(row: Row, first: int) -> int:
    """Return the index after the last part of the chain of touching parts from part `first` on."""
    end = first + 1
    while end < row.mass.size and row.closed[end - 1] == 1:
        end += 1
    return end


@borrowing
def touches_stop(row: Row, end: int) -> bool:
    """True if the chain of parts that ends before index `end` touches a stop and moves with it."""
    return row.stop != NO_STOP and end == row.mass.size and row.closed[end - 1] == 1


@borrowing
def first_touching_stop(row: Row) -> int:
    """Return the index of the first part of the chain that touches the stop in front of a row."""
    first = row.mass.size
    if touches_stop(row, first):
        first -= 1
        while first > 0 and row.closed[first - 1] == 1:
            first -= 1
    return first


@borrowing
def open_contacts_between(row: Row, blocks: int) -> None:
    """Open the contacts between the `blocks` blocks that `pool_means` has made: they move apart."""
    for b in range(blocks - 1):
        row.closed[row.last[b]] = 0


@borrowing
def open_unpressed_contacts(row: Row) -> None:
    """Open contacts without force, between parts of a chain that slide in one direction.

    The accelerations D -+ mu n are in the order of their frictions at every time: blocks last until
    an event.
    """
    first = 0
    while first < row.mass.size:
        end = chain_end(row, first)
        mode = row.mode[first]
        if mode != 0 and end > first + 1 and not touches_stop(row, end):
            for i in range(first, end):
                row.value[i] = -mode * row.kinetic[i]
            open_contacts_between(row, pool_means(row, first, end, RESOLVED))
        first = end


@borrowing
def release_from_stop(
    row: Row, drive: Driven, push: float, load: float, flying: bool, released: bool
) -> None:
    """Release parts of a row that are no longer pressed onto the stop in front.

    A stop of the track holds in flight while `push` is forward, and on the floor whatever is at
    rest; against one at rest in space a block presses with -gs - mode mu n > 0 per mass (theory
    17.6).
    """
    first, parts = first_touching_stop(row), row.mass.size
    if first == parts:
        return
    if row.stop == ON_TRACK:
        if flying and (released or push <= RESOLVED):
            row.closed[parts - 1] = 0
        return
    if flying:
        if drive.gravity_along > 0.0:
            row.closed[parts - 1] = 0
        return
    mode = row.mode[first]
    if row.speed[parts] == 0.0:
        mode = 1 if push + drive.gravity_along > 0.0 else -1
    for i in range(first, parts):
        row.value[i] = -mode * row.kinetic[i]
    pool_means(row, first, parts)
    first_held = parts
    while first_held > first and row.value[first_held - 1] * load - drive.gravity_along > RESOLVED:
        if released and row.value[first_held - 1] == row.value[first]:
            break
        first_held -= 1
    if first_held == parts:
        row.closed[parts - 1] = 0
    elif first_held > first:
        row.closed[first_held - 1] = 0
    for i in range(first_held, parts):
        row.mode[i] = mode


@borrowing
def least_pressed_factor(row: Row, first: int) -> float:
    """Return the factor -mode mu of the block that a stop at rest in space releases first [1]."""
    parts = row.mass.size
    for i in range(first, parts):
        row.value[i] = -row.mode[first] * row.kinetic[i]
    pool_means(row, first, parts)
    return row.value[first]


@borrowing
def set_accelerations(row: Row, drive: Driven, pull: float, flying: bool) -> None:
    """Set the acceleration of every part of a row, from its mode, contacts and the drive.

    In flight the push less the `pull`; at rest 0; sliding by mode = +-1, a block has the mean
    friction mu of its parts: under a sine C sin(tau) - k with C = c + mode mu s, k = pull + mode mu
    gn (theory 13.2).
    """
    first = 0
    while first < row.mass.size:
        mode, end = row.mode[first], first + 1
        if flying:
            set_acceleration(row, drive, first, True, 0.0, pull)
        elif mode == 0:
            set_acceleration(row, drive, first, False, 0.0, 0.0)
        else:
            friction, mass = row.kinetic[first], row.mass[first]
            while end < row.mass.size and row.closed[end - 1] == 1 and row.mode[end] == mode:
                mass += row.mass[end]
                friction += (row.kinetic[end] - friction) * (row.mass[end] / mass)
                end += 1
            for i in range(first, end):
                set_acceleration(
                    row,
                    drive,
                    i,
                    True,
                    mode * friction,
                    pull + mode * friction * drive.gravity_normal,
                )
        first = end
    parts = row.mass.size
    if row.stop == IN_SPACE:
        set_acceleration(row, drive, parts, True, 0.0, pull - drive.gravity_along)
    if row.stop != NO_STOP:
        for i in range(first_touching_stop(row), parts):
            set_acceleration(row, drive, i, row.stop == IN_SPACE, 0.0, row.pull[parts])


@borrowing
def start_movable_parts(row: Row, push: float, load: float, forced: int) -> None:
    """Set those parts of every resting chain of a row in motion that the drive can move.

    The accelerations |D| - mu_s n are pooled; blocks above 0 start, and one of the chain `forced`
    (theory 17.2).
    """
    first = 0
    while first < row.mass.size:
        end = chain_end(row, first)
        blocked = push > 0.0 and row.stop == ON_TRACK and touches_stop(row, end)
        if row.mode[first] == 0 and row.speed[first] == 0.0 and not blocked:
            _start_chain(row, first, end, push, load, forced == first)
        first = end


@borrowing
def _start_chain(row: Row, first: int, end: int, push: float, load: float, is_forced: bool) -> None:
    direction = 1 if push > 0.0 else -1
    for i in range(first, end):
        # Pushed back, the accelerations -(|D| - mu n) do not fall towards the front, either.
        row.value[i] = direction * (abs(push) - row.static[i] * load)
    pool_means(row, first, end, RESOLVED)
    _start_blocks(row, first, end, direction, is_forced)


@borrowing
def _start_blocks(row: Row, first: int, end: int, direction: int, is_forced: bool) -> None:
    # Parts whose pooled acceleration, in `row.value`, is in the push's direction start to slide;
    # with `is_forced` also the block nearest to it. Contacts between parts of different modes open.
    farthest = end - 1 if direction > 0 else first
    largest = direction * row.value[farthest]
    for i in range(first, end):
        acceleration = direction * row.value[i]
        if acceleration > RESOLVED or (is_forced and acceleration == largest):
            row.mode[i] = direction
    for i in range(first, end - 1):
        if row.mode[i] != row.mode[i + 1]:
            row.closed[i] = 0
    if row.stop != NO_STOP and end == row.mass.size and row.mode[end - 1] != 0:
        row.closed[end - 1] = 0  # of a stop of the track; one in space has let go before


@borrowing
def least_friction(row: Row, first: int, end: int, direction: int) -> float:
    """Return the static friction coefficient of the block that starts first in a resting chain.

    A block starts where the push in direction `direction` is mu n, its mu the mean of its parts,
    weighted by mass (theory 17.2).
    """
    for i in range(first, end):
        row.value[i] = -direction * row.static[i]
    pool_means(row, first, end, RESOLVED)
    return -direction * row.value[end - 1 if direction > 0 else first]


@borrowing
def _touching_range(row: Row, contact: int) -> tuple[int, int, bool]:
    # First part and end of the group without gaps around a contact, and True if it includes the
    # stop.
    parts = row.mass.size
    first, end = contact, min(contact + 2, parts)
    while first > 0 and row.gap[first - 1] <= 0.0:
        first -= 1
    while end < parts and row.gap[end - 1] <= 0.0:
        end += 1
    meets_stop = (
        row.stop != NO_STOP and end == parts and (contact == parts - 1 or row.gap[parts - 1] <= 0.0)
    )
    return first, end, meets_stop


@borrowing
def count_closing(row: Row, contact: int, least: float) -> float:
    """Return how many contacts close at a collision, with a relative velocity above `least`."""
    first, end, meets_stop = _touching_range(row, contact)
    count = 0.0
    for i in range(first, end if meets_stop else end - 1):
        closing_speed = row.speed[i] - row.speed[i + 1]
        count += 1.0 if row.closed[i] == 0 and closing_speed > least else 0.0
    return count


@borrowing
def collide(row: Row, contact: int, restitution: float) -> tuple[float, float]:
    """Collide two parts of a row and all that touch them; return energy lost, impulse on the stop.

    u+ = (1 + e) y - e u, y the means of blocks whose parts would overlap, no larger than the
    velocity of a stop that takes part; sum m (u - y)^2 (1 - e^2)/2 is lost, in mass times (g/w)^2
    (theory 17.2).
    """
    parts = row.mass.size
    first, end, meets_stop = _touching_range(row, contact)
    for i in range(first, end):
        row.value[i] = row.speed[i]
    for i in range(first, end - 1):
        row.gap[i] = 0.0
    pool_means(row, first, end)
    if meets_stop:
        row.gap[parts - 1] = 0.0
        for i in range(first, end):
            row.value[i] = min(row.value[i], row.speed[parts])
    energy_sum, impulse = 0.0, 0.0
    for i in range(first, end):
        change = row.speed[i] - row.value[i]
        energy_sum += row.mass[i] * change * change
        impulse += (1.0 + restitution) * row.mass[i] * change
        row.speed[i] = row.value[i] - restitution * change
        row.mode[i] = sign(row.speed[i])
    for i in range(first, end - 1):
        stays_together = row.value[i] == row.value[i + 1] and row.speed[i] == row.speed[i + 1]
        row.closed[i] = 1 if stays_together else 0
    if meets_stop:
        row.closed[parts - 1] = 1 if row.speed[parts - 1] == row.speed[parts] else 0
    return energy_sum * (1.0 - restitution * restitution) / 2.0, impulse if meets_stop else 0.0


@borrowing
def land_all(row: Row, impulse: float) -> float:
    """Land all parts of a row on the floor at once; return the impulse on a stop in front.

    u - mu L sgn(u), with the impulse L of the floor per mass in g/w; touching parts that would
    overlap share the mean of their block, and those that friction would turn round stay at rest.
    """
    first, stop_impulse, parts = 0, 0.0, row.mass.size
    while first < parts:
        end = chain_end(row, first)
        direction, at_stop = sign(row.speed[first]), touches_stop(row, end)
        for i in range(first, end):
            row.mode[i] = direction
        if direction != 0:
            for i in range(first, end):
                row.value[i] = row.speed[i] - direction * row.kinetic[i] * impulse
            pool_means(row, first, end)
            speed_before = row.speed[first]
            for i in range(first, end):
                row.speed[i] = direction * max(0.0, direction * row.value[i])
                if at_stop and row.speed[i] >= row.speed[parts]:
                    row.speed[i] = row.speed[parts]
                    free_speed = speed_before - direction * row.kinetic[i] * impulse
                    stop_impulse += row.mass[i] * (free_speed - row.speed[i])
                row.mode[i] = sign(row.speed[i])
            for i in range(first, end - 1):
                if row.speed[i] != row.speed[i + 1]:
                    row.closed[i] = 0
            if at_stop and row.speed[end - 1] != row.speed[parts]:
                row.closed[end - 1] = 0
        first = end
    return stop_impulse


@borrowing
def sign(value: float) -> int:
    """Return the sign of a value: 1, 0 or -1."""
    return 1 if value > 0.0 else (-1 if value < 0.0 else 0)


Pressed = namedtuple("Pressed", "impulse peak")
"""The integral of a force over a phase, and its largest value."""

NOT_PRESSED = Pressed(0.0, 0.0)


@borrowing
def stop_impulse_and_peak(
    row: Row, drive: Driven, pull: float, tau: float, span: float, flying: bool
) -> Pressed:
    """Return impulse and largest force of a row on the stop in front, over a time without events.

    For a stop at rest in space sum m (-gs - mode mu n), for one of the track in flight sum m times
    the push D; for parts at rest on the floor the least force, sum m max(0, D - mu_s n) over the
    blocks (theory 17.6).
    """
    first, parts = first_touching_stop(row), row.mass.size
    if first == parts:
        return NOT_PRESSED
    if row.stop == ON_TRACK and not flying:
        return _least_stop_force(row, drive, pull, tau, span, first)
    (along_size, normal_size), along, normal, pull_sum = push_sizes(drive), 0.0, 0.0, 0.0
    for i in range(first, parts):
        if row.stop == ON_TRACK:
            along += row.mass[i] * along_size
            pull_sum += row.mass[i] * pull
        else:
            friction = 0.0 if flying else row.mode[i] * row.kinetic[i]
            normal += row.mass[i] * friction * normal_size
            pull_sum += row.mass[i] * (drive.gravity_along + friction * drive.gravity_normal)
    impulse = positive_impulse(drive, first, along, normal, pull_sum, tau, span)
    return Pressed(
        impulse, max(0.0, largest_force(drive, parts, along, normal, pull_sum, tau, span))
    )


@borrowing
def _least_stop_force(
    row: Row, drive: Driven, pull: float, tau: float, span: float, first: int
) -> Pressed:
    # Static friction of each part takes what it can of the push D: a block presses on those in
    # front with max(0, D - mu_s n) per mass, the least force that rest allows.
    parts = row.mass.size
    for i in range(first, parts):
        row.value[i] = -row.static[i]
    blocks = pool_means(row, first, parts)
    impulse, (along_size, normal_size) = 0.0, push_sizes(drive)
    for b in range(blocks):
        begin, mu, mass = _block(row, first, b)
        impulse += mass * positive_impulse(
            drive, begin, along_size, mu * normal_size, pull + mu * drive.gravity_normal, tau, span
        )
    # Blocks in front press first: the force is the largest sum from one block on to the front.
    peak, along, normal, pull_sum = 0.0, 0.0, 0.0, 0.0
    for b in range(blocks - 1, -1, -1):
        _, mu, mass = _block(row, first, b)
        along, normal = along + mass * along_size, normal + mass * mu * normal_size
        pull_sum += mass * (pull + mu * drive.gravity_normal)
        peak = max(peak, largest_force(drive, parts, along, normal, pull_sum, tau, span))
    return Pressed(impulse, peak)


@borrowing
def _block(row: Row, first: int, number: int) -> tuple[int, float, float]:
    begin, mass = row.last[number - 1] + 1 if number > 0 else first, 0.0
    for i in range(begin, row.last[number] + 1):
        mass += row.mass[i]
    return begin, -row.value[begin], mass
