"""Parts on the floor of plane or track, at the drive's peak; sections 3.2, 3.3 of the source."""

from dataclasses import replace
from functools import partial

from vibrafeed.core.mechanics import floor, rolling, travel, wall
from vibrafeed.core.scenes.scene import (
    STANDARD_GRAVITY,
    STATIC_ABOVE_KINETIC,
    Condition,
    Constraint,
    Equation,
    Scene,
    field_of,
    fields,
    under_names,
)

# --- Equations of all scenes of a part on a plane: drive, gravity, and a floor without a wall.

DRIVE = (
    Equation("vibration_acceleration", floor.vibration_acceleration, "theory 0.2"),
    Equation("drive_along", floor.drive_along, "(3.8)"),
    Equation("drive_across", floor.drive_across, "(3.8)"),
    Equation("drive_normal", floor.drive_normal, "(3.8)"),
    Equation("gravity_along", floor.gravity_along, "(3.11)"),
    Equation("normal_acceleration", floor.normal_acceleration, "(3.9), (3.11)"),
    Equation("throw_number", floor.throw_number, "theory 13.2"),
    Equation("in_plane_drive_x", floor.in_plane_drive_x, "theory 3"),
)

LEVEL_GRAVITY = field_of(
    "gravity", (), "gravity_normal", "gravity onto a level floor, g [m s-2]", "(4.17)"
)
PLANE = (
    *DRIVE,
    Equation("gravity_normal", floor.gravity_normal, "(3.11)"),
    *fields(
        "drive_across",
        "theory 3",
        in_plane_drive_y=("drive less gravity along y on a floor without lean, D_y [m s-2]",),
    ),
    Equation("in_plane_drive", floor.in_plane_drive, "theory 3.2"),
    Equation("rotated_acceleration_x", floor.rotated_acceleration_x, "(3.10), (3.12)"),
    Equation("rotated_acceleration_y", floor.rotated_acceleration_y, "(3.10), (3.12)"),
    Equation("floor_force", floor.floor_force, "(3.9), (3.11)"),
)


def unchecked_load(source: str, variant: str = "all") -> tuple[Equation, ...]:
    """Return the equation of a normal force that may pull, as in the source."""
    says = "the normal force per mass, n0, whatever its sign, as in the source [m s-2]"
    return fields("normal_acceleration", source, variant, floor_acceleration=(says,))


PER_AXIS = (
    Equation("acceleration_x", floor.per_axis_acceleration_x, "(3.9), (3.11)", "thesis"),
    Equation("acceleration_y", floor.per_axis_acceleration_y, "(3.9), (3.11)", "thesis"),
    Equation("acceleration_z", floor.no_acceleration_z, "(3.9), (3.11)", "thesis"),
    *unchecked_load("(3.9), (3.11)", "thesis"),
)

UNILATERAL = (
    Equation("floor_acceleration", floor.supported_acceleration, "theory 3.2", "physical"),
    Equation("acceleration_z", floor.lift_off_acceleration, "theory 3.2", "physical"),
)

SHARED_FRICTION = (
    Equation("sliding_fraction", floor.sliding_fraction, "theory 3.2", "physical"),
    Equation("acceleration_x", floor.disc_acceleration_x, "theory 3.2", "physical"),
    under_names(
        "acceleration_y",
        floor.disc_acceleration_x,
        "theory 3.2",
        "the acceleration along y from rest, both axes sharing one friction disc [m s-2]",
        "physical",
        in_plane_drive_x="in_plane_drive_y",
    ),
)

PLANE_DEFAULTS = {"alpha": 0.0, "gamma": 0.0, "gravity": STANDARD_GRAVITY}

ROTATED = frozenset(("rotated_acceleration_x", "rotated_acceleration_y"))
ACCELERATIONS = ROTATED | {"acceleration_x", "acceleration_y", "sliding_fraction", "regime"}
FLOOR = frozenset(
    ("normal_acceleration", "throw_number", "floor_acceleration", "floor_force", "acceleration_z")
)


# --- A rectangular part on a horizontal or inclined plane; sections 3.2.2 and 3.2.3 of the source.

OFFSETS = frozenset(("pressure_offset_x", "pressure_offset_y"))


FLIGHT = Condition(
    "flight", floor.has_left_floor, FLOOR | ACCELERATIONS | OFFSETS, otherwise="contact"
)
STICK = Condition("stick", floor.is_stuck, ACCELERATIONS | OFFSETS, otherwise="slip")

RECTANGLE_SCENE = Scene(
    name="rectangle-on-plane",
    title="Rectangular part on a horizontal or inclined plane",
    source="3.2.2, 3.2.3",
    validity="The results are a snapshot at the peak of the drive, for a part that is at rest "
    "relative to the track and does not rotate. Closed forms describe the part only while the "
    "throw number is below 1.",
    variants={
        "thesis": (*PLANE, *PER_AXIS),
        "derived": (*PLANE, *PER_AXIS),
        "physical": (
            *PLANE,
            *UNILATERAL,
            *SHARED_FRICTION,
            Equation("pressure_offset_x", floor.pressure_offset_x, "theory 4.4", "physical"),
            under_names(
                "pressure_offset_y",
                floor.pressure_offset_x,
                "theory 4.4",
                "the offset along y of the floor's resultant that balances friction's moment [m]",
                "physical",
                height="height",
                in_plane_drive_x="in_plane_drive_y",
            ),
        ),
    },
    default_variant="physical",
    conditions={
        "thesis": (FLIGHT, STICK),
        "derived": (FLIGHT, STICK),
        "physical": (
            FLIGHT,
            Condition("tipping", floor.tips_x, frozenset(("pressure_offset_x",))),
            Condition("tipping", floor.tips_y, frozenset(("pressure_offset_y",))),
            STICK,
        ),
    },
    defaults={**PLANE_DEFAULTS, "yaw": 0.0},
    rounding_bound=8,
)


# --- A part on a plate that slopes in any direction, without a wall.

PLATE_SCENE = Scene(
    name="part-on-plate",
    title="Part on a plate without a wall",
    source="",
    validity="The results are a snapshot at the peak of the drive, for a part that is at rest "
    "relative to the plate. Closed forms describe the part only while the throw number is below "
    "1.",
    variants={
        "physical": (
            *DRIVE,
            Equation("gravity_normal", floor.leaning_gravity_normal, "(3.13)"),
            Equation("gravity_across", floor.gravity_across, "(3.13)"),
            under_names(
                "in_plane_drive_y",
                floor.in_plane_drive_x,
                "theory 3",
                "drive less gravity along y [m s-2]",
                drive_along="drive_across",
                gravity_along="gravity_across",
            ),
            Equation("in_plane_drive", floor.in_plane_drive, "theory 3.2"),
            Equation("floor_force", floor.floor_force, "(3.9), (3.11)"),
            *UNILATERAL,
            *SHARED_FRICTION,
        )
    },
    default_variant="physical",
    conditions={
        "physical": tuple(
            replace(one, outputs=one.outputs - OFFSETS - ROTATED) for one in (FLIGHT, STICK)
        )
    },
    defaults={**PLANE_DEFAULTS, "delta": 0.0},
)


# --- A cylinder that lies on a plane, axis along the track; sections 3.3.2 and 3.3.3 of the source.

MOTION = ACCELERATIONS - {"sliding_fraction"} | {"angular_acceleration"}

CONDITIONS = (
    Condition("flight", floor.has_left_floor, FLOOR | MOTION | {"roll_root"}, "contact"),
    Condition("stick", rolling.is_at_rest, MOTION),
    Condition("roll", rolling.is_rolling, MOTION | {"roll_root"}, otherwise="slip"),
)

CYLINDER_SCENE = Scene(
    name="cylinder-on-plane",
    title="Cylindrical part lying on a plane, its axis along the track",
    source="3.3.2, 3.3.3",
    validity="The results are a snapshot at the peak of the drive, for a part that is at rest "
    "relative to the track. Rolling resistance and drilling friction are neglected. Closed forms "
    "describe the part only while the throw number is below 1.",
    variants={
        "thesis": (
            *PLANE,
            *PER_AXIS,
            Equation(
                "angular_acceleration", rolling.printed_angular_acceleration, "(3.36)", "thesis"
            ),
        ),
        "derived": (
            *PLANE,
            *PER_AXIS,
            Equation(
                "angular_acceleration", rolling.rolling_angular_acceleration, "(3.36)", "derived"
            ),
        ),
        "physical": (
            *PLANE,
            *UNILATERAL,
            Equation("roll_root", rolling.roll_root, "theory 7.3", "physical"),
            Equation("acceleration_x", rolling.slipping_acceleration_x, "theory 7.3", "physical"),
            Equation("acceleration_y", rolling.slipping_acceleration_y, "theory 7.3", "physical"),
            Equation(
                "angular_acceleration",
                rolling.slipping_angular_acceleration,
                "theory 7.3",
                "physical",
            ),
        ),
    },
    default_variant="physical",
    conditions={"thesis": CONDITIONS, "derived": CONDITIONS, "physical": CONDITIONS},
    defaults={**PLANE_DEFAULTS, "yaw": 0.0},
    rounding_bound=8,
)


# --- A rectangular part on the narrow track, floor and outer wall; section 3.2.4 of the source.

COMMON = (
    *DRIVE,
    Equation("gravity_normal", floor.leaning_gravity_normal, "(3.13)"),
    Equation("gravity_across", floor.gravity_across, "(3.13)"),
    Equation("centripetal_acceleration", wall.centripetal_acceleration, "(3.14)"),
    Equation("transport_velocity", travel.transport_velocity, "(3.18)"),
    Equation("terminal_velocity", travel.terminal_velocity, "theory 4.5"),
    Equation("travel_time", travel.travel_time, "theory 4.5"),
    Equation("mean_velocity", travel.mean_velocity, "theory 4.5"),
    Equation("velocity_at_time", travel.velocity_at_time, "theory 4.5"),
    Equation("distance_at_time", travel.distance_at_time, "theory 4.5"),
    Equation("stopping_distance", travel.stopping_distance, "theory 4.5"),
    Equation("stopping_time", travel.stopping_time, "theory 4.5"),
    Equation("velocity_bound", floor.velocity_bound, "theory 11.1"),
    Equation("suggested_distance", travel.suggested_distance, "theory 11.1"),
    Equation("distance_bound", travel.distance_bound, "theory 11.1"),
    Equation("chord_cosine", wall.chord_cosine, "(3.13)"),
    Equation("floor_force", floor.floor_force, "(3.15b)"),
    Equation("wall_force", wall.wall_force, "(3.16)"),
    Equation("wall_force_front", wall.wall_force_front, "(3.16)"),
    Equation("wall_force_rear", wall.wall_force_rear, "(3.16)"),
)
TOP_EDGE = (
    Equation("acceleration_x", wall.curved_acceleration_x, "(3.17)"),
    *fields(
        "centripetal_acceleration",
        "(3.14)",
        acceleration_y=("the acceleration v^2/R of a part that follows the wall [m s-2]",),
    ),
    Equation("acceleration_z", floor.no_acceleration_z, "(3.14)"),
    Equation("wall_acceleration", wall.top_edge_wall_acceleration, "(3.16)"),
    Equation("floor_acceleration", wall.top_edge_floor_acceleration, "(3.15b)"),
    Equation("z_residual", wall.z_residual, "(3.14)"),
)
CORRECTED = (
    Equation("starting_acceleration", wall.derived_starting_acceleration, "(3.17)", "derived"),
    Equation("wall_balance", wall.derived_wall_balance, "(3.16)"),
    Equation("wall_speed", wall.derived_wall_speed, "theory 4.3"),
)

WALL_FORCES = frozenset(("wall_acceleration", "wall_force", "wall_force_rear", "wall_force_front"))
FLOOR_FORCES = frozenset(("floor_acceleration", "floor_force"))
TRAVEL = frozenset(
    (
        "transport_velocity",
        "terminal_velocity",
        "travel_time",
        "mean_velocity",
        "velocity_at_time",
        "distance_at_time",
        "stopping_distance",
        "stopping_time",
        "distance_bound",
        "starting_acceleration",
    )
)
ACCELERATION = frozenset(("acceleration_x", "regime"))
BOTH = WALL_FORCES | FLOOR_FORCES | TRAVEL | ACCELERATION | {"z_residual", "pressure_offset_x"}
WALL = BOTH | {"wall_balance", "acceleration_y"}

CORNERS_FIT = Condition(
    "invalid_geometry",
    lambda *, width, length, radius, friction_kinetic: (
        (length <= friction_kinetic * width) | (length >= 2 * radius)
    ),
    frozenset(("wall_force_rear", "wall_force_front")),
    otherwise="contact",
    says="True where not both corners touch the wall: h <= mu_k a, or h >= 2R.",
)
FITS = Condition(
    "invalid_geometry", wall.is_too_long, frozenset(("chord_cosine",)), otherwise="contact"
)
LEFT_FLOOR = (
    Condition(
        "flight_and_wall_lost",
        lambda *, normal_acceleration, wall_balance: (
            (normal_acceleration <= 0) & (wall_balance < 0)
        ),
        BOTH,
        says="True where the part has left floor and wall.",
    ),
    Condition(
        "flight",
        floor.has_left_floor,
        BOTH | {"normal_acceleration", "throw_number", "acceleration_z"},
        otherwise="contact",
    ),
)
# After flight, but before the wall: a speed of 0 is explained before its validity is doubted.
REST = (
    Condition("no_motion", travel.does_not_start, TRAVEL, otherwise="slip"),
    Condition(
        "stopped",
        travel.stops_before_distance,
        frozenset(("transport_velocity", "travel_time", "mean_velocity")),
    ),
    Condition(
        "stopped",
        lambda *, stopping_time, time: stopping_time <= time,
        frozenset(("velocity_at_time", "distance_at_time")),
        says="True where the part stops before, or at, the time.",
    ),
)
LEFT_WALL = Condition(
    "wall_lost",
    lambda *, wall_balance: wall_balance < 0,
    WALL,
    otherwise="contact",
    says="True where the part has left the wall: B < 0.",
)
BEYOND = (
    Condition(
        "unbounded",
        lambda *, starting_acceleration, friction_kinetic: (
            (starting_acceleration > 0) & (friction_kinetic == 0)
        ),
        frozenset(("terminal_velocity",)),
        says="True where no terminal velocity exists: drive without friction.",
    ),
    *(
        Condition(
            "unbounded", partial(travel.is_endless, name), frozenset((name, *others)),
            needs=(name,), says=f"True where {says}.",
        )
        for name, others, says in (
            ("stopping_distance", ("stopping_time",), "the part never stops"),
            ("travel_time", (), "the part takes longer to cover the distance than a float holds"),
            ("distance_bound", (), "(3.18) never reaches the largest speed of the track"),
        )
    ),
    *(
        Condition(
            "faster_than_track", partial(travel.exceeds_track, name), frozenset((name,)),
            needs=(name, "velocity_bound"),
            says=f"True where {symbol} exceeds the largest speed of the track, which friction "
            "cannot do.",
        )
        for name, symbol in (
            ("transport_velocity", "v(x)"), ("mean_velocity", "x/t(x)"),
            ("velocity_at_time", "v(t)"), ("terminal_velocity", "v_inf"),
        )
    ),
)  # fmt: skip
PRINTED_CONDITIONS = (
    Condition(
        "invalid_geometry",
        lambda *, width, height, friction_static: 2 * height <= friction_static * width,
        WALL_FORCES | FLOOR_FORCES | {"z_residual"},
        says="True where (3.16) does not hold: 2b <= mu_s a.",
    ),
    CORNERS_FIT,
    FITS,
    *LEFT_FLOOR,
    *REST,
    Condition("no_motion", travel.does_not_start, ACCELERATION, otherwise="slip"),
    LEFT_WALL,
    Condition(
        "outside_cone",
        lambda *, wall_balance: wall_balance > 0,
        WALL_FORCES | FLOOR_FORCES | {"z_residual"},
        says="True where the part presses on the wall, so that the forces of (3.15) leave the "
        "cone.",
    ),
    *BEYOND,
)

TRACK_SCENE = Scene(
    name="rectangle-on-track",
    title="Rectangular part on the narrow track, floor and wall",
    source="3.2.4",
    validity="Accelerations and forces are a snapshot at the peak of the drive. Velocities after "
    "a distance or time assume that the drive stays at its peak. They are kinematic estimates, "
    "not averages over a period, and the physical variant computes them with the derived K. The "
    "radius of the part's path is taken as R. In the variants thesis and derived, the wall acts "
    "at the part's top edge; their forces leave z_residual in the vertical balance and lie "
    "outside the friction cone.",
    variants={
        "thesis": (
            *COMMON,
            *TOP_EDGE,
            Equation(
                "starting_acceleration", wall.printed_starting_acceleration, "(3.17)", "thesis"
            ),
            Equation("wall_balance", wall.printed_wall_balance, "(3.16)", "thesis"),
            Equation("wall_speed", wall.printed_wall_speed, "(3.16)", "thesis"),
        ),
        "derived": (*COMMON, *TOP_EDGE, *CORRECTED),
        "physical": (
            *COMMON,
            *CORRECTED,
            Equation("acceleration_x", wall.supported_acceleration_x, "theory 4.4", "physical"),
            Equation("acceleration_y", wall.off_wall_acceleration_y, "theory 4.4", "physical"),
            Equation("acceleration_z", floor.lift_off_acceleration, "theory 4.4", "physical"),
            Equation("wall_acceleration", wall.pushing_wall_acceleration, "theory 4.4", "physical"),
            Equation("floor_acceleration", floor.supported_acceleration, "theory 4.4", "physical"),
            Equation("pressure_offset_x", wall.held_pressure_offset_x, "theory 4.4", "physical"),
        ),
    },
    default_variant="physical",
    conditions={
        "thesis": PRINTED_CONDITIONS,
        "derived": PRINTED_CONDITIONS,
        "physical": (
            CORNERS_FIT,
            FITS,
            *LEFT_FLOOR,
            *REST,
            LEFT_WALL,
            Condition("tipping", floor.tips_x, frozenset(("pressure_offset_x",))),
            *BEYOND,
            Condition("stick", wall.is_held, ACCELERATION, otherwise="slip"),
        ),
    },
    defaults={
        "alpha": 0.0,
        "gamma": 0.0,
        "delta": 0.0,
        "gravity": STANDARD_GRAVITY,
        "speed": 0.0,
        "centripetal_acceleration": 0.0,
    },
    constraints=(
        STATIC_ABOVE_KINETIC,
        Constraint(
            ("length", "radius"),
            lambda least_length, _, __, largest_radius: least_length <= 2 * largest_radius,
            "the part is longer than the bowl is wide (length > 2 radius), so it cannot touch the "
            "wall with both corners",
            "Give a length of at most twice the radius",
        ),
    ),
    rounding_bound=8,
)
