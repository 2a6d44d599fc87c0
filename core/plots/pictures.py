"""Every picture: its name, what it shows, and the module that draws it.

A module of a picture has two functions: ``fits(dataset, options)``, whether it is the picture that
is drawn where none is named, and ``draw(dataset, options)``. It is loaded when it is needed: a
module is asked whether its picture fits where a look at the dataset does not tell otherwise. This
table loads nothing, so that the command line can tell of pictures at no cost.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

from vibrafeed.core.plots.problem import PlotError

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from vibrafeed.core.plots.options import Options


def is_calibration(dataset: xarray.Dataset) -> bool:
    """True if a dataset is a calibration."""
    return "log_density" in dataset.data_vars and "unknowns" in dataset.attrs


def _has_uncertain_parameters(dataset: xarray.Dataset) -> bool:
    """True if a dataset is a sensitivity study."""
    return "uncertain_parameters" in dataset.attrs


def _is_front(dataset: xarray.Dataset) -> bool:
    """True if a dataset holds a trade-off front."""
    return "knee" in dataset


def _is_row(dataset: xarray.Dataset) -> bool:
    """True if a dataset is of a row of parts."""
    return dataset.attrs.get("scene") == "row-on-plane"


def _is_motion(dataset: xarray.Dataset) -> bool:
    """True if a dataset holds a motion over a cycle, or one part that can be simulated over one."""
    return "cycle_time" in dataset.dims or ("motion_status" in dataset and _is_single(dataset))


def _is_optimum(dataset: xarray.Dataset) -> bool:
    """True if a dataset is the result of an optimisation."""
    return "optimum_status" in dataset


def _is_single(dataset: xarray.Dataset) -> bool:
    """True if a dataset has one cell."""
    return all(values.size == 1 for values in dataset.data_vars.values())


def _any(dataset: xarray.Dataset) -> bool:
    """Return True."""
    return True


def _none(dataset: xarray.Dataset) -> bool:
    """Return False: this picture is drawn on request only."""
    return False


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
    takes : tuple of str
        Which of the options `variable`, `axes` and `at` it takes.
    may_fit : callable
        False of a dataset that it does not fit, whatever is asked for; tells so without the module.
    """

    name: str
    says: str
    home: str
    takes: tuple[str, ...] = ("variable", "axes", "at")
    may_fit: Callable[[xarray.Dataset], bool] = _any

    def fits(self, dataset: xarray.Dataset, options: Options) -> bool:
        """True if this picture is the default for a dataset."""
        return self.may_fit(dataset) and bool(
            import_module(f"{__package__}.{self.home}").fits(dataset, options)
        )

    def draw(self, dataset: xarray.Dataset, options: Options) -> Figure:
        """Return the picture; raise `PlotError` if the dataset lacks what it needs.

        So does an option that this kind of picture does not take.
        """
        for option in ("variable", "axes", "at"):
            if getattr(options, option) and option not in self.takes:
                fix = f"Leave {option} out, or name another kind"
                raise PlotError(option, f"a picture of kind {self.name} has no {option}", fix)
        figure: Figure = import_module(f"{__package__}.{self.home}").draw(dataset, options)
        return figure


ONE_DESIGN = ("variable", "at")
"""Options of a picture of one design, which may be chosen among several."""

PICTURES = {
    picture.name: picture
    for picture in (
        Picture(
            "posterior", "what a calibration knows of its unknowns", "calibration", (),
            is_calibration,
        ),
        Picture(
            "speeds", "measured and computed speeds of a calibration", "calibration", (),
            is_calibration,
        ),
        Picture(
            "residuals", "what a calibration leaves unexplained, run by run", "calibration", (),
            is_calibration,
        ),
        Picture(
            "distribution", "how an output with uncertain parameters spreads", "uncertain",
            ONE_DESIGN, _has_uncertain_parameters,
        ),
        Picture(
            "indices", "shares of the variance, by parameter", "uncertain", ONE_DESIGN,
            _has_uncertain_parameters,
        ),
        Picture(
            "tornado", "what each tolerance does by itself", "uncertain", ONE_DESIGN,
            _has_uncertain_parameters,
        ),
        Picture("front", "a trade-off of two outputs", "front", ("at",), _is_front),
        Picture("positions", "where the parts of a row are over time", "positions", (), _is_row),
        Picture("trajectory", "the motion of one part", "motion", (), _is_motion),
        Picture("animation", "the same, moving; a GIF or MP4 file", "movie", (), _none),
        Picture(
            "landscape", "the objective of an optimisation over its variables", "landscape",
            ("at",), _is_optimum,
        ),
        Picture(
            "profiles", "the objective along each variable by itself", "profiles", ("at",),
            _is_optimum,
        ),
        Picture(
            "values", "the values of one design; of an impact, what hits what", "values",
            ONE_DESIGN, _is_single,
        ),
        Picture("line", "an output over one parameter, or a family of lines", "line"),
        Picture("map", "regimes, or an output whose numbers stand for words", "regime_map"),
        Picture("contour", "an output over two parameters, in colours", "contour"),
        Picture("levels", "an output over two parameters, as lines of equal value", "levels"),
        Picture("surface", "an output over two parameters, in relief", "surface"),
        Picture(
            "thresholds", "an output over one parameter, with its thresholds", "thresholds",
            may_fit=_none,
        ),
        Picture(
            "parallel", "all designs, a line each through all parameters", "parallel",
            ONE_DESIGN, _none,
        ),
    )
}  # fmt: skip
"""By name. The first that fits a dataset is drawn where none is named."""

MOVING = (".gif", ".mp4")
"""Endings of files that move."""

NAMES = tuple(PICTURES)
