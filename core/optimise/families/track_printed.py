"""The rectangle on the track, printed forces: as printed, and with the wall's sign corrected.

Theory 4.2, 12.
"""

from __future__ import annotations

from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from vibrafeed.core.optimise.codes import ACTIVE
from vibrafeed.core.optimise.families.family import Family
from vibrafeed.core.optimise.families.optimum import (
    Optimum,
    bounds_active,
    broadcast,
    optimum,
    statuses,
    tight,
    valid_inputs,
)
from vibrafeed.core.optimise.kernels.columns import TrackPrinted
from vibrafeed.core.study.optimise_study import Maximise


def track_fastest(
    *,
    variant: Literal["thesis", "derived"],
    vibration_acceleration: ArrayLike,
    gravity_along: ArrayLike,
    gravity_across: ArrayLike,
    friction_kinetic: ArrayLike,
    wall_contact: bool,
) -> Optimum:
    """Return the drive angles of the largest K on the track, with the source's printed forces.

    K is the acceleration along the track at rest. tan(alpha) = mu, beta = 0: K = P sqrt(1 + mu^2) -
    c -+ mu g_y. There the wall has to pull unless g_y is large (theory 4.2, 12). With
    `wall_contact` it may not, W = P cos(beta) sin(alpha) <= g_y at rest, and alpha = min(atan(mu),
    asin(g_y/P)). The `thesis` variant prints the balance with the other sign, W <= -g_y, which no
    lean onto the wall allows: `infeasible`.

    `vibration_acceleration` is P, `gravity_along` is c, along -x, `gravity_across` g_y, towards the
    wall [m/s2], `friction_kinetic` is mu; they broadcast. The result has the angles [rad], K
    [m/s2], binding constraints and a status.
    """
    P, c, gy, mu = broadcast(
        vibration_acceleration, gravity_along, gravity_across, friction_kinetic
    )
    within = (P >= 0) & (mu >= 0)
    valid, driven, (P, c, gy, mu) = valid_inputs(within, P, c, gy, mu)
    sign = 1.0 if variant == "derived" else -1.0
    wall_margin = sign * gy
    alpha = np.arctan(mu)
    infeasible = np.zeros_like(valid)
    if wall_contact:
        infeasible = valid & (wall_margin < 0)
        sine = np.clip(wall_margin / np.where(driven, P, 1.0), 0.0, 1.0)
        alpha = np.minimum(alpha, np.arcsin(sine))
    beta = np.zeros_like(alpha)
    K = P * (np.cos(alpha) + mu * np.sin(alpha)) - c - mu * wall_margin
    active = bounds_active(alpha, beta)
    if wall_contact:
        active |= tight(ACTIVE["wall"], wall_margin - P * np.sin(alpha), P + np.abs(gy))
    status = statuses(valid, infeasible, driven, K)
    return optimum(alpha, beta, K, np.zeros_like(K), active, status)


THESIS = Family(
    name="track_thesis",
    systems=(
        ("rectangle-on-track", "thesis", "acceleration_x"),
        ("rectangle-on-track", "thesis", "starting_acceleration"),
    ),
    closed={Maximise: partial(track_fastest, variant="thesis")},
    batch=(Maximise,),
    kernel=partial(TrackPrinted, side=-1.0),
    against=None,
)

DERIVED = Family(
    name="track_derived",
    systems=(
        ("rectangle-on-track", "derived", "acceleration_x"),
        ("rectangle-on-track", "derived", "starting_acceleration"),
        ("rectangle-on-track", "physical", "starting_acceleration"),
    ),
    closed={Maximise: partial(track_fastest, variant="derived")},
    batch=(Maximise,),
    kernel=partial(TrackPrinted, side=1.0),
    against=None,
)
