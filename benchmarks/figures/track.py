"""Judges the figures of the rectangular part on the track, 5.22 to 5.29."""

from __future__ import annotations

import numpy as np

from benchmarks.figures.judgement import (
    GOOD,
    HOLDS,
    IMPOSSIBLE,
    NOT_REPRODUCED,
    REPRODUCED,
    SLIGHT,
    SMALL,
    Judgement,
)
from benchmarks.figures.measures import at_largest, crossing, rises, slope, span
from benchmarks.figures.studies import changed, data, fine


def velocity_over_drive() -> list[Judgement]:
    """Judge the claims of figure 5.22."""
    v = data(22)["transport_velocity"]
    grows = rises(v, "frequency") and rises(v, "amplitude")
    tilted = changed(22, frequency=60, amplitude="1 mm", beta=[5, 20])["transport_velocity"]
    gain = 100 * (float(tilted[1] / tilted[0]) - 1)
    starts = [start_of_motion(variant) for variant in ("thesis", "derived")]
    return [
        Judgement(
            "The velocity rises with frequency and amplitude.",
            HOLDS if grows else NOT_REPRODUCED,
            f"It falls nowhere. At 0.1 mm the part starts at {starts[0]:.1f} Hz as printed, at "
            f"{starts[1]:.1f} Hz with the sign of the lean corrected.",
        ),
        Judgement(
            "It rises with the normal amplitude A0 sin(beta).",
            HOLDS if gain > 0 else NOT_REPRODUCED,
            f"With beta from 5 to 20 deg at 60 Hz, 1 mm, A0 sin(beta) rises fourfold and the "
            f"velocity changes by {gain:.1f} %.",
        ),
    ]


def start_of_motion(variant: str) -> float:
    """Return the frequency at which motion starts (K = 0) at 0.1 mm [Hz]."""
    K = changed(22, variant=variant, amplitude="0.1 mm")["starting_acceleration"]  # noqa: N806
    per_square, constant = np.polyfit(K["frequency"] ** 2, K, 1)
    return float(np.sqrt(-constant / per_square))


def velocity_over_elevation() -> list[Judgement]:
    """Judge the claims of figure 5.23."""
    v = data(23)["transport_velocity"]
    part = v / v.max()
    largest = part.isel(amplitude=-1)
    level = float(largest.sel(beta=25))
    amplitude = 1e3 * crossing(part.sel(beta=0), level)
    good = float(largest.sel(beta=40))
    return [
        Judgement(
            "The maximum lies at A0 0.9 to 1 mm, beta 0 to 25 deg.",
            REPRODUCED if abs(amplitude - 0.9) < 0.02 else NOT_REPRODUCED,
            f"The velocity at 1 mm, 25 deg is {level:.3f} of the largest; at beta 0 this level is "
            f"reached at {amplitude:.2f} mm. The effective distance has no effect.",
        ),
        Judgement(
            "Good for beta 0 to 40 deg.",
            HOLDS if good >= GOOD else NOT_REPRODUCED,
            f"At 1 mm, 40 deg the velocity is {good:.2f} of the largest.",
        ),
    ]


def velocity_over_frequency() -> list[Judgement]:
    """Judge the claims of figure 5.24."""
    v = data(24)["transport_velocity"]
    high = v.isel(frequency=-1)
    ratio = float(high.sel(beta=35) / high.sel(beta=0))
    return [
        Judgement(
            "Best at high frequency, beta 0 to 35 deg.",
            HOLDS if rises(v, "frequency") and ratio >= GOOD else NOT_REPRODUCED,
            f"The velocity falls nowhere over frequency; at 120 Hz that at 35 deg is {ratio:.3f} "
            f"of that at 0 deg.",
        )
    ]


def velocity_over_angles() -> list[Judgement]:
    """Judge the claims of figure 5.25."""
    v = data(25)["transport_velocity"]
    least = float((v / v.max()).sel(alpha=slice(0, 45), beta=slice(0, 35)).min())
    level = changed(25, alpha=fine(0, 90, 0.01), beta=0)["transport_velocity"]
    best = at_largest(level)["alpha"]
    falls = rises(-v, "alpha") and rises(-v, "beta")
    load = float(data(25)["wall_balance"].sel(alpha=45, beta=20))
    return [
        Judgement(
            "Good for alpha 0 to 45, beta 0 to 35 deg.",
            HOLDS if least >= GOOD else NOT_REPRODUCED,
            f"In this box the velocity is at least {least:.3f} of the largest.",
        ),
        Judgement(
            "The angles are inversely proportional to the velocity.",
            HOLDS if falls else NOT_REPRODUCED,
            f"At beta 0 the velocity rises up to alpha {best:.1f} deg, atan(mu), and falls beyond. "
            f"The rise needs a wall that pulls: its load at (45, 20) deg is {load:.1f} m/s2.",
        ),
    ]


def velocity_over_inclination() -> list[Judgement]:
    """Judge the claims of figure 5.26."""

    def gain(variant: str) -> float:
        """Return the gain of velocity from 0 to 10 degrees of lean."""
        v = changed(26, variant=variant, gamma=0, delta=[0, 10])["transport_velocity"]
        return float(v[1] / v[0]) - 1

    printed, derived = gain("thesis"), gain("derived")
    v = data(26)["transport_velocity"].sel(delta=0)
    left = float(v.sel(gamma=90) / v.sel(gamma=0))
    return [
        Judgement(
            "The lean delta lowers the velocity slightly.",
            HOLDS if -SLIGHT < printed < 0 else NOT_REPRODUCED,
            f"A lean of 10 deg changes it by {100 * printed:+.2f} % as printed, by "
            f"{100 * derived:+.2f} % with the sign of the lean corrected, where the claim "
            f"{'holds' if -SLIGHT < derived < 0 else 'fails too'}.",
        ),
        Judgement(
            "A large climb gamma gives a small velocity.",
            HOLDS if left <= SMALL else NOT_REPRODUCED,
            f"At gamma 90 deg the velocity is still {left:.3f} of that at 0 deg.",
        ),
    ]


def velocity_over_friction() -> list[Judgement]:
    """Judge the claims of figure 5.27."""
    bare = changed(27, friction=0, frequency=60)
    bound = float(bare["velocity_bound"])
    distance = bound**2 / (2 * float(bare["starting_acceleration"]))
    real = changed(27, frequency=60, distance=distance)["transport_velocity"]
    far = data(27)["transport_velocity"].sel(frequency=60)
    needed = [least_distance(120, all_the_way=False), least_distance(20, all_the_way=True)]
    return [
        Judgement(
            "The velocity falls with friction.",
            HOLDS if (real.diff("friction") < 0).all() else NOT_REPRODUCED,
            f"At 60 Hz a distance of {1e3 * distance:.2f} mm gives the track's own speed, "
            f"{bound:.2f} m/s, at friction 0; from there to friction 1 the velocity changes by "
            f"{100 * float(real[-1] / real[0] - 1):+.0f} %. It falls only for distances above "
            f"{needed[0]:.2f} m (at 120 Hz, from friction 0 to 1) to {needed[1]:.2f} m (at 20 Hz, "
            f"all the way), with speeds of {span((float(far.min()), float(far.max())))} m/s at "
            f"60 Hz and 0.3 m, the distance drawn.",
        )
    ]


def least_distance(frequency: float, *, all_the_way: bool) -> float:
    """Return the distance beyond which the velocity of 5.27 falls with friction [m]."""
    v = changed(27, frequency=frequency, distance=fine(0.19, 0.29, 0.001))["transport_velocity"]
    falls = (v.diff("friction") < 0).all("friction") if all_the_way else slope(v) < 0
    return float(v["distance"].where(falls).min())


MISSING = {
    28: ("the abscissa", "the radius", "gamma", "the effective distance", "the measured values"),
    29: ("the abscissa", "A0", "beta", "the radius", "the effective distance"),
}


def _comparison(number: int, numbers: str) -> Judgement:
    """Return the judgement of a comparison with measurements."""
    missing = MISSING[number]
    return Judgement(
        "The model describes what was measured adequately.",
        IMPOSSIBLE if missing else HOLDS,
        f"Not given: {', '.join(missing)}. {numbers}",
    )


def wolfsteiner_and_pfeiffer() -> list[Judgement]:
    """Judge the claims of figure 5.28."""
    level = data(28).sel(gamma=0)
    bound = float(level["velocity_bound"])
    distance = 1e3 * crossing(level["transport_velocity"] - bound)
    throw = float(level["throw_number"])
    text = (
        f"The throw number is {throw:.2f}; speeds up to the track's own, {bound:.2f} m/s, need a "
        f"distance of at most {distance:.2f} mm."
    )
    return [_comparison(28, text)]


def boothroyd() -> list[Judgement]:
    """Judge the claims of figure 5.29."""
    without = changed(29, friction=0)["starting_acceleration"].values
    same = bool((data(29)["starting_acceleration"].values == without).all())
    text = (
        f"With alpha, gamma and delta 0 the wall carries nothing, and friction 0.3 and 0 give "
        f"{'the same' if same else 'different'} accelerations."
    )
    return [_comparison(29, text)]
