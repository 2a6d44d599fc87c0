"""How regimes and levels of quantities look, the same in every picture and on every page."""

from __future__ import annotations

LEVELS = {"throw_number": (1.0, "lift-off")}
"""A value of a quantity that is marked, and what begins there."""

INKS = {
    "not_assessed": "#8a8a8a",
    "contact": "#4d9221",
    "stick": "#2166ac",
    "slip": "#4d9221",
    "roll": "#01665e",
    "flight": "#4a4a4a",
    "wall_lost": "#b3560f",
    "flight_and_wall_lost": "#5e2d91",
    "no_motion": "#2166ac",
    "stopped": "#5e3c99",
    "outside_cone": "#9b1b5a",
    "invalid_geometry": "#6b5d00",
    "tipping": "#8b1a1a",
    "faster_than_track": "#00696b",
    "unbounded": "#777777",
    "separation": "#8a7a1f",
    "sliding": "#4d9221",
    "two_solutions": "#5e2d91",
    "no_solution": "#9b1b5a",
    "apart": "#8a8a8a",
    "overlap": "#6b5d00",
    "no_impact": "#2166ac",
    "impact_stick": "#01665e",
    "impact_slip": "#4d9221",
    "simultaneous": "#8b1a1a",
    "impact": "#b3560f",
    "singular": "#9b1b5a",
    "stick_slip": "#01806a",
    "hopping": "#8a7a1f",
    "hop_after_hop": "#b3560f",
    "period_doubled": "#a8325e",
    "aperiodic": "#5a4580",
    "runaway": "#8b1a1a",
    "unresolved": "#4a4a4a",
    "rests": "#2166ac",
    "tumbles": "#b3560f",
    "resonance": "#a8325e",
    "tuned_stiff": "#2166ac",
    "tuned_soft": "#8a7a1f",
    "hits_magnet": "#8b1a1a",
    "overstressed": "#5e2d91",
    "isolation_poor": "#b3560f",
    "several_amplitudes": "#4a4a4a",
    "hunting": "#4a4a4a",
    "unstable_side": "#8a7a1f",
    "stands": "#2166ac",
    "may_topple": "#b3560f",
    "no_pass": "#8b1a1a",
    "passes": "#2166ac",
    "crowded": "#b3560f",
    "indeterminate_force": "#4a4a4a",
    "out_of_phase_possible": "#5a4580",
    "separating": "#01665e",
    "neutral": "#777777",
    "rolls_and_slips": "#8a7a1f",
}
"""The colour of hatches, borders and lines of a regime."""

# Fills of a map, chosen by measurement: the least distance (CAM02-UCS) of two that may stand side
# by side is above 12 in every kind of colour vision, and black text is read on all of them. Regimes
# that share one do not occur in one scene. Where values do not hold, a map is pale and hatched.
FILLS = {
    "stick": "#9ccbff",
    "no_motion": "#a05ce6",
    "no_impact": "#9ccbff",
    "slip": "#a3c02c",
    "sliding": "#a3c02c",
    "impact_slip": "#a3c02c",
    "roll": "#3f8a70",
    "stick_slip": "#3f8a70",
    "impact_stick": "#3f8a70",
    "hopping": "#ffd98f",
    "separation": "#ffd98f",
    "hop_after_hop": "#c66a2c",
    "impact": "#c66a2c",
    "period_doubled": "#ee7fa6",
    "stopped": "#ee7fa6",
    "aperiodic": "#a05ce6",
    "rests": "#9ccbff",
    "tumbles": "#c66a2c",
    "contact": "#ffffff",
    "apart": "#d6d6d6",
    "not_assessed": "#dddddd",
    "unbounded": "#d6d6d6",
    "resonance": "#ee7fa6",
    "tuned_stiff": "#9ccbff",
    "tuned_soft": "#ffd98f",
    "isolation_poor": "#c66a2c",
    "several_amplitudes": "#ffffff",
    "hunting": "#d6d6d6",
    "unstable_side": "#ffd98f",
    "stands": "#9ccbff",
    "may_topple": "#c66a2c",
    "passes": "#9ccbff",
    "crowded": "#c66a2c",
    "indeterminate_force": "#d6d6d6",
    "out_of_phase_possible": "#c66a2c",
    "separating": "#3f8a70",
    "neutral": "#d6d6d6",
}
"""The colour of an area, or of a mark, of a regime where values hold."""


def colour_of(regime: str) -> str:
    """Return the colour of a mark in a regime: light where values hold, dark elsewhere."""
    return FILLS.get(regime, INKS[regime])
