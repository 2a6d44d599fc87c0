"""The bodies that tumble: what their shape and mass mean for motion in a vertical plane."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.scenes import isolated


class Body(NamedTuple):
    """The numbers of a part's motion (theory 2.1); `turning` is 0 of a ball, which has no sides."""

    half_diagonal: Array
    inertia_ratio: Array
    corner_angle: Array
    turning: Array


class TumblingRectangle(NamedTuple):
    """A rectangular part; at pitch 0 it lies on a side of its length [m]."""

    length: ArrayLike
    height: ArrayLike

    def body(self) -> Body:
        """Return half diagonal [m], inertia ratio [1] and corner angle [rad] of the rectangle.

        With them a tumbling part is simulated (theory 2.1); the fourth number, 1, says that it has
        corners.
        """
        h, b = (np.asarray(side, dtype=float) for side in self)
        return Body(
            isolated.rectangle_half_diagonal(height=b, length=h),
            isolated.rectangle_inertia_ratio(),
            isolated.rectangle_corner_angle(height=b, length=h),
            np.ones(()),
        )


class TumblingCylinder(NamedTuple):
    """A cylindrical part whose axis stays in the plane of motion; at pitch 0 it lies on its side.

    Its rim strikes the plane; it does not roll about its axis [m].
    """

    length: ArrayLike
    diameter: ArrayLike

    def body(self) -> Body:
        """Return half diagonal [m], inertia ratio [1] and corner angle [rad] of the part's outline.

        The outline is a rectangle, on its long side or standing. With them a tumbling part is
        simulated (theory 6); the fourth number, 1, says that it has corners.
        """
        h, d = (np.asarray(side, dtype=float) for side in self)
        direction = isolated.cylinder_corner_direction(diameter=d, length=h)
        return Body(
            isolated.cylinder_half_diagonal(diameter=d, length=h),
            isolated.cylinder_inertia_ratio(corner_direction=direction),
            isolated.cylinder_corner_angle(diameter=d, length=h),
            np.ones(()),
        )


class Ball(NamedTuple):
    """A ball, whose one contact lies below its centre [m]."""

    radius: ArrayLike

    def body(self) -> Body:
        """Return the radius of the ball and its inertia ratio m R^2/I = 5/2; it has no corners."""
        radius = np.asarray(self.radius, dtype=float)
        return Body(radius, np.full((), 2.5), np.full((), np.pi / 2), np.zeros(()))


Part = TumblingRectangle | TumblingCylinder | Ball
