"""`python -m benchmarks.plate_pictures` draws the pictures of docs/plate.md, in docs/plate."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

import vibrafeed

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "plate"
DOTS = 100  # an inch
STUDY = ROOT / "configs" / "plate-centre.toml"

PLACES = {"start": "-120 mm", "stop": "120 mm", "num": 7}
LEVEL = {"amplitude_tilt_x_1": "0 deg", "amplitude_tilt_y_1": "0 deg"}
MOVES: dict[str, dict[str, Any]] = {
    "convey to 45°: bounce, -17°": LEVEL | {"amplitude_normal_1": "0.04 mm", "phase_normal_1": -17},
    "centre: tilts, 119° and 29°": {"phase_tilt_x_1": 119, "phase_tilt_y_1": 29},
    "spread: tilts, -61° and -151°": {"phase_tilt_x_1": -61, "phase_tilt_y_1": -151},
    "swirl: tilts, -151° and 119°": {"phase_tilt_x_1": -151, "phase_tilt_y_1": 119},
}
"""What is changed in the study of the page, whose plate circles in all of them."""


def moves() -> Figure:
    """Return the fields of four moves of one plate, side by side."""
    figure = Figure(figsize=(11, 3.2), layout="constrained", facecolor="white")
    panels = figure.subplots(1, len(MOVES), sharey=True)
    for axes, (name, changes) in zip(panels, MOVES.items(), strict=True):
        found = vibrafeed.simulate(STUDY, position_x=PLACES, position_y=PLACES, **changes)
        x, y = (1e3 * found[place].values for place in ("position_x", "position_y"))
        speeds = (1e3 * found[one].values.T for one in ("velocity_x", "velocity_y"))
        axes.quiver(x, y, *speeds, color="#1f3b73", pivot="mid", scale=220, width=0.008)
        axes.set_title(name, loc="left", fontsize=9)
        axes.set_aspect("equal")
        axes.set(xlabel="x (mm)")
    panels[0].set_ylabel("y (mm)")
    return figure


def main() -> None:
    """Draw all pictures of the page."""
    PICTURES.mkdir(exist_ok=True)
    moves().savefig(PICTURES / "moves.png", dpi=DOTS)
    found = vibrafeed.simulate(STUDY)
    vibrafeed.plot(found).savefig(PICTURES / "centre.png", dpi=DOTS)


if __name__ == "__main__":
    main()
