"""A problem whose answer is known, and how an answer is judged."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

Content = Mapping[str, Any]

TRUTHS: Mapping[str, str] = MappingProxyType(
    {
        "exact": "a published closed form",
        "derived": "a closed form of our own, or digits computed without this program",
        "limit": "a closed form that is approached",
        "inequality": "a bound that must hold",
        "measured": "a measurement, with its scatter",
        "thesis figure": "what a figure of the thesis is said to show",
    }
)
"""Kinds of truth, from the strongest claim about the program to the weakest."""

RELATIONS: Mapping[str, str] = MappingProxyType(
    {
        "equals": "",
        "at most": "at most ",
        "at least": "at least ",
        "shown": "",
    }
)
"""What an answer has to do with the expected value, and how that is written before it.

``shown`` is a value that is set beside the answer and not judged.
"""


@dataclass(frozen=True)
class Term:
    """One output of one study: its part of an answer is ``times * output - minus``.

    Attributes
    ----------
    study : mapping
        The content of a study.
    output : str
        The output, in SI units and degrees, as files hold it.
    pick : str
        What is taken of the output: its one `value`, the `least` or `largest` over the study, or
        that of the `first` or `last` time of its trajectory.
    times, minus : float
    """

    study: Content
    output: str
    pick: str = "value"
    times: float = 1.0
    minus: float = 0.0


@dataclass(frozen=True)
class KnownProblem:
    """A problem whose answer is known.

    Attributes
    ----------
    id : str
        Its name: that of its form and a number, as in ``Q-two-levels-1``. Of random members the
        number tells the seed and the place, as in ``Q-two-levels-r1.20``.
    title : str
        What it is, in a line; the words of its form say what happens, and what is asked.
    source : str
        Who found the expected value, or how it was derived.
    truth : str
        One of `TRUTHS`.
    given : mapping of str to float
        The inputs, in the units that the form names; empty where the study says all.
    terms : tuple of Term
        What the answer is made of.
    combine : str
        ``sum`` of the terms, or their ``rms``: the root of the mean of their squares.
    relation : str
        One of `RELATIONS`.
    expected : float
    digits : str
        The expected value as its source writes it; empty where all digits are known.
    unit : str
        Of the answer and the expected value.
    tolerance : float
        By how much an answer may miss, in that unit.
    why : str
        Why it is that large.
    """

    id: str
    title: str
    source: str
    truth: str
    given: Mapping[str, float]
    terms: tuple[Term, ...]
    relation: str
    expected: float
    unit: str
    tolerance: float
    why: str
    digits: str = ""
    combine: str = "sum"

    @property
    def form(self) -> str:
        """The form that it is a member of."""
        return self.id.rpartition("-")[0]

    @property
    def family(self) -> str:
        """The letter of its family."""
        return self.id.partition("-")[0]

    def answer(self, outputs: list[float]) -> float:
        """Return the answer, given the outputs of its terms."""
        parts = [
            term.times * found - term.minus for term, found in zip(self.terms, outputs, strict=True)
        ]
        if self.combine == "rms":
            return math.sqrt(math.fsum(part * part for part in parts) / len(parts))
        return math.fsum(parts)

    def miss(self, found: float) -> float:
        """Return by how much an answer misses the expected value; 0 on the right side of a bound.

        Infinite where there is no answer.
        """
        if math.isnan(found):
            return math.inf
        off = found - self.expected
        if self.relation == "at most":
            return max(off, 0.0)
        if self.relation == "at least":
            return max(-off, 0.0)
        return abs(off)

    def holds(self, found: float) -> bool:
        """True if an answer is right; one that is only shown always is."""
        return self.relation == "shown" or self.miss(found) <= self.tolerance

    def document(self) -> dict[str, Any]:
        """Return the problem as plain values, for JSON."""
        return {
            "id": self.id,
            "family": self.family,
            "form": self.form,
            "title": self.title,
            "source": self.source,
            "truth": self.truth,
            **({"given": dict(self.given)} if self.given else {}),
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
            "expected": self.expected,
            **({"digits": self.digits} if self.digits else {}),
            "unit": self.unit,
            "tolerance": self.tolerance,
            "why": self.why,
        }


def half_unit(digits: str) -> float:
    """Return half a unit of the last digit of a number as it is written, such as ``3.2700``."""
    mantissa, _, exponent = digits.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 0.5 * 10.0 ** (int(exponent or 0) - decimals)
