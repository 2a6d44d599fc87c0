"""The section `[reduce]` of a study of closed forms or of motion: statistics instead of cells."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    PlainSerializer,
    PlainValidator,
    WithJsonSchema,
)

from vibrafeed.core.quantities import QUANTITIES, REGIMES
from vibrafeed.core.quantities.flags import is_regime
from vibrafeed.core.study.grid_study import Level, at_most, read_level, refusal, refusing
from vibrafeed.core.suggestions import suggestion

STATISTICS = ("max", "min", "mean", "std", "argmax", "argmin")
"""Statistics of an output over the cells that are reduced."""
QUANTILE = "quantile"
"""The dimension of quantiles, and the suffix of their variables."""
MOST = 20  # names of shares or of levels, or conditions of one share, at most
MAX_NAMES = 100

_CONDITION = re.compile(r"\s*(\w{1,100})\s*(<=|>=|==|!=|<|>)\s*(.{1,200}?)\s*")
_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")


@dataclass(frozen=True)
class ShareCondition:
    """One thing that a cell has to meet.

    Attributes
    ----------
    name : str
        An output, or a variable of regimes, such as ``regime``.
    comparison : str
        One of <=, >=, ==, !=, < and >.
    value : float or str
        A value in the output's unit, or the name of a regime.
    """

    name: str
    comparison: str
    value: float | str

    @property
    def is_regime(self) -> bool:
        """True for a condition on a regime, false for one on an output."""
        return isinstance(self.value, str)

    def __str__(self) -> str:
        value = self.value if isinstance(self.value, str) else repr(self.value)
        return f"{self.name} {self.comparison} {value}"


@refusing
def _read_condition(raw: object) -> ShareCondition:
    if isinstance(raw, ShareCondition):
        return raw
    match = _CONDITION.fullmatch(raw) if isinstance(raw, str) else None
    if match is None:
        raise refusal(
            f"{str(raw)[:60]!r} is not a condition",
            "Write, for example, 'throw_number < 1' or 'regime == slip'",
        )
    name, comparison, value = match.groups()
    if is_regime(name):
        if comparison not in ("==", "!="):
            raise refusal(
                "regimes have no order", f"Write 'regime == {value}' or 'regime != {value}'"
            )
        if value not in REGIMES:
            raise refusal(f"'{value[:60]}' is not a regime", partial(suggestion, value, REGIMES))
        return ShareCondition(name, comparison, value)
    if name not in QUANTITIES:
        raise refusal(f"'{name[:60]}' is not an output", partial(suggestion, name, QUANTITIES))
    try:
        number: object = float(value)
    except ValueError:
        number = value
    return ShareCondition(name, comparison, read_level(name, number))


def _read_statistic(raw: object) -> str:
    if raw in STATISTICS:
        return str(raw)
    text = str(raw)[:60]
    near = "Write quantiles = [0.5]" if text == "median" else partial(suggestion, text, STATISTICS)
    raise refusal(f"'{text}' is not a statistic", near)


def _read_quantile(raw: object) -> float:
    if isinstance(raw, bool) or not isinstance(raw, int | float) or not 0 <= raw <= 1:
        raise refusal(
            f"{str(raw)[:40]!r} is not a quantile",
            "Write a number from 0 to 1, such as 0.5 for the median",
        )
    return float(raw)


def _read_name(raw: object) -> str:
    if not isinstance(raw, str) or not _NAME.fullmatch(raw):
        raise refusal(
            f"{str(raw)[:60]!r} is not a valid name of a variable of the result",
            "Use lower-case letters, digits and underscores, 40 at most, beginning with a letter",
        )
    return raw


def _ordered(order: Iterable[str]) -> Any:
    position_of = {name: position for position, name in enumerate(order)}

    return AfterValidator(
        lambda names: tuple(
            sorted(dict.fromkeys(names), key=lambda name: position_of.get(name, len(position_of)))
        )
    )


_BY_NAME = AfterValidator(lambda named: dict(sorted(named.items())))
_TEXT = {"type": "string", "maxLength": 300}
_Condition = Annotated[
    ShareCondition, PlainValidator(_read_condition), PlainSerializer(str), WithJsonSchema(_TEXT)
]
_Conditions = Annotated[tuple[_Condition, ...], at_most(MOST), Field(max_length=MOST)]
_Name = Annotated[str, PlainValidator(_read_name), WithJsonSchema({"type": "string"})]
_Known = Annotated[str, Field(max_length=100)]


class _Part(BaseModel):
    model_config = ConfigDict(
        frozen=True, extra="forbid", defer_build=True, arbitrary_types_allowed=True
    )


class LevelSet(_Part):
    """The position at which an output crosses a level, along one of the axes that go."""

    output: _Known = Field(description="The output.")
    level: Level = Field(description="The level.")
    along: _Known = Field(description="The axis on which the crossing is located; one of `over`.")
    take: Literal["smallest", "largest"] = Field(
        "smallest",
        description="Which crossing to return if there are several: the smallest or the largest.",
    )


class Reduction(_Part):
    """Answers over some axes of a grid, in place of its cells."""

    over: Annotated[tuple[_Known, ...], at_most(MAX_NAMES), _ordered(QUANTITIES)] = Field(
        description="The axes that are reduced; all other axes stay.",
        min_length=1,
        max_length=MAX_NAMES,
    )
    statistics: Annotated[
        tuple[
            Annotated[
                str, PlainValidator(_read_statistic), WithJsonSchema({"enum": list(STATISTICS)})
            ],
            ...,
        ],
        at_most(MOST),
        _ordered(STATISTICS),
    ] = Field(
        (),
        description="Statistics of each output: max, min, mean, and where the largest and least "
        "value lie (argmax, argmin: one variable for each axis that goes).",
        max_length=MOST,
    )
    of: Annotated[tuple[_Known, ...], at_most(MAX_NAMES)] = Field(
        (),
        description="The outputs of statistics and quantiles; all by default.",
        max_length=MAX_NAMES,
    )
    quantiles: Annotated[
        tuple[
            Annotated[
                float,
                PlainValidator(_read_quantile),
                WithJsonSchema({"type": "number", "minimum": 0, "maximum": 1}),
            ],
            ...,
        ],
        at_most(MAX_NAMES),
        AfterValidator(lambda q: tuple(sorted({*q}))),
    ] = Field((), description="Quantiles of each output, from 0 to 1.", max_length=MAX_NAMES)
    cells: Literal["valid", "all"] = Field(
        "valid",
        description="Which cells count: those whose regime describes a real part, or all. Cells "
        "without a value count in neither.",
    )
    regimes: bool = Field(
        False, description="True to count the cells in each regime, valid or not.", strict=True
    )
    shares: Annotated[dict[_Name, _Conditions], _BY_NAME] = Field(
        {},
        description="Named shares: for each name, conditions; the result is the "
        "share of cells that meet all.",
        max_length=MOST,
    )
    levels: Annotated[dict[_Name, LevelSet], _BY_NAME] = Field(
        {},
        description="Named levels: for each name, the output and level whose crossing is located.",
        max_length=MOST,
    )
