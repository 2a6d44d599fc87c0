"""Names that editors offer and type checkers know; nothing loads them to run.

Written by `python -m benchmarks.keywords` from scenes and quantities.
"""

from __future__ import annotations

from typing import Literal, TypeAlias, TypedDict

from vibrafeed._values import Values

SweptScene: TypeAlias = (
    Literal[
        "rectangle-isolated",
        "rectangle-on-plane",
        "rectangle-on-track",
        "rectangle-pair-impact",
        "cylinder-isolated",
        "cylinder-on-plane",
        "cylinder-pair-impact",
        "cylinder-rolling",
        "sphere-on-plane",
        "roller-on-plane",
        "disc-on-edge",
        "cone-on-plane",
        "soft-contact",
        "linear-drive-unit",
        "bowl-drive-unit",
        "resting-part",
        "orienting-line",
        "row-on-plane",
    ]
    | str
)
SweptOutput: TypeAlias = (
    Literal[
        "vibration_acceleration",
        "drive_along",
        "drive_across",
        "drive_normal",
        "gravity_along",
        "gravity_across",
        "gravity_normal",
        "throw_number",
        "normal_acceleration",
        "floor_acceleration",
        "centripetal_acceleration",
        "in_plane_drive_x",
        "in_plane_drive_y",
        "in_plane_drive",
        "sliding_fraction",
        "roll_root",
        "acceleration_x",
        "acceleration_y",
        "acceleration_z",
        "rotated_acceleration_x",
        "rotated_acceleration_y",
        "angular_acceleration",
        "starting_acceleration",
        "transport_velocity",
        "terminal_velocity",
        "travel_time",
        "mean_velocity",
        "velocity_at_time",
        "distance_at_time",
        "stopping_distance",
        "stopping_time",
        "velocity_bound",
        "suggested_distance",
        "distance_bound",
        "floor_force",
        "wall_balance",
        "wall_acceleration",
        "wall_force",
        "wall_force_rear",
        "wall_force_front",
        "chord_cosine",
        "wall_speed",
        "z_residual",
        "pressure_offset_x",
        "pressure_offset_y",
        "regime",
        "rolling_drive",
        "axial_drive",
        "axial_friction_acceleration",
        "rolling_friction",
        "axial_friction",
        "spin_acceleration",
        "yaw_acceleration",
        "printed_yaw_rate",
        "pressure_offset_axial",
        "required_friction",
        "cone_margin",
        "floor_pitch",
        "floor_axis_normal",
        "floor_axis_rolling",
        "floor_axis_axial",
        "force_pitch",
        "force_axis_normal",
        "force_axis_rolling",
        "force_axis_axial",
        "corner_angle",
        "diagonal_angle",
        "half_diagonal",
        "inertia_ratio",
        "touching_height",
        "pivot_velocity_along",
        "pivot_velocity_upward",
        "gap_normal",
        "gap_tangential",
        "gap_normal_rate",
        "gap_tangential_rate",
        "gap_normal_acceleration",
        "gap_tangential_acceleration",
        "free_normal_acceleration",
        "free_tangential_acceleration",
        "normal_response_right",
        "normal_response_left",
        "normal_response",
        "holding_normal_acceleration",
        "holding_tangential_acceleration",
        "slip_direction",
        "friction_force",
        "acceleration_along",
        "acceleration_upward",
        "pitch_acceleration",
        "inverse_limiting_friction",
        "limiting_friction_right",
        "limiting_friction_left",
        "least_limiting_friction",
        "least_limiting_pitch",
        "impact_impulse_normal",
        "impact_impulse_tangential",
        "inertia_1",
        "velocity_x_1_after",
        "velocity_y_1_after",
        "velocity_z_1_after",
        "spin_x_1_after",
        "spin_y_1_after",
        "spin_z_1_after",
        "spin_1_after",
        "inertia_2",
        "velocity_x_2_after",
        "velocity_y_2_after",
        "velocity_z_2_after",
        "spin_x_2_after",
        "spin_y_2_after",
        "spin_z_2_after",
        "spin_2_after",
        "gap",
        "face_body",
        "contact_corner",
        "contact_x",
        "contact_y",
        "normal_x",
        "normal_y",
        "contact_form",
        "contact_z",
        "normal_z",
        "sliding_before",
        "sliding_after",
        "impulse_friction",
        "impulse_x",
        "impulse_y",
        "impulse_z",
        "momentum_residual_z",
        "angular_momentum_residual_x",
        "angular_momentum_residual_y",
        "angular_momentum_residual_z",
        "delassus_normal",
        "delassus_coupling",
        "delassus_tangential",
        "approach_normal",
        "approach_tangential",
        "separation_normal",
        "separation_tangential",
        "impulse_normal",
        "impulse_tangential",
        "energy_before",
        "energy_lost",
        "momentum_residual_x",
        "momentum_residual_y",
        "angular_momentum_residual",
        "circular_frequency",
        "generalised_mass",
        "loaded_mass",
        "loaded_inertia",
        "bowl_mass",
        "damping",
        "natural_frequency",
        "foot_frequency",
        "stroke",
        "phase",
        "amplification",
        "second_harmonic",
        "turning_mass",
        "trough_turn",
        "track_amplitude",
        "vibration_angle",
        "bowl_turn",
        "bowl_lift",
        "leaf_frequency",
        "leaf_mass",
        "spring_stress",
        "stress_margin",
        "air_gap_margin",
        "foot_force",
        "drive_unit_power",
        "mass_height",
        "gyration",
        "let_down_share_flat",
        "thrown_share_flat",
        "counted_share_flat",
        "let_down_share_on_side",
        "thrown_share_on_side",
        "counted_share_on_side",
        "let_down_share_on_end",
        "thrown_share_on_end",
        "counted_share_on_end",
        "let_down_share_upright",
        "thrown_share_upright",
        "counted_share_upright",
        "let_down_share_inverted",
        "thrown_share_inverted",
        "counted_share_inverted",
        "side_foot",
        "long_side_share",
        "standing_base",
        "standing_centre",
        "edge_distance",
        "topple_slope",
        "rocking_friction",
        "rocking_rate",
        "topple_speed",
        "pulse_angle",
        "topple_acceleration",
        "push_over_load",
        "rocking_margin",
        "topple_margin",
        "drop_count",
        "yield",
        "passing_share_flat",
        "leaving_share_flat",
        "passing_share_on_side",
        "leaving_share_on_side",
        "passing_share_on_end",
        "leaving_share_on_end",
        "passing_share_upright",
        "leaving_share_upright",
        "passing_share_inverted",
        "leaving_share_inverted",
        "leaving_wanted",
        "purity",
        "laps",
        "laps_variance",
        "laps_99",
        "time_per_part",
        "line_feed_rate",
        "oriented_feed_rate",
        "return_rate",
        "yield_deviation",
        "yield_lower",
        "yield_upper",
        "laps_lower",
        "laps_upper",
        "line_feed_rate_lower",
        "line_feed_rate_upper",
        "purity_lower",
        "purity_upper",
        "oriented_feed_rate_lower",
        "oriented_feed_rate_upper",
        "return_rate_lower",
        "return_rate_upper",
        "lane_pitch",
        "throughput_limit",
        "throughput",
        "part_spacing",
        "queue_velocity",
        "fill_time",
        "clear_time",
        "escapement_rate",
        "bend_pitch",
        "held_line_force",
        "sliding_line_force",
        "row_weight",
        "stop_force",
        "least_stop_force",
        "locked_stop_force",
        "mean_platoons",
        "closing_time",
        "pair_force",
        "stop_contact_fraction",
        "stop_impact_share",
        "rolling_share",
        "moved_fraction",
        "push_across_axis",
        "push_along_axis",
        "axial_acceleration",
        "rolling_acceleration",
        "cone_half_angle",
        "centre_radius",
        "axial_gyration",
        "cone_factor",
        "turning_acceleration",
        "net_push",
        "wall_drag",
        "impact_damping",
        "restitution_at_impact",
        "damping_of_restitution",
        "restitution_of_damping",
        "lining_frequency",
        "lining_sag",
        "stiffness_ratio",
        "hertz_depth",
        "hertz_time",
    ]
    | str
)
SimulatedScene: TypeAlias = (
    Literal[
        "rectangle-on-plane",
        "cylinder-on-plane",
        "rectangle-on-track",
        "rectangle-isolated",
        "cylinder-isolated",
        "row-on-plane",
        "sphere-on-plane",
        "roller-on-plane",
        "disc-on-edge",
    ]
    | str
)
SimulatedOutput: TypeAlias = (
    Literal[
        "vibration_acceleration",
        "throw_number",
        "regime",
        "largest_acceleration_along",
        "stroke_along",
        "largest_jerk_along",
        "largest_acceleration_across",
        "stroke_across",
        "largest_jerk_across",
        "largest_acceleration_normal",
        "stroke_normal",
        "largest_jerk_normal",
        "drive_number",
        "drive_number_along",
        "drive_number_across",
        "drive_number_normal",
        "gravity_number_along",
        "gravity_number_across",
        "gravity_number_normal",
        "hold_down_number",
        "load_number",
        "curvature_number",
        "acceleration_scale",
        "velocity_scale",
        "length_scale",
        "conveying_velocity",
        "conveying_velocity_spread",
        "conveying_velocity_error",
        "velocity_across",
        "efficiency",
        "fastest_velocity",
        "share_of_fastest",
        "stick_fraction",
        "forward_fraction",
        "backward_fraction",
        "flight_fraction",
        "impacts_per_period",
        "period_multiple",
        "landing_speed",
        "hop_height",
        "friction_power",
        "impact_power",
        "drive_power",
        "friction_work",
        "impact_work",
        "drive_work",
        "part_friction_power",
        "part_impact_power",
        "part_drive_power",
        "part_friction_work",
        "part_impact_work",
        "part_drive_work",
        "effective_mass_ratio",
        "motion_status",
        "feed_rate",
        "direction",
        "final_pitch",
        "resting_side",
        "settling_time",
        "impact_count",
        "largest_bounce",
        "drift_velocity",
        "specific_energy_lost",
        "part_energy_lost",
        "line_feed_rate",
        "oriented_feed_rate",
        "mass_scale",
        "mean_gap",
        "impact_energy",
        "stop_force_peak",
        "stop_impulse",
        "platoon_size_1",
        "platoon_velocity_1",
        "platoon_size_2",
        "platoon_velocity_2",
        "platoon_size_3",
        "platoon_velocity_3",
        "platoon_size_4",
        "platoon_velocity_4",
        "platoon_size_5",
        "platoon_velocity_5",
        "platoon_size_6",
        "platoon_velocity_6",
        "platoon_size_7",
        "platoon_velocity_7",
        "platoon_size_8",
        "platoon_velocity_8",
        "platoon_size_9",
        "platoon_velocity_9",
        "platoon_size_10",
        "platoon_velocity_10",
        "platoons",
        "slowest_velocity",
        "fastest_part_velocity",
        "contact_fraction",
        "collisions_per_period",
        "stop_force",
        "stop_contact_fraction",
        "rolling_share",
        "mean_acceleration",
        "slip_velocity",
    ]
    | str
)
Output: TypeAlias = SweptOutput | SimulatedOutput


class NoMore(TypedDict):
    """No further keywords."""


class DriveNumbers(TypedDict, total=False):
    """Drives that are no plain sine: harmonics or steps (docs/drives.md)."""

    drive_factor: Values
    """Factor by which every amplitude or acceleration of the drive is multiplied. 0 or more, for
    example 1.2."""
    amplitude_along_1: Values
    """Amplitude of the track's motion along the track at the drive frequency, zero to peak. In m, 0
    or more, for example "0.1 mm"."""
    amplitude_along_2: Values
    """Amplitude of the track's motion along the track at 2 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_along_3: Values
    """Amplitude of the track's motion along the track at 3 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_along_4: Values
    """Amplitude of the track's motion along the track at 4 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_along_5: Values
    """Amplitude of the track's motion along the track at 5 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_along_6: Values
    """Amplitude of the track's motion along the track at 6 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_along_7: Values
    """Amplitude of the track's motion along the track at 7 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_along_8: Values
    """Amplitude of the track's motion along the track at 8 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_along_9: Values
    """Amplitude of the track's motion along the track at 9 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_along_10: Values
    """Amplitude of the track's motion along the track at 10 times the drive frequency, zero to
    peak. In m, 0 or more, for example "0.1 mm"."""
    amplitude_across_1: Values
    """Amplitude of the track's motion across the track at the drive frequency, zero to peak. In m,
    0 or more, for example "0.1 mm"."""
    amplitude_across_2: Values
    """Amplitude of the track's motion across the track at 2 times the drive frequency, zero to
    peak. In m, 0 or more, for example "0.1 mm"."""
    amplitude_across_3: Values
    """Amplitude of the track's motion across the track at 3 times the drive frequency, zero to
    peak. In m, 0 or more, for example "0.1 mm"."""
    amplitude_across_4: Values
    """Amplitude of the track's motion across the track at 4 times the drive frequency, zero to
    peak. In m, 0 or more, for example "0.1 mm"."""
    amplitude_across_5: Values
    """Amplitude of the track's motion across the track at 5 times the drive frequency, zero to
    peak. In m, 0 or more, for example "0.1 mm"."""
    amplitude_across_6: Values
    """Amplitude of the track's motion across the track at 6 times the drive frequency, zero to
    peak. In m, 0 or more, for example "0.1 mm"."""
    amplitude_across_7: Values
    """Amplitude of the track's motion across the track at 7 times the drive frequency, zero to
    peak. In m, 0 or more, for example "0.1 mm"."""
    amplitude_across_8: Values
    """Amplitude of the track's motion across the track at 8 times the drive frequency, zero to
    peak. In m, 0 or more, for example "0.1 mm"."""
    amplitude_across_9: Values
    """Amplitude of the track's motion across the track at 9 times the drive frequency, zero to
    peak. In m, 0 or more, for example "0.1 mm"."""
    amplitude_across_10: Values
    """Amplitude of the track's motion across the track at 10 times the drive frequency, zero to
    peak. In m, 0 or more, for example "0.1 mm"."""
    amplitude_normal_1: Values
    """Amplitude of the track's motion off the floor at the drive frequency, zero to peak. In m, 0
    or more, for example "0.1 mm"."""
    amplitude_normal_2: Values
    """Amplitude of the track's motion off the floor at 2 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_normal_3: Values
    """Amplitude of the track's motion off the floor at 3 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_normal_4: Values
    """Amplitude of the track's motion off the floor at 4 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_normal_5: Values
    """Amplitude of the track's motion off the floor at 5 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_normal_6: Values
    """Amplitude of the track's motion off the floor at 6 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_normal_7: Values
    """Amplitude of the track's motion off the floor at 7 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_normal_8: Values
    """Amplitude of the track's motion off the floor at 8 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_normal_9: Values
    """Amplitude of the track's motion off the floor at 9 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    amplitude_normal_10: Values
    """Amplitude of the track's motion off the floor at 10 times the drive frequency, zero to peak.
    In m, 0 or more, for example "0.1 mm"."""
    phase_along_1: Values
    """Lead of the track's motion along the track at the drive frequency: the displacement is A sin(
    w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_along_2: Values
    """Lead of the track's motion along the track at 2 times the drive frequency: the displacement
    is A sin(2 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_along_3: Values
    """Lead of the track's motion along the track at 3 times the drive frequency: the displacement
    is A sin(3 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_along_4: Values
    """Lead of the track's motion along the track at 4 times the drive frequency: the displacement
    is A sin(4 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_along_5: Values
    """Lead of the track's motion along the track at 5 times the drive frequency: the displacement
    is A sin(5 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_along_6: Values
    """Lead of the track's motion along the track at 6 times the drive frequency: the displacement
    is A sin(6 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_along_7: Values
    """Lead of the track's motion along the track at 7 times the drive frequency: the displacement
    is A sin(7 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_along_8: Values
    """Lead of the track's motion along the track at 8 times the drive frequency: the displacement
    is A sin(8 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_along_9: Values
    """Lead of the track's motion along the track at 9 times the drive frequency: the displacement
    is A sin(9 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_along_10: Values
    """Lead of the track's motion along the track at 10 times the drive frequency: the displacement
    is A sin(10 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_across_1: Values
    """Lead of the track's motion across the track at the drive frequency: the displacement is A
    sin( w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_across_2: Values
    """Lead of the track's motion across the track at 2 times the drive frequency: the displacement
    is A sin(2 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_across_3: Values
    """Lead of the track's motion across the track at 3 times the drive frequency: the displacement
    is A sin(3 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_across_4: Values
    """Lead of the track's motion across the track at 4 times the drive frequency: the displacement
    is A sin(4 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_across_5: Values
    """Lead of the track's motion across the track at 5 times the drive frequency: the displacement
    is A sin(5 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_across_6: Values
    """Lead of the track's motion across the track at 6 times the drive frequency: the displacement
    is A sin(6 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_across_7: Values
    """Lead of the track's motion across the track at 7 times the drive frequency: the displacement
    is A sin(7 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_across_8: Values
    """Lead of the track's motion across the track at 8 times the drive frequency: the displacement
    is A sin(8 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_across_9: Values
    """Lead of the track's motion across the track at 9 times the drive frequency: the displacement
    is A sin(9 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_across_10: Values
    """Lead of the track's motion across the track at 10 times the drive frequency: the displacement
    is A sin(10 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_normal_1: Values
    """Lead of the track's motion off the floor at the drive frequency: the displacement is A sin( w
    t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_normal_2: Values
    """Lead of the track's motion off the floor at 2 times the drive frequency: the displacement is
    A sin(2 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_normal_3: Values
    """Lead of the track's motion off the floor at 3 times the drive frequency: the displacement is
    A sin(3 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_normal_4: Values
    """Lead of the track's motion off the floor at 4 times the drive frequency: the displacement is
    A sin(4 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_normal_5: Values
    """Lead of the track's motion off the floor at 5 times the drive frequency: the displacement is
    A sin(5 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_normal_6: Values
    """Lead of the track's motion off the floor at 6 times the drive frequency: the displacement is
    A sin(6 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_normal_7: Values
    """Lead of the track's motion off the floor at 7 times the drive frequency: the displacement is
    A sin(7 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_normal_8: Values
    """Lead of the track's motion off the floor at 8 times the drive frequency: the displacement is
    A sin(8 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_normal_9: Values
    """Lead of the track's motion off the floor at 9 times the drive frequency: the displacement is
    A sin(9 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    phase_normal_10: Values
    """Lead of the track's motion off the floor at 10 times the drive frequency: the displacement is
    A sin(10 w t + phi). In degrees, from -720 to 720, for example "90 deg"."""
    acceleration_along_1: Values
    """Acceleration of the track along the track during step 1 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_along_2: Values
    """Acceleration of the track along the track during step 2 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_along_3: Values
    """Acceleration of the track along the track during step 3 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_along_4: Values
    """Acceleration of the track along the track during step 4 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_along_5: Values
    """Acceleration of the track along the track during step 5 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_along_6: Values
    """Acceleration of the track along the track during step 6 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_along_7: Values
    """Acceleration of the track along the track during step 7 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_along_8: Values
    """Acceleration of the track along the track during step 8 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_along_9: Values
    """Acceleration of the track along the track during step 9 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_along_10: Values
    """Acceleration of the track along the track during step 10 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_along_11: Values
    """Acceleration of the track along the track during step 11 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_along_12: Values
    """Acceleration of the track along the track during step 12 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_across_1: Values
    """Acceleration of the track across the track during step 1 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_across_2: Values
    """Acceleration of the track across the track during step 2 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_across_3: Values
    """Acceleration of the track across the track during step 3 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_across_4: Values
    """Acceleration of the track across the track during step 4 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_across_5: Values
    """Acceleration of the track across the track during step 5 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_across_6: Values
    """Acceleration of the track across the track during step 6 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_across_7: Values
    """Acceleration of the track across the track during step 7 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_across_8: Values
    """Acceleration of the track across the track during step 8 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_across_9: Values
    """Acceleration of the track across the track during step 9 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_across_10: Values
    """Acceleration of the track across the track during step 10 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_across_11: Values
    """Acceleration of the track across the track during step 11 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_across_12: Values
    """Acceleration of the track across the track during step 12 of a period. In m s-2, for example
    "4 m/s^2"."""
    acceleration_normal_1: Values
    """Acceleration of the track off the floor during step 1 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_normal_2: Values
    """Acceleration of the track off the floor during step 2 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_normal_3: Values
    """Acceleration of the track off the floor during step 3 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_normal_4: Values
    """Acceleration of the track off the floor during step 4 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_normal_5: Values
    """Acceleration of the track off the floor during step 5 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_normal_6: Values
    """Acceleration of the track off the floor during step 6 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_normal_7: Values
    """Acceleration of the track off the floor during step 7 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_normal_8: Values
    """Acceleration of the track off the floor during step 8 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_normal_9: Values
    """Acceleration of the track off the floor during step 9 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_normal_10: Values
    """Acceleration of the track off the floor during step 10 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_normal_11: Values
    """Acceleration of the track off the floor during step 11 of a period. In m s-2, for example "4
    m/s^2"."""
    acceleration_normal_12: Values
    """Acceleration of the track off the floor during step 12 of a period. In m s-2, for example "4
    m/s^2"."""
    duration_1: Values
    """Relative duration of step 1; the durations of all steps divide the period. 0 or more, for
    example 0.25."""
    duration_2: Values
    """Relative duration of step 2; the durations of all steps divide the period. 0 or more, for
    example 0.25."""
    duration_3: Values
    """Relative duration of step 3; the durations of all steps divide the period. 0 or more, for
    example 0.25."""
    duration_4: Values
    """Relative duration of step 4; the durations of all steps divide the period. 0 or more, for
    example 0.25."""
    duration_5: Values
    """Relative duration of step 5; the durations of all steps divide the period. 0 or more, for
    example 0.25."""
    duration_6: Values
    """Relative duration of step 6; the durations of all steps divide the period. 0 or more, for
    example 0.25."""
    duration_7: Values
    """Relative duration of step 7; the durations of all steps divide the period. 0 or more, for
    example 0.25."""
    duration_8: Values
    """Relative duration of step 8; the durations of all steps divide the period. 0 or more, for
    example 0.25."""
    duration_9: Values
    """Relative duration of step 9; the durations of all steps divide the period. 0 or more, for
    example 0.25."""
    duration_10: Values
    """Relative duration of step 10; the durations of all steps divide the period. 0 or more, for
    example 0.25."""
    duration_11: Values
    """Relative duration of step 11; the durations of all steps divide the period. 0 or more, for
    example 0.25."""
    duration_12: Values
    """Relative duration of step 12; the durations of all steps divide the period. 0 or more, for
    example 0.25."""
    part_friction_1: Values
    """Coefficient of friction between the track and part 1 of a row, the rearmost. 0 or more, for
    example 0.3."""
    part_friction_2: Values
    """Coefficient of friction between the track and part 2 of a row. 0 or more, for example 0.3."""
    part_friction_3: Values
    """Coefficient of friction between the track and part 3 of a row. 0 or more, for example 0.3."""
    part_friction_4: Values
    """Coefficient of friction between the track and part 4 of a row. 0 or more, for example 0.3."""
    part_friction_5: Values
    """Coefficient of friction between the track and part 5 of a row. 0 or more, for example 0.3."""
    part_friction_6: Values
    """Coefficient of friction between the track and part 6 of a row. 0 or more, for example 0.3."""
    part_friction_7: Values
    """Coefficient of friction between the track and part 7 of a row. 0 or more, for example 0.3."""
    part_friction_8: Values
    """Coefficient of friction between the track and part 8 of a row. 0 or more, for example 0.3."""
    part_friction_9: Values
    """Coefficient of friction between the track and part 9 of a row. 0 or more, for example 0.3."""
    part_friction_10: Values
    """Coefficient of friction between the track and part 10 of a row. 0 or more, for example
    0.3."""
    part_mass_1: Values
    """Mass of part 1 of a row, the rearmost. In kg, above 0, for example "4 g"."""
    part_mass_2: Values
    """Mass of part 2 of a row. In kg, above 0, for example "4 g"."""
    part_mass_3: Values
    """Mass of part 3 of a row. In kg, above 0, for example "4 g"."""
    part_mass_4: Values
    """Mass of part 4 of a row. In kg, above 0, for example "4 g"."""
    part_mass_5: Values
    """Mass of part 5 of a row. In kg, above 0, for example "4 g"."""
    part_mass_6: Values
    """Mass of part 6 of a row. In kg, above 0, for example "4 g"."""
    part_mass_7: Values
    """Mass of part 7 of a row. In kg, above 0, for example "4 g"."""
    part_mass_8: Values
    """Mass of part 8 of a row. In kg, above 0, for example "4 g"."""
    part_mass_9: Values
    """Mass of part 9 of a row. In kg, above 0, for example "4 g"."""
    part_mass_10: Values
    """Mass of part 10 of a row. In kg, above 0, for example "4 g"."""
    part_gap_1: Values
    """Gap in front of part 1 of a row, the rearmost, at the start. In m, 0 or more, for example "1
    mm"."""
    part_gap_2: Values
    """Gap in front of part 2 of a row, at the start. In m, 0 or more, for example "1 mm"."""
    part_gap_3: Values
    """Gap in front of part 3 of a row, at the start. In m, 0 or more, for example "1 mm"."""
    part_gap_4: Values
    """Gap in front of part 4 of a row, at the start. In m, 0 or more, for example "1 mm"."""
    part_gap_5: Values
    """Gap in front of part 5 of a row, at the start. In m, 0 or more, for example "1 mm"."""
    part_gap_6: Values
    """Gap in front of part 6 of a row, at the start. In m, 0 or more, for example "1 mm"."""
    part_gap_7: Values
    """Gap in front of part 7 of a row, at the start. In m, 0 or more, for example "1 mm"."""
    part_gap_8: Values
    """Gap in front of part 8 of a row, at the start. In m, 0 or more, for example "1 mm"."""
    part_gap_9: Values
    """Gap in front of part 9 of a row, at the start. In m, 0 or more, for example "1 mm"."""
    part_gap_10: Values
    """Gap in front of part 10 of a row, at the start. In m, 0 or more, for example "1 mm"."""
    stretch_turns_1: Values
    """Turns of stretch 1 of the track. Above 0, for example 1.5."""
    stretch_turns_2: Values
    """Turns of stretch 2 of the track. Above 0, for example 1.5."""
    stretch_turns_3: Values
    """Turns of stretch 3 of the track. Above 0, for example 1.5."""
    stretch_turns_4: Values
    """Turns of stretch 4 of the track. Above 0, for example 1.5."""
    stretch_turns_5: Values
    """Turns of stretch 5 of the track. Above 0, for example 1.5."""
    stretch_turns_6: Values
    """Turns of stretch 6 of the track. Above 0, for example 1.5."""
    stretch_radius_1: Values
    """Radius at the end of stretch 1. In m, above 0, for example "150 mm"."""
    stretch_radius_2: Values
    """Radius at the end of stretch 2. In m, above 0, for example "150 mm"."""
    stretch_radius_3: Values
    """Radius at the end of stretch 3. In m, above 0, for example "150 mm"."""
    stretch_radius_4: Values
    """Radius at the end of stretch 4. In m, above 0, for example "150 mm"."""
    stretch_radius_5: Values
    """Radius at the end of stretch 5. In m, above 0, for example "150 mm"."""
    stretch_radius_6: Values
    """Radius at the end of stretch 6. In m, above 0, for example "150 mm"."""
    stretch_climb_1: Values
    """Climb of stretch 1; that of the stretch before unless given. In degrees, from -80 to 80, for
    example "3 deg"."""
    stretch_climb_2: Values
    """Climb of stretch 2; that of the stretch before unless given. In degrees, from -80 to 80, for
    example "3 deg"."""
    stretch_climb_3: Values
    """Climb of stretch 3; that of the stretch before unless given. In degrees, from -80 to 80, for
    example "3 deg"."""
    stretch_climb_4: Values
    """Climb of stretch 4; that of the stretch before unless given. In degrees, from -80 to 80, for
    example "3 deg"."""
    stretch_climb_5: Values
    """Climb of stretch 5; that of the stretch before unless given. In degrees, from -80 to 80, for
    example "3 deg"."""
    stretch_climb_6: Values
    """Climb of stretch 6; that of the stretch before unless given. In degrees, from -80 to 80, for
    example "3 deg"."""
    stretch_friction_1: Values
    """Coefficient of friction on stretch 1; that of the stretch before unless given. 0 or more, for
    example 0.3."""
    stretch_friction_2: Values
    """Coefficient of friction on stretch 2; that of the stretch before unless given. 0 or more, for
    example 0.3."""
    stretch_friction_3: Values
    """Coefficient of friction on stretch 3; that of the stretch before unless given. 0 or more, for
    example 0.3."""
    stretch_friction_4: Values
    """Coefficient of friction on stretch 4; that of the stretch before unless given. 0 or more, for
    example 0.3."""
    stretch_friction_5: Values
    """Coefficient of friction on stretch 5; that of the stretch before unless given. 0 or more, for
    example 0.3."""
    stretch_friction_6: Values
    """Coefficient of friction on stretch 6; that of the stretch before unless given. 0 or more, for
    example 0.3."""
