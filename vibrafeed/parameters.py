"""The parameters of each scene, as types for editors and type checkers.

Written by `python -m benchmarks.keywords`. The type of a parameter names the unit of numbers that
are given without one. `vibrafeed.scene` says more of each parameter.

>>> from vibrafeed.parameters import RectangleOnPlane
>>> design: RectangleOnPlane = {"frequency": "50 Hz", "beta": 20, "friction": 0.3}
>>> design["amplitude"] = ["0.2 mm", "0.3 mm"]
>>> vibrafeed.simulate("rectangle-on-plane", **design).conveying_velocity.dims
('amplitude',)
"""

# fmt: off
# ruff: noqa: D204, UP013
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias, TypedDict

from vibrafeed._values import Values

number: TypeAlias = Values
Hz: TypeAlias = Values
N: TypeAlias = Values
N_m: TypeAlias = Values
N_per_m: TypeAlias = Values
N_s_per_m: TypeAlias = Values
Pa: TypeAlias = Values
T: TypeAlias = Values
V: TypeAlias = Values
degree: TypeAlias = Values
kg: TypeAlias = Values
kg_m: TypeAlias = Values
kg_per_m3: TypeAlias = Values
kg_m2: TypeAlias = Values
m: TypeAlias = Values
m_per_s: TypeAlias = Values
m_per_s2: TypeAlias = Values
m2: TypeAlias = Values
per_min: TypeAlias = Values
rad_per_s: TypeAlias = Values
s: TypeAlias = Values
SceneName: TypeAlias = Literal[
    "rectangle-isolated", "rectangle-on-plane", "rectangle-on-track", "part-on-plate",
    "rectangle-pair-impact", "cylinder-isolated", "cylinder-on-plane", "cylinder-pair-impact",
    "cylinder-rolling", "sphere-on-plane", "roller-on-plane", "disc-on-edge", "cone-on-plane",
    "soft-contact", "linear-drive-unit", "bowl-drive-unit", "resting-part", "orienting-line",
    "row-on-plane",
]
Output: TypeAlias = Literal[
    "vibration_acceleration", "drive_along", "drive_across", "drive_normal", "gravity_along",
    "gravity_across", "gravity_normal", "throw_number", "normal_acceleration", "floor_acceleration",
    "centripetal_acceleration", "in_plane_drive_x", "in_plane_drive_y", "in_plane_drive",
    "sliding_fraction", "roll_root", "acceleration_x", "acceleration_y", "acceleration_z",
    "rotated_acceleration_x", "rotated_acceleration_y", "angular_acceleration",
    "starting_acceleration", "transport_velocity", "terminal_velocity", "travel_time",
    "mean_velocity", "velocity_at_time", "distance_at_time", "stopping_distance", "stopping_time",
    "velocity_bound", "suggested_distance", "distance_bound", "floor_force", "wall_balance",
    "wall_acceleration", "wall_force", "wall_force_rear", "wall_force_front", "chord_cosine",
    "wall_speed", "z_residual", "pressure_offset_x", "pressure_offset_y", "regime",
    "largest_acceleration_along", "stroke_along", "largest_jerk_along",
    "largest_acceleration_across", "stroke_across", "largest_jerk_across",
    "largest_acceleration_normal", "stroke_normal", "largest_jerk_normal", "rolling_drive",
    "axial_drive", "axial_friction_acceleration", "rolling_friction", "axial_friction",
    "spin_acceleration", "yaw_acceleration", "printed_yaw_rate", "pressure_offset_axial",
    "required_friction", "cone_margin", "floor_pitch", "floor_axis_normal", "floor_axis_rolling",
    "floor_axis_axial", "force_pitch", "force_axis_normal", "force_axis_rolling",
    "force_axis_axial", "corner_angle", "diagonal_angle", "half_diagonal", "inertia_ratio",
    "touching_height", "pivot_velocity_along", "pivot_velocity_upward", "gap_normal",
    "gap_tangential", "gap_normal_rate", "gap_tangential_rate", "gap_normal_acceleration",
    "gap_tangential_acceleration", "free_normal_acceleration", "free_tangential_acceleration",
    "normal_response_right", "normal_response_left", "normal_response",
    "holding_normal_acceleration", "holding_tangential_acceleration", "slip_direction",
    "friction_force", "acceleration_along", "acceleration_upward", "pitch_acceleration",
    "inverse_limiting_friction", "limiting_friction_right", "limiting_friction_left",
    "least_limiting_friction", "least_limiting_pitch", "impact_impulse_normal",
    "impact_impulse_tangential", "inertia_1", "velocity_x_1_after", "velocity_y_1_after",
    "velocity_z_1_after", "spin_x_1_after", "spin_y_1_after", "spin_z_1_after", "spin_1_after",
    "inertia_2", "velocity_x_2_after", "velocity_y_2_after", "velocity_z_2_after", "spin_x_2_after",
    "spin_y_2_after", "spin_z_2_after", "spin_2_after", "gap", "face_body", "contact_corner",
    "contact_x", "contact_y", "normal_x", "normal_y", "contact_form", "contact_z", "normal_z",
    "sliding_before", "sliding_after", "impulse_friction", "impulse_x", "impulse_y", "impulse_z",
    "momentum_residual_z", "angular_momentum_residual_x", "angular_momentum_residual_y",
    "angular_momentum_residual_z", "delassus_normal", "delassus_coupling", "delassus_tangential",
    "approach_normal", "approach_tangential", "separation_normal", "separation_tangential",
    "impulse_normal", "impulse_tangential", "energy_before", "energy_lost", "momentum_residual_x",
    "momentum_residual_y", "angular_momentum_residual", "drive_number", "drive_number_along",
    "drive_number_across", "drive_number_normal", "gravity_number_along", "gravity_number_across",
    "gravity_number_normal", "hold_down_number", "load_number", "curvature_number",
    "acceleration_scale", "velocity_scale", "length_scale", "conveying_velocity",
    "conveying_velocity_spread", "conveying_velocity_error", "velocity_across", "efficiency",
    "fastest_velocity", "share_of_fastest", "stick_fraction", "forward_fraction",
    "backward_fraction", "flight_fraction", "impacts_per_period", "period_multiple",
    "landing_speed", "hop_height", "friction_power", "impact_power", "drive_power", "friction_work",
    "impact_work", "drive_work", "part_friction_power", "part_impact_power", "part_drive_power",
    "part_friction_work", "part_impact_work", "part_drive_work", "effective_mass_ratio",
    "motion_status", "feed_rate", "direction", "burst_displacement", "burst_coasting_time",
    "final_pitch", "resting_side", "settling_time", "impact_count", "largest_bounce",
    "drift_velocity", "specific_energy_lost", "part_energy_lost", "circular_frequency",
    "generalised_mass", "loaded_mass", "loaded_inertia", "bowl_mass", "damping",
    "natural_frequency", "foot_frequency", "stroke", "phase", "amplification", "second_harmonic",
    "turning_mass", "trough_turn", "track_amplitude", "vibration_angle", "bowl_turn", "bowl_lift",
    "leaf_frequency", "leaf_mass", "spring_stress", "stress_margin", "air_gap_margin", "foot_force",
    "drive_unit_power", "mass_height", "gyration", "let_down_share_flat", "thrown_share_flat",
    "counted_share_flat", "let_down_share_on_side", "thrown_share_on_side", "counted_share_on_side",
    "let_down_share_on_end", "thrown_share_on_end", "counted_share_on_end",
    "let_down_share_upright", "thrown_share_upright", "counted_share_upright",
    "let_down_share_inverted", "thrown_share_inverted", "counted_share_inverted", "part_volume",
    "part_mass", "let_down_share", "thrown_share", "lying_height", "lying_length", "lying_width",
    "least_base", "standing_base_across", "topple_slope_across", "least_topple_slope", "side_foot",
    "long_side_share", "standing_base", "standing_centre", "edge_distance", "topple_slope",
    "rocking_friction", "rocking_rate", "topple_speed", "pulse_angle", "topple_acceleration",
    "push_over_load", "rocking_margin", "topple_margin", "drop_count", "yield",
    "passing_share_flat", "leaving_share_flat", "passing_share_on_side", "leaving_share_on_side",
    "passing_share_on_end", "leaving_share_on_end", "passing_share_upright",
    "leaving_share_upright", "passing_share_inverted", "leaving_share_inverted", "leaving_wanted",
    "purity", "laps", "laps_variance", "laps_99", "time_per_part", "line_feed_rate",
    "oriented_feed_rate", "return_rate", "yield_deviation", "yield_lower", "yield_upper",
    "laps_lower", "laps_upper", "line_feed_rate_lower", "line_feed_rate_upper", "purity_lower",
    "purity_upper", "oriented_feed_rate_lower", "oriented_feed_rate_upper", "return_rate_lower",
    "return_rate_upper", "mass_scale", "mean_gap", "impact_energy", "stop_force_peak",
    "stop_impulse", "platoon_size_1", "platoon_velocity_1", "platoon_size_2", "platoon_velocity_2",
    "platoon_size_3", "platoon_velocity_3", "platoon_size_4", "platoon_velocity_4",
    "platoon_size_5", "platoon_velocity_5", "platoon_size_6", "platoon_velocity_6",
    "platoon_size_7", "platoon_velocity_7", "platoon_size_8", "platoon_velocity_8",
    "platoon_size_9", "platoon_velocity_9", "platoon_size_10", "platoon_velocity_10", "platoons",
    "slowest_velocity", "fastest_part_velocity", "contact_fraction", "collisions_per_period",
    "lane_pitch", "throughput_limit", "throughput", "part_spacing", "queue_velocity", "fill_time",
    "clear_time", "escapement_rate", "bend_pitch", "held_line_force", "sliding_line_force",
    "row_weight", "stop_force", "least_stop_force", "locked_stop_force", "mean_platoons",
    "closing_time", "pair_force", "stop_contact_fraction", "stop_impact_share", "rolling_share",
    "moved_fraction", "push_across_axis", "push_along_axis", "axial_acceleration",
    "rolling_acceleration", "cone_half_angle", "centre_radius", "axial_gyration", "cone_factor",
    "turning_acceleration", "net_push", "wall_drag", "impact_damping", "restitution_at_impact",
    "damping_of_restitution", "restitution_of_damping", "lining_frequency", "lining_sag",
    "stiffness_ratio", "hertz_depth", "hertz_time", "mean_acceleration", "slip_velocity",
    "velocity_x", "velocity_y", "velocity_error", "travel_speed", "travel_direction",
    "velocity_towards", "slip_fraction",
]
Outputs: TypeAlias = Output | str | Sequence[Output | str]
# Other drives, drive units, tracks of bowls, and single parts of rows (docs/drives.md).
InTime = TypedDict("InTime", {
    "drive_factor": number, "amplitude_along_1": m, "amplitude_along_2": m, "amplitude_along_3": m,
    "amplitude_along_4": m, "amplitude_along_5": m, "amplitude_along_6": m, "amplitude_along_7": m,
    "amplitude_along_8": m, "amplitude_along_9": m, "amplitude_along_10": m,
    "amplitude_across_1": m, "amplitude_across_2": m, "amplitude_across_3": m,
    "amplitude_across_4": m, "amplitude_across_5": m, "amplitude_across_6": m,
    "amplitude_across_7": m, "amplitude_across_8": m, "amplitude_across_9": m,
    "amplitude_across_10": m, "amplitude_normal_1": m, "amplitude_normal_2": m,
    "amplitude_normal_3": m, "amplitude_normal_4": m, "amplitude_normal_5": m,
    "amplitude_normal_6": m, "amplitude_normal_7": m, "amplitude_normal_8": m,
    "amplitude_normal_9": m, "amplitude_normal_10": m, "phase_along_1": degree,
    "phase_along_2": degree, "phase_along_3": degree, "phase_along_4": degree,
    "phase_along_5": degree, "phase_along_6": degree, "phase_along_7": degree,
    "phase_along_8": degree, "phase_along_9": degree, "phase_along_10": degree,
    "phase_across_1": degree, "phase_across_2": degree, "phase_across_3": degree,
    "phase_across_4": degree, "phase_across_5": degree, "phase_across_6": degree,
    "phase_across_7": degree, "phase_across_8": degree, "phase_across_9": degree,
    "phase_across_10": degree, "phase_normal_1": degree, "phase_normal_2": degree,
    "phase_normal_3": degree, "phase_normal_4": degree, "phase_normal_5": degree,
    "phase_normal_6": degree, "phase_normal_7": degree, "phase_normal_8": degree,
    "phase_normal_9": degree, "phase_normal_10": degree, "ellipse_major": m, "ellipse_minor": m,
    "ellipse_tilt": degree, "acceleration_along_1": m_per_s2, "acceleration_along_2": m_per_s2,
    "acceleration_along_3": m_per_s2, "acceleration_along_4": m_per_s2,
    "acceleration_along_5": m_per_s2, "acceleration_along_6": m_per_s2,
    "acceleration_along_7": m_per_s2, "acceleration_along_8": m_per_s2,
    "acceleration_along_9": m_per_s2, "acceleration_along_10": m_per_s2,
    "acceleration_along_11": m_per_s2, "acceleration_along_12": m_per_s2,
    "acceleration_across_1": m_per_s2, "acceleration_across_2": m_per_s2,
    "acceleration_across_3": m_per_s2, "acceleration_across_4": m_per_s2,
    "acceleration_across_5": m_per_s2, "acceleration_across_6": m_per_s2,
    "acceleration_across_7": m_per_s2, "acceleration_across_8": m_per_s2,
    "acceleration_across_9": m_per_s2, "acceleration_across_10": m_per_s2,
    "acceleration_across_11": m_per_s2, "acceleration_across_12": m_per_s2,
    "acceleration_normal_1": m_per_s2, "acceleration_normal_2": m_per_s2,
    "acceleration_normal_3": m_per_s2, "acceleration_normal_4": m_per_s2,
    "acceleration_normal_5": m_per_s2, "acceleration_normal_6": m_per_s2,
    "acceleration_normal_7": m_per_s2, "acceleration_normal_8": m_per_s2,
    "acceleration_normal_9": m_per_s2, "acceleration_normal_10": m_per_s2,
    "acceleration_normal_11": m_per_s2, "acceleration_normal_12": m_per_s2, "duration_1": number,
    "duration_2": number, "duration_3": number, "duration_4": number, "duration_5": number,
    "duration_6": number, "duration_7": number, "duration_8": number, "duration_9": number,
    "duration_10": number, "duration_11": number, "duration_12": number, "moving_mass": kg,
    "base_mass": kg, "load_mass": kg, "load_damping": N_s_per_m, "conveyed_mass": kg,
    "moving_inertia": kg_m2, "base_inertia": kg_m2, "spring_radius": m, "spring_angle": degree,
    "spring_count": number, "spring_width": m, "spring_thickness": m, "spring_length": m,
    "elastic_modulus": Pa, "spring_density": kg_per_m3, "clamp_factor": number,
    "allowable_stress": Pa, "ring_down_frequency": Hz, "damping_ratio": number, "drive_force": N,
    "flux_density": T, "pole_area": m2, "drive_voltage": V, "measured_voltage": V,
    "measured_amplitude": m, "measured_frequency": Hz, "measured_radius": m,
    "force_exponent": number, "force_harmonic": number, "offset_along": m, "offset_upward": m,
    "spot_along": m, "spot_upward": m, "unbalance": kg_m, "air_gap": m, "foot_stiffness": N_per_m,
    "foot_damping": N_s_per_m, "spring_stiffness": N_per_m, "track_fraction": number,
    "start_radius": m, "stretch_turns_1": number, "stretch_turns_2": number,
    "stretch_turns_3": number, "stretch_turns_4": number, "stretch_turns_5": number,
    "stretch_turns_6": number, "stretch_radius_1": m, "stretch_radius_2": m, "stretch_radius_3": m,
    "stretch_radius_4": m, "stretch_radius_5": m, "stretch_radius_6": m, "stretch_climb_1": degree,
    "stretch_climb_2": degree, "stretch_climb_3": degree, "stretch_climb_4": degree,
    "stretch_climb_5": degree, "stretch_climb_6": degree, "stretch_friction_1": number,
    "stretch_friction_2": number, "stretch_friction_3": number, "stretch_friction_4": number,
    "stretch_friction_5": number, "stretch_friction_6": number, "load_radius": m,
    "load_fraction": number, "part_friction_1": number, "part_friction_2": number,
    "part_friction_3": number, "part_friction_4": number, "part_friction_5": number,
    "part_friction_6": number, "part_friction_7": number, "part_friction_8": number,
    "part_friction_9": number, "part_friction_10": number, "part_mass_1": kg, "part_mass_2": kg,
    "part_mass_3": kg, "part_mass_4": kg, "part_mass_5": kg, "part_mass_6": kg, "part_mass_7": kg,
    "part_mass_8": kg, "part_mass_9": kg, "part_mass_10": kg, "part_gap_1": m, "part_gap_2": m,
    "part_gap_3": m, "part_gap_4": m, "part_gap_5": m, "part_gap_6": m, "part_gap_7": m,
    "part_gap_8": m, "part_gap_9": m, "part_gap_10": m, "friction_spread": number,
    "friction_seed": number, "track_stop_gap": m, "fixed_stop_gap": m, "amplitude_yaw_1": degree,
    "amplitude_yaw_2": degree, "amplitude_yaw_3": degree, "amplitude_tilt_x_1": degree,
    "amplitude_tilt_x_2": degree, "amplitude_tilt_x_3": degree, "amplitude_tilt_y_1": degree,
    "amplitude_tilt_y_2": degree, "amplitude_tilt_y_3": degree, "phase_yaw_1": degree,
    "phase_yaw_2": degree, "phase_yaw_3": degree, "phase_tilt_x_1": degree,
    "phase_tilt_x_2": degree, "phase_tilt_x_3": degree, "phase_tilt_y_1": degree,
    "phase_tilt_y_2": degree, "phase_tilt_y_3": degree, "position_x": m, "position_y": m,
    "target_direction": degree,
}, total=False)
_RectangleIsolated = TypedDict("_RectangleIsolated", {
    "frequency": Hz, "amplitude": m, "peak_to_peak": m, "vertical_amplitude": m,
    "vertical_peak_to_peak": m, "beta": degree, "gamma": degree, "gravity": m_per_s2,
    "friction": number, "friction_static": number, "friction_kinetic": number, "height": m,
    "length": m, "mass": kg, "restitution": number, "pitch": degree, "pitch_rate": rad_per_s,
    "centre_along": m, "centre_height": m, "velocity_along": m_per_s, "velocity_upward": m_per_s,
    "duration": s, "drop_height": m,
}, total=False)
class RectangleIsolated(_RectangleIsolated, InTime, total=False):
    """Rectangular part with one corner on a plane."""
_RectangleOnPlane = TypedDict("_RectangleOnPlane", {
    "frequency": Hz, "amplitude": m, "peak_to_peak": m, "vertical_amplitude": m,
    "vertical_peak_to_peak": m, "alpha": degree, "beta": degree, "gamma": degree, "yaw": degree,
    "gravity": m_per_s2, "friction": number, "friction_static": number, "friction_kinetic": number,
    "width": m, "height": m, "length": m, "mass": kg, "restitution": number, "hold_down": m_per_s2,
    "hold_down_force": N, "part_gap": m, "occupancy": number, "burst_periods": number,
    "line_yield": number, "line_purity": number,
}, total=False)
class RectangleOnPlane(_RectangleOnPlane, InTime, total=False):
    """Rectangular part on a horizontal or inclined plane."""
_RectangleOnTrack = TypedDict("_RectangleOnTrack", {
    "frequency": Hz, "amplitude": m, "peak_to_peak": m, "vertical_amplitude": m,
    "vertical_peak_to_peak": m, "alpha": degree, "beta": degree, "gamma": degree, "delta": degree,
    "radius": m, "gravity": m_per_s2, "friction": number, "friction_static": number,
    "friction_kinetic": number, "wall_friction": number, "width": m, "height": m, "length": m,
    "mass": kg, "restitution": number, "wall_restitution": number, "speed": m_per_s, "distance": m,
    "time": s, "hold_down": m_per_s2, "hold_down_force": N, "part_gap": m, "occupancy": number,
    "burst_periods": number, "line_yield": number, "line_purity": number,
}, total=False)
class RectangleOnTrack(_RectangleOnTrack, InTime, total=False):
    """Rectangular part on the narrow track, floor and wall."""
_PartOnPlate = TypedDict("_PartOnPlate", {
    "frequency": Hz, "amplitude": m, "peak_to_peak": m, "vertical_amplitude": m,
    "vertical_peak_to_peak": m, "alpha": degree, "beta": degree, "gamma": degree, "delta": degree,
    "gravity": m_per_s2, "friction": number, "friction_static": number, "friction_kinetic": number,
    "mass": kg, "restitution": number, "hold_down": m_per_s2, "hold_down_force": N,
}, total=False)
class PartOnPlate(_PartOnPlate, InTime, total=False):
    """Part on a plate without a wall."""
# Impact of two rectangular parts on the floor plane.
RectanglePairImpact = TypedDict("RectanglePairImpact", {
    "friction": number, "restitution": number, "position_x_1": m, "position_y_1": m,
    "angle_1": degree, "velocity_x_1": m_per_s, "velocity_y_1": m_per_s, "spin_1": rad_per_s,
    "length_1": m, "width_1": m, "mass_1": kg, "position_x_2": m, "position_y_2": m,
    "angle_2": degree, "velocity_x_2": m_per_s, "velocity_y_2": m_per_s, "spin_2": rad_per_s,
    "length_2": m, "width_2": m, "mass_2": kg, "contact_tolerance": number,
}, total=False)
_CylinderIsolated = TypedDict("_CylinderIsolated", {
    "frequency": Hz, "amplitude": m, "peak_to_peak": m, "vertical_amplitude": m,
    "vertical_peak_to_peak": m, "beta": degree, "gamma": degree, "gravity": m_per_s2,
    "friction": number, "friction_static": number, "friction_kinetic": number, "length": m,
    "diameter": m, "mass": kg, "restitution": number, "pitch": degree, "pitch_rate": rad_per_s,
    "centre_along": m, "centre_height": m, "velocity_along": m_per_s, "velocity_upward": m_per_s,
    "duration": s, "drop_height": m,
}, total=False)
class CylinderIsolated(_CylinderIsolated, InTime, total=False):
    """Cylindrical part with one point of its rim on a plane."""
_CylinderOnPlane = TypedDict("_CylinderOnPlane", {
    "frequency": Hz, "amplitude": m, "peak_to_peak": m, "vertical_amplitude": m,
    "vertical_peak_to_peak": m, "alpha": degree, "beta": degree, "gamma": degree, "yaw": degree,
    "gravity": m_per_s2, "friction": number, "friction_static": number, "friction_kinetic": number,
    "length": m, "diameter": m, "mass": kg, "restitution": number, "hold_down": m_per_s2,
    "hold_down_force": N, "part_gap": m, "occupancy": number, "burst_periods": number,
    "line_yield": number, "line_purity": number,
}, total=False)
class CylinderOnPlane(_CylinderOnPlane, InTime, total=False):
    """Cylindrical part lying on a plane, its axis along the track."""
# Impact of two cylindrical parts.
CylinderPairImpact = TypedDict("CylinderPairImpact", {
    "friction": number, "restitution": number, "position_x_1": m, "position_y_1": m,
    "velocity_x_1": m_per_s, "velocity_y_1": m_per_s, "position_z_1": m, "azimuth_1": degree,
    "elevation_1": degree, "velocity_z_1": m_per_s, "spin_x_1": rad_per_s, "spin_y_1": rad_per_s,
    "spin_z_1": rad_per_s, "diameter_1": m, "length_1": m, "mass_1": kg, "position_x_2": m,
    "position_y_2": m, "velocity_x_2": m_per_s, "velocity_y_2": m_per_s, "position_z_2": m,
    "azimuth_2": degree, "elevation_2": degree, "velocity_z_2": m_per_s, "spin_x_2": rad_per_s,
    "spin_y_2": rad_per_s, "spin_z_2": rad_per_s, "diameter_2": m, "length_2": m, "mass_2": kg,
    "contact_tolerance": number,
}, total=False)
# Cylindrical part that rolls and yaws on a level plane.
CylinderRolling = TypedDict("CylinderRolling", {
    "frequency": Hz, "amplitude": m, "peak_to_peak": m, "vertical_amplitude": m,
    "vertical_peak_to_peak": m, "alpha": degree, "beta": degree, "gravity": m_per_s2,
    "friction": number, "friction_static": number, "length": m, "diameter": m, "mass": kg,
    "axis_yaw": degree, "spin_rate": rad_per_s, "yaw_rate": rad_per_s, "drilling_moment": N_m,
}, total=False)
_SphereOnPlane = TypedDict("_SphereOnPlane", {
    "frequency": Hz, "amplitude": m, "peak_to_peak": m, "vertical_amplitude": m,
    "vertical_peak_to_peak": m, "alpha": degree, "beta": degree, "gamma": degree, "yaw": degree,
    "gravity": m_per_s2, "friction": number, "friction_static": number, "friction_kinetic": number,
    "length": m, "diameter": m, "mass": kg, "restitution": number, "hold_down": m_per_s2,
    "hold_down_force": N, "part_gap": m, "occupancy": number, "line_yield": number,
    "line_purity": number, "inner_diameter": m, "rolling_factor": number,
    "rolling_resistance": number,
}, total=False)
class SphereOnPlane(_SphereOnPlane, InTime, total=False):
    """Ball or hollow ball on a horizontal or inclined plane."""
_RollerOnPlane = TypedDict("_RollerOnPlane", {
    "frequency": Hz, "amplitude": m, "peak_to_peak": m, "vertical_amplitude": m,
    "vertical_peak_to_peak": m, "alpha": degree, "beta": degree, "gamma": degree, "yaw": degree,
    "gravity": m_per_s2, "friction": number, "friction_static": number, "friction_kinetic": number,
    "length": m, "diameter": m, "mass": kg, "restitution": number, "axis_yaw": degree,
    "hold_down": m_per_s2, "hold_down_force": N, "part_gap": m, "occupancy": number,
    "line_yield": number, "line_purity": number, "inner_diameter": m, "rolling_factor": number,
    "rolling_resistance": number,
}, total=False)
class RollerOnPlane(_RollerOnPlane, InTime, total=False):
    """Roller, tube, ring or hoop lying on a plane, its axis across the track."""
_DiscOnEdge = TypedDict("_DiscOnEdge", {
    "frequency": Hz, "amplitude": m, "peak_to_peak": m, "vertical_amplitude": m,
    "vertical_peak_to_peak": m, "alpha": degree, "beta": degree, "gamma": degree, "delta": degree,
    "radius": m, "gravity": m_per_s2, "friction": number, "friction_static": number,
    "friction_kinetic": number, "wall_friction": number, "length": m, "diameter": m, "mass": kg,
    "speed": m_per_s, "hold_down": m_per_s2, "hold_down_force": N, "part_gap": m,
    "occupancy": number, "line_yield": number, "line_purity": number, "inner_diameter": m,
    "rolling_factor": number, "rolling_resistance": number,
}, total=False)
class DiscOnEdge(_DiscOnEdge, InTime, total=False):
    """Disc, coin or ring on its edge, its face against the wall."""
# Truncated cone on its side, rolling about its apex.
ConeOnPlane = TypedDict("ConeOnPlane", {
    "frequency": Hz, "amplitude": m, "peak_to_peak": m, "vertical_amplitude": m,
    "vertical_peak_to_peak": m, "alpha": degree, "beta": degree, "gamma": degree,
    "gravity": m_per_s2, "friction": number, "friction_static": number, "height": m, "diameter": m,
    "mass": kg, "axis_yaw": degree, "small_diameter": m,
}, total=False)
# Compliant contact: restitution over speed, lined tracks.
SoftContact = TypedDict("SoftContact", {
    "frequency": Hz, "gravity": m_per_s2, "mass": kg, "restitution": number,
    "restitution_speed": m_per_s, "impact_speed": m_per_s, "contact_damping_ratio": number,
    "lining_stiffness": N_per_m, "contact_modulus": Pa, "contact_radius": m,
}, total=False)
# Drive unit of a linear feeder.
LinearDriveUnit = TypedDict("LinearDriveUnit", {
    "frequency": Hz, "gamma": degree, "moving_mass": kg, "base_mass": kg, "load_mass": kg,
    "load_damping": N_s_per_m, "moving_inertia": kg_m2, "base_inertia": kg_m2,
    "spring_angle": degree, "spring_count": number, "spring_width": m, "spring_thickness": m,
    "spring_length": m, "elastic_modulus": Pa, "spring_density": kg_per_m3, "clamp_factor": number,
    "allowable_stress": Pa, "ring_down_frequency": Hz, "damping_ratio": number, "drive_force": N,
    "flux_density": T, "pole_area": m2, "drive_voltage": V, "measured_voltage": V,
    "measured_amplitude": m, "measured_frequency": Hz, "force_exponent": number,
    "force_harmonic": number, "offset_along": m, "offset_upward": m, "spot_along": m,
    "spot_upward": m, "unbalance": kg_m, "air_gap": m, "foot_stiffness": N_per_m,
    "foot_damping": N_s_per_m, "spring_stiffness": N_per_m,
}, total=False)
# Drive unit of a bowl feeder.
BowlDriveUnit = TypedDict("BowlDriveUnit", {
    "frequency": Hz, "gamma": degree, "radius": m, "moving_mass": kg, "base_mass": kg,
    "load_mass": kg, "load_damping": N_s_per_m, "moving_inertia": kg_m2, "base_inertia": kg_m2,
    "spring_radius": m, "spring_angle": degree, "spring_count": number, "spring_width": m,
    "spring_thickness": m, "spring_length": m, "elastic_modulus": Pa, "spring_density": kg_per_m3,
    "clamp_factor": number, "allowable_stress": Pa, "ring_down_frequency": Hz,
    "damping_ratio": number, "drive_force": N, "flux_density": T, "pole_area": m2,
    "drive_voltage": V, "measured_voltage": V, "measured_amplitude": m, "measured_frequency": Hz,
    "measured_radius": m, "force_exponent": number, "force_harmonic": number, "unbalance": kg_m,
    "air_gap": m, "spring_stiffness": N_per_m, "load_radius": m,
}, total=False)
# How a part comes to rest, and when it topples.
RestingPart = TypedDict("RestingPart", {
    "frequency": Hz, "amplitude": m, "peak_to_peak": m, "vertical_amplitude": m,
    "vertical_peak_to_peak": m, "beta": degree, "gamma": degree, "gravity": m_per_s2,
    "friction": number, "friction_static": number, "width": m, "height": m, "length": m,
    "diameter": m, "small_diameter": m, "centre_of_mass": m, "radius_of_gyration": m,
    "sides": number, "aspect": number, "part_density": kg_per_m3,
}, total=False)
# A line of devices that orient parts.
OrientingLine = TypedDict("OrientingLine", {
    "delta": degree, "width": m, "height": m, "length": m, "diameter": m, "small_diameter": m,
    "centre_of_mass": m, "sides": number, "arrival_rate": per_min, "arrival_speed": m_per_s,
    "part_pitch": m, "wanted_aspect": number, "shank_diameter": m, "device_order": number,
    "drop_count_1": number, "drop_count_2": number, "drop_count_3": number, "drop_count_4": number,
    "drop_count_5": number, "drop_count_6": number, "drop_count_7": number, "drop_count_8": number,
    "drop_count_9": number, "wiper_height_1": m, "ledge_width_1": m, "gap_length_1": m,
    "passed_aspect_1": number, "rail_width_1": m, "outlet_capacity_1": per_min,
    "turned_share_1": number, "turn_1": number, "wiper_height_2": m, "ledge_width_2": m,
    "gap_length_2": m, "passed_aspect_2": number, "rail_width_2": m, "outlet_capacity_2": per_min,
    "turned_share_2": number, "turn_2": number, "wiper_height_3": m, "ledge_width_3": m,
    "gap_length_3": m, "passed_aspect_3": number, "rail_width_3": m, "outlet_capacity_3": per_min,
    "turned_share_3": number, "turn_3": number, "wiper_height_4": m, "ledge_width_4": m,
    "gap_length_4": m, "passed_aspect_4": number, "rail_width_4": m, "outlet_capacity_4": per_min,
    "turned_share_4": number, "turn_4": number, "wiper_height_5": m, "ledge_width_5": m,
    "gap_length_5": m, "passed_aspect_5": number, "rail_width_5": m, "outlet_capacity_5": per_min,
    "turned_share_5": number, "turn_5": number, "wiper_height_6": m, "ledge_width_6": m,
    "gap_length_6": m, "passed_aspect_6": number, "rail_width_6": m, "outlet_capacity_6": per_min,
    "turned_share_6": number, "turn_6": number, "lap_time": s,
}, total=False)
_RowOnPlane = TypedDict("_RowOnPlane", {
    "frequency": Hz, "amplitude": m, "peak_to_peak": m, "vertical_amplitude": m,
    "vertical_peak_to_peak": m, "beta": degree, "gamma": degree, "gravity": m_per_s2,
    "friction": number, "friction_static": number, "friction_kinetic": number, "length": m,
    "mass": kg, "restitution": number, "hold_down": m_per_s2, "hold_down_force": N, "part_gap": m,
    "occupancy": number, "parts": number, "part_restitution": number, "row_velocity": m_per_s,
    "inflow": per_min, "lane_length": m, "closed_time": s, "open_time": s, "part_width": m,
    "bend_radius": m, "bend_length": m, "bend_friction": number, "line_push": N_per_m,
    "forward_acceleration": m_per_s2, "return_acceleration": m_per_s2, "row_mass": kg,
    "front_velocity": m_per_s,
}, total=False)
class RowOnPlane(_RowOnPlane, InTime, total=False):
    """Row of equal parts in one lane."""
class Keywords(RectangleIsolated, RectangleOnPlane, RectangleOnTrack, PartOnPlate,
        RectanglePairImpact, CylinderIsolated, CylinderOnPlane, CylinderPairImpact, CylinderRolling,
        SphereOnPlane, RollerOnPlane, DiscOnEdge, ConeOnPlane, SoftContact, LinearDriveUnit,
        BowlDriveUnit, RestingPart, OrientingLine, RowOnPlane, total=False):
    """Keywords of studies that their functions do not name."""
    scene: SceneName | str
    parameters: Mapping[str, Values]
    units: str | Sequence[str]
    title: str
    notes: str
    designs: Mapping[str, Any] | Sequence[Mapping[str, Values]]
