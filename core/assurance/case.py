"""A case: a study whose right result is known, with the tolerance and the source of that."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array

Content = Mapping[str, Any]

EVIDENCE: Mapping[str, str] = MappingProxyType(
    {
        "exact": "a published closed form",
        "derived": "a closed form of our own, or digits computed without this program",
        "limit": "a closed form that is approached",
        "inequality": "a bound that must hold",
        "measured": "a measurement, with its scatter",
        "thesis figure": "what a figure of the thesis is said to show",
    }
)
"""Kinds of evidence, from the strongest claim about the program to the weakest."""

RELATIONS: Mapping[str, str] = MappingProxyType(
    {
        "equals": "",
        "at most": "at most ",
        "at least": "at least ",
        "shown": "",
    }
)
"""How a result relates to the right value, and how that is written before it.

``shown`` is a value that is set beside the answer and not judged.
"""


@dataclass(frozen=True)
class Term:
    """One output of one study: its part of a result is ``times * output - minus``.

    Attributes
    ----------
    study : mapping
        The content of a study.
    output : str
        The output, in SI units and degrees, as files hold it.
    pick : str
        What is taken of the output: its `value` at every cell, the `least` or `largest` over the
        study, or that of the `first` or `last` time of its trajectory.
    times, minus : float
    """

    study: Content
    output: str
    pick: str = "value"
    times: float = 1.0
    minus: float = 0.0


class Truth(NamedTuple):
    """The right value, the largest error of a result that is still right, and the source.

    Value and tolerance are numbers, or arrays over the cells of the study.
    """

    value: Any
    tolerance: Any
    source: str


@dataclass(frozen=True)
class CaseValues:
    """The values that the studies of a case gave.

    Attributes
    ----------
    value : ndarray
        The judged result, a number or one a cell.
    statuses : frozenset of str
        Names of the statuses (of motion) or regimes (of a sweep) of all cells.
    explained : bool
        True where one of them says why a value is missing.
    stated : ndarray or None
        The error that the method states for its conveying velocity; None where it states none.
    note : str
        What to say beside the verdict instead of the source of the truth.
    """

    value: Array
    statuses: frozenset[str] = frozenset()
    explained: bool = False
    stated: Array | None = None
    note: str = ""


@dataclass(frozen=True)
class Case:
    """A study whose right result is known.

    Attributes
    ----------
    id : str
        Its name. Of a member of a form the name of the form and a number, as in
        ``Q-two-levels-1``; of random members the number holds the seed and the place, as in
        ``Q-two-levels-r1.20``.
    family : str
        The letter of its family, or what a hard case is hard for.
    title : str
        What it is, in a line, or why it is hard.
    terms : tuple of Term
        What the result is made of.
    known : Truth or callable, optional
        The truth, or what computes it; None where the study has to be refused, or where only
        status and finiteness are judged.
    evidence : str
        One of `EVIDENCE`.
    unit : str
        Of result, truth and tolerance.
    why : str
        Why the tolerance is that large.
    inputs : mapping of str to float
        The inputs, in the units that the form names; empty where the study says all.
    relation : str
        One of `RELATIONS`.
    combine : str
        ``sum`` of the terms, or their ``rms``: the root of the mean of their squares.
    digits : str
        The right value as its source writes it; empty where all digits are known.
    status : tuple of str
        The statuses or regimes that are right; empty for any.
    refused : str
        The place that the `StudyError` has to name, where the study has to be refused.
    states_error : bool
        True where the result states its own error, which is then added to the tolerance.
    blunt : str
        Why that stated error may be larger than what it is stated for; empty where it may not.
    compute : callable, optional
        Runs in the place of the studies.
    """

    id: str
    family: str
    title: str
    terms: tuple[Term, ...]
    known: Truth | Callable[[], Truth] | None = field(repr=False)
    evidence: str = "derived"
    unit: str = "1"
    why: str = ""
    inputs: Mapping[str, float] = field(default_factory=dict)
    relation: str = "equals"
    combine: str = "sum"
    digits: str = ""
    status: tuple[str, ...] = ()
    refused: str = ""
    states_error: bool = False
    blunt: str = ""
    compute: Callable[[], CaseValues] | None = None

    @cached_property
    def truth(self) -> Truth | None:
        """The true value, computed once."""
        return self.known() if callable(self.known) else self.known

    @property
    def right(self) -> Truth:
        """The true value of a case that has one."""
        assert self.truth is not None
        return self.truth

    @property
    def form(self) -> str:
        """The form of the case."""
        return self.id.rpartition("-")[0]

    def result(self, outputs: Sequence[Any]) -> Any:
        """Return the result of a case, combined from the outputs of the studies that it runs.

        `outputs` has one number or array for each of the terms, in their order. A term is a factor
        times its output less a constant; terms are added up, or the root of their mean square is
        taken.
        """
        parts = [
            term.times * output - term.minus
            for term, output in zip(self.terms, outputs, strict=True)
        ]
        if self.combine == "rms":
            return math.sqrt(math.fsum(part * part for part in parts) / len(parts))
        return parts[0] + 0.0 if len(parts) == 1 else math.fsum(parts)  # 0 has no sign

    def errors(self, value: Any) -> Array:
        """Return the absolute error of a result in each cell, in the unit of the case.

        `value` is a number or an array over the cells. Where the case only gives a bound, the error
        within the bound is 0. It is infinite where the result has no value (NaN) and should have
        one.
        """
        right = self.right.value
        with np.errstate(invalid="ignore"):
            off = np.subtract(value, right, dtype=np.float64)
        if self.relation == "at most":
            off = np.maximum(off, 0.0)
        elif self.relation == "at least":
            off = np.maximum(-off, 0.0)
        same = np.equal(value, right) | (np.isnan(value) & np.isnan(right))
        return np.where(same, 0.0, np.where(np.isnan(off), np.inf, np.abs(off)))

    def holds(self, value: Any) -> bool:
        """True if a result is right in every cell; cases without a truth always are."""
        return self.relation == "shown" or bool(np.all(self.errors(value) <= self.right.tolerance))

    def document(self) -> dict[str, Any]:
        """Return a validation case as nested dictionaries of plain values, to be written as JSON.

        It has the case's title, source and inputs, the terms of which its value is made (output of
        a study, picked cell, factor), the expected value with unit and tolerance, and the reason
        (`why`).
        """
        return {
            "id": self.id,
            "family": self.family,
            "form": self.form,
            "title": self.title,
            "source": self.right.source,
            "truth": self.evidence,
            **({"given": dict(self.inputs)} if self.inputs else {}),
            "answer": {
                "combine": self.combine,
                "terms": [
                    {
                        "study": term.study,
                        "output": term.output,
                        "pick": term.pick,
                        "times": term.times,
                        "minus": term.minus,
                    }
                    for term in self.terms
                ],
            },
            "relation": self.relation,
            "expected": self.right.value,
            **({"digits": self.digits} if self.digits else {}),
            "unit": self.unit,
            "tolerance": self.right.tolerance,
            "why": self.why,
        }


def half_unit(digits: str) -> float:
    """Return half a unit of the last digit of a number written in `digits`: 5e-5 for "3.2700"."""
    mantissa, _, exponent = digits.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 0.5 * 10.0 ** (int(exponent or 0) - decimals)
