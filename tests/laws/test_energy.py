"""Energy over a cycle: balances of any drive, closed answers, what it is for (theory 13.15)."""

from __future__ import annotations

import math

import numpy as np
import pytest

import night
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study, prepare_content
from vibrafeed.core.kinds import run_study
from vibrafeed.core.motion import waves
from vibrafeed.core.motion.events import energy_by_events, motion_by_events, spatial_path
from vibrafeed.core.motion.method import Contacts, Groups, cells_of, each
from vibrafeed.core.motion.waves import TURN, Wave
from vibrafeed.core.quantities import REGIMES

SETTINGS = {"tolerance": 1e-12, "max_periods": 300}
PLANE, TRACK, CYLINDER = Contacts(), Contacts(wall=True), Contacts(rolling=2.0)
DRIVES = ("sine", "harmonics", "steps")
WORKS = ["conveying_velocity", "friction_power", "impact_power", "drive_power", "drive_work"]
SLIDES = {"frequency": 50, "amplitude": "0.2 mm", "beta": 20, "friction": 0.3, "gravity": 9.8}


def random_wave(drive, sizes, pick):
    """Return harmonics of four orders, or five steps, with axes of these sizes."""
    count = sizes.shape[1]
    harmonics, steps = np.zeros((3, 2, 0, count)), np.zeros((4, 0, count))
    if drive == "harmonics":
        harmonics = pick(-0.25, 0.25, (3, 2, 4, count)) * sizes[:, None, None]
    else:
        steps, last = np.empty((4, 5, count)), pick(0.5, 1.5, (5, count))
        last /= last.sum(axis=0)
        levels = pick(-1, 1, (3, 5, count)) * sizes[:, None]
        steps[:3] = levels - (levels * last).sum(axis=1, keepdims=True)
        steps[3] = TURN * np.cumsum(last, axis=0)
        steps[3, -1] = TURN
    return Wave(harmonics, steps)


def random_groups(drive, count, seed, *, across=False, wall=False, curved=False):
    """Return groups of parts of all regimes, with rebounds, two coefficients and a hold-down."""
    pick = np.random.default_rng(seed).uniform
    beta, alpha = np.radians(pick(10, 50, count)), np.radians(pick(5, 35, count)) * across
    gamma, delta = np.radians(pick(-4, 4, count)), np.radians(pick(2, 20, count)) * wall
    load = np.cos(gamma) * np.cos(delta) + pick(-2, 2, count).clip(min=0)
    size = pick(0.2, 2.5, count) * load / np.sin(beta)
    friction, bounce = pick(0.15, 0.8, count), pick(-0.3, 0.4, count).clip(min=0)
    sizes = size * [np.cos(beta) * np.cos(alpha), np.cos(beta) * np.sin(alpha), np.sin(beta)]
    found = Groups(
        *(sizes[0], sizes[2], np.sin(gamma), load),
        friction_static=friction * pick(0.7, 1.4, count).clip(min=1),
        friction_kinetic=friction,
        restitution=bounce,
        drive_number_across=sizes[1],
        gravity_number_across=np.cos(gamma) * np.sin(delta),
        curvature_number=10 ** pick(-3, -1, count) if curved else 0.0,
        wall_friction=friction,
        wall_restitution=bounce,
    )
    if drive == "sine":
        return found
    wave = random_wave(drive, sizes, pick)
    return found._replace(
        wave=wave,
        drive_number_along=waves.bound(wave, waves.ALONG),
        drive_number_across=waves.bound(wave, waves.ACROSS),
        drive_number_normal=waves.bound(wave, waves.NORMAL),
    )


def both(groups, contacts):
    """Return motion and energy."""
    motion = motion_by_events(groups, contacts, **SETTINGS)
    return motion, energy_by_events(groups, contacts, motion, **SETTINGS)


def balance(motion, energy, lift):
    """Return by how much the work of the track is not what it went into, as a share of it.

    Where next to nothing is done, as a share of what the mean part has done to it.
    """
    repeats = motion.multiple > 0
    assert np.array_equal(np.isfinite(energy.drive), repeats)
    assert (energy.friction[repeats] >= 0).all()
    assert (energy.impact[repeats] >= -1e-16).all()
    assert repeats.mean() > 0.5
    size = np.abs(energy.drive) + energy.friction + energy.impact
    size = np.maximum(size, 0.1 * np.nanmedian(size))
    return (np.abs(energy.drive - energy.friction - energy.impact - lift) / size)[repeats]


@pytest.mark.parametrize("drive", DRIVES)
def test_the_track_works_for_heat_impacts_and_lift_in_the_plane(drive):
    groups = random_groups(drive, 400, 1)
    motion, energy = both(groups, PLANE)
    assert np.count_nonzero(energy.impact > 0) > 30
    assert balance(motion, energy, groups.gravity_number_along * motion.velocity).max() < 1e-11


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize(
    ("contacts", "curved"),
    [(PLANE, False), (CYLINDER, False), (TRACK, False), (TRACK, True)],
    ids=["plane", "cylinder", "wall", "curve"],
)
def test_the_track_works_for_heat_impacts_and_lift_in_space(drive, contacts, curved):
    """What drifts off the wall climbs the lean."""
    groups = random_groups(
        drive, night.count(20, 40), 3, across=True, wall=contacts.wall, curved=curved
    )
    motion, energy = both(groups, contacts)
    lift = groups.gravity_number_along * motion.velocity
    for number, part in enumerate(each(groups)[0]):
        if contacts.wall and motion.multiple[number] > 0:
            cycle = motion.multiple[number] * TURN
            ends = np.array([0.0, cycle * (1 - 1e-14)])
            path, _ = spatial_path(part, contacts, **SETTINGS, phases=ends)
            off = path.position[1, 1] - path.position[0, 1]
            lift[number] += part.gravity_number_across * off / cycle
    assert balance(motion, energy, lift).max() < 1e-10


def test_next_to_the_plane_it_is_that_of_the_plane():
    groups = random_groups("sine", 60, 5)._replace(restitution=0.0)
    motion, energy = both(groups, PLANE)
    near = groups._replace(drive_number_across=1e-9 * groups.drive_number_along)
    other_motion, other = both(near, PLANE)
    alike = (motion.multiple > 0) & (motion.multiple == other_motion.multiple)
    assert alike.sum() > 40
    for one, two in zip(energy, other, strict=True):
        assert np.allclose(one[alike], two[alike], rtol=1e-7, atol=1e-9)


def after_phases(tau, first, push, pull, d):
    """Return velocities after phases from tau on, under push sin(tau) - pull."""
    return first + push * (np.cos(tau) - np.cos(tau + d)) - pull * d


@pytest.mark.parametrize("restitution", [0.0, 0.3])
def test_a_quadrature_over_the_pieces_finds_the_same_and_balances_impulses(restitution):
    """The closed flows of 13.2, written anew: work, and the mean forces of floor and friction."""
    from vibrafeed.core.motion.events import follow
    from vibrafeed.core.motion.kernels.constants import MODE, PIECE
    from vibrafeed.core.motion.kernels.inputs import NEVER

    c, s, gs, gn, mu = 1.4, 1.6, 0.03, 1.1, 0.35
    groups = Groups(c, s, gs, gn, mu, mu, restitution)
    motion, energy = both(groups, PLANE)
    (cell,), _ = cells_of(groups, **SETTINGS)
    pieces, _, _, repeats = follow(cell, NEVER)
    assert repeats
    nodes, weights = np.polynomial.legendre.leggauss(40)
    friction = drive = swing = impact = floor = along = 0.0
    for piece, after in zip(pieces, np.roll(pieces, -1, axis=0), strict=True):
        tau, span, mode = piece[PIECE.phase], piece[PIECE.span], piece[PIECE.mode]
        d = np.append(span * (1 + nodes) / 2, span)
        flies, way = mode == MODE.flight, {MODE.forward: 1.0, MODE.backward: -1.0}.get(mode, 0.0)
        load = 0.0 * d if flies else gn - s * np.sin(tau + d)
        pushed = c * np.sin(tau + d)
        u = after_phases(tau, piece[PIECE.along], c + way * mu * s, gs + way * mu * gn, d)
        w = after_phases(tau, piece[PIECE.normal], s, gn, d) if flies else 0.0 * d
        rub = pushed - gs if mode == MODE.stick else way * mu * load
        measure = np.append(span / 2 * weights, 0.0)
        floor, along = floor + measure @ load, along + measure @ rub
        if mode == MODE.stick:
            continue
        drive += measure @ (pushed * u + s * np.sin(tau + d) * w)
        swing += measure @ (np.cos(tau + d) * (c * u + s * w))
        friction += measure @ (mu * load * np.abs(u))
        if flies:
            floor += after[PIECE.normal] - w[-1]
            along += u[-1] - after[PIECE.along]
            impact += (u[-1] ** 2 + w[-1] ** 2) / 2
            impact -= (after[PIECE.along] ** 2 + after[PIECE.normal] ** 2) / 2
    cycle = float(motion.multiple) * TURN
    for found, expected in zip(energy, (friction, impact, drive, swing), strict=True):
        assert float(found) == pytest.approx(expected / cycle, rel=1e-12)
    assert floor == pytest.approx(gn * cycle, rel=1e-12)
    assert along == pytest.approx(-gs * cycle, rel=1e-11)


# --- studies


def study(parameters, outputs=WORKS, **more):
    return {"kind": "simulate", "scene": "rectangle-on-plane", "outputs": outputs,
            "parameters": parameters, **more}  # fmt: skip


def run(parameters, **more):
    return run_study(parse_study(study(parameters, **more)))


def test_a_rail_with_a_clamp_has_a_closed_answer():
    """Slip of one direction under a constant load: all heat is load times way (Quaid's wave)."""
    slow, fast, held, g = 0.7 * 9.81, 5 * 9.81, 50.0, 9.81
    first = fast / (2 * (slow + fast))
    slip = 0.34 * held + g
    speed = 0.5 / 20 * slow**2 * (fast - slip) / ((slow + fast) * (slow + slip))
    found = run(
        {
            "frequency": 20, "gravity": g, "gamma": 90, "hold_down": held, "mass": "5 g",
            "friction_static": 0.44, "friction_kinetic": 0.34,
            "acceleration_along_1": slow, "acceleration_along_2": -fast,
            "acceleration_along_3": slow,
            "duration_1": first, "duration_2": 1 - 2 * first, "duration_3": first,
        },
        outputs=[*WORKS, "friction_work", "impact_work", "part_friction_power"],
    )  # fmt: skip
    assert float(found.friction_power) == pytest.approx(0.34 * held * speed, rel=1e-12)
    assert float(found.drive_power) == pytest.approx(slip * speed, rel=1e-12)
    assert float(found.friction_work) == pytest.approx(17.0, rel=1e-12)
    assert float(found.drive_work) == pytest.approx(26.81, rel=1e-12)
    assert float(found.impact_power) == float(found.impact_work) == 0.0
    assert float(found.part_friction_power) == pytest.approx(0.005 * 17 * speed, rel=1e-12)


def test_equal_groups_cost_alike():
    """Half the speed takes half the power and as much work a metre."""
    slow = run({**SLIDES, "frequency": 100, "amplitude": "0.05 mm"})
    fast = run(SLIDES)
    for name in ("friction_power", "drive_power"):
        assert float(slow[name]) == pytest.approx(0.5 * float(fast[name]), rel=1e-13)
    assert float(slow.drive_work) == pytest.approx(float(fast.drive_work), rel=1e-13)
    assert float(fast.drive_work) == pytest.approx(
        float(fast.drive_power) / float(fast.conveying_velocity), rel=1e-13
    )


def test_rest_costs_nothing_and_vain_work_is_unbounded():
    rest = run({**SLIDES, "amplitude": "1 um"})
    assert float(rest.drive_power) == float(rest.friction_power) == 0.0
    assert np.isnan(rest.drive_work)
    # Straight up and down it hops on the spot.
    vain = run(
        {**SLIDES, "amplitude": "0.3 mm", "beta": 90}, outputs=["drive_work", "impact_power"]
    )
    assert float(vain.impact_power) > 0
    assert np.isinf(vain.drive_work)
    assert vain.regime_drive_work.item() == REGIMES["unbounded"].value
    assert vain.regime.item() == REGIMES["hopping"].value


def test_without_friction_only_impacts_take_energy():
    found = run({**SLIDES, "friction": 0, "amplitude": "0.3 mm", "beta": 40})
    assert float(found.friction_power) == 0.0
    assert float(found.drive_power) == pytest.approx(float(found.impact_power), rel=1e-12)


def test_what_does_not_repeat_has_none():
    wild = {**SLIDES, "amplitude": "1.3 mm", "beta": 40, "restitution": 0.6}
    found = run(wild, outputs=["drive_power", "period_multiple"])
    assert float(found.period_multiple) == 0.0
    assert np.isnan(found.drive_power)


def test_the_reference_refuses_and_names_the_method_that_tells():
    with pytest.raises(StudyError) as refused:
        prepare_content(study(SLIDES, method="reference"))
    problems = refused.value.problems
    assert {problem.fix for problem in problems} == {"Set method to events"}
    assert {problem.about for problem in problems} == set(WORKS) - {"conveying_velocity"}


def test_it_is_computed_only_where_it_is_asked_for():
    plain = prepare_content(study(SLIDES, outputs=["conveying_velocity"])).plan
    assert "energy" not in [equation.gives for equation in plain.equations]
    asked = prepare_content(study(SLIDES)).plan
    assert len(asked.equations) == len(plain.equations) + 5  # the energy, and what is told of it
    with pytest.raises(StudyError) as refused:
        prepare_content(study(SLIDES, outputs=["part_drive_power"]))
    assert [problem.place for problem in refused.value.problems] == ["parameters.mass"]


def test_a_part_takes_its_mass_times_that():
    kinds = ("friction", "impact", "drive")
    outputs = [f"{part}{kind}_power" for kind in kinds for part in ("part_", "")]
    found = run({**SLIDES, "amplitude": "0.4 mm", "mass": "20 g"}, outputs=outputs)
    for kind in kinds:
        assert found[f"part_{kind}_power"] == pytest.approx(0.02 * found[f"{kind}_power"].item())
        assert math.isfinite(found[f"{kind}_power"].item())
