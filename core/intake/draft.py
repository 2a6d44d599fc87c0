"""A study on its way in: read, files resolved, sections checked, planned."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.intake.messages import problems_of
from vibrafeed.core.intake.recorded import channel_questions, tilt_questions
from vibrafeed.core.intake.section import Stranger
from vibrafeed.core.intake.sections import SECTIONS, in_letters, words_in
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.plan.kind import Sketch
from vibrafeed.core.plan.plan import plan_scene, scene_parameters
from vibrafeed.core.plan.prepared import Prepared, names_intended
from vibrafeed.core.quantities import WORD_OF
from vibrafeed.core.study.grid_study import MAX_OUTPUTS, PARAMETERS, Study
from vibrafeed.core.study.unusual import questions
from vibrafeed.core.suggestions import nearest

if TYPE_CHECKING:
    from vibrafeed.core.measured.drive import Fit
    from vibrafeed.core.plan.kind import Kind


_LETTER = re.compile(rf"\b(?:{'|'.join(WORD_OF)})\b")


@dataclass
class Draft:
    """A study on its way in: content that is resolved, checked and prepared.

    The words for angles in it become letters; messages say what the user wrote.

    Attributes
    ----------
    content : object
        Content of the file or request; after `resolve` with the numbers of files in it.
    problems : list of Problem
        Problems of the files that the study names.
    unread : set of str
        Sections whose files could not be read: no further problem of them is reported.
    fit : Fit or None
        Fit of the recording, if the study names one.
    words : dict of str to str
        The words that the study has for angles, by their letters.
    """

    content: Any
    problems: list[Problem] = field(init=False)
    unread: set[str] = field(default_factory=set)
    fit: Fit | None = None
    words: dict[str, str] = field(init=False)

    def __post_init__(self) -> None:
        """Put letters for words; note each angle given by both as a problem."""
        self.words = words_in(self.content)
        self.content, self.problems = in_letters(self.content)

    @property
    def kind(self) -> Kind | None:
        """The kind of the study; None if the content names no known kind."""
        name = self.content.get("kind") if isinstance(self.content, Mapping) else None
        return KINDS[name] if isinstance(name, str) and name in KINDS else None

    @property
    def questions(self) -> tuple[str, ...]:
        """Questions about values that are allowed and unusual, those of files as those typed."""
        asked = (
            *questions(self.content),
            *channel_questions(self.fit),
            *tilt_questions(self.fit, self.content),
        )
        return tuple(map(self._in_words, asked))

    def resolve(self, *, files: bool) -> Draft:
        """Return this draft of a study with file names replaced by the numbers in the files.

        `files` is True if files of this machine may be read, which a study from the network may not
        ask for. Changes the draft, and adds the problems found.
        """
        keys = _keys_of(self.kind) if self.kind else SECTIONS
        for key, section in SECTIONS.items():
            there = isinstance(self.content, Mapping) and key in self.content and key in keys
            if there and section.resolve is not None:
                self.content, problems, fit = section.resolve(self.content, files)
                self.problems += problems
                self.fit = fit or self.fit
                if key not in self.content:
                    self.unread.add(key)
        return self

    def check(self) -> Study:
        """Return the validated study of this draft, of the model of its kind.

        Raises `StudyError` with all problems of values, keys and files. Without a known kind, the
        values are checked by the kind that was probably intended.
        """
        if not isinstance(self.content, Mapping):
            fix = "Write keys with values: kind, scene, outputs, ..."
            raise StudyError(
                [
                    Problem("study", "the study is not an object with keys and values", fix),
                    *self.problems,
                ]
            )
        if self.kind is None:
            problem, likely = _no_kind(self.content)
            content = {**self.content, "kind": likely.name}
            _, found = self._validated(likely, content)
            raise self._error([problem, *found, *self.problems])
        study, problems = self._validated(self.kind, self.content)
        problems += self.problems
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
            # Without the numbers of files a plan would miss what is not missing.
            further = [] if self.problems else self._objections(error)
            raise self._error([*error.problems, *further]) from None
        try:
            prepared = KINDS[study.kind].prepare(study)
        except StudyError as error:
            raise self._error(error.problems) from None
        asked = map(self._in_words, prepared.questions)
        return replace(prepared, questions=(*self.questions, *asked))

    def _error(self, problems: Iterable[Problem]) -> StudyError:
        """Return the error with problems of this study, which name angles as the user did."""
        said = self._in_words
        return StudyError(
            replace(one, place=said(one.place), message=said(one.message), fix=said(one.fix))
            for one in problems
        )

    def _in_words(self, text: str) -> str:
        """Return a message with the words that the study has for angles in place of letters."""
        return _LETTER.sub(lambda found: self.words.get(found[0], found[0]), text)

    def _validated(
        self, kind: Kind, content: Mapping[str, Any]
    ) -> tuple[Study | None, list[Problem]]:
        """Return the study if its content is valid, else None, and the problems of its content.

        `kind` is the kind of study whose model checks the `content`. Problems of keys that could
        not be read are left out, as they are known.
        """
        keys = _keys_of(kind)

        def unknown(stranger: Stranger) -> Problem:
            """Return the problem of an unknown key at the top level of the study."""
            name, section = stranger.name, SECTIONS.get(stranger.name)
            if section is not None and section.absent is not None:
                return section.absent(stranger)
            message = f"'{name}' is not a key of kind '{kind.name}'"
            return Problem(stranger.place, message, stranger.suggest(name, keys))

        try:
            return kind.model.model_validate(content), []
        except ValidationError as error:
            problems = problems_of(error, SECTIONS, unknown, keys, self._parameters())
            return None, [one for one in problems if one.place not in self.unread]

    def _parameters(self) -> Collection[str]:
        """Return the names of the parameters of the scene that the study names, for suggestions.

        A misspelt parameter is compared with them. They are all parameters of all scenes if the
        scene is unknown.
        """
        names: set[str] = set()
        for scenes in self.kind.scenes if self.kind else ():
            scene = scenes.get(str(self.content.get("scene"))[:100])
            if scene is not None:
                named = str(self.content.get(scene.choice))[:100]
                chosen = named if named in scene.variants else scene.default_variant
                names |= {*scene_parameters(scene, chosen)}
        return names or PARAMETERS

    def _objections(self, known: StudyError) -> list[Problem]:
        """Return problems that planning the study would find, as far as it can be read.

        So a study with errors of form shows those of its plan at the same time. `known` is the
        error that checking the form has raised; fields that it names are left out, and nothing is
        found where kind, scene or parameters cannot be read.
        """
        kind = self.kind
        if kind is None or not isinstance(self.content.get("parameters"), Mapping):
            return []
        sections = {key: section for key, section in SECTIONS.items() if key in _keys_of(kind)}
        outputs = [*self._outputs(kind)]
        scene, problems = self.content.get("scene"), list[Problem]()
        if not isinstance(scene, str) or not all(isinstance(name, str) for name in outputs):
            return []
        texts = (self.content.get(key) for key in ("variant", "method"))
        variant, method = (text if isinstance(text, str) else None for text in texts)

        def written(parameters: Collection[str]) -> list[str]:
            """Return the parameters that the sections of the study give or leave open, as written.

            `parameters` are those of the scene, or none while the scene is not known.
            """
            some = (
                section.names(self.content.get(key), parameters)
                for key, section in sections.items()
            )
            return [str(name) for names in some for name in names]

        def names(parameters: Collection[str]) -> list[str]:
            """Return the same parameters, misspelt ones corrected."""
            return [*dict.fromkeys(names_intended(written(parameters)))]

        try:
            sketch = Sketch(scene, variant, method, outputs, names(()))
            chosen, variant, problems = kind.choose(sketch)
            given = names(scene_parameters(chosen, variant))
            plan_scene(chosen, variant, outputs[:MAX_OUTPUTS], given)
        except StudyError as error:
            problems = [*problems, *error.problems]
        places = [problem.place for problem in known.problems]
        # The corrected name itself is not in the study, and cannot be removed from it.
        places += map("parameters.{}".format, {*names(())} - {*written(())})
        return [problem for problem in problems if problem.place not in places]

    def _outputs(self, kind: Kind) -> Iterable[Any]:
        """Yield the names of all outputs that a study asks for, in whatever section.

        If the key `outputs` is missing, those that its `kind` has by default come first. The values
        are those of the unchecked content, and need not be texts.
        """
        keys = _keys_of(kind)
        if "outputs" in keys and "outputs" not in self.content:
            default = kind.model.model_fields["outputs"].get_default()
            yield from default if isinstance(default, tuple) else ()
        for key, section in SECTIONS.items():
            if key in keys:
                yield from section.outputs(self.content.get(key))


def _keys_of(kind: Kind) -> Collection[str]:
    """Return the keys of studies of a kind."""
    return tuple(kind.model.model_fields)


def _no_kind(content: Mapping[str, Any]) -> tuple[Problem, Kind]:
    """Return the problem of an unknown or missing kind of study, and the kind probably intended.

    That is the kind with the most similar name, else the one that has most of the keys in
    `content`, the unchecked study; its rules find further problems.
    """
    kind = content.get("kind")
    missing = kind is None
    said = None if missing else nearest(str(kind), KINDS)
    problem = Problem(
        "kind",
        "it is missing" if missing else f"{str(kind)[:60]!r} is not a kind of study",
        "Write kind = " + " or ".join(f'"{name}"' for name in ([said] if said else KINDS)),
    )
    shared = {name: len(set(_keys_of(one)) & set(content)) for name, one in KINDS.items()}
    return problem, KINDS[said or max(KINDS, key=lambda name: shared[name])]
