"""Pictures of datasets: what there is stands in `pictures`, and how it is asked for in `drawing`.

The only place that loads matplotlib, when a picture is drawn. Its object interface is used, never
`pyplot`: nothing here changes a global state, opens a window or picks a backend.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from core.plots.drawing import draw
    from core.plots.files import draw_file
    from core.plots.problem import PlotError

__all__ = ["PlotError", "draw", "draw_file"]

_HOMES = {"PlotError": "problem", "draw": "drawing", "draw_file": "files"}


def __getattr__(name: str) -> Any:
    """Load what is asked for: the table of pictures is read without matplotlib."""
    if name not in _HOMES:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    value = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value
    return value
