"""A figure that notebooks show."""

from __future__ import annotations

from io import BytesIO

from matplotlib.figure import Figure


class NotebookFigure(Figure):
    """A figure that a notebook shows by itself: matplotlib teaches it that with pyplot only."""

    def _repr_png_(self) -> bytes:
        """Return the figure as PNG, for notebooks."""
        buffer = BytesIO()
        self.savefig(buffer, format="png")
        return buffer.getvalue()
