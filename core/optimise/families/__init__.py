"""Families of problems whose best angles of the drive are known: "a_x high, |a_y| low" (theory 12).

A file a family: its closed forms, and the record that says what it answers.

The forms hold for 0 <= alpha, beta <= 90 deg, any climb with `gravity_normal` >= 0, and a part at
rest. All of the source's formulas are linear in the drive direction d = (cb ca, cb sa, sb): the
optimum is the highest point of a piece of the unit sphere that planes cut out, so that even the
root of the limit problem has a closed form.

Arguments broadcast; float64, SI units, radians. `gravity_along` is g sin(gamma), `gravity_normal`
g cos(gamma) (times cos(delta) on the track), `gravity_across` g cos(gamma) sin(delta). Inside,
everything is divided by the drive acceleration P.
"""

from vibrafeed.core.optimise.families import cylinder_physical, plane_physical, plane_thesis, track
from vibrafeed.core.optimise.families.family import Family

OF_SYSTEM: dict[tuple[str, str, str], Family] = {
    system: family
    for family in (
        plane_thesis.FAMILY,
        plane_physical.FAMILY,
        cylinder_physical.FAMILY,
        track.THESIS,
        track.DERIVED,
        track.PHYSICAL,
    )
    for system in family.systems
}
"""The family of a scene, its variant and the output that is to be largest."""
