"""The error tree.

VibrafeedError
├── StudyError        what a user wrote cannot be done; holds every problem found
├── LimitError        the request is sound but larger than the limits in force
├── StoppedError      a computation was stopped, and what it had done is no answer
├── MissingPackageError  a package that few need is not installed
└── SceneError        a scene contradicts itself; a mistake of ours, found when it is imported
"""

from collections.abc import Collection, Iterable
from dataclasses import dataclass, field, replace
from typing import Any

PUBLIC = "vibrafeed"  # the name by which users import errors, in tracebacks and pickles
MAX_PROBLEMS = 100  # that are told one by one


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

    __module__ = PUBLIC

    place: str
    message: str
    fix: str
    about: str = field(default="", compare=False, repr=False)

    def __str__(self) -> str:
        return f"{self.place}: {self.message}. {self.fix}{'' if self.fix.endswith('?') else '.'}"

    def document(self) -> dict[str, str]:
        """Return the problem for programs: place, message and fix."""
        return {"place": self.place, "message": self.message, "fix": self.fix}

    def below(self, parent: str) -> "Problem":
        """Return the problem with its path below that of a parent section."""
        return replace(self, place=f"{parent}.{self.place}")


class VibrafeedError(Exception):
    """Base of every error that vibrafeed raises on purpose."""

    __module__ = PUBLIC

    def _render_traceback_(self) -> list[str]:
        return [f"{type(self).__name__}: {self}"]


class StudyError(VibrafeedError):
    """A study cannot be carried out; `problems` holds everything found, not only the first."""

    __module__ = PUBLIC

    def __init__(self, problems: Iterable[Problem]):
        # Two needs of one missing parameter are one problem.
        self.problems = tuple(dict.fromkeys(problems))
        super().__init__("\n".join(str(problem) for problem in self.problems))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.problems,)  # it may come from another process


def refused(path: str, message: str, fix: str, about: str = "") -> StudyError:
    """Return the error of a study with one problem."""
    return StudyError([Problem(path, message, fix, about)])


def given_twice(
    section: str, names: Iterable[str], other: str, others: Collection[str]
) -> list[Problem]:
    """Return the problem of each name in a section of a study that another section gives, too."""
    return [
        Problem(
            f"{section}.{name}",
            f"{name} is given twice: in [{section}] and in [{other}]",
            "Remove one of the two",
        )
        for name in names
        if name in others
    ]


def raise_any(problems: Iterable[Problem]) -> None:
    """Raise a `StudyError` with problems, if there are any."""
    error = StudyError(problems)
    if error.problems:
        raise error


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

    __module__ = PUBLIC

    def __init__(self, limit: str, asked: int, allowed: int, fix: str):
        self.limit, self.asked, self.allowed, self.fix = limit, asked, allowed, fix
        self.message = f"the study asks for {asked:,} {limit}, the limit is {allowed:,}"
        super().__init__(f"{self.message}. {fix}.")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.limit, self.asked, self.allowed, self.fix)


class StoppedError(VibrafeedError):
    """A computation was stopped, by its user or by a time limit, before there was an answer."""


class MissingPackageError(VibrafeedError):
    """Something takes a package that is not installed; the message says how to install it."""

    def __init__(self, what: str, package: str, how: str):
        super().__init__(f"{what} needs {package}, which is not installed: {how}")


class SceneError(VibrafeedError):
    """A scene is not sound: two producers of a quantity, an undeclared name, a cycle."""
