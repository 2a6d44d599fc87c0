"""Parts of figures for which matplotlib has no public name."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure
from matplotlib.text import Text


def heading_of(figure: Figure) -> Text | None:
    """Return the title of a figure; None if it has none."""
    heading: Text | None = figure._suptitle  # type: ignore[attr-defined]
    return heading


def colour_grid(axis: Any, colour: tuple[float, float, float] | str) -> None:
    """Set the colour of the grid behind an axis of a 3D picture."""
    axis._axinfo["grid"]["color"] = colour
