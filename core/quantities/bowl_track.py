"""The track of a bowl in stretches, and what passes the whole of it."""

from __future__ import annotations

from vibrafeed.core.quantities.quantity import Quantity, angle, friction, length, velocity

MAX_STRETCHES = 6
"""Stretches of a track: the inner turns, a lined part, a steeper one, the exit, and two more."""


def _turns(n: int) -> Quantity:
    """Return the declaration of a parameter: the turns of stretch `n` of a bowl's track.

    A stretch is a piece of the track with one climb and one lining; stretches count from 1.
    """
    return Quantity(
        "1", f"n_{n}", f"Turns, stretch {n}", f"Turns of stretch {n} of the track.", 0.0,
        strict=True, parameter=True, examples=("1.5",), usual=(1e-3, 20.0),
    )  # fmt: skip


def _radius(n: int) -> Quantity:
    """Return the quantity of the radius at the end of stretch n."""
    return length(
        f"R_{n}", f"Radius, end of stretch {n}", f"Radius at the end of stretch {n}.", "150 mm"
    )


def _climb(n: int) -> Quantity:
    """Return the declaration of a parameter: the climb of stretch `n` of a bowl's track [degree].

    A stretch is a piece of the track with one climb and one lining; stretches count from 1.
    """
    return angle(
        f"gamma_{n}", f"Climb, stretch {n}",
        f"Climb of stretch {n}; that of the stretch before unless given.", 80.0, "3 deg",
        (-15.0, 15.0),
    )  # fmt: skip


def _friction(n: int) -> Quantity:
    """Return the declaration of a parameter: the friction on stretch `n` of a bowl's track, from 1.

    A stretch is a piece of the track with one climb and one lining.
    """
    return friction(
        f"mu_{n}",
        f"Friction, stretch {n}",
        f"Coefficient of friction on stretch {n}; that of the stretch before unless given.",
    )


OF_STRETCHES = {
    "stretch_turns": _turns,
    "stretch_radius": _radius,
    "stretch_climb": _climb,
    "stretch_friction": _friction,
}
"""What each stretch of a track has, by the stem of its name."""


def _fraction(label: str, says: str, example: str) -> Quantity:
    """Return the quantity of a share of the track's length."""
    return Quantity("1", "x", label, says, 0.0, 1.0, parameter=True, examples=(example,))


BOWL_TRACK: dict[str, Quantity] = {
    "track_fraction": _fraction(
        "Share of the track",
        "Share of the track's length behind the part: 0 at its start, 1 at the exit.", "0.5",
    ),
    "start_radius": length("R_0", "Radius at the start", "Radius at which the track starts.",
                           "100 mm"),
    **{
        f"{stem}_{n}": of_stretch(n)
        for stem, of_stretch in OF_STRETCHES.items()
        for n in range(1, MAX_STRETCHES + 1)
    },
    "load_radius": length(
        "R_l", "Radius of the load",
        "Radius at which the load lies; by default that of the part.", "180 mm",
    ),
    "load_fraction": _fraction(
        "Share of the track, load",
        "Share of the track's length at which the load of all its parts is taken to act.", "0.5",
    ),
    "stretches": Quantity("1", "", "Stretches", "The stretches of a track.", bundle=True),
    "passage": Quantity("1", "", "Passage", "Passage of parts along the whole track.", bundle=True),
    "track_length": Quantity("m", "L", "Length of the track",
    "Length of the track from its start to the "
    "exit."),
    "track_radius": Quantity("m", "R", "Radius of the track", "Radius of the track at its place."),
    "transit_time": Quantity(
        "s", "T", "Transit time", "Time of a part on the track, start to exit; infinite if it "
        "stops on the way.",
    ),
    "transit_time_error": Quantity(
        "s", "e(T)", "Error of the transit time",
        "Time that the speeds between the places where the motion is followed may add.",
        error_of="transit_time",
    ),
    "bottleneck_velocity": velocity(
        "v_b", "Velocity at the bottleneck", "Least mean velocity along the track."
    ),
    "bottleneck_velocity_error": Quantity(
        "m s-1", "e(v_b)", "Error of the velocity at the bottleneck",
        "How much slower a part may be between the places where the motion is followed.",
        error_of="bottleneck_velocity",
    ),
    "bottleneck_fraction": Quantity(
        "1", "x_b", "Share of the track, bottleneck",
        "Share of the track's length at which parts are slowest.",
    ),
    "bottleneck_radius": Quantity(
        "m", "R_b", "Radius of the bottleneck", "Radius at which parts are slowest."
    ),
    "track_feed_rate": Quantity(
        "min-1", "F", "Feed rate of the track",
        "Parts per minute that can pass the whole track, limited by its bottleneck.",
    ),
}  # fmt: skip
