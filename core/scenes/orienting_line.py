"""A line of devices that let parts pass by the way they lie: how many, and which.

Its devices are those whose numbers a study gives: `wiper_height_1` is a wiper at the first place.
The scene is fitted to a study before that is planned: a line of two devices knows no others.
"""

import math
import re
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np

from vibrafeed.core.mechanics import orienting
from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.mechanics.orienting import Matrix, PassedShares
from vibrafeed.core.quantities.orienting import DEVICES, MAX_DEVICES, NUMBERED, PAIRS
from vibrafeed.core.scenes.resting_part import (
    ASPECTS,
    FILE,
    SHAPES,
    WORDS,
    number_of_aspects,
    shares_of,
)
from vibrafeed.core.scenes.scene import (
    MESH,
    UNREAD,
    Condition,
    Constraint,
    Equation,
    Function,
    MeshPart,
    Scene,
    arguments_of,
    field_of,
)

# --- The devices of a line, by the names of the numbers that a study gives of them.

PASSES: dict[str, Callable[[Array, dict[str, Any], int], list[Mask]]] = {
    # A part that is no higher than the edge of the wiper.
    "wiper_height": lambda height, at, _: [size.height <= height for size in at["aspect_sizes"]],
    # One whose front is farther from its centre than the gap is long: it is carried until its front
    # has landed. `way` is 1 or -1 by the way round in which the part lies.
    "gap_length": lambda gap, at, _: [
        size.along / 2 + at["way"] * size.off_along > gap for size in at["aspect_sizes"]
    ],
    # One whose centre is above the ledge, (w - a/2) + z tan(delta) > 0: a track that leans by delta
    # holds the part, of the size a across and with its centre at the height z, on the wall.
    "ledge_width": lambda width, at, _: [
        width - size.across / 2 + at["way"] * size.off_across + centre * np.tan(at["delta"]) > 0
        for size, centre in zip(at["aspect_sizes"], at["centre_heights"], strict=True)
    ],
    "passed_aspect": lambda passed, _, aspects: [passed == k for k in range(1, aspects + 1)],
}
"""Where parts of each aspect pass a device: by its number, the parameters, and the aspects."""


@dataclass(frozen=True)
class Device:
    """The device at a place: what parts have to pass there, by the names of its numbers."""

    place: int
    numbers: tuple[str, ...]

    @property
    def inputs(self) -> tuple[str, ...]:
        """The quantities that it needs: its numbers, and sizes of parts that these are compared to.

        A number's name ends in the place of the device.
        """
        needs = {
            "wiper_height": ("aspect_sizes",), "gap_length": ("aspect_sizes",),
            "ledge_width": ("aspect_sizes", "centre_heights", "delta"),
            "rail_width": ("shank_diameter", "diameter"), "outlet_capacity": ("arrival_rate",),
        }  # fmt: skip
        compared = [name for number in self.numbers for name in needs.get(number, ())]
        turning = ("turned_share", "turn") if self.turns else ()
        own = dict.fromkeys((*self.numbers, *turning))  # each once
        return (*(f"{number}_{self.place}" for number in own), *compared)

    @property
    def turns(self) -> bool:
        """True if the device turns parts."""
        return bool({"turned_share", "turn"} & set(self.numbers))

    def matrix(self, aspects: int, parameters: dict[str, Any]) -> Matrix:
        """Return the effect of the device on parts, as a matrix over their `aspects`.

        Entry j of row i is the share of the parts that arrive in aspect i and go on in aspect j, an
        array over cells; the others fall back. `parameters` are in SI units.
        """
        own: dict[str, Any] = {name: parameters.get(f"{name}_{self.place}") for name in DEVICES}
        tests = [
            PASSES[number](own[number], parameters, aspects)
            for number in self.numbers
            if number in PASSES
        ]
        matrix = orienting.unchanged(aspects)
        for passing in tests:
            matrix = orienting.product(matrix, orienting.test_of(passing))
        if "rail_width" in self.numbers:
            # Upright parts fall between the rails, others go on inverted if their head holds them.
            width, shank = own["rail_width"], parameters["shank_diameter"]
            hangs = np.where((shank < width) & (width < parameters["diameter"]), 1.0, 0.0)
            zero = np.zeros(())
            rail = [[zero, zero, zero], [zero, zero, hangs], [zero, zero, hangs]]
            matrix = orienting.product(matrix, rail)
        if self.turns:
            matrix = orienting.turning(matrix, own["turned_share"], own["turn"], failed=bool(tests))
        return matrix


@dataclass(frozen=True)
class DeviceLine:
    """A line of devices: what passes it.

    Attributes
    ----------
    devices : tuple of Device
        In the order of their places.
    aspects : int
        How many aspects parts have.
    ordered : bool
        Whether the study says in which order they stand.
    ways : tuple of float
        Both ways round, 1 and -1, in which a part is as likely to lie; one if it does not matter.
    """

    devices: tuple[Device, ...]
    aspects: int
    ordered: bool
    ways: tuple[float, ...] = (1.0,)

    def equation(self, gives: str, shares: str, source: str) -> Equation:
        """Return the equation of what passes of parts that arrive in these `shares`, a quantity."""
        own = [name for device in self.devices for name in device.inputs]
        needs = (shares, *own, *(["device_order"] * self.ordered))
        says = "Return what passes the devices of a line, one after another [1]."
        return Equation(gives, partial(self._passed, shares), source, needs=needs, says=says)

    def _passed(self, arriving: str, **values: Any) -> PassedShares:
        # The matrices of all devices, for each way round of the parts.
        matrices = [
            [device.matrix(self.aspects, {**values, "way": way}) for device in self.devices]
            for way in self.ways
        ]
        outlets = [
            values[f"outlet_capacity_{device.place}"]
            if "outlet_capacity" in device.numbers
            else None
            for device in self.devices
        ]
        shares = values[arriving]
        if self.ordered:
            in_order = [
                self._in_order(of_way, outlets, values["device_order"]) for of_way in matrices
            ]
            matrices, outlets = [of_way for of_way, _ in in_order], in_order[0][1]
        passed = [orienting.unchanged(self.aspects) for _ in self.ways]
        for place, outlet in enumerate(outlets):
            passed = [
                orienting.product(before, of_way[place])
                for before, of_way in zip(passed, matrices, strict=True)
            ]
            if outlet is not None:
                flow = orienting.mean(passed)
                share = orienting.outlet_share(shares, flow, values["arrival_rate"], outlet)
                passed = [[[cell * share for cell in row] for row in matrix] for matrix in passed]
        return orienting.passed(shares, orienting.mean(passed))

    def _in_order(
        self, matrices: list[Matrix], outlets: list[Array | None], order: Array
    ) -> tuple[list[Matrix], list[Array | None]]:
        # The order may differ from cell to cell: so may the device that stands at a place.
        capacities = [np.asarray(np.inf) if outlet is None else outlet for outlet in outlets]
        has_outlet = any(outlet is not None for outlet in outlets)
        sorted_matrices: list[Matrix] = []
        sorted_outlets: list[Array | None] = []
        aspects = range(self.aspects)
        for device in orienting.devices_in_order(order, len(matrices)):
            masks = [device == number for number in range(len(matrices))]
            sorted_matrices.append(
                [
                    [_select(masks, [matrix[row][column] for matrix in matrices])
                     for column in aspects]
                    for row in aspects
                ]
            )  # fmt: skip
            sorted_outlets.append(_select(masks, capacities) if has_outlet else None)
        return sorted_matrices, sorted_outlets


def _select(masks: list[Any], values: list[Array]) -> Array:
    """Return each value where its mask is True, the first where none is."""
    selected = values[0]
    for mask, value in zip(masks[1:], values[1:], strict=True):
        selected = np.where(mask, value, selected)
    return selected


def end_of(name: str, function: Function, upper: bool, says: str) -> Equation:
    """Return the equation of the lesser or the larger value at both ends of a line's shares.

    `function` gives the output `name` from a `line`; `says` describes it, with its unit.
    """

    def value(*, line_ends: tuple[PassedShares, PassedShares], **values: Any) -> Array:
        both = [function(line=line, **values) for line in line_ends]
        end: Array = (np.maximum if upper else np.minimum)(*both)
        return end

    needs = ("line_ends", *(name for name in arguments_of(function) if name != "line"))
    gives = f"{name}_{'upper' if upper else 'lower'}"
    says = f"Return the {'largest' if upper else 'least'} {says}."
    return Equation(gives, value, "theory 16.3", needs=needs, says=says)


LINE, TEST = "theory 16.3", "theory 16.4"
SIZES: dict[str, Function] = {
    "box": orienting.box_aspects,
    "weighted_box": orienting.weighted_box_aspects,
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
    Equation("yield_deviation", orienting.yield_deviation, TEST),
)
OF_LINE = frozenset(result.gives for result in RESULTS if result.source == LINE)


def numbers_of(shape: str) -> tuple[str, ...]:
    """Return the device numbers that a shape can have; rails need parts with a head."""
    has_head = shape != MESH and ASPECTS[shape][0] == "upright"
    return tuple(number for number in DEVICES if number != "rail_width" or has_head)


def passed_shares_of(shape: str) -> tuple[Equation, ...]:
    """Return the equations for the shares of parts that pass, by aspect, the way in which one lies.

    The share by a drop test, that of the parts arriving in the aspect that passes, and that of all
    that leaves so.
    """
    return tuple(
        field_of(bundle, path, f"{gives}_{name}", says.format(WORDS[name]), LINE)
        for place, name in enumerate(ASPECTS[shape])
        for gives, bundle, path, says in (
            ("counted_share", "counted_shares", (place,), "the share {} by a drop test [1]"),
            ("passing_share", "line", ("passing", place),
             "the share that passes of those that arrive {} [1]"),
            ("leaving_share", "line", ("leaving", place),
             "the share of all arriving parts that leaves {} [1]"),
        )
    )  # fmt: skip


def equations(shape: str, part: MeshPart) -> tuple[Equation, ...]:
    """Return the equations of an orienting line for a shape of parts, without those of the devices.

    `shape` is a key of `ASPECTS`, or `MESH` of a `part`.
    """
    if shape == MESH:
        own = _mesh_equations(part)
    else:
        sizes = Equation("aspect_sizes", SIZES[shape], LINE)
        own = (*shares_of(shape), sizes, *passed_shares_of(shape))
    return (*own, *counted(aspects_of(shape, part)), *RESULTS)


def aspects_of(shape: str, part: MeshPart) -> int:
    """Return the number of a shape's aspects."""
    return len(part.aspects if shape == MESH else ASPECTS[shape])


def counted(aspects: int) -> tuple[Equation, ...]:
    """Return the equations of a drop test, for up to `NUMBERED` aspects."""
    if aspects > NUMBERED:
        return ()
    counts = tuple(f"drop_count_{k}" for k in range(1, aspects + 1))
    return (
        Equation("drop_count", orienting.posterior_count, TEST, needs=counts),
        Equation("counted_shares", orienting.posterior_shares, TEST, needs=counts),
    )


def _constant(value: tuple[Any, ...]) -> tuple[Any, ...]:
    return value


def _mesh_equations(part: MeshPart) -> tuple[Equation, ...]:
    aspects = part.aspects
    bundles: dict[str, tuple[tuple[Any, ...], str]] = {
        "let_down_shares": (
            tuple(aspect.let_down_share for aspect in aspects),
            "share let down [1]",
        ),
        "thrown_shares": (tuple(aspect.thrown_share for aspect in aspects), "share thrown [1]"),
        "centre_heights": (
            tuple(aspect.centre_height for aspect in aspects),
            "centre's height [m]",
        ),
        "aspect_sizes": (
            tuple(
                orienting.Aspect(*map(np.asarray, (aspect.height, aspect.width, aspect.length)))
                for aspect in aspects
            ),
            "sizes [m]",
        ),
    }
    return tuple(
        Equation(gives, partial(_constant, values), FILE, needs=(),
                 says=f"Return the {says} in each aspect of a part from a file.")
        for gives, (values, says) in bundles.items()
    )  # fmt: skip


def any_line(shape: str) -> tuple[Equation, ...]:
    """Return the equations of an orienting line with devices of all kinds at all places.

    They serve to list the parameters that a study may give.
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
        *equations(shape, UNREAD),
        *(Equation(gives, _unfitted, source, needs=needs) for gives, source, needs in listed),
        Equation("line_ends", orienting.line_ends, LINE),
    )


def _unfitted(**values: Any) -> Any:
    raise NotImplementedError  # the scene must first be fitted to the devices of a study


def fit_to_study(scene: Scene, parameters: Collection[str]) -> Scene:
    """Return the scene with the devices, and perhaps the drop test, that a study has.

    They follow from the names of its parameters, such as `wiper_height_1` or `drop_count_2`.
    """
    names = {*parameters}
    numbers = tuple(sorted(name for name in names if _NUMBER.fullmatch(name)))
    tested = any(name.startswith("drop_count_") for name in names)
    return _fitted(numbers, "device_order" in names, tested, scene.part)


@lru_cache(maxsize=64)
def _fitted(numbers: tuple[str, ...], ordered: bool, tested: bool, part: MeshPart) -> Scene:
    """Return the scene with the devices and the drop test of a study."""
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
            shape: _equations_with_devices(shape, devices, ordered, tested, part)
            for shape in (*SHAPES, MESH)
        },
        defaults={name: value for name, value in SCENE.defaults.items() if name != "devices"},
        constraints=(*constraints(part), order),
        part=part,
    )


def _equations_with_devices(
    shape: str, numbers: dict[int, list[str]], ordered: bool, tested: bool, part: MeshPart
) -> tuple[Equation, ...]:
    aspects = aspects_of(shape, part)
    devices = [
        Device(place, tuple(name for name in numbers_of(shape) if name in numbers[place]))
        for place in sorted(numbers)
    ]
    ways = (1.0, -1.0) if shape == "weighted_box" else (1.0,)
    line = DeviceLine(tuple(device for device in devices if device.numbers), aspects, ordered, ways)
    lines = (
        *equations(shape, part),
        line.equation("thrown_line", "thrown_shares", LINE),
        *([line.equation("counted_line", "counted_shares", TEST)] * (aspects <= NUMBERED)),
    )
    if tested and aspects <= NUMBERED:
        says = "the shares that pass by a drop test [1]"
        ends = Equation("line_ends", orienting.tested_line_ends, TEST)
        return (*lines, field_of("counted_line", (), "line", says, TEST), ends)
    return (
        *lines,
        line.equation("line", "let_down_shares", LINE),
        Equation("line_ends", orienting.line_ends, LINE),
    )


def _turn_constraint(position: int, shape: str, aspects: int) -> Constraint:
    pairs = [str(pair) for pair in PAIRS if max(divmod(pair, 10)) <= aspects]
    return Constraint(
        (f"turn_{position}",),
        lambda *ends: {*ends} <= {*map(float, pairs)},
        "it names no two aspects",
        f"Give {', '.join(pairs[:6])}{' and so on' if pairs[6:] else ''}",
        shape,
    )


def _aspect_constraint(name: str, shape: str) -> Constraint:
    names = [f"{place}, {WORDS[aspect]}" for place, aspect in enumerate(ASPECTS[shape], 1)]
    *before, last = (name.replace("`", "") for name in names)
    return Constraint(
        (name,),
        lambda _, largest: largest <= len(names),
        f"a {shape} has the aspects {', '.join(before)}, and {last}",
        f"Give 1 to {len(names)}" if len(names) > 2 else "Give 1 or 2",
        shape,
    )


def constraints(part: MeshPart) -> tuple[Constraint, ...]:
    """Return the relations of numbers of aspects to those that each shape, or a `part`, has."""
    shapes = (*SHAPES, MESH)
    turns = (
        _turn_constraint(position, shape, aspects_of(shape, part))
        for position in POSITIONS
        for shape in shapes
    )
    named = ("wanted_aspect", *(f"passed_aspect_{position}" for position in POSITIONS))
    return (
        *turns,
        *(_aspect_constraint(name, shape) for name in named for shape in SHAPES),
        *(number_of_aspects(name, part) for name in named),
    )


SCENE = Scene(
    name="orienting-line",
    title="A line of devices that orient parts",
    source="",
    validity="Parts arrive one by one, in the shares of a drop test or, without one, in the "
    "shares of let-down parts. The lower and upper limits are then the values for let-down and "
    "for thrown parts, and the true value lies between them. A device acts only on the position "
    "in which a part lies. A part that falls back into the bowl arrives again in a random "
    "position. A vibrating track may turn parts flat by itself.",
    variants={shape: any_line(shape) for shape in (*SHAPES, MESH)},
    default_variant="box",
    conditions={
        shape: (
            Condition("no_pass", lambda *, line: line.total <= 0, OF_LINE, "passes",
                      says="True where no part passes."),
        )
        for shape in (*SHAPES, MESH)
    },
    defaults={"delta": 0.0, "devices": 0.0, **{f"turn_{place}": 21.0 for place in POSITIONS}},
    constraints=constraints(UNREAD),
    fit=fit_to_study,
)  # fmt: skip
