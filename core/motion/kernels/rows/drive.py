"""The seam between rows and their drive: what a drive has to tell.

Each function here is two, one for a sine, or steps along the track, and one for any other wave;
which one is meant the compiler sees from the type of `drive`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias, TypeVar

from vibrafeed.core.compiled import by_type
from vibrafeed.core.motion.kernels.rows import sine, tables, wave
from vibrafeed.core.motion.kernels.rows.tables import Drive, Row
from vibrafeed.core.motion.kernels.rows.wave import RowWave

Driven: TypeAlias = Drive | RowWave
"""Both have the fields `c` and `s`, largest pushes, `gs`, `gn`, `ends` and `levels`."""

Function = TypeVar("Function", bound=Callable[..., Any])


def _by_drive(for_sine: Any, for_wave: Any) -> Callable[[Function], Function]:
    """Return a decorator that selects a sine's or a wave's function by the type of `drive`."""
    return by_type("drive", {Drive: for_sine, RowWave: for_wave})


@_by_drive(sine.pushes, wave.pushes)
def pushes(drive: Driven, pull: float, tau: float) -> tuple[float, float]:
    """Return the push along the track less `pull`, and the load on the floor, at least 0, in g.

    At the phase `tau`; `pull` is gravity along the track, less the level of a step.
    """
    raise NotImplementedError


@_by_drive(sine.lift_off, wave.lift_off)
def lift_off(drive: Driven, tau: float) -> float:
    """Return the phase in rad from `tau` until parts lift off the floor; inf if they never do."""
    raise NotImplementedError


@_by_drive(sine.is_lifted, wave.is_lifted)
def is_lifted(drive: Driven, tau: float) -> bool:
    """True if the drive lifts parts off the floor at the phase `tau`.

    Its push off the floor then exceeds gravity.
    """
    raise NotImplementedError


@_by_drive(sine.flight, wave.flight)
def flight(drive: Driven, tau: float) -> tuple[float, float]:
    """Return duration in rad and landing speed in g/w of a flight from rest at phase `tau`.

    Infinite and 0 if no landing is found. Here w = 2 pi f.
    """
    raise NotImplementedError


@_by_drive(tables.backward_speed, wave.backward_speed)
def backward_speed(drive: Driven) -> float:
    """Return the velocity relative to the track, at phase 0, of a body at rest in space, in g/w.

    A stop at rest in space starts with it. Here w = 2 pi f.
    """
    raise NotImplementedError


@_by_drive(sine.first_rise, wave.first_rise)
def first_rise(
    drive: Driven, body: int, way: int, along: float, normal: float, level: float, tau: float
) -> float:
    """Return the phase in rad from `tau` until a push rises above `level`; inf if it never does.

    The push is `along` times that along the track plus `normal` times that off the floor, in g.
    `body` (an index) and `way` (1 or -1) say in which table a wave may keep what it computes.
    """
    raise NotImplementedError


# --- parts


@_by_drive(sine.set_flow, wave.set_flow)
def set_flow(row: Row, drive: Driven, body: int, moves: bool, friction: float, drag: float) -> None:
    """Set the acceleration of a body: 0 unless it `moves`, else along + friction normal - drag.

    `along` and `normal` are the pushes of the drive; `friction` is mode times mu (0 in the air and
    for a stop), `drag` the constant k in g. `body` is the index of a part or of the stop.
    """
    raise NotImplementedError


@_by_drive(sine.at_phase, wave.at_phase)
def at_phase(drive: Driven, tau: float) -> Any:
    """Return the terms of a phase `tau` that several searches share, handed on as `now`."""
    raise NotImplementedError


@_by_drive(sine.stop_until, wave.stop_until)
def stop_until(row: Row, drive: Driven, part: int, now: Any, span: float) -> float:
    """Return the phase in rad until a sliding part's velocity is 0; inf if not within `span`.

    `part` is its index, `now` the result of `at_phase`.
    """
    raise NotImplementedError


@_by_drive(sine.contact_until, wave.contact_until)
def contact_until(row: Row, drive: Driven, contact: int, now: Any, span: float) -> float:
    """Return the phase in rad until an open gap closes; inf if not within `span`, at most one turn.

    `contact` is the index of the gap, in front of the part with the same index; `now` is the result
    of `at_phase`.
    """
    raise NotImplementedError


@_by_drive(sine.relative_push, wave.relative_push)
def relative_push(row: Row, drive: Driven, contact: int, tau: float) -> float:
    """Return the share of the drive in the relative acceleration of two neighbours, in g.

    Of the part in front less that of part `contact`, at the phase `tau`.
    """
    raise NotImplementedError


@_by_drive(sine.swung, wave.swung)
def swung(drive: Driven, tau: float, span: float) -> Any:
    """Return the velocity and distance that the drive adds over `span` from phase `tau`.

    Computed once for all bodies, handed on to `carried`.
    """
    raise NotImplementedError


@_by_drive(sine.carried, wave.carried)
def carried(row: Row, drive: Driven, body: int, by: Any, span: float) -> tuple[float, float]:
    """Return the change of velocity and of position of a body over `span`, in g/w and g/w^2.

    `body` is the index of a part or of the stop, `by` the result of `swung`. Here w = 2 pi f.
    """
    raise NotImplementedError


@_by_drive(sine.swept, wave.swept)
def swept(drive: Driven, tau: float, span: float) -> Any:
    """Return the integral of the distance that the drive adds over `span` from phase `tau`.

    Computed once for all gaps, handed on to `gap_swept`.
    """
    raise NotImplementedError


@_by_drive(sine.gap_swept, wave.gap_swept)
def gap_swept(row: Row, drive: Driven, contact: int, by: Any) -> float:
    """Return the share of the drive in the integral of a gap over a phase; means of gaps need it.

    `contact` is the index of the gap, `by` the result of `swept`.
    """
    raise NotImplementedError


# --- forces on a stop


@_by_drive(sine.sizes, wave.sizes)
def sizes(drive: Driven) -> tuple[float, float]:
    """Return the amplitudes along and normal of which `above` and `highest` take multiples.

    The amplitudes of a sine in g; 1, 1 for a wave.
    """
    raise NotImplementedError


@_by_drive(sine.above, wave.above)
def above(
    drive: Driven, body: int, along: float, normal: float, drag: float, tau: float, span: float
) -> float:
    """Return the integral of max(0, a P + b S - k) over `span` from phase `tau`, without a step.

    It is the impulse of a force that can only push. P and S are the pushes along and off the floor
    over `sizes`, a and b `along` and `normal`, k the `drag`; `body` says in which table a wave may
    keep what it computes.
    """
    raise NotImplementedError


@_by_drive(sine.highest, wave.highest)
def highest(
    drive: Driven, body: int, along: float, normal: float, drag: float, tau: float, span: float
) -> float:
    """Return the largest value of a P + b S - k over `span` from phase `tau`, without a step.

    P and S are the pushes along and off the floor over `sizes`, a and b `along` and `normal`, k the
    `drag`; `body` says in which table a wave may keep what it computes.
    """
    raise NotImplementedError
