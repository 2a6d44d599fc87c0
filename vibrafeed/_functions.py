"""Making a study, and carrying it out: the functions that users call, before they have keywords.

`python -m benchmarks.keywords` writes `vibrafeed/_studies.py` from them: each function with all the
keywords of its studies in its signature and in its docstring. It calls the one here.
"""

from __future__ import annotations

import sys
import time
import warnings
from importlib import import_module

CALLER = 5
"""Calls from a warning to who called a function of `vibrafeed`."""
PATIENCE = 2.0
"""Seconds after which a notebook is told how far a computation is, then every `PAUSE`."""
PAUSE = 0.5
WHOLE = 1e-9

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any

    import xarray

    from vibrafeed.core.intake.keywords import StudyLike
    from vibrafeed.core.motion.drive_error import DriveError
    from vibrafeed.core.study import Study
    from vibrafeed.core.watch import Watch


def study(base: StudyLike | None = None, /, **keywords: Any) -> Study:
    """Return the study that a mapping or keywords describe; `kind` says which one it is.

    Its values are right by themselves. Whether they make a whole is seen when it is carried out.

    Parameters
    ----------
    base : mapping, study or path, optional
        The study that the keywords add to.
    **keywords
        Keys of the study and parameters: those of `sweep`, `simulate` and `optimise`.

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
    intake = import_module("vibrafeed.core.intake")
    content = intake.gather(base, keywords)
    if not isinstance(content, dict):
        return content
    made: Study = intake.study_of(content)
    return made


def sweep(study: StudyLike | None = None, /, **keywords: Any) -> xarray.Dataset:
    """Return closed-form quantities of one scene over a grid of parameters.

    They are a snapshot at the drive's peak, with the `regime` that says where they hold.

    *Values* are a number in the unit that is named, text with a unit such as ``"0.25 mm"``, or
    several of either, which become an axis of the dataset: a list, a range, an array, or a mapping
    such as ``{"start": "20 Hz", "stop": "120 Hz", "num": 101}``. ``None`` is a keyword left out.

    Parameters
    ----------
    study : Study, mapping or path, optional
        The study, which keywords add to; its `kind` is ``"sweep"``, and may be left out.

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


def simulate(study: StudyLike | None = None, /, **keywords: Any) -> xarray.Dataset:
    """Return the motion in time of one scene over a grid of parameters: mean velocities and more.

    Without `outputs` it is the mean conveying velocity [m s-1]. `trajectory` gives the
    motion of one cell in time.

    *Values* are a number in the unit that is named, text with a unit such as ``"0.25 mm"``, or
    several of either, which become an axis of the dataset: a list, a range, an array, or a mapping
    such as ``{"start": "20 Hz", "stop": "120 Hz", "num": 101}``. ``None`` is a keyword left out.

    Parameters
    ----------
    study : Study, mapping or path, optional
        The study, which keywords add to; its `kind` is ``"simulate"``, and may be left out.

    Returns
    -------
    xarray.Dataset
        The outputs, each with the axes that it depends on, and units; `regime` says what the part
        does, `motion_status` how the value was found.

    Raises
    ------
    StudyError
        With every problem, also where it is a study of another kind.

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


def optimise(study: StudyLike | None = None, /, **keywords: Any) -> xarray.Dataset:
    """Return the best values of some parameters, over a grid of the others.

    The `criterion` says what is looked for, and `variables` what may be chosen between which
    bounds.

    *Values* are a number in the unit that is named, text with a unit such as ``"0.25 mm"``, or
    several of either, which become an axis of the dataset: a list, a range, an array, or a mapping
    such as ``{"start": "20 Hz", "stop": "120 Hz", "num": 101}``. ``None`` is a keyword left out.

    Parameters
    ----------
    study : Study, mapping or path, optional
        The study, which keywords add to; its `kind` is ``"optimise"``, and may be left out.

    Returns
    -------
    xarray.Dataset
        The best values, `best_beta` and so on, and the outputs there, over the axes; units, and
        `optimum_status`, which says what sort of optimum it is.

    Raises
    ------
    StudyError
        With every problem, also where it is a study of another kind.

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


def sensitivity(study: StudyLike | None = None, /, **keywords: Any) -> xarray.Dataset:
    """Return the variation of outputs with parameters that are not known exactly, over a grid.

    `uncertain` gives parameters and their distributions. `analyses` names the results for
    each output: mean and quantiles, probabilities, Sobol indices, a tolerance budget.

    *Values* are a number in the unit that is named, text with a unit such as ``"0.25 mm"``, or
    several of either, which become an axis of the dataset: a list, a range, an array, or a mapping
    such as ``{"start": "20 Hz", "stop": "120 Hz", "num": 101}``. ``None`` is a keyword left out.

    Parameters
    ----------
    study : Study, mapping or path, optional
        The study, which keywords add to; its `kind` is ``"sensitivity"``, and may be left out.

    Returns
    -------
    xarray.Dataset
        The results of each output, over the axes; units, errors, and `regime` of the nominal
        values. Along `uncertain` are the uncertain parameters, in the order of its
        `flag_meanings`.

    Raises
    ------
    StudyError
        With every problem, also where it is a study of another kind.

    Examples
    --------
    >>> told = vibrafeed.sensitivity(
    ...     scene="rectangle-on-plane", outputs="acceleration_x", frequency="50 Hz",
    ...     amplitude="0.1 mm", beta=30,
    ...     uncertain={"friction": {"mean": 0.3, "deviation": 0.03}},
    ...     demands=[{"output": "acceleration_x", "at_least": "7 m/s^2"}],
    ... )
    >>> 0 < float(told.probability_acceleration_x_at_least) < 1
    True
    """
    return _carry_out("sensitivity", study, keywords)


def calibrate(study: StudyLike | None = None, /, **keywords: Any) -> xarray.Dataset:
    """Return the estimates of unknown parameters from measured speeds.

    `observations` are the runs, each with the parameters that are its own, what was measured and
    its error; they may stand in a CSV or XLSX file. `unknowns`, `offsets` and `factors` are what is
    looked for.

    *Values* are a number in the unit that is named, or text with a unit such as ``"0.25 mm"``.
    ``None`` is a keyword left out.

    Parameters
    ----------
    study : Study, mapping or path, optional
        The study, which keywords add to; its `kind` is ``"calibrate"``, and may be left out.

    Returns
    -------
    xarray.Dataset
        Best values, means and intervals (`best_friction`, `lower_95_friction`, ...), the posterior
        (`log_density`) over its axes, and what is predicted of each run; `findings` among its
        attributes says it in words. See docs/calibrate.md.

    Raises
    ------
    StudyError
        With every problem of the study, each with its place, what is wrong, and what would be
        right.

    Examples
    --------
    >>> told = vibrafeed.calibrate(
    ...     scene="rectangle-on-plane", frequency="50 Hz", beta=20,
    ...     observations=[
    ...         {"amplitude": "0.2 mm", "conveying_velocity": "13 mm/s", "error": "1 mm/s"},
    ...         {"amplitude": "0.3 mm", "conveying_velocity": "33 mm/s", "error": "1 mm/s"},
    ...     ],
    ...     unknowns={"friction": {"lower": 0.1, "upper": 0.6}},
    ... )
    >>> bool(told.lower_95_friction < told.best_friction < told.upper_95_friction)
    True
    """
    return _carry_out("calibrate", study, keywords)


def open_lazily(study: StudyLike | None = None, /, **keywords: Any) -> xarray.Dataset:
    """Return the dataset of a sweep of any size; what is read of it is computed when it is read.

    Parameters
    ----------
    study : Study, mapping or path, optional
        The study, which keywords add to.
    **keywords
        Keys of the study and parameters, as those of `sweep`.

    Returns
    -------
    xarray.Dataset
        What `sweep` returns, without a value yet.

    Raises
    ------
    StudyError
        With every problem.
    VibrafeedError
        If zarr is not installed.

    Examples
    --------
    >>> lazy = vibrafeed.open_lazily(
    ...     scene="rectangle-on-plane", outputs=["acceleration_x"], frequency="50 Hz",
    ...     amplitude={"start": "0.1 mm", "stop": "1 mm", "num": 100_000},
    ...     beta={"start": 0, "stop": 40, "num": 100_000}, friction=0.5,
    ... )
    >>> f"{lazy.acceleration_x.size:,}"
    '10,000,000,000'
    >>> lazy.acceleration_x[99_999, 0].values > lazy.acceleration_x[0, 0].values
    np.True_
    """
    from vibrafeed.core.sweep.lazy import open_lazily  # loads the plan

    prepared = _prepared("sweep", study, keywords)
    _import_accessor()
    return open_lazily(prepared)


def drive_error(
    study: StudyLike | None = None, /, *, draws: int = 200, seed: int = 0, **keywords: Any
) -> DriveError:
    """Return the error of a part's conveying velocity by the errors of a measured drive.

    The part is followed under drives that fit the recording as well as the fitted one. Errors of
    friction and other parameters, of the model and of the sensor's scale are not among them.

    Parameters
    ----------
    study : mapping or path, optional
        A study to simulate, of one cell, whose `drive` names a recording.
    draws : int
        Number of such drives.
    seed : int
        Seed of the random numbers; equal ones give equal results.
    **keywords
        Keys of the study and parameters, as those of `simulate`.

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
    >>> isinstance(told, vibrafeed.DriveError)
    True
    """
    import numpy as np  # a library

    from vibrafeed.core.motion.drive_error import drive_error

    intake = import_module("vibrafeed.core.intake")
    found = intake.gather(study, keywords, "simulate")
    content = found if isinstance(found, dict) else found.content()
    asked, fit = intake.study_and_fit(content)
    return drive_error(asked, fit, draws, np.random.default_rng(seed))


def said(arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keywords that are not None, by name, of all arguments of a public function.

    `arguments` are its `locals()`: the study comes first and is left out, and the mappings `others`
    and `numbered` are merged in.
    """
    _, *named = arguments.items()  # the first is the study
    keywords = dict(named)
    for name in ("others", "numbered"):
        keywords |= keywords.pop(name, {})
    return {name: value for name, value in keywords.items() if value is not None}


def _prepared(kind: str, base: StudyLike | None, keywords: Mapping[str, Any]) -> Any:
    """Return a study of one kind, ready to be computed; warn of unusual values.

    `base` is the study, mapping or path, if any, and `keywords` add to it.
    """
    intake = import_module("vibrafeed.core.intake")
    content = intake.gather(base, keywords, kind)
    if not isinstance(content, dict):
        return import_module("vibrafeed.core.kinds").prepare(content)
    prepared = intake.prepare_content(content, files=True)
    for question in prepared.questions:
        warnings.warn(question, stacklevel=CALLER)
    return prepared


def _carry_out(kind: str, base: StudyLike | None, keywords: Mapping[str, Any]) -> xarray.Dataset:
    """Compute a study of one kind and return its dataset.

    `base` is the study, mapping or path, if any, and `keywords` add to it. Raises `StudyError` with
    every problem, and `LimitError` if the result exceeds this machine's memory.
    """
    prepared = _prepared(kind, base, keywords)
    prepared.check_limits(cells=None, bytes_=import_module("vibrafeed.core.system").memory())
    _import_accessor()
    with import_module("vibrafeed.core.compiling").announced(_say):
        return import_module("vibrafeed.core.kinds").tabulate(prepared, _watch()).to_xarray()


def _watch() -> Watch | None:
    """Return a watch that shows progress in a notebook; elsewhere None."""
    if "ipykernel" not in sys.modules:
        return None
    return import_module("vibrafeed.core.watch").Watch(progress=_progress(time.monotonic))


def _progress(clock: Callable[[], float]) -> Callable[[float], None]:
    """Return a function that takes shares of the work done and writes the progress now and then.

    `clock` returns the time [s].
    """
    began, said, done = clock(), clock(), 0.0

    def advance(share: float) -> None:
        """Add a share of the work, and write a line if the last one is long enough ago."""
        nonlocal said, done
        done += share
        now = clock()
        if said == began and now - began < PATIENCE:
            return  # what ends soon is not worth a line
        if now - said < PAUSE and done < 1:
            return
        said = now
        left = (now - began) * (1 - done) / done if done else 0.0
        line = f"\rvibrafeed: {100 * done:3.0f} %, {left:,.0f} s left"
        sys.stderr.write(line + ("\n" if done >= 1 - WHOLE else ""))

    return advance


def _say(words: str) -> None:
    """Write a line on the error stream, which a notebook shows, too."""
    sys.stderr.write(f"vibrafeed: {words}\n")


def of_kind(kind: str) -> Callable[..., xarray.Dataset]:
    """Return the function that computes studies of a kind, as `sweep` does those of its kind."""

    def carry_out(study: StudyLike | None = None, /, **keywords: Any) -> xarray.Dataset:
        return _carry_out(kind, study, said({"study": study, **keywords}))

    carry_out.__name__ = kind
    carry_out.__doc__ = f"Return the dataset of a study of kind '{kind}'; keywords are its keys."
    return carry_out


def _import_accessor() -> None:
    """Give datasets their `.vf`."""
    from vibrafeed import accessor  # noqa: F401 - loads xarray
