"""Prints how much faster a million impacts in one call are than in a Python loop over the same
function: `python -m benchmarks.impacts`.
"""  # noqa: D205

from __future__ import annotations

import time

import numpy as np

from core.mechanics.arrays import Array
from core.plan.plan import Plan, make_plan
from core.scenes import SCENES

IMPACTS = 1_000_000
SAMPLE = 1_000  # impacts of the loop, whose time is extrapolated
BLOCK = 8_192  # impacts at a time, which stay in the processor's cache
RECTANGLES = {
    "position_x_1": (0.004, 0.006), "position_y_1": (0.0209, 0.0211), "angle_1": (0.5, 0.55),
    "velocity_x_1": (-1, 1), "velocity_y_1": (-1, -0.1), "spin_1": (-3, 3),
    "length_1": (0.04, 0.05), "width_1": (0.006, 0.008), "mass_1": (0.005, 0.02),
    "position_x_2": (-0.001, 0.001), "position_y_2": (-0.001, 0.001), "angle_2": (-0.05, 0.05),
    "velocity_x_2": (-1, 1), "velocity_y_2": (0.1, 1), "spin_2": (-3, 3),
    "length_2": (0.04, 0.05), "width_2": (0.01, 0.012), "mass_2": (0.005, 0.02),
    "friction": (0, 1), "restitution": (0, 1), "contact_tolerance": (1, 1),
}  # fmt: skip
CYLINDERS = {
    **{
        name: ends
        for name, ends in RECTANGLES.items()
        if name.rsplit("_", 1)[0] not in ("angle", "spin", "width")
    },
    "position_z_1": (0.0, 0.001), "azimuth_1": (1.4, 1.6), "elevation_1": (0.2, 0.4),
    "velocity_z_1": (-1, -0.5), "spin_x_1": (-3, 3), "spin_y_1": (-3, 3), "spin_z_1": (-3, 3),
    "diameter_1": (0.018, 0.02), "position_z_2": (-0.03, -0.029), "azimuth_2": (0.3, 0.4),
    "elevation_2": (-0.1, 0.1), "velocity_z_2": (0.5, 1), "spin_x_2": (-3, 3),
    "spin_y_2": (-3, 3), "spin_z_2": (-3, 3), "diameter_2": (0.018, 0.02),
}  # fmt: skip
PAIRS = {"rectangle-pair-impact": RECTANGLES, "cylinder-pair-impact": CYLINDERS}


def impacts(plan: Plan, given: dict[str, Array]) -> list[Array]:
    """Return the outputs of a plan at the given points; arrays of any shape."""
    known = {**{name: np.asarray(value) for name, value in plan.defaults.items()}, **given}
    for equation in plan.equations:
        known[equation.gives] = equation.function(**{n: known[n] for n in equation.inputs})
    return [known[name] for name in plan.outputs]


def in_blocks(plan: Plan, given: dict[str, Array]) -> dict[str, Array]:
    """Return the outputs at all points, computed block by block."""
    results = {name: np.empty(IMPACTS) for name in plan.outputs}
    for start in range(0, IMPACTS, BLOCK):
        piece = slice(start, start + BLOCK)
        block = impacts(plan, {name: values[piece] for name, values in given.items()})
        for name, values in zip(plan.outputs, block, strict=True):
            results[name][piece] = values
    return results


def main() -> None:
    """Print one line for each scene and law."""
    random = np.random.default_rng(1)
    for scene, ranges in PAIRS.items():
        points = {name: random.uniform(*ends, IMPACTS) for name, ends in ranges.items()}
        for law in ("frictionless", "pfeiffer_glocker", "moreau"):
            given = {k: v for k, v in points.items() if law != "frictionless" or k != "friction"}
            asked = [name for name in SCENES[scene].outputs(law) if name != "regime"]
            plan = make_plan(scene, law, asked, list(given))
            start = time.perf_counter()
            whole = in_blocks(plan, given)
            at_once = time.perf_counter() - start
            start = time.perf_counter()
            singly = [
                impacts(plan, {name: values[i] for name, values in given.items()})
                for i in range(SAMPLE)
            ]
            loop = (time.perf_counter() - start) * IMPACTS / SAMPLE
            place = plan.outputs.index("impulse_normal")
            found = np.array([float(one[place]) for one in singly])
            np.testing.assert_allclose(found, whole["impulse_normal"][:SAMPLE], rtol=1e-9)
            print(
                f"{scene:24} {law:18} {IMPACTS:,} impacts, {len(asked)} outputs: {at_once:6.2f} s "
                f"at once, {loop:7.0f} s in a loop (extrapolated from {SAMPLE:,}): "
                f"{loop / at_once:5.0f} times"
            )


if __name__ == "__main__":
    main()
