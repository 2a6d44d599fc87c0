"""Studies from files, requests and programs, with every problem of them at once."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from vibrafeed.core.errors import Problem
from vibrafeed.core.intake.draft import Draft
from vibrafeed.core.intake.text import read_content, read_json, read_toml
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.study.grid_study import Study

if TYPE_CHECKING:
    from vibrafeed.core.measured.drive import Fit
    from vibrafeed.core.study.simulate_study import SimulateStudy

CALLER = 3
"""Calls from a warning to who called a function of `vibrafeed` that reads a study here."""


def load_study(path: str | os.PathLike[str]) -> Study:
    """Return the study in a TOML or JSON file; a named recording is fitted.

    Raises
    ------
    StudyError
        With every problem of the file.

    Examples
    --------
    >>> import vibrafeed
    >>> study = vibrafeed.load_study("configs/figures/fig-5-1.toml")
    >>> study.kind, study.scene
    ('sweep', 'cylinder-on-plane')
    """
    return study_of(read_content(Path(path)))


def study_of(content: object) -> Study:
    """Return the study that a mapping describes, with the content of the files that it names.

    Warns of values that are allowed and unusual.

    Raises
    ------
    StudyError
        With every problem.
    """
    draft = Draft(content).resolve(files=True)
    study = draft.check()
    for question in draft.questions:
        warnings.warn(question, stacklevel=CALLER)
    return study


def parse_study(content: object) -> Study:
    """Return the study that a mapping describes; raise `StudyError` with every problem of it.

    A study that names files is refused: this is for content from the network.
    """
    return Draft(content).check()


def parse_toml(text: str) -> Study:
    """Return the study in a TOML text; raise `StudyError` with every problem of it."""
    return parse_study(read_toml(text))


def parse_json(text: str | bytes) -> Study:
    """Return the study in a JSON text; raise `StudyError` with every problem of it."""
    return parse_study(read_json(text))


def study_and_fit(content: object) -> tuple[SimulateStudy, Fit]:
    """Return a study of motion, and the fit of the recording from which its drive comes.

    `content` holds the keys and values of the study; files of this machine are read.

    Raises
    ------
    StudyError
        With every problem, also if the study names no recording.
    """
    draft = Draft(content).resolve(files=True)
    if draft.fit is None and not draft.problems:
        fix = "Give the file of a study, or a mapping, whose drive has file or data"
        draft.problems += [
            Problem("drive", "the drive of this study names no recording to fit", fix)
        ]
    study: SimulateStudy = draft.check()  # type: ignore[assignment] # whose kind is given
    for question in draft.questions:
        warnings.warn(question, stacklevel=CALLER)
    assert draft.fit is not None  # else there is a problem
    return study, draft.fit


def prepare_content(content: object, only: str | None = None, *, files: bool = False) -> Prepared:
    """Return the prepared study that the content of a file or request describes.

    `content` holds the keys and values. `only` is the one accepted kind, whose cells are to be read
    one by one; by default every kind is accepted. `files` is True if files of this machine may be
    read, which no study from the network may ask for.

    Raises
    ------
    StudyError
        With every problem, those of single values and those of the study as a whole.
    """
    named = content.get("kind") if isinstance(content, Mapping) else None
    draft = Draft(content)
    if only is not None and draft.kind is not None and named != only:
        message = f"'{named}' is not the kind that is wanted here"
        draft.problems.append(Problem("kind", message, f"Set kind = '{only}'"))
    prepared = draft.resolve(files=files).prepare()
    if only is not None:
        prepared.check_lazy(f"Leave it out, or POST to /processes/{only}/execution")
    return prepared
