"""Every quantity and every regime, declared once.

Units, bounds, labels and descriptions that the study, the dataset, the catalogue and the documents
show are read from here. Inside the code all values are SI and angles are radians; at the edge
(studies, files, replies) angles are degrees. Axes of a study follow the order of the declaration.
"""

from collections.abc import Mapping

from vibrafeed.core.quantities.drives import BOWL_TRACK, DRIVE, DRIVE_UNIT
from vibrafeed.core.quantities.flags import (
    MOTION_MODES,
    MOTION_STATUSES,
    OPTIMUM_STATUSES,
    REGIMES,
    Flag,
)
from vibrafeed.core.quantities.impacts import IMPACTS, ISOLATED
from vibrafeed.core.quantities.motion import DIRECTIONS, MOTION, OPTIMUM
from vibrafeed.core.quantities.orienting import ORIENTING, RESTING
from vibrafeed.core.quantities.plate import PLATE
from vibrafeed.core.quantities.quantity import WORD_OF, WORDS, Quantity, by_letters, letter_of
from vibrafeed.core.quantities.round_parts import ROLLING, ROUND_PARTS
from vibrafeed.core.quantities.row import ROW
from vibrafeed.core.quantities.track import TRACK

__all__ = [
    "DIRECTIONS",
    "FAMILIES",
    "FLAGS",
    "MOTION_MODES",
    "MOTION_STATUSES",
    "OPTIMUM_STATUSES",
    "QUANTITIES",
    "REGIMES",
    "STATUSES",
    "WORDS",
    "WORD_OF",
    "Flag",
    "Quantity",
    "by_letters",
    "letter_of",
]

DESIGNS = {
    "design": Quantity(
        "1", "", "Design",
        "Number of a design, counted from 1: a row of a table, or a set of parameter values.",
        count=True,
    ),
}  # fmt: skip
"""The axis of designs, along which parameters have one value each."""

# In the order in which documents list them; those of one study share axes in this order.
FAMILIES = (
    TRACK,
    DRIVE,
    ROLLING,
    ISOLATED,
    IMPACTS,
    MOTION,
    OPTIMUM,
    DRIVE_UNIT,
    BOWL_TRACK,
    RESTING,
    ORIENTING,
    ROW,
    ROUND_PARTS,
    PLATE,
    DESIGNS,
)
QUANTITIES: dict[str, Quantity] = {
    name: quantity for family in FAMILIES for name, quantity in family.items()
}
FLAGS: dict[str, Mapping[str, Flag]] = {
    name: quantity.flags for name, quantity in QUANTITIES.items() if quantity.flags is not None
}
"""The states of each quantity that is a flag."""

STATUSES = {
    name: flags["not_computed"].value for name, flags in FLAGS.items() if "not_computed" in flags
}
"""Variables that tell of each cell whether it was computed, and their value where it was not."""
