"""Prints how far predicted courses of a part lie from ten that were tracked.

Yako, Nowak, Yuan and Salisbury, 2025, arXiv 2502.05693: a part of 9 g is pressed onto an
upright surface, whose impacts lift it; a camera tracks both. Their raw data are public and not part
of vibrafeed: the folder `matlab/data` of the repository
clyako/vertical-vibratory-transport-of-grasped-parts-using-impacts.
`python -m benchmarks.tracked_courses FOLDER` reads it. The recorded motion of the surface is
followed once; the position of the part is that on the surface added to the tracked surface.
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import vibrafeed

MASS, GRAVITY, STATIC = 0.009, 9.81, 0.72
MEASURED = (0.59, (11.089, 16.901, *[5.278] * 7, 22.841))
"""Kinetic friction, and the force onto the surface of each run over the weight: as published."""
FITTED = (
    0.6234,
    (10.65, 13.0009, 9.9833, 6.7872, 6.0413, 7.0798, 6.2765, 6.618, 7.1825, 8.2225),
)
"""The same, fitted to these courses by the authors."""
FIRST, LAST = 3, -2
"""The samples that their program uses, without those that have no acceleration."""


class Course(NamedTuple):
    """Times [s], upward velocity of the surface [m s-1], and positions [m] of both."""

    times: NDArray[np.float64]
    velocity: NDArray[np.float64]
    surface: NDArray[np.float64]
    part: NDArray[np.float64]


def read_course(path: Path) -> Course:
    """Return a course from a table with the columns t [s], vzp [mm s-1], zp and zo [mm]."""
    rows = [*csv.DictReader(path.read_text("latin-1").splitlines())][FIRST:LAST]
    times, velocity, surface, part = (
        np.array([float(row[name]) for row in rows]) for name in ("t", "vzp", "zp", "zo")
    )
    return Course(
        times - times[0],
        1e-3 * velocity,
        1e-3 * (surface - surface[0]),
        1e-3 * (part - part[0]),
    )


def predicted(course: Course, kinetic: float, force: float) -> NDArray[np.float64]:
    """Return the positions of a part [m] that is pressed on with a force over its weight."""
    rows = zip(course.times.tolist(), course.velocity.tolist(), strict=True)
    text = "\n".join(["time [s],up [m/s]", *(f"{time},{up}" for time, up in rows)])
    found = vibrafeed.simulate(
        scene="rectangle-on-plane",
        drive={"data": text, "along": "up", "once": True},
        outputs=["burst_displacement"],
        trajectory=course.times.tolist(),
        gamma=90,
        gravity=GRAVITY,
        mass=MASS,
        hold_down_force=force * MASS * GRAVITY,
        friction_static=STATIC,
        friction_kinetic=kinetic,
    )
    moved: NDArray[np.float64] = found["position_along"].values
    return course.surface + moved


def position_error(course: Course, positions: NDArray[np.float64]) -> float:
    """Return the mean error of the positions of a part [m]."""
    return float(np.mean(np.abs(positions - course.part)))


def main() -> None:
    """Print the table and its means."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="with Trial #1.csv to Trial #10.csv")
    folder = parser.parse_args().folder
    print("| inputs | run | tracked [mm] | predicted [mm] | error [mm] | of the largest travel |")
    print("| --- | --- | --- | --- | --- | --- |")
    for inputs, (kinetic, forces) in (("published", MEASURED), ("fitted", FITTED)):
        errors, shares = [], []
        for run, force in enumerate(forces, 1):
            course = read_course(folder / f"Trial #{run}.csv")
            positions = predicted(course, kinetic, force)
            errors.append(1e3 * position_error(course, positions))
            shares.append(errors[-1] / (1e3 * np.abs(course.part).max()))
            row = f"{1e3 * course.part[-1]:.2f} | {1e3 * positions[-1]:.2f} | {errors[-1]:.3f}"
            print(f"| {inputs} | {run} | {row} | {100 * shares[-1]:.1f} % |", flush=True)
        means = f"{np.mean(errors):.3f} | {100 * np.mean(shares):.1f} %"
        print(f"| {inputs} | mean | | | {means} |")


if __name__ == "__main__":
    main()
