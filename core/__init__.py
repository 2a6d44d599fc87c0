"""The vibrafeed library: mechanics of parts on vibratory feeder tracks.

It speaks no HTTP, prints nothing and keeps no global state. `docs/theory.md` has the equations.
"""

__version__ = "0.2.0"
