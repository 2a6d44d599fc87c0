"""Other ways of giving a parameter."""

from __future__ import annotations

from core.mechanics.drive_unit import magnet_force, unbalance_force
from core.mechanics.friction import friction_kinetic, friction_static
from core.mechanics.orienting import rate_by_pitch
from core.mechanics.vibration import amplitude
from core.scenes.scene import Equation

ALIASES = (
    Equation("amplitude", amplitude, "theory 0.2"),
    Equation("friction_static", friction_static, "theory 11.2"),
    Equation("friction_kinetic", friction_kinetic, "theory 11.2"),
    Equation("drive_force", magnet_force, "theory 15.1"),
    Equation("drive_force", unbalance_force, "theory 15.1"),
    Equation("arrival_rate", rate_by_pitch, "theory 16.3"),
)
"""They serve only where the parameter itself is not given."""

ALTERNATIVES = {
    "friction": ("friction_static", "friction_kinetic"),
    "peak_to_peak": ("amplitude",),
    "occupancy": ("part_gap",),
    "hold_down": ("hold_down_force",),
}
"""Parameters that stand for others; a study gives either."""

WRITTEN_AS = {"friction_static": "friction", "friction_kinetic": "friction"}
"""Which of both ways the error for a missing parameter names."""

NEEDS = {
    "hold_down_force": ("mass", "the mass of the part that it presses on is missing", '"5 g"'),
}
"""Parameters that say nothing without another: that one, what is wrong, and an example of it."""
