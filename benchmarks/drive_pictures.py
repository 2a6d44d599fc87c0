"""`python -m benchmarks.drive_pictures` draws the pictures of docs/drives.md, in docs/generated.

How the track moves under three phases is drawn here; the others are studies of `configs`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import vibrafeed

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "generated"
DOTS = 100  # an inch

ALONG, NORMAL = 0.3, 0.1  # mm
PHASES = {
    0: "a straight line at beta = 18.4 deg",
    -70: "forward at the bottom: carries forward",
    110: "backward at the bottom: carries backward",
}
AXES = {
    "ellipse": ("phase_normal_1", "amplitude_normal_1"),
    "stepped-wave": None,
    "two-frequencies": ("phase_along_2", "amplitude_along_2"),
}
TRACK, PRESSED = "#1f3b73", "#b3560f"


def path(axes: Axes, degrees: int, says: str) -> None:
    """Draw the path of a point of the track from the side; transport goes right."""
    lead = np.radians(degrees)
    phase = np.linspace(0, 2 * np.pi, 721)
    along, normal = ALONG * np.sin(phase), NORMAL * np.sin(phase + lead)
    axes.plot(along, normal, color=TRACK, linewidth=1.6)
    pressed = normal < -0.7 * NORMAL
    axes.plot(
        np.where(pressed, along, np.nan), np.where(pressed, normal, np.nan),
        color=PRESSED, linewidth=5, alpha=0.55, solid_capstyle="butt",
    )  # fmt: skip
    axes.plot([0], [NORMAL * np.sin(lead)], "o", color=TRACK, markersize=6)
    for start in np.radians((25, 205)):
        ends = [(ALONG * np.sin(p), NORMAL * np.sin(p + lead)) for p in (start, start + 0.05)]
        style = {"arrowstyle": "-|>", "color": TRACK, "mutation_scale": 16}
        axes.annotate("", ends[1], ends[0], arrowprops=style)
    axes.axhline(0, color="#000000", alpha=0.25, linewidth=0.6)
    axes.axvline(0, color="#000000", alpha=0.25, linewidth=0.6)
    axes.set_title(f"phase_normal_1 = {degrees} deg\n{says}", loc="left", fontsize=9)
    axes.set_aspect("equal")
    axes.set(xlim=(-0.36, 0.36), ylim=(-0.16, 0.16), xlabel="along (mm)")


def conventions() -> Figure:
    """Return the picture of a straight drive and of ellipses with both senses of rotation."""
    figure = Figure(figsize=(11, 2.7), layout="constrained", facecolor="white")
    panels = figure.subplots(1, len(PHASES), sharey=True)
    for axes, (degrees, says) in zip(panels, PHASES.items(), strict=True):
        path(axes, degrees, says)
    panels[0].set_ylabel("normal (mm)")
    figure.supxlabel(
        "dot: w t = 0      arrows: the way of the track      broad: the floor presses hardest",
        fontsize=9,
    )
    return figure


def main() -> None:
    """Draw all pictures of drives."""
    conventions().savefig(PICTURES / "drives-conventions.png", dpi=DOTS)
    for name, axes in AXES.items():
        found = vibrafeed.simulate(ROOT / "configs" / f"{name}.toml")
        vibrafeed.plot(found, axes=axes).savefig(PICTURES / f"drives-{name}.png", dpi=DOTS)


if __name__ == "__main__":
    main()
