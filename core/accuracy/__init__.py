"""Error against run time, for the scene and the parameters of a user's study.

Loads mpmath, numba and scipy; nothing else in the core imports it.
"""

from core.accuracy.report import Part, measure_study

__all__ = ["Part", "measure_study"]
