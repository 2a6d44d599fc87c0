"""Energy over a cycle: balances of any drive, closed answers, what it is for (theory 13.15)."""

import numpy as np
import pytest

import night
from refusals import problems_of
from vibrafeed.core.intake import parse_study, prepare_content
from vibrafeed.core.kinds import run_study
from vibrafeed.core.motion import waves
from vibrafeed.core.motion.events import energy_by_events, motion_by_events, spatial_path
from vibrafeed.core.motion.method import Contacts, Groups, each
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
    groups = random_groups(drive, 100, 1)
    motion, energy = both(groups, PLANE)
    assert np.count_nonzero(energy.impact > 0) > 10
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
        drive, night.count(12, 40), 3, across=True, wall=contacts.wall, curved=curved
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
    slow, fast = run({**SLIDES, "frequency": 100, "amplitude": "0.05 mm"}), run(SLIDES)
    for name, share in (("friction_power", 0.5), ("drive_power", 0.5), ("drive_work", 1.0)):
        assert float(slow[name]) == pytest.approx(share * float(fast[name]), rel=1e-13)
    work = float(fast.drive_power) / float(fast.conveying_velocity)
    assert float(fast.drive_work) == pytest.approx(work, rel=1e-13)


def test_rest_costs_nothing_and_vain_work_is_unbounded():
    rest = run({**SLIDES, "amplitude": "1 um"})
    assert float(rest.drive_power) == float(rest.friction_power) == 0.0
    assert np.isnan(rest.drive_work)
    # Straight up and down it hops on the spot; without friction impacts take all.
    vain = run({**SLIDES, "amplitude": "0.3 mm", "beta": 90, "friction": 0},
               outputs=["drive_work", "drive_power", "impact_power"])  # fmt: skip
    assert float(vain.drive_power) == pytest.approx(float(vain.impact_power), rel=1e-12)
    assert float(vain.impact_power) > 0
    assert np.isinf(vain.drive_work)
    assert vain.regime_drive_work.item() == REGIMES["unbounded"].value


@pytest.mark.parametrize(
    ("more", "fixes"),
    [
        ({"method": "reference"}, {"Set method to events"}),
        ({"outputs": ["part_drive_power"]}, {'Add, for example, mass = "5 g"'}),
    ],
)
def test_what_cannot_be_told_is_refused(more, fixes):
    assert {problem.fix for problem in problems_of(prepare_content, study(SLIDES, **more))} == fixes


def test_a_part_takes_its_mass_times_that():
    kinds = ("friction", "impact", "drive")
    outputs = [f"{part}{kind}_power" for kind in kinds for part in ("part_", "")]
    found = run({**SLIDES, "amplitude": "0.4 mm", "mass": "20 g"}, outputs=outputs)
    for kind in kinds:
        assert found[f"part_{kind}_power"] == pytest.approx(0.02 * found[f"{kind}_power"].item())
