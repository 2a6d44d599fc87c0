"""General physics engines on a vibrating plate, beside our methods where they are installed."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from benchmarks import engines, plate_engines
from benchmarks.engines import CASES
from core.assurance.accuracy import motion
from core.assurance.accuracy.curves import Measured
from core.intake import prepare_content
from core.watch import Watch


def measured(monkeypatch: pytest.MonkeyPatch, *names: str, **parameters: object) -> Measured:
    """Measure a few cells without what takes long, with these engines installed."""
    monkeypatch.setattr(motion, "_regularised", lambda *_: ())
    monkeypatch.setattr(motion, "STEPS", (100,))
    monkeypatch.setattr(engines, "installed", lambda: names)
    study = {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "outputs": ["conveying_velocity"],
        "parameters": {
            "frequency": 50,
            "amplitude": {"start": "0.1 mm", "stop": "0.35 mm", "num": 20},
            "beta": 30,
            **({} if "friction_static" in parameters else {"friction": 0.5}),
            **parameters,
        },
    }
    return motion.measure(prepare_content(study), Watch(), cells=4, rivals=engines.engine_curves)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_pymunk_comes_near_the_known_velocity_with_its_step(case):
    """Engines are of first order: a tenth of the step is a tenth of the error, or less."""
    errors = [
        abs(
            plate_engines.engine_velocity("pymunk", case.drive, 1 / (50 * steps)) / case.velocity
            - 1
        )
        for steps in (200, 2000)
    ]
    assert errors[0] < 0.02  # a step is 2 % of a period
    assert errors[1] < errors[0] / 10


def test_a_drive_along_a_level_track_moves_nothing():
    """But for the moments at which slip turns, which are late by up to a step."""
    drive = replace(CASES[0].drive, beta=0.0, gamma=0.0)
    speed = drive.amplitude * drive.circular
    found = plate_engines.engine_velocity("pymunk", drive, 1 / (50 * 2000))
    assert abs(found) < 2 * math.pi / 2000 * speed


def test_the_plate_of_a_drive_is_where_it_should_be():
    drive = CASES[1].drive
    step = 1e-4
    away = sum(step * drive.mean_speed(k * step, step) for k in range(50))
    assert away == pytest.approx(drive.displacement(50 * step), rel=1e-12)
    assert math.hypot(*drive.gravity) == pytest.approx(9.81)


def test_what_is_installed_is_measured_beside_our_methods(monkeypatch):
    monkeypatch.setattr(engines, "ENGINE_STEPS", (200, 1000))
    found = measured(monkeypatch, "pymunk")
    [curve] = [curve for curve in found.curves if curve.method == "pymunk"]
    coarse, fine = curve.points
    assert fine.largest < coarse.largest < 0.05
    assert all(point.seconds > 0 for point in curve.points)
    assert any(note.startswith("Engines: pymunk 7") for note in found.notes)


def test_engines_that_are_not_installed_are_left_out(monkeypatch):
    found = measured(monkeypatch)
    assert not {curve.method for curve in found.curves} & set(plate_engines.ENGINES)
    assert not any("Engines" in note for note in found.notes)


@pytest.mark.parametrize(
    "parameters", [{"restitution": 0.2}, {"friction_static": 0.6, "friction_kinetic": 0.5}]
)
def test_what_engines_mean_otherwise_is_left_out_and_said(monkeypatch, parameters):
    found = measured(monkeypatch, "pymunk", **parameters)
    assert not [curve for curve in found.curves if curve.method == "pymunk"]
    assert any("left out" in note and "Engines" in note for note in found.notes)
