"""A row of equal parts in one lane: its flow, its bends, and the force on what holds it."""

from __future__ import annotations

from vibrafeed.core.mechanics import row, vibration, yawing
from vibrafeed.core.scenes.scene import STANDARD_GRAVITY, Condition, Equation, Scene

SOURCE = "theory 17.5"
LANE = (
    Equation("lane_pitch", row.lane_pitch, SOURCE),
    Equation("throughput_limit", row.throughput_limit, SOURCE),
    Equation("throughput", row.throughput, SOURCE),
    Equation("part_spacing", row.part_spacing, SOURCE),
    Equation("queue_velocity", row.queue_velocity, SOURCE),
    Equation("fill_time", row.fill_time, SOURCE),
    Equation("clear_time", row.clear_time, SOURCE),
    Equation("escapement_rate", row.escapement_rate, SOURCE),
)
BEND = (
    Equation("bend_pitch", row.bend_pitch, SOURCE),
    Equation("held_line_force", row.held_line_force, SOURCE),
    Equation("sliding_line_force", row.sliding_line_force, SOURCE),
)
WEIGHT = Equation("row_weight", row.row_weight, SOURCE)
FIXED_STOP = (
    Equation("vibration_acceleration", vibration.vibration_acceleration, "theory 0.2"),
    Equation("drive_normal", vibration.drive_normal, "(3.10)"),
    Equation("gravity_normal", yawing.level_gravity, "(4.17)"),
    Equation("throw_number", vibration.throw_number, "theory 13.2"),
    WEIGHT,
    Equation("stop_force", row.held_force, SOURCE),
)
STEPPED_STOP = (
    WEIGHT,
    Equation("two_level_hold", row.two_level_hold, SOURCE),
    Equation("stop_force", row.two_level_force, SOURCE),
    Equation("stop_contact_fraction", row.two_level_contact, SOURCE),
    Equation("stop_impact_share", row.two_level_impacts, SOURCE),
)
TRACK_STOP = (
    Equation("vibration_acceleration", vibration.vibration_acceleration, "theory 0.2"),
    WEIGHT,
    Equation("least_stop_force", row.least_held_force, SOURCE),
    Equation("locked_stop_force", row.locked_held_force, SOURCE),
)
STEPPED_TRACK_STOP = (
    WEIGHT,
    Equation("least_stop_force", row.least_two_level_force, SOURCE),
)
PLATOONS = (
    Equation("mean_platoons", row.mean_platoons, SOURCE),
    Equation("closing_time", row.closing_time, SOURCE),
    Equation("pair_force", row.pair_force, SOURCE),
)
OF_FLOW = frozenset(("throughput", "part_spacing", "queue_velocity"))
OF_STEPS = frozenset(("stop_force", "stop_contact_fraction", "stop_impact_share"))
OF_TRACK = frozenset(("least_stop_force", "locked_stop_force"))

SCENE = Scene(
    name="row-on-plane",
    title="Row of equal parts in one lane",
    source="",
    validity="Equal parts with smooth faces that move as one part does, and neither tip nor wedge. "
    "A stop at rest in space under a sine (fixed_stop) is on a level lane; its force is exact from "
    "a throw number of 1.705 on. On a stop of the track (track_stop) rigid parts press with "
    "least_stop_force or more; stiff elastic ones keep locked_stop_force.",
    variants={
        "lane": LANE,
        "bend": BEND,
        "fixed_stop": FIXED_STOP,
        "stepped_stop": STEPPED_STOP,
        "track_stop": TRACK_STOP,
        "stepped_track_stop": STEPPED_TRACK_STOP,
        "platoons": PLATOONS,
    },
    default_variant="lane",
    conditions={
        "lane": (Condition("crowded", row.is_crowded, OF_FLOW, otherwise="contact"),),
        "bend": (
            Condition(
                "invalid_geometry", row.is_too_long, frozenset(("bend_pitch",)), otherwise="contact"
            ),
        ),
        "fixed_stop": (
            Condition(
                "indeterminate_force",
                row.is_bound_only,
                frozenset(("stop_force",)),
                otherwise="contact",
            ),
        ),
        "stepped_stop": (
            Condition("indeterminate_force", row.is_not_carried, OF_STEPS, otherwise="contact"),
            Condition("indeterminate_force", row.strikes_too_late, OF_STEPS),
        ),
        "track_stop": (
            Condition("flight", row.leaves_floor, OF_TRACK, otherwise="contact"),
            Condition("indeterminate_force", row.slips_back, OF_TRACK),
        ),
        "stepped_track_stop": (
            Condition(
                "indeterminate_force",
                row.slips_back_in_steps,
                frozenset(("least_stop_force",)),
                otherwise="contact",
            ),
        ),
        "platoons": (
            Condition(
                "separating", row.never_closes, frozenset(("closing_time",)), otherwise="contact"
            ),
        ),
    },
    defaults={"part_gap": 0.0, "gravity": STANDARD_GRAVITY},
    variant_defaults={"track_stop": {"gamma": 0.0}},
    constraints=(),
)
