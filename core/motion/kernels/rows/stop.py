"""The force of a row on its stop, between two events (theory 17.6)."""

from __future__ import annotations

from collections import namedtuple

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.rows.contact import held_from, pooled
from vibrafeed.core.motion.kernels.rows.drive import Driven, above, highest, sizes
from vibrafeed.core.motion.kernels.rows.tables import ON_TRACK, Row

Pressed = namedtuple("Pressed", "impulse peak")
"""The integral of a force over a phase, and its largest value."""

NOT_PRESSED = Pressed(0.0, 0.0)


@borrowing
def stop_pressed(
    row: Row, drive: Driven, pull: float, tau: float, span: float, flying: bool
) -> Pressed:
    """Return impulse and largest force of a row on the stop in front, over a time without events.

    In flight or sliding, the force is that which keeps the touching parts at the velocity of the
    stop: for a stop at rest in space sum m (-gs - mode mu n), for one of the track in flight sum m
    times the push D. Where parts rest on the floor at a stop of the track it is the least force,
    sum m max(0, D - mu_s n) over the blocks; friction may hold more (theory 17.6).

    Parameters
    ----------
    row, drive
        Parts with their contacts and modes; push of the drive and gravity, in g.
    pull
        Gravity along the track less the level of the drive's step, in g.
    tau, span
        Phase at the start and duration, in rad.
    flying
        True if the parts are in the air.
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
    """Return the least impulse and force by which parts at rest press on a stop of the track.

    From part `first` of the row on, over `span` rad from phase `tau`; `pull` is gravity along less
    the level of the drive's step, in g. Blocks of parts farther in front are the more slippery, and
    press first: at every time the force is the largest of the sums over the blocks from one on to
    the front, or 0.
    """
    parts = row.mass.size
    for i in range(first, parts):
        row.value[i] = -row.static[i]
    blocks = pooled(row, first, parts)
    impulse, (push, lift) = 0.0, sizes(drive)
    for b in range(blocks):
        begin, mu, mass = _block(row, first, b)
        impulse += mass * above(drive, begin, push, mu * lift, pull + mu * drive.gn, tau, span)
    peak, along, normal, drag = 0.0, 0.0, 0.0, 0.0
    for b in range(blocks - 1, -1, -1):
        _, mu, mass = _block(row, first, b)
        along, normal = along + mass * push, normal + mass * mu * lift
        drag += mass * (pull + mu * drive.gn)
        peak = max(peak, highest(drive, parts, along, normal, drag, tau, span))
    return Pressed(impulse, peak)


@borrowing
def _block(row: Row, first: int, number: int) -> tuple[int, float, float]:
    """Return first part, static friction coefficient and mass of a block of parts in a row.

    Blocks are runs of neighbours that start together. The function `pooled` has left their last
    parts in `row.last` and minus their friction in `row.value`. `number` is the index of the block,
    `first` the index of the first part of block 0.
    """
    begin, mass = row.last[number - 1] + 1 if number > 0 else first, 0.0
    for i in range(begin, row.last[number] + 1):
        mass += row.mass[i]
    return begin, -row.value[begin], mass
