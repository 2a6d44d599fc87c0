"""Impacts of two bodies: 100,000 random ones for each law and shape.

Tolerances: each is 1e-12 of the sum of the magnitudes that cancel in what is compared (momenta of
both bodies, velocities of both at the contact). A few dozen operations with a rounding error of
1.1e-16 each stay below 1e-14 of it; the rest is for badly matched masses and arms.
"""

from __future__ import annotations

import numpy as np

from night import count
from plans import make_plan
from vibrafeed.core.plan.plan import Verdict, regimes_of
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes import SCENES

IMPACTS = count(20_000, 100_000)
BLOCK = 8_192  # points at a time, which stay in the processor's cache
CLOSE = 1e-12
LAWS = ["frictionless", "pfeiffer_glocker", "moreau"]


def evaluate(scene: str, law: str, points: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return every quantity of a law at the points, and the regime's numbers, block by block."""
    size = len(points["mass_1"])
    pieces = [slice(start, min(start + BLOCK, size)) for start in range(0, size, BLOCK)]
    blocks = [evaluate_block(scene, law, {k: v[p] for k, v in points.items()}) for p in pieces]
    lengths = [piece.stop - piece.start for piece in pieces]
    return {name: joined([block[name] for block in blocks], lengths) for name in blocks[0]}


def joined(parts: list, lengths: list[int]):
    """Return arrays, or bundles of arrays, end to end."""
    if isinstance(parts[0], tuple):
        fields = [joined(list(field), lengths) for field in zip(*parts, strict=True)]
        kind = type(parts[0])
        return kind(*fields) if hasattr(kind, "_fields") else tuple(fields)
    filled = [np.broadcast_to(part, (n,)) for part, n in zip(parts, lengths, strict=True)]
    return np.concatenate(filled)


def evaluate_block(scene: str, law: str, points: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    outputs = SCENES[scene].outputs(law)
    given = {k: v for k, v in points.items() if law != "frictionless" or k != "friction"}
    plan = make_plan(scene, law, outputs, list(given))
    known = {name: np.asarray(value) for name, value in {**plan.defaults, **given}.items()}
    for equation in plan.equations:
        known[equation.gives] = equation.function(**{n: known[n] for n in equation.inputs})
    whole = Verdict("regime", tuple(outputs), plan.conditions)
    found = regimes_of([whole], known)["regime"]
    known["regime"] = np.broadcast_to(found, (len(points["mass_1"]),))
    return known


def where(known: dict, *names: str) -> np.ndarray:
    return np.isin(known["regime"], [REGIMES[name].value for name in names])


def mirrored(points: dict, names: tuple[str, ...]) -> dict:
    return {k: -v if k.rsplit("_", 1)[0] in names else v for k, v in points.items()}


def swapped(points: dict) -> dict:
    other = {"1": "2", "2": "1"}
    return {k[:-1] + other[k[-1]] if k[-1] in other else k: v for k, v in points.items()}
