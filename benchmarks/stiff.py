"""Stiff and extreme cases: scipy's Radau, BDF and LSODA on regularised contact, beside the events.

`python -m benchmarks.stiff` writes docs/generated/stiff.md and its picture: error over run time.
Friction is a steep function of the slip speed v, the floor a stiff spring with a damper:

    F = -mu N v/sqrt(v^2 + s^2),    N = max(0, -k z - d min(1, -k z/onset) z'),

with the slip speed s and the stiffness k. The exact laws come back for s to 0 and k to infinity.
"""

from __future__ import annotations

import math
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from benchmarks.motions import follow
from vibrafeed.core.scenes.soft_contact import damping_of_restitution

PAGE = Path(__file__).parents[1] / "docs" / "generated" / "stiff.md"
SOLVERS = ("Radau", "BDF", "LSODA")
TURN, STEPS, CELLS = 2 * math.pi, 100, 2000
SPAN = 1e-5  # rad that the explicit integrator is followed
PEAK = 3.0  # slip speeds up to which friction holds by creep; there it is the static one
MAX_PERIODS, MAX_EVALUATIONS = 60, 1_000_000


class Cell(NamedTuple):
    """One part in the plane, the amplitude and its mean velocity [m/s], to 14 digits."""

    amplitude: float
    beta: float
    static: float
    kinetic: float
    exact: float
    frequency: float = 60.0
    gravity: float = 9.8

    @property
    def unit(self) -> float:
        """The unit of velocity, g/w [m/s]."""
        return self.gravity / (TURN * self.frequency)

    @property
    def push(self) -> tuple[float, float]:
        """The drive's acceleration along and normal, in g."""
        size = self.amplitude / self.gravity * (TURN * self.frequency) ** 2
        return size * math.cos(math.radians(self.beta)), size * math.sin(math.radians(self.beta))

    def groups(self, **changes: Any) -> dict[str, Any]:
        """Return the dimensionless groups, for the methods of `vibrafeed`."""
        along, normal = self.push
        return {
            "drive_number_along": along, "drive_number_normal": normal,
            "gravity_number_along": 0.0, "gravity_number_normal": 1.0,
            "friction_static": self.static, "friction_kinetic": self.kinetic, **changes,
        }  # fmt: skip


CASES = {
    "stick-slip": Cell(24e-6, 20.0, 0.35, 0.25, 4.3067566120832e-4),
    "hop": Cell(4e-4, 25.0, 0.4, 0.4, 0.12799649244377),
}
SLIPS, STIFFNESSES = (1e-3, 1e-6, 1e-9, 1e-12), (1e6, 1e10, 1e14)


class SpentError(Exception):
    """All evaluations are used."""


class Stiff:
    """One part under regularised laws: x, z and their rates, in g/w^2 and g/w; counts its work."""

    def __init__(self, cell: Cell, slip: float, stiffness: float) -> None:
        """Set the damping that lets nothing rebound, and the height of the peak of friction."""
        self.push, self.slip, self.stiffness, self.spent = cell.push, slip, stiffness, 0
        most = max(1.0, (math.sqrt(stiffness) / 8) ** (1 / 3))
        ratio = min(most, float(damping_of_restitution(restitution=np.zeros(()))))
        self.damping = 2 * ratio * math.sqrt(stiffness)
        self.onset, self.kinetic = max(1.0, 1e-4 * math.sqrt(stiffness)), cell.kinetic
        peak = cell.static * math.sqrt(1 + PEAK**2) / PEAK
        self.extra = peak - cell.kinetic if cell.static > cell.kinetic else 0.0
        self.width = 2 * (1 + PEAK**2) * self.extra / peak * (PEAK * slip) ** 2
        self.rest = np.array([0.0, -1 / stiffness, 0.0, 0.0])

    def friction(self, v: float) -> tuple[float, float]:
        """Return friction over (load times speed), and its derivative by v over v."""
        root = math.sqrt(v * v + self.slip**2)
        value, slope = self.kinetic / root, -self.kinetic / root**3
        if self.extra:  # a Gaussian of the speed, so that the peak is the static one
            bump = self.extra * math.exp(((PEAK * self.slip) ** 2 - v * v) / self.width)
            value += bump / root
            slope -= bump / root**3 + 2 * bump / (self.width * root)
        return value, slope

    def load(self, z: float, rate: float) -> tuple[float, float, float]:
        """Return the floor's force over the weight, and its derivatives by height and rate."""
        spring = -self.stiffness * z
        share = min(1.0, spring / self.onset)
        force = spring - self.damping * share * rate
        if z >= 0 or force <= 0:
            return 0.0, 0.0, 0.0
        more = self.damping * self.stiffness * rate / self.onset if share < 1 else 0.0
        return force, more - self.stiffness, -self.damping * share

    def rate(self, phase: float, state: np.ndarray) -> list[float]:
        """Return the derivative of the state by the phase [rad]."""
        self.spent += 1
        if self.spent > MAX_EVALUATIONS:
            raise SpentError
        _, z, u, w = state.tolist()
        force, sine = self.load(z, w)[0], math.sin(phase)
        along = self.push[0] * sine - (force * self.friction(u)[0] * u if force else 0.0)
        return [u, w, along, self.push[1] * sine - 1.0 + force]

    def jacobian(self, _: float, state: np.ndarray) -> np.ndarray:
        """Return the derivative of `rate` by the state."""
        _, z, u, w = state.tolist()
        matrix = np.zeros((4, 4))
        matrix[0, 2] = matrix[1, 3] = 1.0
        force, by_z, by_w = self.load(z, w)
        if force:
            value, slope = self.friction(u)
            matrix[2] = 0.0, -value * u * by_z, -force * (value + slope * u * u), -value * u * by_w
            matrix[3, 1], matrix[3, 3] = by_z, by_w
        return matrix

    def period(self, state: np.ndarray, solver: str, tolerance: float, whole: float = TURN) -> Any:
        """Return the state after a period, or the first `whole` rad of it, counted from x = 0."""
        scale = tolerance * np.array([1.0, 1 / self.stiffness, min(1.0, 10 * self.slip), 1.0])
        settings: dict[str, Any] = {"rtol": tolerance, "atol": scale, "max_step": TURN / STEPS}
        if solver != "RK45":
            settings["jac"] = self.jacobian
        phase, state = 0.0, np.array([0.0, *state[1:]])
        while phase < whole:  # a new start has steps as short as need be
            run = solve_ivp(
                lambda since, y, start=phase: self.rate(start + since, y),
                (0.0, whole - phase), state, method=solver, **settings,
            )  # fmt: skip
            state, phase = run.y[:, -1], whole if run.success else phase + run.t[-1]
        return state

    def mean(self, solver: str, tolerance: float) -> float:
        """Return the mean velocity once a period is like the one before; NaN if none is."""
        closeness, state = max(0.1 * self.slip, 100 * tolerance), self.rest
        for _ in range(MAX_PERIODS):
            before, state = state, self.period(state, solver, tolerance)
            if np.abs(state - before).max() < closeness:
                return float(state[0]) / TURN
        return math.nan


def measured(case: str, solver: str, slip: float, stiffness: float) -> tuple[float, float, int]:
    """Return error [of the mean], processor time [s] and evaluations of a stiff integrator."""
    cell, begin = CASES[case], time.process_time()
    part = Stiff(cell, slip, stiffness)
    try:
        mean = part.mean(solver, min(1e-6, slip / 10) if slip >= 1e-6 else 1e-7)
    except SpentError:
        mean = math.nan
    error = abs(mean * cell.unit / cell.exact - 1)
    return error, time.process_time() - begin, part.spent


def ours(case: str, method: str, cells: int) -> tuple[float, float]:
    """Return the error of a method of `vibrafeed`, and its processor time a cell [s]."""
    cell = CASES[case]
    near = cell.kinetic * (1 + 1e-9 * np.arange(cells))
    groups = cell.groups(friction_kinetic=near, friction_static=near + cell.static - cell.kinetic)
    settings: dict[str, Any] = {"max_periods": np.array(100.0)}
    if method == "events":
        settings["tolerance"] = np.array(1e-12)
    follow(method, **cell.groups(), **settings)  # compiles
    begin = time.process_time()
    found = follow(method, **groups, **settings)
    took = (time.process_time() - begin) / cells
    return abs(float(found.velocity[0]) * cell.unit / cell.exact - 1), took


def crawling() -> float:
    """Return the evaluations of RK45 in a period over those of Radau, at a slip speed of 1e-9."""
    explicit, implicit = (Stiff(CASES["stick-slip"], 1e-9, 1e4) for _ in range(2))
    explicit.period(explicit.rest, "RK45", 1e-6, SPAN)
    implicit.period(implicit.rest, "Radau", 1e-6)
    return explicit.spent * TURN / SPAN / implicit.spent


def main() -> None:
    """Write the page and the picture."""
    rows, figure = [], Figure(figsize=(9, 3.6), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    for axes, case in zip(panels, CASES, strict=True):
        for method, cells, mark in (("events", CELLS, "*"), ("reference", 1, "P")):
            error, took = ours(case, method, cells)
            rows.append(f"| {case} | `{method}` | - | {error:.1e} | {took:.1e} | - |")
            axes.loglog(took, max(error, 1e-16), mark, markersize=10, label=method)
        for solver in SOLVERS:
            asked = [(s, 1e8) for s in SLIPS] if case == "stick-slip" else [
                (1e-4, k) for k in STIFFNESSES]  # fmt: skip
            points = [measured(case, solver, *pair) for pair in asked]
            for (slip, stiffness), (error, took, spent) in zip(asked, points, strict=True):
                law = f"slip {slip:.0e}" if case == "stick-slip" else f"stiffness {stiffness:.0e}"
                told = "none" if math.isnan(error) else f"{error:.1e}"
                rows.append(f"| {case} | {solver} | {law} | {told} | {took:.1e} | {spent:,} |")
            axes.loglog(*zip(*((took, error) for error, took, _ in points), strict=True), "o-",
                        label=solver)  # fmt: skip
        axes.set(title=case, xlabel="processor time a cell (s)")
    panels[0].set_ylabel("error of the mean velocity")
    panels[1].legend(fontsize=8)
    figure.savefig(PAGE.with_suffix(".png"), dpi=100)
    head, rule = "| case | by | law | error | s a cell | evaluations |", "| --- " * 6 + "|"
    PAGE.write_text(
        "# Stiff and extreme cases\n\nWritten by `python -m benchmarks.stiff`. scipy's implicit "
        "integrators follow regularised contact: friction is a steep function of the slip speed "
        "(in g/w), the floor a stiff spring (over m w^2) with a damper. Errors are shares of a "
        "mean velocity that is known to 14 digits; none: a million evaluations are used up.\n\n"
        "![error over run time](stiff.png)\n\n"
        + "\n".join([head, rule, *rows])
        + f"\n\nAt a slip speed of 1e-9 the explicit RK45 needs {crawling():,.0f} times the "
        "evaluations of Radau.\n",
        encoding="utf-8",
    )


if __name__ == "__main__":
    main()
