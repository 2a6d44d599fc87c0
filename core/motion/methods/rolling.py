"""Round parts that roll: the motion of a block, by any method, read as that of the part (18.2).

There is no kernel of their own. In pure rolling a part moves as a block whose friction is the
rolling resistance, kap/(1 + kap) times as fast; where it cannot roll all the time, or nothing
resists its rolling, the mean is known without following it, or is none. Its slip is a block, too.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.mechanics.rolling import RollingContact
from vibrafeed.core.motion import planar
from vibrafeed.core.motion.groups import Contacts, Groups, cells_of
from vibrafeed.core.motion.kernels.constants import PIECE
from vibrafeed.core.motion.method import Follow, Method
from vibrafeed.core.motion.methods.events import planar_motion
from vibrafeed.core.motion.result import ANSWERED, STATUS, Motion
from vibrafeed.core.quantities import MOTION_MODES
from vibrafeed.core.watch import Watch

WAYS = {MOTION_MODES["forward"].value: 1.0, MOTION_MODES["backward"].value: -1.0}
"""Sign of the velocity by motion mode."""
TOLERANCE, MAX_PERIODS = 1e-12, 1000.0
"""Settings of the method `events`, by which a block is followed once more."""
ROUNDING = 1e-12
"""Relative excess over the friction that counts as rounding."""


def block_groups(contact: RollingContact) -> Groups:
    """Return the dimensionless numbers of a sliding block that moves like a given rolling part.

    So the methods for blocks serve for round parts, too. Its friction is the rolling resistance c;
    its load is the part's, and w/c for the friction w of the wall. Without rolling resistance its
    friction is the wall's alone, on a floor under the part's load. A part whose motion is known
    without it is replaced by a block at rest (theory 18.2). `contact` holds the dimensionless
    numbers of the rolling part.
    """
    known = contact.free | contact.lifts | contact.runs_away
    rubs = contact.resistance > 0
    resistance = np.where(rubs, contact.resistance, 1.0)
    friction = np.where(rubs, resistance, contact.drag / np.where(rubs, 1.0, contact.load))
    return Groups(
        drive_number_along=np.where(known, 0.0, contact.along),
        drive_number_normal=np.where(known | ~rubs, 0.0, contact.normal),
        gravity_number_along=np.where(known, 0.0, contact.uphill),
        gravity_number_normal=contact.load + np.where(rubs, contact.drag / resistance, 0.0),
        friction_static=friction,
        friction_kinetic=friction,
    )


def slip_groups(contact: RollingContact) -> Groups:
    """Return the dimensionless numbers of the block that moves as the contact of a part slips.

    s' = D + (1 + kap) f, with kap = m r^2/I: the friction of the block is 1 + kap times that of the
    floor. A part that runs down turns one way, so that rolling resistance c and the friction w of
    the wall join the push D: w uphill, kap c n downhill, at most kap mu_k n, with which the part
    does not turn. On other parts both are left out. `contact` holds the dimensionless numbers of
    the part.
    """
    way = np.where(contact.runs_away, np.sign(contact.uphill), 0.0)
    turning = way * contact.factor * np.minimum(contact.resistance, contact.kinetic)
    return Groups(
        drive_number_along=contact.along + turning * contact.normal,
        drive_number_normal=contact.normal,
        gravity_number_along=contact.uphill + turning * contact.load - way * contact.drag,
        gravity_number_normal=contact.load,
        friction_static=(1 + contact.factor) * contact.static,
        friction_kinetic=(1 + contact.factor) * contact.kinetic,
        restitution=contact.restitution,
    )


def mean_acceleration(contact: RollingContact) -> Array:
    """Return the mean acceleration along the track in the long run, over gravity [1].

    That of `rolling_down` where the slip stays bounded, of `slipping_down` where it runs away, 0
    where the part is held. Where static friction would bound the slip and kinetic friction would
    not, the slip is followed from rest. NaN if that has no exact answer: with rolling resistance
    in hops, or beyond kinetic friction. `contact` holds the dimensionless numbers of the part.
    """
    rolling, slipping = contact.rolling_down, contact.slipping_down
    down = np.where(contact.unbounded_slip, slipping, rolling)
    either = ~contact.unbounded_slip & (slipping > (1 + ROUNDING) * rolling) & ~contact.surely_rolls
    if either.any():
        wide = np.broadcast_arrays(*contact, either)
        open_cells = RollingContact(*(field[either] for field in wide[:-1]))
        down = np.broadcast_to(down, either.shape).copy()
        down[either] = _down_by_slip(open_cells)
    return np.asarray(0.0 - np.sign(contact.uphill) * down)  # no -0


def _down_by_slip(contact: RollingContact) -> Array:
    """Return the mean acceleration downhill of parts whose slip is followed, from rest [1]."""
    slip = planar_motion(slip_groups(contact), tolerance=TOLERANCE, max_periods=MAX_PERIODS)
    exact = (contact.resistance == 0) | (~contact.lifts & (contact.resistance <= contact.kinetic))
    bounded = exact & np.isin(slip.status, [STATUS[name] for name in ANSWERED])
    away = exact & (slip.status == STATUS["runaway"])
    unbounded = np.where(away, contact.slipping_down, np.nan)
    return np.where(bounded, contact.rolling_down, unbounded)


def always_rolls(contact: RollingContact, watch: Watch | None) -> Mask:
    """True where a round part never slips: the floor's friction suffices over the whole cycle.

    `contact` holds the dimensionless numbers of the rolling part, arrays over the cells. Bounds
    decide nearly all cells; the motion of each other cell is followed, and the largest ratio of the
    force of rolling to the load is compared with static friction. Cells that `watch` leaves undone
    are False.
    """
    rolls = contact.surely_rolls
    open_cells = ~(rolls | contact.surely_slips | contact.free | contact.runs_away)
    if not open_cells.any():
        return rolls
    wide = np.broadcast_arrays(*contact, rolls, open_cells)
    *fields, known, unknown = (np.ravel(single) for single in wide)
    always: Mask = known.copy()
    watch = watch or Watch()
    with watch.flag() as stop:
        for cell_number in np.flatnonzero(unknown):
            if watch.stopped():
                break
            single = RollingContact(*(field[cell_number] for field in fields))
            (cell,), _ = cells_of(
                block_groups(single), tolerance=TOLERANCE, max_periods=MAX_PERIODS
            )
            pieces = planar.follow(cell, stop)[0]
            always[cell_number] = most_traction(single, pieces) <= (1 + ROUNDING) * float(
                single.static
            )
    return always.reshape(wide[0].shape)


def most_traction(contact: RollingContact, pieces: Array) -> float:
    """Return the largest ratio of friction to load that a round part needs to roll over a cycle.

    It slips nowhere if this is within static friction. |D - w sgn(u) + kap c n sgn(u)|/((1 + kap)
    n) while it rolls, (|D| - w)/n at rest, with the push D along less gravity, the wall's friction
    w, the inertia factor kap = m r^2/I, the rolling resistance c, the load n and the velocity u.
    Infinite if the drive lifts the part. `contact` holds the dimensionless numbers of one part,
    `pieces` the motion pieces of the cycle of its equivalent block (columns of `PIECE`).
    """
    # The pieces are those of a drive that points up and forwards: the mirror image, else.
    normal = abs(float(contact.normal))
    along = float(contact.along) * (-1.0 if contact.normal < 0 else 1.0)
    uphill = float(contact.uphill) * (-1.0 if along < 0 else 1.0)
    along, most = abs(along), 0.0
    for piece in pieces:
        start, way = piece[PIECE.phase], WAYS.get(int(piece[PIECE.mode]), 0.0)
        end = start + piece[PIECE.span]
        peaks = np.pi / 2 + np.pi * np.arange(-2, 8)
        for phase in (start, end, *peaks[(peaks > start) & (peaks < end)]):
            sine = np.sin(phase)
            push, load = along * sine - uphill, float(contact.load) - normal * sine
            if load <= 0.0:
                return float("inf")
            if way:
                push += way * (contact.factor * contact.resistance * load - contact.drag)
                needed = abs(push) / (1 + contact.factor)
            else:
                needed = max(0.0, abs(push) - contact.drag)
            most = max(most, float(needed / load))
    return most


def as_rolling(
    contact: RollingContact, acceleration: Array, block: Motion, watch: Watch | None
) -> Motion:
    """Return a round part's motion, converted from `block`, that of its equivalent block.

    Velocities are the share kap/(1 + kap) of the block's, with kap = m r^2/I. No means where the
    part runs away or slips at times (`rolls_and_slips`). `contact` holds the dimensionless numbers
    of the part, `acceleration` its mean acceleration; `watch` may stop the work.
    """
    rolls = always_rolls(contact, watch) & ~np.isnan(acceleration)
    status = np.where(
        np.abs(acceleration) > 0, STATUS["runaway"],
        np.where(contact.free, STATUS["neutral"],
                 np.where(rolls, block.status, STATUS["rolls_and_slips"])),
    ).astype(np.int8)  # fmt: skip
    none = np.isin(status, [STATUS["runaway"], STATUS["rolls_and_slips"]])
    neutral = status == STATUS["neutral"]

    def means(values: Array, scale: Array | float = 1.0) -> Array:
        """Return a mean value of the part, scaled from that of its block."""
        return np.where(none, np.nan, np.where(neutral, 0.0, scale * values))

    found = {name: means(getattr(block, name)) for name in Motion._fields if name != "status"}
    for name in ("velocity", "spread", "error"):
        found[name] = means(getattr(block, name), contact.share)
    found["across"] = np.where(none, np.nan, 0.0)
    return Motion(**{n: np.broadcast_to(v, status.shape) for n, v in found.items()}, status=status)


def _rolled(method: Method) -> Method:
    """Return the method for round parts that follows equivalent blocks by another method.

    A ball or roller moves as a block of other friction. `method` is the one for blocks; the new one
    gives neither trajectories nor energies.
    """

    def follow(contacts: Contacts) -> Follow:
        """Return the motion equation's function for round parts."""
        block = method.follow(contacts)

        def motion(
            *, groups: Groups, rolling_contact: RollingContact, mean_acceleration: Array,
            watch: Watch | None = None, **inputs: Any,
        ) -> Motion:  # fmt: skip
            """Return the motion of a round part, computed as that of its equivalent block."""
            motion: Motion = block(groups=groups, watch=watch, **inputs)
            return as_rolling(rolling_contact, mean_acceleration, motion, watch)

        return motion

    return replace(method, follow=follow, course=None, energy=None)


def of_slip(block: Follow) -> Follow:
    """Return the function of an equation that follows the slip at the contact of a round part.

    The slip moves as a block whose friction is larger. `block` is the function of the motion of a
    block; the new one takes the argument `slip_groups` in place of `groups`.
    """

    def slip_motion(*, slip_groups: Groups, watch: Watch | None = None, **inputs: Any) -> Motion:
        """Return the slip of a round part's contact, computed as the motion of a block."""
        motion: Motion = block(groups=slip_groups, watch=watch, **inputs)
        return motion

    return slip_motion


def rolled(methods: dict[str, Method]) -> dict[str, Method]:
    """Return the methods for round parts, made from those for blocks."""
    return {name: _rolled(method) for name, method in methods.items()}
