"""Prints how often the speed of a known drive lies within the error that is stated of it.

Each recording holds the same drive of three orders on two axes, noise of a colour, a drift, and a
clock 1 % slow, as in `benchmarks/measured_errors.py`. It is fitted, a part is simulated under the
fitted drive, and its speed compared with that under the drive itself:
`python -m benchmarks.measured_speeds --recordings 100`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from benchmarks.measured_errors import AMPLITUDES, CASES, FREQUENCY, ORDERS, PHASES, fitted
from benchmarks.options import options
from vibrafeed.core.motion.drive_error import DriveError, drive_error, velocities
from vibrafeed.core.motion.prepare import prepare
from vibrafeed.core.study.sweep_and_simulate import SimulateStudy

PARTS = {
    "slides": {"friction": 0.3, "drive_factor": 0.7},
    "hops": {"friction": 0.3, "drive_factor": 1.5},
}
WITHIN = "95 %"


def main() -> None:
    """Print a table row for each kind of noise and part."""
    asked = options(__doc__, recordings=100, draws=200)
    print(f"| noise | part | true speed [mm/s] | stated error [mm/s] | within its {WITHIN} |")
    print("| --- | --- | --- | --- | --- |")
    for noise in CASES:
        for part, parameters in PARTS.items():
            row(noise, part, parameters, asked.recordings, asked.draws)


def row(
    noise: str, part: str, parameters: Mapping[str, float], recordings: int, draws: int
) -> None:
    """Print the measurements for one kind of noise and part."""
    true = true_speed(parameters)
    told = [one for seed in range(recordings) if (one := stated(noise, seed, parameters, draws))]
    inside = sum(one.lower <= true <= one.upper for one in told)
    spread = float(np.mean([one.standard_deviation for one in told]))
    print(
        f"| {noise} | {part} | {1e3 * true:.3f} | {1e3 * spread:.3f} | {inside} of {len(told)} |",
        flush=True,
    )


def stated(noise: str, seed: int, parameters: Mapping[str, float], draws: int) -> DriveError | None:
    """Return the speed under the fitted drive with its error; None if the fit is refused."""
    fit = fitted(seed, CASES[noise])
    if fit is None:
        return None
    study = study_of({**fit.parameters(), **parameters})
    return drive_error(study, fit, draws, np.random.default_rng(seed))


def true_speed(parameters: Mapping[str, float]) -> float:
    """Return the speed under the true drive [m s-1]."""
    drive: dict[str, float] = {"frequency": FREQUENCY}
    for axis, amplitudes, phases in zip(("along", "normal"), AMPLITUDES, PHASES, strict=True):
        for order, amplitude, phase in zip(ORDERS, amplitudes, phases, strict=True):
            drive[f"amplitude_{axis}_{order}"] = float(amplitude)
            drive[f"phase_{axis}_{order}"] = float(np.degrees(phase))
    return float(velocities(prepare(study_of({**drive, **parameters})), [{}])[0])


def study_of(parameters: Mapping[str, Any]) -> SimulateStudy:
    """Return the study of a part on a plane."""
    content = {"kind": "simulate", "scene": "rectangle-on-plane", "parameters": parameters}
    return SimulateStudy.model_validate(content)


if __name__ == "__main__":
    main()
