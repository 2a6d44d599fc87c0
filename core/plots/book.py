"""The book of charts: the classic diagrams of vibratory conveying, computed exactly, as a PDF."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from matplotlib.backends.backend_pdf import PdfPages

from vibrafeed.core.dataset.files import whole
from vibrafeed.core.errors import StoppedError
from vibrafeed.core.plots.book_intro import draw_introduction
from vibrafeed.core.plots.book_page import Chart, draw_page
from vibrafeed.core.plots.files import METADATA
from vibrafeed.core.watch import Watch

FRICTIONS: Final = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0)
SLOPES: Final = (-5.0, -2.0, 0.0, 2.0, 4.0, 6.0)  # degrees
TITLE: Final = "Charts of vibratory conveying"


def write_book(
    target: Path,
    *,
    frictions: Sequence[float] = FRICTIONS,
    slopes: Sequence[float] = SLOPES,
    watch: Watch | None = None,
) -> str:
    """Write the book of charts; return its number of pages in words.

    Two books of one version are equal to the byte: there is no date in them.

    Parameters
    ----------
    target : Path
        The PDF; an existing one is replaced, all of it or nothing.
    frictions, slopes : sequence of float
        Coefficients of friction, and angles of the track in degrees: a page for each pair that is
        not steeper than friction.
    watch : Watch, optional
        Takes the progress, and may stop the work.

    Raises
    ------
    StoppedError
        If it was stopped; nothing is written.
    OSError
        If the file cannot be written.
    """
    watch = watch or Watch()
    wanted = [
        (friction, slope)
        for friction in frictions
        for slope in slopes
        if abs(math.tan(math.radians(slope))) < friction
    ]
    book = io.BytesIO()
    with PdfPages(book, metadata=METADATA["pdf"] | {"Title": TITLE}) as pdf:
        for number in range(len(wanted) + 1):
            if watch.stopped():
                raise StoppedError(
                    "the charts were stopped before all pages were drawn; start again"
                )
            chart = Chart.of(*wanted[number - 1]) if number else None
            pdf.savefig(draw_page(chart) if chart else draw_introduction())
            watch.advance(1.0 / (len(wanted) + 1))
    with whole(target) as temporary:
        temporary.write_bytes(book.getvalue())
    return f"{len(wanted) + 1} pages" if wanted else "1 page"
