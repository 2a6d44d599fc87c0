"""R, on which side a part comes to rest if it is let down with negligible momentum."""

from __future__ import annotations

import math

from numpy.random import Generator

from vibrafeed.core.assurance.case import Term
from vibrafeed.core.assurance.forms.formulas import Formula, Inputs

WIDE = 1e12
"""Of a box that stands for a plane rectangle, over its length."""


def _share(shape: str, output: str, **sizes: float) -> tuple[Term, ...]:
    """Return the terms of a share of let-down parts."""
    study = {"kind": "sweep", "scene": "resting-part", "variant": shape, "outputs": [output],
             "parameters": sizes}  # fmt: skip
    return (Term(study, output),)


def box_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the terms of the share that rests flat, for a face of length by width."""
    sizes = {"length": inputs["a"], "width": inputs["b"], "height": inputs["c"]}
    return _share("box", "let_down_share_flat", **sizes)


def box(inputs: Inputs) -> float:
    """Return the share that rests flat, (2/pi) atan(a b/(c sqrt(a^2 + b^2 + c^2)))."""
    a, b, c = inputs["a"], inputs["b"], inputs["c"]
    return 2 / math.pi * math.atan(a * b / (c * math.sqrt(a * a + b * b + c * c)))


def random_box(random: Generator) -> dict[str, float]:
    """Return random sizes within two orders of magnitude."""
    return {name: 10.0 ** float(random.uniform(-3, -1)) for name in "abc"}


def cylinder_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the terms of the share that rests on the round side."""
    return _share("cylinder", "let_down_share_on_side", **inputs)


def cylinder(inputs: Inputs) -> float:
    """Return the share that rests on the round side, l/sqrt(l^2 + d^2)."""
    return inputs["length"] / math.sqrt(inputs["length"] ** 2 + inputs["diameter"] ** 2)


def random_cylinder(random: Generator) -> dict[str, float]:
    """Return random sizes within two orders of magnitude."""
    return {name: 10.0 ** float(random.uniform(-3, -1)) for name in ("length", "diameter")}


def rectangle_terms(inputs: Inputs) -> tuple[Term, ...]:
    """Return the terms of the share that rests flat, for a box too wide for its other faces."""
    sizes = {"length": inputs["long"], "width": WIDE * inputs["long"], "height": inputs["short"]}
    return _share("box", "let_down_share_flat", **sizes)


def rectangle(inputs: Inputs) -> float:
    """Return the share that rests flat, (2/pi) atan(long/short)."""
    return 2 / math.pi * math.atan(inputs["long"] / inputs["short"])


def random_rectangle(random: Generator) -> dict[str, float]:
    """Return a random short and a random long side."""
    short = 10.0 ** float(random.uniform(-3, -1))
    return {"long": short * float(random.uniform(1, 20)), "short": short}


FORMULAS = {
    "R-box": Formula(box_terms, box, random_box),
    "R-cylinder": Formula(cylinder_terms, cylinder, random_cylinder),
    "R-rectangle": Formula(rectangle_terms, rectangle, random_rectangle),
}
