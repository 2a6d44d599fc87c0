"""The kinds of study, and what carries each of them out."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np

from core import calibrate, motion, optimise, sensitivity, sweep
from core.dataset.table import Table
from core.errors import Problem, StudyError
from core.motion.systems import SYSTEMS
from core.plan.pieces import Computed, carry_out
from core.plan.plan import scene_parameters
from core.plan.posteriors import with_posteriors
from core.plan.prepared import Prepared
from core.plan.sample import FAILED, LEFT_OUT
from core.quantities import FLAGS
from core.scenes import SCENES, Scene
from core.study.drive import names_recording
from core.study.grid_study import PARAMETERS
from core.study.load import parse_study, read_content
from core.study.models import Study
from core.study.simulate_study import SimulateStudy
from core.watch import Watch

if TYPE_CHECKING:
    from core.measured import Fit


@dataclass(frozen=True)
class Kind:
    """How studies of one kind are checked and carried out.

    Attributes
    ----------
    prepare : callable
        Takes a study; returns it ready to be carried out, or raises `StudyError` with every
        problem.
    further : callable
        Takes the content of a file or request that is no sound study, and the error that says so;
        returns what a plan would object to besides, as far as it can be told.
    compute : callable
        Takes what `prepare` returns and a `Watch`; returns what was `Computed`.
    label : callable
        Takes what `prepare` returns, what was computed, and a `Watch` that may stop verifying;
        returns the `Table` of results.
    """

    prepare: Callable[[Any], Prepared]
    further: Callable[[Mapping[str, Any], StudyError], list[Problem]]
    compute: Callable[[Any, Watch], Computed]
    label: Callable[[Any, Computed, Watch], Table]


KINDS: dict[str, Kind] = {
    "sweep": Kind(sweep.prepare, sweep.further, sweep.compute, sweep.label),
    "simulate": Kind(motion.prepare, motion.further, motion.compute, motion.label),
    "optimise": Kind(optimise.prepare, optimise.further, optimise.compute, optimise.label),
    "sensitivity": Kind(
        sensitivity.prepare, sensitivity.further, sensitivity.compute, sensitivity.label
    ),
    "calibrate": Kind(calibrate.prepare, calibrate.further, calibrate.compute, calibrate.label),
}
"""Every kind of study, by the value of its key `kind`."""


PLACES: Mapping[str, tuple[Mapping[str, Scene], ...]] = {
    "sweep": (SCENES,),
    "simulate": (SYSTEMS,),
    "optimise": (SCENES, SYSTEMS),
    "sensitivity": (SCENES, SYSTEMS),
    "calibrate": (SYSTEMS,),
}
"""Where the scenes of each kind of study are found."""

STATUSES = {
    name: flags["not_computed"].value for name, flags in FLAGS.items() if "not_computed" in flags
}
"""Variables that tell of each cell whether it was computed, and their value where it was not."""


def load_study(path: str | os.PathLike[str]) -> Study:
    """Return the study in the TOML or JSON file at `path`; its recording, if any, is fitted.

    Raises
    ------
    StudyError
        With every problem of the file.
    """
    return study_of(read_content(Path(path)))


def study_of(content: object) -> Study:
    """Return the study that a mapping describes; its recording, if any, is fitted.

    Raises
    ------
    StudyError
        With every problem.
    """
    return _parsed(*_fitted(content, files=True)[:2])


def study_and_fit(content: object) -> tuple[SimulateStudy, Fit]:
    """Return a study of motion, and the fit of the recording that it names.

    Raises
    ------
    StudyError
        With every problem, also if it names no recording.
    """
    content, problems, fit = _fitted(content, files=True)
    if fit is None and not problems:
        fix = "Give the file of a study, or a mapping, whose drive has file or data"
        problems.append(Problem("drive", "it names no recording that can be fitted", fix))
    study = _parsed(content, problems)
    assert fit is not None
    assert isinstance(study, SimulateStudy)
    return study, fit


def _parsed(content: object, problems: list[Problem]) -> Study:
    """Return the study of some content; raise if there is a problem in it, or another one."""
    try:
        study = parse_study(content, lambda: _parameters_of(content))
    except StudyError as error:
        raise StudyError([*error.problems, *problems]) from None
    if problems:
        raise StudyError(problems)
    return study


def _fitted(content: object, *, files: bool) -> tuple[object, list[Problem], Fit | None]:
    """Return content with the numbers of the files it names, what is wrong, and a drive's fit.

    Content whose recording is no sound one has no drive. Observations of a file stand in it.
    """
    content, problems = with_posteriors(content, files=files)
    content, unread = _with_observations(content, files=files)
    problems += unread
    if not (isinstance(content, Mapping) and names_recording(content)):
        return content, problems, None
    from core.measured.study import with_drive  # few studies need its libraries

    try:
        content, fit = with_drive(content, files=files)
    except StudyError as error:
        without = {name: value for name, value in content.items() if name != "drive"}
        return without, [*problems, *error.problems], None
    return content, problems, fit


def _with_observations(content: object, *, files: bool) -> tuple[object, list[Problem]]:
    """Return content with the rows of the file that it names, and what is wrong with that."""
    if not (isinstance(content, Mapping) and isinstance(content.get("observations"), str)):
        return content, []
    from core.study.observed_file import with_rows  # few studies need it

    try:
        return with_rows(content, files=files), []
    except StudyError as error:
        return {**content, "observations": [{"regime": "hops"}]}, list(error.problems)


@overload
def prepare_content(
    content: object, only: Literal["sweep"], *, files: bool = False
) -> sweep.Sweep: ...
@overload
def prepare_content(
    content: object, only: str | None = None, *, files: bool = False
) -> Prepared: ...
def prepare_content(content: object, only: str | None = None, *, files: bool = False) -> Prepared:
    """Return the study that the content of a file or request describes, ready to be carried out.

    `only` is the one kind that is wanted; by default any will do. `files` lets it name files of
    this machine: never what comes over the network.

    Raises
    ------
    StudyError
        With every problem, those of single values and those of the study as a whole.
    """
    named = content.get("kind") if isinstance(content, Mapping) else None
    kind = KINDS.get(named) if isinstance(named, str) else None
    problems: list[Problem] = []
    if only is not None and kind is not None and named != only:
        problems = [
            Problem(
                "kind", f"'{named}' is not the kind that is wanted here", f"Set kind = '{only}'"
            )
        ]
    content, unsound, _ = _fitted(content, files=files)
    problems += unsound
    try:
        study = parse_study(content, lambda: _parameters_of(content))
    except StudyError as error:
        # Without the numbers of the drive a plan would miss what is not missing.
        if kind is not None and isinstance(content, Mapping) and not unsound:
            problems += kind.further(content, error)
        raise StudyError([*error.problems, *problems]) from None
    if problems:
        raise StudyError(problems)
    prepared = prepare(study)
    if only is not None and isinstance(prepared, sweep.ReducedSweep):
        raise StudyError([sweep.no_cells("Leave it out, or POST to /processes/sweep/execution")])
    if only is not None and isinstance(prepared, sweep.DerivedSweep):
        raise StudyError([sweep.as_a_whole("Leave it out, or POST to /processes/sweep/execution")])
    return prepared


def _parameters_of(content: object) -> Collection[str]:
    """Return the parameters of the scene that a study names, or all that there are."""
    content = content if isinstance(content, Mapping) else {}
    found: set[str] = set()
    for scenes in PLACES.get(str(content.get("kind"))[:60], ()):
        scene = scenes.get(str(content.get("scene"))[:100])
        if scene is not None:
            named = str(content.get(scene.choice))[:100]
            chosen = named if named in scene.variants else scene.default_variant
            found |= {*scene_parameters(scene, chosen)}
    return found or PARAMETERS


def prepare(study: Study) -> Prepared:
    """Return a study, ready to be carried out; raise `StudyError` with every problem."""
    return KINDS[study.kind].prepare(study)


def tabulate(prepared: Prepared, watch: Watch | None = None) -> Table:
    """Return the labelled results of a prepared study."""
    kind = KINDS[prepared.study.kind]
    return carry_out(prepared, kind.compute, kind.label, watch)


def share_left_out(table: Table) -> float:
    """Return the share of the cells of a result that a stop left without computing."""
    shares = (
        np.mean(table.variables[name].values == value)
        for name, value in STATUSES.items()
        if name in table.variables
    )
    return float(next(shares, 0.0))


def not_verified(table: Table) -> int:
    """Return how many cells of a result are further off than what is known of their error."""
    return int(table.attributes.get(FAILED, 0))


def is_whole(table: Table) -> bool:
    """Return whether no stop left a cell of a result without computing or verifying it."""
    return not share_left_out(table) and LEFT_OUT not in table.attributes
