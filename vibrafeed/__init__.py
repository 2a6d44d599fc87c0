"""Motion of parts on vibratory feeder tracks: sweeps, motion in time, best drives.

>>> import vibrafeed
>>> motion = vibrafeed.simulate(
...     "rectangle-on-plane", frequency="50 Hz", amplitude="0.25 mm", beta=30, friction=0.5
... )
>>> float(motion.conveying_velocity) > 0
True

Functions
---------
- `scenes` lists the scenes; `scene` shows one: parameters, outputs, units, equations.
- `sweep` (closed forms), `simulate` (motion in time), `optimise`, `sensitivity` and
  `calibrate` carry out a study and return an xarray dataset; `open_lazily` opens a sweep
  of any size. `study` and `load_study` make a study without carrying it out.
- `plot` draws a dataset, `animate` the motion of a part.
- `drive_error` tells how far the errors of a measured drive move a velocity.
- `friction`, `leaf_springs` give published values; `parts_per_minute`, `velocity_for` and
  `effective_distance` turn velocities into rates.
- `QUANTITIES` and `REGIMES` describe every name and flag of a dataset.

Studies
-------
The first argument is the name of a scene, the path of a TOML or JSON file, a mapping that
holds what such a file would, or a study. Keywords beside it replace what it says: keys of
the study, which the `help` of each function lists, and parameters of the scene, which
`scene` lists. All studies have `units` (those of screens and pictures: trade, si, or such
as m/min), `title`, `notes` and `designs` (rows of values that belong together). `None` is a
keyword left out. The value of a parameter is

- a number, in SI and degrees, as `QUANTITIES["amplitude"].unit` says;
- text with a unit: ``"0.25 mm"``, ``"3000 rpm"``, ``"20 deg"``; or a quantity of pint;
- several of them, which become an axis of the dataset: a list, a ``range``, an array, or
  a mapping such as ``{"start": "20 Hz", "stop": "120 Hz", "num": 101}``, or with ``step``.

A study is a `SweepStudy`, a `SimulateStudy`, an `OptimiseStudy`, a `SensitivityStudy` or a
`CalibrateStudy`; a `Study` is any of them.

>>> type(motion.vibrafeed.study) is vibrafeed.SimulateStudy
True
>>> models = [vibrafeed.SweepStudy, vibrafeed.OptimiseStudy, vibrafeed.SensitivityStudy]
>>> all(issubclass(model, vibrafeed.Study) for model in (*models, vibrafeed.CalibrateStudy))
True

Datasets
--------
Values are in SI, angles in degrees; `dataset.vibrafeed.trade()` gives mm, mm/s, deg and
1/min. `dataset.vibrafeed` draws, counts regimes, writes Excel (`vibrafeed.accessor`).

>>> vibrafeed.QUANTITIES["conveying_velocity"].unit, vibrafeed.REGIMES["hopping"].value
('m s-1', 28)

Errors
------
What is wrong with a study is a `StudyError`, whose `problems` say where, what, and what
would be right. It is a `VibrafeedError`, as are all errors that are raised on purpose.

>>> try:
...     vibrafeed.simulate(motion.vibrafeed.study, friction="much")
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

import sys as _sys
from importlib import import_module as _import_module

from vibrafeed import core
from vibrafeed._functions import (
    animate,
    calibrate,
    drive_error,
    open_lazily,
    optimise,
    plot,
    scene,
    scenes,
    sensitivity,
    simulate,
    study,
    sweep,
)

TYPE_CHECKING = False
if TYPE_CHECKING:
    from vibrafeed.core.errors import LimitError, Problem, StudyError, VibrafeedError
    from vibrafeed.core.intake import load_study
    from vibrafeed.core.materials import friction, leaf_springs
    from vibrafeed.core.motion.drive_error import DriveError
    from vibrafeed.core.motion.feeding import effective_distance, parts_per_minute, velocity_for
    from vibrafeed.core.quantities import QUANTITIES, REGIMES
    from vibrafeed.core.study.calibrate_study import CalibrateStudy
    from vibrafeed.core.study.grid_study import Study
    from vibrafeed.core.study.optimise_study import OptimiseStudy
    from vibrafeed.core.study.sensitivity_study import SensitivityStudy
    from vibrafeed.core.study.sweep_and_simulate import SimulateStudy, SweepStudy

__version__: str = core.__version__

__all__ = [
    "QUANTITIES", "REGIMES", "CalibrateStudy", "DriveError", "LimitError", "OptimiseStudy",
    "Problem", "SensitivityStudy", "SimulateStudy", "Study", "StudyError", "SweepStudy",
    "VibrafeedError", "__version__", "animate", "calibrate", "drive_error",
    "effective_distance", "friction", "leaf_springs", "load_study", "open_lazily",
    "optimise", "parts_per_minute", "plot", "scene", "scenes", "sensitivity",
    "simulate", "study", "sweep", "velocity_for",
]  # fmt: skip

_HOMES = {
    "errors": ("LimitError", "Problem", "StudyError", "VibrafeedError"),
    "intake": ("load_study",),
    "materials": ("friction", "leaf_springs"),
    "motion.drive_error": ("DriveError",),
    "motion.feeding": ("effective_distance", "parts_per_minute", "velocity_for"),
    "quantities": ("QUANTITIES", "REGIMES"),
    "study.calibrate_study": ("CalibrateStudy",),
    "study.grid_study": ("Study",),
    "study.optimise_study": ("OptimiseStudy",),
    "study.sensitivity_study": ("SensitivityStudy",),
    "study.sweep_and_simulate": ("SimulateStudy", "SweepStudy"),
}

if not TYPE_CHECKING:  # there every name would do

    def __getattr__(name: str) -> object:
        """Load what stands in the core when it is first asked for."""
        for home, names in _HOMES.items():
            if name in names:
                value = getattr(_import_module(f"vibrafeed.core.{home}"), name)
                globals()[name] = value
                return value
        raise AttributeError(f"module 'vibrafeed' has no attribute '{name}'")


def __dir__() -> list[str]:
    return __all__


if "xarray" in _sys.modules:  # files that are read from now on have `.vibrafeed`, at no cost
    import vibrafeed.accessor  # noqa: F401
