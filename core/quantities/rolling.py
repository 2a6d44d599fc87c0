"""The rolling cylinder (chapter 4)."""

from __future__ import annotations

from vibrafeed.core.quantities.quantity import Quantity, acceleration, angle, force


def _screw(name: str, label: str, what: str) -> dict[str, Quantity]:
    """Return the declarations of a wrench's pitch and of a point of its axis, by name.

    A wrench is a force along an axis with a moment along it; the point is given by the components n
    (normal), eta (rolling) and sigma (axial). `name` begins the names of the quantities, `label`
    their labels, and `what` says which forces it sums up.
    """
    pitch = Quantity(
        "m", "p", f"{label}, pitch", f"Moment along the wrench axis over force, of {what}."
    )
    point = {
        f"{name}_axis_{direction}": Quantity(
            "m", f"r_{symbol}", f"{label}, axis point, {symbol}",
            f"From the centre to the nearest point of the wrench axis of {what}, along +{symbol}.",
        )
        for direction, symbol in (("normal", "n"), ("rolling", "eta"), ("axial", "sigma"))
    }  # fmt: skip
    return {f"{name}_pitch": pitch, **point}


ROLLING: dict[str, Quantity] = {
    "axis_yaw": angle(
        "theta", "Yaw of the cylinder's axis",
        "Turn of the rolling cylinder's axis in the floor plane as chapter 4 counts it: from +x "
        "towards -y, clockwise seen from above.", 180.0, "30 deg",
    ),
    "spin_rate": Quantity(
        "rad s-1", "phi.", "Spin rate",
        "Angular velocity of the rolling cylinder about its axis; positive rolls along +eta.",
        parameter=True, examples=("40 rad/s", "400 rpm"),
    ),
    "yaw_rate": Quantity(
        "rad s-1", "theta.", "Yaw rate", "Rate of the cylinder's yaw, in the sense of axis_yaw.",
        parameter=True, examples=("2 rad/s",),
    ),
    "drilling_moment": Quantity(
        "N m", "M_z", "Drilling moment",
        "Moment of all floor friction about the vertical through the centre, in the sense of "
        "axis_yaw.", parameter=True, examples=("0.1 mN m",),
    ),
    "rolling_drive": acceleration(
        "D_eta", "Drive in rolling direction",
        "Drive acceleration at its peak, along +eta, horizontal and across the axis.",
    ),
    "axial_drive": acceleration(
        "D_sigma", "Drive along the axis",
        "Drive acceleration at its peak, along +sigma, the cylinder's axis.",
    ),
    "axial_friction_acceleration": acceleration(
        "F_sigma/m", "Axial friction per mass",
        "Friction along the axis per mass that pure rolling requires; positive acts along -sigma.",
    ),
    "rolling_friction": force(
        "F_eta", "Friction in rolling direction",
        "Friction that pure rolling requires; positive acts along -eta.",
    ),
    "axial_friction": force(
        "F_sigma", "Friction along the axis",
        "Friction that pure rolling asks for along the axis; positive acts along -sigma.",
    ),
    "spin_acceleration": Quantity(
        "rad s-2", "phi..", "Spin acceleration",
        "Angular acceleration about the cylinder's axis in pure rolling.",
    ),
    "yaw_acceleration": Quantity(
        "rad s-2", "theta..", "Yaw acceleration",
        "Angular acceleration about the vertical; 0 without a drilling moment.",
    ),
    "printed_yaw_rate": Quantity(
        "rad s-1", "theta. (4.20)", "Yaw rate as printed",
        "Yaw rate by (4.20) of the source, with the floor's resultant at mid-length. For "
        "comparison only: it contradicts the source's (4.18) and (4.19).",
    ),
    "pressure_offset_axial": Quantity(
        "m", "e", "Centre of pressure, axial",
        "Offset of the floor's normal force from mid-length, along +sigma.",
    ),
    "required_friction": Quantity(
        "1", "mu_req", "Required friction coefficient",
        "Least static friction coefficient with which the cylinder rolls without slip.",
    ),
    "cone_margin": force(
        "mu_s N - |F|", "Margin in the friction cone",
        "Static friction limit less the friction that pure rolling asks for; negative slips.",
    ),
    "floor_wrench": Quantity(
        "1", "(F, M)", "Floor wrench",
        "Force [N] of the floor and its moment [N m] about the centre, axes n, eta, sigma.",
        bundle=True,
    ),
    "floor_reduction": Quantity(
        "1", "(p, r)", "Floor wrench, reduced", "Pitch and axis of the floor wrench.", bundle=True
    ),
    "force_wrench": Quantity(
        "1", "(F, M)", "Wrench of the force system",
        "Resultant [N] of drive, gravity and floor, moment [N m] about the centre, axes n, eta, "
        "sigma.", bundle=True,
    ),
    "force_reduction": Quantity(
        "1", "(p, r)", "Wrench of the force system, reduced",
        "Pitch and axis of the force system.", bundle=True,
    ),
    **_screw("floor", "Floor wrench", "the floor's forces"),
    **_screw("force", "Force system", "drive, gravity and floor together"),
}  # fmt: skip
