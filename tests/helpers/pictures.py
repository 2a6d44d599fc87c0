"""What tests read from a picture."""

from __future__ import annotations

import pytest
import xarray
from matplotlib.figure import Figure

from vibrafeed.core.plots.drawing import draw
from vibrafeed.core.plots.pictures import PlotError

SPACE = "\N{NO-BREAK SPACE}"


def legend(figure: Figure) -> list[str]:
    return [text.get_text().replace(SPACE, " ") for text in figure.legends[-1].get_texts()]


def subtitle(figure: Figure) -> str:
    return figure.axes[0].get_title(loc="left").replace(SPACE, " ")


def problem(dataset: xarray.Dataset, **asked: object):
    with pytest.raises(PlotError) as caught:
        draw(dataset, **asked)
    return caught.value.problem
