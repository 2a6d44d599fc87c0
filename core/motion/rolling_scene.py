"""The systems of round parts that roll along the track: ball, roller, disc on its edge (18.2)."""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics import round_parts
from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.mechanics.rolling import RollingContact
from vibrafeed.core.motion import feeding, limits, scales
from vibrafeed.core.motion.feeding import DEFAULTS
from vibrafeed.core.motion.groups import BLOCK_ON_FLOOR, Groups
from vibrafeed.core.motion.method import Method
from vibrafeed.core.motion.methods import METHODS, rolling
from vibrafeed.core.motion.result import Motion, has_status
from vibrafeed.core.motion.row_scene import drive_number_along
from vibrafeed.core.scenes.scene import (
    STANDARD_GRAVITY,
    STATIC_ABOVE_KINETIC,
    Condition,
    Constraint,
    Equation,
    Scene,
    arguments_of,
    fields,
)

SOURCE = "theory 18.2"
BALL, ROLLER, DISC = "sphere-on-plane", "roller-on-plane", "disc-on-edge"
ROLLING = (BALL, ROLLER, DISC)


# --- equations


def floor_contact(
    *, rolling_share: Array, rolling_factor: Array, friction_static: Array,
    friction_kinetic: Array, restitution: Array, rolling_resistance: Array, load_number: Array,
    gravity_number_along: Array, drive_number_along: Array, drive_number_normal: Array,
) -> RollingContact:  # fmt: skip
    """Return the dimensionless numbers of the contact of a round part with the floor.

    All arguments are arrays [1]: `rolling_factor` m r^2/I, `rolling_share` the share of a push that
    accelerates a rolling part, friction, restitution and rolling resistance coefficients,
    `load_number` gravity onto the floor, and gravity along, drive along and normal over g. There is
    no wall, whose drag is 0.
    """
    return RollingContact(
        share=rolling_share, factor=rolling_factor, static=friction_static,
        kinetic=friction_kinetic, restitution=restitution, resistance=rolling_resistance,
        drag=np.zeros(()), load=load_number, uphill=gravity_number_along,
        along=drive_number_along, normal=drive_number_normal,
    )  # fmt: skip


def wall_contact(
    *, rolling_share: Array, rolling_factor: Array, friction_static: Array,
    friction_kinetic: Array, rolling_resistance: Array, load_number: Array,
    gravity_number_along: Array, gravity_number_across: Array, wall_friction: Array,
    drive_number_along: Array, drive_number_normal: Array,
) -> RollingContact:  # fmt: skip
    """Return the dimensionless numbers of the contacts of a disc on its edge with floor and wall.

    All arguments are arrays [1]: `rolling_factor` m r^2/I, `rolling_share` the share of a push that
    accelerates a rolling part, frictions and rolling resistance, `load_number` gravity onto the
    floor, and gravity along and across, drive along and normal over g. The disc leans on the wall
    with gravity across, whose friction is its drag. It lands without rebound.
    """
    return RollingContact(
        share=rolling_share, factor=rolling_factor, static=friction_static,
        kinetic=friction_kinetic, restitution=np.zeros(()), resistance=rolling_resistance,
        drag=wall_friction * np.maximum(gravity_number_across, 0.0), load=load_number,
        uphill=gravity_number_along, along=drive_number_along, normal=drive_number_normal,
    )  # fmt: skip


def rolling_groups(*, rolling_contact: RollingContact) -> Groups:
    """Return the groups of the block that moves like the rolling part."""
    return rolling.block_groups(rolling_contact)


def slip_groups(*, rolling_contact: RollingContact) -> Groups:
    """Return the groups of the block that moves as the contact point of a round part slips."""
    return rolling.slip_groups(rolling_contact)


def slip_velocity(*, slip_motion: Motion, velocity_scale: Array) -> Array:
    """Return the mean slip velocity of the contact [m s-1].

    Rolling resistance is left out where the part turns to and fro.
    """
    return slip_motion.velocity * velocity_scale


def mean_acceleration(*, rolling_contact: RollingContact, gravity: Array) -> Array:
    """Return the mean acceleration along the track in the long run [m s-2].

    Of a part that runs down -kap/(1 + kap) (g sin(gamma) - c n - w), whatever the drive, friction
    and rebounds, while the slip of its contact stays bounded; -(g sin(gamma) - mu n - w) where the
    slip runs away, beyond g sin(gamma) = ((1 + kap) mu - kap c) n + w, with the load n and the
    wall's friction w per mass; else 0.
    """
    return gravity * rolling.mean_acceleration(rolling_contact)


def leaves_wall(*, gravity_number_across: Array) -> Mask:
    """True where nothing presses the disc onto the wall: the track leans the other way."""
    return gravity_number_across < 0


def rests(*, motion: Motion) -> Mask:
    """True where rolling resistance, or the wall, holds the part all the time."""
    return motion.only("stick")


RESULTS = (
    Equation("conveying_velocity", scales.conveying_velocity, SOURCE),
    Equation("conveying_velocity_error", scales.conveying_velocity_error, SOURCE),
    Equation("efficiency", scales.efficiency, "theory 13.10"),
    *fields(
        "motion",
        SOURCE,
        stick_fraction=("stick", "share of the period in which the part does not move [1]"),
        forward_fraction=("forward", "share of the period in which the part rolls forward [1]"),
        backward_fraction=("backward", "share of the period in which the part rolls backward [1]"),
        period_multiple=(
            "multiple",
            "after how many periods of the drive the motion repeats; 0 where it has none [1]",
        ),
        motion_status=("status", "how the motion ended, as a status"),
    ),
    *feeding.RESULTS,
)
ANY_RESULT = frozenset(one.gives for one in RESULTS) - {"occupancy"} | {"regime"}
CONDITIONS = (
    Condition(
        "unresolved", has_status("not_computed", "limit_reached", "no_solution"), ANY_RESULT, "roll"
    ),
    Condition("runaway", has_status("runaway"), ANY_RESULT),
    Condition("rolls_and_slips", has_status("rolls_and_slips"), ANY_RESULT),
    Condition("neutral", has_status("neutral"), ANY_RESULT),
    Condition("stick", rests, ANY_RESULT),
)
LEAVES_THE_WALL = Condition(
    "wall_lost", leaves_wall, ANY_RESULT | {"mean_acceleration"}, otherwise="contact"
)
VALIDITY = (
    "Motion along the track. Rolling resistance is a couple c r n against the turning, r the "
    "radius and n the load. A part without any is not conveyed, whatever the drive and the "
    "friction. Where the floor has not the friction to roll all the time, or the part hops, its "
    "mean velocity is not known: the regime is rolls_and_slips."
)


def rolling_scenes(
    scales_of_drive: tuple[Equation, ...], driven_within: Constraint
) -> dict[str, Scene]:
    """Return the scenes in which round parts roll along a track, by name: ball, roller and disc.

    `scales_of_drive` are the equations of the drive's scales, such as g/w, `driven_within` is the
    constraint on the drive's frequency.
    """
    planar = tuple(each for each in scales_of_drive if each.gives != "drive_number_along")
    planar = (
        *planar,
        Equation("drive_number_along", drive_number_along, SOURCE),
        *limits.equations("sine", ("along", "normal")),
        Equation("rolling_share", round_parts.rolling_share, "theory 18.1"),
        Equation("groups", rolling_groups, SOURCE),
        Equation("mean_acceleration", mean_acceleration, SOURCE),
    )
    on_floor = (
        *planar,
        Equation("rolling_contact", floor_contact, SOURCE),
    )
    at_wall = (
        *(each for each in planar if each.gives != "gravity_number_normal"),
        Equation("gravity_number_across", scales.gravity_number_across, "theory 13.1"),
        Equation("gravity_number_normal", scales.leaning_gravity_number_normal, "theory 13.1"),
        Equation("wall_friction", scales.wall_friction, "theory 13.1"),
        Equation("rolling_contact", wall_contact, SOURCE),
    )

    def scene(
        name: str, title: str, numbers: tuple[Equation, ...], kap: float, more: str = ""
    ) -> Scene:
        """Return the system of one round part.

        `numbers` are the equations of its dimensionless numbers, `kap` is m r^2/I of the full body,
        `more` is added to its range of validity.
        """
        shape = round_parts.ball_factor if name == BALL else round_parts.tube_factor
        own = (*numbers, Equation("rolling_factor", shape, "theory 18.1"))
        leaning = {"delta": 0.0} if name == DISC else {}
        return Scene(
            name=name,
            title=title,
            source=SOURCE,
            validity=VALIDITY + more,
            variants={
                method.name: (*own, *_equations_of_method(method, slips=name != DISC))
                for method in METHODS["rolling"].values()
            },
            default_variant="events",
            conditions=dict.fromkeys(
                METHODS["rolling"], (LEAVES_THE_WALL, *CONDITIONS) if name == DISC else CONDITIONS
            ),
            defaults={
                "gamma": 0.0, "gravity": STANDARD_GRAVITY, "hold_down_number": 0.0,
                "rolling_resistance": 0.0, "inner_diameter": 0.0, "rolling_factor": kap,
                "restitution": 0.0, **leaning, **DEFAULTS,
            },
            constraints=(
                STATIC_ABOVE_KINETIC, driven_within,
                *(each for method in METHODS["rolling"].values() for each in method.refuses),
            ),
            choice="method",
            variant_defaults={m.name: m.defaults for m in METHODS["rolling"].values()},
        )  # fmt: skip

    return {
        BALL: scene(BALL, "Motion in time of a ball that rolls on a plane", on_floor, 2.5),
        ROLLER: scene(
            ROLLER, "Motion in time of a roller or ring, its axis across the track", on_floor, 2.0
        ),
        DISC: scene(
            DISC, "Motion in time of a disc on its edge, its face against the wall", at_wall, 2.0,
            " The wall presses by the lean alone, through the centre, and rubs as the floor does "
            "unless the study gives its own friction.",
        ),
    }  # fmt: skip


def _equations_of_method(method: Method, *, slips: bool) -> tuple[Equation, ...]:
    """Return the equations for the motion of a round part by one method, and for its results.

    `slips` is True if the slip of the contact is a result, too; it is followed as the motion of a
    block.
    """
    block = METHODS["conveying"][method.name].follow(BLOCK_ON_FLOOR)
    inputs = arguments_of(block)
    needs = ("rolling_contact", "mean_acceleration", *inputs)
    equations = [Equation("motion", method.follow(BLOCK_ON_FLOOR), SOURCE, needs=needs), *RESULTS]
    if slips:
        needs = ("slip_groups", *(one for one in inputs if one != "groups"))
        equations += [
            Equation("slip_groups", slip_groups, SOURCE),
            Equation("slip_motion", rolling.of_slip(block), SOURCE, needs=needs),
            Equation("slip_velocity", slip_velocity, SOURCE),
        ]
    return tuple(equations)
