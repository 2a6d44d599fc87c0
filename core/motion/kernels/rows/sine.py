"""A sine, or steps along the track, as the drive of a row: their part of `drive` (theory 17.3)."""

from __future__ import annotations

import math
from collections import namedtuple

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.planar.flow import flow, phase_to, swings
from vibrafeed.core.motion.kernels.rows.roots import (
    first_beyond,
    first_contact,
    first_stop,
    flight_time,
)
from vibrafeed.core.motion.kernels.rows.tables import Drive, Row

LONGEST_FLIGHT = 1000
"""Longest flight in turns of the drive: at throw numbers beyond some 3,000 no feeder works."""

Now = namedtuple("Now", "tau sine cosine")
"""A phase, its sine and its cosine."""


@borrowing
def pushes(drive: Drive, pull: float, tau: float) -> tuple[float, float]:
    """Return the push along the track, c sin(tau) - k, and the load on the floor, at least 0, in g.

    At the phase `tau`; k = `pull` is gravity along less the level of the drive's step.
    """
    return drive.c * math.sin(tau) - pull, max(0.0, drive.gn - drive.s * math.sin(tau))


@borrowing
def lift_off(drive: Drive, tau: float) -> float:
    """Return the phase in rad until parts lift off, where s sin(tau) rises through n."""
    return phase_to(math.asin(drive.gn / drive.s), tau) if drive.s > drive.gn else math.inf


@borrowing
def is_lifted(drive: Drive, tau: float) -> bool:
    """True if parts on the floor lift off at a phase."""
    return drive.s * math.sin(tau) > drive.gn


@borrowing
def flight(drive: Drive, tau: float) -> tuple[float, float]:
    """Return duration in rad and landing speed in g/w of a flight that begins at phase `tau`.

    z'' = s sin(tau) - gn from z = z' = 0, with drive s and gravity gn normal to the floor in g, w =
    2 pi f. (inf, 0) for flights longer than 1,000 periods.
    """
    span = flight_time(drive.s, drive.gn, tau, LONGEST_FLIGHT)
    if span == math.inf:
        return math.inf, 0.0
    return span, -flow(0.0, drive.s, drive.gn, math.sin(tau), math.cos(tau), span)[0]


@borrowing
def first_rise(
    drive: Drive, body: int, way: int, along: float, normal: float, level: float, tau: float
) -> float:
    """Return the phase in rad from `tau` until (a c + b s) sin rises above `level`; inf if never.

    a = `along`, b = `normal`; `body` and `way` are for waves only.
    """
    return first_beyond(along * drive.c + normal * drive.s, level, tau)


@borrowing
def set_flow(row: Row, drive: Drive, body: int, moves: bool, friction: float, drag: float) -> None:
    """Set C and k of a body's acceleration C sin(tau) - k; C = 0 unless it `moves`.

    C = c + `friction` s, where `friction` is mode times mu (0 in the air); k = `drag` in g; `body`
    is the index of the part or the stop.
    """
    row.gain[body], row.drag[body] = drive.c + friction * drive.s if moves else 0.0, drag


@borrowing
def at_phase(drive: Drive, tau: float) -> Now:
    """Return sine and cosine of the phase, which the searches below share."""
    return Now(tau, math.sin(tau), math.cos(tau))


@borrowing
def stop_until(row: Row, drive: Drive, part: int, now: Now, span: float) -> float:
    """Return the phase in rad until a sliding part's velocity comes to 0; inf if not within `span`.

    The velocity u of the part at index `part` of the row, relative to the track, follows u' = C
    sin(tau) - k, with C and k from `row.gain` and `row.drag`. `now` is the phase tau with its sine
    and cosine, `span` the phase searched in rad; `drive` is unused, since only waves need it.
    """
    return first_stop(
        row.speed[part], row.mode[part], row.gain[part], row.drag[part], now.tau, now.sine,
        now.cosine, span,
    )  # fmt: skip


@borrowing
def contact_until(row: Row, drive: Drive, contact: int, now: Now, span: float) -> float:
    """Return the phase in rad until a gap in a row closes: 0 if it does now, inf if not in `span`.

    `contact` is the index of the gap between part `contact` and its neighbour in front, `now` the
    phase with its sine and cosine, `span` the phase searched in rad. The relative velocity of both
    follows C sin(tau) - k, with the differences of `row.gain` and `row.drag`; `drive` is unused,
    since only waves need it.
    """
    gain = row.gain[contact + 1] - row.gain[contact]
    drag = row.drag[contact + 1] - row.drag[contact]
    apart = row.speed[contact + 1] - row.speed[contact]
    return first_contact(row.gap[contact], apart, gain, drag, now.tau, now.sine, now.cosine, span)


@borrowing
def relative_push(row: Row, drive: Drive, contact: int, tau: float) -> float:
    """Return the share of the drive in the relative acceleration of two neighbours, in g.

    Of the part in front less that of part `contact`, at the phase `tau`.
    """
    return (row.gain[contact + 1] - row.gain[contact]) * math.sin(tau)


@borrowing
def swung(drive: Drive, tau: float, span: float) -> tuple[float, float]:
    """Return the velocity and distance that sin adds over `span` rad from phase `tau` on."""
    return swings(math.sin(tau), math.cos(tau), span)


@borrowing
def carried(
    row: Row, drive: Drive, body: int, by: tuple[float, float], span: float
) -> tuple[float, float]:
    """Return the change of velocity and of position of a body over `span`, in g/w and g/w^2.

    Here w = 2 pi f and `span` is in rad. `body` is the index of a part of `row`, or of the stop,
    `by` the velocity and distance that sin(tau) adds in this time; `drive` is not used.
    """
    return (
        row.gain[body] * by[0] - row.drag[body] * span,
        row.speed[body] * span + row.gain[body] * by[1] - row.drag[body] * (span * span / 2.0),
    )


@borrowing
def swept(drive: Drive, tau: float, span: float) -> float:
    """Return the integral over `span` of the distance that sin adds from phase `tau` on.

    cos(tau + d) - cos(tau) + sin(tau) d + cos(tau) d^2/2, d = `span`.
    """
    sine, cosine = math.sin(tau), math.cos(tau)
    return math.cos(tau + span) - cosine + sine * span + cosine * span * span / 2.0


@borrowing
def gap_swept(row: Row, drive: Drive, contact: int, by: float) -> float:
    """Return the share of the drive in the integral of a gap over a phase.

    `contact` is the index of the gap, `by` the integral for sin(tau), from `swept`.
    """
    return (row.gain[contact + 1] - row.gain[contact]) * by


@borrowing
def sizes(drive: Drive) -> tuple[float, float]:
    """Return the amplitudes of both pushes in g, of which `above` and `highest` take multiples."""
    return drive.c, drive.s


@borrowing
def above(
    drive: Drive, body: int, along: float, normal: float, drag: float, tau: float, span: float
) -> float:
    """Return the integral of the positive part of a force, max(0, C sin(x) - k), over a phase.

    The least impulse of a row on its stop is such an integral. From phase `tau` over `span` rad, a
    turn at most; C = `along` + `normal` and k = `drag`, in g times mass. `drive` and `body` are
    unused, since only waves need them.
    """
    gain = along + normal
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
    """Return the integral of gain sin(x) - drag over `span` rad from phase `tau`."""
    return gain * (math.cos(tau) - math.cos(tau + span)) - drag * span


@borrowing
def highest(
    drive: Drive, body: int, along: float, normal: float, drag: float, tau: float, span: float
) -> float:
    """Return the largest value of a force C sin(x) - k over a phase, as that of a row on its stop.

    From phase `tau` over `span`, in rad; C = `along` + `normal` and k = `drag`, in g times mass.
    `drive` and `body` are unused, since only waves need them.
    """
    gain = along + normal
    top = phase_to(0.5 * math.pi if gain >= 0.0 else 1.5 * math.pi, tau)
    if top <= span:
        return abs(gain) - drag
    return max(gain * math.sin(tau), gain * math.sin(tau + span)) - drag
