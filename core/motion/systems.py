"""The systems that can be simulated: a scene's coordinates and contacts, by method.

The systems are scenes of their own: the same parameters, other equations. What a closed-form scene
calls a variant is a method here: every method of `METHODS` that follows the contacts of a system is
one of its variants. Nothing that computes is loaded before it is called.
"""

import inspect
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion import (
    drives,
    events,
    feeding,
    plate,
    reference,
    rolling_scene,
    row_scene,
    rows,
    scales,
    tumbling_scene,
)
from vibrafeed.core.motion.method import (
    SOLID_CYLINDER,
    Contacts,
    Groups,
    Method,
    of_quantities,
    where,
    with_status,
)
from vibrafeed.core.motion.reference.burst import burst_by_reference
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.scenes.scene import (
    STANDARD_GRAVITY,
    STATIC_ABOVE_KINETIC,
    Condition,
    Constraint,
    Equation,
    Scene,
    fields,
)
from vibrafeed.core.scenes.soft_contact import impact_damping

RESULTS = (
    scales.CONVEYING_VELOCITY,
    scales.CONVEYING_VELOCITY_SPREAD,
    scales.CONVEYING_VELOCITY_ERROR,
    Equation("efficiency", scales.efficiency, "theory 13.10"),
    Equation("share_of_fastest", drives.share_of_fastest, "docs/theory/best-drive.md"),
    *fields(
        "motion",
        "theory 13.2",
        stick_fraction=("stick", "share of the period in which friction holds the part [1]"),
        forward_fraction=("forward", "share of the period in which the part slides forward [1]"),
        backward_fraction=(
            "backward",
            "share of the period in which the part slides backward [1]",
        ),
        flight_fraction=("flight", "share of the period in which the part is off the floor [1]"),
    ),
    *fields(
        "motion",
        "theory 13.4",
        impacts_per_period=("impacts", "the impacts on the floor per period of the drive [1]"),
    ),
    *fields(
        "motion",
        "theory 13.8",
        period_multiple=(
            "multiple",
            "after how many periods of the drive the motion repeats; 0 where it does not [1]",
        ),
    ),
    scales.product(
        "landing_speed", "motion.landing_speed", "velocity_scale", source="theory 13.4",
        says="the largest speed normal to the floor before an impact [m s-1]",
    ),
    scales.product(
        "hop_height", "motion.hop_height", "length_scale", source="theory 13.2",
        says="the largest distance from the floor [m]",
    ),
    *fields(
        "motion",
        "theory 13.8",
        motion_status=("status", "how the motion ended, as a status"),
    ),
    *feeding.RESULTS,
)  # fmt: skip
ACROSS = scales.product(
    "velocity_across", "motion.across", "velocity_scale", source="theory 13.8",
    says="the mean velocity across the track, towards +y, over whole cycles [m s-1]",
)  # fmt: skip
"""Not of a part that rolls across: it keeps the speed at which it happens to."""
ANY_RESULT = frozenset(
    equation.gives
    for equation in (*RESULTS, ACROSS, *scales.ENERGY_RESULTS)
    if not QUANTITIES[equation.gives].parameter
) | {"regime"}

CONDITIONS = (
    with_status("unresolved", ("not_computed", "limit_reached", "no_solution", "no_drive",),
        ANY_RESULT,
        otherwise="slip",
    ),
    with_status("runaway", ("runaway",), ANY_RESULT),
    where(
        "unbounded", "the part moves and the drive along the track is 0, or next to nothing",
        lambda *, efficiency: np.isinf(efficiency), ("efficiency",),
    ),
    with_status("aperiodic", ("aperiodic", "sensitive",), ANY_RESULT),
    where(
        "period_doubled", "the motion repeats after two periods of the drive or more",
        lambda *, motion: motion.multiple > 1, ANY_RESULT,
    ),
    where(
        "hop_after_hop", "the part is in the air all the time but for impacts",
        lambda *, motion: motion.only("flight"), ANY_RESULT,
    ),
    where(
        "hopping", "the part is in the air for a part of the period",
        lambda *, motion: motion.flight > 0, ANY_RESULT,
    ),
    where(
        "stick", "friction holds the part all the time",
        lambda *, motion: motion.only("stick"), ANY_RESULT,
    ),
    where(
        "stick_slip", "friction holds the part for a part of the period",
        lambda *, motion: motion.stick > 0, ANY_RESULT,
    ),
)  # fmt: skip
LEAVES_THE_WALL = where(
    "wall_lost", "the part moves away from the wall in every cycle, and never comes back",
    lambda *, motion, drive_number: motion.across > feeding.RESOLVED * np.asarray(drive_number),
    ANY_RESULT,
)  # fmt: skip
"""Condition of a track: the part leaves it sideways; the results hold on an endless floor."""

SPATIAL_SCALES = (
    *scales.PLANAR_SCALES,
    Equation("drive_number_across", scales.drive_number_across, "theory 13.1"),
    *drives.limits("sine"),
    Equation("fastest_velocity", drives.fastest_velocity, "docs/theory/best-drive.md"),
)
LEANING_SCALES = (
    *(e for e in SPATIAL_SCALES if e.gives != "gravity_number_normal"),
    Equation("gravity_number_across", scales.gravity_number_across, "theory 13.1"),
    Equation("gravity_number_normal", scales.leaning_gravity_number_normal, "theory 13.1"),
)
TRACK_SCALES = (
    *LEANING_SCALES,
    Equation("curvature_number", scales.curvature_number, "theory 13.10"),
    scales.WALL_FRICTION,
    scales.product(
        "wall_restitution", "restitution", source="theory 13.1",
        says="the floor's restitution, for a wall of the same material [1]",
    ),
)  # fmt: skip

_ON_FLOOR = (
    "drive_number_along", "drive_number_across", "drive_number_normal", "gravity_number_along",
    "load_number", "friction_static", "friction_kinetic", "restitution",
)  # fmt: skip
_ON_TRACK = (
    "drive_number_along", "drive_number_across", "drive_number_normal", "gravity_number_along",
    "gravity_number_across", "load_number", "curvature_number", "friction_static",
    "friction_kinetic", "wall_friction", "restitution", "wall_restitution",
)  # fmt: skip
GROUPS_ON_FLOOR = Equation(
    "groups", of_quantities, "theory 13.1", needs=_ON_FLOOR,
    says="Return the dimensionless groups of a part that moves in space on a floor without wall.",
)  # fmt: skip
ON_FLOOR = (*SPATIAL_SCALES, GROUPS_ON_FLOOR)
ON_TRACK = (
    *TRACK_SCALES,
    Equation(
        "groups", of_quantities, "theory 13.1", needs=_ON_TRACK,
        says="Return the dimensionless groups of a part on floor and wall, as one record for the "
        "kernels.",
    ),
)  # fmt: skip

DEFAULTS = {
    "alpha": 0.0,
    "gamma": 0.0,
    "gravity": STANDARD_GRAVITY,
    "hold_down_number": 0.0,
    "restitution": 0.0,
    **feeding.DEFAULTS,
}
VALIDITY = (
    "The part is a point with contact conditions, so that it does not tip. It starts at rest on "
    "the floor. Mean values are those of the motion that it finally reaches."
)


METHODS: dict[str, dict[str, Method]] = {
    "conveying": {"events": events.EVENTS, "reference": reference.REFERENCE},
    "tumbling": {"events": tumbling_scene.EVENTS},
    "plate": plate.METHODS,
    "row": {"events": rows.EVENTS},
    "rolling": rolling_scene.METHODS,
}
"""The methods by what they follow: a conveyed part, one on a plate, one that tumbles, a row, a
round part."""


def _conveying(
    name: str,
    title: str,
    *,
    in_space: tuple[Equation, ...],
    defaults: Mapping[str, float] = MappingProxyType({}),
    more_validity: str = "",
) -> Scene:
    # A scene of one part that is conveyed, with a variant for each method that can follow its
    # contacts; `in_space` are the equations up to its groups.
    contacts = CONTACTS[name]
    methods = [item for item in METHODS["conveying"].values() if item.follows(contacts)]

    def equation(gives: str, function: Callable[..., Any], source: str) -> Equation:
        says = inspect.getdoc(function) or ""
        return Equation(gives, partial(function, contacts=contacts), source, says=says)

    def equations(method: Method) -> tuple[Equation, ...]:
        conveying = [equation("motion", method.follow, method.source), *RESULTS]
        if not contacts.rolling:
            conveying.append(ACROSS)
        if method.energy is not None:
            energy = equation("energy", method.energy, scales.ENERGY_SOURCE)
            conveying += [energy, *scales.ENERGY_RESULTS]
        conveying.append(equation("burst", burst_by_reference, "theory 13.9"))
        return (*in_space, *conveying, *scales.BURST_RESULTS)

    def conditions(method: Method) -> tuple[Condition, ...]:
        track_conditions = [LEAVES_THE_WALL] if contacts.wall else []
        if method.energy is not None:
            track_conditions.append(scales.WORK_UNBOUNDED)
        # They give way to what has no answer, as that of the efficiency does.
        index = [item.regime for item in CONDITIONS].index("unbounded")
        ordered = (*CONDITIONS[:index], *track_conditions, *CONDITIONS[index:])
        if not contacts.rolling:
            return ordered
        return tuple(replace(item, outputs=item.outputs - {ACROSS.gives}) for item in ordered)

    return Scene(
        name=name,
        title=title,
        source="theory 13",
        validity=VALIDITY + more_validity,
        variants={method.name: equations(method) for method in methods},
        default_variant="events",
        conditions={method.name: conditions(method) for method in methods},
        defaults={**DEFAULTS, **defaults},
        constraints=(
            STATIC_ABOVE_KINETIC,
            scales.DRIVEN,
            scales.WHOLE_PERIODS,
            *(refusal for method in methods for refusal in method.refuses),
        ),
        choice="method",
        variant_defaults={method.name: method.defaults for method in methods},
    )


# --- a part on a plate

_ON_PLATE = (*_ON_FLOOR, "gravity_number_across")
_OF_PLATE = (
    "stick_fraction", "flight_fraction", "impacts_per_period", "period_multiple", "landing_speed",
    "hop_height", "motion_status",
)  # fmt: skip
_POWERS = tuple(e for e in scales.ENERGY_RESULTS if e.gives.endswith("_power"))


def _on_plate() -> Scene:
    # The scene of a part on a plate: as conveying, without outputs that take one direction of
    # travel.
    results = (*plate.RESULTS, *(item for item in RESULTS if item.gives in _OF_PLATE))
    any_result = frozenset(item.gives for item in (*results, *_POWERS)) | {"regime"}
    conditions = tuple(
        replace(item, outputs=any_result) for item in CONDITIONS if item.regime != "unbounded"
    )

    def equations(method: Method) -> tuple[Equation, ...]:
        functions = {"motion": method.follow} | ({"energy": method.energy} if method.energy else {})
        return (
            *(item for item in LEANING_SCALES if item.gives != "fastest_velocity"),
            replace(GROUPS_ON_FLOOR, needs=_ON_PLATE),
            *(
                Equation(gives, partial(function, contacts=CONTACTS[plate.PLATE]), method.source,
                         says=inspect.getdoc(function) or "")
                for gives, function in functions.items()
            ),
            *results,
            *(_POWERS if method.energy else ()),
        )  # fmt: skip

    return Scene(
        name=plate.PLATE,
        title="Motion in time of a part on a plate without a wall",
        source="theory 13",
        validity=VALIDITY + " The plate has no edge. Its rotations are small. The displacement of "
        "the plate is that at the position given for the part, also while the part travels.",
        variants={name: equations(method) for name, method in plate.METHODS.items()},
        default_variant="events",
        conditions=dict.fromkeys(plate.METHODS, conditions),
        defaults={**DEFAULTS, "delta": 0.0, "target_direction": 0.0},
        constraints=(STATIC_ABOVE_KINETIC, scales.DRIVEN, *reference.REFERENCE.refuses),
        choice="method",
        variant_defaults={name: method.defaults for name, method in plate.METHODS.items()},
    )


# --- restitution that falls with the speed of impact (theory 18.3)


FALLING = "restitution_speed"
"""The parameter that asks for the law: the speed at which `restitution` was measured."""


def with_falling_restitution(system: Scene, parameters: Collection[str]) -> Scene:
    """Return a system whose restitution falls with the speed of impact, given that at one speed.

    Parameters that the law does not allow are refused.
    """
    law = Equation("impact_damping", impact_damping, "theory 18.3")

    def with_law(equation: Equation) -> Equation:
        if equation.gives != "groups":
            return equation
        needs, says = ("impact_damping", "velocity_scale", *equation.inputs), equation.summary
        return replace(equation, function=_falling_groups, says=says, needs=needs)

    message = "restitution that falls with speed is known for motion in the plane of the track"
    refusals = [
        Constraint(
            (FALLING, name),
            lambda _, __, least, largest: least == largest == 0.0,
            message,
            f"Leave restitution_speed out, or set {name} to 0",
        )
        for name in ("alpha", "delta")
    ]
    refusals += [
        Constraint((FALLING, name), lambda *_: False, message, f"Leave it or {name} out")
        for name in parameters
        if name == "radius" or "_across_" in name
    ]
    return replace(
        system,
        variants={
            name: (law, *map(with_law, equations)) for name, equations in system.variants.items()
        },
        defaults={name: value for name, value in system.defaults.items() if name != "restitution"},
        constraints=(*system.constraints, *refusals),
    )


def _falling_groups(*, impact_damping: Array, velocity_scale: Array, **numbers: Array) -> Groups:
    damping = impact_damping * velocity_scale
    endless = np.isinf(damping)
    return of_quantities(**numbers)._replace(
        restitution=np.where(endless, 0.0, 1.0), impact_damping=np.where(endless, 0.0, damping)
    )


CONTACTS: dict[str, Contacts] = {
    "rectangle-on-plane": Contacts(),
    "cylinder-on-plane": Contacts(rolling=SOLID_CYLINDER),
    "rectangle-on-track": Contacts(wall=True),
    plate.PLATE: Contacts(),
}
"""What the parts that are conveyed can touch, by the name of their scene."""

SYSTEMS: dict[str, Scene] = {
    "rectangle-on-plane": _conveying(
        "rectangle-on-plane",
        "Motion in time of a rectangular part on a plane",
        in_space=ON_FLOOR,
    ),
    "cylinder-on-plane": _conveying(
        "cylinder-on-plane",
        "Motion in time of a cylinder on a plane, its axis along the track",
        in_space=ON_FLOOR,
    ),
    "rectangle-on-track": _conveying(
        "rectangle-on-track",
        "Motion in time of a rectangular part on the track, with floor and wall",
        in_space=ON_TRACK,
        defaults={"delta": 0.0, "curvature_number": 0.0},
        more_validity=" By default the wall has the kinetic friction and the restitution of the "
        "floor; its static friction equals its kinetic friction. The track is straight unless the "
        "study gives its radius.",
    ),
    plate.PLATE: _on_plate(),
    **tumbling_scene.SCENES,
    row_scene.ROW: row_scene.row_of(()),
    **rolling_scene.SCENES,
}
"""Every system that can be simulated, by the name of its scene."""


def methods_of(scene: str) -> Mapping[str, Method]:
    """Return the simulation methods of the kind of system that a scene is, by name.

    `scene` is the name of the scene: a row of parts, rolling, conveying, or tumbling.
    """
    if scene == plate.PLATE:
        return METHODS["plate"]
    kind = "row" if scene == row_scene.ROW else "conveying" if scene in CONTACTS else "tumbling"
    return METHODS["rolling" if scene in rolling_scene.SCENES else kind]
