"""Pictures of datasets: `pictures` lists them, and `drawing` draws them.

The only place that loads matplotlib, when a picture is drawn. Its object interface is used, never
`pyplot`: nothing here changes a global state, opens a window or picks a backend.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

if TYPE_CHECKING:
    from vibrafeed.core.plots.drawing import draw
    from vibrafeed.core.plots.files import draw_file, save
    from vibrafeed.core.plots.fixed import read_fixed
    from vibrafeed.core.plots.measured import draw_fit
    from vibrafeed.core.plots.pictures import PlotError
    from vibrafeed.core.plots.sheet import write_sheet
else:  # the table of pictures is read without matplotlib
    __getattr__ = lazily(
        __name__,
        {
            "drawing": ("draw",),
            "files": ("draw_file", "save"),
            "fixed": ("read_fixed",),
            "measured": ("draw_fit",),
            "pictures": ("PlotError",),
            "sheet": ("write_sheet",),
        },
    )

__all__ = ["PlotError", "draw", "draw_file", "draw_fit", "read_fixed", "save", "write_sheet"]
