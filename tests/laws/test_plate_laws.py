"""Random drives of a plate: beside the reference, and weak friction beside the settled motion."""

from __future__ import annotations

import numpy as np

from night import count
from vibrafeed.core.motion.method import STATUS, Contacts, Groups
from vibrafeed.core.motion.plate import METHODS
from vibrafeed.core.motion.waves import Wave, bound

CELLS = count(4, 500)
WEAK = count(40, 400)


def drives(cells: int) -> Groups:
    """Return parts under two harmonics on each axis; half slope, half rebound."""
    rng = np.random.default_rng(62)
    sizes = np.array([1.0, 1.0, 0.35])[:, None, None, None] * np.array([1.0, 0.5])[:, None]
    wave = Wave(rng.normal(size=(3, 2, 2, cells)) * sizes, np.zeros((4, 0, cells)))
    slopes = [np.where(rng.random(cells) < 0.5, 0.0, rng.uniform(-0.03, 0.03, cells)) for _ in "xy"]
    friction = rng.uniform(0.05, 0.6, cells)
    return Groups(
        drive_number_along=bound(wave, 0),
        drive_number_across=bound(wave, 1),
        drive_number_normal=bound(wave, 2),
        gravity_number_along=slopes[0],
        gravity_number_across=slopes[1],
        gravity_number_normal=np.ones(cells),
        friction_static=1.1 * friction,
        friction_kinetic=friction,
        restitution=np.where(rng.random(cells) < 0.5, 0.0, rng.uniform(0.0, 0.6, cells)),
        wave=wave,
    )


def test_random_drives_beside_the_reference():
    groups, motions = drives(CELLS), []
    for method in METHODS.values():
        settings = {name: np.asarray(value) for name, value in method.defaults.items()}
        motions.append(method.follow(groups=groups, contacts=Contacts(), **settings))
    ours, theirs = motions
    stated = ours.error + theirs.error
    assert np.isfinite(stated).all()
    for name in ("velocity", "across"):
        assert (np.abs(getattr(ours, name) - getattr(theirs, name)) <= stated).all(), name


def test_the_velocity_of_weak_friction_is_that_of_the_settled_motion():
    friction = 10.0 ** np.random.default_rng(5).uniform(-3.3, -1.5, WEAK)
    groups = drives(WEAK)._replace(
        friction_static=friction, friction_kinetic=friction, restitution=0.0,
        gravity_number_along=0.4 * friction, gravity_number_across=0.0,
    )  # fmt: skip
    follow = METHODS["events"].follow
    given = {"groups": groups, "contacts": Contacts(), "tolerance": 1e-12}
    soon, late = (follow(**given, max_periods=np.asarray(most)) for most in (4.0, 5000.0))
    both = (soon.status == STATUS["weak_friction"]) & (late.status == STATUS["periodic"])
    assert both.sum() >= 0.3 * WEAK
    apart = np.hypot(soon.velocity - late.velocity, soon.across - late.across)
    assert (apart <= soon.error + late.error)[both].all()
