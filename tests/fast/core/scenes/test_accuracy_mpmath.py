"""Every output of planes and track against exact values: random, extreme and threshold points.

The exact functions are the textbook formulas of the theory (sections 0.2, 3, 4, 7, 11.1)
with so many digits that cancellation does not matter; they share nothing with the code under test.

The bar: ``|got - exact| <= 8 kappa ulp(exact)``, where the condition number
``kappa = max(1, sum |x_i dF/dx_i| / |F|)`` runs over the float64 inputs. No warning, and nothing
infinite or NaN but where the exact value is.

Switches: where a function changes its form, rounding may put the code on the other side. This is
accepted only if the argument of the switch, itself a function of the inputs, is within its own
``8 kappa ulp`` of 0. Then, all else being exact, a continuous function may take (to the bar) the
values between those at the ends of that range of the argument (`BENDS`), and at a jump the value on
the other side (`JUMPS`).
"""

import math
import sys

import numpy as np
import pytest

from exact_planes import EPSILON, FORMULAS, ZERO, Point, digits
from many_digits import mp, mpf
from plane_points import make_points, parameters
from plans import values_at
from vibrafeed.core.scenes import SCENES

BAR = 8
STEP = mpf(10) ** -20  # relative, of central differences


# --- the bar


def near(point, changed, fixed=None):
    return Point(point.scene, point.variant, point.given | changed, fixed or point.fixed)


def moves(point, name):
    """Yield x_i dF/dx_i for each input, central differences."""
    fresh = near(point, {})
    getattr(fresh, name)
    for key in sorted(fresh.used):
        if x := point.given[key]:
            if key not in point.beside:
                point.beside[key] = [near(point, {key: x * (1 + h)}) for h in (STEP, -STEP)]
            up, down = point.beside[key]
            yield (getattr(up, name) - getattr(down, name)) / (2 * STEP)


def excess(point, name, got, value):
    """Return the error over kappa ulp(value), or 0 as soon as it is seen to be within the bar."""
    if not math.isfinite(got) or not abs(value) <= sys.float_info.max:
        same = (mp.isnan(value) and math.isnan(got)) or (
            abs(value) > sys.float_info.max and got == mp.sign(value) * mp.inf
        )
        return ZERO if same else mp.inf
    error, ulp = abs(mpf(got) - value), math.ulp(float(value))
    moved, unit = ZERO, mpf(ulp)
    if error <= BAR * unit:
        return ZERO
    for move in moves(point, name):
        moved += abs(move)
        unit = max(unit, moved * (ulp / abs(value) if value else EPSILON))
        if error <= BAR * unit:
            return ZERO
    return error / unit


def admitted(point, name, got, value):
    """Return the switch, if any, that admits a value beyond the bar."""
    for kind in (BENDS, JUMPS):
        for switch, outputs in kind[point.scene].items():
            if name not in outputs:
                continue
            argument = getattr(point, switch)
            bar = BAR * EPSILON / 2 * sum(abs(move) for move in moves(point, switch))
            if not abs(argument) <= bar:
                continue
            if kind is JUMPS:
                arguments = [ZERO if switch == "pole" else -argument]
            else:
                arguments = [argument - bar, argument + bar]
            others = [switched(point, switch, moved) for moved in arguments]
            values = [getattr(other, name) for other in others]
            pairs = zip(others, values, strict=True)
            between = kind is BENDS and min(value, *values) <= got <= max(value, *values)
            if between or any(excess(other, name, got, there) <= BAR for other, there in pairs):
                return switch
    return None


def switched(point, switch, argument):
    """Return the point with another value of the argument of a switch, all else as it was."""
    if switch == "time_left":
        return near(point, {"time": point.stopping_time - argument})
    return near(point, {}, {switch: argument})


MOTION = {f"{turned}acceleration_{axis}" for turned in ("", "rotated_") for axis in "xy"}
OFFSETS = {"pressure_offset_x", "pressure_offset_y"}
FLOOR = {"floor_acceleration", "floor_force", "acceleration_z"}
WALL = {"wall_acceleration", "wall_force", "wall_force_front", "wall_force_rear"}
AT_DISTANCE = {"transport_velocity", "travel_time", "mean_velocity"}
AT_TIME = {"velocity_at_time", "distance_at_time"}
STOP = {"stopping_distance", "stopping_time"}
BENDS = {  # continuous
    "rectangle-on-plane": {"normal_acceleration": FLOOR | MOTION},
    "cylinder-on-plane": {
        "normal_acceleration": FLOOR | MOTION | {"roll_root", "angular_acceleration"}
    },
    "rectangle-on-track": {
        "normal_acceleration": FLOOR | MOTION,
        "wall_balance": WALL | MOTION,
        "in_plane_drive_x": MOTION,
        "wall_pull": {"wall_speed"},
        "starting_acceleration": AT_DISTANCE
        | AT_TIME
        | STOP
        | {"terminal_velocity", "distance_bound"},
        "speed_squared": AT_DISTANCE,
        "time_left": AT_TIME,
        "bound_margin": {"distance_bound"},
    },
}
JUMPS = {
    "rectangle-on-plane": {
        "normal_acceleration": OFFSETS,
        "hold_margin": MOTION | OFFSETS | {"sliding_fraction"},
    },
    "cylinder-on-plane": {"roll_margin": MOTION | {"roll_root", "angular_acceleration"}},
    "rectangle-on-track": {
        "normal_acceleration": OFFSETS,
        "hold_margin": MOTION | OFFSETS,
        "pole": WALL | {"floor_acceleration", "floor_force", "z_residual"},
    },
}


@pytest.mark.parametrize(
    ("scene", "variant"), [(s, v) for s in FORMULAS for v in SCENES[s].variants]
)
def test_every_output_is_exact_to_the_bar(scene, variant):
    points, wrong = make_points(scene), []
    cells = {n: np.array([point[n] for point in points]) for n in parameters(scene, [variant])}
    got = {
        name: np.broadcast_to(values, len(points))
        for name, values in values_at(scene, variant, SCENES[scene].outputs(variant), cells).items()
    }
    for number, inputs in enumerate(points):
        given = {name: mpf(value) for name, value in inputs.items()}
        point = Point(scene, variant, given)
        with mp.workdps(digits(scene, variant, given)):
            for name in got:
                value, result = getattr(point, name), float(got[name][number])
                error = excess(point, name, result, value)
                if error > BAR and not admitted(point, name, result, value):
                    floats = {key: float(x) for key, x in inputs.items()}
                    wrong.append(f"{name}: {result!r}, exact {mp.nstr(value, 20)}, {floats}")
    assert not wrong, f"{len(wrong)} beyond the bar\n" + "\n".join(wrong[:20])
