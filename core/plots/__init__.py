"""Pictures of a sweep: contours, surfaces and lines, with the regime shaded.

The only place that loads matplotlib. Its object interface is used, never `pyplot`: nothing here
changes a global state, opens a window or picks a backend.
"""

from core.plots.draw import draw
from core.plots.files import draw_file
from core.plots.problem import PlotError

__all__ = ["PlotError", "draw", "draw_file"]
