"""Known answers: the TOML files of tests/known_answers, and the comparison of a result with one.

A file has a group of answers. Each answer has `name`, `study`, `value`, `tolerance` and `source`:

- The result is `times` (1) times an output of the study, in the units of result files: `output`
  (the only one) at the only cell, or at the one that `pick` names: `first`, `last`, `least`,
  `largest`, or a number. With `terms` it is the sum of several, or the root of their mean square
  (`combine = "rms"`), each `times * output - minus`, of the study of the answer or of its own.
- `relation` says how the result relates to the value: `equals` (default), `at most`, `at least`,
  or `shown`, which is not judged.
- `status` has the statuses or regimes that are right; `stated_error = true` adds the error that the
  method states itself to the tolerance; `refused` is the place that the refusal of a wrong study
  has to name.
- `family` names a table of [families], whose entries, like those at the top of the file, hold for
  every answer that does not have its own.
"""

from __future__ import annotations

import json
import math
import tomllib
import warnings
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from vibrafeed.core import kinds
from vibrafeed.core.dataset.table import Table, TableVariable
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.quantities import MOTION_STATUSES, REGIMES
from vibrafeed.core.quantities.flags import is_regime

FOLDER = Path(__file__).parents[1] / "tests" / "known_answers"
FILES = tuple(sorted(path.stem for path in FOLDER.glob("*.toml")))
WITHOUT_VALUE = {"unbounded", "no_motion", "stopped", "no_pass"}
"""Valid regimes that explain a value that is not finite; all that are not valid do so too."""
STATED = "conveying_velocity_error"


class Known(SimpleNamespace):
    """A known answer, with the keys of its file as attributes, and its terms."""

    name: str
    study: dict[str, Any]
    value: Any
    tolerance: Any
    terms: Sequence[Mapping[str, Any]]

    def errors(self, result: Any) -> np.ndarray:
        """Return the error of a result in each cell; infinite where a value is missing."""
        with np.errstate(invalid="ignore"):
            off = np.subtract(result, self.value, dtype=np.float64)
        if self.relation != "equals":
            off = np.maximum(off if self.relation == "at most" else -off, 0.0)
        same = np.equal(result, self.value) | (np.isnan(result) & np.isnan(self.value))
        return np.where(same, 0.0, np.where(np.isnan(off), np.inf, np.abs(off)))

    def holds(self, result: Any, stated: Any = 0.0) -> bool:
        """True if a result is right in every cell; `stated` is its own error."""
        allowed = np.asarray(self.tolerance) + (stated if self.stated_error else 0.0)
        return self.relation == "shown" or bool(np.all(self.errors(result) <= allowed))


class Found(NamedTuple):
    """The result of an answer's studies: its value, statuses, and the error that it states."""

    value: np.ndarray
    statuses: frozenset[str]
    explained: bool
    stated: np.ndarray


@cache
def known_answers(file: str) -> tuple[Known, ...]:
    """Return the answers of a file of tests/known_answers, by its name without suffix."""
    content = tomllib.loads((FOLDER / f"{file}.toml").read_text(encoding="utf-8"))
    families, rows = content.pop("families", {}), content.pop("answers")
    plain = {"relation": "equals", "status": (), "stated_error": False, "refused": "", "unit": "1",
             "evidence": "derived", "combine": "sum", "family": "", "night": False,
             "inputs": {}, "title": "", "note": "", "about": ""}  # fmt: skip
    found = []
    for row in rows:
        own = {**plain, **content, **families.get(row.get("family", ""), {}), "inputs": {}, **row}
        term = {key: own[key] for key in ("output", "pick", "times", "minus") if key in own}
        term.setdefault("output", own["study"]["outputs"][0])
        own.setdefault("terms", [term])
        found.append(Known(**own))
    return tuple(found)


@cache
def answer(name: str) -> Known:
    """Return the answer of a name."""
    return next(one for file in FILES for one in known_answers(file) if one.name == name)


def found(known: Known, tables: dict[str, Table]) -> Found:
    """Return the result of an answer's studies; `tables` keeps what was computed, by study.

    Raises `StudyError` if a study is refused, and every warning as an error.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mine = [_table(_study_of(known, term), tables) for term in known.terms]
    values = [_picked(term, table) for term, table in zip(known.terms, mine, strict=True)]
    if known.combine == "rms":
        value = math.sqrt(math.fsum(one * one for one in values) / len(values))
    else:
        value = values[0] + 0.0 if len(values) == 1 else math.fsum(values)  # 0 has no sign
    flags = [_statuses(table.variables) for table in mine]
    stated = mine[0].variables.get(STATED)
    return Found(
        np.asarray(value),
        frozenset[str]().union(*(names for names, _ in flags)),
        any(explained for _, explained in flags),
        np.asarray(0.0 if stated is None else stated.values),
    )


def fault(known: Known, tables: dict[str, Table]) -> str:
    """Return what is wrong with this program's answer, "" if it is right."""
    try:
        result = found(known, tables)
    except StudyError as refusal:
        places = [problem.place for problem in refusal.problems]
        return "" if places == [known.refused] else f"refused: {refusal}"
    if known.refused:
        return f"{known.refused} is accepted"
    if known.status and not result.statuses <= set(known.status):
        return f"status {', '.join(result.statuses)}"
    finite = np.isfinite(result.value)
    if not (result.explained or finite.all()):
        return "not finite, and no status says why"
    stated = np.where(finite, result.stated, 0.0)
    if not np.isfinite(stated).all():
        return "finite, with a stated error that is not"
    if not hasattr(known, "value") or known.holds(result.value, stated):
        return ""
    return f"{result.value} instead of {known.value} within {known.tolerance}"


def _study_of(known: Known, term: Mapping[str, Any]) -> Mapping[str, Any]:
    return term.get("study", known.study)


def _table(study: Mapping[str, Any], tables: dict[str, Table]) -> Table:
    key = json.dumps(study, sort_keys=True)
    if key not in tables:
        tables[key] = kinds.tabulate(prepare_content(study))
    return tables[key]


def _picked(term: Mapping[str, Any], table: Table) -> Any:
    values = np.asarray(table.variables[term["output"]].values, dtype=np.float64)
    pick = term.get("pick")
    if pick in ("least", "largest"):
        values = values.min() if pick == "least" else values.max()
    elif pick is not None:
        values = values[{"first": 0, "last": -1}.get(pick, pick)]
    return term.get("times", 1.0) * values - term.get("minus", 0.0)


def _statuses(variables: Mapping[str, TableVariable]) -> tuple[set[str], bool]:
    """Return the statuses of motions, else regimes, of all cells; whether one explains a gap."""
    judges = {name: REGIMES for name in variables if is_regime(name)}
    if "motion_status" in variables:
        judges["motion_status"] = MOTION_STATUSES
    present = {}
    for name, flags in judges.items():
        numbers = set(np.unique(variables[name].values).tolist())
        present[name] = {one: flag for one, flag in flags.items() if flag.value in numbers}
    explained = any(
        flags and all(not flag.valid or name in WITHOUT_VALUE for name, flag in flags.items())
        for flags in present.values()
    )
    last = present.get("motion_status")
    named = [last] if last is not None else list(present.values())
    return {name for flags in named for name in flags}, explained
