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
"""Both have the fields `c` and `s`, largest pushes, `gs`, `gn`, `ends` and `levels`."""


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

set_flow: Callable[[Row, Driven, int, bool, float, float], None] = _by_drive(
    row_sine.set_flow, row_wave.set_flow
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

swung: Callable[[Driven, float, float], Any] = _by_drive(row_sine.swung, row_wave.swung)

carried: Callable[[Row, Driven, int, Any, float], tuple[float, float]] = _by_drive(
    row_sine.carried, row_wave.carried
)

swept: Callable[[Driven, float, float], Any] = _by_drive(row_sine.swept, row_wave.swept)

gap_swept: Callable[[Row, Driven, int, Any], float] = _by_drive(
    row_sine.gap_swept, row_wave.gap_swept
)


# --- forces on a stop

sizes: Callable[[Driven], tuple[float, float]] = _by_drive(row_sine.sizes, row_wave.sizes)

above: Callable[[Driven, int, float, float, float, float, float], float] = _by_drive(
    row_sine.above, row_wave.above
)

highest: Callable[[Driven, int, float, float, float, float, float], float] = _by_drive(
    row_sine.highest, row_wave.highest
)


@borrowing
def pooled(row: Row, first: int, end: int, slack: float = 0.0) -> int:
    """Pool neighbouring values of a row into non-decreasing means; return the number of blocks.

    min sum m (y - v)^2 under y_i <= y_(i+1), isotonic regression of the values v =
    `row.value[first:end]` with the masses m (theory 17.2). Each becomes its block's mean;
    `row.last[b]` is the last part of block b.
    """
    blocks = 0
    for i in range(first, end):
        mean, mass = row.value[i], row.mass[i]
        while blocks > 0 and row.value[row.last[blocks - 1]] >= mean - slack:
            before = row.last[blocks - 1]
            both = row.weight[before] + mass
            mean = row.value[before] + (mean - row.value[before]) * (mass / both)
            mass = both
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
def is_held(row: Row, end: int) -> bool:
    """True if the chain of parts that ends before index `end` touches a stop and moves with it."""
    return row.stop != NO_STOP and end == row.mass.size and row.closed[end - 1] == 1


@borrowing
def held_from(row: Row) -> int:
    """Return the index of the first part of the chain that touches the stop in front of a row."""
    first = row.mass.size
    if is_held(row, first):
        first -= 1
        while first > 0 and row.closed[first - 1] == 1:
            first -= 1
    return first


@borrowing
def open_between(row: Row, blocks: int) -> None:
    """Open the contacts between the `blocks` blocks that `pooled` has made: they move apart."""
    for b in range(blocks - 1):
        row.closed[row.last[b]] = 0


@borrowing
def slide(row: Row) -> None:
    """Open contacts without force, between parts of a chain that slide in one direction.

    The accelerations D -+ mu n are in the order of their frictions at every time: blocks last until
    an event.
    """
    first = 0
    while first < row.mass.size:
        end = chain_end(row, first)
        mode = row.mode[first]
        if mode != 0 and end > first + 1 and not is_held(row, end):
            for i in range(first, end):
                row.value[i] = -mode * row.kinetic[i]
            open_between(row, pooled(row, first, end, RESOLVED))
        first = end


@borrowing
def hold(row: Row, drive: Driven, push: float, load: float, flying: bool, released: bool) -> None:
    """Release parts of a row that are no longer pressed onto the stop in front.

    A stop of the track holds in flight while `push` is forward, and on the floor whatever is at
    rest; against one at rest in space a block presses with -gs - mode mu n > 0 per mass (theory
    17.6).
    """
    first, parts = held_from(row), row.mass.size
    if first == parts:
        return
    if row.stop == ON_TRACK:
        if flying and (released or push <= RESOLVED):
            row.closed[parts - 1] = 0
        return
    if flying:
        if drive.gs > 0.0:
            row.closed[parts - 1] = 0
        return
    mode = row.mode[first]
    if row.speed[parts] == 0.0:
        mode = 1 if push + drive.gs > 0.0 else -1
    for i in range(first, parts):
        row.value[i] = -mode * row.kinetic[i]
    pooled(row, first, parts)
    held = parts
    while held > first and row.value[held - 1] * load - drive.gs > RESOLVED:
        if released and row.value[held - 1] == row.value[first]:
            break
        held -= 1
    if held == parts:
        row.closed[parts - 1] = 0
    elif held > first:
        row.closed[held - 1] = 0
    for i in range(held, parts):
        row.mode[i] = mode


@borrowing
def least_pressed(row: Row, first: int) -> float:
    """Return the factor -mode mu of the block that a stop at rest in space releases first [1]."""
    parts = row.mass.size
    for i in range(first, parts):
        row.value[i] = -row.mode[first] * row.kinetic[i]
    pooled(row, first, parts)
    return row.value[first]


@borrowing
def set_flows(row: Row, drive: Driven, pull: float, flying: bool) -> None:
    """Set the acceleration of every part of a row, from its mode, contacts and the drive.

    In flight the push less the `pull`; at rest 0; sliding by mode = +-1, a block has the mean
    friction mu of its parts: under a sine C sin(tau) - k with C = c + mode mu s, k = pull + mode mu
    gn (theory 13.2).
    """
    first = 0
    while first < row.mass.size:
        mode, end = row.mode[first], first + 1
        if flying:
            set_flow(row, drive, first, True, 0.0, pull)
        elif mode == 0:
            set_flow(row, drive, first, False, 0.0, 0.0)
        else:
            mu, mass = row.kinetic[first], row.mass[first]
            while end < row.mass.size and row.closed[end - 1] == 1 and row.mode[end] == mode:
                mass += row.mass[end]
                mu += (row.kinetic[end] - mu) * (row.mass[end] / mass)
                end += 1
            for i in range(first, end):
                set_flow(row, drive, i, True, mode * mu, pull + mode * mu * drive.gn)
        first = end
    parts = row.mass.size
    if row.stop == IN_SPACE:
        set_flow(row, drive, parts, True, 0.0, pull - drive.gs)
    if row.stop != NO_STOP:
        for i in range(held_from(row), parts):
            set_flow(row, drive, i, row.stop == IN_SPACE, 0.0, row.drag[parts])


@borrowing
def start(row: Row, push: float, load: float, forced: int) -> None:
    """Set those parts of every resting chain of a row in motion that the drive can move.

    The accelerations |D| - mu_s n are pooled; blocks above 0 start, and one of the chain `forced`
    (theory 17.2).
    """
    first = 0
    while first < row.mass.size:
        end = chain_end(row, first)
        blocked = push > 0.0 and row.stop == ON_TRACK and is_held(row, end)
        if row.mode[first] == 0 and row.speed[first] == 0.0 and not blocked:
            _start_chain(row, first, end, push, load, forced == first)
        first = end


@borrowing
def _start_chain(row: Row, first: int, end: int, push: float, load: float, is_forced: bool) -> None:
    way = 1 if push > 0.0 else -1
    for i in range(first, end):
        # Pushed back, the accelerations -(|D| - mu n) do not fall towards the front, either.
        row.value[i] = way * (abs(push) - row.static[i] * load)
    pooled(row, first, end, RESOLVED)
    _set_apart(row, first, end, way, is_forced)


@borrowing
def _set_apart(row: Row, first: int, end: int, way: int, is_forced: bool) -> None:
    farthest = end - 1 if way > 0 else first
    most = way * row.value[farthest]
    for i in range(first, end):
        own = way * row.value[i]
        if own > RESOLVED or (is_forced and own == most):
            row.mode[i] = way
    for i in range(first, end - 1):
        if row.mode[i] != row.mode[i + 1]:
            row.closed[i] = 0
    if row.stop != NO_STOP and end == row.mass.size and row.mode[end - 1] != 0:
        row.closed[end - 1] = 0  # of a stop of the track; one in space has let go before


@borrowing
def least_friction(row: Row, first: int, end: int, way: int) -> float:
    """Return the static friction coefficient of the block that starts first in a resting chain.

    A block starts where the push in direction `way` is mu n, its mu the mean of its parts, weighted
    by mass (theory 17.2).
    """
    for i in range(first, end):
        row.value[i] = -way * row.static[i]
    pooled(row, first, end, RESOLVED)
    return -way * row.value[end - 1 if way > 0 else first]


@borrowing
def _touching(row: Row, contact: int) -> tuple[int, int, bool]:
    parts = row.mass.size
    first, end = contact, min(contact + 2, parts)
    while first > 0 and row.gap[first - 1] <= 0.0:
        first -= 1
    while end < parts and row.gap[end - 1] <= 0.0:
        end += 1
    stopped = (
        row.stop != NO_STOP and end == parts and (contact == parts - 1 or row.gap[parts - 1] <= 0.0)
    )
    return first, end, stopped


@borrowing
def closing(row: Row, contact: int, least: float) -> float:
    """Return how many contacts close at a collision, with a relative velocity above `least`."""
    first, end, stopped = _touching(row, contact)
    count = 0.0
    for i in range(first, end if stopped else end - 1):
        meets = row.speed[i] - row.speed[i + 1]
        count += 1.0 if row.closed[i] == 0 and meets > least else 0.0
    return count


@borrowing
def collide(row: Row, contact: int, restitution: float) -> tuple[float, float]:
    """Collide two parts of a row and all that touch them; return energy lost, impulse on the stop.

    u+ = (1 + e) y - e u, y the means of blocks whose parts would overlap, no larger than the
    velocity of a stop that takes part; sum m (u - y)^2 (1 - e^2)/2 is lost, in mass times (g/w)^2
    (theory 17.2).
    """
    parts = row.mass.size
    first, end, stopped = _touching(row, contact)
    for i in range(first, end):
        row.value[i] = row.speed[i]
    for i in range(first, end - 1):
        row.gap[i] = 0.0
    pooled(row, first, end)
    if stopped:
        row.gap[parts - 1] = 0.0
        for i in range(first, end):
            row.value[i] = min(row.value[i], row.speed[parts])
    lost, impulse = 0.0, 0.0
    for i in range(first, end):
        apart = row.speed[i] - row.value[i]
        lost += row.mass[i] * apart * apart
        impulse += (1.0 + restitution) * row.mass[i] * apart
        row.speed[i] = row.value[i] - restitution * apart
        row.mode[i] = sign(row.speed[i])
    for i in range(first, end - 1):
        alike = row.value[i] == row.value[i + 1] and row.speed[i] == row.speed[i + 1]
        row.closed[i] = 1 if alike else 0
    if stopped:
        row.closed[parts - 1] = 1 if row.speed[parts - 1] == row.speed[parts] else 0
    return lost * (1.0 - restitution * restitution) / 2.0, impulse if stopped else 0.0


@borrowing
def land(row: Row, impulse: float) -> float:
    """Land all parts of a row on the floor at once; return the impulse on a stop in front.

    u - mu L sgn(u), with the impulse L of the floor per mass in g/w; touching parts that would
    overlap share the mean of their block, and those that friction would turn round stay at rest.
    """
    first, taken, parts = 0, 0.0, row.mass.size
    while first < parts:
        end = chain_end(row, first)
        way, held = sign(row.speed[first]), is_held(row, end)
        for i in range(first, end):
            row.mode[i] = way
        if way != 0:
            for i in range(first, end):
                row.value[i] = row.speed[i] - way * row.kinetic[i] * impulse
            pooled(row, first, end)
            before = row.speed[first]
            for i in range(first, end):
                row.speed[i] = way * max(0.0, way * row.value[i])
                if held and row.speed[i] >= row.speed[parts]:
                    row.speed[i] = row.speed[parts]
                    free = before - way * row.kinetic[i] * impulse
                    taken += row.mass[i] * (free - row.speed[i])
                row.mode[i] = sign(row.speed[i])
            for i in range(first, end - 1):
                if row.speed[i] != row.speed[i + 1]:
                    row.closed[i] = 0
            if held and row.speed[end - 1] != row.speed[parts]:
                row.closed[end - 1] = 0
        first = end
    return taken


@borrowing
def sign(value: float) -> int:
    """Return the sign of a value: 1, 0 or -1."""
    return 1 if value > 0.0 else (-1 if value < 0.0 else 0)


Pressed = namedtuple("Pressed", "impulse peak")
"""The integral of a force over a phase, and its largest value."""

NOT_PRESSED = Pressed(0.0, 0.0)


@borrowing
def stop_pressed(
    row: Row, drive: Driven, pull: float, tau: float, span: float, flying: bool
) -> Pressed:
    """Return impulse and largest force of a row on the stop in front, over a time without events.

    For a stop at rest in space sum m (-gs - mode mu n), for one of the track in flight sum m times
    the push D; for parts at rest on the floor the least force, sum m max(0, D - mu_s n) over the
    blocks (theory 17.6).
    """
    first, parts = held_from(row), row.mass.size
    if first == parts:
        return NOT_PRESSED
    if row.stop == ON_TRACK and not flying:
        return _least(row, drive, pull, tau, span, first)
    (push, lift), along, normal, drag = sizes(drive), 0.0, 0.0, 0.0
    for i in range(first, parts):
        if row.stop == ON_TRACK:
            along += row.mass[i] * push
            drag += row.mass[i] * pull
        else:
            friction = 0.0 if flying else row.mode[i] * row.kinetic[i]
            normal += row.mass[i] * friction * lift
            drag += row.mass[i] * (drive.gs + friction * drive.gn)
    impulse = above(drive, first, along, normal, drag, tau, span)
    return Pressed(impulse, max(0.0, highest(drive, parts, along, normal, drag, tau, span)))


@borrowing
def _least(row: Row, drive: Driven, pull: float, tau: float, span: float, first: int) -> Pressed:
    parts = row.mass.size
    for i in range(first, parts):
        row.value[i] = -row.static[i]
    blocks = pooled(row, first, parts)
    impulse, (push, lift) = 0.0, sizes(drive)
    for b in range(blocks):
        begin, mu, mass = _block(row, first, b)
        impulse += mass * above(drive, begin, push, mu * lift, pull + mu * drive.gn, tau, span)
    # Blocks in front press first: the force is the largest sum from one block on to the front.
    peak, along, normal, drag = 0.0, 0.0, 0.0, 0.0
    for b in range(blocks - 1, -1, -1):
        _, mu, mass = _block(row, first, b)
        along, normal = along + mass * push, normal + mass * mu * lift
        drag += mass * (pull + mu * drive.gn)
        peak = max(peak, highest(drive, parts, along, normal, drag, tau, span))
    return Pressed(impulse, peak)


@borrowing
def _block(row: Row, first: int, number: int) -> tuple[int, float, float]:
    begin, mass = row.last[number - 1] + 1 if number > 0 else first, 0.0
    for i in range(begin, row.last[number] + 1):
        mass += row.mass[i]
    return begin, -row.value[begin], mass
