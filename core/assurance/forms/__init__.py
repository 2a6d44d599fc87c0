"""Forms: problems of one formula, listed with the digits of their source, or with random inputs.

Words, sources, tolerances and listed problems of a form are a TOML file beside this one; its
formula, of the same name, is in one of the modules of `FORMULAS`.
"""

from __future__ import annotations

import tomllib
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np

from vibrafeed.core.assurance.case import Case, Truth, half_unit
from vibrafeed.core.assurance.forms import best_wave, fast_drives, formulas, laws, resting
from vibrafeed.core.assurance.forms.formulas import Formula

FORMULAS: Mapping[str, Formula] = {
    **formulas.FORMULAS,
    **best_wave.FORMULAS,
    **fast_drives.FORMULAS,
    **laws.FORMULAS,
    **resting.FORMULAS,
}


@dataclass(frozen=True)
class Form:
    """The properties that the problems of one form share.

    Attributes
    ----------
    name : str
        Its letter and what it is, as in ``Q-two-levels``.
    family, title, words, source, truth, relation, unit, why : str
        Of its family in words, and what its problems say unless they say otherwise themselves.
    inputs : mapping of str to str
        Unit and meaning of each input.
    tolerance : float
        Of random members, in the unit of the form.
    relative : bool
        Whether that is a share of the expected value instead.
    listed : tuple of mapping
        The problems with the digits of their source.
    """

    name: str
    family: str
    title: str
    words: str
    source: str
    truth: str
    relation: str
    unit: str
    why: str
    inputs: Mapping[str, str]
    tolerance: float
    relative: bool
    listed: tuple[Mapping[str, Any], ...]

    @property
    def letter(self) -> str:
        """The letter of the form's family."""
        return self.name.partition("-")[0]

    @property
    def formula(self) -> Formula:
        """The formula of the form."""
        return FORMULAS[self.name]

    def cases(self) -> Iterator[Case]:
        """Yield the problems of the form that its file lists, with the digits of their sources.

        The tolerance is half a unit of the last digit, unless the problem has one of its own.
        """
        for number, row in enumerate(self.listed, 1):
            digits = row["expected"]
            yield Case(
                id=f"{self.name}-{number}",
                family=self.letter,
                title=self.title,
                terms=self.formula.terms(row["given"]),
                known=Truth(
                    float(digits),
                    row.get("tolerance", half_unit(digits)),
                    row.get("source", self.source),
                ),
                evidence=row.get("truth", self.truth),
                unit=self.unit,
                inputs=row["given"],
                relation=self.relation,
                why=row.get("why", "half a unit of the last digit"),
                digits=digits,
            )

    def random(self, count: int, seed: int) -> Iterator[Case]:
        """Yield `count` problems of the form with random inputs, expected values from its formula.

        Equal seeds give equal problems, and the first ones do not depend on `count`.
        """
        draw = np.random.default_rng([seed, zlib.crc32(self.name.encode())])
        for number in range(1, count + 1):
            inputs = self.formula.random(draw)
            expected = self.formula.value(inputs)
            size = abs(expected) if self.relative else 1.0
            yield Case(
                id=f"{self.name}-r{seed}.{number}",
                family=self.letter,
                title=self.title,
                terms=self.formula.terms(inputs),
                known=Truth(expected, self.tolerance * size, self.source),
                evidence=self.truth,
                unit=self.unit,
                inputs=inputs,
                relation=self.relation,
                why=self.why,
            )


@cache
def forms() -> Mapping[str, Form]:
    """Return all forms of validation problems by name, such as "Q-two-levels", sorted.

    A form is a formula with listed and random problems; each has a TOML file in this package.
    """
    names = sorted(
        file.name.removesuffix(".toml")
        for file in files(__name__).iterdir()
        if file.name.endswith(".toml")
    )
    return {name: _form(name) for name in names}


def _form(name: str) -> Form:
    """Return the form of validation problems that the TOML file of this name describes."""
    content = tomllib.loads((files(__name__) / f"{name}.toml").read_text(encoding="utf-8"))
    relative = "relative" in content
    same = ("family", "title", "source", "truth", "relation", "unit", "why", "inputs")
    return Form(
        name=name,
        words=" ".join(content["words"].split()),
        tolerance=content["relative" if relative else "absolute"],
        relative=relative,
        listed=tuple(content.get("problems", ())),
        **{key: content[key] for key in same},
    )
