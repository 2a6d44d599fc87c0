"""The error tree.

VibrafeedError
├── StudyError        what a user wrote cannot be done; holds every problem found
├── LimitError        the request is sound but larger than the limits in force
├── StoppedError      a computation was stopped, and what it had done is no answer
├── MissingPackageError  a package that few need is not installed
└── SceneError        a scene contradicts itself; a mistake of ours, found when it is imported
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace

from core.other_names import meant


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a study.

    Attributes
    ----------
    place : str
        Where: the key path, such as ``parameters.beta``.
    message : str
        What is wrong.
    fix : str
        What would be right.
    about : str
        The name that it is about, by which a caller finds the place where a user wrote it; empty
        where nobody asks. No part of what users see, nor of what makes two problems equal.
    """

    place: str
    message: str
    fix: str
    about: str = field(default="", compare=False, repr=False)

    def __str__(self) -> str:
        return f"{self.place}: {self.message}. {self.fix}{'' if self.fix.endswith('?') else '.'}"

    def below(self, place: str) -> Problem:
        """Return the same problem with `place` in front of its own place."""
        return replace(self, place=f"{place}.{self.place}")


class VibrafeedError(Exception):
    """Base of every error that vibrafeed raises on purpose."""


class StudyError(VibrafeedError):
    """A study cannot be carried out; `problems` holds everything found, not only the first."""

    def __init__(self, problems: Iterable[Problem]):
        # Two needs of one missing parameter are one problem.
        self.problems = tuple(dict.fromkeys(problems))
        super().__init__("\n".join(str(problem) for problem in self.problems))


class LimitError(VibrafeedError):
    """A request is larger than a limit.

    Attributes
    ----------
    limit : str
        Name of the limit, such as ``cells``.
    asked, allowed : int
        The two figures.
    fix : str
        What would fit.
    """

    def __init__(self, limit: str, asked: int, allowed: int, fix: str):
        self.limit, self.asked, self.allowed, self.fix = limit, asked, allowed, fix
        self.message = f"the study asks for {asked:,} {limit}, the limit is {allowed:,}"
        super().__init__(f"{self.message}. {fix}.")


class StoppedError(VibrafeedError):
    """A computation was stopped, by its user or by a time limit, before there was an answer."""


class MissingPackageError(VibrafeedError):
    """Something takes a package that is not installed; the message says how to install it."""

    def __init__(self, what: str, package: str, how: str):
        super().__init__(f"{what} needs {package}, which is not installed: {how}")


class SceneError(VibrafeedError):
    """A scene is not sound: two producers of a quantity, an undeclared name, a cycle."""


MEANT = 4  # letters of a name that tell which is meant
LONGEST = 60  # letters of a name that are looked at; no name of ours has more


def nearest(name: str, known: Iterable[str]) -> str | None:
    """Return the known name that another, mistyped or shortened one stands for; None if none is."""
    choice, name = sorted(known), name[:LONGEST]
    said = meant(name, choice)
    if said is not None:
        return said
    longer = [known for known in choice if len(name) >= MEANT and known.startswith(name)]
    near = longer or difflib.get_close_matches(name, choice, n=1, cutoff=0.6)
    return near[0] if near else None


FEWEST_OF_A_FAMILY = 3
MOST_PROBLEMS = 100  # that are told one by one
SEARCHED = 8  # names of one request that are worth a search for what was meant


def suggestion(name: str, known: Iterable[str], listed: Iterable[str] | None = None) -> str:
    """Return ``Did you mean ...?`` for the nearest known name, or the whole choice.

    `listed` are those of the known names that are the choice, if not all of them.
    """
    choice = sorted(known)
    near = nearest(name, choice)
    if near:
        return f"Did you mean '{near}'?"
    return "Known: " + ", ".join(_in_families(choice if listed is None else sorted(listed)))


class Suggestions:
    """Searches for the first few names alone: nobody reads more, and each search takes time."""

    def __init__(self) -> None:
        self.left = SEARCHED

    def __call__(self, name: str, known: Iterable[str], listed: Iterable[str] | None = None) -> str:
        """Return what `suggestion` does, or a plain word once that has been asked often enough."""
        return self.within(lambda: suggestion(name, known, listed))

    def within(self, search: Callable[[], str]) -> str:
        """Return what a search gives, as above."""
        self.left -= 1
        return search() if self.left >= 0 else "Fix the ones before it first"


def _in_families(names: Iterable[str]) -> list[str]:
    """Return names, sorted, those that differ by a last number alone as one: `spin_1 to _3`."""
    families: dict[str, list[str]] = {}
    for name in names:
        stem, _, number = name.rpartition("_")
        families.setdefault(f"{stem}_" if number.isdecimal() else name, []).append(name)
    told = []
    for stem, family in families.items():
        if len(family) >= FEWEST_OF_A_FAMILY:
            numbers = [int(name.removeprefix(stem)) for name in family]
            told.append(f"{stem}{min(numbers)} to _{max(numbers)}")
        else:
            told += family
    return told
