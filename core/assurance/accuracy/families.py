"""The families of measurements that a study has."""

from __future__ import annotations

from collections.abc import Collection

from vibrafeed.core.assurance.accuracy.curves import FAMILIES
from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.plan.prepared import Prepared

SECONDS = 60.0
"""Of one family; what is fast takes less."""


def families_of(prepared: Prepared, only: Collection[str] = ()) -> tuple[str, ...]:
    """Return the families of accuracy measurements that a study's kind has, in order.

    `only` restricts them to those that it names; all if it is empty.

    Raises
    ------
    StudyError
        If the kind of study has none, or `only` names one that does not exist or that it has not.
    """
    kind = prepared.study.kind
    known = KINDS[kind].measures
    if not known:
        measured = (name for name, one in KINDS.items() if one.measures)
        message = f"the accuracy of a study of kind '{kind}' is not measured"
        raise StudyError([Problem("kind", message, f"Measure one of kind {' or '.join(measured)}")])
    unknown = [name for name in only if name not in known]
    if unknown:
        what = (
            "is not a family of measurements"
            if unknown[0] not in FAMILIES
            else f"is not measured for {kind}"
        )
        raise StudyError([Problem("only", f"'{unknown[0]}' {what}", f"Known: {', '.join(known)}")])
    return tuple(name for name in known if not only or name in only)
