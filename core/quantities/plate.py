"""A plate that moves parts in any direction: its turns, places on it, and travel over it."""

from vibrafeed.core.quantities.quantity import Quantity, angle, velocity

ROTATIONS = {
    "yaw": "about its normal (positive from +x towards +y)",
    "tilt_x": "about the x axis (positive lifts the +y side)",
    "tilt_y": "about the y axis (positive lowers the +x side)",
}
"""Small turns of the plate about its origin."""

_ORDERS = {
    1: "the drive frequency", 2: "twice the drive frequency", 3: "three times the drive frequency"
}  # fmt: skip
TURNS: dict[str, Quantity] = {
    **{
        f"amplitude_{turn}_{n}": Quantity(
            "degree", f"A_{turn}{n}", f"Amplitude of {turn.replace('_', ' ')}, order {n}",
            f"Amplitude of the plate's rotation {about} at {where}, zero to peak.", 0.0, 10.0,
            parameter=True, examples=("0.05 deg",), usual=(1e-5, 2.0),
        )
        for turn, about in ROTATIONS.items() for n, where in _ORDERS.items()
    },
    **{
        f"phase_{turn}_{n}": angle(
            f"phi_{turn}{n}", f"Phase of {turn.replace('_', ' ')}, order {n}",
            f"Phase phi of the plate's rotation {about} at {where}. The angle is "
            f"A sin({f'{n} ' if n > 1 else ''}w t + phi).", 720.0, "90 deg",
        )
        for turn, about in ROTATIONS.items() for n, where in _ORDERS.items()
    },
}  # fmt: skip


def _position(axis: str) -> Quantity:
    return Quantity(
        "m", axis.upper(), f"Position along {axis}",
        f"Distance of the part along {axis} from the point about which the plate rotates.",
        parameter=True, examples=("50 mm",), usual=(1e-4, 5.0),
    )  # fmt: skip


PLATE: dict[str, Quantity] = {
    **TURNS,
    "position_x": _position("x"),
    "position_y": _position("y"),
    "target_direction": angle(
        "chi", "Target direction",
        "Direction on the plate in which velocity_towards is measured, as an angle from +x "
        "towards +y.", 360.0, "45 deg"
    ),
    "velocity_x": velocity("v_x", "Velocity along x",
        "Mean velocity of the part along x, relative to the plate."),
    "velocity_y": velocity("v_y", "Velocity along y",
        "Mean velocity of the part along y, relative to the plate."),
    "velocity_error": Quantity(
        "m s-1", "e(v)", "Error of the velocity",
        "Error of each component of the part's mean velocity, as the simulation method estimates "
        "it.",
        error_of="velocity_x", compared=False,
    ),
    "travel_speed": velocity("|v|", "Speed of travel",
        "Magnitude of the part's mean velocity over the plate."),
    "travel_direction": Quantity(
        "degree", "psi", "Direction of travel on the plate",
        "Direction of the part's mean velocity on the plate, as an angle from +x towards +y; NaN "
        "if the part does not travel.",
        compared=False,
    ),
    "velocity_towards": velocity(
        "v_chi", "Velocity towards the target direction",
        "Component of the part's mean velocity in the direction target_direction.",
    ),
    "slip_fraction": Quantity(
        "1", "", "Sliding share", "Share of the period in which the part slides on the plate."
    ),
    "position_across": Quantity(
        "m", "y", "Position across",
        "Position of the part along y, relative to the plate; 0 at the first time of the "
        "trajectory."
    ),
    "relative_velocity_across": velocity(
        "u_y", "Velocity relative to the plate along y",
        "Velocity of the part along y, relative to the plate."
    ),
    "track_across": Quantity("m", "", "Displacement along y", "Displacement of the plate along y."),
}  # fmt: skip
