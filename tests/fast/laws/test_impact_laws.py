"""Laws of impacts of two bodies: thousands of random ones for each law of impact and shape.

Tolerances: each is 1e-12 of the sum of the magnitudes that cancel in what is compared (momenta of
both bodies, velocities of both at the contact). A few dozen operations with a rounding error of
1.1e-16 each stay below 1e-14 of it; the rest is for badly matched masses and arms.
"""

import functools

import numpy as np
import pytest

from night import count
from plans import quantities_at
from vibrafeed.core.mechanics import impact
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes import SCENES

IMPACTS = count(3_000, 100_000)
DRAWN = 3 * IMPACTS
CLOSE = 1e-12
RECTANGLES, CYLINDERS = "rectangle-pair-impact", "cylinder-pair-impact"
SHAPES = pytest.mark.parametrize("scene", [RECTANGLES, CYLINDERS])
LAWS = pytest.mark.parametrize("law", ["frictionless", "pfeiffer_glocker", "moreau"])


def evaluate(scene: str, law: str, points: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return every quantity of a law at the points, and the regime's numbers."""
    given = {k: v for k, v in points.items() if law != "frictionless" or k != "friction"}
    return quantities_at(scene, law, SCENES[scene].outputs(law), given)


def where(known: dict, *names: str) -> np.ndarray:
    return np.isin(known["regime"], [REGIMES[name].value for name in names])


def swapped(points: dict) -> dict:
    other = {"1": "2", "2": "1"}
    return {k[:-1] + other[k[-1]] if k[-1] in other else k: v for k, v in points.items()}


def unit(x: np.ndarray) -> np.ndarray:
    return x / np.linalg.norm(x, axis=0)


def axis_of(points: dict, body: str) -> np.ndarray:
    az, el = points[f"azimuth_{body}"], points[f"elevation_{body}"]
    return np.array([np.cos(el) * np.cos(az), np.cos(el) * np.sin(az), np.sin(el)])


def rectangles() -> dict[str, np.ndarray]:
    """Return pairs that touch and approach: a corner of one on a random point of a random face."""
    random, n = np.random.default_rng(3240), DRAWN
    size = 10 ** random.uniform(-3, -1, n)
    h, a = size * random.uniform(0.2, 1, (2, n))
    ho, ao = size * 10 ** random.uniform(-1, 1, n) * random.uniform(0.2, 1, (2, n))
    x, y = random.uniform(-1, 1, (2, n)) * size
    angle, other = random.uniform(-np.pi, np.pi, (2, n))
    quarter = random.integers(0, 4, n)
    d, half = (np.where(quarter % 2 == 0, *sides) / 2 for sides in ((ho, ao), (ao, ho)))
    turn = angle + quarter * np.pi / 2
    n_x, n_y = np.cos(turn), np.sin(turn)
    place = random.uniform(-0.98, 0.98, n) * half
    p_x, p_y = x + n_x * d - n_y * place, y + n_y * d + n_x * place
    # The corner that lies deepest along -n, for a body turned by any angle but the four flat ones.
    other = np.where(np.abs(np.sin(2 * (other - turn))) < 0.02, other + 0.05, other)
    c, s = np.cos(other), np.sin(other)
    i = np.where(n_x * c + n_y * s > 0, -1, 1) * h / 2
    j = np.where(n_y * c - n_x * s > 0, -1, 1) * a / 2
    points = {
        "position_x_1": p_x - (i * c - j * s), "position_y_1": p_y - (i * s + j * c),
        "angle_1": other, "length_1": h, "width_1": a,
        "position_x_2": x, "position_y_2": y, "angle_2": angle, "length_2": ho, "width_2": ao,
        "friction": random.choice([0.0, 1.0, 3.0], n) * random.uniform(0, 1, n),
    }  # fmt: skip
    for body in "12":
        points[f"velocity_x_{body}"], points[f"velocity_y_{body}"] = random.normal(size=(2, n))
        points[f"spin_{body}"] = random.normal(size=n) / size
    return drawn(RECTANGLES, points, random)


def cylinders() -> dict[str, np.ndarray]:
    """Return pairs that touch in one point and approach: rims on faces and sides, sides on sides.

    A point of body B's surface and its normal are drawn; body A is put on it with the point that
    comes first along the normal.
    """
    random, n = np.random.default_rng(3344), DRAWN
    size = 10 ** random.uniform(-3, -1, n)
    r_A, l_A = size * random.uniform(0.1, 0.5, (2, n))
    r_B, l_B = size * 10 ** random.uniform(-0.5, 0.5, n) * random.uniform(0.1, 0.5, (2, n))
    u_A, u_B, sideways = (unit(random.normal(size=(3, n))) for _ in range(3))
    c_B = size * random.uniform(-1, 1, (3, n))
    radial = unit(np.cross(u_B, sideways, axis=0))
    kind = random.integers(0, 3, n)  # rim on face, rim on side, side on side
    end = random.choice([-1, 1], n)
    on_face = c_B + end * l_B * u_B + 0.95 * r_B * np.sqrt(random.uniform(size=n)) * radial
    on_side = c_B + 0.95 * l_B * random.uniform(-1, 1, n) * u_B + r_B * radial
    p, normal = (np.where(kind == 0, x, y) for x, y in ((on_face, on_side), (end * u_B, radial)))
    across = unit(u_A - (u_A * normal).sum(0) * normal)
    u_A = np.where(kind == 2, across, u_A)
    w = (u_A * normal).sum(0)
    along = np.where(kind == 2, 0.95 * random.uniform(-1, 1, n), -np.sign(w)) * l_A
    c_A = p - along * u_A + r_A * unit(normal - w * u_A)
    # Leave out what is nearly a line or a plane.
    good = (np.abs(w) < 0.999) & ((kind == 2) | (np.abs(w) > 1e-3))
    good &= (kind != 2) | (np.abs((u_A * u_B).sum(0)) < 0.999)
    points: dict[str, np.ndarray] = {"friction": random.choice([0.0, 1.5, 1.5], n)}
    points["friction"] *= random.uniform(0, 1, n)
    for body, c, u, r, half in (("1", c_A, u_A, r_A, l_A), ("2", c_B, u_B, r_B, l_B)):
        for i, axis in enumerate("xyz"):
            points[f"position_{axis}_{body}"] = c[i]
            points[f"velocity_{axis}_{body}"] = random.normal(size=n)
            points[f"spin_{axis}_{body}"] = random.normal(size=n) / size
        points[f"azimuth_{body}"], points[f"elevation_{body}"] = angles(u)
        points[f"diameter_{body}"], points[f"length_{body}"] = 2 * r, 2 * half
    return drawn(CYLINDERS, points, random, good)


def angles(axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.arctan2(axis[1], axis[0]), np.arcsin(np.clip(axis[2], -1, 1))


def drawn(scene: str, points: dict, random: np.random.Generator, good: object = True) -> dict:
    """Return those that approach, with masses and restitution."""
    for body in "12":
        points[f"mass_{body}"] = 10 ** random.uniform(-3, 0, DRAWN)
    points["restitution"] = np.clip(random.uniform(-0.1, 1.1, DRAWN), 0, 1)
    other_way, turned = random.uniform(size=DRAWN) < 0.5, swapped(points)
    points = {k: np.where(other_way, turned[k], v) for k, v in points.items()}
    at = evaluate(scene, "frictionless", points)
    # The far rim of a cylinder may reach through the other one; the rest is found as placed.
    assert where(at, "overlap")[good].mean() < (0.05 if scene == CYLINDERS else 1e-9)
    assert not np.any(where(at, "apart", "simultaneous")[good])
    chosen = np.flatnonzero(good & where(at, "impact"))[:IMPACTS]
    assert len(chosen) == IMPACTS
    return {k: v[chosen] for k, v in points.items()}


@functools.cache
def pairs(scene: str) -> dict[str, np.ndarray]:
    return rectangles() if scene == RECTANGLES else cylinders()


@functools.cache
def of_pairs(scene: str, law: str) -> dict[str, np.ndarray]:
    return evaluate(scene, law, pairs(scene))


def vector(at: dict, name: str, end: str = "") -> np.ndarray:
    """Return a vector in space, of rectangles too: they move in a plane and turn about z."""
    none = np.zeros(IMPACTS)
    if name == "spin" and f"spin{end}" in at:
        return np.array([none, none, at[f"spin{end}"]])
    return np.array([at.get(f"{name}_{axis}{end}", none) for axis in "xyz"])


def momentum_about(at: dict, body: str, spin: np.ndarray) -> np.ndarray:
    """Return J w of a body."""
    m = at[f"mass_{body}"]
    if f"width_{body}" in at:
        return m * (at[f"length_{body}"] ** 2 + at[f"width_{body}"] ** 2) / 12 * spin
    d, h = at[f"diameter_{body}"], at[f"length_{body}"]
    axial, transverse, u = m * d**2 / 8, m * (0.75 * d**2 + h**2) / 12, axis_of(at, body)
    return transverse * spin + (axial - transverse) * (u * spin).sum(0) * u


def states(at: dict):
    """Yield body, -1 before and +1 after, mass, position, velocity and spin."""
    for body in "12":
        for sign, end in ((-1, f"_{body}"), (1, f"_{body}_after")):
            position = vector(at, "position", f"_{body}")
            velocity, spin = vector(at, "velocity", end), vector(at, "spin", end)
            yield body, sign, at[f"mass_{body}"], position, velocity, spin


def speeds(at: dict) -> np.ndarray:
    """Return the sum of the speeds that both bodies have at the contact, before and after."""
    return sum(
        np.linalg.norm(v, axis=0)
        + np.linalg.norm(vector(at, "contact") - r, axis=0) * np.linalg.norm(w, axis=0)
        for _, _, _, r, v, w in states(at)
    )


@SHAPES
@LAWS
def test_every_one_is_an_impact_at_a_point(scene, law):
    at = of_pairs(scene, law)
    assert np.all(where(at, "impact", "impact_stick", "impact_slip"))
    forms = at["contact_form"] if scene == CYLINDERS else at["face_body"]
    assert np.all(np.isin(forms, (1, 2, 4)))
    size = at[f"{scene.partition('-')[0]}_contact"].size
    assert np.all(np.abs(at["gap"]) <= 1e-12 * size)
    if law != "frictionless":
        both = [where(at, regime).sum() for regime in ("impact_stick", "impact_slip")]
        assert min(both) > IMPACTS // 10


@SHAPES
@LAWS
def test_momentum_is_kept_and_energy_never_created(scene, law):
    at = of_pairs(scene, law)
    linear, angular = np.zeros((2, 3, IMPACTS))
    size, turning = np.zeros((2, IMPACTS))
    energy = {-1: 0.0, 1: 0.0}
    for body, sign, m, r, v, w in states(at):
        own = momentum_about(at, body, w)
        linear += sign * m * v
        angular += sign * (np.cross(r, m * v, axis=0) + own)
        size += np.linalg.norm(m * v, axis=0)
        turning += np.linalg.norm(r, axis=0) * np.linalg.norm(m * v, axis=0)
        turning += np.linalg.norm(own, axis=0)
        energy[sign] = energy[sign] + (m * (v * v).sum(0) + (w * own).sum(0)) / 2
    assert np.all(np.abs(linear) <= CLOSE * size)
    assert np.all(np.abs(angular) <= CLOSE * turning)
    assert np.all(np.abs(vector(at, "momentum_residual")) <= CLOSE * size)
    about = "angular_momentum_residual"
    residual = vector(at, about) if f"{about}_x" in at else at[about]
    assert np.all(np.abs(residual) <= CLOSE * turning)
    before = at["energy_before"]
    assert np.all(np.abs(before - energy[-1]) <= CLOSE * before)
    assert np.all(np.abs(before - energy[1] - at["energy_lost"]) <= CLOSE * before)
    assert np.all(at["energy_lost"] >= -CLOSE * before)
    if law == "frictionless":
        expected = (1 - at["restitution"] ** 2) * at["approach_normal"] ** 2
        slack = CLOSE * at["impulse_normal"] * speeds(at)
        assert np.all(np.abs(at["energy_lost"] - expected / (2 * at["delassus_normal"])) <= slack)


def sliding(at: dict, sign: int) -> np.ndarray:
    """Return the velocity of body 1 against body 2 across the normal, before or after."""
    apart, n = np.zeros((3, IMPACTS)), vector(at, "normal")
    for body, when, _, r, v, w in states(at):
        if when == sign:
            there = v + np.cross(w, vector(at, "contact") - r, axis=0)
            apart += there if body == "1" else -there
    return apart - (apart * n).sum(0) * n


@SHAPES
@LAWS
def test_friction_stays_in_its_disc_and_opposes_sliding(scene, law):
    at = of_pairs(scene, law)
    n, L_N = vector(at, "normal"), at["impulse_normal"]
    assert np.all(L_N > 0)
    if scene == CYLINDERS:
        L_T = vector(at, "impulse") - L_N * n
    else:
        L_T = at["impulse_tangential"] * np.array([-n[1], n[0], n[2]])
    size = np.linalg.norm(L_T, axis=0)
    limit = at["friction"] * L_N if law != "frictionless" else 0 * L_N
    assert np.all(size <= limit + CLOSE * L_N * (1 + limit / L_N))
    if law == "frictionless":
        return
    slack = 1e-11 * speeds(at)  # the root of the sliding direction adds a few digits
    # moreau: sliding before, weighted by eps, and after together; in stick they cancel
    w = sliding(at, 1) + (at["restitution"] * sliding(at, -1) if law == "moreau" else 0.0)
    sticks, slides = where(at, "impact_stick"), where(at, "impact_slip")
    assert np.all(np.linalg.norm(w, axis=0)[sticks] <= slack[sticks])
    if law == "moreau":
        assert np.all(np.abs(size - limit)[slides] <= 10 * CLOSE * (limit + L_N)[slides])
        assert np.all((w * L_T).sum(0)[slides] <= (slack * size)[slides])
        across = np.linalg.norm(np.cross(w, L_T, axis=0), axis=0)
        assert np.all(across[slides] <= (slack * (size + L_N))[slides])


@SHAPES
@LAWS
def test_the_bodies_separate_as_restitution_says(scene, law):
    at = of_pairs(scene, law)
    after, slack = at["separation_normal"], CLOSE * speeds(at)
    assert np.all(after >= -slack)
    if law != "pfeiffer_glocker":  # there eps is a ratio of impulses, tested below
        assert np.all(np.abs(after + at["restitution"] * at["approach_normal"]) <= slack)


def test_the_expansion_has_eps_times_the_impulse_of_the_compression():
    """As the ratio with eps = 0, whose impulse is the compression alone."""
    at = of_pairs(RECTANGLES, "pfeiffer_glocker")
    names = {"G_NN": "delassus_normal", "G_NT": "delassus_coupling", "G_TT": "delassus_tangential",
             "u_N": "approach_normal", "u_T": "approach_tangential",
             "friction": "friction"}  # fmt: skip
    given = {short: at[name] for short, name in names.items()}
    compression = impact.pfeiffer_glocker(**given, restitution=np.zeros(IMPACTS)).normal
    ratio = at["impulse_normal"] / compression
    np.testing.assert_allclose(ratio, 1 + at["restitution"], rtol=CLOSE)


def turned(points: dict, turn: np.ndarray) -> dict:
    """Return points with everything turned by a matrix; of rectangles it is one about z."""
    found = dict(points)
    for b in "12":
        for name in ("position", "velocity", "spin"):
            for axis, value in zip("xyz", turn @ vector(points, name, f"_{b}"), strict=True):
                if f"{name}_{axis}_{b}" in points:
                    found[f"{name}_{axis}_{b}"] = value
        if f"angle_{b}" in points:
            found[f"angle_{b}"] = points[f"angle_{b}"] + np.arctan2(turn[1, 0], turn[0, 0])
        else:
            found[f"azimuth_{b}"], found[f"elevation_{b}"] = angles(turn @ axis_of(points, b))
    return found


def mirrored(points: dict) -> dict:
    """Return points with y -> -y: polar y, axial x and z change sign."""
    names = ("position_y", "velocity_y", "azimuth", "angle", "spin", "spin_x", "spin_z")
    return {k: -v if k.rsplit("_", 1)[0] in names else v for k, v in points.items()}


@SHAPES
@LAWS
def test_swapping_mirroring_and_turning_change_nothing(scene, law):
    at, points = of_pairs(scene, law), pairs(scene)
    same(at, evaluate(scene, law, swapped(points)), np.eye(3), 1, "21")
    same(at, evaluate(scene, law, mirrored(points)), np.diag([1, -1, 1]), -1, "12")
    turn = np.linalg.qr(np.random.default_rng(9).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    if scene == RECTANGLES:
        turn = np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
    # asin of an axis near the pole loses half of the digits
    same(at, evaluate(scene, law, turned(points, turn)), turn, 1, "12", 1e-8)


def same(at: dict, other: dict, turn, axial: int, bodies: str, close: float = 1e-10) -> None:
    """Assert that two evaluations agree; 1/sine of nearly parallel axes costs three digits."""
    scale = speeds(at)
    for body, there in zip("12", bodies, strict=True):
        arm = np.minimum(at[f"length_{body}"], at.get(f"diameter_{body}", 1.0)) / 4
        arm = np.minimum(arm, at.get(f"width_{body}", 1.0))
        for name, way, by in (("velocity", 1, 1.0), ("spin", axial, arm)):
            back = way * turn.T @ vector(other, name, f"_{there}_after")
            error = np.abs(vector(at, name, f"_{body}_after") - back)
            assert np.all(error * by <= close * scale), name
    error = np.abs(at["impulse_normal"] - other["impulse_normal"])
    assert np.all(error <= close * scale / at["delassus_normal"])
    np.testing.assert_array_equal(at["regime"], other["regime"])


def test_one_solution_of_the_planar_law_passes_the_tests_of_its_cases():
    """Stick and both directions of sliding, each with its own acceptance, mu up to 10."""
    random = np.random.default_rng(53)
    a, b = random.normal(size=(2, 3, IMPACTS))
    G_NN, G_NT, G_TT = (a * a).sum(0) + 0.1, (a * b).sum(0), (b * b).sum(0) + 0.1
    u_N, u_T = -random.uniform(0, 1, IMPACTS), random.normal(size=IMPACTS)
    mu = random.uniform(0, 10, IMPACTS)
    given = {"G_NN": G_NN, "G_NT": G_NT, "G_TT": G_TT, "u_N": u_N, "u_T": u_T, "friction": mu}
    found = impact.moreau(**given, restitution=np.zeros(IMPACTS))
    determinant = G_NN * G_TT - G_NT**2
    L_N = (G_NT * u_T - G_TT * u_N) / determinant
    L_T = (G_NT * u_N - G_NN * u_T) / determinant
    accepted = [(np.abs(L_T) <= mu * L_N, L_N, L_T)]
    for s in (1, -1):
        L_N = -u_N / (G_NN - s * mu * G_NT)
        L_T = -s * mu * L_N
        accepted.append(((L_N > 0) & (s * (u_T + G_NT * L_N + G_TT * L_T) > 0), L_N, L_T))
    assert np.all(sum(ok.astype(int) for ok, _, __ in accepted) == 1)
    for number, (ok, L_N, L_T) in enumerate(accepted):
        size = np.hypot(L_N, L_T)[ok]
        assert ok.sum() > IMPACTS // 20
        assert np.all(np.abs(found.normal[ok] - L_N[ok]) <= 1e-10 * size)
        assert np.all(np.abs(found.tangential[ok] - L_T[ok]) <= 1e-10 * size)
        assert np.all(found.sticks[ok] == (number == 0))
