"""Making a study, and carrying it out: what users call with keywords.

Written by `python -m benchmarks.keywords` from `vibrafeed/_functions.py`, and from quantities,
scenes and the models of studies.
"""

from __future__ import annotations

from vibrafeed import _functions

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Any, Literal, Unpack

    import xarray

    from vibrafeed._names import (
        DriveNumbers,
        NoMore,
        Output,
        SimulatedOutput,
        SimulatedScene,
        SweptOutput,
        SweptScene,
    )
    from vibrafeed._values import Bounds, Values
    from vibrafeed.core.intake.keywords import StudyLike
    from vibrafeed.core.motion.drive_error import DriveError
    from vibrafeed.core.study import Study


def study(
    base: StudyLike | None = None,
    /,
    *,
    kind: Literal["sweep", "simulate", "optimise", "sensitivity", "calibrate"] | None = None,
    scene: SweptScene | None = None,
    outputs: Output | Sequence[Output] | None = None,
    variant: Literal["thesis", "derived", "physical"] | str | None = None,
    method: str | None = None,
    criterion: Mapping[str, Any] | None = None,
    variables: Mapping[str, Bounds] | None = None,
    constraints: Sequence[Mapping[str, Any]] | None = None,
    observations: str | Sequence[Mapping[str, Any]] | None = None,
    error: float | str | None = None,
    unknowns: Mapping[str, Mapping[str, Any]] | None = None,
    frequency: Values | None = None,
    amplitude: Values | None = None,
    peak_to_peak: Values | None = None,
    vertical_amplitude: Values | None = None,
    vertical_peak_to_peak: Values | None = None,
    alpha: Values | None = None,
    beta: Values | None = None,
    gamma: Values | None = None,
    delta: Values | None = None,
    yaw: Values | None = None,
    radius: Values | None = None,
    gravity: Values | None = None,
    friction: Values | None = None,
    friction_static: Values | None = None,
    friction_kinetic: Values | None = None,
    wall_friction: Values | None = None,
    width: Values | None = None,
    height: Values | None = None,
    length: Values | None = None,
    diameter: Values | None = None,
    mass: Values | None = None,
    restitution: Values | None = None,
    wall_restitution: Values | None = None,
    speed: Values | None = None,
    distance: Values | None = None,
    time: Values | None = None,
    axis_yaw: Values | None = None,
    spin_rate: Values | None = None,
    yaw_rate: Values | None = None,
    drilling_moment: Values | None = None,
    pitch: Values | None = None,
    pitch_rate: Values | None = None,
    centre_along: Values | None = None,
    centre_height: Values | None = None,
    velocity_along: Values | None = None,
    velocity_upward: Values | None = None,
    position_x_1: Values | None = None,
    position_y_1: Values | None = None,
    angle_1: Values | None = None,
    velocity_x_1: Values | None = None,
    velocity_y_1: Values | None = None,
    spin_1: Values | None = None,
    position_z_1: Values | None = None,
    azimuth_1: Values | None = None,
    elevation_1: Values | None = None,
    velocity_z_1: Values | None = None,
    spin_x_1: Values | None = None,
    spin_y_1: Values | None = None,
    spin_z_1: Values | None = None,
    diameter_1: Values | None = None,
    length_1: Values | None = None,
    width_1: Values | None = None,
    mass_1: Values | None = None,
    position_x_2: Values | None = None,
    position_y_2: Values | None = None,
    angle_2: Values | None = None,
    velocity_x_2: Values | None = None,
    velocity_y_2: Values | None = None,
    spin_2: Values | None = None,
    position_z_2: Values | None = None,
    azimuth_2: Values | None = None,
    elevation_2: Values | None = None,
    velocity_z_2: Values | None = None,
    spin_x_2: Values | None = None,
    spin_y_2: Values | None = None,
    spin_z_2: Values | None = None,
    diameter_2: Values | None = None,
    length_2: Values | None = None,
    width_2: Values | None = None,
    mass_2: Values | None = None,
    contact_tolerance: Values | None = None,
    hold_down: Values | None = None,
    hold_down_force: Values | None = None,
    part_gap: Values | None = None,
    occupancy: Values | None = None,
    duration: Values | None = None,
    drop_height: Values | None = None,
    moving_mass: Values | None = None,
    base_mass: Values | None = None,
    load_mass: Values | None = None,
    load_damping: Values | None = None,
    conveyed_mass: Values | None = None,
    moving_inertia: Values | None = None,
    base_inertia: Values | None = None,
    spring_radius: Values | None = None,
    spring_angle: Values | None = None,
    spring_count: Values | None = None,
    spring_width: Values | None = None,
    spring_thickness: Values | None = None,
    spring_length: Values | None = None,
    elastic_modulus: Values | None = None,
    spring_density: Values | None = None,
    clamp_factor: Values | None = None,
    allowable_stress: Values | None = None,
    ring_down_frequency: Values | None = None,
    damping_ratio: Values | None = None,
    drive_force: Values | None = None,
    flux_density: Values | None = None,
    pole_area: Values | None = None,
    force_harmonic: Values | None = None,
    offset_along: Values | None = None,
    offset_upward: Values | None = None,
    spot_along: Values | None = None,
    spot_upward: Values | None = None,
    unbalance: Values | None = None,
    air_gap: Values | None = None,
    foot_stiffness: Values | None = None,
    foot_damping: Values | None = None,
    spring_stiffness: Values | None = None,
    track_fraction: Values | None = None,
    start_radius: Values | None = None,
    load_radius: Values | None = None,
    load_fraction: Values | None = None,
    small_diameter: Values | None = None,
    centre_of_mass: Values | None = None,
    radius_of_gyration: Values | None = None,
    sides: Values | None = None,
    arrival_rate: Values | None = None,
    arrival_speed: Values | None = None,
    part_pitch: Values | None = None,
    wanted_aspect: Values | None = None,
    shank_diameter: Values | None = None,
    device_order: Values | None = None,
    drop_count_1: Values | None = None,
    drop_count_2: Values | None = None,
    drop_count_3: Values | None = None,
    wiper_height_1: Values | None = None,
    ledge_width_1: Values | None = None,
    gap_length_1: Values | None = None,
    passed_aspect_1: Values | None = None,
    rail_width_1: Values | None = None,
    outlet_capacity_1: Values | None = None,
    turned_share_1: Values | None = None,
    turn_1: Values | None = None,
    wiper_height_2: Values | None = None,
    ledge_width_2: Values | None = None,
    gap_length_2: Values | None = None,
    passed_aspect_2: Values | None = None,
    rail_width_2: Values | None = None,
    outlet_capacity_2: Values | None = None,
    turned_share_2: Values | None = None,
    turn_2: Values | None = None,
    wiper_height_3: Values | None = None,
    ledge_width_3: Values | None = None,
    gap_length_3: Values | None = None,
    passed_aspect_3: Values | None = None,
    rail_width_3: Values | None = None,
    outlet_capacity_3: Values | None = None,
    turned_share_3: Values | None = None,
    turn_3: Values | None = None,
    wiper_height_4: Values | None = None,
    ledge_width_4: Values | None = None,
    gap_length_4: Values | None = None,
    passed_aspect_4: Values | None = None,
    rail_width_4: Values | None = None,
    outlet_capacity_4: Values | None = None,
    turned_share_4: Values | None = None,
    turn_4: Values | None = None,
    wiper_height_5: Values | None = None,
    ledge_width_5: Values | None = None,
    gap_length_5: Values | None = None,
    passed_aspect_5: Values | None = None,
    rail_width_5: Values | None = None,
    outlet_capacity_5: Values | None = None,
    turned_share_5: Values | None = None,
    turn_5: Values | None = None,
    wiper_height_6: Values | None = None,
    ledge_width_6: Values | None = None,
    gap_length_6: Values | None = None,
    passed_aspect_6: Values | None = None,
    rail_width_6: Values | None = None,
    outlet_capacity_6: Values | None = None,
    turned_share_6: Values | None = None,
    turn_6: Values | None = None,
    lap_time: Values | None = None,
    line_yield: Values | None = None,
    line_purity: Values | None = None,
    parts: Values | None = None,
    part_restitution: Values | None = None,
    friction_spread: Values | None = None,
    friction_seed: Values | None = None,
    track_stop_gap: Values | None = None,
    fixed_stop_gap: Values | None = None,
    row_velocity: Values | None = None,
    inflow: Values | None = None,
    lane_length: Values | None = None,
    closed_time: Values | None = None,
    open_time: Values | None = None,
    part_width: Values | None = None,
    bend_radius: Values | None = None,
    bend_length: Values | None = None,
    bend_friction: Values | None = None,
    line_push: Values | None = None,
    forward_acceleration: Values | None = None,
    return_acceleration: Values | None = None,
    row_mass: Values | None = None,
    front_velocity: Values | None = None,
    inner_diameter: Values | None = None,
    rolling_factor: Values | None = None,
    restitution_speed: Values | None = None,
    impact_speed: Values | None = None,
    contact_damping_ratio: Values | None = None,
    lining_stiffness: Values | None = None,
    contact_modulus: Values | None = None,
    contact_radius: Values | None = None,
    rolling_resistance: Values | None = None,
    uncertain: Mapping[str, Mapping[str, Any]] | None = None,
    analyses: Sequence[Literal["distribution", "sobol", "morris", "budget"]] | None = None,
    demands: Sequence[Mapping[str, Any]] | None = None,
    quantiles: Sequence[float] | None = None,
    samples: int | None = None,
    seed: int | None = None,
    robust: Literal["worst", "mean", "quantile"] | None = None,
    quantile: float | None = None,
    floor_contact: bool | None = None,
    wall_contact: bool | None = None,
    sensitivities: bool | Sequence[str] | None = None,
    offsets: Mapping[str, Mapping[str, Any]] | None = None,
    factors: Mapping[str, Mapping[str, Any]] | None = None,
    candidates: Mapping[str, Values] | None = None,
    discrepancy: bool | None = None,
    outlier_probability: float | None = None,
    points: int | None = None,
    trajectory: int | Sequence[float] | None = None,
    drive: Mapping[str, Any] | None = None,
    tolerance: float | None = None,
    max_periods: int | None = None,
    steps_per_period: int | None = None,
    slip_speed: float | None = None,
    contact_stiffness: float | None = None,
    precision: Literal["double", "single"] | None = None,
    reduce: Mapping[str, Any] | None = None,
    verify: int | None = None,
    units: str | Sequence[str] | None = None,
    title: str | None = None,
    notes: str | None = None,
    parameters: Mapping[str, Values] | None = None,
    **numbered: Unpack[DriveNumbers],
) -> Study:
    """Return the study that a mapping or keywords describe; `kind` says which one it is.

    Its values are right by themselves. Whether they make a whole is seen when it is carried out.

    Parameters
    ----------
    base : mapping, study or path, optional
        The study that the keywords add to.
    **keywords
        Keys of the study and parameters: those of `sweep`, `simulate` and `optimise`.

    Raises
    ------
    StudyError
        With every problem.

    Examples
    --------
    >>> drive = vibrafeed.study(
    ...     kind="sweep", scene="rectangle-on-plane", outputs=["acceleration_x"],
    ...     frequency=range(20, 121), amplitude="0.35 mm", beta=[15, 30], friction=0.3,
    ... )
    >>> dict(vibrafeed.sweep(drive, beta=20).sizes)
    {'frequency': 101}
    """
    keywords = _functions.said(locals())
    return _functions.study(base, **keywords)


def sweep(
    study: StudyLike | None = None,
    /,
    *,
    scene: SweptScene | None = None,
    outputs: SweptOutput | Sequence[SweptOutput] | None = None,
    variant: Literal["thesis", "derived", "physical"] | str | None = None,
    frequency: Values | None = None,
    amplitude: Values | None = None,
    peak_to_peak: Values | None = None,
    vertical_amplitude: Values | None = None,
    vertical_peak_to_peak: Values | None = None,
    alpha: Values | None = None,
    beta: Values | None = None,
    gamma: Values | None = None,
    delta: Values | None = None,
    yaw: Values | None = None,
    radius: Values | None = None,
    gravity: Values | None = None,
    friction: Values | None = None,
    friction_static: Values | None = None,
    friction_kinetic: Values | None = None,
    wall_friction: Values | None = None,
    width: Values | None = None,
    height: Values | None = None,
    length: Values | None = None,
    diameter: Values | None = None,
    mass: Values | None = None,
    restitution: Values | None = None,
    speed: Values | None = None,
    distance: Values | None = None,
    time: Values | None = None,
    axis_yaw: Values | None = None,
    spin_rate: Values | None = None,
    yaw_rate: Values | None = None,
    drilling_moment: Values | None = None,
    pitch: Values | None = None,
    pitch_rate: Values | None = None,
    centre_along: Values | None = None,
    centre_height: Values | None = None,
    velocity_along: Values | None = None,
    velocity_upward: Values | None = None,
    position_x_1: Values | None = None,
    position_y_1: Values | None = None,
    angle_1: Values | None = None,
    velocity_x_1: Values | None = None,
    velocity_y_1: Values | None = None,
    spin_1: Values | None = None,
    position_z_1: Values | None = None,
    azimuth_1: Values | None = None,
    elevation_1: Values | None = None,
    velocity_z_1: Values | None = None,
    spin_x_1: Values | None = None,
    spin_y_1: Values | None = None,
    spin_z_1: Values | None = None,
    diameter_1: Values | None = None,
    length_1: Values | None = None,
    width_1: Values | None = None,
    mass_1: Values | None = None,
    position_x_2: Values | None = None,
    position_y_2: Values | None = None,
    angle_2: Values | None = None,
    velocity_x_2: Values | None = None,
    velocity_y_2: Values | None = None,
    spin_2: Values | None = None,
    position_z_2: Values | None = None,
    azimuth_2: Values | None = None,
    elevation_2: Values | None = None,
    velocity_z_2: Values | None = None,
    spin_x_2: Values | None = None,
    spin_y_2: Values | None = None,
    spin_z_2: Values | None = None,
    diameter_2: Values | None = None,
    length_2: Values | None = None,
    width_2: Values | None = None,
    mass_2: Values | None = None,
    contact_tolerance: Values | None = None,
    part_gap: Values | None = None,
    moving_mass: Values | None = None,
    base_mass: Values | None = None,
    load_mass: Values | None = None,
    load_damping: Values | None = None,
    moving_inertia: Values | None = None,
    base_inertia: Values | None = None,
    spring_radius: Values | None = None,
    spring_angle: Values | None = None,
    spring_count: Values | None = None,
    spring_width: Values | None = None,
    spring_thickness: Values | None = None,
    spring_length: Values | None = None,
    elastic_modulus: Values | None = None,
    spring_density: Values | None = None,
    clamp_factor: Values | None = None,
    allowable_stress: Values | None = None,
    ring_down_frequency: Values | None = None,
    damping_ratio: Values | None = None,
    drive_force: Values | None = None,
    flux_density: Values | None = None,
    pole_area: Values | None = None,
    force_harmonic: Values | None = None,
    offset_along: Values | None = None,
    offset_upward: Values | None = None,
    spot_along: Values | None = None,
    spot_upward: Values | None = None,
    unbalance: Values | None = None,
    air_gap: Values | None = None,
    foot_stiffness: Values | None = None,
    foot_damping: Values | None = None,
    spring_stiffness: Values | None = None,
    load_radius: Values | None = None,
    small_diameter: Values | None = None,
    centre_of_mass: Values | None = None,
    radius_of_gyration: Values | None = None,
    sides: Values | None = None,
    arrival_rate: Values | None = None,
    arrival_speed: Values | None = None,
    part_pitch: Values | None = None,
    wanted_aspect: Values | None = None,
    shank_diameter: Values | None = None,
    device_order: Values | None = None,
    drop_count_1: Values | None = None,
    drop_count_2: Values | None = None,
    drop_count_3: Values | None = None,
    wiper_height_1: Values | None = None,
    ledge_width_1: Values | None = None,
    gap_length_1: Values | None = None,
    passed_aspect_1: Values | None = None,
    rail_width_1: Values | None = None,
    outlet_capacity_1: Values | None = None,
    turned_share_1: Values | None = None,
    turn_1: Values | None = None,
    wiper_height_2: Values | None = None,
    ledge_width_2: Values | None = None,
    gap_length_2: Values | None = None,
    passed_aspect_2: Values | None = None,
    rail_width_2: Values | None = None,
    outlet_capacity_2: Values | None = None,
    turned_share_2: Values | None = None,
    turn_2: Values | None = None,
    wiper_height_3: Values | None = None,
    ledge_width_3: Values | None = None,
    gap_length_3: Values | None = None,
    passed_aspect_3: Values | None = None,
    rail_width_3: Values | None = None,
    outlet_capacity_3: Values | None = None,
    turned_share_3: Values | None = None,
    turn_3: Values | None = None,
    wiper_height_4: Values | None = None,
    ledge_width_4: Values | None = None,
    gap_length_4: Values | None = None,
    passed_aspect_4: Values | None = None,
    rail_width_4: Values | None = None,
    outlet_capacity_4: Values | None = None,
    turned_share_4: Values | None = None,
    turn_4: Values | None = None,
    wiper_height_5: Values | None = None,
    ledge_width_5: Values | None = None,
    gap_length_5: Values | None = None,
    passed_aspect_5: Values | None = None,
    rail_width_5: Values | None = None,
    outlet_capacity_5: Values | None = None,
    turned_share_5: Values | None = None,
    turn_5: Values | None = None,
    wiper_height_6: Values | None = None,
    ledge_width_6: Values | None = None,
    gap_length_6: Values | None = None,
    passed_aspect_6: Values | None = None,
    rail_width_6: Values | None = None,
    outlet_capacity_6: Values | None = None,
    turned_share_6: Values | None = None,
    turn_6: Values | None = None,
    lap_time: Values | None = None,
    parts: Values | None = None,
    row_velocity: Values | None = None,
    inflow: Values | None = None,
    lane_length: Values | None = None,
    closed_time: Values | None = None,
    open_time: Values | None = None,
    part_width: Values | None = None,
    bend_radius: Values | None = None,
    bend_length: Values | None = None,
    bend_friction: Values | None = None,
    line_push: Values | None = None,
    forward_acceleration: Values | None = None,
    return_acceleration: Values | None = None,
    row_mass: Values | None = None,
    front_velocity: Values | None = None,
    inner_diameter: Values | None = None,
    rolling_factor: Values | None = None,
    restitution_speed: Values | None = None,
    impact_speed: Values | None = None,
    contact_damping_ratio: Values | None = None,
    lining_stiffness: Values | None = None,
    contact_modulus: Values | None = None,
    contact_radius: Values | None = None,
    sensitivities: bool | Sequence[str] | None = None,
    precision: Literal["double", "single"] | None = None,
    reduce: Mapping[str, Any] | None = None,
    verify: int | None = None,
    units: str | Sequence[str] | None = None,
    title: str | None = None,
    notes: str | None = None,
    parameters: Mapping[str, Values] | None = None,
    **others: Unpack[NoMore],
) -> xarray.Dataset:
    """Return closed-form quantities of one scene over a grid of parameters.

    They are a snapshot at the drive's peak, with the `regime` that says where they hold.

    *Values* are a number in the unit that is named, text with a unit such as ``"0.25 mm"``, or
    several of either, which become an axis of the dataset: a list, a range, an array, or a mapping
    such as ``{"start": "20 Hz", "stop": "120 Hz", "num": 101}``. ``None`` is a keyword left out.

    Parameters
    ----------
    study : Study, mapping or path, optional
        The study, which keywords add to; its `kind` is ``"sweep"``, and may be left out.
    scene : str, optional
        Name of a scene; `vibrafeed scenes` lists them.
    outputs : str or sequence of str, optional
        Names of the outputs.
    variant : {"thesis", "derived", "physical"}, optional
        thesis (as printed), derived (errors corrected) or physical; the scene's default where left
        out.
    frequency : values, optional
        Drive frequency. In Hz, 0 or more, for example "50 Hz" or "3000 rpm" or "3000 vpm".
    amplitude : values, optional
        Drive amplitude, zero to peak, along the drive direction. In m, 0 or more, for example "0.5
        mm".
    peak_to_peak : values, optional
        Twice the drive amplitude. In m, 0 or more, for example "1 mm".
    vertical_amplitude : values, optional
        Amplitude of the drive's part normal to the floor, zero to peak: A0 sin(beta). In m, 0 or
        more, for example "0.2 mm".
    vertical_peak_to_peak : values, optional
        Twice the vertical amplitude. In m, 0 or more, for example "0.4 mm".
    alpha : values, optional
        Azimuth of the drive in the floor plane, from the track (+x) towards +y. In degrees, from
        -180 to 180, for example "15 deg".
    beta : values, optional
        Elevation of the drive above the floor plane. In degrees, from -180 to 180, for example "20
        deg".
    gamma : values, optional
        Climb angle of the track; +x goes uphill. In degrees, from -90 to 90, for example "3 deg".
    delta : values, optional
        Lean of the track; the part leans on the wall. In degrees, from -90 to 90, for example "2
        deg".
    yaw : values, optional
        Turn of the part's axes about the floor normal. In degrees, from -180 to 180, for example
        "30 deg".
    radius : values, optional
        Radius of the bowl's track wall. In m, above 0, for example "0.3 m".
    gravity : values, optional
        Acceleration of gravity. In m s-2, above 0, for example "9.80665 m/s^2".
    friction : values, optional
        Coulomb friction coefficient, static and kinetic alike. 0 or more, for example 0.3.
    friction_static : values, optional
        Coulomb friction coefficient at rest. 0 or more, for example 0.3.
    friction_kinetic : values, optional
        Coulomb friction coefficient in sliding. 0 or more, for example 0.3.
    wall_friction : values, optional
        Coulomb friction coefficient at the wall of the track; the floor's unless given. 0 or more,
        for example 0.3.
    width : values, optional
        Width of the rectangular part, across. In m, above 0, for example "10 mm".
    height : values, optional
        Height of the rectangular part. In m, above 0, for example "1.5 mm".
    length : values, optional
        Length of the part, along the track. In m, above 0, for example "50 mm".
    diameter : values, optional
        Diameter of the cylindrical part. In m, above 0, for example "8 mm".
    mass : values, optional
        Mass of the part. In kg, above 0, for example "5 g".
    restitution : values, optional
        Coefficient of restitution: 0 for no rebound, 1 for full rebound. From 0 to 1, for example
        0.5.
    speed : values, optional
        Speed of the part along the track at the start. In m s-1, 0 or more, for example "0.1 m/s".
    distance : values, optional
        Distance over which the drive is taken to act; the source gives no value for it. In m, 0 or
        more, for example "0.2 mm".
    time : values, optional
        Time since the start, with the drive held at its peak. In s, 0 or more, for example "20 ms".
    axis_yaw : values, optional
        Turn of the rolling cylinder's axis in the floor plane as chapter 4 counts it: from +x
        towards -y, clockwise seen from above. In degrees, from -180 to 180, for example "30 deg".
    spin_rate : values, optional
        Angular velocity of the rolling cylinder about its axis; positive rolls along +eta. In rad
        s-1, for example "40 rad/s" or "400 rpm".
    yaw_rate : values, optional
        Rate of the cylinder's yaw, in the sense of axis_yaw. In rad s-1, for example "2 rad/s".
    drilling_moment : values, optional
        Moment of all floor friction about the vertical through the centre, in the sense of
        axis_yaw. In N m, for example "0.1 mN m".
    pitch : values, optional
        Turn of the part in its plane of motion, clockwise: its right corner dips. In degrees, from
        -180 to 180, for example "20 deg".
    pitch_rate : values, optional
        Rate of the pitch, clockwise. In rad s-1, for example "2 rad/s" or "-90 deg/s".
    centre_along : values, optional
        Position of the part's centre along the plane. In m, for example "12 mm".
    centre_height : values, optional
        Height of the part's centre above the plane. In m, for example "8 mm".
    velocity_along : values, optional
        Velocity of the part's centre along the plane, to the right. In m s-1, for example "0.1
        m/s".
    velocity_upward : values, optional
        Velocity of the part's centre off the plane. In m s-1, for example "-0.1 m/s".
    position_x_1 : values, optional
        Centre of body 1, x. In m, for example "5 mm".
    position_y_1 : values, optional
        Centre of body 1, y. In m, for example "5 mm".
    angle_1 : values, optional
        Angle of the length of body 1, from +x towards +y. In degrees, for example "30 deg".
    velocity_x_1 : values, optional
        Velocity of body 1 before the impact, x. In m s-1, for example "0.2 m/s".
    velocity_y_1 : values, optional
        Velocity of body 1 before the impact, y. In m s-1, for example "0.2 m/s".
    spin_1 : values, optional
        Angular velocity of body 1 before the impact, from +x towards +y. In rad s-1, for example "3
        rad/s".
    position_z_1 : values, optional
        Centre of body 1, z. In m, for example "5 mm".
    azimuth_1 : values, optional
        Angle of the axis of body 1 in the floor plane, from +x towards +y. In degrees, for example
        "30 deg".
    elevation_1 : values, optional
        Angle of the axis of body 1 above the floor plane. In degrees, for example "10 deg".
    velocity_z_1 : values, optional
        Velocity of body 1 before the impact, z. In m s-1, for example "0.2 m/s".
    spin_x_1 : values, optional
        Angular velocity of body 1 before the impact, x. In rad s-1, for example "3 rad/s".
    spin_y_1 : values, optional
        Angular velocity of body 1 before the impact, y. In rad s-1, for example "3 rad/s".
    spin_z_1 : values, optional
        Angular velocity of body 1 before the impact, z. In rad s-1, for example "3 rad/s".
    diameter_1 : values, optional
        Diameter of body 1. In m, above 0, for example "8 mm".
    length_1 : values, optional
        Length of body 1. In m, above 0, for example "20 mm".
    width_1 : values, optional
        Width of body 1. In m, above 0, for example "10 mm".
    mass_1 : values, optional
        Mass of body 1. In kg, above 0, for example "5 g".
    position_x_2 : values, optional
        Centre of body 2, x. In m, for example "5 mm".
    position_y_2 : values, optional
        Centre of body 2, y. In m, for example "5 mm".
    angle_2 : values, optional
        Angle of the length of body 2, from +x towards +y. In degrees, for example "30 deg".
    velocity_x_2 : values, optional
        Velocity of body 2 before the impact, x. In m s-1, for example "0.2 m/s".
    velocity_y_2 : values, optional
        Velocity of body 2 before the impact, y. In m s-1, for example "0.2 m/s".
    spin_2 : values, optional
        Angular velocity of body 2 before the impact, from +x towards +y. In rad s-1, for example "3
        rad/s".
    position_z_2 : values, optional
        Centre of body 2, z. In m, for example "5 mm".
    azimuth_2 : values, optional
        Angle of the axis of body 2 in the floor plane, from +x towards +y. In degrees, for example
        "30 deg".
    elevation_2 : values, optional
        Angle of the axis of body 2 above the floor plane. In degrees, for example "10 deg".
    velocity_z_2 : values, optional
        Velocity of body 2 before the impact, z. In m s-1, for example "0.2 m/s".
    spin_x_2 : values, optional
        Angular velocity of body 2 before the impact, x. In rad s-1, for example "3 rad/s".
    spin_y_2 : values, optional
        Angular velocity of body 2 before the impact, y. In rad s-1, for example "3 rad/s".
    spin_z_2 : values, optional
        Angular velocity of body 2 before the impact, z. In rad s-1, for example "3 rad/s".
    diameter_2 : values, optional
        Diameter of body 2. In m, above 0, for example "8 mm".
    length_2 : values, optional
        Length of body 2. In m, above 0, for example "20 mm".
    width_2 : values, optional
        Width of body 2. In m, above 0, for example "10 mm".
    mass_2 : values, optional
        Mass of body 2. In kg, above 0, for example "5 g".
    contact_tolerance : values, optional
        Largest gap or overlap that counts as touching, as a share of the bodies' size, the sum of
        their half diagonals. 1 lets the impact happen as the bodies are placed. 0 or more, for
        example "1e-6".
    part_gap : values, optional
        Free length between two parts on the track. In m, 0 or more, for example "5 mm".
    moving_mass : values, optional
        Mass of trough or bowl, with what is fixed to it. In kg, above 0, for example "10 kg".
    base_mass : values, optional
        Mass of the base, or counter-mass. In kg, above 0, for example "30 kg".
    load_mass : values, optional
        Mass of parts that move with the track, neither sliding nor hopping. In kg, 0 or more, for
        example "0.5 kg".
    load_damping : values, optional
        Damping between track and ground by parts that slide and hop. In N s m-1, 0 or more, for
        example "40 N s/m".
    moving_inertia : values, optional
        Moment of inertia of the bowl about its axis. In kg m2, above 0, for example "0.25 kg m^2".
    base_inertia : values, optional
        Moment of inertia of the base about the same axis. In kg m2, above 0, for example "0.9 kg
        m^2".
    spring_radius : values, optional
        Radius from the bowl's axis to the leaf springs. In m, above 0, for example "150 mm".
    spring_angle : values, optional
        Tilt of the leaf springs from the vertical; equals the drive's angle of a linear unit. In
        degrees, from -89 to 89, for example "20 deg".
    spring_count : values, optional
        Number of leaf springs in all packs, separated by spacers. Above 0, for example 8.
    spring_width : values, optional
        Width of a leaf spring. In m, above 0, for example "40 mm".
    spring_thickness : values, optional
        Thickness of a leaf spring. In m, above 0, for example "3 mm".
    spring_length : values, optional
        Length of a leaf spring between its clamps. In m, above 0, for example "100 mm".
    elastic_modulus : values, optional
        Elastic modulus of the leaf springs: 206 GPa for spring steel. In Pa, above 0, for example
        "206 GPa".
    spring_density : values, optional
        Density of the leaf springs: 7850 kg/m^3 for spring steel. In kg m-3, above 0, for example
        "7850 kg/m^3".
    clamp_factor : values, optional
        Stiffness of the leaf springs relative to rigid clamps. Above 0, for example 0.9.
    allowable_stress : values, optional
        Bending stress that the leaf springs endure permanently. In Pa, above 0, for example "250
        MPa".
    ring_down_frequency : values, optional
        Frequency at which the empty unit vibrates freely after a knock. In Hz, above 0, for example
        "53 Hz".
    damping_ratio : values, optional
        Logarithmic decrement of the ring-down over 2 pi. Above 0, for example 0.02.
    drive_force : values, optional
        Amplitude of the force between both masses, at the drive's frequency; a magnet's follows
        from flux_density and pole_area, an unbalance's from unbalance. In N, above 0, for example
        "100 N".
    flux_density : values, optional
        Peak of the flux density in the magnet's gap. In T, above 0, for example "0.5 T".
    pole_area : values, optional
        Area of all poles of the magnet that pull. In m2, above 0, for example "12 cm^2".
    force_harmonic : values, optional
        Second harmonic over the first: 0.25 of a magnet on a half wave that pulls the track back
        and down, -0.25 of one that pulls it forward and up, 0 on a full wave. From -1 to 1, for
        example 0.25.
    offset_along : values, optional
        Moving mass centre ahead of the base's. In m, for example "0 mm".
    offset_upward : values, optional
        Moving mass centre above the base's. In m, for example "0 mm".
    spot_along : values, optional
        Place on the track ahead of the mass centre. In m, for example "0 mm".
    spot_upward : values, optional
        Place on the track above the mass centre. In m, for example "0 mm".
    unbalance : values, optional
        Mass of an unbalance times its radius. In kg m, above 0, for example "0.002 kg m".
    air_gap : values, optional
        Air gap of the magnet at rest, along the stroke. In m, above 0, for example "2 mm".
    foot_stiffness : values, optional
        Stiffness of all feet together; 0 if the base is free. In N m-1, 0 or more, for example
        "50000 N/m".
    foot_damping : values, optional
        Damping of all feet together. In N s m-1, 0 or more, for example "100 N s/m".
    spring_stiffness : values, optional
        Stiffness of all leaf springs along the stroke; computed from their sizes by default. In N
        m-1, above 0, for example "1000 N/mm".
    load_radius : values, optional
        Radius at which the load lies; by default that of the part. In m, above 0, for example "180
        mm".
    small_diameter : values, optional
        Diameter of the end opposite to that of diameter; 0 of a full cone. In m, 0 or more, for
        example "12 mm".
    centre_of_mass : values, optional
        Distance of the centre of mass from the end of diameter. In m, above 0, for example "8 mm".
    radius_of_gyration : values, optional
        Root of moment of inertia over mass, about a line across the part through its centre. In m,
        above 0, for example "7 mm".
    sides : values, optional
        Sides of a regular prism; diameter is that of the circle through its corners. 3 or more, for
        example 6.
    arrival_rate : values, optional
        Parts a minute that arrive at the first device. In min-1, above 0, for example "300 1/min".
    arrival_speed : values, optional
        Conveying velocity of the parts before the first device. In m s-1, above 0, for example "60
        mm/s".
    part_pitch : values, optional
        Distance from part to part in a row. In m, above 0, for example "22 mm".
    wanted_aspect : values, optional
        Number of the aspect in which parts are to leave. From 1 to 3, for example 1.
    shank_diameter : values, optional
        Diameter of the shank of a part with a head; `diameter` is that of the head. In m, above 0,
        for example "4 mm".
    device_order : values, optional
        Number of the order of the devices, in lexical order: 1 is the order of their positions, the
        last one is backwards. From 1 to 720, for example 1.
    drop_count_1 : values, optional
        Parts of a drop test that came to rest in aspect 1. 0 or more, for example 129.
    drop_count_2 : values, optional
        Parts of a drop test that came to rest in aspect 2. 0 or more, for example 129.
    drop_count_3 : values, optional
        Parts of a drop test that came to rest in aspect 3. 0 or more, for example 129.
    wiper_height_1 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_1 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_1 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_1 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_1 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_1 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_1 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_1 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_2 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_2 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_2 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_2 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_2 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_2 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_2 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_2 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_3 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_3 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_3 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_3 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_3 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_3 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_3 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_3 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_4 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_4 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_4 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_4 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_4 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_4 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_4 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_4 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_5 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_5 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_5 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_5 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_5 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_5 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_5 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_5 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_6 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_6 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_6 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_6 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_6 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_6 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_6 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_6 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    lap_time : values, optional
        Time from the bowl to the first device and back. In s, above 0, for example "40 s".
    parts : values, optional
        Number of parts in the row. From 2 to 64, for example 8.
    row_velocity : values, optional
        Mean velocity of the parts on the free lane: measured, or of a study of their motion. In m
        s-1, above 0, for example "80 mm/s".
    inflow : values, optional
        Parts a minute that come onto the lane. In min-1, 0 or more, for example "120 1/min".
    lane_length : values, optional
        Length of the lane. In m, above 0, for example "500 mm".
    closed_time : values, optional
        Time for which the escapement is closed. In s, 0 or more, for example "200 ms".
    open_time : values, optional
        Minimum time for which the escapement is open. In s, 0 or more, for example "100 ms".
    part_width : values, optional
        Width of a part, across the lane. In m, above 0, for example "10 mm".
    bend_radius : values, optional
        Radius of the bend's outer wall. In m, above 0, for example "200 mm".
    bend_length : values, optional
        Length of the part of a row inside the bend. In m, above 0, for example "200 mm".
    bend_friction : values, optional
        Coefficient of friction at the wall of the bend. Above 0, for example 0.3.
    line_push : values, optional
        Force per length with which the track pushes the row. In N m-1, above 0, for example "1
        N/m".
    forward_acceleration : values, optional
        Acceleration of the track forwards, which carries parts. In m s-2, above 0, for example "2
        m/s^2".
    return_acceleration : values, optional
        Acceleration of the track backwards, under the parts. In m s-2, above 0, for example "2
        m/s^2".
    row_mass : values, optional
        Mass of all parts of the row. In kg, above 0, for example "100 g".
    front_velocity : values, optional
        Mean velocity of the parts in front. In m s-1, 0 or more, for example "60 mm/s".
    inner_diameter : values, optional
        Diameter of the hole of a tube or ring, or of the hollow of a ball; the part's own of a hoop
        or a thin shell. In m, 0 or more, for example "6 mm".
    rolling_factor : values, optional
        Ratio m r^2/I about the rolling axis: 5/2 of a ball, 3/2 of a thin shell, 2 of a cylinder or
        disc, 1 of a hoop; follows from the diameters unless given. Above 0, for example 2.5.
    restitution_speed : values, optional
        Speed of impact at which the restitution was measured. In m s-1, above 0, for example "0.1
        m/s".
    impact_speed : values, optional
        Speed of approach normal to the contact. In m s-1, above 0, for example "0.2 m/s".
    contact_damping_ratio : values, optional
        Damping ratio of the spring and damper of a contact that never pulls. 0 or more, for example
        0.2.
    lining_stiffness : values, optional
        Force over depth of a part on a lined track, such as brush or urethane. In N m-1, above 0,
        for example "20 N/mm".
    contact_modulus : values, optional
        Reduced modulus of both materials: 1/E is the sum of (1 - nu^2)/E of each. In Pa, above 0,
        for example "115 GPa".
    contact_radius : values, optional
        Radius of a ball, or of a rounded part where it strikes. In m, above 0, for example "4 mm".
    sensitivities : bool or sequence of str, optional
        Also give the derivative of each output by these parameters, and its elasticity d
        ln(output)/d ln(parameter): true for all that the study gives, or a list of names.
    precision : {"double", "single"}, optional
        double (64-bit floats, the default) or single: values are computed in double and stored in
        32 bits, half the bytes, each rounded once more by at most 6e-8 of itself.
    reduce : mapping, optional
        Statistics over some axes instead of all cells: docs/reduce.md.
    verify : int, optional
        Number of random cells to evaluate again, with 50 digits or by another method; the result
        states the worst of them.
    units : str or sequence of str, optional
        Units that screens and pictures show: trade (the default), si, or units such as m/min, each
        for its kind. Files hold SI.
    title : str, optional
        Title of the dataset.
    notes : str, optional
        Notes that are stored in the dataset.
    parameters : mapping of str to values, optional
        Fixed or ranged parameters.

    Returns
    -------
    xarray.Dataset
        The outputs, each with the axes that it depends on, units and equation numbers.

    Raises
    ------
    StudyError
        With every problem, also where it is a study of another kind.

    Examples
    --------
    >>> import numpy as np
    >>> dataset = vibrafeed.sweep(
    ...     scene="rectangle-on-plane", outputs=["acceleration_x"], frequency="50 Hz",
    ...     amplitude="0.25 mm", beta=np.linspace(0, 40, 9), friction=0.5,
    ... )
    >>> dataset.acceleration_x.dims, dataset.acceleration_x.units
    (('beta',), 'm s-2')
    """
    keywords = _functions.said(locals())
    return _functions.sweep(study, **keywords)


def simulate(
    study: StudyLike | None = None,
    /,
    *,
    scene: SimulatedScene | None = None,
    outputs: SimulatedOutput | Sequence[SimulatedOutput] | None = None,
    method: str | None = None,
    frequency: Values | None = None,
    amplitude: Values | None = None,
    peak_to_peak: Values | None = None,
    vertical_amplitude: Values | None = None,
    vertical_peak_to_peak: Values | None = None,
    alpha: Values | None = None,
    beta: Values | None = None,
    gamma: Values | None = None,
    delta: Values | None = None,
    radius: Values | None = None,
    gravity: Values | None = None,
    friction: Values | None = None,
    friction_static: Values | None = None,
    friction_kinetic: Values | None = None,
    wall_friction: Values | None = None,
    height: Values | None = None,
    length: Values | None = None,
    diameter: Values | None = None,
    mass: Values | None = None,
    restitution: Values | None = None,
    wall_restitution: Values | None = None,
    pitch: Values | None = None,
    pitch_rate: Values | None = None,
    velocity_along: Values | None = None,
    velocity_upward: Values | None = None,
    hold_down: Values | None = None,
    hold_down_force: Values | None = None,
    part_gap: Values | None = None,
    occupancy: Values | None = None,
    duration: Values | None = None,
    drop_height: Values | None = None,
    moving_mass: Values | None = None,
    base_mass: Values | None = None,
    load_mass: Values | None = None,
    load_damping: Values | None = None,
    conveyed_mass: Values | None = None,
    moving_inertia: Values | None = None,
    base_inertia: Values | None = None,
    spring_radius: Values | None = None,
    spring_angle: Values | None = None,
    spring_count: Values | None = None,
    spring_width: Values | None = None,
    spring_thickness: Values | None = None,
    spring_length: Values | None = None,
    elastic_modulus: Values | None = None,
    spring_density: Values | None = None,
    clamp_factor: Values | None = None,
    allowable_stress: Values | None = None,
    ring_down_frequency: Values | None = None,
    damping_ratio: Values | None = None,
    drive_force: Values | None = None,
    flux_density: Values | None = None,
    pole_area: Values | None = None,
    force_harmonic: Values | None = None,
    offset_along: Values | None = None,
    offset_upward: Values | None = None,
    spot_along: Values | None = None,
    spot_upward: Values | None = None,
    unbalance: Values | None = None,
    air_gap: Values | None = None,
    foot_stiffness: Values | None = None,
    foot_damping: Values | None = None,
    spring_stiffness: Values | None = None,
    track_fraction: Values | None = None,
    start_radius: Values | None = None,
    load_radius: Values | None = None,
    load_fraction: Values | None = None,
    line_yield: Values | None = None,
    line_purity: Values | None = None,
    parts: Values | None = None,
    part_restitution: Values | None = None,
    friction_spread: Values | None = None,
    friction_seed: Values | None = None,
    track_stop_gap: Values | None = None,
    fixed_stop_gap: Values | None = None,
    inner_diameter: Values | None = None,
    rolling_factor: Values | None = None,
    rolling_resistance: Values | None = None,
    sensitivities: bool | Sequence[str] | None = None,
    trajectory: int | Sequence[float] | None = None,
    drive: Mapping[str, Any] | None = None,
    tolerance: float | None = None,
    max_periods: int | None = None,
    steps_per_period: int | None = None,
    slip_speed: float | None = None,
    contact_stiffness: float | None = None,
    reduce: Mapping[str, Any] | None = None,
    verify: int | None = None,
    units: str | Sequence[str] | None = None,
    title: str | None = None,
    notes: str | None = None,
    parameters: Mapping[str, Values] | None = None,
    **numbered: Unpack[DriveNumbers],
) -> xarray.Dataset:
    """Return the motion in time of one scene over a grid of parameters: mean velocities and more.

    Without `outputs` it is the mean conveying velocity [m s-1]. `trajectory` gives the
    motion of one cell in time.

    *Values* are a number in the unit that is named, text with a unit such as ``"0.25 mm"``, or
    several of either, which become an axis of the dataset: a list, a range, an array, or a mapping
    such as ``{"start": "20 Hz", "stop": "120 Hz", "num": 101}``. ``None`` is a keyword left out.

    Parameters
    ----------
    study : Study, mapping or path, optional
        The study, which keywords add to; its `kind` is ``"simulate"``, and may be left out.
    scene : str, optional
        Name of a scene; `vibrafeed scenes` lists them.
    outputs : str or sequence of str, optional
        Names of the outputs.
    method : str, optional
        events (from event to event, exact), time-stepping, reference (of high order, slow) or
        regularised (stiff, for comparison); events where left out.
    frequency : values, optional
        Drive frequency. In Hz, 0 or more, for example "50 Hz" or "3000 rpm" or "3000 vpm".
    amplitude : values, optional
        Drive amplitude, zero to peak, along the drive direction. In m, 0 or more, for example "0.5
        mm".
    peak_to_peak : values, optional
        Twice the drive amplitude. In m, 0 or more, for example "1 mm".
    vertical_amplitude : values, optional
        Amplitude of the drive's part normal to the floor, zero to peak: A0 sin(beta). In m, 0 or
        more, for example "0.2 mm".
    vertical_peak_to_peak : values, optional
        Twice the vertical amplitude. In m, 0 or more, for example "0.4 mm".
    alpha : values, optional
        Azimuth of the drive in the floor plane, from the track (+x) towards +y. In degrees, from
        -180 to 180, for example "15 deg".
    beta : values, optional
        Elevation of the drive above the floor plane. In degrees, from -180 to 180, for example "20
        deg".
    gamma : values, optional
        Climb angle of the track; +x goes uphill. In degrees, from -90 to 90, for example "3 deg".
    delta : values, optional
        Lean of the track; the part leans on the wall. In degrees, from -90 to 90, for example "2
        deg".
    radius : values, optional
        Radius of the bowl's track wall. In m, above 0, for example "0.3 m".
    gravity : values, optional
        Acceleration of gravity. In m s-2, above 0, for example "9.80665 m/s^2".
    friction : values, optional
        Coulomb friction coefficient, static and kinetic alike. 0 or more, for example 0.3.
    friction_static : values, optional
        Coulomb friction coefficient at rest. 0 or more, for example 0.3.
    friction_kinetic : values, optional
        Coulomb friction coefficient in sliding. 0 or more, for example 0.3.
    wall_friction : values, optional
        Coulomb friction coefficient at the wall of the track; the floor's unless given. 0 or more,
        for example 0.3.
    height : values, optional
        Height of the rectangular part. In m, above 0, for example "1.5 mm".
    length : values, optional
        Length of the part, along the track. In m, above 0, for example "50 mm".
    diameter : values, optional
        Diameter of the cylindrical part. In m, above 0, for example "8 mm".
    mass : values, optional
        Mass of the part. In kg, above 0, for example "5 g".
    restitution : values, optional
        Coefficient of restitution: 0 for no rebound, 1 for full rebound. From 0 to 1, for example
        0.5.
    wall_restitution : values, optional
        Coefficient of restitution at the wall of the track; the floor's unless given. From 0 to 1,
        for example 0.3.
    pitch : values, optional
        Turn of the part in its plane of motion, clockwise: its right corner dips. In degrees, from
        -180 to 180, for example "20 deg".
    pitch_rate : values, optional
        Rate of the pitch, clockwise. In rad s-1, for example "2 rad/s" or "-90 deg/s".
    velocity_along : values, optional
        Velocity of the part's centre along the plane, to the right. In m s-1, for example "0.1
        m/s".
    velocity_upward : values, optional
        Velocity of the part's centre off the plane. In m s-1, for example "-0.1 m/s".
    hold_down : values, optional
        Force per mass that presses the part onto the floor, of a magnet or a vacuum. In m s-2, 0 or
        more, for example "20 m/s^2".
    hold_down_force : values, optional
        Force that presses the part onto the floor, of a magnet or a vacuum; with the mass of the
        part it gives hold_down. In N, 0 or more, for example "0.5 N".
    part_gap : values, optional
        Free length between two parts on the track. In m, 0 or more, for example "5 mm".
    occupancy : values, optional
        Share of the track's length that parts cover, 1 where each touches the next; follows from
        part_gap unless given. From 0 to 1, for example 0.6.
    duration : values, optional
        Time after which the run ends. In s, above 0, for example "2 s".
    drop_height : values, optional
        Height of the part's lowest corner above the plane at the start. In m, 0 or more, for
        example "10 mm".
    moving_mass : values, optional
        Mass of trough or bowl, with what is fixed to it. In kg, above 0, for example "10 kg".
    base_mass : values, optional
        Mass of the base, or counter-mass. In kg, above 0, for example "30 kg".
    load_mass : values, optional
        Mass of parts that move with the track, neither sliding nor hopping. In kg, 0 or more, for
        example "0.5 kg".
    load_damping : values, optional
        Damping between track and ground by parts that slide and hop. In N s m-1, 0 or more, for
        example "40 N s/m".
    conveyed_mass : values, optional
        Mass of all parts that travel on the track; amplitude and motion are found together. In kg,
        0 or more, for example "0.5 kg".
    moving_inertia : values, optional
        Moment of inertia of the bowl about its axis. In kg m2, above 0, for example "0.25 kg m^2".
    base_inertia : values, optional
        Moment of inertia of the base about the same axis. In kg m2, above 0, for example "0.9 kg
        m^2".
    spring_radius : values, optional
        Radius from the bowl's axis to the leaf springs. In m, above 0, for example "150 mm".
    spring_angle : values, optional
        Tilt of the leaf springs from the vertical; equals the drive's angle of a linear unit. In
        degrees, from -89 to 89, for example "20 deg".
    spring_count : values, optional
        Number of leaf springs in all packs, separated by spacers. Above 0, for example 8.
    spring_width : values, optional
        Width of a leaf spring. In m, above 0, for example "40 mm".
    spring_thickness : values, optional
        Thickness of a leaf spring. In m, above 0, for example "3 mm".
    spring_length : values, optional
        Length of a leaf spring between its clamps. In m, above 0, for example "100 mm".
    elastic_modulus : values, optional
        Elastic modulus of the leaf springs: 206 GPa for spring steel. In Pa, above 0, for example
        "206 GPa".
    spring_density : values, optional
        Density of the leaf springs: 7850 kg/m^3 for spring steel. In kg m-3, above 0, for example
        "7850 kg/m^3".
    clamp_factor : values, optional
        Stiffness of the leaf springs relative to rigid clamps. Above 0, for example 0.9.
    allowable_stress : values, optional
        Bending stress that the leaf springs endure permanently. In Pa, above 0, for example "250
        MPa".
    ring_down_frequency : values, optional
        Frequency at which the empty unit vibrates freely after a knock. In Hz, above 0, for example
        "53 Hz".
    damping_ratio : values, optional
        Logarithmic decrement of the ring-down over 2 pi. Above 0, for example 0.02.
    drive_force : values, optional
        Amplitude of the force between both masses, at the drive's frequency; a magnet's follows
        from flux_density and pole_area, an unbalance's from unbalance. In N, above 0, for example
        "100 N".
    flux_density : values, optional
        Peak of the flux density in the magnet's gap. In T, above 0, for example "0.5 T".
    pole_area : values, optional
        Area of all poles of the magnet that pull. In m2, above 0, for example "12 cm^2".
    force_harmonic : values, optional
        Second harmonic over the first: 0.25 of a magnet on a half wave that pulls the track back
        and down, -0.25 of one that pulls it forward and up, 0 on a full wave. From -1 to 1, for
        example 0.25.
    offset_along : values, optional
        Moving mass centre ahead of the base's. In m, for example "0 mm".
    offset_upward : values, optional
        Moving mass centre above the base's. In m, for example "0 mm".
    spot_along : values, optional
        Place on the track ahead of the mass centre. In m, for example "0 mm".
    spot_upward : values, optional
        Place on the track above the mass centre. In m, for example "0 mm".
    unbalance : values, optional
        Mass of an unbalance times its radius. In kg m, above 0, for example "0.002 kg m".
    air_gap : values, optional
        Air gap of the magnet at rest, along the stroke. In m, above 0, for example "2 mm".
    foot_stiffness : values, optional
        Stiffness of all feet together; 0 if the base is free. In N m-1, 0 or more, for example
        "50000 N/m".
    foot_damping : values, optional
        Damping of all feet together. In N s m-1, 0 or more, for example "100 N s/m".
    spring_stiffness : values, optional
        Stiffness of all leaf springs along the stroke; computed from their sizes by default. In N
        m-1, above 0, for example "1000 N/mm".
    track_fraction : values, optional
        Share of the track's length behind the part: 0 at its start, 1 at the exit. From 0 to 1, for
        example 0.5.
    start_radius : values, optional
        Radius at which the track starts. In m, above 0, for example "100 mm".
    load_radius : values, optional
        Radius at which the load lies; by default that of the part. In m, above 0, for example "180
        mm".
    load_fraction : values, optional
        Share of the track's length at which the load of all its parts is taken to act. From 0 to 1,
        for example 0.5.
    line_yield : values, optional
        Share of the parts that pass the devices behind the track, in any aspect, as yield of
        orienting-line. From 0 to 1, for example 0.79.
    line_purity : values, optional
        Share of the parts leaving the devices behind the track that lie as wanted, as purity of
        orienting-line. From 0 to 1, for example 1.0.
    parts : values, optional
        Number of parts in the row. From 2 to 64, for example 8.
    part_restitution : values, optional
        Relative velocity after a collision of two parts over that before. From 0 to 1, for example
        0.3.
    friction_spread : values, optional
        Standard deviation of the friction of the parts, drawn within three of it. 0 or more, for
        example 0.03.
    friction_seed : values, optional
        Seed: each whole number samples another row. From 0 to 1e+09, for example 1.
    track_stop_gap : values, optional
        Gap between the front part and a stop that moves with the track, at the start. In m, 0 or
        more, for example "0 mm".
    fixed_stop_gap : values, optional
        Gap between the front part and a stop at rest beside the track, at the start. In m, 0 or
        more, for example "0 mm".
    inner_diameter : values, optional
        Diameter of the hole of a tube or ring, or of the hollow of a ball; the part's own of a hoop
        or a thin shell. In m, 0 or more, for example "6 mm".
    rolling_factor : values, optional
        Ratio m r^2/I about the rolling axis: 5/2 of a ball, 3/2 of a thin shell, 2 of a cylinder or
        disc, 1 of a hoop; follows from the diameters unless given. Above 0, for example 2.5.
    rolling_resistance : values, optional
        Coefficient of rolling resistance: lever of the floor's force over the radius of the part.
        Hard steel on steel has some 0.001, plastic on a lined track some 0.02. 0 or more, for
        example 0.01.
    sensitivities : bool or sequence of str, optional
        Also give the derivative of each output by these parameters, and its elasticity d
        ln(output)/d ln(parameter): true for all that the study gives, or a list of names.
    trajectory : int or sequence of float, optional
        Also give the motion in time of the one point of the study: at this number of equal steps of
        its cycle, or at these times in seconds since the start of a period.
    drive : mapping, optional
        A measured drive: the recording of an accelerometer. Its harmonics are parameters, as far as
        the study does not give them itself.
    tolerance : float, optional
        Largest error of a periodic state, as a share of the drive. From 0.001 on events in the
        plane follow an aperiodic motion only until the error of its mean velocity is that share of
        it.
    max_periods : int, optional
        Maximum number of drive periods that are simulated for one point.
    steps_per_period : int, optional
        Time steps per period, for time-stepping; steps times periods are at most 25 million.
    slip_speed : float, optional
        Slip speed, in g/w, up to which regularised friction rises.
    contact_stiffness : float, optional
        Stiffness of the regularised floor, over m w^2.
    reduce : mapping, optional
        Statistics over some axes instead of all cells: docs/reduce.md.
    verify : int, optional
        Number of random cells to evaluate again, with 50 digits or by another method; the result
        states the worst of them.
    units : str or sequence of str, optional
        Units that screens and pictures show: trade (the default), si, or units such as m/min, each
        for its kind. Files hold SI.
    title : str, optional
        Title of the dataset.
    notes : str, optional
        Notes that are stored in the dataset.
    parameters : mapping of str to values, optional
        Fixed or ranged parameters.
    drive_factor : values, optional
        Factor by which every amplitude or acceleration of the drive is multiplied. 0 or more, for
        example 1.2.
    amplitude_along_1 to _10 : values, optional
        Amplitude of the track's motion along the track at the drive frequency, zero to peak. In m,
        0 or more, for example "0.1 mm".
    amplitude_across_1 to _10 : values, optional
        Amplitude of the track's motion across the track at the drive frequency, zero to peak. In m,
        0 or more, for example "0.1 mm".
    amplitude_normal_1 to _10 : values, optional
        Amplitude of the track's motion off the floor at the drive frequency, zero to peak. In m, 0
        or more, for example "0.1 mm".
    phase_along_1 to _10 : values, optional
        Lead of the track's motion along the track at the drive frequency: the displacement is A
        sin( w t + phi). In degrees, from -720 to 720, for example "90 deg".
    phase_across_1 to _10 : values, optional
        Lead of the track's motion across the track at the drive frequency: the displacement is A
        sin( w t + phi). In degrees, from -720 to 720, for example "90 deg".
    phase_normal_1 to _10 : values, optional
        Lead of the track's motion off the floor at the drive frequency: the displacement is A sin(
        w t + phi). In degrees, from -720 to 720, for example "90 deg".
    acceleration_along_1 to _12 : values, optional
        Acceleration of the track along the track during step 1 of a period. In m s-2, for example
        "4 m/s^2".
    acceleration_across_1 to _12 : values, optional
        Acceleration of the track across the track during step 1 of a period. In m s-2, for example
        "4 m/s^2".
    acceleration_normal_1 to _12 : values, optional
        Acceleration of the track off the floor during step 1 of a period. In m s-2, for example "4
        m/s^2".
    duration_1 to _12 : values, optional
        Relative duration of step 1; the durations of all steps divide the period. 0 or more, for
        example 0.25.
    part_friction_1 to _10 : values, optional
        Coefficient of friction between the track and part 1 of a row, the rearmost. 0 or more, for
        example 0.3.
    part_mass_1 to _10 : values, optional
        Mass of part 1 of a row, the rearmost. In kg, above 0, for example "4 g".
    part_gap_1 to _10 : values, optional
        Gap in front of part 1 of a row, the rearmost, at the start. In m, 0 or more, for example "1
        mm".
    stretch_turns_1 to _6 : values, optional
        Turns of stretch 1 of the track. Above 0, for example 1.5.
    stretch_radius_1 to _6 : values, optional
        Radius at the end of stretch 1. In m, above 0, for example "150 mm".
    stretch_climb_1 to _6 : values, optional
        Climb of stretch 1; that of the stretch before unless given. In degrees, from -80 to 80, for
        example "3 deg".
    stretch_friction_1 to _6 : values, optional
        Coefficient of friction on stretch 1; that of the stretch before unless given. 0 or more,
        for example 0.3.

    Returns
    -------
    xarray.Dataset
        The outputs, each with the axes that it depends on, and units; `regime` says what the part
        does, `motion_status` how the value was found.

    Raises
    ------
    StudyError
        With every problem, also where it is a study of another kind.

    Examples
    --------
    >>> motion = vibrafeed.simulate(
    ...     scene="rectangle-on-plane", frequency="50 Hz", amplitude=["0.25 mm", "0.4 mm"], beta=30,
    ...     friction=0.5,
    ... )
    >>> motion.conveying_velocity.dims, motion.conveying_velocity.units
    (('amplitude',), 'm s-1')
    """
    keywords = _functions.said(locals())
    return _functions.simulate(study, **keywords)


def optimise(
    study: StudyLike | None = None,
    /,
    *,
    scene: SweptScene | None = None,
    outputs: Output | Sequence[Output] | None = None,
    variant: Literal["thesis", "derived", "physical"] | str | None = None,
    method: str | None = None,
    criterion: Mapping[str, Any] | None = None,
    variables: Mapping[str, Bounds] | None = None,
    constraints: Sequence[Mapping[str, Any]] | None = None,
    frequency: Values | None = None,
    amplitude: Values | None = None,
    peak_to_peak: Values | None = None,
    vertical_amplitude: Values | None = None,
    vertical_peak_to_peak: Values | None = None,
    alpha: Values | None = None,
    beta: Values | None = None,
    gamma: Values | None = None,
    delta: Values | None = None,
    yaw: Values | None = None,
    radius: Values | None = None,
    gravity: Values | None = None,
    friction: Values | None = None,
    friction_static: Values | None = None,
    friction_kinetic: Values | None = None,
    wall_friction: Values | None = None,
    width: Values | None = None,
    height: Values | None = None,
    length: Values | None = None,
    diameter: Values | None = None,
    mass: Values | None = None,
    restitution: Values | None = None,
    wall_restitution: Values | None = None,
    speed: Values | None = None,
    distance: Values | None = None,
    time: Values | None = None,
    axis_yaw: Values | None = None,
    spin_rate: Values | None = None,
    yaw_rate: Values | None = None,
    drilling_moment: Values | None = None,
    pitch: Values | None = None,
    pitch_rate: Values | None = None,
    centre_along: Values | None = None,
    centre_height: Values | None = None,
    velocity_along: Values | None = None,
    velocity_upward: Values | None = None,
    position_x_1: Values | None = None,
    position_y_1: Values | None = None,
    angle_1: Values | None = None,
    velocity_x_1: Values | None = None,
    velocity_y_1: Values | None = None,
    spin_1: Values | None = None,
    position_z_1: Values | None = None,
    azimuth_1: Values | None = None,
    elevation_1: Values | None = None,
    velocity_z_1: Values | None = None,
    spin_x_1: Values | None = None,
    spin_y_1: Values | None = None,
    spin_z_1: Values | None = None,
    diameter_1: Values | None = None,
    length_1: Values | None = None,
    width_1: Values | None = None,
    mass_1: Values | None = None,
    position_x_2: Values | None = None,
    position_y_2: Values | None = None,
    angle_2: Values | None = None,
    velocity_x_2: Values | None = None,
    velocity_y_2: Values | None = None,
    spin_2: Values | None = None,
    position_z_2: Values | None = None,
    azimuth_2: Values | None = None,
    elevation_2: Values | None = None,
    velocity_z_2: Values | None = None,
    spin_x_2: Values | None = None,
    spin_y_2: Values | None = None,
    spin_z_2: Values | None = None,
    diameter_2: Values | None = None,
    length_2: Values | None = None,
    width_2: Values | None = None,
    mass_2: Values | None = None,
    contact_tolerance: Values | None = None,
    hold_down: Values | None = None,
    hold_down_force: Values | None = None,
    part_gap: Values | None = None,
    occupancy: Values | None = None,
    duration: Values | None = None,
    drop_height: Values | None = None,
    moving_mass: Values | None = None,
    base_mass: Values | None = None,
    load_mass: Values | None = None,
    load_damping: Values | None = None,
    conveyed_mass: Values | None = None,
    moving_inertia: Values | None = None,
    base_inertia: Values | None = None,
    spring_radius: Values | None = None,
    spring_angle: Values | None = None,
    spring_count: Values | None = None,
    spring_width: Values | None = None,
    spring_thickness: Values | None = None,
    spring_length: Values | None = None,
    elastic_modulus: Values | None = None,
    spring_density: Values | None = None,
    clamp_factor: Values | None = None,
    allowable_stress: Values | None = None,
    ring_down_frequency: Values | None = None,
    damping_ratio: Values | None = None,
    drive_force: Values | None = None,
    flux_density: Values | None = None,
    pole_area: Values | None = None,
    force_harmonic: Values | None = None,
    offset_along: Values | None = None,
    offset_upward: Values | None = None,
    spot_along: Values | None = None,
    spot_upward: Values | None = None,
    unbalance: Values | None = None,
    air_gap: Values | None = None,
    foot_stiffness: Values | None = None,
    foot_damping: Values | None = None,
    spring_stiffness: Values | None = None,
    track_fraction: Values | None = None,
    start_radius: Values | None = None,
    load_radius: Values | None = None,
    load_fraction: Values | None = None,
    small_diameter: Values | None = None,
    centre_of_mass: Values | None = None,
    radius_of_gyration: Values | None = None,
    sides: Values | None = None,
    arrival_rate: Values | None = None,
    arrival_speed: Values | None = None,
    part_pitch: Values | None = None,
    wanted_aspect: Values | None = None,
    shank_diameter: Values | None = None,
    device_order: Values | None = None,
    drop_count_1: Values | None = None,
    drop_count_2: Values | None = None,
    drop_count_3: Values | None = None,
    wiper_height_1: Values | None = None,
    ledge_width_1: Values | None = None,
    gap_length_1: Values | None = None,
    passed_aspect_1: Values | None = None,
    rail_width_1: Values | None = None,
    outlet_capacity_1: Values | None = None,
    turned_share_1: Values | None = None,
    turn_1: Values | None = None,
    wiper_height_2: Values | None = None,
    ledge_width_2: Values | None = None,
    gap_length_2: Values | None = None,
    passed_aspect_2: Values | None = None,
    rail_width_2: Values | None = None,
    outlet_capacity_2: Values | None = None,
    turned_share_2: Values | None = None,
    turn_2: Values | None = None,
    wiper_height_3: Values | None = None,
    ledge_width_3: Values | None = None,
    gap_length_3: Values | None = None,
    passed_aspect_3: Values | None = None,
    rail_width_3: Values | None = None,
    outlet_capacity_3: Values | None = None,
    turned_share_3: Values | None = None,
    turn_3: Values | None = None,
    wiper_height_4: Values | None = None,
    ledge_width_4: Values | None = None,
    gap_length_4: Values | None = None,
    passed_aspect_4: Values | None = None,
    rail_width_4: Values | None = None,
    outlet_capacity_4: Values | None = None,
    turned_share_4: Values | None = None,
    turn_4: Values | None = None,
    wiper_height_5: Values | None = None,
    ledge_width_5: Values | None = None,
    gap_length_5: Values | None = None,
    passed_aspect_5: Values | None = None,
    rail_width_5: Values | None = None,
    outlet_capacity_5: Values | None = None,
    turned_share_5: Values | None = None,
    turn_5: Values | None = None,
    wiper_height_6: Values | None = None,
    ledge_width_6: Values | None = None,
    gap_length_6: Values | None = None,
    passed_aspect_6: Values | None = None,
    rail_width_6: Values | None = None,
    outlet_capacity_6: Values | None = None,
    turned_share_6: Values | None = None,
    turn_6: Values | None = None,
    lap_time: Values | None = None,
    line_yield: Values | None = None,
    line_purity: Values | None = None,
    parts: Values | None = None,
    part_restitution: Values | None = None,
    friction_spread: Values | None = None,
    friction_seed: Values | None = None,
    track_stop_gap: Values | None = None,
    fixed_stop_gap: Values | None = None,
    row_velocity: Values | None = None,
    inflow: Values | None = None,
    lane_length: Values | None = None,
    closed_time: Values | None = None,
    open_time: Values | None = None,
    part_width: Values | None = None,
    bend_radius: Values | None = None,
    bend_length: Values | None = None,
    bend_friction: Values | None = None,
    line_push: Values | None = None,
    forward_acceleration: Values | None = None,
    return_acceleration: Values | None = None,
    row_mass: Values | None = None,
    front_velocity: Values | None = None,
    inner_diameter: Values | None = None,
    rolling_factor: Values | None = None,
    restitution_speed: Values | None = None,
    impact_speed: Values | None = None,
    contact_damping_ratio: Values | None = None,
    lining_stiffness: Values | None = None,
    contact_modulus: Values | None = None,
    contact_radius: Values | None = None,
    rolling_resistance: Values | None = None,
    uncertain: Mapping[str, Mapping[str, Any]] | None = None,
    robust: Literal["worst", "mean", "quantile"] | None = None,
    quantile: float | None = None,
    floor_contact: bool | None = None,
    wall_contact: bool | None = None,
    sensitivities: bool | Sequence[str] | None = None,
    drive: Mapping[str, Any] | None = None,
    verify: int | None = None,
    units: str | Sequence[str] | None = None,
    title: str | None = None,
    notes: str | None = None,
    parameters: Mapping[str, Values] | None = None,
    **numbered: Unpack[DriveNumbers],
) -> xarray.Dataset:
    """Return the best values of some parameters, over a grid of the others.

    The `criterion` says what is looked for, and `variables` what may be chosen between which
    bounds.

    *Values* are a number in the unit that is named, text with a unit such as ``"0.25 mm"``, or
    several of either, which become an axis of the dataset: a list, a range, an array, or a mapping
    such as ``{"start": "20 Hz", "stop": "120 Hz", "num": 101}``. ``None`` is a keyword left out.

    Parameters
    ----------
    study : Study, mapping or path, optional
        The study, which keywords add to; its `kind` is ``"optimise"``, and may be left out.
    scene : str, optional
        Name of a scene; `vibrafeed scenes` lists them.
    outputs : str or sequence of str, optional
        Further outputs to compute at the optimum.
    variant : {"thesis", "derived", "physical"}, optional
        thesis (as printed), derived (errors corrected) or physical; the scene's default where left
        out.
    method : str, optional
        The optimiser; where left out, the exact answer if there is one, else what was measured to
        be best.
    criterion : mapping, optional
        The criterion: which output is maximised or minimised.
    variables : mapping of str to bounds, optional
        The variables with their bounds; alpha and beta from 0 to 90 degrees where left out, as far
        as they are not given and the outputs depend on them.
    constraints : sequence of mapping, optional
        Constraints: bounds that outputs must keep.
    frequency : values, optional
        Drive frequency. In Hz, 0 or more, for example "50 Hz" or "3000 rpm" or "3000 vpm".
    amplitude : values, optional
        Drive amplitude, zero to peak, along the drive direction. In m, 0 or more, for example "0.5
        mm".
    peak_to_peak : values, optional
        Twice the drive amplitude. In m, 0 or more, for example "1 mm".
    vertical_amplitude : values, optional
        Amplitude of the drive's part normal to the floor, zero to peak: A0 sin(beta). In m, 0 or
        more, for example "0.2 mm".
    vertical_peak_to_peak : values, optional
        Twice the vertical amplitude. In m, 0 or more, for example "0.4 mm".
    alpha : values, optional
        Azimuth of the drive in the floor plane, from the track (+x) towards +y. In degrees, from
        -180 to 180, for example "15 deg".
    beta : values, optional
        Elevation of the drive above the floor plane. In degrees, from -180 to 180, for example "20
        deg".
    gamma : values, optional
        Climb angle of the track; +x goes uphill. In degrees, from -90 to 90, for example "3 deg".
    delta : values, optional
        Lean of the track; the part leans on the wall. In degrees, from -90 to 90, for example "2
        deg".
    yaw : values, optional
        Turn of the part's axes about the floor normal. In degrees, from -180 to 180, for example
        "30 deg".
    radius : values, optional
        Radius of the bowl's track wall. In m, above 0, for example "0.3 m".
    gravity : values, optional
        Acceleration of gravity. In m s-2, above 0, for example "9.80665 m/s^2".
    friction : values, optional
        Coulomb friction coefficient, static and kinetic alike. 0 or more, for example 0.3.
    friction_static : values, optional
        Coulomb friction coefficient at rest. 0 or more, for example 0.3.
    friction_kinetic : values, optional
        Coulomb friction coefficient in sliding. 0 or more, for example 0.3.
    wall_friction : values, optional
        Coulomb friction coefficient at the wall of the track; the floor's unless given. 0 or more,
        for example 0.3.
    width : values, optional
        Width of the rectangular part, across. In m, above 0, for example "10 mm".
    height : values, optional
        Height of the rectangular part. In m, above 0, for example "1.5 mm".
    length : values, optional
        Length of the part, along the track. In m, above 0, for example "50 mm".
    diameter : values, optional
        Diameter of the cylindrical part. In m, above 0, for example "8 mm".
    mass : values, optional
        Mass of the part. In kg, above 0, for example "5 g".
    restitution : values, optional
        Coefficient of restitution: 0 for no rebound, 1 for full rebound. From 0 to 1, for example
        0.5.
    wall_restitution : values, optional
        Coefficient of restitution at the wall of the track; the floor's unless given. From 0 to 1,
        for example 0.3.
    speed : values, optional
        Speed of the part along the track at the start. In m s-1, 0 or more, for example "0.1 m/s".
    distance : values, optional
        Distance over which the drive is taken to act; the source gives no value for it. In m, 0 or
        more, for example "0.2 mm".
    time : values, optional
        Time since the start, with the drive held at its peak. In s, 0 or more, for example "20 ms".
    axis_yaw : values, optional
        Turn of the rolling cylinder's axis in the floor plane as chapter 4 counts it: from +x
        towards -y, clockwise seen from above. In degrees, from -180 to 180, for example "30 deg".
    spin_rate : values, optional
        Angular velocity of the rolling cylinder about its axis; positive rolls along +eta. In rad
        s-1, for example "40 rad/s" or "400 rpm".
    yaw_rate : values, optional
        Rate of the cylinder's yaw, in the sense of axis_yaw. In rad s-1, for example "2 rad/s".
    drilling_moment : values, optional
        Moment of all floor friction about the vertical through the centre, in the sense of
        axis_yaw. In N m, for example "0.1 mN m".
    pitch : values, optional
        Turn of the part in its plane of motion, clockwise: its right corner dips. In degrees, from
        -180 to 180, for example "20 deg".
    pitch_rate : values, optional
        Rate of the pitch, clockwise. In rad s-1, for example "2 rad/s" or "-90 deg/s".
    centre_along : values, optional
        Position of the part's centre along the plane. In m, for example "12 mm".
    centre_height : values, optional
        Height of the part's centre above the plane. In m, for example "8 mm".
    velocity_along : values, optional
        Velocity of the part's centre along the plane, to the right. In m s-1, for example "0.1
        m/s".
    velocity_upward : values, optional
        Velocity of the part's centre off the plane. In m s-1, for example "-0.1 m/s".
    position_x_1 : values, optional
        Centre of body 1, x. In m, for example "5 mm".
    position_y_1 : values, optional
        Centre of body 1, y. In m, for example "5 mm".
    angle_1 : values, optional
        Angle of the length of body 1, from +x towards +y. In degrees, for example "30 deg".
    velocity_x_1 : values, optional
        Velocity of body 1 before the impact, x. In m s-1, for example "0.2 m/s".
    velocity_y_1 : values, optional
        Velocity of body 1 before the impact, y. In m s-1, for example "0.2 m/s".
    spin_1 : values, optional
        Angular velocity of body 1 before the impact, from +x towards +y. In rad s-1, for example "3
        rad/s".
    position_z_1 : values, optional
        Centre of body 1, z. In m, for example "5 mm".
    azimuth_1 : values, optional
        Angle of the axis of body 1 in the floor plane, from +x towards +y. In degrees, for example
        "30 deg".
    elevation_1 : values, optional
        Angle of the axis of body 1 above the floor plane. In degrees, for example "10 deg".
    velocity_z_1 : values, optional
        Velocity of body 1 before the impact, z. In m s-1, for example "0.2 m/s".
    spin_x_1 : values, optional
        Angular velocity of body 1 before the impact, x. In rad s-1, for example "3 rad/s".
    spin_y_1 : values, optional
        Angular velocity of body 1 before the impact, y. In rad s-1, for example "3 rad/s".
    spin_z_1 : values, optional
        Angular velocity of body 1 before the impact, z. In rad s-1, for example "3 rad/s".
    diameter_1 : values, optional
        Diameter of body 1. In m, above 0, for example "8 mm".
    length_1 : values, optional
        Length of body 1. In m, above 0, for example "20 mm".
    width_1 : values, optional
        Width of body 1. In m, above 0, for example "10 mm".
    mass_1 : values, optional
        Mass of body 1. In kg, above 0, for example "5 g".
    position_x_2 : values, optional
        Centre of body 2, x. In m, for example "5 mm".
    position_y_2 : values, optional
        Centre of body 2, y. In m, for example "5 mm".
    angle_2 : values, optional
        Angle of the length of body 2, from +x towards +y. In degrees, for example "30 deg".
    velocity_x_2 : values, optional
        Velocity of body 2 before the impact, x. In m s-1, for example "0.2 m/s".
    velocity_y_2 : values, optional
        Velocity of body 2 before the impact, y. In m s-1, for example "0.2 m/s".
    spin_2 : values, optional
        Angular velocity of body 2 before the impact, from +x towards +y. In rad s-1, for example "3
        rad/s".
    position_z_2 : values, optional
        Centre of body 2, z. In m, for example "5 mm".
    azimuth_2 : values, optional
        Angle of the axis of body 2 in the floor plane, from +x towards +y. In degrees, for example
        "30 deg".
    elevation_2 : values, optional
        Angle of the axis of body 2 above the floor plane. In degrees, for example "10 deg".
    velocity_z_2 : values, optional
        Velocity of body 2 before the impact, z. In m s-1, for example "0.2 m/s".
    spin_x_2 : values, optional
        Angular velocity of body 2 before the impact, x. In rad s-1, for example "3 rad/s".
    spin_y_2 : values, optional
        Angular velocity of body 2 before the impact, y. In rad s-1, for example "3 rad/s".
    spin_z_2 : values, optional
        Angular velocity of body 2 before the impact, z. In rad s-1, for example "3 rad/s".
    diameter_2 : values, optional
        Diameter of body 2. In m, above 0, for example "8 mm".
    length_2 : values, optional
        Length of body 2. In m, above 0, for example "20 mm".
    width_2 : values, optional
        Width of body 2. In m, above 0, for example "10 mm".
    mass_2 : values, optional
        Mass of body 2. In kg, above 0, for example "5 g".
    contact_tolerance : values, optional
        Largest gap or overlap that counts as touching, as a share of the bodies' size, the sum of
        their half diagonals. 1 lets the impact happen as the bodies are placed. 0 or more, for
        example "1e-6".
    hold_down : values, optional
        Force per mass that presses the part onto the floor, of a magnet or a vacuum. In m s-2, 0 or
        more, for example "20 m/s^2".
    hold_down_force : values, optional
        Force that presses the part onto the floor, of a magnet or a vacuum; with the mass of the
        part it gives hold_down. In N, 0 or more, for example "0.5 N".
    part_gap : values, optional
        Free length between two parts on the track. In m, 0 or more, for example "5 mm".
    occupancy : values, optional
        Share of the track's length that parts cover, 1 where each touches the next; follows from
        part_gap unless given. From 0 to 1, for example 0.6.
    duration : values, optional
        Time after which the run ends. In s, above 0, for example "2 s".
    drop_height : values, optional
        Height of the part's lowest corner above the plane at the start. In m, 0 or more, for
        example "10 mm".
    moving_mass : values, optional
        Mass of trough or bowl, with what is fixed to it. In kg, above 0, for example "10 kg".
    base_mass : values, optional
        Mass of the base, or counter-mass. In kg, above 0, for example "30 kg".
    load_mass : values, optional
        Mass of parts that move with the track, neither sliding nor hopping. In kg, 0 or more, for
        example "0.5 kg".
    load_damping : values, optional
        Damping between track and ground by parts that slide and hop. In N s m-1, 0 or more, for
        example "40 N s/m".
    conveyed_mass : values, optional
        Mass of all parts that travel on the track; amplitude and motion are found together. In kg,
        0 or more, for example "0.5 kg".
    moving_inertia : values, optional
        Moment of inertia of the bowl about its axis. In kg m2, above 0, for example "0.25 kg m^2".
    base_inertia : values, optional
        Moment of inertia of the base about the same axis. In kg m2, above 0, for example "0.9 kg
        m^2".
    spring_radius : values, optional
        Radius from the bowl's axis to the leaf springs. In m, above 0, for example "150 mm".
    spring_angle : values, optional
        Tilt of the leaf springs from the vertical; equals the drive's angle of a linear unit. In
        degrees, from -89 to 89, for example "20 deg".
    spring_count : values, optional
        Number of leaf springs in all packs, separated by spacers. Above 0, for example 8.
    spring_width : values, optional
        Width of a leaf spring. In m, above 0, for example "40 mm".
    spring_thickness : values, optional
        Thickness of a leaf spring. In m, above 0, for example "3 mm".
    spring_length : values, optional
        Length of a leaf spring between its clamps. In m, above 0, for example "100 mm".
    elastic_modulus : values, optional
        Elastic modulus of the leaf springs: 206 GPa for spring steel. In Pa, above 0, for example
        "206 GPa".
    spring_density : values, optional
        Density of the leaf springs: 7850 kg/m^3 for spring steel. In kg m-3, above 0, for example
        "7850 kg/m^3".
    clamp_factor : values, optional
        Stiffness of the leaf springs relative to rigid clamps. Above 0, for example 0.9.
    allowable_stress : values, optional
        Bending stress that the leaf springs endure permanently. In Pa, above 0, for example "250
        MPa".
    ring_down_frequency : values, optional
        Frequency at which the empty unit vibrates freely after a knock. In Hz, above 0, for example
        "53 Hz".
    damping_ratio : values, optional
        Logarithmic decrement of the ring-down over 2 pi. Above 0, for example 0.02.
    drive_force : values, optional
        Amplitude of the force between both masses, at the drive's frequency; a magnet's follows
        from flux_density and pole_area, an unbalance's from unbalance. In N, above 0, for example
        "100 N".
    flux_density : values, optional
        Peak of the flux density in the magnet's gap. In T, above 0, for example "0.5 T".
    pole_area : values, optional
        Area of all poles of the magnet that pull. In m2, above 0, for example "12 cm^2".
    force_harmonic : values, optional
        Second harmonic over the first: 0.25 of a magnet on a half wave that pulls the track back
        and down, -0.25 of one that pulls it forward and up, 0 on a full wave. From -1 to 1, for
        example 0.25.
    offset_along : values, optional
        Moving mass centre ahead of the base's. In m, for example "0 mm".
    offset_upward : values, optional
        Moving mass centre above the base's. In m, for example "0 mm".
    spot_along : values, optional
        Place on the track ahead of the mass centre. In m, for example "0 mm".
    spot_upward : values, optional
        Place on the track above the mass centre. In m, for example "0 mm".
    unbalance : values, optional
        Mass of an unbalance times its radius. In kg m, above 0, for example "0.002 kg m".
    air_gap : values, optional
        Air gap of the magnet at rest, along the stroke. In m, above 0, for example "2 mm".
    foot_stiffness : values, optional
        Stiffness of all feet together; 0 if the base is free. In N m-1, 0 or more, for example
        "50000 N/m".
    foot_damping : values, optional
        Damping of all feet together. In N s m-1, 0 or more, for example "100 N s/m".
    spring_stiffness : values, optional
        Stiffness of all leaf springs along the stroke; computed from their sizes by default. In N
        m-1, above 0, for example "1000 N/mm".
    track_fraction : values, optional
        Share of the track's length behind the part: 0 at its start, 1 at the exit. From 0 to 1, for
        example 0.5.
    start_radius : values, optional
        Radius at which the track starts. In m, above 0, for example "100 mm".
    load_radius : values, optional
        Radius at which the load lies; by default that of the part. In m, above 0, for example "180
        mm".
    load_fraction : values, optional
        Share of the track's length at which the load of all its parts is taken to act. From 0 to 1,
        for example 0.5.
    small_diameter : values, optional
        Diameter of the end opposite to that of diameter; 0 of a full cone. In m, 0 or more, for
        example "12 mm".
    centre_of_mass : values, optional
        Distance of the centre of mass from the end of diameter. In m, above 0, for example "8 mm".
    radius_of_gyration : values, optional
        Root of moment of inertia over mass, about a line across the part through its centre. In m,
        above 0, for example "7 mm".
    sides : values, optional
        Sides of a regular prism; diameter is that of the circle through its corners. 3 or more, for
        example 6.
    arrival_rate : values, optional
        Parts a minute that arrive at the first device. In min-1, above 0, for example "300 1/min".
    arrival_speed : values, optional
        Conveying velocity of the parts before the first device. In m s-1, above 0, for example "60
        mm/s".
    part_pitch : values, optional
        Distance from part to part in a row. In m, above 0, for example "22 mm".
    wanted_aspect : values, optional
        Number of the aspect in which parts are to leave. From 1 to 3, for example 1.
    shank_diameter : values, optional
        Diameter of the shank of a part with a head; `diameter` is that of the head. In m, above 0,
        for example "4 mm".
    device_order : values, optional
        Number of the order of the devices, in lexical order: 1 is the order of their positions, the
        last one is backwards. From 1 to 720, for example 1.
    drop_count_1 : values, optional
        Parts of a drop test that came to rest in aspect 1. 0 or more, for example 129.
    drop_count_2 : values, optional
        Parts of a drop test that came to rest in aspect 2. 0 or more, for example 129.
    drop_count_3 : values, optional
        Parts of a drop test that came to rest in aspect 3. 0 or more, for example 129.
    wiper_height_1 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_1 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_1 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_1 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_1 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_1 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_1 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_1 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_2 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_2 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_2 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_2 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_2 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_2 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_2 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_2 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_3 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_3 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_3 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_3 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_3 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_3 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_3 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_3 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_4 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_4 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_4 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_4 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_4 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_4 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_4 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_4 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_5 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_5 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_5 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_5 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_5 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_5 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_5 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_5 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_6 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_6 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_6 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_6 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_6 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_6 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_6 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_6 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    lap_time : values, optional
        Time from the bowl to the first device and back. In s, above 0, for example "40 s".
    line_yield : values, optional
        Share of the parts that pass the devices behind the track, in any aspect, as yield of
        orienting-line. From 0 to 1, for example 0.79.
    line_purity : values, optional
        Share of the parts leaving the devices behind the track that lie as wanted, as purity of
        orienting-line. From 0 to 1, for example 1.0.
    parts : values, optional
        Number of parts in the row. From 2 to 64, for example 8.
    part_restitution : values, optional
        Relative velocity after a collision of two parts over that before. From 0 to 1, for example
        0.3.
    friction_spread : values, optional
        Standard deviation of the friction of the parts, drawn within three of it. 0 or more, for
        example 0.03.
    friction_seed : values, optional
        Seed: each whole number samples another row. From 0 to 1e+09, for example 1.
    track_stop_gap : values, optional
        Gap between the front part and a stop that moves with the track, at the start. In m, 0 or
        more, for example "0 mm".
    fixed_stop_gap : values, optional
        Gap between the front part and a stop at rest beside the track, at the start. In m, 0 or
        more, for example "0 mm".
    row_velocity : values, optional
        Mean velocity of the parts on the free lane: measured, or of a study of their motion. In m
        s-1, above 0, for example "80 mm/s".
    inflow : values, optional
        Parts a minute that come onto the lane. In min-1, 0 or more, for example "120 1/min".
    lane_length : values, optional
        Length of the lane. In m, above 0, for example "500 mm".
    closed_time : values, optional
        Time for which the escapement is closed. In s, 0 or more, for example "200 ms".
    open_time : values, optional
        Minimum time for which the escapement is open. In s, 0 or more, for example "100 ms".
    part_width : values, optional
        Width of a part, across the lane. In m, above 0, for example "10 mm".
    bend_radius : values, optional
        Radius of the bend's outer wall. In m, above 0, for example "200 mm".
    bend_length : values, optional
        Length of the part of a row inside the bend. In m, above 0, for example "200 mm".
    bend_friction : values, optional
        Coefficient of friction at the wall of the bend. Above 0, for example 0.3.
    line_push : values, optional
        Force per length with which the track pushes the row. In N m-1, above 0, for example "1
        N/m".
    forward_acceleration : values, optional
        Acceleration of the track forwards, which carries parts. In m s-2, above 0, for example "2
        m/s^2".
    return_acceleration : values, optional
        Acceleration of the track backwards, under the parts. In m s-2, above 0, for example "2
        m/s^2".
    row_mass : values, optional
        Mass of all parts of the row. In kg, above 0, for example "100 g".
    front_velocity : values, optional
        Mean velocity of the parts in front. In m s-1, 0 or more, for example "60 mm/s".
    inner_diameter : values, optional
        Diameter of the hole of a tube or ring, or of the hollow of a ball; the part's own of a hoop
        or a thin shell. In m, 0 or more, for example "6 mm".
    rolling_factor : values, optional
        Ratio m r^2/I about the rolling axis: 5/2 of a ball, 3/2 of a thin shell, 2 of a cylinder or
        disc, 1 of a hoop; follows from the diameters unless given. Above 0, for example 2.5.
    restitution_speed : values, optional
        Speed of impact at which the restitution was measured. In m s-1, above 0, for example "0.1
        m/s".
    impact_speed : values, optional
        Speed of approach normal to the contact. In m s-1, above 0, for example "0.2 m/s".
    contact_damping_ratio : values, optional
        Damping ratio of the spring and damper of a contact that never pulls. 0 or more, for example
        0.2.
    lining_stiffness : values, optional
        Force over depth of a part on a lined track, such as brush or urethane. In N m-1, above 0,
        for example "20 N/mm".
    contact_modulus : values, optional
        Reduced modulus of both materials: 1/E is the sum of (1 - nu^2)/E of each. In Pa, above 0,
        for example "115 GPa".
    contact_radius : values, optional
        Radius of a ball, or of a rounded part where it strikes. In m, above 0, for example "4 mm".
    rolling_resistance : values, optional
        Coefficient of rolling resistance: lever of the floor's force over the radius of the part.
        Hard steel on steel has some 0.001, plastic on a lined track some 0.02. 0 or more, for
        example 0.01.
    uncertain : mapping of str to mapping, optional
        Parameters that are not known exactly, such as friction: their bounds, or their
        distributions.
    robust : {"worst", "mean", "quantile"}, optional
        What is looked for under them: the best worst case (where left out), the best mean, or the
        best quantile.
    quantile : float, optional
        The quantile, 0 to 1, of the output that is optimised.
    floor_contact : bool, optional
        True if the part must stay on the floor, if the scene has one.
    wall_contact : bool, optional
        True if the part must stay on the wall, if the scene has one.
    sensitivities : bool or sequence of str, optional
        True to compute d ln(output)/d ln(parameter) at each optimum.
    drive : mapping, optional
        A measured drive: the recording of an accelerometer. Its harmonics are parameters, as far as
        the study does not give them itself.
    verify : int, optional
        Number of random cells to evaluate again, with 50 digits or by another method; the result
        states the worst of them.
    units : str or sequence of str, optional
        Units that screens and pictures show: trade (the default), si, or units such as m/min, each
        for its kind. Files hold SI.
    title : str, optional
        Title of the dataset.
    notes : str, optional
        Notes that are stored in the dataset.
    parameters : mapping of str to values, optional
        Fixed or ranged parameters.
    drive_factor : values, optional
        Factor by which every amplitude or acceleration of the drive is multiplied. 0 or more, for
        example 1.2.
    amplitude_along_1 to _10 : values, optional
        Amplitude of the track's motion along the track at the drive frequency, zero to peak. In m,
        0 or more, for example "0.1 mm".
    amplitude_across_1 to _10 : values, optional
        Amplitude of the track's motion across the track at the drive frequency, zero to peak. In m,
        0 or more, for example "0.1 mm".
    amplitude_normal_1 to _10 : values, optional
        Amplitude of the track's motion off the floor at the drive frequency, zero to peak. In m, 0
        or more, for example "0.1 mm".
    phase_along_1 to _10 : values, optional
        Lead of the track's motion along the track at the drive frequency: the displacement is A
        sin( w t + phi). In degrees, from -720 to 720, for example "90 deg".
    phase_across_1 to _10 : values, optional
        Lead of the track's motion across the track at the drive frequency: the displacement is A
        sin( w t + phi). In degrees, from -720 to 720, for example "90 deg".
    phase_normal_1 to _10 : values, optional
        Lead of the track's motion off the floor at the drive frequency: the displacement is A sin(
        w t + phi). In degrees, from -720 to 720, for example "90 deg".
    acceleration_along_1 to _12 : values, optional
        Acceleration of the track along the track during step 1 of a period. In m s-2, for example
        "4 m/s^2".
    acceleration_across_1 to _12 : values, optional
        Acceleration of the track across the track during step 1 of a period. In m s-2, for example
        "4 m/s^2".
    acceleration_normal_1 to _12 : values, optional
        Acceleration of the track off the floor during step 1 of a period. In m s-2, for example "4
        m/s^2".
    duration_1 to _12 : values, optional
        Relative duration of step 1; the durations of all steps divide the period. 0 or more, for
        example 0.25.
    part_friction_1 to _10 : values, optional
        Coefficient of friction between the track and part 1 of a row, the rearmost. 0 or more, for
        example 0.3.
    part_mass_1 to _10 : values, optional
        Mass of part 1 of a row, the rearmost. In kg, above 0, for example "4 g".
    part_gap_1 to _10 : values, optional
        Gap in front of part 1 of a row, the rearmost, at the start. In m, 0 or more, for example "1
        mm".
    stretch_turns_1 to _6 : values, optional
        Turns of stretch 1 of the track. Above 0, for example 1.5.
    stretch_radius_1 to _6 : values, optional
        Radius at the end of stretch 1. In m, above 0, for example "150 mm".
    stretch_climb_1 to _6 : values, optional
        Climb of stretch 1; that of the stretch before unless given. In degrees, from -80 to 80, for
        example "3 deg".
    stretch_friction_1 to _6 : values, optional
        Coefficient of friction on stretch 1; that of the stretch before unless given. 0 or more,
        for example 0.3.

    Returns
    -------
    xarray.Dataset
        The best values, `best_beta` and so on, and the outputs there, over the axes; units, and
        `optimum_status`, which says what sort of optimum it is.

    Raises
    ------
    StudyError
        With every problem, also where it is a study of another kind.

    Examples
    --------
    >>> best = vibrafeed.optimise(
    ...     scene="rectangle-on-plane", criterion={"kind": "maximise", "output": "acceleration_x"},
    ...     variables={"beta": {"lower": 0, "upper": 60}}, frequency="50 Hz", amplitude="0.25 mm",
    ...     friction=0.5,
    ... )
    >>> best.best_beta.units
    'degree'
    """
    keywords = _functions.said(locals())
    return _functions.optimise(study, **keywords)


def sensitivity(
    study: StudyLike | None = None,
    /,
    *,
    scene: SweptScene | None = None,
    outputs: Output | Sequence[Output] | None = None,
    variant: Literal["thesis", "derived", "physical"] | str | None = None,
    method: str | None = None,
    frequency: Values | None = None,
    amplitude: Values | None = None,
    peak_to_peak: Values | None = None,
    vertical_amplitude: Values | None = None,
    vertical_peak_to_peak: Values | None = None,
    alpha: Values | None = None,
    beta: Values | None = None,
    gamma: Values | None = None,
    delta: Values | None = None,
    yaw: Values | None = None,
    radius: Values | None = None,
    gravity: Values | None = None,
    friction: Values | None = None,
    friction_static: Values | None = None,
    friction_kinetic: Values | None = None,
    wall_friction: Values | None = None,
    width: Values | None = None,
    height: Values | None = None,
    length: Values | None = None,
    diameter: Values | None = None,
    mass: Values | None = None,
    restitution: Values | None = None,
    wall_restitution: Values | None = None,
    speed: Values | None = None,
    distance: Values | None = None,
    time: Values | None = None,
    axis_yaw: Values | None = None,
    spin_rate: Values | None = None,
    yaw_rate: Values | None = None,
    drilling_moment: Values | None = None,
    pitch: Values | None = None,
    pitch_rate: Values | None = None,
    centre_along: Values | None = None,
    centre_height: Values | None = None,
    velocity_along: Values | None = None,
    velocity_upward: Values | None = None,
    position_x_1: Values | None = None,
    position_y_1: Values | None = None,
    angle_1: Values | None = None,
    velocity_x_1: Values | None = None,
    velocity_y_1: Values | None = None,
    spin_1: Values | None = None,
    position_z_1: Values | None = None,
    azimuth_1: Values | None = None,
    elevation_1: Values | None = None,
    velocity_z_1: Values | None = None,
    spin_x_1: Values | None = None,
    spin_y_1: Values | None = None,
    spin_z_1: Values | None = None,
    diameter_1: Values | None = None,
    length_1: Values | None = None,
    width_1: Values | None = None,
    mass_1: Values | None = None,
    position_x_2: Values | None = None,
    position_y_2: Values | None = None,
    angle_2: Values | None = None,
    velocity_x_2: Values | None = None,
    velocity_y_2: Values | None = None,
    spin_2: Values | None = None,
    position_z_2: Values | None = None,
    azimuth_2: Values | None = None,
    elevation_2: Values | None = None,
    velocity_z_2: Values | None = None,
    spin_x_2: Values | None = None,
    spin_y_2: Values | None = None,
    spin_z_2: Values | None = None,
    diameter_2: Values | None = None,
    length_2: Values | None = None,
    width_2: Values | None = None,
    mass_2: Values | None = None,
    contact_tolerance: Values | None = None,
    hold_down: Values | None = None,
    hold_down_force: Values | None = None,
    part_gap: Values | None = None,
    occupancy: Values | None = None,
    duration: Values | None = None,
    drop_height: Values | None = None,
    moving_mass: Values | None = None,
    base_mass: Values | None = None,
    load_mass: Values | None = None,
    load_damping: Values | None = None,
    conveyed_mass: Values | None = None,
    moving_inertia: Values | None = None,
    base_inertia: Values | None = None,
    spring_radius: Values | None = None,
    spring_angle: Values | None = None,
    spring_count: Values | None = None,
    spring_width: Values | None = None,
    spring_thickness: Values | None = None,
    spring_length: Values | None = None,
    elastic_modulus: Values | None = None,
    spring_density: Values | None = None,
    clamp_factor: Values | None = None,
    allowable_stress: Values | None = None,
    ring_down_frequency: Values | None = None,
    damping_ratio: Values | None = None,
    drive_force: Values | None = None,
    flux_density: Values | None = None,
    pole_area: Values | None = None,
    force_harmonic: Values | None = None,
    offset_along: Values | None = None,
    offset_upward: Values | None = None,
    spot_along: Values | None = None,
    spot_upward: Values | None = None,
    unbalance: Values | None = None,
    air_gap: Values | None = None,
    foot_stiffness: Values | None = None,
    foot_damping: Values | None = None,
    spring_stiffness: Values | None = None,
    track_fraction: Values | None = None,
    start_radius: Values | None = None,
    load_radius: Values | None = None,
    load_fraction: Values | None = None,
    small_diameter: Values | None = None,
    centre_of_mass: Values | None = None,
    radius_of_gyration: Values | None = None,
    sides: Values | None = None,
    arrival_rate: Values | None = None,
    arrival_speed: Values | None = None,
    part_pitch: Values | None = None,
    wanted_aspect: Values | None = None,
    shank_diameter: Values | None = None,
    device_order: Values | None = None,
    drop_count_1: Values | None = None,
    drop_count_2: Values | None = None,
    drop_count_3: Values | None = None,
    wiper_height_1: Values | None = None,
    ledge_width_1: Values | None = None,
    gap_length_1: Values | None = None,
    passed_aspect_1: Values | None = None,
    rail_width_1: Values | None = None,
    outlet_capacity_1: Values | None = None,
    turned_share_1: Values | None = None,
    turn_1: Values | None = None,
    wiper_height_2: Values | None = None,
    ledge_width_2: Values | None = None,
    gap_length_2: Values | None = None,
    passed_aspect_2: Values | None = None,
    rail_width_2: Values | None = None,
    outlet_capacity_2: Values | None = None,
    turned_share_2: Values | None = None,
    turn_2: Values | None = None,
    wiper_height_3: Values | None = None,
    ledge_width_3: Values | None = None,
    gap_length_3: Values | None = None,
    passed_aspect_3: Values | None = None,
    rail_width_3: Values | None = None,
    outlet_capacity_3: Values | None = None,
    turned_share_3: Values | None = None,
    turn_3: Values | None = None,
    wiper_height_4: Values | None = None,
    ledge_width_4: Values | None = None,
    gap_length_4: Values | None = None,
    passed_aspect_4: Values | None = None,
    rail_width_4: Values | None = None,
    outlet_capacity_4: Values | None = None,
    turned_share_4: Values | None = None,
    turn_4: Values | None = None,
    wiper_height_5: Values | None = None,
    ledge_width_5: Values | None = None,
    gap_length_5: Values | None = None,
    passed_aspect_5: Values | None = None,
    rail_width_5: Values | None = None,
    outlet_capacity_5: Values | None = None,
    turned_share_5: Values | None = None,
    turn_5: Values | None = None,
    wiper_height_6: Values | None = None,
    ledge_width_6: Values | None = None,
    gap_length_6: Values | None = None,
    passed_aspect_6: Values | None = None,
    rail_width_6: Values | None = None,
    outlet_capacity_6: Values | None = None,
    turned_share_6: Values | None = None,
    turn_6: Values | None = None,
    lap_time: Values | None = None,
    line_yield: Values | None = None,
    line_purity: Values | None = None,
    parts: Values | None = None,
    part_restitution: Values | None = None,
    friction_spread: Values | None = None,
    friction_seed: Values | None = None,
    track_stop_gap: Values | None = None,
    fixed_stop_gap: Values | None = None,
    row_velocity: Values | None = None,
    inflow: Values | None = None,
    lane_length: Values | None = None,
    closed_time: Values | None = None,
    open_time: Values | None = None,
    part_width: Values | None = None,
    bend_radius: Values | None = None,
    bend_length: Values | None = None,
    bend_friction: Values | None = None,
    line_push: Values | None = None,
    forward_acceleration: Values | None = None,
    return_acceleration: Values | None = None,
    row_mass: Values | None = None,
    front_velocity: Values | None = None,
    inner_diameter: Values | None = None,
    rolling_factor: Values | None = None,
    restitution_speed: Values | None = None,
    impact_speed: Values | None = None,
    contact_damping_ratio: Values | None = None,
    lining_stiffness: Values | None = None,
    contact_modulus: Values | None = None,
    contact_radius: Values | None = None,
    rolling_resistance: Values | None = None,
    uncertain: Mapping[str, Mapping[str, Any]] | None = None,
    analyses: Sequence[Literal["distribution", "sobol", "morris", "budget"]] | None = None,
    demands: Sequence[Mapping[str, Any]] | None = None,
    quantiles: Sequence[float] | None = None,
    samples: int | None = None,
    seed: int | None = None,
    drive: Mapping[str, Any] | None = None,
    verify: int | None = None,
    units: str | Sequence[str] | None = None,
    title: str | None = None,
    notes: str | None = None,
    parameters: Mapping[str, Values] | None = None,
    **numbered: Unpack[DriveNumbers],
) -> xarray.Dataset:
    """Return the variation of outputs with parameters that are not known exactly, over a grid.

    `uncertain` gives parameters and their distributions. `analyses` names the results for
    each output: mean and quantiles, probabilities, Sobol indices, a tolerance budget.

    *Values* are a number in the unit that is named, text with a unit such as ``"0.25 mm"``, or
    several of either, which become an axis of the dataset: a list, a range, an array, or a mapping
    such as ``{"start": "20 Hz", "stop": "120 Hz", "num": 101}``. ``None`` is a keyword left out.

    Parameters
    ----------
    study : Study, mapping or path, optional
        The study, which keywords add to; its `kind` is ``"sensitivity"``, and may be left out.
    scene : str, optional
        Name of a scene; `vibrafeed scenes` lists them.
    outputs : str or sequence of str, optional
        Names of the outputs.
    variant : {"thesis", "derived", "physical"}, optional
        thesis (as printed), derived (errors corrected) or physical, of closed forms; the scene's
        default where left out.
    method : str, optional
        The method of motion in time, as in a simulation, where outputs are those of a motion.
    frequency : values, optional
        Drive frequency. In Hz, 0 or more, for example "50 Hz" or "3000 rpm" or "3000 vpm".
    amplitude : values, optional
        Drive amplitude, zero to peak, along the drive direction. In m, 0 or more, for example "0.5
        mm".
    peak_to_peak : values, optional
        Twice the drive amplitude. In m, 0 or more, for example "1 mm".
    vertical_amplitude : values, optional
        Amplitude of the drive's part normal to the floor, zero to peak: A0 sin(beta). In m, 0 or
        more, for example "0.2 mm".
    vertical_peak_to_peak : values, optional
        Twice the vertical amplitude. In m, 0 or more, for example "0.4 mm".
    alpha : values, optional
        Azimuth of the drive in the floor plane, from the track (+x) towards +y. In degrees, from
        -180 to 180, for example "15 deg".
    beta : values, optional
        Elevation of the drive above the floor plane. In degrees, from -180 to 180, for example "20
        deg".
    gamma : values, optional
        Climb angle of the track; +x goes uphill. In degrees, from -90 to 90, for example "3 deg".
    delta : values, optional
        Lean of the track; the part leans on the wall. In degrees, from -90 to 90, for example "2
        deg".
    yaw : values, optional
        Turn of the part's axes about the floor normal. In degrees, from -180 to 180, for example
        "30 deg".
    radius : values, optional
        Radius of the bowl's track wall. In m, above 0, for example "0.3 m".
    gravity : values, optional
        Acceleration of gravity. In m s-2, above 0, for example "9.80665 m/s^2".
    friction : values, optional
        Coulomb friction coefficient, static and kinetic alike. 0 or more, for example 0.3.
    friction_static : values, optional
        Coulomb friction coefficient at rest. 0 or more, for example 0.3.
    friction_kinetic : values, optional
        Coulomb friction coefficient in sliding. 0 or more, for example 0.3.
    wall_friction : values, optional
        Coulomb friction coefficient at the wall of the track; the floor's unless given. 0 or more,
        for example 0.3.
    width : values, optional
        Width of the rectangular part, across. In m, above 0, for example "10 mm".
    height : values, optional
        Height of the rectangular part. In m, above 0, for example "1.5 mm".
    length : values, optional
        Length of the part, along the track. In m, above 0, for example "50 mm".
    diameter : values, optional
        Diameter of the cylindrical part. In m, above 0, for example "8 mm".
    mass : values, optional
        Mass of the part. In kg, above 0, for example "5 g".
    restitution : values, optional
        Coefficient of restitution: 0 for no rebound, 1 for full rebound. From 0 to 1, for example
        0.5.
    wall_restitution : values, optional
        Coefficient of restitution at the wall of the track; the floor's unless given. From 0 to 1,
        for example 0.3.
    speed : values, optional
        Speed of the part along the track at the start. In m s-1, 0 or more, for example "0.1 m/s".
    distance : values, optional
        Distance over which the drive is taken to act; the source gives no value for it. In m, 0 or
        more, for example "0.2 mm".
    time : values, optional
        Time since the start, with the drive held at its peak. In s, 0 or more, for example "20 ms".
    axis_yaw : values, optional
        Turn of the rolling cylinder's axis in the floor plane as chapter 4 counts it: from +x
        towards -y, clockwise seen from above. In degrees, from -180 to 180, for example "30 deg".
    spin_rate : values, optional
        Angular velocity of the rolling cylinder about its axis; positive rolls along +eta. In rad
        s-1, for example "40 rad/s" or "400 rpm".
    yaw_rate : values, optional
        Rate of the cylinder's yaw, in the sense of axis_yaw. In rad s-1, for example "2 rad/s".
    drilling_moment : values, optional
        Moment of all floor friction about the vertical through the centre, in the sense of
        axis_yaw. In N m, for example "0.1 mN m".
    pitch : values, optional
        Turn of the part in its plane of motion, clockwise: its right corner dips. In degrees, from
        -180 to 180, for example "20 deg".
    pitch_rate : values, optional
        Rate of the pitch, clockwise. In rad s-1, for example "2 rad/s" or "-90 deg/s".
    centre_along : values, optional
        Position of the part's centre along the plane. In m, for example "12 mm".
    centre_height : values, optional
        Height of the part's centre above the plane. In m, for example "8 mm".
    velocity_along : values, optional
        Velocity of the part's centre along the plane, to the right. In m s-1, for example "0.1
        m/s".
    velocity_upward : values, optional
        Velocity of the part's centre off the plane. In m s-1, for example "-0.1 m/s".
    position_x_1 : values, optional
        Centre of body 1, x. In m, for example "5 mm".
    position_y_1 : values, optional
        Centre of body 1, y. In m, for example "5 mm".
    angle_1 : values, optional
        Angle of the length of body 1, from +x towards +y. In degrees, for example "30 deg".
    velocity_x_1 : values, optional
        Velocity of body 1 before the impact, x. In m s-1, for example "0.2 m/s".
    velocity_y_1 : values, optional
        Velocity of body 1 before the impact, y. In m s-1, for example "0.2 m/s".
    spin_1 : values, optional
        Angular velocity of body 1 before the impact, from +x towards +y. In rad s-1, for example "3
        rad/s".
    position_z_1 : values, optional
        Centre of body 1, z. In m, for example "5 mm".
    azimuth_1 : values, optional
        Angle of the axis of body 1 in the floor plane, from +x towards +y. In degrees, for example
        "30 deg".
    elevation_1 : values, optional
        Angle of the axis of body 1 above the floor plane. In degrees, for example "10 deg".
    velocity_z_1 : values, optional
        Velocity of body 1 before the impact, z. In m s-1, for example "0.2 m/s".
    spin_x_1 : values, optional
        Angular velocity of body 1 before the impact, x. In rad s-1, for example "3 rad/s".
    spin_y_1 : values, optional
        Angular velocity of body 1 before the impact, y. In rad s-1, for example "3 rad/s".
    spin_z_1 : values, optional
        Angular velocity of body 1 before the impact, z. In rad s-1, for example "3 rad/s".
    diameter_1 : values, optional
        Diameter of body 1. In m, above 0, for example "8 mm".
    length_1 : values, optional
        Length of body 1. In m, above 0, for example "20 mm".
    width_1 : values, optional
        Width of body 1. In m, above 0, for example "10 mm".
    mass_1 : values, optional
        Mass of body 1. In kg, above 0, for example "5 g".
    position_x_2 : values, optional
        Centre of body 2, x. In m, for example "5 mm".
    position_y_2 : values, optional
        Centre of body 2, y. In m, for example "5 mm".
    angle_2 : values, optional
        Angle of the length of body 2, from +x towards +y. In degrees, for example "30 deg".
    velocity_x_2 : values, optional
        Velocity of body 2 before the impact, x. In m s-1, for example "0.2 m/s".
    velocity_y_2 : values, optional
        Velocity of body 2 before the impact, y. In m s-1, for example "0.2 m/s".
    spin_2 : values, optional
        Angular velocity of body 2 before the impact, from +x towards +y. In rad s-1, for example "3
        rad/s".
    position_z_2 : values, optional
        Centre of body 2, z. In m, for example "5 mm".
    azimuth_2 : values, optional
        Angle of the axis of body 2 in the floor plane, from +x towards +y. In degrees, for example
        "30 deg".
    elevation_2 : values, optional
        Angle of the axis of body 2 above the floor plane. In degrees, for example "10 deg".
    velocity_z_2 : values, optional
        Velocity of body 2 before the impact, z. In m s-1, for example "0.2 m/s".
    spin_x_2 : values, optional
        Angular velocity of body 2 before the impact, x. In rad s-1, for example "3 rad/s".
    spin_y_2 : values, optional
        Angular velocity of body 2 before the impact, y. In rad s-1, for example "3 rad/s".
    spin_z_2 : values, optional
        Angular velocity of body 2 before the impact, z. In rad s-1, for example "3 rad/s".
    diameter_2 : values, optional
        Diameter of body 2. In m, above 0, for example "8 mm".
    length_2 : values, optional
        Length of body 2. In m, above 0, for example "20 mm".
    width_2 : values, optional
        Width of body 2. In m, above 0, for example "10 mm".
    mass_2 : values, optional
        Mass of body 2. In kg, above 0, for example "5 g".
    contact_tolerance : values, optional
        Largest gap or overlap that counts as touching, as a share of the bodies' size, the sum of
        their half diagonals. 1 lets the impact happen as the bodies are placed. 0 or more, for
        example "1e-6".
    hold_down : values, optional
        Force per mass that presses the part onto the floor, of a magnet or a vacuum. In m s-2, 0 or
        more, for example "20 m/s^2".
    hold_down_force : values, optional
        Force that presses the part onto the floor, of a magnet or a vacuum; with the mass of the
        part it gives hold_down. In N, 0 or more, for example "0.5 N".
    part_gap : values, optional
        Free length between two parts on the track. In m, 0 or more, for example "5 mm".
    occupancy : values, optional
        Share of the track's length that parts cover, 1 where each touches the next; follows from
        part_gap unless given. From 0 to 1, for example 0.6.
    duration : values, optional
        Time after which the run ends. In s, above 0, for example "2 s".
    drop_height : values, optional
        Height of the part's lowest corner above the plane at the start. In m, 0 or more, for
        example "10 mm".
    moving_mass : values, optional
        Mass of trough or bowl, with what is fixed to it. In kg, above 0, for example "10 kg".
    base_mass : values, optional
        Mass of the base, or counter-mass. In kg, above 0, for example "30 kg".
    load_mass : values, optional
        Mass of parts that move with the track, neither sliding nor hopping. In kg, 0 or more, for
        example "0.5 kg".
    load_damping : values, optional
        Damping between track and ground by parts that slide and hop. In N s m-1, 0 or more, for
        example "40 N s/m".
    conveyed_mass : values, optional
        Mass of all parts that travel on the track; amplitude and motion are found together. In kg,
        0 or more, for example "0.5 kg".
    moving_inertia : values, optional
        Moment of inertia of the bowl about its axis. In kg m2, above 0, for example "0.25 kg m^2".
    base_inertia : values, optional
        Moment of inertia of the base about the same axis. In kg m2, above 0, for example "0.9 kg
        m^2".
    spring_radius : values, optional
        Radius from the bowl's axis to the leaf springs. In m, above 0, for example "150 mm".
    spring_angle : values, optional
        Tilt of the leaf springs from the vertical; equals the drive's angle of a linear unit. In
        degrees, from -89 to 89, for example "20 deg".
    spring_count : values, optional
        Number of leaf springs in all packs, separated by spacers. Above 0, for example 8.
    spring_width : values, optional
        Width of a leaf spring. In m, above 0, for example "40 mm".
    spring_thickness : values, optional
        Thickness of a leaf spring. In m, above 0, for example "3 mm".
    spring_length : values, optional
        Length of a leaf spring between its clamps. In m, above 0, for example "100 mm".
    elastic_modulus : values, optional
        Elastic modulus of the leaf springs: 206 GPa for spring steel. In Pa, above 0, for example
        "206 GPa".
    spring_density : values, optional
        Density of the leaf springs: 7850 kg/m^3 for spring steel. In kg m-3, above 0, for example
        "7850 kg/m^3".
    clamp_factor : values, optional
        Stiffness of the leaf springs relative to rigid clamps. Above 0, for example 0.9.
    allowable_stress : values, optional
        Bending stress that the leaf springs endure permanently. In Pa, above 0, for example "250
        MPa".
    ring_down_frequency : values, optional
        Frequency at which the empty unit vibrates freely after a knock. In Hz, above 0, for example
        "53 Hz".
    damping_ratio : values, optional
        Logarithmic decrement of the ring-down over 2 pi. Above 0, for example 0.02.
    drive_force : values, optional
        Amplitude of the force between both masses, at the drive's frequency; a magnet's follows
        from flux_density and pole_area, an unbalance's from unbalance. In N, above 0, for example
        "100 N".
    flux_density : values, optional
        Peak of the flux density in the magnet's gap. In T, above 0, for example "0.5 T".
    pole_area : values, optional
        Area of all poles of the magnet that pull. In m2, above 0, for example "12 cm^2".
    force_harmonic : values, optional
        Second harmonic over the first: 0.25 of a magnet on a half wave that pulls the track back
        and down, -0.25 of one that pulls it forward and up, 0 on a full wave. From -1 to 1, for
        example 0.25.
    offset_along : values, optional
        Moving mass centre ahead of the base's. In m, for example "0 mm".
    offset_upward : values, optional
        Moving mass centre above the base's. In m, for example "0 mm".
    spot_along : values, optional
        Place on the track ahead of the mass centre. In m, for example "0 mm".
    spot_upward : values, optional
        Place on the track above the mass centre. In m, for example "0 mm".
    unbalance : values, optional
        Mass of an unbalance times its radius. In kg m, above 0, for example "0.002 kg m".
    air_gap : values, optional
        Air gap of the magnet at rest, along the stroke. In m, above 0, for example "2 mm".
    foot_stiffness : values, optional
        Stiffness of all feet together; 0 if the base is free. In N m-1, 0 or more, for example
        "50000 N/m".
    foot_damping : values, optional
        Damping of all feet together. In N s m-1, 0 or more, for example "100 N s/m".
    spring_stiffness : values, optional
        Stiffness of all leaf springs along the stroke; computed from their sizes by default. In N
        m-1, above 0, for example "1000 N/mm".
    track_fraction : values, optional
        Share of the track's length behind the part: 0 at its start, 1 at the exit. From 0 to 1, for
        example 0.5.
    start_radius : values, optional
        Radius at which the track starts. In m, above 0, for example "100 mm".
    load_radius : values, optional
        Radius at which the load lies; by default that of the part. In m, above 0, for example "180
        mm".
    load_fraction : values, optional
        Share of the track's length at which the load of all its parts is taken to act. From 0 to 1,
        for example 0.5.
    small_diameter : values, optional
        Diameter of the end opposite to that of diameter; 0 of a full cone. In m, 0 or more, for
        example "12 mm".
    centre_of_mass : values, optional
        Distance of the centre of mass from the end of diameter. In m, above 0, for example "8 mm".
    radius_of_gyration : values, optional
        Root of moment of inertia over mass, about a line across the part through its centre. In m,
        above 0, for example "7 mm".
    sides : values, optional
        Sides of a regular prism; diameter is that of the circle through its corners. 3 or more, for
        example 6.
    arrival_rate : values, optional
        Parts a minute that arrive at the first device. In min-1, above 0, for example "300 1/min".
    arrival_speed : values, optional
        Conveying velocity of the parts before the first device. In m s-1, above 0, for example "60
        mm/s".
    part_pitch : values, optional
        Distance from part to part in a row. In m, above 0, for example "22 mm".
    wanted_aspect : values, optional
        Number of the aspect in which parts are to leave. From 1 to 3, for example 1.
    shank_diameter : values, optional
        Diameter of the shank of a part with a head; `diameter` is that of the head. In m, above 0,
        for example "4 mm".
    device_order : values, optional
        Number of the order of the devices, in lexical order: 1 is the order of their positions, the
        last one is backwards. From 1 to 720, for example 1.
    drop_count_1 : values, optional
        Parts of a drop test that came to rest in aspect 1. 0 or more, for example 129.
    drop_count_2 : values, optional
        Parts of a drop test that came to rest in aspect 2. 0 or more, for example 129.
    drop_count_3 : values, optional
        Parts of a drop test that came to rest in aspect 3. 0 or more, for example 129.
    wiper_height_1 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_1 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_1 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_1 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_1 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_1 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_1 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_1 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_2 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_2 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_2 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_2 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_2 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_2 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_2 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_2 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_3 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_3 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_3 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_3 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_3 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_3 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_3 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_3 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_4 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_4 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_4 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_4 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_4 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_4 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_4 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_4 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_5 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_5 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_5 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_5 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_5 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_5 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_5 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_5 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    wiper_height_6 : values, optional
        Height of a wiper's edge over the track: passes lower parts. In m, above 0, for example "12
        mm".
    ledge_width_6 : values, optional
        Width of a narrow track along the wall: passes parts whose centre is above it. In m, above
        0, for example "9 mm".
    gap_length_6 : values, optional
        Length of a gap in the track: passes parts longer than twice that. In m, above 0, for
        example "8 mm".
    passed_aspect_6 : values, optional
        Number of the only aspect that passes the device. From 1 to 3, for example 1.
    rail_width_6 : values, optional
        Distance of two rails: parts with a head hang in it by their shank. In m, above 0, for
        example "5 mm".
    outlet_capacity_6 : values, optional
        Maximum number of parts per minute that pass a pressure break or outlet. In min-1, above 0,
        for example "120 1/min".
    turned_share_6 : values, optional
        Share of the parts of an aspect that a riser, step or wiper turns into another. From 0 to 1,
        for example 0.6.
    turn_6 : values, optional
        Aspects before and after turning: 21 turns aspect 2 into aspect 1. From 12 to 32, for
        example 21.
    lap_time : values, optional
        Time from the bowl to the first device and back. In s, above 0, for example "40 s".
    line_yield : values, optional
        Share of the parts that pass the devices behind the track, in any aspect, as yield of
        orienting-line. From 0 to 1, for example 0.79.
    line_purity : values, optional
        Share of the parts leaving the devices behind the track that lie as wanted, as purity of
        orienting-line. From 0 to 1, for example 1.0.
    parts : values, optional
        Number of parts in the row. From 2 to 64, for example 8.
    part_restitution : values, optional
        Relative velocity after a collision of two parts over that before. From 0 to 1, for example
        0.3.
    friction_spread : values, optional
        Standard deviation of the friction of the parts, drawn within three of it. 0 or more, for
        example 0.03.
    friction_seed : values, optional
        Seed: each whole number samples another row. From 0 to 1e+09, for example 1.
    track_stop_gap : values, optional
        Gap between the front part and a stop that moves with the track, at the start. In m, 0 or
        more, for example "0 mm".
    fixed_stop_gap : values, optional
        Gap between the front part and a stop at rest beside the track, at the start. In m, 0 or
        more, for example "0 mm".
    row_velocity : values, optional
        Mean velocity of the parts on the free lane: measured, or of a study of their motion. In m
        s-1, above 0, for example "80 mm/s".
    inflow : values, optional
        Parts a minute that come onto the lane. In min-1, 0 or more, for example "120 1/min".
    lane_length : values, optional
        Length of the lane. In m, above 0, for example "500 mm".
    closed_time : values, optional
        Time for which the escapement is closed. In s, 0 or more, for example "200 ms".
    open_time : values, optional
        Minimum time for which the escapement is open. In s, 0 or more, for example "100 ms".
    part_width : values, optional
        Width of a part, across the lane. In m, above 0, for example "10 mm".
    bend_radius : values, optional
        Radius of the bend's outer wall. In m, above 0, for example "200 mm".
    bend_length : values, optional
        Length of the part of a row inside the bend. In m, above 0, for example "200 mm".
    bend_friction : values, optional
        Coefficient of friction at the wall of the bend. Above 0, for example 0.3.
    line_push : values, optional
        Force per length with which the track pushes the row. In N m-1, above 0, for example "1
        N/m".
    forward_acceleration : values, optional
        Acceleration of the track forwards, which carries parts. In m s-2, above 0, for example "2
        m/s^2".
    return_acceleration : values, optional
        Acceleration of the track backwards, under the parts. In m s-2, above 0, for example "2
        m/s^2".
    row_mass : values, optional
        Mass of all parts of the row. In kg, above 0, for example "100 g".
    front_velocity : values, optional
        Mean velocity of the parts in front. In m s-1, 0 or more, for example "60 mm/s".
    inner_diameter : values, optional
        Diameter of the hole of a tube or ring, or of the hollow of a ball; the part's own of a hoop
        or a thin shell. In m, 0 or more, for example "6 mm".
    rolling_factor : values, optional
        Ratio m r^2/I about the rolling axis: 5/2 of a ball, 3/2 of a thin shell, 2 of a cylinder or
        disc, 1 of a hoop; follows from the diameters unless given. Above 0, for example 2.5.
    restitution_speed : values, optional
        Speed of impact at which the restitution was measured. In m s-1, above 0, for example "0.1
        m/s".
    impact_speed : values, optional
        Speed of approach normal to the contact. In m s-1, above 0, for example "0.2 m/s".
    contact_damping_ratio : values, optional
        Damping ratio of the spring and damper of a contact that never pulls. 0 or more, for example
        0.2.
    lining_stiffness : values, optional
        Force over depth of a part on a lined track, such as brush or urethane. In N m-1, above 0,
        for example "20 N/mm".
    contact_modulus : values, optional
        Reduced modulus of both materials: 1/E is the sum of (1 - nu^2)/E of each. In Pa, above 0,
        for example "115 GPa".
    contact_radius : values, optional
        Radius of a ball, or of a rounded part where it strikes. In m, above 0, for example "4 mm".
    rolling_resistance : values, optional
        Coefficient of rolling resistance: lever of the floor's force over the radius of the part.
        Hard steel on steel has some 0.001, plastic on a lined track some 0.02. 0 or more, for
        example 0.01.
    uncertain : mapping of str to mapping, optional
        Parameters that are not known exactly, and their distributions.
    analyses : sequence of Literal["distribution", "sobol", "morris", "budget"], optional
        What to compute: distribution (mean, standard deviation, quantiles, demands), sobol (which
        parameter the variance comes from), morris (a first, cheaper screening of many parameters),
        budget (what each tolerance does).
    demands : sequence of mapping, optional
        Outputs within bounds, or regimes, whose probability is computed.
    quantiles : sequence of float, optional
        Shares of the parts; the result has the value that this share stays below.
    samples : int, optional
        Number of points sampled from the distributions for each design, a power of two; Sobol
        indices take as many again for each parameter, and once more.
    seed : int, optional
        Seed of the sampled points.
    drive : mapping, optional
        A measured drive: the recording of an accelerometer. Its harmonics are parameters, as far as
        the study does not give them itself.
    verify : int, optional
        Number of random cells to evaluate again, with 50 digits or by another method; the result
        states the worst of them.
    units : str or sequence of str, optional
        Units that screens and pictures show: trade (the default), si, or units such as m/min, each
        for its kind. Files hold SI.
    title : str, optional
        Title of the dataset.
    notes : str, optional
        Notes that are stored in the dataset.
    parameters : mapping of str to values, optional
        Fixed or ranged parameters.
    drive_factor : values, optional
        Factor by which every amplitude or acceleration of the drive is multiplied. 0 or more, for
        example 1.2.
    amplitude_along_1 to _10 : values, optional
        Amplitude of the track's motion along the track at the drive frequency, zero to peak. In m,
        0 or more, for example "0.1 mm".
    amplitude_across_1 to _10 : values, optional
        Amplitude of the track's motion across the track at the drive frequency, zero to peak. In m,
        0 or more, for example "0.1 mm".
    amplitude_normal_1 to _10 : values, optional
        Amplitude of the track's motion off the floor at the drive frequency, zero to peak. In m, 0
        or more, for example "0.1 mm".
    phase_along_1 to _10 : values, optional
        Lead of the track's motion along the track at the drive frequency: the displacement is A
        sin( w t + phi). In degrees, from -720 to 720, for example "90 deg".
    phase_across_1 to _10 : values, optional
        Lead of the track's motion across the track at the drive frequency: the displacement is A
        sin( w t + phi). In degrees, from -720 to 720, for example "90 deg".
    phase_normal_1 to _10 : values, optional
        Lead of the track's motion off the floor at the drive frequency: the displacement is A sin(
        w t + phi). In degrees, from -720 to 720, for example "90 deg".
    acceleration_along_1 to _12 : values, optional
        Acceleration of the track along the track during step 1 of a period. In m s-2, for example
        "4 m/s^2".
    acceleration_across_1 to _12 : values, optional
        Acceleration of the track across the track during step 1 of a period. In m s-2, for example
        "4 m/s^2".
    acceleration_normal_1 to _12 : values, optional
        Acceleration of the track off the floor during step 1 of a period. In m s-2, for example "4
        m/s^2".
    duration_1 to _12 : values, optional
        Relative duration of step 1; the durations of all steps divide the period. 0 or more, for
        example 0.25.
    part_friction_1 to _10 : values, optional
        Coefficient of friction between the track and part 1 of a row, the rearmost. 0 or more, for
        example 0.3.
    part_mass_1 to _10 : values, optional
        Mass of part 1 of a row, the rearmost. In kg, above 0, for example "4 g".
    part_gap_1 to _10 : values, optional
        Gap in front of part 1 of a row, the rearmost, at the start. In m, 0 or more, for example "1
        mm".
    stretch_turns_1 to _6 : values, optional
        Turns of stretch 1 of the track. Above 0, for example 1.5.
    stretch_radius_1 to _6 : values, optional
        Radius at the end of stretch 1. In m, above 0, for example "150 mm".
    stretch_climb_1 to _6 : values, optional
        Climb of stretch 1; that of the stretch before unless given. In degrees, from -80 to 80, for
        example "3 deg".
    stretch_friction_1 to _6 : values, optional
        Coefficient of friction on stretch 1; that of the stretch before unless given. 0 or more,
        for example 0.3.

    Returns
    -------
    xarray.Dataset
        The results of each output, over the axes; units, errors, and `regime` of the nominal
        values. Along `uncertain` are the uncertain parameters, in the order of its
        `flag_meanings`.

    Raises
    ------
    StudyError
        With every problem, also where it is a study of another kind.

    Examples
    --------
    >>> told = vibrafeed.sensitivity(
    ...     scene="rectangle-on-plane", outputs="acceleration_x", frequency="50 Hz",
    ...     amplitude="0.1 mm", beta=30,
    ...     uncertain={"friction": {"mean": 0.3, "deviation": 0.03}},
    ...     demands=[{"output": "acceleration_x", "at_least": "7 m/s^2"}],
    ... )
    >>> 0 < float(told.probability_acceleration_x_at_least) < 1
    True
    """
    keywords = _functions.said(locals())
    return _functions.sensitivity(study, **keywords)


def calibrate(
    study: StudyLike | None = None,
    /,
    *,
    scene: SimulatedScene | None = None,
    method: str | None = None,
    observations: str | Sequence[Mapping[str, Any]] | None = None,
    error: float | str | None = None,
    unknowns: Mapping[str, Mapping[str, Any]] | None = None,
    frequency: Values | None = None,
    amplitude: Values | None = None,
    peak_to_peak: Values | None = None,
    vertical_amplitude: Values | None = None,
    vertical_peak_to_peak: Values | None = None,
    alpha: Values | None = None,
    beta: Values | None = None,
    gamma: Values | None = None,
    delta: Values | None = None,
    radius: Values | None = None,
    gravity: Values | None = None,
    friction: Values | None = None,
    friction_static: Values | None = None,
    friction_kinetic: Values | None = None,
    wall_friction: Values | None = None,
    height: Values | None = None,
    length: Values | None = None,
    diameter: Values | None = None,
    mass: Values | None = None,
    restitution: Values | None = None,
    wall_restitution: Values | None = None,
    pitch: Values | None = None,
    pitch_rate: Values | None = None,
    velocity_along: Values | None = None,
    velocity_upward: Values | None = None,
    hold_down: Values | None = None,
    hold_down_force: Values | None = None,
    part_gap: Values | None = None,
    occupancy: Values | None = None,
    duration: Values | None = None,
    drop_height: Values | None = None,
    moving_mass: Values | None = None,
    base_mass: Values | None = None,
    load_mass: Values | None = None,
    load_damping: Values | None = None,
    conveyed_mass: Values | None = None,
    moving_inertia: Values | None = None,
    base_inertia: Values | None = None,
    spring_radius: Values | None = None,
    spring_angle: Values | None = None,
    spring_count: Values | None = None,
    spring_width: Values | None = None,
    spring_thickness: Values | None = None,
    spring_length: Values | None = None,
    elastic_modulus: Values | None = None,
    spring_density: Values | None = None,
    clamp_factor: Values | None = None,
    allowable_stress: Values | None = None,
    ring_down_frequency: Values | None = None,
    damping_ratio: Values | None = None,
    drive_force: Values | None = None,
    flux_density: Values | None = None,
    pole_area: Values | None = None,
    force_harmonic: Values | None = None,
    offset_along: Values | None = None,
    offset_upward: Values | None = None,
    spot_along: Values | None = None,
    spot_upward: Values | None = None,
    unbalance: Values | None = None,
    air_gap: Values | None = None,
    foot_stiffness: Values | None = None,
    foot_damping: Values | None = None,
    spring_stiffness: Values | None = None,
    track_fraction: Values | None = None,
    start_radius: Values | None = None,
    load_radius: Values | None = None,
    load_fraction: Values | None = None,
    line_yield: Values | None = None,
    line_purity: Values | None = None,
    parts: Values | None = None,
    part_restitution: Values | None = None,
    friction_spread: Values | None = None,
    friction_seed: Values | None = None,
    track_stop_gap: Values | None = None,
    fixed_stop_gap: Values | None = None,
    inner_diameter: Values | None = None,
    rolling_factor: Values | None = None,
    rolling_resistance: Values | None = None,
    offsets: Mapping[str, Mapping[str, Any]] | None = None,
    factors: Mapping[str, Mapping[str, Any]] | None = None,
    candidates: Mapping[str, Values] | None = None,
    discrepancy: bool | None = None,
    outlier_probability: float | None = None,
    points: int | None = None,
    drive: Mapping[str, Any] | None = None,
    tolerance: float | None = None,
    max_periods: int | None = None,
    steps_per_period: int | None = None,
    slip_speed: float | None = None,
    contact_stiffness: float | None = None,
    verify: int | None = None,
    units: str | Sequence[str] | None = None,
    title: str | None = None,
    notes: str | None = None,
    parameters: Mapping[str, Values] | None = None,
    **numbered: Unpack[DriveNumbers],
) -> xarray.Dataset:
    """Return the estimates of unknown parameters from measured speeds.

    `observations` are the runs, each with the parameters that are its own, what was measured and
    its error; they may stand in a CSV or XLSX file. `unknowns`, `offsets` and `factors` are what is
    looked for.

    *Values* are a number in the unit that is named, or text with a unit such as ``"0.25 mm"``.
    ``None`` is a keyword left out.

    Parameters
    ----------
    study : Study, mapping or path, optional
        The study, which keywords add to; its `kind` is ``"calibrate"``, and may be left out.
    scene : str, optional
        Name of a scene; `vibrafeed scenes` lists them.
    method : str, optional
        events (from event to event, exact), time-stepping, reference (of high order, slow) or
        regularised (stiff, for comparison); events where left out.
    observations : str or sequence of mapping, optional
        The runs: what differs between them, and what was measured; or the name of a CSV or XLSX
        file in the study's folder.
    error : float or str, optional
        Standard deviation of the measured values, for runs that do not give their own: a number,
        text with a unit, or a share such as '5 %'.
    unknowns : mapping of str to mapping, optional
        The unknown parameters: { lower, upper }, or { mean, deviation }.
    frequency : values, optional
        Drive frequency. In Hz, 0 or more, for example "50 Hz" or "3000 rpm" or "3000 vpm".
    amplitude : values, optional
        Drive amplitude, zero to peak, along the drive direction. In m, 0 or more, for example "0.5
        mm".
    peak_to_peak : values, optional
        Twice the drive amplitude. In m, 0 or more, for example "1 mm".
    vertical_amplitude : values, optional
        Amplitude of the drive's part normal to the floor, zero to peak: A0 sin(beta). In m, 0 or
        more, for example "0.2 mm".
    vertical_peak_to_peak : values, optional
        Twice the vertical amplitude. In m, 0 or more, for example "0.4 mm".
    alpha : values, optional
        Azimuth of the drive in the floor plane, from the track (+x) towards +y. In degrees, from
        -180 to 180, for example "15 deg".
    beta : values, optional
        Elevation of the drive above the floor plane. In degrees, from -180 to 180, for example "20
        deg".
    gamma : values, optional
        Climb angle of the track; +x goes uphill. In degrees, from -90 to 90, for example "3 deg".
    delta : values, optional
        Lean of the track; the part leans on the wall. In degrees, from -90 to 90, for example "2
        deg".
    radius : values, optional
        Radius of the bowl's track wall. In m, above 0, for example "0.3 m".
    gravity : values, optional
        Acceleration of gravity. In m s-2, above 0, for example "9.80665 m/s^2".
    friction : values, optional
        Coulomb friction coefficient, static and kinetic alike. 0 or more, for example 0.3.
    friction_static : values, optional
        Coulomb friction coefficient at rest. 0 or more, for example 0.3.
    friction_kinetic : values, optional
        Coulomb friction coefficient in sliding. 0 or more, for example 0.3.
    wall_friction : values, optional
        Coulomb friction coefficient at the wall of the track; the floor's unless given. 0 or more,
        for example 0.3.
    height : values, optional
        Height of the rectangular part. In m, above 0, for example "1.5 mm".
    length : values, optional
        Length of the part, along the track. In m, above 0, for example "50 mm".
    diameter : values, optional
        Diameter of the cylindrical part. In m, above 0, for example "8 mm".
    mass : values, optional
        Mass of the part. In kg, above 0, for example "5 g".
    restitution : values, optional
        Coefficient of restitution: 0 for no rebound, 1 for full rebound. From 0 to 1, for example
        0.5.
    wall_restitution : values, optional
        Coefficient of restitution at the wall of the track; the floor's unless given. From 0 to 1,
        for example 0.3.
    pitch : values, optional
        Turn of the part in its plane of motion, clockwise: its right corner dips. In degrees, from
        -180 to 180, for example "20 deg".
    pitch_rate : values, optional
        Rate of the pitch, clockwise. In rad s-1, for example "2 rad/s" or "-90 deg/s".
    velocity_along : values, optional
        Velocity of the part's centre along the plane, to the right. In m s-1, for example "0.1
        m/s".
    velocity_upward : values, optional
        Velocity of the part's centre off the plane. In m s-1, for example "-0.1 m/s".
    hold_down : values, optional
        Force per mass that presses the part onto the floor, of a magnet or a vacuum. In m s-2, 0 or
        more, for example "20 m/s^2".
    hold_down_force : values, optional
        Force that presses the part onto the floor, of a magnet or a vacuum; with the mass of the
        part it gives hold_down. In N, 0 or more, for example "0.5 N".
    part_gap : values, optional
        Free length between two parts on the track. In m, 0 or more, for example "5 mm".
    occupancy : values, optional
        Share of the track's length that parts cover, 1 where each touches the next; follows from
        part_gap unless given. From 0 to 1, for example 0.6.
    duration : values, optional
        Time after which the run ends. In s, above 0, for example "2 s".
    drop_height : values, optional
        Height of the part's lowest corner above the plane at the start. In m, 0 or more, for
        example "10 mm".
    moving_mass : values, optional
        Mass of trough or bowl, with what is fixed to it. In kg, above 0, for example "10 kg".
    base_mass : values, optional
        Mass of the base, or counter-mass. In kg, above 0, for example "30 kg".
    load_mass : values, optional
        Mass of parts that move with the track, neither sliding nor hopping. In kg, 0 or more, for
        example "0.5 kg".
    load_damping : values, optional
        Damping between track and ground by parts that slide and hop. In N s m-1, 0 or more, for
        example "40 N s/m".
    conveyed_mass : values, optional
        Mass of all parts that travel on the track; amplitude and motion are found together. In kg,
        0 or more, for example "0.5 kg".
    moving_inertia : values, optional
        Moment of inertia of the bowl about its axis. In kg m2, above 0, for example "0.25 kg m^2".
    base_inertia : values, optional
        Moment of inertia of the base about the same axis. In kg m2, above 0, for example "0.9 kg
        m^2".
    spring_radius : values, optional
        Radius from the bowl's axis to the leaf springs. In m, above 0, for example "150 mm".
    spring_angle : values, optional
        Tilt of the leaf springs from the vertical; equals the drive's angle of a linear unit. In
        degrees, from -89 to 89, for example "20 deg".
    spring_count : values, optional
        Number of leaf springs in all packs, separated by spacers. Above 0, for example 8.
    spring_width : values, optional
        Width of a leaf spring. In m, above 0, for example "40 mm".
    spring_thickness : values, optional
        Thickness of a leaf spring. In m, above 0, for example "3 mm".
    spring_length : values, optional
        Length of a leaf spring between its clamps. In m, above 0, for example "100 mm".
    elastic_modulus : values, optional
        Elastic modulus of the leaf springs: 206 GPa for spring steel. In Pa, above 0, for example
        "206 GPa".
    spring_density : values, optional
        Density of the leaf springs: 7850 kg/m^3 for spring steel. In kg m-3, above 0, for example
        "7850 kg/m^3".
    clamp_factor : values, optional
        Stiffness of the leaf springs relative to rigid clamps. Above 0, for example 0.9.
    allowable_stress : values, optional
        Bending stress that the leaf springs endure permanently. In Pa, above 0, for example "250
        MPa".
    ring_down_frequency : values, optional
        Frequency at which the empty unit vibrates freely after a knock. In Hz, above 0, for example
        "53 Hz".
    damping_ratio : values, optional
        Logarithmic decrement of the ring-down over 2 pi. Above 0, for example 0.02.
    drive_force : values, optional
        Amplitude of the force between both masses, at the drive's frequency; a magnet's follows
        from flux_density and pole_area, an unbalance's from unbalance. In N, above 0, for example
        "100 N".
    flux_density : values, optional
        Peak of the flux density in the magnet's gap. In T, above 0, for example "0.5 T".
    pole_area : values, optional
        Area of all poles of the magnet that pull. In m2, above 0, for example "12 cm^2".
    force_harmonic : values, optional
        Second harmonic over the first: 0.25 of a magnet on a half wave that pulls the track back
        and down, -0.25 of one that pulls it forward and up, 0 on a full wave. From -1 to 1, for
        example 0.25.
    offset_along : values, optional
        Moving mass centre ahead of the base's. In m, for example "0 mm".
    offset_upward : values, optional
        Moving mass centre above the base's. In m, for example "0 mm".
    spot_along : values, optional
        Place on the track ahead of the mass centre. In m, for example "0 mm".
    spot_upward : values, optional
        Place on the track above the mass centre. In m, for example "0 mm".
    unbalance : values, optional
        Mass of an unbalance times its radius. In kg m, above 0, for example "0.002 kg m".
    air_gap : values, optional
        Air gap of the magnet at rest, along the stroke. In m, above 0, for example "2 mm".
    foot_stiffness : values, optional
        Stiffness of all feet together; 0 if the base is free. In N m-1, 0 or more, for example
        "50000 N/m".
    foot_damping : values, optional
        Damping of all feet together. In N s m-1, 0 or more, for example "100 N s/m".
    spring_stiffness : values, optional
        Stiffness of all leaf springs along the stroke; computed from their sizes by default. In N
        m-1, above 0, for example "1000 N/mm".
    track_fraction : values, optional
        Share of the track's length behind the part: 0 at its start, 1 at the exit. From 0 to 1, for
        example 0.5.
    start_radius : values, optional
        Radius at which the track starts. In m, above 0, for example "100 mm".
    load_radius : values, optional
        Radius at which the load lies; by default that of the part. In m, above 0, for example "180
        mm".
    load_fraction : values, optional
        Share of the track's length at which the load of all its parts is taken to act. From 0 to 1,
        for example 0.5.
    line_yield : values, optional
        Share of the parts that pass the devices behind the track, in any aspect, as yield of
        orienting-line. From 0 to 1, for example 0.79.
    line_purity : values, optional
        Share of the parts leaving the devices behind the track that lie as wanted, as purity of
        orienting-line. From 0 to 1, for example 1.0.
    parts : values, optional
        Number of parts in the row. From 2 to 64, for example 8.
    part_restitution : values, optional
        Relative velocity after a collision of two parts over that before. From 0 to 1, for example
        0.3.
    friction_spread : values, optional
        Standard deviation of the friction of the parts, drawn within three of it. 0 or more, for
        example 0.03.
    friction_seed : values, optional
        Seed: each whole number samples another row. From 0 to 1e+09, for example 1.
    track_stop_gap : values, optional
        Gap between the front part and a stop that moves with the track, at the start. In m, 0 or
        more, for example "0 mm".
    fixed_stop_gap : values, optional
        Gap between the front part and a stop at rest beside the track, at the start. In m, 0 or
        more, for example "0 mm".
    inner_diameter : values, optional
        Diameter of the hole of a tube or ring, or of the hollow of a ball; the part's own of a hoop
        or a thin shell. In m, 0 or more, for example "6 mm".
    rolling_factor : values, optional
        Ratio m r^2/I about the rolling axis: 5/2 of a ball, 3/2 of a thin shell, 2 of a cylinder or
        disc, 1 of a hoop; follows from the diameters unless given. Above 0, for example 2.5.
    rolling_resistance : values, optional
        Coefficient of rolling resistance: lever of the floor's force over the radius of the part.
        Hard steel on steel has some 0.001, plastic on a lined track some 0.02. 0 or more, for
        example 0.01.
    offsets : mapping of str to mapping, optional
        Unknown offsets of parameters, such as the mounting error of an angle.
    factors : mapping of str to mapping, optional
        Unknown factors of parameters, such as that of all amplitudes.
    candidates : mapping of str to values, optional
        Drives that could be run next, as values or ranges; the result says which of them would add
        most.
    discrepancy : bool, optional
        True if speeds may scatter by more than their errors, for effects that the model lacks.
    outlier_probability : float, optional
        Probability that an observed regime is wrong.
    points : int, optional
        Maximum number of grid points of the unknowns; each needs one motion per run.
    drive : mapping, optional
        A measured drive: the recording of an accelerometer. Its harmonics are parameters, as far as
        the study does not give them itself.
    tolerance : float, optional
        Largest error of a periodic state, as a share of the drive. From 0.001 on events in the
        plane follow an aperiodic motion only until the error of its mean velocity is that share of
        it.
    max_periods : int, optional
        Maximum number of drive periods that are simulated for one point.
    steps_per_period : int, optional
        Time steps per period, for time-stepping; steps times periods are at most 25 million.
    slip_speed : float, optional
        Slip speed, in g/w, up to which regularised friction rises.
    contact_stiffness : float, optional
        Stiffness of the regularised floor, over m w^2.
    verify : int, optional
        Number of random cells to evaluate again, with 50 digits or by another method; the result
        states the worst of them.
    units : str or sequence of str, optional
        Units that screens and pictures show: trade (the default), si, or units such as m/min, each
        for its kind. Files hold SI.
    title : str, optional
        Title of the dataset.
    notes : str, optional
        Notes that are stored in the dataset.
    parameters : mapping of str to values, optional
        Fixed or ranged parameters.
    drive_factor : values, optional
        Factor by which every amplitude or acceleration of the drive is multiplied. 0 or more, for
        example 1.2.
    amplitude_along_1 to _10 : values, optional
        Amplitude of the track's motion along the track at the drive frequency, zero to peak. In m,
        0 or more, for example "0.1 mm".
    amplitude_across_1 to _10 : values, optional
        Amplitude of the track's motion across the track at the drive frequency, zero to peak. In m,
        0 or more, for example "0.1 mm".
    amplitude_normal_1 to _10 : values, optional
        Amplitude of the track's motion off the floor at the drive frequency, zero to peak. In m, 0
        or more, for example "0.1 mm".
    phase_along_1 to _10 : values, optional
        Lead of the track's motion along the track at the drive frequency: the displacement is A
        sin( w t + phi). In degrees, from -720 to 720, for example "90 deg".
    phase_across_1 to _10 : values, optional
        Lead of the track's motion across the track at the drive frequency: the displacement is A
        sin( w t + phi). In degrees, from -720 to 720, for example "90 deg".
    phase_normal_1 to _10 : values, optional
        Lead of the track's motion off the floor at the drive frequency: the displacement is A sin(
        w t + phi). In degrees, from -720 to 720, for example "90 deg".
    acceleration_along_1 to _12 : values, optional
        Acceleration of the track along the track during step 1 of a period. In m s-2, for example
        "4 m/s^2".
    acceleration_across_1 to _12 : values, optional
        Acceleration of the track across the track during step 1 of a period. In m s-2, for example
        "4 m/s^2".
    acceleration_normal_1 to _12 : values, optional
        Acceleration of the track off the floor during step 1 of a period. In m s-2, for example "4
        m/s^2".
    duration_1 to _12 : values, optional
        Relative duration of step 1; the durations of all steps divide the period. 0 or more, for
        example 0.25.
    part_friction_1 to _10 : values, optional
        Coefficient of friction between the track and part 1 of a row, the rearmost. 0 or more, for
        example 0.3.
    part_mass_1 to _10 : values, optional
        Mass of part 1 of a row, the rearmost. In kg, above 0, for example "4 g".
    part_gap_1 to _10 : values, optional
        Gap in front of part 1 of a row, the rearmost, at the start. In m, 0 or more, for example "1
        mm".
    stretch_turns_1 to _6 : values, optional
        Turns of stretch 1 of the track. Above 0, for example 1.5.
    stretch_radius_1 to _6 : values, optional
        Radius at the end of stretch 1. In m, above 0, for example "150 mm".
    stretch_climb_1 to _6 : values, optional
        Climb of stretch 1; that of the stretch before unless given. In degrees, from -80 to 80, for
        example "3 deg".
    stretch_friction_1 to _6 : values, optional
        Coefficient of friction on stretch 1; that of the stretch before unless given. 0 or more,
        for example 0.3.

    Returns
    -------
    xarray.Dataset
        Best values, means and intervals (`best_friction`, `lower_95_friction`, ...), the posterior
        (`log_density`) over its axes, and what is predicted of each run; `findings` among its
        attributes says it in words. See docs/calibrate.md.

    Raises
    ------
    StudyError
        With every problem of the study, each with its place, what is wrong, and what would be
        right.

    Examples
    --------
    >>> told = vibrafeed.calibrate(
    ...     scene="rectangle-on-plane", frequency="50 Hz", beta=20,
    ...     observations=[
    ...         {"amplitude": "0.2 mm", "conveying_velocity": "13 mm/s", "error": "1 mm/s"},
    ...         {"amplitude": "0.3 mm", "conveying_velocity": "33 mm/s", "error": "1 mm/s"},
    ...     ],
    ...     unknowns={"friction": {"lower": 0.1, "upper": 0.6}},
    ... )
    >>> bool(told.lower_95_friction < told.best_friction < told.upper_95_friction)
    True
    """
    keywords = _functions.said(locals())
    return _functions.calibrate(study, **keywords)


def open_lazily(
    study: StudyLike | None = None,
    /,
    *,
    scene: SweptScene | None = None,
    outputs: SweptOutput | Sequence[SweptOutput] | None = None,
    variant: Literal["thesis", "derived", "physical"] | str | None = None,
    frequency: Values | None = None,
    amplitude: Values | None = None,
    peak_to_peak: Values | None = None,
    vertical_amplitude: Values | None = None,
    vertical_peak_to_peak: Values | None = None,
    alpha: Values | None = None,
    beta: Values | None = None,
    gamma: Values | None = None,
    delta: Values | None = None,
    yaw: Values | None = None,
    radius: Values | None = None,
    gravity: Values | None = None,
    friction: Values | None = None,
    friction_static: Values | None = None,
    friction_kinetic: Values | None = None,
    wall_friction: Values | None = None,
    width: Values | None = None,
    height: Values | None = None,
    length: Values | None = None,
    diameter: Values | None = None,
    mass: Values | None = None,
    restitution: Values | None = None,
    speed: Values | None = None,
    distance: Values | None = None,
    time: Values | None = None,
    axis_yaw: Values | None = None,
    spin_rate: Values | None = None,
    yaw_rate: Values | None = None,
    drilling_moment: Values | None = None,
    pitch: Values | None = None,
    pitch_rate: Values | None = None,
    centre_along: Values | None = None,
    centre_height: Values | None = None,
    velocity_along: Values | None = None,
    velocity_upward: Values | None = None,
    position_x_1: Values | None = None,
    position_y_1: Values | None = None,
    angle_1: Values | None = None,
    velocity_x_1: Values | None = None,
    velocity_y_1: Values | None = None,
    spin_1: Values | None = None,
    position_z_1: Values | None = None,
    azimuth_1: Values | None = None,
    elevation_1: Values | None = None,
    velocity_z_1: Values | None = None,
    spin_x_1: Values | None = None,
    spin_y_1: Values | None = None,
    spin_z_1: Values | None = None,
    diameter_1: Values | None = None,
    length_1: Values | None = None,
    width_1: Values | None = None,
    mass_1: Values | None = None,
    position_x_2: Values | None = None,
    position_y_2: Values | None = None,
    angle_2: Values | None = None,
    velocity_x_2: Values | None = None,
    velocity_y_2: Values | None = None,
    spin_2: Values | None = None,
    position_z_2: Values | None = None,
    azimuth_2: Values | None = None,
    elevation_2: Values | None = None,
    velocity_z_2: Values | None = None,
    spin_x_2: Values | None = None,
    spin_y_2: Values | None = None,
    spin_z_2: Values | None = None,
    diameter_2: Values | None = None,
    length_2: Values | None = None,
    width_2: Values | None = None,
    mass_2: Values | None = None,
    contact_tolerance: Values | None = None,
    part_gap: Values | None = None,
    moving_mass: Values | None = None,
    base_mass: Values | None = None,
    load_mass: Values | None = None,
    load_damping: Values | None = None,
    moving_inertia: Values | None = None,
    base_inertia: Values | None = None,
    spring_radius: Values | None = None,
    spring_angle: Values | None = None,
    spring_count: Values | None = None,
    spring_width: Values | None = None,
    spring_thickness: Values | None = None,
    spring_length: Values | None = None,
    elastic_modulus: Values | None = None,
    spring_density: Values | None = None,
    clamp_factor: Values | None = None,
    allowable_stress: Values | None = None,
    ring_down_frequency: Values | None = None,
    damping_ratio: Values | None = None,
    drive_force: Values | None = None,
    flux_density: Values | None = None,
    pole_area: Values | None = None,
    force_harmonic: Values | None = None,
    offset_along: Values | None = None,
    offset_upward: Values | None = None,
    spot_along: Values | None = None,
    spot_upward: Values | None = None,
    unbalance: Values | None = None,
    air_gap: Values | None = None,
    foot_stiffness: Values | None = None,
    foot_damping: Values | None = None,
    spring_stiffness: Values | None = None,
    load_radius: Values | None = None,
    small_diameter: Values | None = None,
    centre_of_mass: Values | None = None,
    radius_of_gyration: Values | None = None,
    sides: Values | None = None,
    arrival_rate: Values | None = None,
    arrival_speed: Values | None = None,
    part_pitch: Values | None = None,
    wanted_aspect: Values | None = None,
    shank_diameter: Values | None = None,
    device_order: Values | None = None,
    drop_count_1: Values | None = None,
    drop_count_2: Values | None = None,
    drop_count_3: Values | None = None,
    wiper_height_1: Values | None = None,
    ledge_width_1: Values | None = None,
    gap_length_1: Values | None = None,
    passed_aspect_1: Values | None = None,
    rail_width_1: Values | None = None,
    outlet_capacity_1: Values | None = None,
    turned_share_1: Values | None = None,
    turn_1: Values | None = None,
    wiper_height_2: Values | None = None,
    ledge_width_2: Values | None = None,
    gap_length_2: Values | None = None,
    passed_aspect_2: Values | None = None,
    rail_width_2: Values | None = None,
    outlet_capacity_2: Values | None = None,
    turned_share_2: Values | None = None,
    turn_2: Values | None = None,
    wiper_height_3: Values | None = None,
    ledge_width_3: Values | None = None,
    gap_length_3: Values | None = None,
    passed_aspect_3: Values | None = None,
    rail_width_3: Values | None = None,
    outlet_capacity_3: Values | None = None,
    turned_share_3: Values | None = None,
    turn_3: Values | None = None,
    wiper_height_4: Values | None = None,
    ledge_width_4: Values | None = None,
    gap_length_4: Values | None = None,
    passed_aspect_4: Values | None = None,
    rail_width_4: Values | None = None,
    outlet_capacity_4: Values | None = None,
    turned_share_4: Values | None = None,
    turn_4: Values | None = None,
    wiper_height_5: Values | None = None,
    ledge_width_5: Values | None = None,
    gap_length_5: Values | None = None,
    passed_aspect_5: Values | None = None,
    rail_width_5: Values | None = None,
    outlet_capacity_5: Values | None = None,
    turned_share_5: Values | None = None,
    turn_5: Values | None = None,
    wiper_height_6: Values | None = None,
    ledge_width_6: Values | None = None,
    gap_length_6: Values | None = None,
    passed_aspect_6: Values | None = None,
    rail_width_6: Values | None = None,
    outlet_capacity_6: Values | None = None,
    turned_share_6: Values | None = None,
    turn_6: Values | None = None,
    lap_time: Values | None = None,
    parts: Values | None = None,
    row_velocity: Values | None = None,
    inflow: Values | None = None,
    lane_length: Values | None = None,
    closed_time: Values | None = None,
    open_time: Values | None = None,
    part_width: Values | None = None,
    bend_radius: Values | None = None,
    bend_length: Values | None = None,
    bend_friction: Values | None = None,
    line_push: Values | None = None,
    forward_acceleration: Values | None = None,
    return_acceleration: Values | None = None,
    row_mass: Values | None = None,
    front_velocity: Values | None = None,
    inner_diameter: Values | None = None,
    rolling_factor: Values | None = None,
    restitution_speed: Values | None = None,
    impact_speed: Values | None = None,
    contact_damping_ratio: Values | None = None,
    lining_stiffness: Values | None = None,
    contact_modulus: Values | None = None,
    contact_radius: Values | None = None,
    sensitivities: bool | Sequence[str] | None = None,
    precision: Literal["double", "single"] | None = None,
    reduce: Mapping[str, Any] | None = None,
    verify: int | None = None,
    units: str | Sequence[str] | None = None,
    title: str | None = None,
    notes: str | None = None,
    parameters: Mapping[str, Values] | None = None,
    **others: Unpack[NoMore],
) -> xarray.Dataset:
    """Return the dataset of a sweep of any size; what is read of it is computed when it is read.

    Parameters
    ----------
    study : Study, mapping or path, optional
        The study, which keywords add to.
    **keywords
        Keys of the study and parameters, as those of `sweep`.

    Returns
    -------
    xarray.Dataset
        What `sweep` returns, without a value yet.

    Raises
    ------
    StudyError
        With every problem.
    VibrafeedError
        If zarr is not installed.

    Examples
    --------
    >>> lazy = vibrafeed.open_lazily(
    ...     scene="rectangle-on-plane", outputs=["acceleration_x"], frequency="50 Hz",
    ...     amplitude={"start": "0.1 mm", "stop": "1 mm", "num": 100_000},
    ...     beta={"start": 0, "stop": 40, "num": 100_000}, friction=0.5,
    ... )
    >>> f"{lazy.acceleration_x.size:,}"
    '10,000,000,000'
    >>> lazy.acceleration_x[99_999, 0].values > lazy.acceleration_x[0, 0].values
    np.True_
    """
    keywords = _functions.said(locals())
    return _functions.open_lazily(study, **keywords)


def drive_error(
    study: StudyLike | None = None,
    /,
    *,
    draws: int = 200,
    seed: int = 0,
    scene: SimulatedScene | None = None,
    outputs: SimulatedOutput | Sequence[SimulatedOutput] | None = None,
    method: str | None = None,
    frequency: Values | None = None,
    amplitude: Values | None = None,
    peak_to_peak: Values | None = None,
    vertical_amplitude: Values | None = None,
    vertical_peak_to_peak: Values | None = None,
    alpha: Values | None = None,
    beta: Values | None = None,
    gamma: Values | None = None,
    delta: Values | None = None,
    radius: Values | None = None,
    gravity: Values | None = None,
    friction: Values | None = None,
    friction_static: Values | None = None,
    friction_kinetic: Values | None = None,
    wall_friction: Values | None = None,
    height: Values | None = None,
    length: Values | None = None,
    diameter: Values | None = None,
    mass: Values | None = None,
    restitution: Values | None = None,
    wall_restitution: Values | None = None,
    pitch: Values | None = None,
    pitch_rate: Values | None = None,
    velocity_along: Values | None = None,
    velocity_upward: Values | None = None,
    hold_down: Values | None = None,
    hold_down_force: Values | None = None,
    part_gap: Values | None = None,
    occupancy: Values | None = None,
    duration: Values | None = None,
    drop_height: Values | None = None,
    moving_mass: Values | None = None,
    base_mass: Values | None = None,
    load_mass: Values | None = None,
    load_damping: Values | None = None,
    conveyed_mass: Values | None = None,
    moving_inertia: Values | None = None,
    base_inertia: Values | None = None,
    spring_radius: Values | None = None,
    spring_angle: Values | None = None,
    spring_count: Values | None = None,
    spring_width: Values | None = None,
    spring_thickness: Values | None = None,
    spring_length: Values | None = None,
    elastic_modulus: Values | None = None,
    spring_density: Values | None = None,
    clamp_factor: Values | None = None,
    allowable_stress: Values | None = None,
    ring_down_frequency: Values | None = None,
    damping_ratio: Values | None = None,
    drive_force: Values | None = None,
    flux_density: Values | None = None,
    pole_area: Values | None = None,
    force_harmonic: Values | None = None,
    offset_along: Values | None = None,
    offset_upward: Values | None = None,
    spot_along: Values | None = None,
    spot_upward: Values | None = None,
    unbalance: Values | None = None,
    air_gap: Values | None = None,
    foot_stiffness: Values | None = None,
    foot_damping: Values | None = None,
    spring_stiffness: Values | None = None,
    track_fraction: Values | None = None,
    start_radius: Values | None = None,
    load_radius: Values | None = None,
    load_fraction: Values | None = None,
    line_yield: Values | None = None,
    line_purity: Values | None = None,
    parts: Values | None = None,
    part_restitution: Values | None = None,
    friction_spread: Values | None = None,
    friction_seed: Values | None = None,
    track_stop_gap: Values | None = None,
    fixed_stop_gap: Values | None = None,
    inner_diameter: Values | None = None,
    rolling_factor: Values | None = None,
    rolling_resistance: Values | None = None,
    sensitivities: bool | Sequence[str] | None = None,
    trajectory: int | Sequence[float] | None = None,
    drive: Mapping[str, Any] | None = None,
    tolerance: float | None = None,
    max_periods: int | None = None,
    steps_per_period: int | None = None,
    slip_speed: float | None = None,
    contact_stiffness: float | None = None,
    reduce: Mapping[str, Any] | None = None,
    verify: int | None = None,
    units: str | Sequence[str] | None = None,
    title: str | None = None,
    notes: str | None = None,
    parameters: Mapping[str, Values] | None = None,
    **numbered: Unpack[DriveNumbers],
) -> DriveError:
    """Return the error of a part's conveying velocity by the errors of a measured drive.

    The part is followed under drives that fit the recording as well as the fitted one. Errors of
    friction and other parameters, of the model and of the sensor's scale are not among them.

    Parameters
    ----------
    study : mapping or path, optional
        A study to simulate, of one cell, whose `drive` names a recording.
    draws : int
        Number of such drives.
    seed : int
        Seed of the random numbers; equal ones give equal results.
    **keywords
        Keys of the study and parameters, as those of `simulate`.

    Returns
    -------
    DriveError
        velocity, standard_deviation, lower and upper (of 95 %), draws, without [m s-1].

    Raises
    ------
    StudyError
        With every problem.

    Examples
    --------
    >>> told = vibrafeed.drive_error("configs/measured-drive.toml", drive_factor=1, friction=0.3)
    >>> told.lower < told.velocity < told.upper
    True
    >>> isinstance(told, vibrafeed.DriveError)
    True
    """
    keywords = _functions.said(locals())
    return _functions.drive_error(study, **keywords)
