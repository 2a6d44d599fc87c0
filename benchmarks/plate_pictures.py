"""`python -m benchmarks.plate_pictures` draws pictures and film of docs/plate.md, in docs/plate."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.interpolate import RegularGridInterpolator

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


FRAMES, STEP, A_SECOND = 32, 0.375, 8
"""Frames of the film, seconds of motion from one to the next, and frames a second."""
SIDE = 120.0  # mm, half of the plate


def fields() -> dict[str, xarray.Dataset]:
    """Return the velocities of each move, over the places of the plate."""
    return {
        name: vibrafeed.simulate(STUDY, position_x=PLACES, position_y=PLACES, **changes)
        for name, changes in MOVES.items()
    }


def moves(found: dict[str, xarray.Dataset]) -> tuple[Figure, list[Axes]]:
    """Return the fields of four moves of one plate, side by side, and their panels."""
    figure = Figure(figsize=(11, 3.2), layout="constrained", facecolor="white")
    panels = list(figure.subplots(1, len(MOVES), sharey=True))
    for axes, (name, field) in zip(panels, found.items(), strict=True):
        x, y = (1e3 * field[place].values for place in ("position_x", "position_y"))
        speeds = (1e3 * field[one].values.T for one in ("velocity_x", "velocity_y"))
        axes.quiver(x, y, *speeds, color="#1f3b73", pivot="mid", scale=220, width=0.008)
        axes.set_title(name, loc="left", fontsize=9)
        axes.set_aspect("equal")
        axes.set(xlabel="x (mm)")
    panels[0].set_ylabel("y (mm)")
    return figure, panels


def film(found: dict[str, xarray.Dataset]) -> FuncAnimation:
    """Return the film of parts that each move carries over the plate, from the same places."""
    figure, panels = moves(found)
    lattice = SIDE * np.linspace(-0.75, 0.75, 6)
    starts = np.stack(np.meshgrid(lattice, lattice), axis=-1).reshape(-1, 2)
    places = np.stack([starts] * len(found))
    dots = [axes.plot(*starts.T, "o", color="#c2410c", markersize=4)[0] for axes in panels]
    for axes in panels:
        axes.set(xlim=(-SIDE, SIDE), ylim=(-SIDE, SIDE))
    speeds = [
        RegularGridInterpolator(
            [1e3 * field[place].values for place in ("position_x", "position_y")],
            1e3 * np.stack([field.velocity_x.values, field.velocity_y.values], axis=-1),
            bounds_error=False, fill_value=None,
        )
        for field in found.values()
    ]  # fmt: skip

    def draw(frame: int) -> list[Artist]:
        for k, (dot, speed) in enumerate(zip(dots, speeds, strict=True)):
            places[k] = starts if not frame else places[k] + STEP * speed(places[k])
            dot.set_data(*places[k].T)
        return [*dots]

    return FuncAnimation(figure, draw, frames=FRAMES, init_func=lambda: [*dots])


def main() -> None:
    """Draw the pictures and the film of the page."""
    PICTURES.mkdir(exist_ok=True)
    carried = fields()
    moves(carried)[0].savefig(PICTURES / "moves.png", dpi=DOTS)
    writer = PillowWriter(fps=A_SECOND)
    film(carried).save(PICTURES / "moves.gif", writer, dpi=0.6 * DOTS)
    found = vibrafeed.simulate(STUDY)
    vibrafeed.plot(found).savefig(PICTURES / "centre.png", dpi=DOTS)


if __name__ == "__main__":
    main()
