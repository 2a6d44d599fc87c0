"""M, drives far above friction: the speed is where friction, weighted by the load, balances.

Then the part hardly changes its speed v over a period, and

    integral of N(t) sgn(v_track(t) - v) dt = T g sin(gamma)/mu,   N the load in g.
"""

from __future__ import annotations

import math

from numpy.random import Generator

from core.assurance.case import Term
from core.assurance.forms.formulas import GRAVITY, Formula, Given, sine_cosine, speed

FREQUENCY = 50.0  # Hz; the answers are in scales in which it does not count
CIRCULAR = 2 * math.pi * FREQUENCY
FAST = 1e-5
"""mu g/(A w^2) of random members."""


def _along(given: Given) -> float:
    """Return the amplitude along the track [m]."""
    return given["friction"] * GRAVITY / (given["weak"] * CIRCULAR**2)


def _share(given: Given, drive: dict[str, float]) -> tuple[Term, ...]:
    """Return the mean velocity over the largest speed of the track along itself."""
    drive |= {"frequency": FREQUENCY, "friction": given["friction"]}
    return speed(drive, times=1 / (_along(given) * CIRCULAR))


# --- one frequency, along and normal


def ellipse_terms(given: Given) -> tuple[Term, ...]:
    """Return the mean velocity under an ellipse, over A_x w."""
    normal = given["throw"] * GRAVITY * sine_cosine(given["gamma"])[1] / CIRCULAR**2
    return _share(
        given,
        {
            "amplitude_along_1": _along(given),
            "amplitude_normal_1": normal,
            "phase_normal_1": given["phase"],
            "gamma": given["gamma"],
        },
    )


def ellipse(given: Given) -> float:
    """Return c of acos(c) - Gamma sin(phi) sqrt(1 - c^2) = (pi/2)(1 + tan(gamma)/mu).

    By bisection: the left side falls as c rises.
    """
    turned = given["throw"] * sine_cosine(given["phase"])[0]
    climb = math.tan(math.radians(given["gamma"])) / given["friction"]
    right = math.pi / 2 * (1 + climb)
    least, most = 0.0, math.pi  # of the angle acos(c), which the left side rises with
    for _ in range(100):
        angle = (least + most) / 2
        if angle - turned * math.sin(angle) < right:
            least = angle
        else:
            most = angle
    return math.cos((least + most) / 2)


def random_ellipse(random: Generator) -> dict[str, float]:
    """Return inputs on slopes that are less steep than the steepest climb."""
    throw, phase = float(random.uniform(0.1, 1)), float(random.uniform(-180, 180))
    friction = float(random.uniform(0.1, 0.9))
    steepest = climb({"throw": throw, "phase": phase, "friction": friction})
    gamma = float(random.choice([0.0, random.uniform(-0.9, 0.9) * steepest]))
    return {"weak": FAST, "throw": throw, "phase": phase, "friction": friction, "gamma": gamma}


def climb(given: Given) -> float:
    """Return gamma of tan(gamma) = (2/pi) mu Gamma |sin(phi)| [degree], where v is 0."""
    turned = abs(sine_cosine(given["phase"])[0])
    return math.degrees(math.atan(2 / math.pi * given["friction"] * given["throw"] * turned))


def climb_terms(given: Given) -> tuple[Term, ...]:
    """Return the mean velocity on the steepest climb, over A_x w."""
    return ellipse_terms({**given, "gamma": climb(given)})


def random_climb(random: Generator) -> dict[str, float]:
    """Return inputs whose ellipse conveys upwards."""
    given = random_ellipse(random)
    del given["gamma"]
    return given | {"phase": float(random.uniform(-170, -10))}


def at_rest(given: Given) -> float:
    """Return 0: the part neither climbs nor falls back."""
    return 0.0


# --- in phase


def line_terms(given: Given) -> tuple[Term, ...]:
    """Return the mean velocity under a drive along a line, over Gamma mu g/w."""
    drive = {
        "frequency": FREQUENCY,
        "friction": given["friction"],
        "amplitude_along_1": _along(given),
        "amplitude_normal_1": given["throw"] * GRAVITY / CIRCULAR**2,
    }
    scale = given["throw"] * given["friction"] * GRAVITY / CIRCULAR
    return speed(drive, times=1 / scale)


def line(given: Given) -> float:
    """Return pi/2 + 2/pi."""
    return math.pi / 2 + 2 / math.pi


def random_line(random: Generator) -> dict[str, float]:
    """Return inputs with a normal acceleration below gravity."""
    return {
        "weak": 1e-4,
        "throw": float(random.uniform(0.1, 1)),
        "friction": float(random.uniform(0.1, 0.9)),
    }


# --- two frequencies along the track


def second_terms(given: Given) -> tuple[Term, ...]:
    """Return the mean velocity under a track whose speed is cos(t) + e cos(2 t), over A w."""
    along = _along(given)
    return _share(
        given,
        {"amplitude_along_1": along, "amplitude_along_2": given["second"] * along / 2},
    )


def second(given: Given) -> float:
    """Return -e."""
    return -given["second"]


def random_second(random: Generator) -> dict[str, float]:
    """Return inputs with e <= 1/4."""
    return {
        "weak": FAST,
        "second": float(random.uniform(0.01, 0.25)),
        "friction": float(random.uniform(0.1, 0.9)),
    }


FORMULAS = {
    "M-ellipse": Formula(ellipse_terms, ellipse, random_ellipse),
    "M-climb": Formula(climb_terms, at_rest, random_climb),
    "M-line": Formula(line_terms, line, random_line),
    "M-two-frequencies": Formula(second_terms, second, random_second),
}
