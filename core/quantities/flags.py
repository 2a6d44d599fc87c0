"""Regimes, statuses and modes: what a flag variable can say of a cell."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Flag:
    """A value of a flag variable, such as a state that a cell can be in.

    Attributes
    ----------
    value : int
        The number that stands in files.
    description : str
        What it says to the user.
    valid : bool
        False where the values of the cell do not describe a real part.
    of_value : bool
        True where it speaks of single outputs, not of the part: one has no finite value, say.
    """

    value: int
    description: str
    valid: bool = True
    of_value: bool = False

    @property
    def judges(self) -> bool:
        """True where it says of an output more than the state of the part."""
        return self.of_value or not self.valid


REGIME = "regime"
"""The variable of a result that holds the regime of the contact, or of all outputs alike."""


def is_regime(name: str) -> bool:
    """True for the name of a variable that holds regimes, ``regime`` or ``regime_<output>``.

    A reduction has counts of cells in a regime, ``regime_hopping_count``: these hold none.
    """
    return name == REGIME or (name.startswith(f"{REGIME}_") and not name.endswith("_count"))


REGIMES: dict[str, Flag] = {
    "not_assessed": Flag(0, "the requested outputs do not depend on any contact"),
    "contact": Flag(1, "the part is in contact; sticking or sliding makes no difference here"),
    "stick": Flag(2, "friction holds the part; it does not move"),
    "slip": Flag(3, "the part slides"),
    "roll": Flag(4, "the part rolls without slip"),
    "flight": Flag(5, "the part has left the floor", valid=False),
    "wall_lost": Flag(6, "the part has left the wall", valid=False),
    "flight_and_wall_lost": Flag(7, "the part has left both floor and wall", valid=False),
    "no_motion": Flag(8, "the drive is too weak to start forward motion", of_value=True),
    "stopped": Flag(9, "the part stops before the distance or time is reached", of_value=True),
    "outside_cone": Flag(10, "the forces lie outside the friction cone", valid=False),
    "invalid_geometry": Flag(11, "the part does not fit the track or the model", valid=False),
    "tipping": Flag(12, "the centre of pressure leaves the base: the part tips", valid=False),
    "faster_than_track": Flag(13, "the estimate exceeds the largest track speed", valid=False),
    "unbounded": Flag(14, "no finite value exists: the quantity is unbounded", of_value=True),
    "separation": Flag(15, "the corner leaves the plane"),
    "sliding": Flag(16, "the corner slides on the plane, or starts to slide"),
    "two_solutions": Flag(17, "more than one contact force satisfies the model", valid=False),
    "no_solution": Flag(18, "no contact force satisfies the model", valid=False),
    # --- impacts of two bodies
    "apart": Flag(19, "the bodies do not touch; no impact occurs"),
    "overlap": Flag(20, "the bodies overlap: no such placement is possible", valid=False),
    "no_impact": Flag(21, "the bodies touch but do not approach; no impact occurs"),
    "impact_stick": Flag(22, "the bodies collide and do not slide on each other after the impact"),
    "impact_slip": Flag(23, "the bodies collide and slide on each other after the impact"),
    "simultaneous": Flag(
        24, "the bodies meet at several points at once, or edge to edge: "
        "the law gives no unique result",
        valid=False,
    ),
    "impact": Flag(25, "the bodies collide"),
    "singular": Flag(26, "the formula divides by zero here: it has no value", valid=False),
    # --- motion in time
    "stick_slip": Flag(27, "the part sticks for a part of the period and slides for the rest"),
    "hopping": Flag(28, "the part hops once a period or more often, and touches the floor between"),
    "hop_after_hop": Flag(29, "the part hops again as soon as it lands"),
    "period_doubled": Flag(30, "the motion repeats after two periods of the drive or more"),
    "aperiodic": Flag(
        31,
        "the motion does not repeat, or rounding decides how it repeats; the values are means over "
        "many periods",
    ),
    "runaway": Flag(32, "the part gains speed without limit; it has no mean velocity", valid=False),
    "unresolved": Flag(
        33, "no result: the study was stopped, or a limit was reached first", valid=False
    ),
    "rests": Flag(34, "the part has come to rest on a side"),
    "tumbles": Flag(35, "the part still moves at the end of the duration"),
    # --- drive units
    "resonance": Flag(36, "the drive is at the natural frequency: small changes have "
    "large effects"),
    "tuned_stiff": Flag(37,
        "the natural frequency is above the drive frequency: more load raises the amplitude, more "
        "springs lower it"),
    "tuned_soft": Flag(38,
        "the natural frequency is below the drive frequency: more load lowers the amplitude, more "
        "springs raise it"),
    "hits_magnet": Flag(39, "the stroke closes the air gap of the magnet", of_value=True),
    "overstressed": Flag(40, "the leaf springs are bent beyond their allowable "
    "stress", of_value=True),
    "isolation_poor": Flag(
        41, "the unit rocks on its feet at more than a third of the drive's frequency",
        of_value=True,
    ),
    "several_amplitudes": Flag(42,
        "drive and parts agree at several amplitudes; the smallest one is given"),
    "hunting": Flag(
        43,
        "the motion of the parts changes at the amplitude at which drive and parts would agree: "
        "the amplitude is known only to 3 %"
    ),
    # --- which way up
    "unstable_side": Flag(44, "the part does not lie on its side: it rolls on over a rim"),
    "stands": Flag(
        45, "the standing part does not rock, or twice the track's speed does not topple it"
    ),
    "may_topple": Flag(46, "the drive may topple the standing part; a simulation can decide"),
    "no_pass": Flag(47, "the devices let no part pass: all parts return to the bowl"),
    "passes": Flag(48, "parts pass"),
    # --- rows of parts
    "crowded": Flag(49,
        "more parts arrive than the lane can take: the other parts are turned away"),
    "indeterminate_force": Flag(
        50, "the force on the stop is not unique, or only a bound of it is known",
        of_value=True,
    ),
    "out_of_phase_possible": Flag(
        51,
        "above a throw number of 3.724 parts may hop in turn; in this result all parts hop at once"
    ),
    "separating": Flag(52, "the row breaks up into platoons that separate for good"),
    # --- round parts
    "neutral": Flag(53, "nothing conveys the part: it keeps the speed that it has at the start"),
    "rolls_and_slips": Flag(
        54, "the part does not always roll: it also slips or hops; its mean velocity is not known",
        valid=False,
    ),
    "soft_contact": Flag(
        55, "the lining is too soft for a rigid model: the impacts last too long"
    ),
    # --- rows of parts
    "blocked": Flag(56, "the stop holds the row"),
    "not_supported": Flag(
        57, "parts that rebound from the floor hop independently: such rows are not supported",
        valid=False,
    ),
    # --- drive units
    "stalls": Flag(
        58, "parts stop or turn back somewhere on the track: no part leaves it", of_value=True
    ),
    "thrown_load": Flag(
        59,
        "parts above a throw number of 2 load the unit: their harmonics, which the model "
        "neglects, move the track, so that the amplitude is known only to 1 or 2 %",
    ),
}  # fmt: skip

MOTION_STATUSES: dict[str, Flag] = {
    "not_computed": Flag(0, "the study was stopped before this cell", valid=False),
    "periodic": Flag(1, "the motion repeats after a whole number of periods"),
    "at_rest": Flag(2, "friction holds the part; it does not move"),
    "aperiodic": Flag(3, "the motion does not repeat; values are taken over many periods"),
    "runaway": Flag(4, "the part gains speed without limit; it has no mean velocity", valid=False),
    "neutral": Flag(5, "nothing conveys the part: it keeps the speed that it has at the start"),
    "limit_reached": Flag(
        6, "a limit, or rounding, stopped the simulation before it had a result", valid=False
    ),
    "no_solution": Flag(7, "the contact laws had no solution, or several", valid=False),
    "settled": Flag(8, "the part has come to rest on a side"),
    "moving": Flag(9, "the part still moves at the end of the duration"),
    "sensitive": Flag(
        10, "the motion repeats in the end, but rounding decides how; values are means over starts"
    ),
    "no_drive": Flag(
        11, "the mean acceleration of the steps is not 0, so they cannot drive a track", valid=False
    ),
    "rolls_and_slips": Flag(
        12, "a round part also slips or hops: its mean velocity is not known", valid=False
    ),
    "weak_friction": Flag(
        13,
        "friction is too weak to settle the motion within max_periods: the values are the limit "
        "for weak friction",
    ),
}

OPTIMUM_STATUSES: dict[str, Flag] = {
    "optimal": Flag(0, "no other choice within the bounds does better"),
    "flat": Flag(1, "the choice does not matter, for example without a drive"),
    "no_motion": Flag(
        2,
        "no choice within the bounds moves the part forwards (with uncertain parameters: in the "
        "mean or the worst case)",
    ),
    "not_attained": Flag(
        3,
        "static friction still holds the part exactly at the optimum; right beside it the output "
        "jumps to the stated value",
    ),
    "infeasible": Flag(4, "no choice satisfies the bounds, limits and contacts", valid=False),
    "invalid": Flag(5, "an argument is not a number, or is out of its range", valid=False),
    "limit_reached": Flag(
        6, "the search reached its limit of steps before the last digit", valid=False
    ),
    "no_value": Flag(7, "the outputs have no value within the bounds", valid=False),
    "not_computed": Flag(8, "the study was stopped before this design", valid=False),
    "suboptimal": Flag(9, "a dense grid has a better point that the search missed", valid=False),
    "only_backward": Flag(
        10,
        "every choice moves the part backwards on average (with uncertain parameters: in the mean "
        "or the worst case)",
    ),
    "target_missed": Flag(
        11, "no choice within the bounds reaches the target; this is the nearest"
    ),
}

MOTION_MODES: dict[str, Flag] = {
    "stick": Flag(0, "friction holds the part on the track"),
    "forward": Flag(1, "the part slides forward"),
    "backward": Flag(2, "the part slides backward"),
    "flight": Flag(3, "the part is off the floor"),
    "unknown": Flag(4, "no motion was found for this time", valid=False),
}

SIGNS: dict[str, Flag] = {
    "settled": Flag(0, "speeds have one direction over the whole band"),
    "unsettled": Flag(1, "speeds change their direction within the band"),
    "open": Flag(2, "the part has no mean speed at some values in the band"),
}
"""The states of the flag of a band."""

DERIVATIVE_STATUSES: dict[str, Flag] = {
    "differences": Flag(0, "from central differences inside one regime"),
    "one_sided": Flag(1, "from inside, at an end of the parameter's range"),
    "kink": Flag(3, "none: a kink or a jump, where the two sides differ or cannot be separated"),
    "not_periodic": Flag(
        4, "none: the motion does not repeat, because it is aperiodic or runs away"
    ),
    "no_value": Flag(5, "none: the output has no finite value here"),
    "unsettled": Flag(
        6, "none: the differences do not converge, or the regime changes too close by"
    ),
    "not_computed": Flag(7, "not computed"),
}
"""The status of a derivative: how it was computed, or why there is none; of a cell and a parameter,
the most serious of all outputs."""
