"""A plate that moves parts in any direction: its turns, places on it, and travel over it."""

from vibrafeed.core.quantities.quantity import Quantity, angle, velocity

ROTATIONS = {
    "yaw": "about the plate's normal, from +x towards +y",
    "tilt_x": "about the x axis: +y goes up",
    "tilt_y": "about the y axis: +x goes down",
}
"""Small turns of the plate about its origin."""

_ORDERS = range(1, 4)
TURNS: dict[str, Quantity] = {
    **{
        f"amplitude_{turn}_{n}": Quantity(
            "degree", f"A_{turn}{n}", f"Amplitude of {turn.replace('_', ' ')}, order {n}",
            f"Amplitude of the plate's turn {about}, at {n} times the drive frequency.", 0.0, 10.0,
            parameter=True, examples=("0.05 deg",), usual=(1e-5, 2.0),
        )
        for turn, about in ROTATIONS.items() for n in _ORDERS
    },
    **{
        f"phase_{turn}_{n}": angle(
            f"phi_{turn}{n}", f"Phase of {turn.replace('_', ' ')}, order {n}",
            f"Lead of the plate's turn {about}, at {n} times the drive frequency.", 720.0, "90 deg",
        )
        for turn, about in ROTATIONS.items() for n in _ORDERS
    },
}  # fmt: skip


def _position(axis: str) -> Quantity:
    return Quantity(
        "m", axis.upper(), f"Position along {axis}",
        f"Distance of the part along {axis} from the point about which the plate turns.",
        parameter=True, examples=("50 mm",), usual=(1e-4, 5.0),
    )  # fmt: skip


PLATE: dict[str, Quantity] = {
    **TURNS,
    "position_x": _position("x"),
    "position_y": _position("y"),
    "target_direction": angle(
        "chi", "Target direction", "Direction on the plate, from +x towards +y.", 360.0, "45 deg"
    ),
    "velocity_x": velocity("v_x", "Velocity along x", "Mean velocity over the plate along x."),
    "velocity_y": velocity("v_y", "Velocity along y", "Mean velocity over the plate along y."),
    "velocity_error": Quantity(
        "m s-1", "e(v)", "Error of the velocity",
        "Error of each component of the mean velocity, estimated by the method.",
        error_of="velocity_x", compared=False,
    ),
    "travel_speed": velocity("|v|", "Speed of travel", "Size of the mean velocity."),
    "travel_direction": Quantity(
        "degree", "psi", "Direction of travel on the plate",
        "Direction of the mean velocity, from +x towards +y; NaN for a part that does not travel.",
        compared=False,
    ),
    "velocity_towards": velocity(
        "v_chi", "Velocity towards the target direction",
        "Component of the mean velocity in target_direction.",
    ),
    "slip_fraction": Quantity(
        "1", "", "Sliding share", "Share of the period in which the part slides."
    ),
    "position_across": Quantity(
        "m", "y", "Position across", "Position along y, relative to the plate, from the first."
    ),
    "relative_velocity_across": velocity(
        "u_y", "Velocity relative to the plate along y", "Velocity along y, relative to the plate."
    ),
    "track_across": Quantity("m", "", "Displacement along y", "Displacement of the plate along y."),
}  # fmt: skip
