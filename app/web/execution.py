"""The processes that the service offers: one a kind of study, and the accuracy of one."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Union

from pydantic import BaseModel, ConfigDict, Field, RootModel

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.plan.pieces import Kind
from vibrafeed.core.study import Study

ACCURACY = "accuracy"


def _any_of(kinds: Iterable[Kind]) -> Any:
    """Return the union type of the studies of some kinds, discriminated by `kind`."""
    models = tuple(kind.model for kind in kinds)
    return Annotated[Union[models], Field(discriminator="kind")]  # noqa: UP007 - made as it runs


if TYPE_CHECKING:
    AnyStudy = RootModel[Study]
    MeasuredStudy = RootModel[Study]
else:
    # Only the OpenAPI document shows these: what validates them is built when that is asked for,
    # as it takes as long as all else of a start.

    class AnyStudy(RootModel):
        """A study of any kind."""

        model_config = ConfigDict(defer_build=True)
        root: _any_of(KINDS.values())

    class MeasuredStudy(RootModel):
        """A study whose accuracy can be measured."""

        model_config = ConfigDict(defer_build=True)
        root: _any_of(kind for kind in KINDS.values() if kind.is_measured)


@dataclass(frozen=True)
class Process:
    """A process that the service carries out.

    Attributes
    ----------
    title, description : str
        What a list shows.
    study : type
        The model of its studies.
    example : mapping
        A short study.
    """

    title: str
    description: str
    study: type[BaseModel]
    example: Mapping[str, Any]


PROCESSES: dict[str, Process] = {
    **{
        name: Process(kind.title, kind.description, kind.model, kind.example)
        for name, kind in KINDS.items()
    },
    ACCURACY: Process(
        "Measure accuracy and run time",
        "Measures the error of a study over its run time, against a witness; takes up to a minute "
        "or so, and is always a job.",
        MeasuredStudy,
        KINDS["sweep"].example,
    ),
}
"""Every process, by its identifier."""


@dataclass(frozen=True)
class Execution:
    """The body of an execute request.

    Attributes
    ----------
    study : object
        What is to be the study.
    as_document : bool
        The reply is to name the output, as in ``{"dataset": {"value": ...}}``.
    """

    study: object
    as_document: bool


def read_execution(content: object, kind: str) -> Execution:
    """Return the study and the requested form of reply in the body of an execute request.

    The body (`content`, parsed JSON) is the study itself, or an execute request with the study
    under ``inputs.study``. `kind` is the process; a study without `kind` gets this one.

    Raises
    ------
    StudyError
        If there is no study, or one of another kind, or an unsupported form of reply.
    """
    as_document = False
    if isinstance(content, Mapping) and "inputs" in content:
        as_document = _read_wishes(content)
        inputs = content["inputs"]
        study = inputs.get("study") if isinstance(inputs, Mapping) else None
        if isinstance(study, Mapping) and set(study) <= {"value", "mediaType"}:
            study = study.get("value")
        if not isinstance(study, Mapping):
            fix = 'Send {"inputs": {"study": {...}}}'
            raise StudyError([Problem("inputs.study", "there is no study", fix)])
        content = study
    if not isinstance(content, Mapping):
        return Execution(content, as_document)
    if kind == ACCURACY:
        return Execution(content, as_document)
    named = content.get("kind", kind)
    if named != kind:
        problem = Problem(
            "kind",
            f"this process takes studies of kind '{kind}', not of kind {str(named)[:60]!r}",
            f"Write kind = '{kind}', or post the study to the process of its own kind",
        )
        raise StudyError([problem])
    return Execution({"kind": kind, **content}, as_document)


def _read_wishes(content: Mapping[str, Any]) -> bool:
    """True if an execute request asks for a document as reply, False for the bare result.

    `content` is the request. Raises `StudyError` with all problems if it asks for another form of
    reply or another output.
    """
    problems = []
    response = content.get("response", "raw")
    if response not in ("raw", "document"):
        message = f"{str(response)[:60]!r} is not a form of reply"
        problems.append(Problem("response", message, "Write 'raw' or 'document'"))
    outputs = content.get("outputs") or {}
    if not isinstance(outputs, Mapping):
        problems.append(
            Problem(
                "outputs",
                "outputs of the execute request is not a JSON object",
                "Leave outputs out",
            )
        )
    else:
        problems += [
            Problem(
                f"outputs.{str(name)[:60]}",
                f"a process has no output {str(name)[:60]!r}",
                "In outputs, request the only output, dataset",
            )
            for name in outputs
            if name != "dataset"
        ]
    if problems:
        raise StudyError(problems)
    return response == "document"
