"""Every picture: its name, what it shows, and the module that draws it.

A module of a picture has two functions: ``fits(dataset, options)``, whether it is the picture that
is drawn where none is named, and ``draw(dataset, options)``. It is loaded when it is needed: a
module is asked whether its picture fits where a look at the dataset does not tell otherwise. This
table loads nothing, so that the command line can tell of pictures at no cost.
"""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

from vibrafeed.core.errors import Problem, VibrafeedError

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from vibrafeed.core.plots.style import Options


class PlotError(VibrafeedError):
    """A picture cannot be drawn; `problem` says where, why, and what would do."""

    def __init__(self, place: str, message: str, fix: str):
        self.problem = Problem(place, message, fix)
        super().__init__(str(self.problem))


def unreadable(message: str) -> PlotError:
    """Return the error of a dataset that lacks what `vibrafeed run` writes."""
    return PlotError("dataset", message, "Draw a result file that `vibrafeed run` wrote")


def is_calibration(dataset: "xarray.Dataset") -> bool:
    """True if a dataset is a calibration."""
    return "log_density" in dataset.data_vars and "unknowns" in dataset.attrs


def is_pair(dataset: "xarray.Dataset") -> bool:
    """True if a dataset is the result of an impact of two bodies."""
    return {"position_x_1", "position_x_2"} <= {*dataset.coords}


def _is_single(dataset: "xarray.Dataset") -> bool:
    return all(values.size == 1 for values in dataset.data_vars.values())


@dataclass(frozen=True)
class Picture:
    """A picture of a dataset.

    Attributes
    ----------
    name, says : str
        As it is asked for, and what it shows, in a few words.
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
    may_fit: "Callable[[xarray.Dataset], bool]" = lambda _: True

    def fits(self, dataset: "xarray.Dataset", options: "Options") -> bool:
        """True if this picture is the default for a dataset."""
        return self.may_fit(dataset) and bool(
            import_module(f"{__package__}.{self.home}").fits(dataset, options)
        )

    def draw(self, dataset: "xarray.Dataset", options: "Options") -> "Figure":
        """Return the picture; raise `PlotError` if the dataset lacks what it needs.

        So does an option that this kind of picture does not take.
        """
        for option in ("variable", "axes", "at"):
            if getattr(options, option) and option not in self.takes:
                raise PlotError(
                    option,
                    f"a picture of kind {self.name} does not use {option}",
                    f"Leave {option} out, or name another kind",
                )
        figure: Figure = import_module(f"{__package__}.{self.home}").draw(dataset, options)
        return figure


# Where it is drawn, its options, and what it is of: of one design, chosen among several.
OF_UNCERTAIN = (
    "spreads",
    ("variable", "at"),
    lambda dataset: "uncertain_parameters" in dataset.attrs,
)

PICTURES = {
    picture.name: picture
    for picture in (
        Picture(
            "posterior", "the posterior of a calibration's unknowns", "spreads", (), is_calibration,
        ),
        Picture(
            "distribution", "how an output with uncertain parameters spreads", *OF_UNCERTAIN,
        ),
        Picture(
            "indices", "shares of the variance, by parameter", *OF_UNCERTAIN,
        ),
        Picture(
            "tornado", "the effect of each tolerance by itself", *OF_UNCERTAIN,
        ),
        Picture("front", "a trade-off of two outputs", "landscape", ("at",),
                lambda dataset: "knee" in dataset),
        Picture("positions", "where the parts of a row are over time", "film", (),
                lambda dataset: dataset.attrs.get("scene") == "row-on-plane"),
        Picture("trajectory", "the motion of one part", "trajectory", (),
                lambda dataset: "cycle_time" in dataset.dims
                or ("motion_status" in dataset and _is_single(dataset))),
        Picture("animation", "the same, moving; a GIF file", "animation", (),
                lambda _: False),
        Picture(
            "landscape", "the objective of an optimisation over one or two variables",
            "landscape", ("axes", "at"),
            lambda dataset: "optimum_status" in dataset,
        ),
        Picture("bodies", "an impact: what hits what", "bodies", ("at",),
                lambda dataset: is_pair(dataset) and _is_single(dataset)),
        Picture("aspects", "the aspects of a part from a file", "aspects", (),
                lambda dataset: "part" in dataset.attrs),
        Picture("field", "the velocity over a plate, as arrows in colours of its size", "field",
                ("axes", "at"),
                lambda dataset: {"velocity_x", "velocity_y"} <= {*dataset.data_vars}),
        Picture("line", "an output over one parameter, or a family of lines", "line"),
        Picture("map", "regimes, or an output whose numbers have names", "maps"),
        Picture("contour", "an output over two parameters, in colours", "maps"),
        Picture("levels", "an output over two parameters, as lines of equal value", "maps"),
    )
}  # fmt: skip

"""By name. The first that fits a dataset is drawn where none is named."""


GONE = {
    "surface": "Draw kind contour or levels",
    "parallel": "Draw kind contour over two parameters, at values of the others",
    "thresholds": "Draw kind line, which shows where the regime changes",
    "profiles": "Draw kind landscape, with the variable as the axis",
    "values": "Print them with `vibrafeed run`, or write a page with `vibrafeed sheet`",
    "effects": "Draw kind indices",
    "speeds": "Draw kind posterior; the file has the speeds: predicted_best and residual",
    "residuals": "Print the variable residual of the file",
}

"""Kinds of former versions, and what shows the same."""
