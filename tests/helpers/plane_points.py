"""Points of planes and track: random, extreme, and at the thresholds of their formulas.

Values are in SI units and radians.
"""

import functools

import numpy as np

from exact_planes import Point, digits
from many_digits import mp, mpf
from night import count, spread
from vibrafeed.core.plan.plan import scene_parameters
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.scenes import SCENES, instead_of

RANDOM, EXTREME = count(120, 2000), count(40, 300)
TUNED = count(4, 8)  # points for each threshold, three in a row


DECADES = {  # of random values
    "frequency": (0, 3), "amplitude": (-6, -2), "gravity": (0, 1.5), "radius": (-2, 2),
    "width": (-3, -1), "height": (-3, -1), "length": (-3, -1.7), "diameter": (-3, -1),
    "mass": (-4, 0), "speed": (-4, 2), "distance": (-7, 3), "time": (-5, 2),
}  # fmt: skip
RIGHT_ANGLES = (-180.0, -90.0, 0.0, 90.0, 180.0)
FRICTION = (0.0, 1e-300, 1e-16, 1e-8, 0.3, 1.0, 1e3)
EXTREMES = {
    "frequency": (0.0, 1e-3, 50.0, 1e5), "amplitude": (0.0, 1e-12, 4e-4, 1.0),
    "gravity": (1e-3, 9.80665, 1e3), "radius": (1e-3, 0.3, 1e6, 1e12), "speed": (0.0, 1e-9, 1e3),
    "distance": (0.0, 1e-12, 1e9), "time": (0.0, 1e-9, 1.0, 1e6), "mass": (1e-9, 1e3),
    "width": (1e-6, 1e-2, 10.0), "height": (1e-6, 1e-2, 10.0), "length": (1e-6, 2e-3, 1.0),
    "diameter": (1e-6, 10.0), "friction_static": FRICTION, "friction_kinetic": FRICTION,
}  # fmt: skip
# What to turn, and what becomes 0 by it.
THRESHOLDS = {
    "rectangle-on-plane": {"normal_acceleration": "amplitude", "hold_margin": "friction_static"},
    "cylinder-on-plane": {"normal_acceleration": "amplitude", "roll_margin": "friction_static"},
    "rectangle-on-track": {
        "normal_acceleration": "amplitude",
        "wall_balance": "speed",
        "wall_pull": "amplitude",
        "starting_acceleration": "amplitude",
        "speed_squared": "distance",
        "time_left": "time",
        "bound_margin": "radius",
        "hold_margin": "friction_static",
        "pole": "width",
    },
}
VELOCITY_SWITCHES = ("starting_acceleration", "speed_squared", "time_left", "bound_margin")

# Points that broke a form once.
HARD = {
    "cylinder-on-plane": (
        {  # mu n is subnormal, the angular acceleration is not
            "alpha": 1.2, "amplitude": 2e-4, "beta": 0.0, "diameter": 10.0, "frequency": 1e5,
            "gamma": 0.0, "gravity": 1e-3, "friction_kinetic": 1e-300, "friction_static": 1e-8,
        },
    ),
    "rectangle-on-track": (
        {  # starts 100 times faster than the terminal velocity, and loses it all
            "alpha": 0.69, "amplitude": 7e-5, "beta": 0.1, "delta": 0.1, "distance": 0.68,
            "frequency": 16.8, "gamma": -0.0126, "gravity": 17.2, "radius": 0.0343, "speed": 46.4,
            "friction_kinetic": 0.39, "friction_static": 0.77,
        },
        {  # v0/|K| is too large for a float, the stopping distance is not
            "alpha": 0.0, "amplitude": 0.0, "delta": np.pi / 2, "frequency": 50.0, "gamma": 0.0,
            "gravity": 1e-3, "radius": 0.3, "speed": 1e4, "friction_kinetic": 1e-300,
        },
        {  # K = 0 and nearly no speed left: the travel time is too large for a float
            "alpha": -np.pi / 2, "amplitude": 0.0, "delta": 0.0, "distance": 1e9, "gamma": 0.0,
            "gravity": 9.8, "radius": 1e6, "speed": 1e-9, "friction_kinetic": 0.69,
        },
        {  # K = 0 to rounding; as a float it is subnormal
            "alpha": 0.0, "amplitude": 1.0132118364233776e-08, "beta": 0.0, "delta": np.pi / 2,
            "frequency": 50.0, "gamma": np.pi / 2, "gravity": 1e-3, "radius": 0.83, "speed": 5e-4,
            "friction_kinetic": 1e-300, "friction_static": 0.04, "time": 1.0,
        },
    ),
}  # fmt: skip


def parameters(scene, variants):
    """Return the inputs of the variants, without other ways of giving them."""
    used = {name for v in variants for name in scene_parameters(SCENES[scene], v)}
    return sorted(name for name in used if not instead_of(name))


def angles(name):
    """Return the special angles of a parameter, none if it is not an angle."""
    quantity = QUANTITIES[name]
    return np.deg2rad([a for a in RIGHT_ANGLES if abs(a) <= quantity.upper and quantity.is_angle])


def random_point(scene, rng):
    """Return ordinary values; half of the points nearly level, half with mu_s = mu_k."""
    tilt = rng.choice((0.05, 1.0))
    point = {}
    for name in parameters(scene, SCENES[scene].variants):
        if QUANTITIES[name].is_angle:
            limit = QUANTITIES[name].upper * (tilt if name in ("beta", "gamma", "delta") else 1.0)
            point[name] = np.deg2rad(rng.uniform(-limit, limit))
        elif name in DECADES:
            point[name] = 10 ** rng.uniform(*DECADES[name])
    point["friction_kinetic"] = rng.uniform(0.0, 1.2)
    point["friction_static"] = point["friction_kinetic"] * rng.choice((1.0, rng.uniform(1.0, 2.0)))
    if "speed" in point:
        point["speed"] *= rng.integers(2)  # half from rest
    return point


def extreme_point(scene, rng):
    """Return a random point, most of whose values are replaced by extreme ones."""
    point = random_point(scene, rng)
    for name in point:
        if rng.random() < 0.7:
            point[name] = rng.choice(EXTREMES.get(name) or angles(name))
    both = sorted((point["friction_kinetic"], point["friction_static"]))
    return point | {"friction_kinetic": both[0], "friction_static": both[1]}


def tuned_points(scene, switch, turned, rng):
    """Yield points where the argument of a switch is as near 0 as floats allow, and next to it.

    The input to turn is solved for. Half of those for the velocity laws are extreme in the others;
    for contacts they are not, lest two switches meet.
    """
    kinds = (random_point, extreme_point if switch in VELOCITY_SWITCHES else random_point)
    for _ in range(TUNED):
        root = None
        while root is None:
            variant = rng.choice(tuple(SCENES[scene].variants))
            base = kinds[rng.integers(2)](scene, rng)
            root = solve(scene, variant, base, switch, turned)
        for value in (np.nextafter(root, 0.0), root, np.nextafter(root, np.inf)):
            yield base | {turned: value}


def solve(scene, variant, base, switch, turned):
    """Return the float of the turned input at which the switch's argument is 0, if there is one."""
    given = {name: mpf(value) for name, value in base.items()}

    def argument(x):
        return getattr(Point(scene, variant, given | {turned: x}), switch)

    start = given[turned] or mpf(1)
    with mp.workdps(digits(scene, variant, given)):
        try:
            root = float(mp.findroot(argument, (start, 2 * start)))
        except (ValueError, ZeroDivisionError, TypeError):  # none, or none that is real
            return None
    least = base["friction_kinetic"] if turned == "friction_static" else 1e-12
    return root if least <= root < 1e12 else None


@functools.cache
def make_points(scene):
    rng = np.random.default_rng(2004)
    every = [
        *(random_point(scene, rng) for _ in range(RANDOM)),
        *(extreme_point(scene, rng) for _ in range(EXTREME)),
        *(p for pair in THRESHOLDS[scene].items() for p in tuned_points(scene, *pair, rng)),
        *(random_point(scene, rng) | hard for hard in HARD.get(scene, ())),
    ]
    return spread(every, 150)
