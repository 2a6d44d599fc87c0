"""Contact of parts in a row: isotonic regression decides who pushes whom (theory 17.2).

Gauss's principle for parts that touch at one velocity is to minimise sum m (u' - a)^2/2 under
u'_1 <= u'_2 <= ... from the rear to the front, a the acceleration of each part by itself. Its
solution is unique, and pooling neighbours that violate the order gives it in one pass.
"""

from __future__ import annotations

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.rows.drive import Driven, set_flow
from vibrafeed.core.motion.kernels.rows.roots import RESOLVED
from vibrafeed.core.motion.kernels.rows.tables import IN_SPACE, NO_STOP, ON_TRACK, Row


@borrowing
def pooled(row: Row, first: int, end: int, slack: float = 0.0) -> int:
    """Pool neighbouring values of a row into non-decreasing means; return the number of blocks.

    Who pushes whom in a row of touching parts is decided so (theory 17.2): min sum m (y - v)^2
    under y_i <= y_(i+1), isotonic regression of the values v = `row.value[first:end]` with the
    masses m. A block grows as long as its mean is no larger than that of the block before, or
    beyond it by at most `slack`. Each value becomes its block's mean; `row.last[b]` is the last
    part of block b. Equal values keep their exact value.
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
    """Return the index after the last part of the chain of touching parts from part `first` on.

    `row` tells by `closed` which parts touch the next one.
    """
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
    """Return the index of the first part of the chain that touches the stop in front of a row.

    The chain has all parts from there to the front; the number of parts if none touches the stop.
    """
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

    A chain is a run of parts that touch. The accelerations D - mu n (forward) and D + mu n
    (backward) of its parts are in the order of -mu and of mu at every time: the blocks that move as
    one depend on friction alone, and last until an event. Changes the contacts in `row`.
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

    A stop of the track holds in flight while `push`, the acceleration along in g, is forward, and
    on the floor whatever is at rest. From a stop at rest in space seen a part would have u' = D +
    gs, so that a block of sliding parts presses with -gs - mode mu n > 0 per mass, with gravity gs
    along the track, its direction of slip `mode`, friction mu and the load n = `load` in g (theory
    17.6).

    `flying` is True if parts are in the air. With `released` the block that presses least is let go
    in any case: its limit has just been reached. Modes and contacts of `row` are changed.
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
    """Return the factor -mode mu of the block that a stop at rest in space releases first [1].

    A row slides against such a stop. A block of parts presses on it with -gs - mode mu n per mass,
    with gravity gs along the track, the load n, the friction mu and the direction of slip `mode`
    (1, -1), so that the block of least -mode mu lets go first, when that times n has fallen to gs
    (theory 17.6). `first` is the index of the first part of the chain that touches the stop.
    Overwrites `row.value` and `row.last`.
    """
    parts = row.mass.size
    for i in range(first, parts):
        row.value[i] = -row.mode[first] * row.kinetic[i]
    pooled(row, first, parts)
    return row.value[first]


@borrowing
def set_flows(row: Row, drive: Driven, pull: float, flying: bool) -> None:
    """Set the acceleration of every part of a row, from its mode, contacts and the drive.

    `pull` is gravity along less the level of the drive's step, in g. In flight (`flying`) the
    acceleration is the push along less the pull; at rest 0; sliding by mode = +-1, a block has the
    mean friction mu of its parts: under a sine C sin(tau) - k with C = c + mode mu s, k = pull +
    mode mu gn (theory 13.2), where c and s are the drive along and off the floor.
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

    The accelerations |D| - mu_s n, by which the `push` D exceeds static friction under the `load` n
    in g, are pooled to blocks; blocks above 0 start: those in front under a push forward, those
    behind under one backward (theory 17.2). Of the chain that begins with part `forced` (-1 for
    none) the block that moves most starts in any case: its limit has just been reached. Modes and
    contacts of `row` are changed.
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
    """Set those parts of a resting chain in motion that the push of the drive can move.

    The chain of touching parts is `first` to before `end`. The accelerations |D| - mu_s n by which
    the `push` D exceeds static friction under the `load` n, in g, are pooled to blocks of parts
    that start together; blocks above 0 start (theory 17.2). `is_forced` is True if one block has
    just reached its limit, and starts in any case.
    """
    way = 1 if push > 0.0 else -1
    for i in range(first, end):
        # Pushed back, the accelerations -(|D| - mu n) do not fall towards the front, either.
        row.value[i] = way * (abs(push) - row.static[i] * load)
    pooled(row, first, end, RESOLVED)
    _set_apart(row, first, end, way, is_forced)


@borrowing
def _set_apart(row: Row, first: int, end: int, way: int, is_forced: bool) -> None:
    """Set the modes of the parts of a chain that start to slide; open contacts to resting ones.

    The chain of touching parts is `first` to before `end`, `way` the direction of the push (1, -1);
    `row.value` holds the accelerations of its blocks along the track, positive forward; those start
    whose acceleration in the direction of the push is above `RESOLVED`. If `is_forced`, the block
    that moves most starts in any case, since its limit has just been reached. Contacts between
    moving and resting parts, and to a stop, are opened.
    """
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

    Touching parts start in blocks, each where the push in direction `way` (1, -1) is mu n, n the
    load: its mu is the mean of those of its parts, weighted by mass. Pooled over the parts `first`
    to before `end`, the first block is that in front (`way` 1) or at the rear (-1) (theory 17.2).
    Overwrites `row.value` and `row.last`.
    """
    for i in range(first, end):
        row.value[i] = -way * row.static[i]
    pooled(row, first, end, RESOLVED)
    return -way * row.value[end - 1 if way > 0 else first]


@borrowing
def _touching(row: Row, contact: int) -> tuple[int, int, bool]:
    """Return the parts that touch when a contact closes: first, behind the last; True with a stop.

    `contact` is the index of the rear part of two that collide.
    """
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
    """Return how many contacts close at a collision, with a relative velocity above `least`.

    Those of all parts that touch when the contact of part `contact` and the next one closes, and of
    the front part with a stop; `least` is in g/w (w = 2 pi f).
    """
    first, end, stopped = _touching(row, contact)
    count = 0.0
    for i in range(first, end if stopped else end - 1):
        meets = row.speed[i] - row.speed[i + 1]
        count += 1.0 if row.closed[i] == 0 and meets > least else 0.0
    return count


@borrowing
def collide(row: Row, contact: int, restitution: float) -> tuple[float, float]:
    """Collide two parts of a row and all that touch them; return energy lost, impulse on the stop.

    `contact` is the index of the rear part. Touching parts whose contact was open take part: pair
    by pair they would strike without end. With `restitution` e and the velocities u: u+ = (1 + e) y
    - e u, where y are the means of blocks whose parts would overlap, no larger than the velocity of
    a stop that takes part. Momentum is kept, and sum m (u - y)^2 (1 - e^2)/2 is lost, in mass times
    (g/w)^2 (w = 2 pi f); the impulse is in mass times g/w. Velocities, modes, gaps and contacts of
    `row` are changed (theory 17.2).
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

    Friction takes at most mu L off each velocity u, with the impulse L = `impulse` of the floor per
    mass in g/w (w = 2 pi f): u - mu L sgn(u). Touching parts that would overlap share the mean of
    their block, and those that friction would turn round stay at rest. Parts that touch a stop are
    no faster than the stop; the result, in mass times g/w, is the momentum that this costs.
    Velocities, modes and contacts of `row` are changed in place.
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
