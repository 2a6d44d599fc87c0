"""Every picture: its name, what it shows, and the module that draws it.

A module of a picture has two functions: ``fits(dataset, options)``, whether it is the picture that
is drawn where none is named, and ``draw(dataset, options)``. It is loaded when it is needed; this
table loads nothing, so that the command line can tell of pictures at no cost.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from core.plots.options import Options


@dataclass(frozen=True)
class Picture:
    """A picture of a dataset.

    Attributes
    ----------
    name : str
        As it is asked for.
    says : str
        What it shows, in a few words.
    home : str
        The module of this package that draws it.
    """

    name: str
    says: str
    home: str

    def fits(self, dataset: xarray.Dataset, options: Options) -> bool:
        """True where this is what the dataset is drawn as, if nothing is named."""
        return bool(import_module(f"{__package__}.{self.home}").fits(dataset, options))

    def draw(self, dataset: xarray.Dataset, options: Options) -> Figure:
        """Return the picture; raise `PlotError` if the dataset does not hold what it needs."""
        figure: Figure = import_module(f"{__package__}.{self.home}").draw(dataset, options)
        return figure


PICTURES = {
    picture.name: picture
    for picture in (
        Picture("posterior", "what a calibration knows of its unknowns", "calibration"),
        Picture("speeds", "measured and computed speeds of a calibration", "calibration"),
        Picture("residuals", "what a calibration leaves unexplained, run by run", "calibration"),
        Picture("distribution", "how an output with uncertain parameters spreads", "uncertain"),
        Picture("indices", "shares of the variance, by parameter", "uncertain"),
        Picture("effects", "effects of parameters after Morris", "uncertain"),
        Picture("tornado", "what each tolerance does by itself", "uncertain"),
        Picture("front", "a trade-off of two outputs", "front"),
        Picture("positions", "where the parts of a row are over time", "positions"),
        Picture("trajectory", "the motion of one part", "motion"),
        Picture("animation", "the same, moving; a GIF or MP4 file", "movie"),
        Picture("landscape", "the objective of an optimisation over its variables", "landscape"),
        Picture("profiles", "the objective along each variable by itself", "profiles"),
        Picture("values", "the values of one design; of an impact, what hits what", "values"),
        Picture("line", "an output over one parameter, or a family of lines", "line"),
        Picture("map", "regimes, or an output whose numbers stand for words", "regime_map"),
        Picture("contour", "an output over two parameters, in colours", "contour"),
        Picture("levels", "an output over two parameters, as lines of equal value", "levels"),
        Picture("surface", "an output over two parameters, in relief", "surface"),
        Picture("thresholds", "an output over one parameter, with its thresholds", "thresholds"),
        Picture("parallel", "all designs, a line each through all parameters", "parallel"),
    )
}
"""By name. The first that fits a dataset is drawn where none is named."""

NAMES = tuple(PICTURES)
