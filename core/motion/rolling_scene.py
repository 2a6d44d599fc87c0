"""The systems of round parts that roll along the track: ball, roller, disc on its edge (18.2).

There is no kernel of their own. In pure rolling a part moves as a block whose friction is the
rolling resistance, kap/(1 + kap) times as fast; where it cannot roll all the time, or nothing
resists its rolling, the mean is known without following it, or is none. Its slip is a block, too.
"""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from vibrafeed.core.mechanics import round_parts
from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.mechanics.rolling import RollingContact
from vibrafeed.core.motion import feeding, scales
from vibrafeed.core.motion.drives import limits
from vibrafeed.core.motion.events import EVENTS, follow, planar_motion
from vibrafeed.core.motion.kernels.constants import PIECE
from vibrafeed.core.motion.method import (
    ANSWERED,
    BLOCK_ON_FLOOR,
    STATUS,
    Groups,
    Method,
    Motion,
    cells_of,
    where,
    with_status,
)
from vibrafeed.core.motion.reference import REFERENCE
from vibrafeed.core.quantities import MOTION_MODES
from vibrafeed.core.scenes.scene import (
    STANDARD_GRAVITY,
    STATIC_ABOVE_KINETIC,
    Equation,
    Scene,
    fields,
)
from vibrafeed.core.watch import Watch

SOURCE = "theory 18.2"
BALL, ROLLER, DISC = "sphere-on-plane", "roller-on-plane", "disc-on-edge"


WAYS = {MOTION_MODES["forward"].value: 1.0, MOTION_MODES["backward"].value: -1.0}
"""Sign of the velocity by motion mode."""
SETTINGS: dict[str, Any] = dict(EVENTS.defaults)
"""By which a block is followed once more."""
ROUNDING = 1e-12
"""Relative excess over the friction that counts as rounding."""


def block_groups(rolling_contact: RollingContact) -> Groups:
    """Return the groups of the block that moves like the rolling part.

    Its friction is the rolling resistance c; its load is the part's, and w/c for the friction w of
    the wall. Without rolling resistance its friction is the wall's alone, on a floor under the
    part's load. A part whose motion is known without it is replaced by a block at rest (theory
    18.2).
    """
    contact = rolling_contact
    needs_no_motion = contact.free | contact.lifts | contact.runs_away
    has_resistance = contact.resistance > 0
    resistance = np.where(has_resistance, contact.resistance, 1.0)
    friction = np.where(
        has_resistance, resistance, contact.drag / np.where(has_resistance, 1.0, contact.load)
    )
    return Groups(
        drive_number_along=np.where(needs_no_motion, 0.0, contact.along),
        drive_number_normal=np.where(needs_no_motion | ~has_resistance, 0.0, contact.normal),
        gravity_number_along=np.where(needs_no_motion, 0.0, contact.uphill),
        gravity_number_normal=contact.load
        + np.where(has_resistance, contact.drag / resistance, 0.0),
        friction_static=friction,
        friction_kinetic=friction,
    )


def slip_groups(rolling_contact: RollingContact) -> Groups:
    """Return the groups of the block that moves as the contact point of a round part slips.

    s' = D + (1 + kap) f, with kap = m r^2/I: the friction of the block is 1 + kap times that of the
    floor. A part that runs down turns one way, so that rolling resistance c and the friction w of
    the wall join the push D: w uphill, kap c n downhill, at most kap mu_k n, with which the part
    does not turn. On other parts both are left out.
    """
    contact = rolling_contact
    direction = np.where(contact.runs_away, np.sign(contact.uphill), 0.0)
    turning_friction = direction * contact.factor * np.minimum(contact.resistance, contact.kinetic)
    return Groups(
        drive_number_along=contact.along + turning_friction * contact.normal,
        drive_number_normal=contact.normal,
        gravity_number_along=contact.uphill
        + turning_friction * contact.load
        - direction * contact.drag,
        gravity_number_normal=contact.load,
        friction_static=(1 + contact.factor) * contact.static,
        friction_kinetic=(1 + contact.factor) * contact.kinetic,
        restitution=contact.restitution,
    )


def mean_acceleration(*, rolling_contact: RollingContact, gravity: Array) -> Array:
    """Return the mean acceleration along the track in the long run [m s-2].

    Of a part that runs down -kap/(1 + kap) (g sin(gamma) - c n - w), whatever the drive, friction
    and rebounds, while the slip of its contact stays bounded; -(g sin(gamma) - mu n - w) where the
    slip runs away, beyond g sin(gamma) = ((1 + kap) mu - kap c) n + w, with the load n and the
    wall's friction w per mass; else 0. Where static friction would bound the slip and kinetic
    friction would not, the slip is followed from rest. NaN if that has no exact answer: with
    rolling resistance in hops, or beyond kinetic friction.
    """
    contact = rolling_contact
    rolling, slipping = contact.rolling_down, contact.slipping_down
    downhill = np.where(contact.unbounded_slip, slipping, rolling)
    is_undecided = (
        ~contact.unbounded_slip & (slipping > (1 + ROUNDING) * rolling) & ~contact.surely_rolls
    )
    if is_undecided.any():
        broadcast = np.broadcast_arrays(*contact, is_undecided)
        open_cells = RollingContact(*(field[is_undecided] for field in broadcast[:-1]))
        downhill = np.broadcast_to(downhill, is_undecided.shape).copy()
        downhill[is_undecided] = _downhill_by_slip(open_cells)
    return gravity * np.asarray(0.0 - np.sign(contact.uphill) * downhill)  # no -0


def _downhill_by_slip(contact: RollingContact) -> Array:
    # By the motion of the slip's block: where its mean is known the slip stays bounded, where it
    # runs away the part slides. NaN if neither is sure.
    slip = planar_motion(slip_groups(contact), **SETTINGS)
    is_exact = (contact.resistance == 0) | (
        ~contact.lifts & (contact.resistance <= contact.kinetic)
    )
    is_bounded = is_exact & np.isin(slip.status, [STATUS[name] for name in ANSWERED])
    runs_away = is_exact & (slip.status == STATUS["runaway"])
    unbounded = np.where(runs_away, contact.slipping_down, np.nan)
    return np.where(is_bounded, contact.rolling_down, unbounded)


def always_rolls(contact: RollingContact, watch: Watch | None) -> Mask:
    """True where a round part never slips: the floor's friction suffices over the whole cycle.

    Bounds decide nearly all cells; the motion of each other cell is followed. Cells that `watch`
    leaves undone are False.
    """
    rolls = contact.surely_rolls
    open_cells = ~(rolls | contact.surely_slips | contact.free | contact.runs_away)
    if not open_cells.any():
        return rolls
    broadcast = np.broadcast_arrays(*contact, rolls, open_cells)
    *fields, decided, open_values = (np.ravel(single) for single in broadcast)
    always: Mask = decided.copy()
    watch = watch or Watch()
    with watch.flag() as stop:
        for cell_number in np.flatnonzero(open_values):
            if watch.stopped():
                break
            single = RollingContact(*(field[cell_number] for field in fields))
            (cell,), _ = cells_of(block_groups(single), **SETTINGS)
            needed = _largest_traction(single, follow(cell, stop)[0])
            always[cell_number] = needed <= (1 + ROUNDING) * float(single.static)
    return always.reshape(broadcast[0].shape)


def _largest_traction(contact: RollingContact, pieces: Array) -> float:
    # The largest ratio of friction to load that rolling needs over a cycle of the block's motion:
    # |D - w sgn(u) + kap c n sgn(u)|/((1 + kap) n) while it rolls, (|D| - w)/n at rest, with the
    # push D along less gravity, the wall's friction w, kap = m r^2/I, the rolling resistance c, the
    # load n and the velocity u. Infinite if the drive lifts the part.
    # The pieces are those of a drive that points up and forwards: the mirror image, else.
    normal = abs(float(contact.normal))
    along = float(contact.along) * (-1.0 if contact.normal < 0 else 1.0)
    uphill = float(contact.uphill) * (-1.0 if along < 0 else 1.0)
    along, largest = abs(along), 0.0
    for piece in pieces:
        start, direction = piece[PIECE.phase], WAYS.get(int(piece[PIECE.mode]), 0.0)
        end = start + piece[PIECE.span]
        peaks = np.pi / 2 + np.pi * np.arange(-2, 8)
        for phase in (start, end, *peaks[(peaks > start) & (peaks < end)]):
            sine = np.sin(phase)
            push, load = along * sine - uphill, float(contact.load) - normal * sine
            if load <= 0.0:
                return float("inf")
            if direction:
                push += direction * (contact.factor * contact.resistance * load - contact.drag)
                needed = abs(push) / (1 + contact.factor)
            else:
                needed = max(0.0, abs(push) - contact.drag)
            largest = max(largest, float(needed / load))
    return largest


# --- equations


def floor_contact(
    *, rolling_share: Array, rolling_factor: Array, friction_static: Array,
    friction_kinetic: Array, restitution: Array, rolling_resistance: Array, load_number: Array,
    gravity_number_along: Array, drive_number_along: Array, drive_number_normal: Array,
) -> RollingContact:  # fmt: skip
    """Return the dimensionless numbers of the contact of a round part with the floor."""
    return RollingContact(
        share=rolling_share, factor=rolling_factor, static=friction_static,
        kinetic=friction_kinetic, restitution=restitution, resistance=rolling_resistance,
        drag=np.zeros(()), load=load_number, uphill=gravity_number_along,
        along=drive_number_along, normal=drive_number_normal,
    )  # fmt: skip


def wall_contact(
    *, rolling_share: Array, rolling_factor: Array, friction_static: Array,
    friction_kinetic: Array, rolling_resistance: Array, load_number: Array,
    gravity_number_along: Array, gravity_number_across: Array, wall_friction: Array,
    drive_number_along: Array, drive_number_normal: Array,
) -> RollingContact:  # fmt: skip
    """Return the dimensionless numbers of the contacts of a disc on its edge with floor and wall.

    The disc leans on the wall with gravity across, whose friction is its drag. It lands without
    rebound.
    """
    return RollingContact(
        share=rolling_share, factor=rolling_factor, static=friction_static,
        kinetic=friction_kinetic, restitution=np.zeros(()), resistance=rolling_resistance,
        drag=wall_friction * np.maximum(gravity_number_across, 0.0), load=load_number,
        uphill=gravity_number_along, along=drive_number_along, normal=drive_number_normal,
    )  # fmt: skip


RESULTS = (
    replace(scales.CONVEYING_VELOCITY, source=SOURCE),
    replace(scales.CONVEYING_VELOCITY_ERROR, source=SOURCE),
    Equation("efficiency", scales.efficiency, "theory 13.10"),
    *fields(
        "motion",
        SOURCE,
        stick_fraction=("stick", "share of the period in which the part does not move [1]"),
        forward_fraction=("forward", "share of the period in which the part rolls forward [1]"),
        backward_fraction=("backward", "share of the period in which the part rolls backward [1]"),
        period_multiple=(
            "multiple",
            "after how many periods of the drive the motion repeats; 0 where it has none [1]",
        ),
        motion_status=("status", "how the motion ended, as a status"),
    ),
    *feeding.RESULTS,
)
ANY_RESULT = frozenset(one.gives for one in RESULTS) - {"occupancy"} | {"regime"}
CONDITIONS = (
    with_status("unresolved", ("not_computed", "limit_reached", "no_solution",), ANY_RESULT, "roll"
    ),
    with_status("runaway", ("runaway",), ANY_RESULT),
    with_status("rolls_and_slips", ("rolls_and_slips",), ANY_RESULT),
    with_status("neutral", ("neutral",), ANY_RESULT),
    where(
        "stick", "rolling resistance, or the wall, holds the part all the time",
        lambda *, motion: motion.only("stick"), ANY_RESULT,
    ),
)  # fmt: skip
LEAVES_THE_WALL = where(
    "wall_lost", "nothing presses the disc onto the wall: the track leans the other way",
    lambda *, gravity_number_across: gravity_number_across < 0, ANY_RESULT | {"mean_acceleration"},
    otherwise="contact",
)  # fmt: skip
VALIDITY = (
    "The part moves along the track. Rolling resistance is a moment c r n against the rotation, "
    "with the radius r and the load n. Without it the part is not conveyed, whatever the drive and "
    "the friction. If the floor has too little friction for the part to roll all the time, or if "
    "the part hops, its mean velocity is not known: the regime is rolls_and_slips."
)


def _motion(
    method: Method, *, groups: Groups, rolling_contact: RollingContact, mean_acceleration: Array,
    watch: Watch | None = None, **settings: Any,
) -> Motion:  # fmt: skip
    # The motion of the equivalent block, read as that of the part; no means where it runs away or
    # does not always roll.
    contact = rolling_contact
    block: Motion = method.follow(groups=groups, contacts=BLOCK_ON_FLOOR, watch=watch, **settings)
    rolls = always_rolls(contact, watch) & ~np.isnan(mean_acceleration)
    status = np.where(
        np.abs(mean_acceleration) > 0, STATUS["runaway"],
        np.where(contact.free, STATUS["neutral"],
                 np.where(rolls, block.status, STATUS["rolls_and_slips"])),
    ).astype(np.int8)  # fmt: skip
    has_no_mean = np.isin(status, [STATUS["runaway"], STATUS["rolls_and_slips"]])
    means = {}
    for name, values in block._asdict().items():
        # A rolling part has the share kap/(1 + kap) of its block's velocity, kap = m r^2/I.
        scale = contact.share if name in ("velocity", "spread", "error") else 1.0
        scaled = np.where(status == STATUS["neutral"], 0.0, scale * values)
        means[name] = np.broadcast_to(np.where(has_no_mean, np.nan, scaled), status.shape)
    means["across"] = np.broadcast_to(np.where(has_no_mean, np.nan, 0.0), status.shape)
    return Motion(**{**means, "status": status})


METHODS = {
    method.name: replace(method, follow=partial(_motion, method), course=None, energy=None)
    for method in (EVENTS, REFERENCE)
}
"""The methods for round parts: a block is followed, and its motion read as that of the part."""


def _equations_of_method(block: Method, *, slips: bool) -> tuple[Equation, ...]:
    # The motion by a method and its results; with `slips` also the slip of the contact.
    def slip_motion(*, slip_groups: Groups, watch: Watch | None = None, **settings: Any) -> Motion:
        """Return the slip of a round part's contact, computed as the motion of a block."""
        return block.follow(groups=slip_groups, contacts=BLOCK_ON_FLOOR, watch=watch, **settings)

    settings = tuple(block.defaults)
    needs = ("rolling_contact", "mean_acceleration", "groups", *settings)
    says = "Return the motion of a round part, computed as that of its equivalent block."
    motion = Equation("motion", METHODS[block.name].follow, SOURCE, needs=needs, says=says)
    if not slips:
        return (motion, *RESULTS)
    return (
        motion,
        *RESULTS,
        Equation("slip_groups", slip_groups, SOURCE),
        Equation("slip_motion", slip_motion, SOURCE, needs=("slip_groups", *settings)),
        scales.product(
            "slip_velocity", "slip_motion.velocity", "velocity_scale", source=SOURCE,
            says="the mean slip velocity of the contact [m s-1]",
        ),
    )  # fmt: skip


_IN_PLANE = (
    *(each for each in scales.PLANAR_SCALES if each.gives != "drive_number_along"),
    Equation("drive_number_along", scales.drive_number_in_plane, SOURCE),
    *limits("sine", ("along", "normal")),
    Equation("rolling_share", round_parts.rolling_share, "theory 18.1"),
    Equation("groups", block_groups, SOURCE),
    Equation("mean_acceleration", mean_acceleration, SOURCE),
)
_ON_FLOOR = (*_IN_PLANE, Equation("rolling_contact", floor_contact, SOURCE))
_AT_WALL = (
    *(each for each in _IN_PLANE if each.gives != "gravity_number_normal"),
    Equation("gravity_number_across", scales.gravity_number_across, "theory 13.1"),
    Equation("gravity_number_normal", scales.leaning_gravity_number_normal, "theory 13.1"),
    scales.WALL_FRICTION,
    Equation("rolling_contact", wall_contact, SOURCE),
)


def _scene(name: str, title: str, kap: float, more_validity: str = "") -> Scene:
    # `kap` is m r^2/I of the full body.
    disc = name == DISC
    shape = round_parts.ball_factor if name == BALL else round_parts.tube_factor
    contact_equations = _AT_WALL if disc else _ON_FLOOR
    equations = (*contact_equations, Equation("rolling_factor", shape, "theory 18.1"))
    return Scene(
        name=name,
        title=title,
        source=SOURCE,
        validity=VALIDITY + more_validity,
        variants={
            block.name: (*equations, *_equations_of_method(block, slips=not disc))
            for block in (EVENTS, REFERENCE)
        },
        default_variant="events",
        conditions=dict.fromkeys(METHODS, (LEAVES_THE_WALL, *CONDITIONS) if disc else CONDITIONS),
        defaults={
            "gamma": 0.0, "gravity": STANDARD_GRAVITY, "hold_down_number": 0.0,
            "rolling_resistance": 0.0, "inner_diameter": 0.0, "rolling_factor": kap,
            "restitution": 0.0, **({"delta": 0.0} if disc else {}), **feeding.DEFAULTS,
        },
        constraints=(
            STATIC_ABOVE_KINETIC, scales.DRIVEN,
            *(each for method in METHODS.values() for each in method.refuses),
        ),
        choice="method",
        variant_defaults={method.name: method.defaults for method in METHODS.values()},
    )  # fmt: skip


SCENES = {
    BALL: _scene(BALL, "Motion in time of a ball that rolls on a plane", 2.5),
    ROLLER: _scene(ROLLER, "Motion in time of a roller or ring, its axis across the track", 2.0),
    DISC: _scene(
        DISC, "Motion in time of a disc on its edge, its face against the wall", 2.0,
        " Only the lean presses the disc onto the wall, through the centre of the disc. By "
        "default the wall has the friction of the floor.",
    ),
}  # fmt: skip
