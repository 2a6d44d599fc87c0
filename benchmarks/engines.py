"""Prints mean velocities of general physics engines beside known ones: a block on a vibrating
plate in MuJoCo, PyBullet and pymunk, as far as they are installed: `python -m benchmarks.engines`.

`--study FILE` sets them beside our methods on cells of a planar study without restitution, as
`vibrafeed report` does with our methods alone.
"""  # noqa: D205

from __future__ import annotations

import argparse
import importlib.metadata
import math
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.plate_engines import (
    AVERAGED,
    ENGINES,
    TRANSIENT,
    Drive,
    engine_velocity,
    installed,
)
from benchmarks.worked_values import REFERENCE_SPEEDS
from core.assurance.accuracy import motion
from core.assurance.accuracy.curves import Curve
from core.intake import load_study
from core.kinds.results import prepare
from core.mechanics.arrays import Array
from core.plan.equations import run_equations
from core.plan.plan import plan_scene
from core.scenes import Scene
from core.watch import Watch

GRAVITY = 9.81  # m s-2
BETA = math.radians(30.0)
ENGINE_STEPS = (200, 2000)  # a period, on the cells of a study
ENGINE_INPUTS = (
    "frequency", "amplitude", "beta", "gamma", "friction_static", "friction_kinetic", "gravity",
    "restitution", "hold_down_number",
)  # fmt: skip
FINE, FINER = 1e-4, 1e-5  # s: 200 and 2,000 steps a period


@dataclass(frozen=True)
class Case:
    """A drive of 50 Hz, at 30 degrees to the track, with a friction of 0.5.

    Attributes
    ----------
    name : str
    throw_number : float
        Largest acceleration of the plate normal to itself, over that of gravity.
    gamma : float
        Incline of the track, degrees.
    velocity : float
        Known mean velocity [m s-1], of core/assurance.
    """

    name: str
    throw_number: float
    gamma: float
    velocity: float

    @property
    def drive(self) -> Drive:
        """The track and its drive."""
        gamma, frequency = math.radians(self.gamma), 50.0
        largest = self.throw_number * GRAVITY * math.cos(gamma) / math.sin(BETA)
        amplitude = largest / (2 * math.pi * frequency) ** 2
        return Drive(frequency, amplitude, BETA, gamma, 0.5, GRAVITY)


CASES = tuple(
    Case(speed.name, speed.throw_number, speed.gamma, speed.value / 1e3)
    for speed in (REFERENCE_SPEEDS["hop"], REFERENCE_SPEEDS["stick-slip"])
)


@dataclass(frozen=True)
class Row:
    """One line of the table; the time is that of one configuration."""

    engine: str
    version: str
    case: Case
    step: str
    seconds: float
    velocity: float  # m s-1


def engine_rows(name: str) -> list[Row]:
    """Return the lines of one engine; none where it is not installed, which is printed."""
    if name not in installed():
        print(f"{name} is not installed: pip install {name}")
        return []
    _, usual = ENGINES[name]
    version = importlib.metadata.version(name)
    rows = []
    for case in CASES:
        for step in (usual, FINE, FINER):
            start = time.perf_counter()
            found = engine_velocity(name, case.drive, step)
            seconds = time.perf_counter() - start
            rows.append(Row(name, version, case, f"{step:.2g} s", seconds, found))
    return rows


def ours() -> list[Row]:
    """Return the lines of this project's methods."""
    from benchmarks.lockstep import lockstep_velocities
    from benchmarks.motions import planar_motion, regularised_motion
    from core import __version__

    def by_events(groups: dict[str, float]) -> float:
        return float(planar_motion(**groups, tolerance=1e-12, most_periods=1000).velocity)

    def by_steps(groups: dict[str, float]) -> float:
        names = ("drive_number_along", "drive_number_normal", "gravity_number_along",
                 "gravity_number_normal", "friction_kinetic", "restitution")  # fmt: skip
        return float(lockstep_velocities(*(groups[name] for name in names)))

    def by_regularising(groups: dict[str, float]) -> float:
        motion = regularised_motion(
            **groups, drive_number_across=0.0, gravity_number_across=0.0, slip_speed=1e-6,
            contact_stiffness=1e10, tolerance=1e-7, most_periods=100, solver="Radau", planar=True,
        )  # fmt: skip
        return float(motion.velocity)

    rows = []
    for case in CASES:
        drive = case.drive
        number = drive.amplitude * drive.circular**2 / GRAVITY
        groups = {
            "drive_number_along": number * drive.line[0],
            "drive_number_normal": number * drive.line[1],
            "gravity_number_along": -drive.gravity[0] / GRAVITY,
            "gravity_number_normal": -drive.gravity[1] / GRAVITY,
            "friction_kinetic": drive.friction,
            "friction_static": drive.friction,
            "restitution": 0.0,
        }
        for name, step, velocity in (
            ("events", "events", by_events),
            ("lockstep", f"{1 / drive.frequency / 1600:.2g} s", by_steps),
            ("regularised", "adaptive", by_regularising),
        ):
            velocity(groups)  # compiles
            start = time.perf_counter()
            found = velocity(groups)
            seconds = time.perf_counter() - start
            scale = GRAVITY / drive.circular
            rows.append(Row(name, __version__, case, step, seconds, found * scale))
    return rows


def engine_curves(
    scene: Scene,
    cells: Mapping[str, Array],
    truth: Array,
    hops: NDArray[np.bool_],
    watch: Watch,
) -> tuple[list[Curve], list[str]]:
    """Return what general physics engines find, by their steps, and what to say of them."""
    names = installed()
    if not names:
        return [], []
    first = motion.one_of_each(hops)
    plan = plan_scene(scene, "events", ("conveying_velocity",), tuple(cells))
    found = run_equations(plan, {name: cells[name][first] for name in plan.parameters})
    known = {name: np.broadcast_to(found[name], first.size) for name in ENGINE_INPUTS}
    if np.any(known["restitution"]) or np.any(
        known["friction_static"] != known["friction_kinetic"]
    ):
        return [], ["Engines: left out; what they make of bouncing parts and of two coefficients "
                    "of friction differs in kind."]  # fmt: skip
    if np.any(known["hold_down_number"]):
        return [], ["Engines: left out; they are not told of a force that holds the part down."]
    curves = []
    for name in names:
        points = []
        for steps in ENGINE_STEPS:
            if watch.stopped():
                break
            shares = np.empty(first.size)
            started = time.perf_counter()
            for cell in range(first.size):
                one = {key: float(values[cell]) for key, values in known.items()}
                drive = Drive(
                    one["frequency"], one["amplitude"], one["beta"], one["gamma"],
                    one["friction_kinetic"], one["gravity"],
                )  # fmt: skip
                step = 1 / (drive.frequency * steps)
                velocity = engine_velocity(name, drive, step)
                shares[cell] = velocity / (drive.amplitude * drive.circular)
            seconds = (time.perf_counter() - started) / first.size
            none = np.full(first.size, np.nan)
            run = motion.Means(shares, none, hops[first], hops[first], seconds)
            points.append(motion.point_of(f"{steps} steps", steps, run, truth[first]))
        curve = Curve(
            "motion",
            f"{motion.kinds_of(hops)} cells",
            name,
            tuple(p for p in points if p),
            of="largest",
        )
        if curve.points:
            curves.append(curve)
    versions = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in names)
    remark = (
        f"Engines: {versions}, on the first of these cells of each kind ({motion.kinds_of(hops)}); "
        f"the mean over {AVERAGED} periods after {TRANSIENT}."
    )
    return curves, [remark]


def print_known() -> None:
    """Print the configurations of known velocity."""
    rows = [row for name in ENGINES for row in engine_rows(name)] + ours()
    print(
        f"{'engine':12} {'version':>8}  {'case':10} {'step':>9} {'time':>9} {'velocity':>12} "
        f"{'known':>10}  error"
    )
    for row in sorted(rows, key=lambda row: row.case.name):
        known = row.case.velocity
        print(
            f"{row.engine:12} {row.version:>8}  {row.case.name:10} {row.step:>9} "
            f"{1e3 * row.seconds:7.2f} ms {1e3 * row.velocity:7.3f} mm/s {1e3 * known:10.6f}  "
            f"{100 * (row.velocity / known - 1):+9.4f} %"
        )


def print_study(path: Path) -> None:
    """Print error and time of our methods and of the engines, on cells of a simulation."""
    prepared = prepare(load_study(path))
    measured = motion.measure(prepared, Watch(), rivals=engine_curves)
    for curve in measured.curves:
        for point in curve.points:
            print(
                f"{curve.method:16} {curve.subject:26} {point.setting:20} of {point.error:8.1e}, "
                f"largest {point.largest:8.1e}  {1e3 * point.seconds:9.3f} ms"
            )
    print(*measured.notes, sep="\n")


def main() -> None:
    """Print the known configurations, or the cells of a study."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--study", type=Path, help="a simulation")
    path = parser.parse_args().study
    print_known() if path is None else print_study(path)


if __name__ == "__main__":
    main()
