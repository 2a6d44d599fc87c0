"""Judges the figures of the cylinder on the plane, 5.1 to 5.21."""

from __future__ import annotations

import numpy as np
import xarray as xr

from benchmarks.figures.judgement import (
    ARTEFACT,
    BEST,
    EDGE,
    HOLDS,
    NOT_REPRODUCED,
    REPRODUCED,
    Judgement,
)
from benchmarks.figures.measures import (
    at_largest,
    crossing,
    extents,
    is_polynomial,
    is_sinusoidal,
    lift_off_angle,
    nearest_region,
    rises,
    shortfall,
    slope,
    span,
)
from benchmarks.figures.studies import changed, data, fine


def best_region() -> list[Judgement]:
    """Judge the claims of figures 5.1 and 5.2."""
    box = {"alpha": (0.0, 20.0), "beta": (8.0, 45.0)}
    near = changed(1, alpha=fine(0, 50, 0.1), beta=fine(0, 60, 0.1))
    level, found, misfit = nearest_region(near["acceleration_x"], box, above=True)
    flying = near["throw_number"].where(near["acceleration_x"] >= level).min() > 1
    short = shortfall(data(1)["acceleration_x"], box, above=True)
    top = changed(1, alpha=0, beta=fine(20, 35, 0.01))["acceleration_x"]
    pushed = changed(1, variant="physical", alpha=0, beta=fine(0, 90, 0.01))["acceleration_x"]
    return [
        Judgement(
            "The maximum region is alpha 0 to 20, beta 8 to 45 deg.",
            REPRODUCED if misfit <= EDGE else NOT_REPRODUCED,
            f"a_x >= {level:.1f} m/s2 spans alpha {span(found['alpha'])}, beta "
            f"{span(found['beta'])} deg. The maximum is {float(top.max()):.2f} m/s2 at alpha 0, "
            f"beta {at_largest(top)['beta']:.1f} deg. {'All' if flying else 'Not all'} of the "
            f"region lies beyond lift-off at beta {lift_off_angle():.2f} deg. With a floor that "
            f"only pushes the largest value is {float(pushed.max()):.1f} m/s2, at beta "
            f"{at_largest(pushed)['beta']:.1f} deg.",
        ),
        Judgement(
            "The acceleration is high all over that interval.",
            HOLDS if short <= BEST else NOT_REPRODUCED,
            f"The lowest value in it is below the maximum by {100 * short:.0f} % of the "
            f"range of all values.",
        ),
    ]


def friction_and_elevation() -> list[Judgement]:
    """Judge the claims of figures 5.3 and 5.4."""
    rate = slope(data(3)["acceleration_x"])
    flying = data(3)["throw_number"] > 1
    if (rate > 0).all():
        verdict = HOLDS
    else:
        verdict = ARTEFACT if bool(((rate > 0) == flying).all()) else NOT_REPRODUCED
    contact = rate.where(~flying).max()
    return [
        Judgement(
            "The acceleration rises with friction.",
            verdict,
            f"The slope over friction is {float(rate.min()):.1f} m/s2 at beta 0 and changes sign "
            f"at {crossing(rate):.2f} deg, where the part leaves the floor; it is "
            f"{'negative' if contact < 0 else 'not negative'} wherever there is contact. At every "
            f"beta the acceleration is linear in friction.",
        )
    ]


def friction_and_frequency() -> list[Judgement]:
    """Judge the claims of figures 5.5 and 5.6."""
    a_x = data(5)["acceleration_x"]
    rate = slope(a_x)
    shape = is_polynomial(a_x, "friction", 1) and is_polynomial(a_x, "frequency", 2)
    over_frequency = float((a_x.max("frequency") - a_x.min("frequency")).min())
    over_friction = float((a_x.max("friction") - a_x.min("friction")).max())
    named = data(5)["throw_number"].sel(frequency=slice(50, 80))
    effect = (float(rate.sel(frequency=50)), float(rate.sel(frequency=80)))
    rising = min(effect) > 0
    return [
        Judgement(
            "Linear in friction, parabolic in frequency; frequency matters more.",
            HOLDS if shape and over_frequency > over_friction else NOT_REPRODUCED,
            f"Differences of second order over friction and of third order over frequency vanish. "
            f"Over 20 to 120 Hz a_x changes by at least {over_frequency:.0f} m/s2, over friction 0 "
            f"to 1 by at most {over_friction:.0f}.",
        ),
        Judgement(
            "Friction matters at 50 to 80 Hz.",
            (ARTEFACT if (named > 1).all() else HOLDS) if rising else NOT_REPRODUCED,
            f"The slope over friction is zero at {crossing(rate):.1f} Hz, at lift-off, and "
            f"{effect[0]:.0f} to {effect[1]:.0f} m/s2 at 50 to 80 Hz, where the throw number is "
            f"{span((float(named.min()), float(named.max())))}.",
        ),
    ]


def elevation_and_frequency() -> list[Judgement]:
    """Judge the claims of figures 5.7 and 5.8."""
    a_x = data(7)["acceleration_x"]
    spread = a_x.max("beta") - a_x.min("beta")
    low, high = float(spread.sel(frequency=20)), float(spread.sel(frequency=120))
    grows = rises(a_x, "frequency") and is_polynomial(a_x, "frequency", 2)
    best = at_largest(changed(7, frequency=60, beta=fine(20, 35, 0.01))["acceleration_x"])["beta"]
    there = changed(7, beta=best)["throw_number"]
    return [
        Judgement(
            "The acceleration grows with frequency; beta matters at high frequency.",
            HOLDS if grows and high > 10 * low else NOT_REPRODUCED,
            f"It grows with the square of the frequency. Over beta it changes by {low:.1f} m/s2 at "
            f"20 Hz and by {high:.0f} at 120 Hz. The best beta is {best:.1f} deg at every "
            f"frequency; from {crossing(there, 1):.0f} Hz on that is beyond lift-off.",
        )
    ]


def amplitude_and_frequency() -> list[Judgement]:
    """Judge the claims of figures 5.9 and 5.10."""
    a_x = data(9)["acceleration_x"]
    strength = a_x["amplitude"] * (2 * np.pi * a_x["frequency"]) ** 2
    y, x = xr.broadcast(a_x, strength)
    per_drive, constant = np.polyfit(x.values.ravel(), y.values.ravel(), 1)
    lift_off = float((strength / data(9)["throw_number"]).mean())
    shape = is_polynomial(a_x, "amplitude", 1) and is_polynomial(a_x, "frequency", 2)
    return [
        Judgement(
            "Not linear in frequency, linear in amplitude.",
            HOLDS if shape else NOT_REPRODUCED,
            f"a_x = {per_drive:.3f} A0 w^2 - {-constant:.1f} m/s2. The part has left the floor "
            f"where A0 w^2 is above {lift_off:.1f} m/s2.",
        )
    ]


def across_the_track() -> list[Judgement]:
    """Judge the claims of figures 5.11 and 5.12."""
    box = {"alpha": (0.0, 20.0), "beta": (0.0, 45.0)}
    a_y = changed(11, alpha=fine(0, 50, 0.1), beta=fine(0, 60, 0.1))["acceleration_y"]
    level, _, misfit = nearest_region(a_y, box, above=False)
    ends = (crossing(a_y.sel(beta=0), level), crossing(a_y.sel(alpha=0), level))
    coarse = data(11)["acceleration_y"]
    short = shortfall(coarse, box, above=False)
    small = extents(abs(a_y) <= 5)
    return [
        Judgement(
            "The minimum interval is alpha 0 to 20, beta 0 to 45 deg.",
            REPRODUCED if misfit <= EDGE else NOT_REPRODUCED,
            f"a_y <= {level:.1f} m/s2 reaches alpha {ends[0]:.1f} and beta "
            f"{ends[1]:.1f} deg, each where the other angle is 0. The minimum, "
            f"{float(coarse.min()):.1f} m/s2, lies at (0, 0), where nothing pushes sideways.",
        ),
        Judgement(
            "The acceleration is low all over that interval.",
            HOLDS if short <= BEST else NOT_REPRODUCED,
            f"It reaches {float(coarse.sel(alpha=20, beta=45)):.1f} m/s2 at (20, 45) deg, "
            f"{100 * short:.0f} % of the range of all values above the minimum and more than the "
            f"{float(coarse.sel(alpha=0, beta=90)):.1f} at (0, 90) deg. |a_y| <= 5 m/s2 ends at "
            f"alpha {small['alpha'][1]:.0f}, beta {small['beta'][1]:.0f} deg.",
        ),
    ]


def across_by_friction() -> list[Judgement]:
    """Judge the claims of figures 5.13 and 5.14."""
    rate = slope(data(13)["acceleration_y"])
    beta = crossing(rate)
    near = changed(13, beta=[beta - 0.01, beta + 0.01])["acceleration_y"]
    saddle = crossing(near.isel(beta=1) - near.isel(beta=0))
    ends = (float(rate.sel(beta=0)), float(rate.sel(beta=90)))
    return [
        Judgement(
            "A hyperbolic surface; friction matters at small and at large beta.",
            HOLDS if 0 < saddle < 1 and ends[0] < 0 < ends[1] else NOT_REPRODUCED,
            f"The surface has a saddle at beta {beta:.2f} deg, friction {saddle:.3f}, at lift-off. "
            f"The slope over friction is {ends[0]:.1f} m/s2 at beta 0 and {ends[1]:.1f} at 90 deg; "
            f"it rises with friction beyond lift-off only.",
        )
    ]


def across_by_frequency() -> list[Judgement]:
    """Judge the claims of figures 5.15 and 5.16."""
    a_y = data(15)["acceleration_y"]
    shape = is_polynomial(a_y, "frequency", 2) and is_sinusoidal(a_y, "beta")
    best = at_largest(changed(15, frequency=60, beta=fine(50, 70, 0.01))["acceleration_y"])["beta"]
    chosen = extents(compromises())
    bare = changed(11, variant="physical", alpha=0)["acceleration_y"]
    return [
        Judgement(
            "Parabolic in frequency, sinusoidal in beta.",
            HOLDS if shape else NOT_REPRODUCED,
            f"Fits of these shapes are exact. The maximum over beta is at {best:.1f} deg.",
        ),
        Judgement(
            "Best at small angles, where a_x is high and a_y low.",
            HOLDS if chosen["alpha"][1] <= 20 and chosen["beta"][1] <= 45 else NOT_REPRODUCED,
            f"At 60 Hz, friction 0.5, the best trade-offs of a_x and |a_y| (to 0.1 "
            f"m/s2) are alpha {span(chosen['alpha'], 0)}, beta {span(chosen['beta'])} deg, from "
            f"lift-off on. With the friction disc |a_y| at alpha 0 is "
            f"{float(abs(bare).max()):.0f}: there is no such trade-off.",
        ),
    ]


def compromises() -> xr.DataArray:
    """Return a mask of the angles of 5.1 and 5.11 on the trade-off of a_x and |a_y|."""
    a_x, a_y = data(1)["acceleration_x"], abs(data(11)["acceleration_y"]).round(1)
    x, y = a_x.values.ravel(), a_y.values.ravel()
    order = np.lexsort((y, -x))
    lowest = np.minimum.accumulate(y[order])
    kept = np.zeros(x.size, dtype=bool)
    kept[order] = np.concatenate([[True], y[order][1:] < lowest[:-1]])
    return a_x.copy(data=kept.reshape(a_x.shape))


def across_by_friction_and_frequency() -> list[Judgement]:
    """Judge the claims of figures 5.17 and 5.18."""
    a_y = data(17)["acceleration_y"]
    rate = slope(a_y)
    shape = is_polynomial(a_y, "friction", 1) and is_polynomial(a_y, "frequency", 2)
    ends = (float(rate.sel(frequency=20)), float(rate.sel(frequency=120)))
    return [
        Judgement(
            "Linear in friction, parabolic in frequency; friction matters at both ends.",
            HOLDS if shape and ends[0] < 0 < ends[1] else NOT_REPRODUCED,
            f"The slope over friction is {ends[0]:.1f} m/s2 at 20 Hz, zero at {crossing(rate):.1f} "
            f"Hz, at lift-off, and {ends[1]:.1f} at 120 Hz.",
        )
    ]


def angular_over_angles() -> list[Judgement]:
    """Judge the claims of figures 5.19 and 5.20."""
    turn = data(19)["angular_acceleration"]
    ratio = turn / changed(19, variant="derived")["angular_acceleration"].where(turn > 0)
    shape = is_sinusoidal(turn, "alpha") and is_sinusoidal(turn, "beta")
    friction = "friction" in changed(19, friction=[0.1, 0.9])["angular_acceleration"].dims
    return [
        Judgement(
            "Sinusoidal in both angles.",
            HOLDS if shape else NOT_REPRODUCED,
            f"Fits of this shape are exact. Friction plays "
            f"{'a' if friction else 'no'} part, and the value is {float(ratio.mean()):.1f} times "
            f"that of the same free body with the inertia about the contact line.",
        )
    ]


def angular_over_frequency() -> list[Judgement]:
    """Judge the claims of figure 5.21."""
    turn = data(21)["angular_acceleration"]
    shape = is_polynomial(turn, "frequency", 2) and is_sinusoidal(turn, "beta")
    return [
        Judgement(
            "Parabolic in frequency, sinusoidal in beta; grows with frequency.",
            HOLDS if shape and rises(turn, "frequency") else NOT_REPRODUCED,
            "Fits of these shapes are exact; three times too large, as 5.19.",
        )
    ]
