"""Prints mean velocities of general physics engines beside known ones: a block on a vibrating
plate in MuJoCo, PyBullet and pymunk, as far as they are installed: `python -m benchmarks.engines`.
"""  # noqa: D205

from __future__ import annotations

import importlib.metadata
import math
import time
from dataclasses import dataclass

from benchmarks.worked_values import REFERENCE_SPEEDS
from core.accuracy.engines import ENGINES, Drive, engine_velocity, installed

GRAVITY = 9.81  # m s-2
BETA = math.radians(30.0)
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
        Known mean velocity [m s-1], of core/validation.
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


def main() -> None:
    """Print the table."""
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


if __name__ == "__main__":
    main()
