"""Small studies of every kind that verify some of their cells."""

import math
import re

from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.scenes import SCENES

BOUND = SCENES["rectangle-on-track"].rounding_bound

# A plane of gravity 9.81: at the second amplitude the drive lifts the part off but for 1e-9 of it.
DRIVE = 9.81 * (1 - 1e-9) / ((2 * math.pi * 50) ** 2 * math.sin(math.radians(30)))
SWEEP = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "variant": "thesis",
    "outputs": ["normal_acceleration", "throw_number"],
    "parameters": {
        "frequency": 50,
        "amplitude": [1e-4, DRIVE],
        "beta": [10, 30],
        "gravity": 9.81,
    },
    "verify": 4,
}
MOTION = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity", "flight_fraction"],
    "parameters": {
        "frequency": 50,
        "amplitude": {"start": "0.1 mm", "stop": "0.24 mm", "num": 8},
        "beta": [20, 30],
        "friction": 0.4,
    },
    "verify": 3,
}
BEST = {
    "kind": "optimise",
    "scene": "rectangle-on-plane",
    "variant": "thesis",
    "criterion": {"kind": "limit", "limit": 0.5},
    "parameters": {"frequency": 50, "amplitude": "0.3 mm", "friction": [0.1, 0.2, 0.3, 0.4]},
    "verify": 3,
}
PAIR = {
    "kind": "sweep",
    "scene": "rectangle-pair-impact",
    "outputs": ["impulse_normal"],
    "parameters": {
        "position_x_1": "5 mm",
        "position_y_1": "20.9641016 mm",
        "angle_1": "30 deg",
        "velocity_y_1": ["-0.5 m/s", "-0.4 m/s"],
        "length_1": "50 mm",
        "width_1": "8 mm",
        "mass_1": "5 g",
        "length_2": "40 mm",
        "width_2": "10 mm",
        "mass_2": "8 g",
        "restitution": 0.3,
        "contact_tolerance": 1e-6,
    },
    "verify": 2,
}
STUDIES = {"sweep": SWEEP, "simulate": MOTION, "optimise": BEST}


def told(content):
    attributes = tabulate(prepare_content(content)).attributes
    return {name: value for name, value in attributes.items() if name.startswith("verified")}


def number(pattern, text):
    found = re.search(pattern, text)
    assert found, text
    return float(found[1])
