"""What tests read from a picture."""

import numpy as np
import pytest
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vibrafeed.core.plots.drawing import draw
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.quantities import REGIMES

SPACE = "\N{NO-BREAK SPACE}"


def legend(figure: Figure) -> list[str]:
    return [text.get_text().replace(SPACE, " ") for text in figure.legends[-1].get_texts()]


def subtitle(figure: Figure) -> str:
    return figure.axes[0].get_title(loc="left").replace(SPACE, " ")


def hatches(axes: Axes) -> set[str]:
    areas = [getattr(area, "hatches", None) or [] for area in axes.collections]
    return {hatch for area in areas for hatch in area if hatch}


def regimes_in(dataset: xarray.Dataset, **at: float) -> set[str]:
    """Return the regimes of the cells at some values, as pictures write them."""
    values = np.unique(dataset["regime"].sel(at, method="nearest"))
    return {name.replace("_", " ") for name, regime in REGIMES.items() if regime.value in values}


def problem(dataset: xarray.Dataset, **asked: object):
    with pytest.raises(PlotError) as caught:
        draw(dataset, **asked)
    return caught.value.problem
