"""Exact answers to "a_x high, |a_y| low" for the angles of the drive (theory 12).

The forms hold for 0 <= alpha, beta <= 90 deg, any climb with `gravity_normal` >= 0, and a part at
rest. With other bounds use `core.optimise.newton`. All of the source's formulas are linear in the
drive direction d = (cb ca, cb sa, sb): what is sought is the highest point of a piece of the unit
sphere that planes cut out, so that even the root of the limit problem has a closed form.

Arguments broadcast; float64, SI units, radians. `gravity_along` is g sin(gamma), `gravity_normal`
g cos(gamma) (times cos(delta) on the track), `gravity_across` g cos(gamma) sin(delta). Inside,
everything is divided by the drive acceleration P.
"""

from core.optimise.exact.answers import ParetoSet, PlaneOptimum, TrackOptimum
from core.optimise.exact.block import plane_physical_fastest
from core.optimise.exact.cylinder import cylinder_physical_fastest
from core.optimise.exact.plane import (
    plane_thesis_fastest,
    plane_thesis_least_across,
    plane_thesis_limited,
    plane_thesis_pareto,
    plane_thesis_weighted,
)
from core.optimise.exact.track import track_fastest, track_physical_fastest

__all__ = [
    "ParetoSet",
    "PlaneOptimum",
    "TrackOptimum",
    "cylinder_physical_fastest",
    "plane_physical_fastest",
    "plane_thesis_fastest",
    "plane_thesis_least_across",
    "plane_thesis_limited",
    "plane_thesis_pareto",
    "plane_thesis_weighted",
    "track_fastest",
    "track_physical_fastest",
]
