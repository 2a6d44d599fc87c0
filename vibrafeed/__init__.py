"""Motion of parts on vibratory feeder tracks: sweeps, motion in time, best drives.

>>> import vibrafeed
>>> motion = vibrafeed.simulate(
...     scene="rectangle-on-plane", frequency="50 Hz", amplitude="0.25 mm", beta=30, friction=0.5
... )
>>> float(motion.conveying_velocity) > 0
True

What there is:

- `scenes` tells the systems, their parameters, outputs and equations;
- `sweep`, `simulate`, `optimise`, `sensitivity` and `calibrate` carry out a study and return an
  xarray dataset, which has an accessor: `dataset.vf` (`vibrafeed.accessor`); `open_lazily` opens a
  sweep of any size, and computes what is read of it;
- `lookup` reads speeds from an atlas, which `open_atlas` opens;
- `drive_error` tells how far the errors of a measured drive move a velocity;
- `study` and `load_study` make a study without carrying it out; `plot` draws a dataset, and
  `animate` the motion of a part;
- `QUANTITIES` and `REGIMES` describe every name and flag of a dataset;
- `friction` gives published coefficients of friction and restitution, with their sources;
- `parts_per_minute`, `velocity_for` and `effective_distance` turn velocities into rates.

>>> vibrafeed.QUANTITIES["conveying_velocity"].unit, vibrafeed.REGIMES["hopping"].value
('m s-1', 28)

A *study* is written in one of four ways, wherever one is asked for: as an object, as made by
`study` or `load_study`; as the path of a TOML or JSON file; as a mapping that holds what such a
file would; as keywords. Keywords beside one of the others replace what it says. The keys of a study
(`scene`, `outputs`, `variant`, `method`, `criterion`, ...) and the names of parameters may stand
beside each other; the value of a parameter is

- a number, in the unit of `QUANTITIES` (SI, angles in degrees), or text with a unit, ``"0.25 mm"``;
- several of them, which become an axis of the dataset: a list, a tuple, a ``range``, an array of
  numpy, or a mapping such as ``{"start": "20 Hz", "stop": "120 Hz", "num": 101}``.

``help(vibrafeed.simulate)`` lists all keywords of a simulation in words. A study is a `SweepStudy`,
a `SimulateStudy`, an `OptimiseStudy`, a `SensitivityStudy` or a `CalibrateStudy`; a `Study` is any
of them.

>>> type(motion.vf.study) is vibrafeed.SimulateStudy
True
>>> models = [vibrafeed.SweepStudy, vibrafeed.OptimiseStudy, vibrafeed.SensitivityStudy]
>>> all(issubclass(model, vibrafeed.Study) for model in (*models, vibrafeed.CalibrateStudy))
True

What is wrong with a study is a `StudyError`, whose `problems` say where, what, and what would be
right. It is a `VibrafeedError`, as are all errors that are raised on purpose.

>>> try:
...     vibrafeed.simulate(motion.vf.study, friction="much")
... except vibrafeed.StudyError as error:
...     problem = error.problems[0]
>>> isinstance(problem, vibrafeed.Problem), problem.place
(True, 'parameters.friction')
>>> issubclass(vibrafeed.LimitError, vibrafeed.VibrafeedError)  # larger than a limit in force
True

Importing this module loads no library; each function loads what it needs.

>>> vibrafeed.__version__ == vibrafeed.core.__version__
True
"""

from __future__ import annotations

import os as _os
import sys as _sys
from importlib import import_module

from vibrafeed import core
from vibrafeed._functions import of_kind
from vibrafeed._studies import (
    calibrate,
    drive_error,
    open_lazily,
    optimise,
    sensitivity,
    simulate,
    study,
    sweep,
)

TYPE_CHECKING = False  # of the standard library's it is known to all, and would have to be loaded
if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence
    from typing import Any

    import xarray
    from matplotlib.figure import Figure

    from vibrafeed.core.atlas.lookup import lookup
    from vibrafeed.core.atlas.read import open_atlas
    from vibrafeed.core.errors import LimitError, Problem, StudyError, VibrafeedError
    from vibrafeed.core.materials import friction, leaf_springs
    from vibrafeed.core.motion.drive_error import DriveError
    from vibrafeed.core.motion.rates import effective_distance, parts_per_minute, velocity_for
    from vibrafeed.core.quantities import QUANTITIES, REGIMES
    from vibrafeed.core.study import (
        CalibrateStudy,
        OptimiseStudy,
        SensitivityStudy,
        SimulateStudy,
        Study,
        SweepStudy,
    )

__version__: str = core.__version__

_ELSEWHERE = {
    "vibrafeed.core.atlas.lookup": ("lookup",),
    "vibrafeed.core.atlas.read": ("open_atlas",),
    "vibrafeed.core.errors": ("LimitError", "Problem", "StudyError", "VibrafeedError"),
    "vibrafeed.core.materials": ("friction", "leaf_springs"),
    "vibrafeed.core.motion.drive_error": ("DriveError",),
    "vibrafeed.core.motion.rates": ("effective_distance", "parts_per_minute", "velocity_for"),
    "vibrafeed.core.quantities": ("QUANTITIES", "REGIMES"),
    "vibrafeed.core.study": (
        "CalibrateStudy",
        "OptimiseStudy",
        "SensitivityStudy",
        "SimulateStudy",
        "Study",
        "SweepStudy",
    ),
}
_HOMES = {name: module for module, names in _ELSEWHERE.items() for name in names}

__all__ = [
    "QUANTITIES",
    "REGIMES",
    "CalibrateStudy",
    "DriveError",
    "LimitError",
    "OptimiseStudy",
    "Problem",
    "SensitivityStudy",
    "SimulateStudy",
    "Study",
    "StudyError",
    "SweepStudy",
    "VibrafeedError",
    "__version__",
    "animate",
    "calibrate",
    "drive_error",
    "effective_distance",
    "friction",
    "leaf_springs",
    "load_study",
    "lookup",
    "open_atlas",
    "open_lazily",
    "optimise",
    "parts_per_minute",
    "plot",
    "scenes",
    "sensitivity",
    "simulate",
    "study",
    "sweep",
    "velocity_for",
]


if not TYPE_CHECKING:  # there every name would do

    def __getattr__(name: str) -> Any:
        """Load what stands in the core when it is first asked for."""
        if name in _HOMES:
            value = getattr(import_module(_HOMES[name]), name)
        elif (
            name in import_module("vibrafeed.core.kinds").KINDS
        ):  # for which no keywords have been written
            value = of_kind(name)
        else:
            raise AttributeError(f"module 'vibrafeed' has no attribute '{name}'")
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def load_study(path: str | os.PathLike[str]) -> Study:
    """Return the study in a TOML or JSON file.

    Raises
    ------
    StudyError
        With every problem of the file.

    Examples
    --------
    >>> study = vibrafeed.load_study("configs/figures/fig-5-1.toml")
    >>> study.kind, study.scene
    ('sweep', 'cylinder-on-plane')
    """
    loaded: Study = import_module("vibrafeed.core.intake").load_study(path)
    return loaded


def plot(
    dataset: xarray.Dataset | str | os.PathLike[str] | Sequence[Any],
    *,
    variable: str | None = None,
    axes: str | tuple[str, ...] | None = None,
    at: Mapping[str, float | str] | None = None,
    kind: str | None = None,
    title: str | None = None,
    units: str | Sequence[str] | None = None,
    nearest: bool = False,
    dark: bool = False,
    small: bool = False,
) -> Figure:
    """Return the picture of an output with its regimes, of the regimes alone, or of one motion.

    It needs matplotlib, of the extra `plot`. A notebook shows the figure; its method
    `savefig` writes it.

    Parameters
    ----------
    dataset : xarray.Dataset, or a list of them
        A dataset that `sweep`, `simulate` or `optimise` returned, or the path of a file that
        `vibrafeed run` wrote. Of several, the same output is drawn over the same axis.
    variable : str, optional
        The output; the first if left out.
    axes : str or tuple of str, optional
        One or two dimensions, the first across; the longest if left out.
    at : mapping, optional
        Values of other dimensions, numbers in the unit of the dataset or text with a unit; the
        middle one if left out.
    kind : str, optional
        The name of a picture: posterior, speeds, residuals, distribution, indices, effects,
        tornado, front, positions, trajectory, animation, landscape, profiles, values, line, map,
        contour, levels, surface, thresholds or parallel; the first that fits if left out.
    title : str, optional
        The name of the picture; that of what it shows if left out.
    units : str or sequence of str, optional
        Units for reading: `trade`, those usual in practice (mm, mm/s); `si`; or units such as
        m/min, each for its kind. If left out, those of the study, else trade.
    nearest : bool
        True if a value of `at` that the dataset does not have stands for the nearest one.
    dark : bool
        Draw in light colours on a dark background.
    small : bool
        For a column of a document, some 11 cm wide.

    Raises
    ------
    VibrafeedError
        If the dataset does not hold what is asked for.

    Examples
    --------
    >>> dataset = vibrafeed.sweep(
    ...     scene="rectangle-on-plane", outputs=["acceleration_x"], frequency="50 Hz",
    ...     amplitude="0.25 mm", beta=range(0, 41, 5), friction=[0.3, 0.5],
    ... )
    >>> figure = vibrafeed.plot(dataset, axes="beta", at={"friction": 0.5})
    >>> figure.get_suptitle()
    'Acceleration along the track'
    """
    plots = import_module("vibrafeed.core.plots")
    dataset = _opened(dataset)
    dims = (axes,) if isinstance(axes, str) else axes
    return plots.draw(
        dataset, variable=variable, axes=dims, at=plots.read_fixed(at or {}), kind=kind,
        title=title, units=units, nearest=nearest, dark=dark, small=small,
    )  # fmt: skip


def _opened(source: Any) -> Any:
    """Return the datasets to be drawn: paths are read as files, lists entry by entry."""
    if isinstance(source, str | _os.PathLike):
        return import_module("vibrafeed.core.plots.files").read(source)
    return [_opened(one) for one in source] if isinstance(source, list | tuple) else source


def animate(
    dataset: xarray.Dataset | str | os.PathLike[str],
    file: str | os.PathLike[str],
    *,
    slow: float | None = None,
    title: str | None = None,
    units: str | Sequence[str] | None = None,
    dark: bool = False,
    small: bool = False,
) -> None:
    """Write the motion of one part as an animation, GIF or MP4 by the suffix of the file.

    It needs matplotlib, and imageio-ffmpeg for MP4: the extra `video`.

    Parameters
    ----------
    dataset : xarray.Dataset or path
        A simulation of one part with `trajectory`, or the file of one.
    file : path
        The file; an existing one is replaced.
    slow : float, optional
        Slow-motion factor. By default a period takes about a second, a fall six.
    title, units, dark, small
        As for `plot`.

    Raises
    ------
    VibrafeedError
        If the dataset holds no trajectory, or the file cannot be made.

    Examples
    --------
    >>> import os, tempfile
    >>> motion = vibrafeed.simulate("configs/trajectory.toml", trajectory=40)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     vibrafeed.animate(motion, os.path.join(folder, "part.gif"), slow=10)
    ...     os.listdir(folder)
    ['part.gif']
    """
    from pathlib import Path

    from vibrafeed.core.plots.movie import animate

    animate(
        _opened(dataset), Path(file), slow=slow, title=title, units=units, dark=dark, small=small
    )


def scenes(
    name: str | None = None, variant: str | None = None, *, method: str | None = None
) -> Any:
    """Return the catalogue: one entry a scene, or all about the scene of that name.

    Parameters
    ----------
    name : str, optional
        Name of the scene to describe; by default all scenes are listed.
    variant : str, optional
        The variant that is described; the scene's default if left out.
    method : str, optional
        A method of simulation: what is described is then the motion in time.

    Returns
    -------
    list of dict, or dict
        Of a scene: its parameters, outputs, equations, regimes and validity, as plain values.

    Raises
    ------
    StudyError
        If there is no such scene, variant or method.

    Examples
    --------
    >>> [scene["name"] for scene in vibrafeed.scenes()][:2]
    ['rectangle-isolated', 'rectangle-on-plane']
    >>> vibrafeed.scenes("rectangle-on-plane")["parameters"][0]["name"]
    'frequency'
    """
    catalogue = import_module("vibrafeed.core.catalogue")
    return (
        catalogue.describe_all()
        if name is None
        else catalogue.describe(name, variant, method=method)
    )


if "xarray" in _sys.modules:  # files that are read from now on have `.vf` too, at no cost
    import vibrafeed.accessor  # noqa: F401
