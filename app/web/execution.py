"""The processes that the service offers: one a kind of study, and the accuracy of one."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union

from pydantic import BaseModel, ConfigDict, Field, RootModel, ValidationError
from pydantic_core import ErrorDetails

from vibrafeed.core.errors import Problem, StudyError, refused
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.plan.pieces import Kind
from vibrafeed.core.study.grid_study import Study

ACCURACY = "accuracy"


def _any_of(kinds: Iterable[Kind]) -> Any:
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


class Inputs(BaseModel):
    """The inputs of a process: the study."""

    study: dict[str, Any]


class ExecuteRequest(BaseModel):
    """An execute request of OGC API - Processes, with the study under `inputs.study`."""

    inputs: Inputs
    outputs: dict[Literal["dataset"], Any] | None = None
    response: Literal["raw", "document"] = "raw"


def read_execution(content: object, kind: str) -> tuple[object, bool]:
    """Return the study in the body of an execute request, and whether to reply by a document.

    The body (`content`, parsed JSON) is the study itself, or an execute request with the study
    under ``inputs.study``. `kind` is the process; a study without `kind` gets this one. A document
    names the output, as in ``{"dataset": {"value": ...}}``.

    Raises
    ------
    StudyError
        If there is no study, or one of another kind, or an unsupported form of reply.
    """
    as_document = False
    if isinstance(content, Mapping) and "inputs" in content:
        try:
            request = ExecuteRequest.model_validate(content)
        except ValidationError as error:
            raise StudyError([_problem_of(item) for item in error.errors()]) from None
        as_document, content = request.response == "document", request.inputs.study
        if set(content) <= {"value", "mediaType"}:  # an input by value, as the standard has it
            content = content.get("value")
    if not isinstance(content, Mapping) or kind == ACCURACY:
        return content, as_document
    own_kind = content.get("kind", kind)
    if own_kind != kind:
        raise refused(
            "kind",
            f"this process accepts studies of kind '{kind}', not of kind {str(own_kind)[:60]!r}",
            f"Set kind = '{kind}', or post the study to the process of its own kind",
        )
    return {"kind": kind, **content}, as_document


def _problem_of(error: ErrorDetails) -> Problem:
    place = ".".join(str(part)[:60] for part in error["loc"] if part != "[key]")
    return Problem(place, error["msg"], 'Send {"inputs": {"study": {...}}}')
