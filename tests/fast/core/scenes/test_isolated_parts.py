"""Isolated parts: worked values, cases, and every output against 50 digits.

The exact functions are the equations of motion themselves, solved as the 2 by 2 system that they
are; the code uses none of these forms. The bar: ``|got - exact| <= 8 K ulp(exact)`` with the
condition number ``K = max(1, sum |x_i dF/dx_i|/|F|)`` over the float64 inputs, and no warning. A
point on whose contact case or slip direction rounding decides (the argument of that switch is
within its own bar of 0) is left out for the outputs that jump there; their number is bounded.
"""

import collections
import math

import numpy as np
import pytest

from benchmarks.known_answers import answer
from many_digits import mp, mpf
from night import count
from plans import values_at
from refusals import places_of
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.mechanics.corner import (
    NO_SOLUTION,
    SEPARATION,
    SLIDING,
    TWO_SOLUTIONS,
    case,
    contact_force,
)
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.sweep.kind import prepare
from vibrafeed.core.sweep.slice import compute_slice, prepare_cut

SQUARE = {"height": 1.0, "length": 1.0}
OF_A_CYLINDER = answer("V-limiting-friction-2")


def run(scene: str, outputs: list[str], variant: str = "derived", **parameters: object):
    content = {"kind": "sweep", "scene": scene, "variant": variant, "outputs": outputs}
    return run_study(parse_study({**content, "parameters": parameters}))


@pytest.mark.parametrize(
    ("friction", "pitch_rate", "velocity", "expected"),
    [
        (0.3, 0, 0.1, "sliding"),
        (0.3, 20, 20, "separation"),
        (2.0, 0, 0.1, "no_solution"),
        (2.0, 20, 20, "two_solutions"),
        (2.0, 20, -20, "separation"),  # to the left there is one solution at every friction
        (2.0, 0, -0.1, "sliding"),
        (1.0, 0, None, "stick"),
        (0.1, 0, None, "sliding"),
        (0.1, 20, None, "separation"),
    ],
)
def test_each_case_of_a_corner_is_told(friction, pitch_rate, velocity, expected):
    outputs = ["floor_acceleration", "gap_normal_acceleration", "free_normal_acceleration"]
    slips = {} if velocity is None else {"velocity_along": velocity}
    dataset = run(
        "rectangle-isolated", outputs, **SQUARE, pitch=15, friction=friction,
        pitch_rate=pitch_rate, **slips,
    )  # fmt: skip
    assert int(dataset["regime"]) == REGIMES[expected].value
    force, gap, free = (float(dataset[name]) for name in outputs)
    assert math.isnan(force) if expected == "no_solution" else force >= 0
    assert (force == 0) == (expected == "separation")
    assert gap == free if expected == "separation" else not gap > 0


@pytest.mark.parametrize("size", [5e-324, 1e-300, 1.0, 1e16])
@pytest.mark.parametrize(
    ("response", "free", "told", "force"),
    [
        (1, 1, SEPARATION, 0), (1, 0, SLIDING, 0), (1, -1, SLIDING, 1), (-1, 1, TWO_SOLUTIONS, 1),
        (-1, 0, SLIDING, 0), (-1, -1, NO_SOLUTION, np.nan), (0, 1, SEPARATION, 0),
        (0, 0, TWO_SOLUTIONS, np.nan), (0, -1, NO_SOLUTION, np.nan),
    ],
)  # fmt: skip
def test_next_to_zero_the_solutions_are_those_of_both_branches(response, free, told, force, size):
    """Of every n with 0 <= n, 0 <= response n + free and one of them 0."""
    given = np.array([response * size]), np.array([free * size])
    assert case(*given) == told
    np.testing.assert_array_equal(contact_force(*given), [force])


def test_a_corner_at_rest_slips_away_from_the_centre():
    # The centre falls on the left of the corner, which is driven to the right; and the mirror.
    outputs = ["slip_direction"]
    found = run("rectangle-isolated", outputs, **SQUARE, friction=0.1, pitch=[15, 75])
    assert found["slip_direction"].values.tolist() == [1, -1]


@pytest.mark.parametrize(
    ("scene", "variant", "outputs", "given", "places"),
    [
        ("rectangle-isolated", "derived", ["gap_normal", "gap_normal_rate"], {**SQUARE, "pitch": 0},
         {"parameters.centre_height", "parameters.velocity_upward"}),
        ("rectangle-on-track", "physical", ["centripetal_acceleration"], {}, {"parameters.radius"}),
    ],
)  # fmt: skip
def test_an_output_asks_for_what_it_is_made_of(scene, variant, outputs, given, places):
    assert set(places_of(run, scene, outputs, variant, **given)) == places


@pytest.mark.parametrize(
    ("ratio", "printed", "tolerance"),
    [
        (2, OF_A_CYLINDER.value, OF_A_CYLINDER.tolerance),
        (1, 1.2276, 5e-5),
        (1.29846, 1.2, 5e-7),
        (1.25, 1.2039, 5e-5),
        (1e-9, 4 / 3, 1e-15),
        (1e9, math.sqrt(5) / 2, 1e-15),
    ],
)
def test_the_least_limiting_friction_of_a_cylinder_depends_on_its_shape(ratio, printed, tolerance):
    dataset = run("cylinder-isolated", ["least_limiting_friction"], diameter=ratio, length=1.0)
    assert float(dataset["least_limiting_friction"]) == pytest.approx(printed, abs=tolerance, rel=0)


def test_a_pitch_at_which_another_corner_is_lower_is_told():
    at = run("rectangle-isolated", ["floor_force"], **SQUARE, mass=1, friction=0.3,
             pitch=[-1, 0, 45, 90, 91])  # fmt: skip
    told = at["regime"] == REGIMES["invalid_geometry"].value
    assert told.values.tolist() == [True, False, False, False, True]


def test_an_angle_among_the_outputs_is_in_degrees_in_a_slice_too():
    content = {
        "kind": "sweep", "scene": "rectangle-isolated", "outputs": ["diagonal_angle"],
        "parameters": {**SQUARE, "pitch": [0, 15, 30]},
    }  # fmt: skip
    sweep = prepare(parse_study(content))
    found = compute_slice(
        prepare_cut(sweep, output="diagonal_angle", axes=["pitch"], at={}, most=10)
    )
    np.testing.assert_allclose(found["values"]["data"], [45, 60, 75], rtol=1e-15)
    assert found["unit"] == "degree"


BAR = 8
DIGITS = 50
STEP = mpf(10) ** -18
EPSILON = mpf(2) ** -52
RANDOM, EXTREME = count(60, 2000), count(40, 300)
ACROSS = {"rectangle-isolated": "height", "cylinder-isolated": "diameter"}


def exact(scene: str, variant: str, p: dict[str, mpf]) -> dict[str, mpf]:
    """Return every output, and the arguments of the switches under names with a star."""
    b, h, g, w = p[ACROSS[scene]], p["length"], p["gravity"], p["pitch_rate"]
    zeta = mp.atan2(b, h)
    s = zeta + p["pitch"]
    rho = mp.sqrt(b**2 + h**2) / 2
    per_mass = (b**2 + h**2) / 12 if scene.startswith("rect") else (b**2 * 3 / 4 + h**2) / 12
    kappa = rho**2 / per_mass
    sine, cosine = mp.sin(s), mp.cos(s)
    nn, nt, tt = 1 + kappa * cosine**2, kappa * sine * cosine, 1 + kappa * sine**2
    chi, along = rho * w**2 * sine - g, -rho * w**2 * cosine
    mu, mu_s = p["friction_kinetic"], p["friction_static"]
    out = {
        "corner_angle": zeta, "diagonal_angle": s, "half_diagonal": rho, "inertia_ratio": kappa,
        "touching_height": rho * sine, "gap_normal": p["centre_height"] - rho * sine,
        "gap_tangential": p["centre_along"] + rho * cosine,
        "pivot_velocity_along": rho * w * sine, "pivot_velocity_upward": rho * w * cosine,
        "gap_normal_rate": p["velocity_upward"] - rho * w * cosine,
        "gap_tangential_rate": p["velocity_along"] - rho * w * sine if p["slips"] else mpf(0),
        "free_normal_acceleration": chi, "free_tangential_acceleration": along,
        "normal_response_right": nn - mu * nt, "normal_response_left": nn + mu * nt,
        "holding_normal_acceleration": (nt * along - tt * chi) / (nn * tt - nt**2),
        "holding_tangential_acceleration": (nt * chi - nn * along) / (nn * tt - nt**2),
        "inverse_limiting_friction": nt / nn,
        "limiting_friction_right": nn / nt if nt > 0 else mp.inf,
        "limiting_friction_left": -nn / nt if nt < 0 else mp.inf,
        "least_limiting_friction": 2 * mp.sqrt(1 + kappa) / kappa,
        "least_limiting_pitch": mp.atan(mp.sqrt(1 + kappa)) - zeta,
    }  # fmt: skip
    slip = out["gap_tangential_rate"]
    normal, friction = out["holding_normal_acceleration"], out["holding_tangential_acceleration"]
    out["*grip"] = mu_s * normal - abs(friction)
    out["*chi"], out["*slip"], out["*nt"] = chi, slip, nt
    held = slip == 0 and normal >= 0 and out["*grip"] >= 0
    sigma = mp.sign(slip) if slip else 0 if held or chi > 0 else -mp.sign(friction)
    tau = out["*tau"] = nn - sigma * mu * nt
    pushed = nt - sigma * mu * tt
    if variant == "thesis":
        square = sine**2 if scene.startswith("rect") else cosine**2
        pushed = sigma * mu + nt - sigma * mu * kappa * square
    out["slip_direction"], out["normal_response"] = mpf(sigma), tau
    out["impact_impulse_normal"] = out["impact_impulse_tangential"] = mpf(0)
    lost = not held and tau <= 0 and chi < 0
    if held:
        n, t, gap, slipping = normal, friction, mpf(0), mpf(0)
    elif lost:
        n = t = gap = slipping = mp.nan
        turn = nn * tt - nt**2
        out["impact_impulse_normal"] = p["mass"] * nt * slip / turn
        out["impact_impulse_tangential"] = -p["mass"] * nn * slip / turn
    elif tau >= 0 and chi > 0:
        n, t, gap, slipping = mpf(0), mpf(0), chi, along
    else:
        n = -chi / tau
        t, gap, slipping = -sigma * mu * n, mpf(0), pushed * n + along
    return out | {
        "floor_acceleration": n, "floor_force": p["mass"] * n, "acceleration_along": t,
        "friction_force": p["mass"] * t, "acceleration_upward": n - g,
        "pitch_acceleration": -kappa * (n * cosine + t * sine) / rho,
        "gap_normal_acceleration": gap, "gap_tangential_acceleration": slipping,
    }  # fmt: skip


JUMPING = {
    "slip_direction", "normal_response", "floor_acceleration", "floor_force", "friction_force",
    "acceleration_along", "acceleration_upward", "pitch_acceleration", "gap_normal_acceleration",
    "gap_tangential_acceleration", "impact_impulse_normal", "impact_impulse_tangential",
}  # fmt: skip
SWITCHES = {
    **dict.fromkeys(JUMPING, ("*chi", "*slip", "*grip", "*tau")),
    "limiting_friction_right": ("*nt",),
    "limiting_friction_left": ("*nt",),
}
SIGNED = (
    "pitch", "pitch_rate", "centre_along", "velocity_along", "velocity_upward",
)  # fmt: skip
ENDS = {
    "pitch": (-math.pi, -math.pi / 2, -1e-12, 0.0, 1e-300, 1e-9, math.pi / 2, math.pi),
    "height": (1e-9, 1e-3, 1e3), "diameter": (1e-9, 1e-3, 1e3), "length": (1e-9, 1e-3, 1e3),
    "friction_kinetic": (0.0, 1e-300, 1e-9, 4 / 3, 1e6), "pitch_rate": (0.0, 1e-150, 1e-6, 1e6),
    "gravity": (1e-6, 9.80665, 1e6), "mass": (1e-12, 1e6), "velocity_along": (0.0, 1e-12, 1e6),
    "velocity_upward": (0.0, 1e3), "centre_along": (0.0, 1e6), "centre_height": (0.0, 1e-9, 1e6),
}  # fmt: skip


def make_points(scene: str) -> list[dict[str, float]]:
    """Return random points over decades, a quarter with a corner at rest, and extreme ones."""
    rng = np.random.default_rng(33315)
    decades = {
        ACROSS[scene]: (-3, 0), "length": (-3, 0), "pitch_rate": (-1, 2), "gravity": (0, 1.5),
        "mass": (-4, 0), "velocity_along": (-3, 1), "velocity_upward": (-3, 1),
        "centre_along": (-3, 0), "centre_height": (-3, 0),
    }  # fmt: skip
    points = []
    for number in range(RANDOM + EXTREME):
        point = {name: float(10 ** rng.uniform(*ends)) for name, ends in decades.items()}
        point["pitch"] = float(rng.uniform(0, math.pi if number % 2 else 1.2))
        for name in SIGNED:
            point[name] *= rng.choice((1, -1)) if number % 2 else 1
        point["friction_kinetic"] = float(rng.choice((1.0, 5.0)) * rng.uniform())
        if number >= RANDOM:
            for name in point:
                if rng.random() < 0.6:
                    point[name] = float(rng.choice(ENDS[name]))
        point["friction_static"] = point["friction_kinetic"] * float(rng.choice((1.0, 1.3)))
        point["slips"] = float(number % 4 > 0)
        points.append(point)
    return points


def evaluate(scene: str, variant: str, points: list[dict[str, float]]) -> dict[str, np.ndarray]:
    """Return every output; the points that slip have a velocity along the floor, others none."""
    got: dict[str, np.ndarray] = {}
    slipping = np.array([bool(point["slips"]) for point in points])
    for where, lacks in ((slipping, ()), (~slipping, ("velocity_along", "gap_tangential_rate"))):
        names = [name for name in points[0] if name not in ("slips", *lacks)]
        cells = {name: np.array([point[name] for point in points])[where] for name in names}
        outputs = [n for n in SCENES[scene].outputs(variant) if n not in ("regime", *lacks)]
        for name, values in values_at(scene, variant, outputs, cells).items():
            got.setdefault(name, np.zeros(len(points)))[where] = values
    return got


@pytest.mark.parametrize("variant", ["thesis", "derived"])
@pytest.mark.parametrize("scene", list(ACROSS))
def test_every_output_is_exact_to_the_bar(scene: str, variant: str) -> None:
    points, skipped, wrong = make_points(scene), [], []
    got = evaluate(scene, variant, points)
    if variant == "thesis":  # the rest is the same code, run on the same points
        got = {name: got[name] for name in ("gap_tangential_acceleration",)}
    with mp.workdps(DIGITS):
        for number, values in enumerate(points):
            point = {name: mpf(value) for name, value in values.items()}
            right = exact(scene, variant, point)
            beyond = [n for n in got if excess(float(got[n][number]), right[n], mpf(0)) > BAR]
            moved = sensitivities(scene, variant, point) if beyond else {}
            for name in beyond:
                at_switch = any(
                    abs(right[switch]) <= BAR * moved[switch] * EPSILON
                    and (switch != "*slip" or values["slips"])
                    for switch in SWITCHES.get(name, ())
                )
                found = float(got[name][number])
                if excess(found, right[name], moved[name]) > BAR:
                    (skipped if at_switch else wrong).append((name, found, right[name], values))
    assert not wrong, (len(wrong), sorted({w[0] for w in wrong}), wrong[:3])
    assert len(skipped) <= 0.002 * len(points) * len(got)


def sensitivities(scene: str, variant: str, point: dict[str, mpf]) -> dict[str, mpf]:
    """Return the sum of |x_i dF/dx_i| over the inputs, for every output."""
    sums = collections.defaultdict(mpf)
    for key in point.keys() - {"slips"}:
        up, down = (
            exact(scene, variant, point | {key: point[key] * (1 + way)}) for way in (STEP, -STEP)
        )
        for output in up if point[key] else ():
            sums[output] += abs(up[output] - down[output]) / (2 * STEP)
    return sums


def excess(found: float, right: mpf, moved: mpf) -> float:
    """Return the error over K ulp of a value that its inputs move so far."""
    if not mp.isfinite(right) or not math.isfinite(found):
        return 0.0 if found == right or (mp.isnan(right) and math.isnan(found)) else math.inf
    return float(abs(mpf(found) - right) / max(mpf(math.ulp(float(right))), moved * EPSILON / 2))
