"""Rows of parts that touch, push and part, from event to event (theory 17)."""

from vibrafeed.core.motion.kernels.rows.row_cells import (
    path_of_row,
    path_of_wave_row,
    row_cells,
    wave_row_cells,
)
from vibrafeed.core.motion.kernels.rows.row_state import (
    AT,
    HEAD,
    OWN,
    ROW_COLUMNS,
    Head,
    RowColumns,
)

__all__ = [
    "AT",
    "HEAD",
    "OWN",
    "ROW_COLUMNS",
    "Head",
    "RowColumns",
    "path_of_row",
    "path_of_wave_row",
    "row_cells",
    "wave_row_cells",
]
