"""The parts of a row: the names of a study's parameters say which have their own numbers."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibrafeed.core.errors import Problem
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.methods.rows import RowParts
from vibrafeed.core.quantities.row import NUMBERS

STOP_GAPS = {"track_stop_gap": "track", "fixed_stop_gap": "space"}
"""Parameters that put a stop in front of a row, and which; at most one of them is given."""

CHOOSING = ("friction_spread", "friction_seed", *STOP_GAPS)
"""Parameters without a number that a row has only where a study gives them."""

MAX_DEVIATIONS = 3.0
"""Standard deviations at which sampled frictions are cut off."""
DRAWN = 256
"""Deviations sampled for a seed: enough for the longest row after the cut."""

_NUMBERED = re.compile(rf"({'|'.join(NUMBERS)})_(\d+)")


@dataclass(frozen=True)
class NumberedParts:
    """The numbers that the parts of a row have of their own.

    Attributes
    ----------
    numbers
        By the stem of a parameter (`part_friction`, ...), the parts with their own value of it.
    count
        Smallest number of parts that these numbers imply; 0 if there are none.
    counted
        If the study gives the number of parts, too.
    stop_gap
        Parameter that puts a stop in front of the row; empty if none does.
    drawn
        If the frictions of the parts are sampled at random.
    """

    numbers: Mapping[str, tuple[int, ...]]
    count: int
    counted: bool
    stop_gap: str = ""
    drawn: bool = False

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the quantities that the parts are made from, as an equation takes them."""
        numbered = [f"{stem}_{n}" for stem, which in self.numbers.items() for n in which]
        common = [] if self.has_all_masses or not self.has_own_masses else ["mass"]
        counted = ["parts"] if self.counted or not self.count else []
        drawn = ["friction_spread", "friction_seed"] if self.drawn else []
        stop = [self.stop_gap] if self.stop_gap else []
        return (*counted, *numbered, *common, *drawn, *stop, "part_restitution", "length_scale")

    @property
    def has_own_masses(self) -> bool:
        """True if some part has its own mass."""
        return bool(self.numbers["part_mass"])

    @property
    def has_all_masses(self) -> bool:
        """True if every part has its own mass."""
        return not self.counted and 0 < len(self.numbers["part_mass"]) == self.count

    @property
    def has_all_frictions(self) -> bool:
        """True if every part has its own friction."""
        return not self.counted and 0 < len(self.numbers["part_friction"]) == self.count

    def row(self, **given: Any) -> RowParts:
        """Return the parts of the row, from the quantities of `inputs` by name.

        A fractional number of parts is rounded up.
        """
        count = np.ceil(np.asarray(given.get("parts", float(self.count)), dtype=float))
        most = max(self.count, int(count.max()))
        places = range(1, most + 1)
        scale = given["length_scale"]
        common = given.get("mass", np.ones(()))
        parts = RowParts(
            number=np.maximum(count, self.count),
            friction=tuple(given.get(f"part_friction_{n}", np.full((), np.nan)) for n in places),
            mass=tuple(given.get(f"part_mass_{n}", common) for n in places),
            gap=tuple(given.get(f"part_gap_{n}", np.zeros(())) / scale for n in places),
            restitution=given["part_restitution"],
        )
        if self.drawn:
            shift = drawn_deviations(given["friction_seed"], most) * given["friction_spread"]
            parts = parts._replace(shift=tuple(shift))
        if self.stop_gap:
            gap = given[self.stop_gap] / scale
            parts = parts._replace(stop=STOP_GAPS[self.stop_gap], stop_gap=gap)
        return parts


def drawn_deviations(seed: Array, parts: int) -> Array:
    """Return random deviations of the friction of parts in a row, in standard deviations.

    Shape (parts, ...), with the shape of `seed` behind. Normal numbers, cut at `MAX_DEVIATIONS`.
    Those of a seed are the same in every study, and those of a longer row begin with those of a
    shorter one, so that rows can be compared.
    """
    seeds, where = np.unique(np.asarray(seed), return_inverse=True)
    rows = [np.random.default_rng(int(one)).standard_normal(DRAWN) for one in seeds]
    drawn: Array = np.array([row[np.abs(row) <= MAX_DEVIATIONS][:parts] for row in rows]).T
    return drawn[:, where.reshape(np.shape(seed))]


def numbered(names: Iterable[str]) -> NumberedParts:
    """Return the description of a row's parts that a study's parameter names define.

    Names such as `part_friction_2` give a part (here the second from the rear) its own value;
    others say that the number of parts is a parameter, that frictions scatter, or that a stop
    stands in front. No values are known yet: the result makes the parts from them.
    """
    names = tuple(names)
    found = [match for match in map(_NUMBERED.fullmatch, names) if match]
    numbers = {
        stem: tuple(sorted(int(match[2]) for match in found if match[1] == stem))
        for stem in NUMBERS
    }
    behind = max(
        (n + (stem == "part_gap") for stem, which in numbers.items() for n in which), default=0
    )
    stop = next((name for name in STOP_GAPS if name in names), "")
    return NumberedParts(numbers, behind, "parts" in names, stop, "friction_spread" in names)


def contradictions(names: Iterable[str]) -> list[Problem]:
    """Return problems of the parameters of a row of parts that exclude each other.

    `names` are the names of a study's parameters: two stops, or frictions that are both given and
    drawn at random.
    """
    names, problems = tuple(names), []
    if all(name in names for name in STOP_GAPS):
        message = "a row has one stop, and the study gives two"
        problems.append(Problem("parameters.track_stop_gap", message, "Remove one of them"))
    own = [name for name in names if name.startswith("part_friction_")]
    if "friction_spread" in names and own:
        message = f"the frictions are drawn, and {own[0]} is given"
        problems.append(
            Problem(
                "parameters.friction_spread",
                message,
                "Give either friction_spread or the frictions of single parts",
            )
        )
    return problems
