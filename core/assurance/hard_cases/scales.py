"""Hard for size: of masses and lengths, and of grids."""

from __future__ import annotations

import math

import numpy as np

from vibrafeed.core.assurance import textbook
from vibrafeed.core.assurance.case import Case, Truth
from vibrafeed.core.assurance.hard_cases.studies import (
    DRIVE,
    Content,
    G,
    W,
    by_reference,
    from_study,
    hard_case,
    hopping,
    motion,
    sweep,
)
from vibrafeed.core.assurance.textbook import EPSILON, exact


def masses_and_sizes() -> list[Case]:
    """Return hard cases with masses and lengths over twelve decades.

    They are floor forces, impacts of two bodies, and tumbling parts, whose results follow those at
    1 kg and 1 m by scaling.
    """
    family = "masses and sizes over twelve decades"
    cases = []
    for mass in (1e-9, 1e-3, 1e3):
        parameters = {**DRIVE, "mass": mass, "gravity": G}
        P = 4e-4 * W * W * math.sin(math.radians(20))
        cases.append(hard_case(
            f"floor force of {mass:g} kg", family, "forces from 1e-8 N to 1e4 N",
            sweep("rectangle-on-plane", "floor_force", **{**parameters, "amplitude": 1e-5}),
            "floor_force", Truth(mass * (G - P / 40), 16 * EPSILON * mass * G,
                                 "m (g - P sin(beta)); 16 ulp"),
        ))  # fmt: skip
    for small, large in ((1e-9, 1e3), (1e3, 1e-9), (1e-9, 1e-9)):
        for size in (1e-6, 1.0, 1e6):
            parameters = {
                "position_x_1": 0.0, "position_y_1": size, "angle_1": 0.0, "velocity_x_1": 0.0,
                "velocity_y_1": -1.0, "spin_1": 0.0, "length_1": 2 * size, "width_1": size,
                "mass_1": small, "position_x_2": 0.0, "position_y_2": 0.0, "angle_2": 0.0,
                "velocity_x_2": 0.0, "velocity_y_2": 0.0, "spin_2": 0.0, "length_2": 2 * size,
                "width_2": size, "mass_2": large, "restitution": 0.5,
            }  # fmt: skip
            after = -1.0 + 1.5 * large / (small + large)
            cases.append(hard_case(
                f"impact of {small:g} kg on {large:g} kg, {size:g} m", family,
                "two Delassus numbers that differ by 1e12",
                {**sweep("rectangle-pair-impact", "velocity_y_1_after", **parameters),
                 "variant": "frictionless"},
                "velocity_y_1_after",
                Truth(after, 64 * EPSILON, "central impact; 64 ulp of the velocity"), ("impact",),
            ))  # fmt: skip
    oblique = {
        "angle_1": 20.0, "velocity_x_1": 0.3, "velocity_y_1": -1.0, "spin_1": 0.0, "angle_2": 0.0,
        "velocity_x_2": 0.0, "velocity_y_2": 0.0, "spin_2": 0.0, "friction": 0.3,
        "restitution": 0.5, "contact_tolerance": 1e-6, "position_x_2": 0.0, "position_y_2": 0.0,
    }  # fmt: skip

    def scaled(size: float, mass: float) -> Content:
        """Return the study of an impact of scaled bodies."""
        turn = math.radians(20.0)
        rise = size * (math.sin(turn) + 0.5 * math.cos(turn)) + 0.5 * size
        lengths = {"position_x_1": 0.1 * size, "position_y_1": rise, "length_1": 2 * size,
                   "width_1": size, "length_2": 4 * size, "width_2": size}  # fmt: skip
        return {**sweep("rectangle-pair-impact", "velocity_y_1_after", **oblique, **lengths,
                        mass_1=mass, mass_2=2 * mass), "variant": "pfeiffer_glocker"}  # fmt: skip

    for size, mass in ((1e-6, 1e-9), (1e6, 1e3), (1e-6, 1e3), (1e6, 1e-9)):
        cases.append(hard_case(
            f"oblique impact, {size:g} m, {mass:g} kg", family,
            "velocities do not depend on either",
            scaled(size, mass), "velocity_y_1_after",
            from_study(scaled(1.0, 1.0), "velocity_y_1_after", 1e-12,
                       "the same at 1 m, 1 kg; roundings of the placement, 1e-16, over 1e-4"),
            ("impact_slip", "impact_stick"),
        ))  # fmt: skip
    for size in (1e-6, 1e6):
        # Times grow as the root of the size.
        def falls(size: float) -> Content:
            """Return the study of a falling part of a size."""
            return {"kind": "simulate", "scene": "rectangle-isolated", "method": "events",
                    "outputs": ["settling_time"],
                    "parameters": {"length": 2 * size, "height": size, "friction": 0.4,
                                   "restitution": 0.3, "drop_height": size, "pitch": 20.0,
                                   "gravity": G, "duration": 20 * math.sqrt(size)}}  # fmt: skip

        cases.append(hard_case(
            f"tumbling, {size:g} m", family, "times from 1e-3 s to 1e3 s",
            falls(size), "settling_time",
            from_study(falls(1.0), "settling_time", 1e-9, "the same at 1 m: times grow as the "
                       "root of the size; a dozen impacts amplify roundings", math.sqrt(size)),
            ("settled",),
        ))  # fmt: skip
    return cases


def grids() -> list[Case]:
    """Return hard cases of grids: one value on an axis, ten million, or the same value twice."""
    family = "grids: one point, 10^7 on an axis, repeated values"
    parameters = {**DRIVE, "amplitude": 5e-5, "gravity": G}
    axes = {name: [value] for name, value in parameters.items()}
    long_axis = {"start": 1.0, "stop": 100.0, "num": 10_000_000}

    def throws() -> Truth:
        """Return the exact throw numbers on ten million cells."""
        frequencies = np.linspace(1.0, 100.0, 10_000_000)
        scale = 5e-5 * 4 * math.pi**2 * math.sin(math.radians(20)) / G
        values = scale * frequencies**2
        return Truth(values, 16 * EPSILON * values, "C f^2; 16 ulp")

    quarters = hopping(0.88)

    def equal() -> Truth:
        """Return the exact velocities of cells that pairwise share a motion."""
        # A0 w^2 is that of (50 Hz, A0) and (100 Hz, A0/4): one motion, at half the speed.
        once = by_reference(quarters)()
        hops = exact(textbook.hop_after_hop, frequency=100.0, beta=30.0, gamma=0.0, gravity=G)()
        value = np.array([[0.0, once.value], [once.value / 2, hops.value]])
        error = np.array([[0.0, once.tolerance], [once.tolerance / 2, hops.tolerance]])
        return Truth(value, error, "held, reference method, half of it, hop after hop")

    return [
        hard_case(
            "every axis of one value", family, "axes that are none",
            sweep("rectangle-on-plane", "throw_number", **axes), "throw_number",
            exact(textbook.throw_number, **parameters),
        ),
        hard_case(
            "10^7 values on one axis", family, "no cell may be stored",
            sweep("rectangle-on-plane", "throw_number", **{**parameters, "frequency": long_axis}),
            "throw_number", throws,
        ),
        hard_case(
            "a value that stands twice", family, "a label that names two cells",
            sweep("rectangle-on-plane", "throw_number",
                  **{**parameters, "frequency": [50, 50, 60]}),
            refused="parameters.frequency",
        ),
        hard_case(
            "a range from a value to itself", family, "a range of no length",
            sweep("rectangle-on-plane", "throw_number",
                  **{**parameters, "frequency": {"start": 50, "stop": 50, "num": 3}}),
            refused="parameters.frequency",
        ),
        hard_case(
            "values an ulp apart", family, "two labels that print alike",
            sweep("rectangle-on-plane", "throw_number",
                  **{**parameters, "frequency": [50.0, float(np.nextafter(50.0, 60.0))]}),
            "throw_number", lambda: Truth(
                np.full(2, exact(textbook.throw_number, **parameters)().value),
                np.full(2, 2 * exact(textbook.throw_number, **parameters)().tolerance),
                "the first, and 2 ulp"),
        ),
        hard_case(
            "more values than an axis holds", family, "memory",
            sweep("rectangle-on-plane", "throw_number",
                  **{**parameters, "frequency": {"start": 1, "stop": 2, "num": 10**9}}),
            refused="parameters.frequency",
        ),
        hard_case(
            "equal cells of motion", family, "computed once, given twice",
            motion(**{**quarters, "frequency": [50.0, 100.0],
                      "amplitude": [quarters["amplitude"] / 4, quarters["amplitude"]]}),
            "conveying_velocity", equal, ("at_rest", "periodic"), states_error=True,
        ),
    ]  # fmt: skip
