"""How hard a row presses on its stop, between two events (theory 17.6)."""

from __future__ import annotations

import math
from collections import namedtuple

from core.compiled import borrowing
from core.motion.kernels.planar.flow import phase_to
from core.motion.kernels.rows.contact import held_from, pooled
from core.motion.kernels.rows.tables import ON_TRACK, Drive, Row

Pressed = namedtuple("Pressed", "impulse peak")
"""The integral of a force over a phase, and its largest value."""

NOT_PRESSED = Pressed(0.0, 0.0)


@borrowing
def stop_pressed(
    row: Row, drive: Drive, pull: float, tau: float, span: float, flying: bool
) -> Pressed:
    """Return how the row presses on its stop over a phase in which no event is, per weight.

    In space, sliding: sum of m (-gs - mode mu n). In the air: sum of m times what the push exceeds
    the stop's acceleration by. On a stop of the track, at rest, the least force: the sum over the
    blocks of a row pushed forward, m max(0, D - mu_s n); friction may hold more.
    """
    first, parts = held_from(row), row.mass.size
    if first == parts:
        return NOT_PRESSED
    if row.stop == ON_TRACK and not flying:
        return _least(row, drive, pull, tau, span, first)
    gain, drag = 0.0, 0.0
    for i in range(first, parts):
        if row.stop == ON_TRACK:
            gain += row.mass[i] * drive.c
            drag += row.mass[i] * pull
        else:
            friction = 0.0 if flying else row.mode[i] * row.kinetic[i]
            gain += row.mass[i] * friction * drive.s
            drag += row.mass[i] * (drive.gs + friction * drive.gn)
    impulse = above(gain, drag, tau, span)
    return Pressed(impulse, max(0.0, highest(gain, drag, tau, span)))


@borrowing
def _least(row: Row, drive: Drive, pull: float, tau: float, span: float, first: int) -> Pressed:
    """Return the least force of parts at rest on a stop of the track."""
    parts = row.mass.size
    for i in range(first, parts):
        row.value[i] = -row.static[i]
    blocks = pooled(row, first, parts)
    impulse, begin = 0.0, first
    for b in range(blocks):
        mu, mass = -row.value[begin], 0.0
        for i in range(begin, row.last[b] + 1):
            mass += row.mass[i]
        impulse += mass * above(drive.c + mu * drive.s, pull + mu * drive.gn, tau, span)
        begin = row.last[b] + 1
    # Every block's force bends upwards where it begins: the sum is largest at an end or a turn.
    peak = 0.0
    for way in (0.0, 1.0, 0.5 * math.pi, 1.5 * math.pi):
        at = way * span if way <= 1.0 else phase_to(way, tau)
        if at <= span:
            force = 0.0
            for i in range(first, parts):
                mu = -row.value[i]
                push = (drive.c + mu * drive.s) * math.sin(tau + at) - pull - mu * drive.gn
                force += row.mass[i] * max(0.0, push)
            peak = max(peak, force)
    return Pressed(impulse, peak)


@borrowing
def above(gain: float, drag: float, tau: float, span: float) -> float:
    """Return the integral of max(0, C sin(x) - k) over a phase of a turn at most."""
    if gain == 0.0:
        return max(0.0, -drag) * span
    if abs(gain) <= abs(drag):
        return _whole(gain, drag, tau, span) if drag < 0.0 else 0.0
    angle = math.asin(drag / gain)
    one, other = phase_to(angle, tau), phase_to(math.pi - angle, tau)
    total, at = 0.0, 0.0
    for until in (min(one, other, span), min(max(one, other), span), span):
        middle = tau + 0.5 * (at + until)
        if until > at and gain * math.sin(middle) > drag:
            total += _whole(gain, drag, tau + at, until - at)
        at = until
    return total


@borrowing
def _whole(gain: float, drag: float, tau: float, span: float) -> float:
    return gain * (math.cos(tau) - math.cos(tau + span)) - drag * span


@borrowing
def highest(gain: float, drag: float, tau: float, span: float) -> float:
    """Return the largest value of C sin(x) - k over a phase."""
    top = phase_to(0.5 * math.pi if gain >= 0.0 else 1.5 * math.pi, tau)
    if top <= span:
        return abs(gain) - drag
    return max(gain * math.sin(tau), gain * math.sin(tau + span)) - drag
