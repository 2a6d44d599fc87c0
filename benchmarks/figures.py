"""Judges chapter 5 and draws its figures, for docs/thesis.md: `python -m benchmarks.figures`.

Each claim of the source about a figure is put to the data of configs/figures, which hold the
formulas as printed. A function for each figure, or for each pair that shows the same data, measures
what the claim speaks of and decides from the numbers.
"""

from __future__ import annotations

import io
import tomllib
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from PIL import Image

from core.plots import draw
from core.quantities import REGIMES
from core.study import SweepStudy, load_study, parse_study
from core.sweep import sweep

ROOT = Path(__file__).parents[1]
STUDIES = ROOT / "configs" / "figures"
PICTURES = ROOT / "docs" / "figures"
PAGE = ROOT / "docs" / "thesis.md"
BEGIN = "<!-- Written by `python -m benchmarks.figures`: begin. -->"
END = "<!-- Written by `python -m benchmarks.figures`: end. -->"

DPI = 84
COLOURS = 256  # of a picture's palette

HOLDS = "holds"
REPRODUCED = "reproduced"
NOT_REPRODUCED = "not reproduced"
ARTEFACT = "artefact beyond lift-off"
IMPOSSIBLE = "cannot be reproduced"
VERDICTS = (HOLDS, REPRODUCED, NOT_REPRODUCED, ARTEFACT, IMPOSSIBLE)

EXACT = 1e-11  # of the largest value: rounding
EDGE = 1.0  # degree: how far the edge of a region may lie from the printed one
GOOD = 0.8  # of the largest velocity: what a good region is taken to mean
SMALL = 0.5  # likewise for a small velocity
SLIGHT = 0.01  # likewise for a slight change
BEST = 0.25  # of all values: what high, or low, all over a region is taken to mean


class Judgement(NamedTuple):
    """A claim of the source, what became of it, and the numbers behind the verdict."""

    claim: str
    verdict: str
    evidence: str


# --- data


def path_of(number: int) -> Path:
    """Return the study of figure 5.number."""
    return STUDIES / f"fig-5-{number}.toml"


def picture_of(number: int) -> Path:
    """Return the picture of figure 5.number."""
    return PICTURES / f"fig-5-{number}.png"


@cache
def study(number: int) -> SweepStudy:
    """Return the study of figure 5.number."""
    return load_study(path_of(number))


@cache
def data(number: int) -> xr.Dataset:
    """Return the data of figure 5.number."""
    return sweep(study(number))


def changed(number: int, *, variant: str | None = None, **parameters: object) -> xr.Dataset:
    """Return the figure's data with another variant, or with other values of parameters."""
    content = tomllib.loads(path_of(number).read_text(encoding="utf-8"))
    content["parameters"] |= parameters
    content["variant"] = variant or content["variant"]
    return sweep(parse_study(content))


def fine(start: float, stop: float, step: float) -> dict[str, float]:
    """Return a range of a study."""
    return {"start": start, "stop": stop, "step": step}


# --- measures


def slope(values: xr.DataArray) -> xr.DataArray:
    """Return the change from friction 0 to 1."""
    return values.sel(friction=1) - values.sel(friction=0)


def crossing(values: xr.DataArray, level: float = 0.0) -> float:
    """Return where values over one axis first pass a level, between two points by a line."""
    (dim,) = values.dims
    x, y = values[dim].values, values.values - level
    i = int(np.flatnonzero(np.sign(y[:-1]) != np.sign(y[1:]))[0])
    return float(x[i] - y[i] * (x[i + 1] - x[i]) / (y[i + 1] - y[i]))


def at_largest(values: xr.DataArray) -> dict[str, float]:
    """Return the place of the largest value."""
    place = values.where(values == values.max(), drop=True)
    return {str(dim): float(place[dim].item()) for dim in values.dims}


def is_polynomial(values: xr.DataArray, dim: str, degree: int) -> bool:
    """Return whether values over an even axis are a polynomial, and of no lower degree."""
    size = float(abs(values).max())
    rest = float(abs(values.diff(dim, degree + 1)).max())
    return rest <= EXACT * size < float(abs(values.diff(dim, degree)).max())


def is_sinusoidal(values: xr.DataArray, dim: str) -> bool:
    """Return whether values over an angle are a constant, a cosine and a sine of it."""
    angle = np.deg2rad(values[dim].values)
    shapes = np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=1)
    rows = values.transpose(dim, ...).values.reshape(angle.size, -1)
    fit, *_ = np.linalg.lstsq(shapes, rows)
    return bool(abs(shapes @ fit - rows).max() <= EXACT * abs(rows).max())


def rises(values: xr.DataArray, dim: str) -> bool:
    """Return whether values never fall over an axis."""
    return bool((values.diff(dim) >= 0).all())


def extents(inside: xr.DataArray) -> dict[str, tuple[float, float]]:
    """Return the least and largest coordinates of a region, by axis."""
    found = {}
    for dim in map(str, inside.dims):
        along = inside[dim].where(inside.any([other for other in inside.dims if other != dim]))
        found[dim] = (float(along.min()), float(along.max()))
    return found


def nearest_region(
    values: xr.DataArray, box: Mapping[str, tuple[float, float]], *, above: bool
) -> tuple[float, dict[str, tuple[float, float]], float]:
    """Return the level, in halves, whose region fits a printed box best, its extents, its misfit.

    The misfit is the largest distance of an edge from the printed one.
    """
    fits = []
    for level in np.arange(np.ceil(2 * values.min()), np.floor(2 * values.max())) / 2:
        found = extents(values >= level if above else values <= level)
        misfit = max(abs(found[d][i] - box[d][i]) for d in box for i in (0, 1))
        fits.append((misfit, float(level), found))
    misfit, level, found = min(fits, key=lambda fit: fit[:2])
    return level, found, misfit


def shortfall(
    values: xr.DataArray, box: Mapping[str, tuple[float, float]], *, above: bool
) -> float:
    """Return how far the worst value of a box lies from the best of all, over their range."""
    inside = values.sel({dim: slice(*ends) for dim, ends in box.items()})
    gap = values.max() - inside.min() if above else inside.max() - values.min()
    return float(gap / (values.max() - values.min()))


def share(inside: xr.DataArray) -> str:
    """Return the share of cells in percent."""
    return f"{100 * float(inside.mean()):.0f} %"


def in_regimes(number: int, *names: str) -> xr.DataArray:
    """Return where the figure's data are in one of some regimes."""
    return data(number)["regime"].isin([REGIMES[name].value for name in names])


def beyond_lift_off(number: int) -> xr.DataArray:
    """Return where the part has left the floor; the data keep all dimensions of the regime."""
    return in_regimes(number, "flight", "flight_and_wall_lost")


def wall_pulls(number: int) -> xr.DataArray:
    """Return where the wall would have to pull."""
    return in_regimes(number, "wall_lost", "flight_and_wall_lost")


def lift_off_angle() -> float:
    """Return the elevation of lift-off at 60 Hz and 0.5 mm [degree]."""
    return crossing(data(3)["throw_number"], 1)


def span(pair: tuple[float, float], digits: int = 1) -> str:
    """Return two numbers as a range."""
    return " to ".join(dict.fromkeys(f"{value:.{digits}f}" for value in pair))


# --- the cylinder on the plane


def best_region() -> list[Judgement]:
    """Judge 5.1 and 5.2."""
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
            f"The lowest value in it falls short of the maximum by {100 * short:.0f} % of the "
            f"range of all values.",
        ),
    ]


def friction_and_elevation() -> list[Judgement]:
    """Judge 5.3 and 5.4."""
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
    """Judge 5.5 and 5.6."""
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
    """Judge 5.7 and 5.8."""
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
    """Judge 5.9 and 5.10."""
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
    """Judge 5.11 and 5.12."""
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
    """Judge 5.13 and 5.14."""
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
            f"all that rises with friction lies beyond lift-off.",
        )
    ]


def across_by_frequency() -> list[Judgement]:
    """Judge 5.15 and 5.16."""
    a_y = data(15)["acceleration_y"]
    shape = is_polynomial(a_y, "frequency", 2) and is_sinusoidal(a_y, "beta")
    best = at_largest(changed(15, frequency=60, beta=fine(50, 70, 0.01))["acceleration_y"])["beta"]
    chosen = extents(compromises())
    bare = changed(11, variant="physical", alpha=0)["acceleration_y"]
    return [
        Judgement(
            "Parabolic in frequency, sinusoidal in beta.",
            HOLDS if shape else NOT_REPRODUCED,
            f"Fits of these shapes leave nothing over. The maximum over beta is at {best:.1f} deg.",
        ),
        Judgement(
            "Best at small angles, where a_x is high and a_y low.",
            HOLDS if chosen["alpha"][1] <= 20 and chosen["beta"][1] <= 45 else NOT_REPRODUCED,
            f"At 60 Hz, friction 0.5, the angles that no others beat in both a_x and |a_y| (to 0.1 "
            f"m/s2) are alpha {span(chosen['alpha'], 0)}, beta {span(chosen['beta'])} deg, from "
            f"lift-off on. With the friction disc |a_y| at alpha 0 is "
            f"{float(abs(bare).max()):.0f}: there is no such trade-off.",
        ),
    ]


def compromises() -> xr.DataArray:
    """Return which angles of 5.1 and 5.11 no others beat in a_x and |a_y|, to 0.1 m/s2."""
    a_x, a_y = data(1)["acceleration_x"], abs(data(11)["acceleration_y"]).round(1)
    x, y = a_x.values.ravel(), a_y.values.ravel()
    order = np.lexsort((y, -x))
    lowest = np.minimum.accumulate(y[order])
    kept = np.zeros(x.size, dtype=bool)
    kept[order] = np.concatenate([[True], y[order][1:] < lowest[:-1]])
    return a_x.copy(data=kept.reshape(a_x.shape))


def across_by_friction_and_frequency() -> list[Judgement]:
    """Judge 5.17 and 5.18."""
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
    """Judge 5.19 and 5.20."""
    turn = data(19)["angular_acceleration"]
    ratio = turn / changed(19, variant="derived")["angular_acceleration"].where(turn > 0)
    shape = is_sinusoidal(turn, "alpha") and is_sinusoidal(turn, "beta")
    friction = "friction" in changed(19, friction=[0.1, 0.9])["angular_acceleration"].dims
    return [
        Judgement(
            "Sinusoidal in both angles.",
            HOLDS if shape else NOT_REPRODUCED,
            f"Fits of this shape leave nothing over. Friction plays "
            f"{'a' if friction else 'no'} part, and the value is {float(ratio.mean()):.1f} times "
            f"that of the same free body with the inertia about the contact line.",
        )
    ]


def angular_over_frequency() -> list[Judgement]:
    """Judge 5.21."""
    turn = data(21)["angular_acceleration"]
    shape = is_polynomial(turn, "frequency", 2) and is_sinusoidal(turn, "beta")
    return [
        Judgement(
            "Parabolic in frequency, sinusoidal in beta; grows with frequency.",
            HOLDS if shape and rises(turn, "frequency") else NOT_REPRODUCED,
            "Fits of these shapes leave nothing over; three times too large, as 5.19.",
        )
    ]


# --- the rectangular part on the track


def velocity_over_drive() -> list[Judgement]:
    """Judge 5.22."""
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
    """Return the frequency at which K is zero at 0.1 mm; K is linear in f^2 [Hz]."""
    K = changed(22, variant=variant, amplitude="0.1 mm")["starting_acceleration"]  # noqa: N806
    per_square, constant = np.polyfit(K["frequency"] ** 2, K, 1)
    return float(np.sqrt(-constant / per_square))


def velocity_over_elevation() -> list[Judgement]:
    """Judge 5.23."""
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
            f"reached at {amplitude:.2f} mm. The effective distance plays no part in it.",
        ),
        Judgement(
            "Good for beta 0 to 40 deg.",
            HOLDS if good >= GOOD else NOT_REPRODUCED,
            f"At 1 mm, 40 deg the velocity is {good:.2f} of the largest.",
        ),
    ]


def velocity_over_frequency() -> list[Judgement]:
    """Judge 5.24."""
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
    """Judge 5.25."""
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
    """Judge 5.26."""

    def gain(variant: str) -> float:
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
            f"{100 * derived:+.2f} % with the sign of the lean corrected: there the claim "
            f"{'holds' if -SLIGHT < derived < 0 else 'fails too'}.",
        ),
        Judgement(
            "A large climb gamma gives a small velocity.",
            HOLDS if left <= SMALL else NOT_REPRODUCED,
            f"At gamma 90 deg the velocity is still {left:.3f} of that at 0 deg.",
        ),
    ]


def velocity_over_friction() -> list[Judgement]:
    """Judge 5.27."""
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
    """Return the distance from which on the velocity of 5.27 falls with friction [m]."""
    v = changed(27, frequency=frequency, distance=fine(0.19, 0.29, 0.001))["transport_velocity"]
    falls = (v.diff("friction") < 0).all("friction") if all_the_way else slope(v) < 0
    return float(v["distance"].where(falls).min())


MISSING = {
    28: ("the abscissa", "the radius", "gamma", "the effective distance", "the measured values"),
    29: ("the abscissa", "A0", "beta", "the radius", "the effective distance"),
}


def _comparison(number: int, numbers: str) -> Judgement:
    missing = MISSING[number]
    return Judgement(
        "The model describes what was measured adequately.",
        IMPOSSIBLE if missing else HOLDS,
        f"Not given: {', '.join(missing)}. {numbers}",
    )


def wolfsteiner_and_pfeiffer() -> list[Judgement]:
    """Judge 5.28."""
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
    """Judge 5.29."""
    without = changed(29, friction=0)["starting_acceleration"].values
    same = bool((data(29)["starting_acceleration"].values == without).all())
    text = (
        f"With alpha, gamma and delta 0 the wall carries nothing, and friction 0.3 and 0 give "
        f"{'the same' if same else 'different'} accelerations."
    )
    return [_comparison(29, text)]


FIGURES: dict[int, Callable[[], list[Judgement]]] = {
    1: best_region,
    2: best_region,
    3: friction_and_elevation,
    4: friction_and_elevation,
    5: friction_and_frequency,
    6: friction_and_frequency,
    7: elevation_and_frequency,
    8: elevation_and_frequency,
    9: amplitude_and_frequency,
    10: amplitude_and_frequency,
    11: across_the_track,
    12: across_the_track,
    13: across_by_friction,
    14: across_by_friction,
    15: across_by_frequency,
    16: across_by_frequency,
    17: across_by_friction_and_frequency,
    18: across_by_friction_and_frequency,
    19: angular_over_angles,
    20: angular_over_angles,
    21: angular_over_frequency,
    22: velocity_over_drive,
    23: velocity_over_elevation,
    24: velocity_over_frequency,
    25: velocity_over_angles,
    26: velocity_over_inclination,
    27: velocity_over_friction,
    28: wolfsteiner_and_pfeiffer,
    29: boothroyd,
}


# --- page and pictures


def section() -> str:
    """Return the part of the page between its marks."""
    judged = {function: function() for function in dict.fromkeys(FIGURES.values())}
    return "\n".join([*_overview(judged), *_figures(judged)])


def _overview(judged: Mapping[Callable[[], list[Judgement]], list[Judgement]]) -> Iterator[str]:
    yield "| figure | shows | scene, output | beyond lift-off | wall pulls | verdict |"
    yield "| --- | --- | --- | --- | --- | --- |"
    for number, function in FIGURES.items():
        track = study(number).scene == "rectangle-on-track"
        verdicts = "; ".join(dict.fromkeys(judgement.verdict for judgement in judged[function]))
        yield (
            f"| [5.{number}](figures/{picture_of(number).name}) | {_subject(number)} | "
            f"`{study(number).scene}`, `{study(number).outputs[0]}` | "
            f"{share(beyond_lift_off(number))} | {share(wall_pulls(number)) if track else ''} | "
            f"{verdicts} |"
        )


def _figures(judged: Mapping[Callable[[], list[Judgement]], list[Judgement]]) -> Iterator[str]:
    for function, numbers in groupby(FIGURES, FIGURES.__getitem__):
        group = list(numbers)
        names = " and ".join(f"5.{number}" for number in group)
        yield f"\n### Figure{'s' * (len(group) > 1)} {names}\n"
        subject = _subject(group[0]).removesuffix(" (surface)")
        studies = " and ".join(f"`configs/figures/{path_of(number).name}`" for number in group)
        yield f"{subject[0].upper()}{subject[1:]}; {studies}.\n"
        yield "| claim | verdict | numbers |"
        yield "| --- | --- | --- |"
        for judgement in judged[function]:
            cells = (text.replace("|", "\\|") for text in judgement)
            yield f"| {' | '.join(cells)} |"
        yield ""
        for number in group:
            yield f"![Figure 5.{number}: {_subject(number)}](figures/{picture_of(number).name})"


def _subject(number: int) -> str:
    return (study(number).title or "").partition(": ")[2]


def page(text: str) -> str:
    """Return the page with its part on the figures written anew."""
    head, _, rest = text.partition(BEGIN)
    _, _, tail = rest.partition(END)
    return f"{head}{BEGIN}\n\n{section()}\n\n{END}{tail}"


def draw_picture(number: int) -> None:
    """Draw a figure as its title says, as a small PNG."""
    kind = "surface" if "(surface)" in (study(number).title or "") else "contour"
    figure = draw(data(number), variable=study(number).outputs[0], kind=kind)
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=DPI)
    with Image.open(picture) as image:
        # Of the ways to choose a palette, this one keeps the colours of the colour bar.
        small = image.convert("RGB").quantize(
            COLOURS, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE
        )
        small.save(picture_of(number), format="PNG", optimize=True)


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    print(f"wrote {PAGE.name}")
    PICTURES.mkdir(exist_ok=True)
    for number in FIGURES:
        draw_picture(number)
    sizes = [picture_of(number).stat().st_size for number in FIGURES]
    print(
        f"drew {len(sizes)} pictures, {sum(sizes) / 1e6:.2f} MB, at most {max(sizes) / 1e3:.0f} kB"
    )
