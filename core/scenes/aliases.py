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
