"""A line of devices that let parts pass by the way they lie: how many, and which.

Its devices are those whose numbers a study gives: `wiper_height_1` is a wiper at the first place.
The scene is fitted to a study before that is planned: a line of two devices knows no others.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any

from vibrafeed.core.mechanics import drop_test, orienting
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.quantities.orienting import DEVICES, MAX_DEVICES, PAIRS
from vibrafeed.core.scenes.devices import Device, DeviceLine, end_of
from vibrafeed.core.scenes.scene import (
    Condition,
    Constraint,
    Equation,
    Function,
    Scene,
    field_of,
)
from vibrafeed.core.scenes.shapes import ASPECTS, SHAPES, WORDS, shares_of

LINE, TEST = "theory 16.3", "theory 16.4"
SIZES: dict[str, Function] = {
    "box": orienting.box_aspects,
    "cylinder": orienting.cylinder_aspects,
    "prism": orienting.prism_aspects,
    "truncated_cone": orienting.turned_aspects,
    "turned": orienting.turned_aspects,
}
_NUMBER = re.compile(rf"({'|'.join(DEVICES)})_(\d)")
POSITIONS = range(1, MAX_DEVICES + 1)

BRACKETED: dict[str, tuple[Function, str]] = {
    "yield": (orienting.line_yield, "share of the arriving parts that leave [1]"),
    "laps": (orienting.laps, "mean number of laps of a part until it passes [1]"),
    "line_feed_rate": (
        orienting.line_feed_rate, "number of parts that leave the line per minute [min-1]"
    ),
    "purity": (orienting.purity, "share of the leaving parts that lie as wanted [1]"),
    "oriented_feed_rate": (
        orienting.oriented_feed_rate, "number of parts that leave as wanted per minute [min-1]"
    ),
    "return_rate": (
        orienting.return_rate, "number of parts that fall back into the bowl per minute [min-1]"
    ),
}  # fmt: skip
"""What is given with both ends of what the shares leave open: its function, and what it is."""

RESULTS = (
    *(Equation(name, function, LINE) for name, (function, _) in BRACKETED.items()),
    *(
        end_of(name, function, end == "upper", says)
        for name, (function, says) in BRACKETED.items()
        for end in ("lower", "upper")
    ),
    Equation("laps_variance", orienting.laps_variance, LINE),
    Equation("laps_99", orienting.laps_99, LINE),
    Equation("time_per_part", orienting.time_per_part, LINE),
    Equation("leaving_wanted", orienting.leaving_wanted, LINE),
    Equation("yield_deviation", drop_test.yield_deviation, TEST),
)
OF_LINE = frozenset(one.gives for one in RESULTS if one.source == LINE)


def numbers_of(shape: str) -> tuple[str, ...]:
    """Return the device numbers that a shape can have; rails need parts with a head."""
    return tuple(n for n in DEVICES if n != "rail_width" or ASPECTS[shape][0] == "upright")


def passed_shares_of(shape: str) -> tuple[Equation, ...]:
    """Return the equations for the shares of parts that pass, by aspect, the way in which one lies.

    For each aspect of a `shape` (a key of `ASPECTS`) they give the share by a drop test, the share
    of the parts arriving in it that passes the line, and the share of all that leaves so.
    """
    rows: list[tuple[str, tuple[Any, ...], str, str]] = []
    for position, name in enumerate(ASPECTS[shape]):
        words = WORDS[name]
        rows += [
            (f"counted_share_{name}", (position,), "counted_shares",
             f"the share {words} by a drop test [1]"),
            (f"passing_share_{name}", ("passing", position), "line",
             f"the share that passes of those that arrive {words} [1]"),
            (f"leaving_share_{name}", ("leaving", position), "line",
             f"the share of all arriving parts that leaves {words} [1]"),
        ]  # fmt: skip
    return tuple(field_of(bundle, path, gives, says, LINE) for gives, path, bundle, says in rows)


def equations(shape: str) -> tuple[Equation, ...]:
    """Return the equations of an orienting line for a shape of parts, without those of the devices.

    `shape` is a key of `ASPECTS`.
    """
    counts = tuple(f"drop_count_{k}" for k in range(1, len(ASPECTS[shape]) + 1))
    count, posterior = (
        Equation(gives, partial(_of_counts, one), TEST, needs=counts, says=one.__doc__ or "")
        for gives, one in (
            ("drop_count", drop_test.posterior_count),
            ("counted_shares", drop_test.posterior_shares),
        )
    )
    return (
        *shares_of(shape),
        Equation("aspect_sizes", SIZES[shape], LINE),
        count,
        posterior,
        *passed_shares_of(shape),
        *RESULTS,
    )


def any_line(shape: str) -> tuple[Equation, ...]:
    """Return the equations of an orienting line with devices of all kinds at all places.

    They serve to list the parameters that a study of parts of this shape may give.
    """
    every = tuple(Device(place, numbers_of(shape)) for place in POSITIONS)
    names = (name for device in every for name in device.inputs)
    listed = (
        ("devices", LINE, (*names, "device_order")),
        ("line", LINE, ("let_down_shares", "devices")),
        ("thrown_line", LINE, ("thrown_shares", "devices")),
        ("counted_line", TEST, ("counted_shares", "devices")),
    )
    return (
        *equations(shape),
        *(Equation(gives, _unfitted, source, needs=needs) for gives, source, needs in listed),
        Equation("line_ends", orienting.line_ends, LINE),
    )


def _of_counts(function: Callable[[Sequence[Array]], Any], **counts: Array) -> Any:
    return function([*counts.values()])


def _unfitted(**values: Any) -> Any:
    """Return the devices of a line [1]."""
    raise NotImplementedError  # the scene must first be fitted to the devices of a study


def fit_to_study(scene: Scene, parameters: Collection[str]) -> Scene:
    """Return the scene with the devices, and perhaps the drop test, that a study has.

    They follow from the names of its parameters, such as `wiper_height_1` or `drop_count_2`.
    """
    names = {*parameters}
    numbers = tuple(sorted(name for name in names if _NUMBER.fullmatch(name)))
    tested = any(name.startswith("drop_count_") for name in names)
    return _fitted(scene.name, numbers, "device_order" in names, tested)


@lru_cache(maxsize=64)
def _fitted(_: str, numbers: tuple[str, ...], ordered: bool, tested: bool) -> Scene:
    """Return the scene of an orienting line with the devices of a study; cached by its arguments.

    `numbers` are the names of the devices' parameters, which end in the place of a device, such as
    ``wiper_height_1``; `ordered` is true if the study gives the order of the devices as a number,
    `tested` if it gives a drop test. The first argument is only part of the cache's key.
    """
    devices: dict[int, list[str]] = {}
    for number, place in (match.groups() for match in map(_NUMBER.fullmatch, numbers) if match):
        devices.setdefault(int(place), []).append(number)
    order = Constraint(
        ("device_order",),
        lambda least, largest: 1 <= least <= largest <= math.factorial(len(devices)),
        f"{len(devices)} devices stand in {math.factorial(len(devices))} orders",
        f"Give 1 to {math.factorial(len(devices))}",
    )
    return replace(
        SCENE,
        variants={
            shape: _equations_with_devices(shape, devices, ordered, tested) for shape in SHAPES
        },
        defaults={name: value for name, value in SCENE.defaults.items() if name != "devices"},
        constraints=(*SCENE.constraints, order),
    )


def _equations_with_devices(
    shape: str, numbers: dict[int, list[str]], ordered: bool, tested: bool
) -> tuple[Equation, ...]:
    """Return the equations of an orienting line for a shape of parts, with the devices of a study.

    `numbers` has for each place of the line, from 1, the names of what the study gives of the
    device there, such as ``wiper_height``; `ordered` is true if the study gives the order of the
    devices, `tested` if it gives a drop test, from which the shares and their ends are then taken.
    """
    known, aspects = numbers_of(shape), len(ASPECTS[shape])
    devices = [
        Device(place, tuple(n for n in known if n in numbers[place])) for place in sorted(numbers)
    ]
    line = DeviceLine(tuple(d for d in devices if d.numbers), aspects, ordered)
    lines = (
        *equations(shape),
        line.equation("thrown_line", "thrown_shares", LINE),
        line.equation("counted_line", "counted_shares", TEST),
    )
    if tested:
        says = "the shares that pass by a drop test [1]"
        ends = Equation("line_ends", drop_test.line_ends, TEST)
        return (*lines, field_of("counted_line", (), "line", says, TEST), ends)
    return (
        *lines,
        line.equation("line", "let_down_shares", LINE),
        Equation("line_ends", orienting.line_ends, LINE),
    )


def _turns(least: float, largest: float) -> bool:
    """True if both ends of a range are numbers of pairs of aspects, as a turning device needs."""
    return least in PAIRS and largest in PAIRS


SCENE = Scene(
    name="orienting-line",
    title="A line of devices that orient parts",
    source="",
    validity="Parts arrive one by one in the shares in which they come to rest: those that a drop "
    "test counted, else those of let-down parts. Lower and upper ends are then those of let-down "
    "and of thrown parts, between which the truth lies. Each device sees only how parts lie. What "
    "falls back into the bowl comes again in any orientation: it does not remember how it lay. A "
    "vibrating track may lay parts down by itself.",
    variants={shape: any_line(shape) for shape in SHAPES},
    default_variant="box",
    conditions={
        shape: (Condition("no_pass", orienting.lets_none_pass, OF_LINE, otherwise="passes"),)
        for shape in SHAPES
    },
    defaults={"delta": 0.0, "devices": 0.0, **{f"turn_{place}": 21.0 for place in POSITIONS}},
    constraints=(
        *(
            Constraint(
                (f"turn_{place}",), _turns, "it names no two aspects", "Give 21, 32, 31, 12, 23, 13"
            )
            for place in POSITIONS
        ),
        *(
            Constraint(
                ("wanted_aspect",), lambda _, largest: largest <= 2,
                f"a {shape} has the aspects 1, on its side, and 2, on an end", "Give 1 or 2", shape,
            )
            for shape in ("cylinder", "prism")
        ),
    ),
    fit=fit_to_study,
)  # fmt: skip
