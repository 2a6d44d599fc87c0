"""The functions of `vibrafeed`: making a study, carrying it out, and looking at what came."""

from __future__ import annotations

import os
import sys
import time
import warnings
from importlib import import_module

CALLER = 3
"""Calls from a warning in `_prepared` to who called a function of `vibrafeed`."""
PATIENCE = 2.0
"""Seconds after which a notebook is told how far a computation is, then every `PAUSE`."""
PAUSE = 0.5
WHOLE = 1e-9

TYPE_CHECKING = False  # of the standard library's it is known to all, and would have to be loaded
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from typing import Any, Literal, Unpack

    import xarray
    from matplotlib.figure import Figure

    from vibrafeed._values import Bounds, Maps, Named, Values
    from vibrafeed.core.catalogue import SceneCard
    from vibrafeed.core.intake.keywords import StudyLike
    from vibrafeed.core.motion.drive_error import DriveError
    from vibrafeed.core.study.grid_study import Study
    from vibrafeed.core.watch import Watch
    from vibrafeed.parameters import Keywords, Outputs, SceneName


def study(
    scene: SceneName | StudyLike | None = None, /, *, kind: str | None = None, **keywords: Any
) -> Study:
    """Return a study without carrying it out.

    Its values are right by themselves. Whether they make a whole is seen when it is carried out.

    Parameters
    ----------
    scene : str, Study, mapping or path
        Name of the scene; or a study that the keywords change.
    kind : str
        sweep, simulate, optimise, sensitivity or calibrate.
    **keywords
        Those of the function that carries it out.

    Examples
    --------
    >>> drive = vibrafeed.study(
    ...     "rectangle-on-plane", kind="sweep", outputs=["acceleration_x"],
    ...     frequency=range(20, 121), amplitude="0.35 mm", beta=[15, 30], friction=0.3,
    ... )
    >>> dict(vibrafeed.sweep(drive, beta=20).sizes)
    {'frequency': 101}
    """
    intake = import_module("vibrafeed.core.intake")
    more = {name: value for name, value in keywords.items() if value is not None}
    content = intake.gather(scene, more if kind is None else {"kind": kind, **more})
    made: Study = intake.study_of(content) if isinstance(content, dict) else content
    return made


def sweep(
    scene: SceneName | StudyLike | None = None, /, *, outputs: Outputs | None = None,
    variant: str | None = None, part: Mapping[str, Any] | None = None,
    reduce: Mapping[str, Any] | None = None,
    sensitivities: bool | Sequence[str] | None = None, verify: int | None = None,
    **parameters: Unpack[Keywords],
) -> xarray.Dataset:  # fmt: skip
    """Return closed-form quantities of one scene over a grid of parameters.

    They are a snapshot at the drive's peak, with the `regime` that says where they hold.

    Parameters
    ----------
    scene : str, Study, mapping or path
        The name of a scene, or a study that the keywords change.
    **parameters
        `vibrafeed.scene("rectangle-on-plane")` lists them, and `help(vibrafeed)` says
        how values are written, and which keywords all studies have.

    Results
        outputs : names of outputs of the scene
        variant : thesis, derived or physical; the scene's own if left out
        part : a part from a file (docs/which-way-up.md)
        reduce : statistics over some axes instead of all cells (docs/scale.md)
        sensitivities : derivatives and elasticities, too: True, or parameters
    Numerics
        verify : number of random cells to evaluate again in extended precision

    Returns
    -------
    xarray.Dataset
        The outputs in SI, each with the axes that it depends on. A study with
        problems, or of another kind, raises `StudyError` with all of them.

    Examples
    --------
    >>> import numpy as np
    >>> dataset = vibrafeed.sweep(
    ...     "rectangle-on-plane", outputs=["acceleration_x"], frequency="50 Hz",
    ...     amplitude="0.25 mm", beta=np.linspace(0, 40, 9), friction=0.5,
    ... )
    >>> dataset.acceleration_x.dims, dataset.acceleration_x.units
    (('beta',), 'm s-2')
    """
    return _carry_out(_prepared("sweep", locals()))


def simulate(
    scene: SceneName | StudyLike | None = None, /, *, outputs: Outputs | None = None,
    method: str | None = None, trajectory: int | Sequence[float] | None = None,
    drive: Mapping[str, Any] | None = None, reduce: Mapping[str, Any] | None = None,
    sensitivities: bool | Sequence[str] | None = None, verify: int | None = None,
    tolerance: float | None = None, max_periods: int | None = None,
    **parameters: Unpack[Keywords],
) -> xarray.Dataset:  # fmt: skip
    """Return the motion in time of one scene over a grid of parameters.

    Parameters
    ----------
    scene : str, Study, mapping or path
        The name of a scene, or a study that the keywords change.
    **parameters
        `vibrafeed.scene("rectangle-on-plane", method="events")` lists them, and
        `help(vibrafeed)` says how values are written, and what all studies have.

    Drive and results
        drive : a recording of an accelerometer (docs/measuring.md)
        outputs : names of outputs; the mean `conveying_velocity` if left out
        trajectory : motion of one cell at so many steps, or at these times [s]
        reduce : statistics over some axes instead of all cells (docs/scale.md)
        sensitivities : derivatives and elasticities, too: True, or parameters
    Numerics
        method : events (exact, the default), or reference to check it
        tolerance, max_periods : error of periodic motion, most periods of a cell
        verify : number of random cells to follow again by another method

    Returns
    -------
    xarray.Dataset
        The outputs in SI. `regime` says what the part does, `motion_status` how the
        value was found. Problems of the study raise `StudyError` with all of them.

    Examples
    --------
    >>> motion = vibrafeed.simulate(
    ...     "rectangle-on-plane", frequency="50 Hz",
    ...     amplitude=["0.25 mm", "0.4 mm"], beta=30, friction=0.5,
    ... )
    >>> motion.conveying_velocity.dims, motion.conveying_velocity.units
    (('amplitude',), 'm s-1')
    """
    return _carry_out(_prepared("simulate", locals()))


def optimise(
    scene: SceneName | StudyLike | None = None, /, *, criterion: Mapping[str, Any] | None = None,
    variables: Mapping[str, Bounds] | None = None,
    constraints: Sequence[Mapping[str, Any]] | None = None, floor_contact: bool | None = None,
    wall_contact: bool | None = None, uncertain: Maps | None = None,
    robust: Literal["worst", "mean", "quantile"] | None = None, quantile: float | None = None,
    outputs: Outputs | None = None, variant: str | None = None, method: str | None = None,
    drive: Mapping[str, Any] | None = None, part: Mapping[str, Any] | None = None,
    sensitivities: bool | Sequence[str] | None = None, verify: int | None = None,
    **parameters: Unpack[Keywords],
) -> xarray.Dataset:  # fmt: skip
    """Return the best values of some parameters, over a grid of the others.

    Parameters
    ----------
    scene : str, Study, mapping or path
        The name of a scene, or a study that the keywords change.
    **parameters
        `vibrafeed.scene` lists them, `help(vibrafeed)` says how values are written.

    Criterion (docs/optimise.md)
        criterion : such as `{"kind": "maximise", "output": "conveying_velocity"}`
        variables : bounds, such as `{"beta": {"lower": 0, "upper": "60 deg"}}`
        constraints : bounds of outputs
        floor_contact, wall_contact : True if the part must stay there
        uncertain : bounds or distributions of parameters not known exactly
        robust, quantile : worst, mean or quantile (0 to 1) under them
    Results and numerics
        outputs : further outputs at the optimum
        variant, method : closed forms by variant, or motion in time by method
        drive : a recording of an accelerometer
        part : a part from a file, in place of its shape
        sensitivities : derivatives of the optimum: True, or parameters
        verify : number of cells to search again by another method

    Returns
    -------
    xarray.Dataset
        `best_beta` and so on, and the outputs there, in SI; `optimum_status` says
        what each optimum is. Problems raise `StudyError` with all of them.

    Examples
    --------
    >>> best = vibrafeed.optimise(
    ...     "rectangle-on-plane", criterion={"kind": "maximise", "output": "acceleration_x"},
    ...     variables={"beta": {"lower": 0, "upper": 60}}, frequency="50 Hz",
    ...     amplitude="0.25 mm", friction=0.5,
    ... )
    >>> best.best_beta.units
    'degree'
    """
    return _carry_out(_prepared("optimise", locals()))


def sensitivity(
    scene: SceneName | StudyLike | None = None, /, *, outputs: Outputs | None = None,
    uncertain: Maps | None = None, analyses: Named | None = None,
    demands: Sequence[Mapping[str, Any]] | None = None, quantiles: Sequence[float] | None = None,
    samples: int | None = None, seed: int | None = None, variant: str | None = None,
    method: str | None = None, drive: Mapping[str, Any] | None = None,
    part: Mapping[str, Any] | None = None, verify: int | None = None,
    **parameters: Unpack[Keywords],
) -> xarray.Dataset:  # fmt: skip
    """Return the variation of outputs with parameters that are not known exactly.

    Parameters
    ----------
    scene : str, Study, mapping or path
        The name of a scene, or a study that the keywords change.
    **parameters
        `vibrafeed.scene` lists them, `help(vibrafeed)` says how values are written.

    Analysis (docs/sensitivity.md)
        outputs : names of outputs of the scene
        uncertain : such as `{"friction": {"mean": 0.3, "deviation": 0.03}}`
        analyses : some of distribution, sobol and budget
        demands : bounds of outputs, or regimes, whose probability is computed
        quantiles : shares of parts; the result has the values they stay below
    Numerics
        samples, seed : number of samples, a power of two, and their random seed
        variant, method : closed forms by variant, or motion in time by method
        drive : a recording of an accelerometer
        part : a part from a file, in place of its shape
        verify : number of points to evaluate again

    Returns
    -------
    xarray.Dataset
        The results of each output, in SI, with errors, and `regime` of the nominal
        values. Along `uncertain` are the parameters, in the order of
        `flag_meanings`. Problems raise `StudyError` with all of them.

    Examples
    --------
    >>> told = vibrafeed.sensitivity(
    ...     "rectangle-on-plane", outputs="acceleration_x", frequency="50 Hz",
    ...     amplitude="0.1 mm", beta=30,
    ...     uncertain={"friction": {"mean": 0.3, "deviation": 0.03}},
    ...     demands=[{"output": "acceleration_x", "at_least": "7 m/s^2"}],
    ... )
    >>> 0 < float(told.probability_acceleration_x_at_least) < 1
    True
    """
    return _carry_out(_prepared("sensitivity", locals()))


def calibrate(
    scene: SceneName | StudyLike | None = None, /, *,
    observations: str | Sequence[Mapping[str, Any]] | None = None, error: float | str | None = None,
    unknowns: Maps | None = None, offsets: Maps | None = None, factors: Maps | None = None,
    candidates: Mapping[str, Values] | None = None, discrepancy: bool | None = None,
    likelihood: str | None = None, outlier_probability: float | None = None,
    points: int | None = None, method: str | None = None,
    drive: Mapping[str, Any] | None = None, tolerance: float | None = None,
    max_periods: int | None = None, verify: int | None = None, **parameters: Unpack[Keywords],
) -> xarray.Dataset:  # fmt: skip
    """Return the estimates of unknown parameters from measured speeds or amplitudes.

    Parameters
    ----------
    scene : str, Study, mapping or path
        The name of a scene, or a study that the keywords change.
    **parameters
        Those common to all runs; `vibrafeed.scene` and `help(vibrafeed)` say more.

    Measurements (docs/friction.md)
        observations : the runs, as mappings, or the name of a CSV or XLSX file
        error : standard deviation of what was measured: number, text or "5 %"
        unknowns : `{"friction": {"lower": 0.1, "upper": 0.6}}`, or mean, deviation
        offsets, factors : unknown offsets and factors of parameters, alike
        candidates : drives that could be run next: which of them adds most
        discrepancy : True if speeds may scatter by more than their errors
        likelihood : "normal", or "student_t" for errors of which a few are large
        outlier_probability, points : of wrong regimes; most points of the unknowns
    As in `simulate` : method, drive, tolerance, max_periods, verify

    Returns
    -------
    xarray.Dataset
        `best_friction`, `lower_95_friction` and so on, the posterior `log_density`;
        `findings` tells it in words. Problems raise `StudyError` with all of them.

    Examples
    --------
    >>> told = vibrafeed.calibrate(
    ...     "rectangle-on-plane", frequency="50 Hz", beta=20, error="1 mm/s",
    ...     observations=[{"amplitude": "0.2 mm", "conveying_velocity": "13 mm/s"}],
    ...     unknowns={"friction": {"lower": 0.1, "upper": 0.6}},
    ... )
    >>> told.lower_95_friction.item() < 0.3 < told.upper_95_friction.item()
    True
    """
    return _carry_out(_prepared("calibrate", locals()))


def open_lazily(scene: SceneName | StudyLike | None = None, /, **keywords: Any) -> xarray.Dataset:
    """Return the dataset of a sweep or simulation of any size, computed where it is read.

    Its variables are dask arrays over their own axes: ``.sel``, ``.max("beta")``, ``.to_zarr`` and
    all else that xarray does is computed block by block.

    Parameters
    ----------
    scene : str, Study, mapping or path
        Name of the scene; or a study that the keywords change. A scene alone is a sweep; give
        ``kind="simulate"`` for motion.
    **keywords
        Those of `sweep`, or of `simulate`.

    Returns
    -------
    xarray.Dataset
        What `sweep` or `simulate` returns, without a value yet.

    Raises
    ------
    StudyError
        With every problem.

    Examples
    --------
    >>> lazy = vibrafeed.open_lazily(
    ...     "rectangle-on-plane", outputs=["acceleration_x"], frequency="50 Hz",
    ...     amplitude={"start": "0.1 mm", "stop": "1 mm", "num": 100_000},
    ...     beta={"start": 0, "stop": 40, "num": 100_000}, friction=0.5,
    ... )
    >>> f"{lazy.acceleration_x.size:,}"
    '10,000,000,000'
    >>> lazy.acceleration_x[99_999, 0].values > lazy.acceleration_x[0, 0].values
    np.True_
    """
    prepared = _prepared(None, locals())
    _import_accessor()
    return import_module("vibrafeed.core.kinds").open_lazily(prepared)


def drive_error(
    scene: SceneName | StudyLike | None = None, /, *, draws: int = 200, seed: int = 0,
    **keywords: Any,
) -> DriveError:  # fmt: skip
    """Return the error of a part's conveying velocity by the errors of a measured drive.

    The part is followed under drives that fit the recording as well as the fitted
    one. Errors of friction and other parameters, of the model and of the sensor's
    scale are not among them.

    Parameters
    ----------
    scene : str, mapping or path
        A study of `simulate`, of one cell, whose `drive` names a recording.
    draws : int
        Number of such drives.
    seed : int
        Seed of the random numbers; equal ones give equal results.
    **keywords
        Those of `simulate`.

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
    found = intake.gather(scene, keywords, "simulate")
    asked, fit = intake.study_and_fit(found if isinstance(found, dict) else found.content())
    return drive_error(asked, fit, draws, np.random.default_rng(seed))


def plot(
    dataset: xarray.Dataset | str | os.PathLike[str] | Sequence[Any], *,
    variable: str | None = None, axes: str | tuple[str, ...] | None = None,
    at: Mapping[str, float | str] | None = None, kind: str | None = None, title: str | None = None,
    units: Named | None = None, nearest: bool = False, dark: bool = False, small: bool = False,
) -> Figure:  # fmt: skip
    """Return the picture of an output with its regimes, of regimes alone, or of one motion.

    It needs matplotlib, of the extra `plot`. A notebook shows the figure; its method
    `savefig` writes it.

    Parameters
    ----------
    dataset : xarray.Dataset or path, or a list of them
        What `sweep`, `simulate` or `optimise` returned, or a file of `vibrafeed run`. Of
        several, the same output is drawn over the same axis.
    variable : str, optional
        The output; the first if left out.
    axes : str or tuple of str, optional
        One or two dimensions, the first across; the longest if left out.
    at : mapping, optional
        Values of other dimensions, numbers in the unit of the dataset or text with a
        unit; the middle one if left out.
    kind : str, optional
        The name of a picture: posterior, distribution, indices, tornado, front,
        positions, trajectory, animation, landscape, bodies, aspects, field, line, map, contour
        or levels; the first that fits if left out.
    title : str, optional
        The name of the picture; that of what it shows if left out.
    units : str or sequence of str, optional
        `trade` (mm, mm/s), `si` or units such as m/min; those of the study if left out.
    nearest : bool
        True if the nearest value stands for one of `at` that is not in the dataset.
    dark, small : bool
        Light colours on a dark background; for a column of some 11 cm.

    Raises
    ------
    VibrafeedError
        If the dataset does not hold what is asked for.

    Examples
    --------
    >>> dataset = vibrafeed.sweep(
    ...     "rectangle-on-plane", outputs=["acceleration_x"], frequency="50 Hz",
    ...     amplitude="0.25 mm", beta=range(0, 41, 5), friction=[0.3, 0.5],
    ... )
    >>> figure = vibrafeed.plot(dataset, axes="beta", at={"friction": 0.5})
    >>> figure.get_suptitle()
    'Acceleration along the track'
    """
    drawing = import_module("vibrafeed.core.plots.drawing")
    return drawing.draw(
        _opened(dataset), variable=variable, axes=(axes,) if isinstance(axes, str) else axes,
        at=drawing.read_fixed(at or {}), kind=kind, title=title, units=units, nearest=nearest,
        dark=dark, small=small,
    )  # fmt: skip


def _opened(source: Any) -> Any:
    """Return the datasets to be drawn: paths are read as files, lists entry by entry."""
    if isinstance(source, str | os.PathLike):
        return import_module("vibrafeed.core.plots.drawing").read(source)
    return [_opened(one) for one in source] if isinstance(source, list | tuple) else source


def animate(
    dataset: xarray.Dataset | str | os.PathLike[str], file: str | os.PathLike[str], *,
    slow: float | None = None, title: str | None = None, units: Named | None = None,
    dark: bool = False, small: bool = False,
) -> None:  # fmt: skip
    """Write the motion of one part as an animation, a GIF file.

    It needs matplotlib and pillow, of the extra `plot`.

    Parameters
    ----------
    dataset : xarray.Dataset or path
        A simulation of one part with `trajectory`, or the file of one.
    file : path
        The file; an existing one is replaced.
    slow : float
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

    from vibrafeed.core.plots.animation import animate

    animate(
        _opened(dataset), Path(file), slow=slow, title=title, units=units, dark=dark, small=small
    )


def scene(
    name: SceneName | str, variant: str | None = None, *, method: str | None = None
) -> SceneCard:
    """Return the card of a scene: parameters, outputs, units, bounds, equations, validity.

    Python prints it as text, a notebook as tables.

    Parameters
    ----------
    name : str
        Name of the scene, one of `scenes()`.
    variant : str, optional
        Variant of its closed forms; the scene's default if left out.
    method : str, optional
        A method of simulation: the card is then that of the motion in time.

    Raises
    ------
    StudyError
        If there is no such scene, variant or method.

    Examples
    --------
    >>> card = vibrafeed.scene("rectangle-on-plane", method="events")
    >>> card.parameters["frequency"]["description"]
    'Frequency of the drive.'
    >>> card.outputs["conveying_velocity"]["unit"]
    'm s-1'
    """
    from vibrafeed.core.catalogue import SceneCard  # loads the catalogue

    return SceneCard(scenes(name, variant, method=method))


def scenes(
    name: str | None = None, variant: str | None = None, *, method: str | None = None
) -> Any:
    """Return the catalogue as plain values: a list of all scenes, or a dict about one.

    Parameters are those of `scene`, which shows the same for reading.

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
    one = name is not None
    return catalogue.describe(name, variant, method=method) if one else catalogue.describe_all()


def _prepared(kind: str | None, arguments: dict[str, Any]) -> Any:
    """Return a study of one kind, ready to be computed; warn of unusual values.

    Without a kind it is the one that the study names, or a sweep.

    `arguments` are the `locals()` of a public function: `scene`, keywords, and a mapping of more.
    """
    more = arguments.pop("parameters", arguments.pop("keywords", {}))
    base = arguments.pop("scene")
    given = {name: value for name, value in (arguments | more).items() if value is not None}
    intake = import_module("vibrafeed.core.intake")
    content = intake.gather(base, given, kind)
    if not isinstance(content, dict):
        return import_module("vibrafeed.core.kinds").prepare(content)
    prepared = intake.prepare_content({"kind": "sweep", **content}, files=True)
    for question in prepared.questions:
        warnings.warn(question, stacklevel=CALLER)
    return prepared


def _carry_out(prepared: Any) -> xarray.Dataset:
    """Compute a prepared study and return its dataset.

    Raises `LimitError` if the result exceeds this machine's memory.
    """
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


def _import_accessor() -> None:
    """Give datasets their `.vibrafeed`."""
    from vibrafeed import accessor  # noqa: F401 - loads xarray
