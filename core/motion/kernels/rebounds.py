"""The rule by which a run of shrinking rebounds ends, in all kernels that count: theory 13.5."""

from __future__ import annotations

SETTLED_EXACTLY = 1e-13
"""Rebound times remaining phase of all hops, in g/w, below which a run of hops ends."""
SETTLED_TIME = 1e-3  # remaining phase of all hops over that to lift-off, below which a run may end

SETTLED_SOFTLY = 3e-4
"""The same, rebound times remaining time, where restitution falls with the speed of impact.

Such hops never end: a speed w falls as exp(-b n t/3), b the damping of the law and n the load, and
takes 3/(2 b w) hops. What is left out is stated as an error.
"""

LEFT_SOFTLY = 2e-3
"""Damping times rebound at the next lift-off, below which such hops pass for a stay on the floor.

Those that do not are some 750 up to there.
"""
