"""D and C, dice and coins: measured shares of throws, beside those of let-down and thrown parts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from vibrafeed.core.assurance.case import Case, Term, Truth

WITHIN = 0.03
"""A measured share lies within this of the bracket of both shares, of most dice."""


class Throws(NamedTuple):
    """Throws of one die or coin.

    Attributes
    ----------
    ratio : float
        Size along the axis over that across it: x/y of a cuboid x by y by y, height over diameter
        of a coin.
    share : float
        Measured share that came to rest on either square of a cuboid, on the side of a coin.
    throws : int
        Number of throws; 0 where the source does not tell it.
    """

    ratio: float
    share: float
    throws: int = 0


DICE = (
    Throws(0.47, 0.916, 332), Throws(0.63, 0.738, 840), Throws(0.75, 0.548, 799),
    Throws(0.81, 0.496, 740), Throws(0.93, 0.399, 516), Throws(0.97, 0.385, 530),
    Throws(1.16, 0.148, 1011), Throws(1.23, 0.154, 532), Throws(1.44, 0.052, 654),
    Throws(1.55, 0.040, 606), Throws(1.60, 0.017, 702), Throws(1.71, 0.031, 609),
    Throws(1.87, 0.009, 680), Throws(2.12, 0.007, 275), Throws(2.65, 0.006, 503),
)  # fmt: skip
COINS = (Throws(0.354, 0.132), Throws(0.577, 0.410))
SOURCES: Mapping[str, str] = {
    "D": "The Mathematical Gazette 97.16, 2013, table 1",
    "C": "throws of M. Parker, in the repository iaroslav-ai/coin-experiment",
}
DICE_LEFT = 0.032
"""The most that the shares of thrown parts may leave in all dice, root of the mean square."""
WAYS = {"let-down": "let_down_share", "thrown": "thrown_share"}


def term_of(family: str, thrown: Throws, way: str) -> Term:
    """Return the share of a die's squares, or of a coin's side, as a term of a result.

    `family` is D for dice, C for coins; `way` a key of `WAYS`.
    """
    if family == "D":
        variant, aspect = "box", "on_end"
        sizes = {"length": thrown.ratio, "width": 1.0, "height": 1.0}
    else:
        variant, aspect = "cylinder", "on_side"
        sizes = {"length": thrown.ratio, "diameter": 1.0}
    output = f"{WAYS[way]}_{aspect}"
    study = {"kind": "sweep", "scene": "resting-part", "variant": variant, "outputs": [output],
             "parameters": {name: 0.01 * size for name, size in sizes.items()}}  # fmt: skip
    return Term(study, output)


def dice() -> Iterator[Case]:
    """Yield two cases for each die, let down and thrown, and one for the scatter of all.

    The share of both squares of a cuboid is shown beside the measured one, and not judged alone.
    The last case judges the root mean square of what the shares of thrown parts leave.
    """
    for number, die in enumerate(DICE, 1):
        for way in WAYS:
            yield _case(
                f"D-{way}-{number}",
                f"Steel cuboid {die.ratio:g} : 1 : 1, {die.throws:,} throws: squares, {way}",
                die,
                (term_of("D", die, way),),
                relation="shown",
                why="not judged alone: the truth lies between let down and thrown",
            )
    terms = (
        Term(term.study, term.output, minus=die.share)
        for die, term in ((die, term_of("D", die, "thrown")) for die in DICE)
    )
    yield Case(
        id="D-scatter-1",
        family="D",
        title=f"Root mean square of what shares of thrown parts leave in {len(DICE)} cuboids",
        terms=tuple(terms),
        known=Truth(DICE_LEFT, 0.0, SOURCES["D"]),
        evidence="measured",
        inputs={"throws": float(sum(die.throws for die in DICE))},
        relation="at most",
        why="the bar that the formula, which has no fitted number, was held to",
        combine="rms",
    )


def coins() -> Iterator[Case]:
    """Yield two cases for each coin: what is measured lies between thrown and let down."""
    for number, coin in enumerate(COINS, 1):
        for way, relation in (("let-down", "at least"), ("thrown", "at most")):
            yield _case(
                f"C-{way}-{number}",
                f"Coin, height over diameter {coin.ratio:g}: side, {way}",
                coin,
                (term_of("C", coin, way),),
                relation=relation,
                why="the truth lies between let down and thrown",
            )


def _case(
    name: str, title: str, thrown: Throws, terms: tuple[Term, ...], *, relation: str, why: str
) -> Case:
    """Return a case beside the measured share."""
    return Case(
        id=name,
        family=name[0],
        title=title,
        terms=terms,
        known=Truth(thrown.share, 0.0, SOURCES[name[0]]),
        evidence="measured",
        inputs={"ratio": thrown.ratio},
        relation=relation,
        why=why,
    )
