"""One page about a result, for a customer: what it is of, what came out, what it assumes."""

import io
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.image import imread
from numpy.typing import NDArray

from vibrafeed.core.dataset.bands import BAND, ENDS, known_between, rounded, sentences_on_bands
from vibrafeed.core.dataset.table import Table, percent, regime_shares
from vibrafeed.core.plots.drawing import check_format, draw, read, save
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.selection import units_of
from vibrafeed.core.plots.style import Style, long_name, number, shown_in, words
from vibrafeed.core.quantities import FLAGS, QUANTITIES, REGIMES
from vibrafeed.core.quantities.flags import is_regime
from vibrafeed.core.quantities.motion import OF_THE_SEARCH
from vibrafeed.core.study.shown import ShownUnits

PAGE = 8.27, 11.69  # inches, A4
LEFT, RIGHT, TOP, BOTTOM = 0.08, 0.92, 0.955, 0.045
LINE = 0.0165  # of the page's height
MAX_ROWS = 18  # rows of a table; the file has all
LETTERS = 108  # letters of a line
SETTINGS = ("tolerance", "max_periods", "gravity", "hold_down_number", "curvature_number")


def write_sheet(file: Path, target: Path, *, title: str = "", units: str | None = None) -> None:
    """Write a one-page summary of a result file as PDF, PNG or SVG.

    `title` is that of the page, by default that of the study; `units` are those for reading.

    Raises
    ------
    PlotError
        If the file is not such a result, has no picture, or the page's name ends otherwise.
    OSError
        If the file cannot be read or the page cannot be written; no part of it is left behind.
    """
    check_format(target)
    save(draw_sheet(read(file), title=title, units=units), target)


def draw_sheet(dataset: xarray.Dataset, *, title: str = "", units: str | None = None) -> Figure:
    """Return a one-page summary of a result: parameters, outputs, regimes, picture and assumptions.

    Title and units are those of `write_sheet`. `PlotError` tells that a result of several designs
    has no picture.
    """
    style, shown = Style(), units_of(dataset, units)
    page = Figure(figsize=PAGE, facecolor=style.ground)
    y = TOP

    def write(text: str, x: float = LEFT, *, down: float, size: float = 9, **look: Any) -> None:
        nonlocal y
        page.text(x, y, text, size=size, va="top", **{"color": style.ink, **look})
        y -= down * LINE

    for line in textwrap.wrap(title or str(dataset.attrs.get("title", "")), 54):
        write(line, down=1.7, size=15, weight="bold")
    y -= 0.3 * LINE
    kind = f"{dataset.attrs.get('scene', '')}, {dataset.attrs.get('source', '')}"
    write(kind, down=2.0, color=style.quiet)
    parameters = [  # without settings of the computation, such as a tolerance
        (long_name(array), _values(array, shown))
        for name, array in dataset.coords.items()
        if name in QUANTITIES and name not in SETTINGS
    ]
    y_of_tables, y_of_ends = y, []
    for name, rows, left, right in (
        ("Drive and part", parameters, LEFT, 0.47),
        ("What comes out", _outputs(dataset, shown), 0.53, RIGHT),
    ):
        y = y_of_tables
        write(name, left, down=1.3, weight="bold")
        if len(rows) > MAX_ROWS:
            rows = [*rows[: MAX_ROWS - 1], (f"{len(rows) - MAX_ROWS + 1} more in the file", "")]
        for label, text in rows:
            write(label, left, down=0)
            write(text, right, down=1, ha="right")
        y_of_ends.append(y)
    y = min(y_of_ends) - 0.5 * LINE
    for line in textwrap.wrap(_regimes(dataset), LETTERS):
        write(line, down=1)
    assumptions = textwrap.wrap(str(dataset.attrs.get("comment", "")), LETTERS + 12)
    y_of_foot = BOTTOM + (len(assumptions) + 3.5) * 0.8 * LINE
    if (figure := _picture(dataset, units)) is not None:
        picture = io.BytesIO()
        figure.savefig(picture, format="png", dpi=200)
        picture.seek(0)
        axes = page.add_axes((LEFT, y_of_foot, RIGHT - LEFT, y - y_of_foot - LINE))
        axes.imshow(imread(picture), aspect="equal", interpolation="antialiased")
        axes.set_anchor("N")
        axes.axis("off")
    y = y_of_foot - 0.5 * LINE
    write("What this assumes", down=0, size=8, weight="bold")
    for line in assumptions:
        y -= 0.8 * LINE
        write(line, down=0, size=7.5, color=style.quiet)
    y -= 1.2 * LINE
    digest = str(dataset.attrs.get("study_sha256", ""))
    write(f"Study {digest[:16]}; the file has all values.", down=0, size=7.5, color=style.quiet)
    return page


def _outputs(dataset: xarray.Dataset, units: ShownUnits) -> list[tuple[str, str]]:
    """Return name and range of each output, as texts."""
    table = Table.of_xarray(dataset)
    friction_range, rows = known_between(table.coordinates), list[tuple[str, str]]()
    for name, array in dataset.data_vars.items():
        if name not in QUANTITIES or name in FLAGS or name in OF_THE_SEARCH:
            continue
        ends = [dataset.get(f"{name}_{end}") for end in ENDS]
        if friction_range and ends[0] is not None and ends[1] is not None:
            rows += [(long_name(array), _band(ends, units)), (f"   for {friction_range}", "")]
        elif array.dtype.kind == "f":
            rows.append((long_name(array), _values(array, units, table.valid(str(name)))))
    return rows


def _band(ends: Sequence[Any], units: ShownUnits) -> str:
    shown = shown_in(max(ends, key=lambda end: float(np.abs(end).max())), units)
    least, largest = shown.factor * float(ends[0].min()), shown.factor * float(ends[1].max())
    text = " to ".join(rounded(end, largest - least) for end in (least, largest))
    return f"{text} {shown.unit}".replace("-", "\N{MINUS SIGN}")


def _picture(dataset: xarray.Dataset, units: str | None) -> Figure | None:
    try:
        return draw([dataset], units=units)
    except PlotError:  # a single design may have no picture
        if any(array.size > 1 for array in dataset.data_vars.values()):
            raise
        return None


def _values(
    array: xarray.DataArray, units: ShownUnits, valid: NDArray[np.bool_] | None = None
) -> str:
    """Return the range of the finite and valid values of an array, as text."""
    shown = shown_in(array, units)
    values = np.asarray(array.attrs.get(BAND, array.values), dtype=float) * shown.factor
    if valid is not None and values.size > 1:
        values = values[valid]
        if not values.size:
            return "none valid"
    values = values[np.isfinite(values)]
    if not values.size:
        return "-"
    ends = [number(float(end), 4) for end in (values.min(), values.max())]
    text = ends[0] if ends[0] == ends[1] else " to ".join(ends)
    return f"{text}{'' if shown.unit in ('', '°') else ' '}{shown.unit}"


def _regimes(dataset: xarray.Dataset) -> str:
    """Return sentences on the regimes that occur, with their shares."""
    sentences = []
    for name in (str(regime) for regime in dataset.data_vars if is_regime(str(regime))):
        noun = long_name(dataset[name]).removeprefix("Regime")
        shares = regime_shares(dataset[name].values)
        if len(shares) == 1:
            (regime,) = shares
            sentences.append(f"Regime{noun}: {words(regime)}: {REGIMES[regime].description}.")
        else:
            parts = [f"{words(regime)} {percent(share)}" for regime, share in shares.items()]
            sentences.append(f"Regimes{noun}: {', '.join(parts)}.")
    return " ".join([*sentences, *sentences_on_bands(Table.of_xarray(dataset))])
