"""How parts accelerate and travel on vibratory feeder tracks: sweeps, motion in time, best drives.

>>> import vibrafeed
>>> motion = vibrafeed.simulate(
...     scene="rectangle-on-plane", frequency="50 Hz", amplitude="0.25 mm", beta=30, friction=0.5
... )
>>> float(motion.conveying_velocity) > 0
True

What there is:

- `scenes` tells the systems, their parameters, outputs and equations;
- `sweep`, `simulate` and `optimise` carry out a study and return an xarray dataset; `open_lazily`
  opens a sweep of any size, and computes what is read of it;
- `drive_error` tells how far the errors of a measured drive move a velocity;
- `study` and `load_study` make a study without carrying it out; `plot` draws a dataset;
- `QUANTITIES` and `REGIMES` describe every name and flag of a dataset;
- `parts_per_minute`, `velocity_for` and `effective_distance` turn velocities into rates.

A *study* is written in one of four ways, wherever one is asked for: as an object, as made by
`study` or `load_study`; as the path of a TOML or JSON file; as a mapping that holds what such a
file would; as keywords. Keywords beside one of the others replace what it says. The keys of a study
(`scene`, `outputs`, `variant`, `method`, `criterion`, ...) and the names of parameters may stand
beside each other; the value of a parameter is

- a number, in the unit of `QUANTITIES` (SI, angles in degrees), or text with a unit, ``"0.25 mm"``;
- several of them, which become an axis of the dataset: a list, a tuple, a ``range``, an array of
  numpy, or a mapping such as ``{"start": "20 Hz", "stop": "120 Hz", "num": 101}``.

What is wrong with a study is a `StudyError`, whose `problems` say where, what, and what would be
right. It is a `VibrafeedError`, as are all errors that are raised on purpose.

Importing this module loads no library; each function loads what it needs.
"""

from __future__ import annotations

from importlib import import_module

from vibrafeed._packages import ForeignPackageError, claim

claim("core")

import core  # noqa: E402 - found only now

TYPE_CHECKING = False  # of the standard library's it is known to all, and would have to be loaded
if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence
    from typing import Any

    import xarray
    from matplotlib.figure import Figure

    from core.errors import LimitError, Problem, StudyError, VibrafeedError
    from core.motion.drive_error import DriveError
    from core.motion.rates import effective_distance, parts_per_minute, velocity_for
    from core.quantities import QUANTITIES, REGIMES
    from core.study import OptimiseStudy, SimulateStudy, Study, SweepStudy
    from core.study.gather import Given

__version__: str = core.__version__

_ELSEWHERE = {
    "core.errors": ("LimitError", "Problem", "StudyError", "VibrafeedError"),
    "core.motion.drive_error": ("DriveError",),
    "core.motion.rates": ("effective_distance", "parts_per_minute", "velocity_for"),
    "core.quantities": ("QUANTITIES", "REGIMES"),
    "core.study": ("OptimiseStudy", "SimulateStudy", "Study", "SweepStudy"),
}
_HOMES = {name: module for module, names in _ELSEWHERE.items() for name in names}

__all__ = [
    "QUANTITIES",
    "REGIMES",
    "DriveError",
    "ForeignPackageError",
    "LimitError",
    "OptimiseStudy",
    "Problem",
    "SimulateStudy",
    "Study",
    "StudyError",
    "SweepStudy",
    "VibrafeedError",
    "__version__",
    "drive_error",
    "effective_distance",
    "load_study",
    "open_lazily",
    "optimise",
    "parts_per_minute",
    "plot",
    "scenes",
    "simulate",
    "study",
    "sweep",
    "velocity_for",
]


if not TYPE_CHECKING:  # there every name would do

    def __getattr__(name: str) -> Any:
        """Load what stands in the core when it is first asked for."""
        if name not in _HOMES:
            raise AttributeError(f"module 'vibrafeed' has no attribute '{name}'")
        value = getattr(import_module(_HOMES[name]), name)
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
    from core.kinds import load_study

    return load_study(path)


def study(given: Given | None = None, /, **keywords: Any) -> Study:
    """Return the study that a mapping or keywords describe; `kind` says which one it is.

    Its values are right by themselves. Whether they make a whole is seen when it is carried out.

    Parameters
    ----------
    given : mapping, study or path, optional
        What the keywords are added to.
    **keywords
        Keys of the study and parameters.

    Raises
    ------
    StudyError
        With every problem.

    Examples
    --------
    >>> drive = vibrafeed.study(
    ...     kind="sweep", scene="rectangle-on-plane", outputs=["acceleration_x"],
    ...     frequency=range(20, 121), amplitude="0.35 mm", beta=[15, 30], friction=0.3,
    ... )
    >>> dict(vibrafeed.sweep(drive, beta=20).sizes)
    {'frequency': 101}
    """
    from core.kinds import study_of
    from core.study.gather import gather

    found = gather(given, keywords)
    return study_of(found) if isinstance(found, dict) else found


def sweep(study: Given | None = None, /, **keywords: Any) -> xarray.Dataset:
    """Return closed-form quantities of one scene over a grid of parameters.

    They are a snapshot at the drive's peak, with the `regime` that says where they hold.

    Parameters
    ----------
    study : Study, mapping or path, optional
        The study; its `kind` is ``"sweep"``, and may be left out of a mapping.
    **keywords
        Keys and parameters that the study has too, or has instead.

    Returns
    -------
    xarray.Dataset
        The outputs, each with the axes that it depends on, units and equation numbers.

    Raises
    ------
    StudyError
        With every problem, also where it is a study of another kind.

    Examples
    --------
    >>> import numpy as np
    >>> dataset = vibrafeed.sweep(
    ...     scene="rectangle-on-plane", outputs=["acceleration_x"], frequency="50 Hz",
    ...     amplitude="0.25 mm", beta=np.linspace(0, 40, 9), friction=0.5,
    ... )
    >>> dataset.acceleration_x.dims, dataset.acceleration_x.units
    (('beta',), 'm s-2')
    """
    return _carry_out("sweep", study, keywords)


def simulate(study: Given | None = None, /, **keywords: Any) -> xarray.Dataset:
    """Return the motion in time of one scene over a grid of parameters: mean velocities and more.

    Parameters, errors and result are those of `sweep`, with ``"simulate"`` for the `kind`. Without
    `outputs` it is the mean conveying velocity. `trajectory` gives the course of one point in time.

    Examples
    --------
    >>> motion = vibrafeed.simulate(
    ...     scene="rectangle-on-plane", frequency="50 Hz", amplitude=["0.25 mm", "0.4 mm"], beta=30,
    ...     friction=0.5,
    ... )
    >>> motion.conveying_velocity.dims, motion.conveying_velocity.units
    (('amplitude',), 'm s-1')
    """
    return _carry_out("simulate", study, keywords)


def optimise(study: Given | None = None, /, **keywords: Any) -> xarray.Dataset:
    """Return the best values of some parameters, over a grid of the others.

    Parameters, errors and result are those of `sweep`, with ``"optimise"`` for the `kind`. The
    `criterion` says what is looked for, and `variables` what may be chosen between which bounds.

    Examples
    --------
    >>> best = vibrafeed.optimise(
    ...     scene="rectangle-on-plane", criterion={"kind": "maximise", "output": "acceleration_x"},
    ...     variables={"beta": {"lower": 0, "upper": 60}}, frequency="50 Hz", amplitude="0.25 mm",
    ...     friction=0.5,
    ... )
    >>> best.best_beta.units
    'degree'
    """
    return _carry_out("optimise", study, keywords)


def drive_error(
    study: Given | None = None, /, *, draws: int = 200, seed: int = 0, **keywords: Any
) -> DriveError:
    """Return how far the errors of a measured drive move the conveying velocity of one part.

    The part is followed under drives that the recording cannot tell from the fitted one. Errors of
    friction and other parameters, of the model and of the sensor's scale are not among them.

    Parameters
    ----------
    study : mapping or path, optional
        A study to simulate, of one cell, whose `drive` names a recording.
    draws : int
        How many such drives.
    seed : int
        Of the random numbers; equal ones give equal results.
    **keywords
        Keys and parameters that the study has too, or has instead.

    Returns
    -------
    DriveError
        velocity, standard_deviation, lower and upper (of 95 %), draws, without [m s-1].

    Raises
    ------
    StudyError
        With every problem.

    Examples
    --------
    >>> told = vibrafeed.drive_error("configs/measured-drive.toml", drive_factor=1, friction=0.3)
    >>> told.lower < told.velocity < told.upper
    True
    """
    import numpy as np

    from core.kinds import study_and_fit
    from core.motion.drive_error import drive_error
    from core.study.gather import gather

    found = gather(study, keywords, "simulate")
    asked, fit = study_and_fit(found if isinstance(found, dict) else found.content())
    return drive_error(asked, fit, draws, np.random.default_rng(seed))


def open_lazily(study: Given | None = None, /, **keywords: Any) -> xarray.Dataset:
    """Return the dataset of a sweep of any size; what is read of it is computed when it is read.

    Parameters and errors are those of `sweep`. It needs zarr: ``pip install 'vibrafeed[cluster]'``.

    Raises
    ------
    VibrafeedError
        If zarr is not installed.
    """
    from core.sweep.lazy import open_lazily

    return open_lazily(_prepared("sweep", study, keywords))


def plot(
    dataset: xarray.Dataset,
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

    It needs matplotlib: ``pip install 'vibrafeed[plot]'``. A notebook shows the figure; its method
    `savefig` writes it.

    Parameters
    ----------
    dataset : xarray.Dataset
        What `sweep`, `simulate` or `optimise` returned, or a file that `vibrafeed run` wrote.
    variable : str, optional
        The output; the first if left out.
    axes : str or tuple of str, optional
        One or two dimensions, the first across; the longest if left out.
    at : mapping, optional
        Values of other dimensions, numbers in the unit of the dataset or text with a unit; the
        middle one if left out.
    kind : str, optional
        contour, surface, line, map, trajectory, front or landscape; what fits if left out.
    title : str, optional
        The name of the picture; that of what it shows if left out.
    units : str or sequence of str, optional
        Units in which values are read: trade (mm, mm/s), si, or units such as m/min, each for its
        kind. If left out, those of the study, else trade.
    nearest : bool
        Whether a value of `at` that the dataset does not have stands for the nearest one.
    dark : bool
        Light on dark.
    small : bool
        For a column of a document, some 11 cm wide.

    Raises
    ------
    VibrafeedError
        If the dataset does not hold what is asked for.
    """
    from core.plots import draw
    from core.plots.fixed import read_fixed

    dims = (axes,) if isinstance(axes, str) else axes
    return draw(
        dataset, variable=variable, axes=dims, at=read_fixed(at or {}), kind=kind, title=title,
        units=units, nearest=nearest, dark=dark, small=small,
    )  # fmt: skip


def scenes(
    name: str | None = None, variant: str | None = None, *, method: str | None = None
) -> Any:
    """Return the catalogue: one entry a scene, or all about the scene of that name.

    Parameters
    ----------
    name : str, optional
        A scene; all if left out.
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
    from core.catalogue import describe, describe_all

    return describe_all() if name is None else describe(name, variant, method=method)


def _prepared(kind: str, given: Given | None, keywords: Mapping[str, Any]) -> Any:
    """Return a study of one kind, ready to be carried out."""
    from core.kinds import prepare, prepare_content
    from core.study.gather import gather

    found = gather(given, keywords, kind)
    return prepare_content(found, files=True) if isinstance(found, dict) else prepare(found)


def _carry_out(kind: str, given: Given | None, keywords: Mapping[str, Any]) -> xarray.Dataset:
    from core.kinds import tabulate

    return tabulate(_prepared(kind, given, keywords)).to_xarray()
