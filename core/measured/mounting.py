"""The orientation of a sensor of three axes on the track."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from vibrafeed.core.errors import Problem
from vibrafeed.core.quantities.quantity import angle
from vibrafeed.core.study.units import UnitError, problem, read_number

Angles = tuple[float | str, float | str, float | str]

ORTHONORMAL = 1e-3  # rounding error of a matrix that a user copies
ANGLES = {
    name: angle(name, name.capitalize(), f"{name.capitalize()} of the sensor.", 360.0, "90 deg")
    for name in ("yaw", "pitch", "roll")
}
FIX = (
    "Give yaw, pitch and roll in degrees, such as [0, 0, 90], or a 3x3 rotation whose columns are "
    "the sensor's x, y and z in components along, across and normal"
)


def direction(mounting: object, problems: list[Problem]) -> NDArray[np.float64] | None:
    """Return the rotation matrix of a sensor's mounting, shape (3, 3); None if it is invalid.

    Components in the track's axes are R times those in the sensor's. `mounting` is three angles,
    yaw, pitch and roll, as numbers in degrees or texts, with R = R_z(yaw) R_y(pitch) R_x(roll); or
    a matrix, of which the nearest rotation is taken; or None for the axes of the track. A problem
    is added to `problems`.
    """
    if mounting is None:
        return np.eye(3)
    parts = list(mounting) if isinstance(mounting, list | tuple | np.ndarray) else []
    if len(parts) != 3:
        problems.append(
            Problem(
                "mounting", "the mounting of the sensor is neither three angles nor a matrix", FIX
            )
        )
        return None
    if all(np.ndim(part) == 0 for part in parts):
        return _rotation_of_angles(parts, problems)
    try:
        matrix = np.array(parts, dtype=np.float64)
    except (TypeError, ValueError):
        matrix = np.full((1, 1), np.nan)
    near = matrix.shape == (3, 3) and np.allclose(matrix @ matrix.T, np.eye(3), atol=ORTHONORMAL)
    if not near:
        problems.append(
            Problem(
                "mounting", "the mounting of the sensor is a matrix that is not a rotation", FIX
            )
        )
        return None
    if np.linalg.det(matrix) < 0:
        fix = 'Reverse one channel with a minus sign: sensor = ["ax", "-ay", "az"]'
        problems.append(
            Problem(
                "mounting",
                "the mounting of the sensor is a matrix that mirrors the axes; it has to "
                "be a rotation",
                fix,
            )
        )
        return None
    return Rotation.from_matrix(matrix).as_matrix()


def _rotation_of_angles(parts: list[object], problems: list[Problem]) -> NDArray[np.float64] | None:
    """Return the 3 by 3 matrix that turns a sensor's axes by yaw, pitch and roll.

    `parts` are these three angles as a study gives them: numbers in degrees, or texts with a unit.
    None if one is invalid, which is added to `problems`.
    """
    angles = []
    for (name, quantity), raw in zip(ANGLES.items(), parts, strict=True):
        raw = raw.item() if isinstance(raw, np.generic) else raw
        try:
            angles.append(read_number(name, quantity, raw))
        except UnitError as error:
            problems.append(problem(f"mounting.{name}", error))
    if len(angles) < len(parts):
        return None
    return Rotation.from_euler("ZYX", angles, degrees=True).as_matrix()
