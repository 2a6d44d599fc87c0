"""Y, a rail of cast iron: 67 measured speeds under two-level waves, against the formula of Q.

One number was fitted to 43 of them, kappa = mu_k/m, since nothing in the data tells the moving
mass: the studies take a mass of 1 kg, on which the speed does not depend.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

from vibrafeed import core
from vibrafeed.core.assurance.case import Case, Term, Truth
from vibrafeed.core.assurance.forms.formulas import GRAVITY, two_levels_terms

FILE = Path(core.__file__).resolve().parent.parent / "configs" / "rail-of-cast-iron.csv"
KAPPA = 0.558  # per kg
FRICTIONS = 0.44 / 0.34
"""Static over kinetic, as printed."""
CONTACT = 38.0  # N; below, the authors lose contact of the plane
SCATTER = 3.06  # mm/s, root of the mean square of what the fit leaves
SOURCE = "D. Yako, Y. Yuan, K. Salisbury, 2026, arXiv 2605.30780; the speeds are our reduction"
WORDS = (
    "A rail stands upright; it is clamped by a measured force F and driven by two-level waves. "
    "Formula Q with a_k = kappa F + g and kappa = 0.558 per kg, fitted once to all runs with "
    "F >= 38 N, is set beside the measured speed."
)

INPUTS = {
    "frequency": "Hz",
    "a_s": "g; the gentle level",
    "a_m": "g; the sharp level",
    "force": "N; F, which clamps the rail",
    "speed": "mm/s, as measured",
}


@cache
def runs() -> tuple[Mapping[str, float], ...]:
    """Return the measured runs: frequency, both accelerations, force and speed of each."""
    with FILE.open(encoding="utf-8", newline="") as lines:
        rows = csv.DictReader(line for line in lines if not line.startswith("#"))
        return tuple({name: float(value) for name, value in row.items()} for row in rows)


def cases() -> Iterator[Case]:
    """Yield a case for each measured run of the rail, and one for the scatter of all.

    A run is shown beside the formula of two-level waves, and not judged alone. The last case judges
    the root mean square of what the formula leaves in the runs with enough contact force [mm/s].
    """
    judged = []
    for number, run in enumerate(runs(), 1):
        (term,) = two_levels_terms(_inputs_of(run))
        on = run["force"] >= CONTACT
        judged += [Term(term.study, term.output, times=term.times, minus=run["speed"])] * on
        yield Case(
            id=f"Y-run-{number}",
            family="Y",
            title=_title(run) + ("" if on else ", contact lost"),
            terms=(term,),
            known=Truth(run["speed"], SCATTER, SOURCE),
            evidence="measured",
            unit="mm/s",
            inputs=run,
            relation="shown",
            why="not judged alone: the scatter of the fit"
            if on
            else "not judged: below 38 N the authors lose contact of the plane",
        )
    yield Case(
        id="Y-scatter-1",
        family="Y",
        title=f"Root mean square of what the formula leaves in {len(judged)} runs, F >= 38 N",
        terms=tuple(judged),
        known=Truth(SCATTER, 0.1, "our fit of one number to the same runs"),
        evidence="measured",
        unit="mm/s",
        inputs={"kappa": KAPPA},
        why="rounding of the table and of kappa",
        digits="3.06",
        combine="rms",
    )


def _title(run: Mapping[str, float]) -> str:
    """Return the title of a run."""
    levels = f"{run['a_s']:g} g and {run['a_m']:g} g"
    return f"{run['frequency']:g} Hz, {levels}, {run['force']:g} N"


def _inputs_of(run: Mapping[str, float]) -> dict[str, float]:
    """Return the inputs of the two-level formula for a run of the rail, with a part of 1 kg.

    `run` has `frequency` [Hz], the levels `a_s` and `a_m` in g and the clamping `force` [N].
    Frictions stand for mu/m, as the moving mass is not known.
    """
    return {
        "frequency": run["frequency"],
        "gentle": run["a_s"],
        "sharp": run["a_m"],
        "friction_static": KAPPA * FRICTIONS,
        "friction_kinetic": KAPPA,
        "gamma": 90.0,
        "hold_down": run["force"] / GRAVITY,
    }
