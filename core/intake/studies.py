"""A study on its way in: read, files resolved, sections checked, planned."""

import os
import re
import warnings
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.intake.forms import read_content, read_json, read_toml
from vibrafeed.core.intake.section import (
    Resolved,
    Stranger,
    channel_questions,
    problems_of,
    tilt_questions,
)
from vibrafeed.core.intake.sections import SECTIONS, in_letters, paired, words_in
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.plan.pieces import Sketch
from vibrafeed.core.plan.plan import plan_scene, scene_parameters
from vibrafeed.core.plan.prepared import Prepared, names_intended
from vibrafeed.core.quantities import WORD_OF
from vibrafeed.core.study.grid_study import MAX_OUTPUTS, PARAMETERS, Study
from vibrafeed.core.study.unusual import questions
from vibrafeed.core.suggestions import nearest

if TYPE_CHECKING:
    from vibrafeed.core.measured.fit import Fit
    from vibrafeed.core.plan.pieces import Kind
    from vibrafeed.core.study.sweep_and_simulate import SimulateStudy


_LETTER = re.compile(rf"\b(?:{'|'.join(WORD_OF)})\b")


@dataclass
class Draft:
    """A study on its way in: content that is resolved, checked and prepared.

    The words for angles in it become letters; messages say what the user wrote.

    Attributes
    ----------
    content : object
        Of the file or request; after `resolve` with the numbers of files in it.
    problems : list of Problem
        Those of the files that the study names.
    unread : set of str
        Sections whose files could not be read: no further problem of them is reported.
    fit : Fit or None
        Of the recording, if the study names one.
    words : dict of str to str
        The words that the study has for angles, by their letters.
    """

    content: Any
    problems: list[Problem] = field(init=False)
    unread: set[str] = field(default_factory=set)
    fit: "Fit | None" = None
    words: dict[str, str] = field(init=False)

    def __post_init__(self) -> None:
        """Put letters for words; note each angle given by both as a problem."""
        self.words = words_in(self.content)
        lettered, self.problems = in_letters(self.content)
        self.content, problems = paired(lettered)
        self.problems += problems

    @property
    def kind(self) -> "Kind | None":
        """The kind of the study; None if the content names no known kind."""
        name = self.content.get("kind") if isinstance(self.content, Mapping) else None
        return KINDS[name] if isinstance(name, str) and name in KINDS else None

    @property
    def questions(self) -> tuple[str, ...]:
        """Questions about values that are allowed and unusual, those of files as those typed."""
        return tuple(
            map(
                self._in_words,
                (
                    *questions(self.content),
                    *channel_questions(self.fit),
                    *tilt_questions(self.fit, self.content),
                ),
            )
        )

    def resolve(self, *, files: bool) -> "Draft":
        """Put the numbers in files for their names, if they may be read; return this draft."""
        keys = _keys_of(self.kind) if self.kind else SECTIONS
        for key, section in SECTIONS.items():
            is_given = isinstance(self.content, Mapping) and key in self.content and key in keys
            if is_given and section.resolve is not None:
                try:
                    resolved = section.resolve(self.content, files)
                except StudyError as error:
                    others = {name: value for name, value in self.content.items() if name != key}
                    resolved = Resolved(others, error.problems)
                self.content = resolved.content
                self.problems += resolved.problems
                self.fit = resolved.fit or self.fit
                if key not in self.content:
                    self.unread.add(key)
        return self

    def check(self) -> Study:
        """Return the valid study; raise `StudyError` with all problems of values, keys and files.

        Without a known kind, the values are checked by the kind that was probably intended.
        """
        if not isinstance(self.content, Mapping):
            raise StudyError(
                [
                    Problem(
                        "study",
                        "the study is not a table of keys and values, in JSON an object",
                        "Give keys with values, such as kind, scene and outputs",
                    ),
                    *self.problems,
                ]
            )
        kind, problems = self.kind, list[Problem]()
        if kind is None:
            problem, kind = _no_kind(self.content)
            problems = [problem]
        study, value_problems = self._validated(kind, {**self.content, "kind": kind.name})
        problems += [*value_problems, *self.problems]
        if study is None or problems:
            raise self._error(problems)
        return study

    def prepare(self) -> Prepared:
        """Return the study of this draft, checked and planned, ready to be computed.

        Raises `StudyError` with every problem at once: if the check fails, also those that planning
        the readable rest would report, unless a file of the study cannot be read.
        """
        try:
            study = self.check()
        except StudyError as error:
            # With an unread file, planning would report its numbers as missing.
            further = [] if self.problems else self._problems_of_plan(error)
            raise self._error([*error.problems, *further]) from None
        try:
            prepared = KINDS[study.kind].prepare(study)
        except StudyError as error:
            raise self._error(error.problems) from None
        plan_questions = (*prepared.questions, *prepared.unused)
        return replace(prepared, questions=(*self.questions, *map(self._in_words, plan_questions)))

    def _error(self, problems: Iterable[Problem]) -> StudyError:
        in_words = self._in_words
        return StudyError(
            replace(
                problem,
                place=in_words(problem.place),
                message=in_words(problem.message),
                fix=in_words(problem.fix),
            )
            for problem in problems
        )

    def _in_words(self, text: str) -> str:
        return _LETTER.sub(lambda match: self.words.get(match[0], match[0]), text)

    def _validated(
        self, kind: "Kind", content: Mapping[str, Any]
    ) -> tuple[Study | None, list[Problem]]:
        keys = _keys_of(kind)

        def unknown(stranger: Stranger) -> Problem:
            name, section = stranger.name, SECTIONS.get(stranger.name)
            if section is not None and section.absent is not None:
                return section.absent(stranger)
            return Problem(
                stranger.place,
                f"'{name}' is not a key of a study of kind '{kind.name}'",
                stranger.suggest(name, keys),
            )

        try:
            return kind.model.model_validate(content), []
        except ValidationError as error:
            return None, [
                problem
                for problem in problems_of(error, SECTIONS, unknown, keys, self._parameters())
                if problem.place not in self.unread
            ]

    def _parameters(self) -> Collection[str]:
        names: set[str] = set()
        for scenes in self.kind.scenes if self.kind else ():
            scene = scenes.get(str(self.content.get("scene"))[:100])
            if scene is not None:
                variant = str(self.content.get(scene.choice))[:100]
                names |= {
                    *scene_parameters(
                        scene, variant if variant in scene.variants else scene.default_variant
                    )
                }
        return names or PARAMETERS

    def _problems_of_plan(self, check_error: StudyError) -> list[Problem]:
        kind = self.kind
        if kind is None or not isinstance(self.content.get("parameters"), Mapping):
            return []
        drive = self.content.get("drive")
        if isinstance(drive, Mapping) and "samples" in drive:
            return []  # a recording that is followed once is no matter of names
        sections = {key: section for key, section in SECTIONS.items() if key in _keys_of(kind)}
        outputs = [*self._outputs(kind)]
        scene, problems = self.content.get("scene"), list[Problem]()
        if not isinstance(scene, str) or not all(isinstance(name, str) for name in outputs):
            return []
        choices = (self.content.get(key) for key in ("variant", "method"))
        variant, method = (text if isinstance(text, str) else None for text in choices)

        def names_written(parameters: Collection[str]) -> list[str]:
            names_by_section = (
                section.names(self.content.get(key), parameters)
                for key, section in sections.items()
            )
            return [str(name) for names in names_by_section for name in names]

        def names(parameters: Collection[str]) -> list[str]:
            return [*dict.fromkeys(names_intended(names_written(parameters)))]

        try:
            chosen, variant, problems = kind.choose(
                Sketch(scene, variant, method, outputs, names(()))
            )
            plan_scene(
                chosen, variant, outputs[:MAX_OUTPUTS], names(scene_parameters(chosen, variant))
            )
        except StudyError as error:
            problems = [*problems, *error.problems]
        reported_places = [problem.place for problem in check_error.problems]
        # A corrected name is not in the study itself: the plan's problems with it are left out.
        reported_places += map("parameters.{}".format, {*names(())} - {*names_written(())})
        return [problem for problem in problems if problem.place not in reported_places]

    def _outputs(self, kind: "Kind") -> Iterable[Any]:
        keys = _keys_of(kind)
        if "outputs" in keys and "outputs" not in self.content:
            default = kind.model.model_fields["outputs"].get_default()
            yield from default if isinstance(default, tuple) else ()
        for key, section in SECTIONS.items():
            if key in keys:
                yield from section.outputs(self.content.get(key))


def _keys_of(kind: "Kind") -> Collection[str]:
    return tuple(kind.model.model_fields)


def _no_kind(content: Mapping[str, Any]) -> "tuple[Problem, Kind]":
    # The problem with the kind, and the kind that was probably meant: it shares most keys.
    kind = content.get("kind")
    is_missing = kind is None
    similar = None if is_missing else nearest(str(kind), KINDS)
    problem = Problem(
        "kind",
        "it is missing" if is_missing else f"{str(kind)[:60]!r} is not a kind of study",
        "Write kind = " + " or ".join(f'"{name}"' for name in ([similar] if similar else KINDS)),
    )
    shared_keys = {name: len(set(_keys_of(kind_)) & set(content)) for name, kind_ in KINDS.items()}
    return problem, KINDS[similar or max(KINDS, key=lambda name: shared_keys[name])]


# --- Studies from files, requests and programs, with every problem of them at once.


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


def study_and_fit(content: object) -> "tuple[SimulateStudy, Fit]":
    """Return a study of motion, and the fit of the recording from which its drive comes.

    `content` holds the keys and values of the study; files of this machine are read.

    Raises
    ------
    StudyError
        With every problem, also if the study names no recording.
    """
    draft = Draft(content).resolve(files=True)
    if draft.fit is None and not draft.problems:
        draft.problems += [
            Problem(
                "drive",
                "the study has no drive from a recording",
                "Give file or data in the section drive of the study",
            )
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
    kind = content.get("kind") if isinstance(content, Mapping) else None
    draft = Draft(content)
    if only is not None and draft.kind is not None and kind != only:
        draft.problems.append(
            Problem(
                "kind",
                f"a study of kind '{only}' is needed here, not '{kind}'",
                f"Set kind = '{only}'",
            )
        )
    prepared = draft.resolve(files=files).prepare()
    if only is not None:
        prepared.check_lazy(f"Leave it out, or POST to /processes/{only}/execution")
    return prepared
