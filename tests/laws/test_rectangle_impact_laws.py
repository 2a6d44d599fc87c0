"""Laws of the impacts of two rectangles; tolerances are argued in `tests/helpers/impacts.py`."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from impacts import CLOSE, IMPACTS, LAWS, evaluate, mirrored, swapped, where
from vibrafeed.core.mechanics import impact


@functools.cache
def rectangles() -> dict[str, np.ndarray]:
    """Return 100,000 pairs that touch, a corner of one on an edge of the other, and approach.

    Body A, with the corner, is placed by its corner on a random point of a random face of body C.
    Either of them is body 1.
    """
    random = np.random.default_rng(3240)
    n = 3 * IMPACTS
    size = 10 ** random.uniform(-3, -1, n)
    h, a = size * random.uniform(0.2, 1, n), size * random.uniform(0.2, 1, n)
    scale = 10 ** random.uniform(-1, 1, n)
    ho, ao = size * scale * random.uniform(0.2, 1, n), size * scale * random.uniform(0.2, 1, n)
    x, y = random.uniform(-1, 1, n) * size, random.uniform(-1, 1, n) * size
    angle = random.uniform(-np.pi, np.pi, n)
    quarter = random.integers(0, 4, n)
    along_x = quarter % 2 == 0
    d, half = np.where(along_x, ho, ao) / 2, np.where(along_x, ao, ho) / 2
    turn = angle + quarter * np.pi / 2
    n_x, n_y = np.cos(turn), np.sin(turn)
    place = random.uniform(-0.98, 0.98, n) * half
    p_x, p_y = x + n_x * d - n_y * place, y + n_y * d + n_x * place
    # The corner that lies deepest along -n, for a body turned by any angle but the four flat ones.
    other = random.uniform(-np.pi, np.pi, n)
    flat = np.abs(np.sin(2 * (other - turn))) < 0.02
    other = np.where(flat, other + 0.05, other)
    c, s = np.cos(other), np.sin(other)
    i = np.where(n_x * c + n_y * s > 0, -1, 1) * h / 2
    j = np.where(n_y * c - n_x * s > 0, -1, 1) * a / 2
    points = {
        "position_x_1": p_x - (i * c - j * s), "position_y_1": p_y - (i * s + j * c),
        "angle_1": other, "length_1": h, "width_1": a,
        "position_x_2": x, "position_y_2": y, "angle_2": angle, "length_2": ho, "width_2": ao,
        "mass_1": 10 ** random.uniform(-3, 0, n), "mass_2": 10 ** random.uniform(-3, 0, n),
        "friction": random.choice([0.0, 1.0, 3.0], n, p=[0.05, 0.65, 0.3])
        * random.uniform(0, 1, n),
        "restitution": random.choice([0.0, 1.0, -1.0], n, p=[0.1, 0.1, 0.8]),
    }  # fmt: skip
    free = points["restitution"] < 0
    points["restitution"] = np.where(free, random.uniform(0, 1, n), points["restitution"])
    for body in "12":
        for axis in "xy":
            points[f"velocity_{axis}_{body}"] = random.normal(size=n)
        points[f"spin_{body}"] = random.normal(size=n) / size
    other_way = random.uniform(size=n) < 0.5
    turned = swapped(points)
    points = {k: np.where(other_way, turned[k], v) for k, v in points.items()}
    at = evaluate("rectangle-pair-impact", "frictionless", points)
    assert not np.any(where(at, "apart", "overlap", "simultaneous"))
    chosen = np.flatnonzero(at["approach_normal"] < 0)[:IMPACTS]
    assert len(chosen) == IMPACTS
    return {k: v[chosen] for k, v in points.items()}


@functools.cache
def of_rectangles(law: str) -> dict[str, np.ndarray]:
    return evaluate("rectangle-pair-impact", law, rectangles())


def speed_scale(at: dict) -> np.ndarray:
    """Return the sum of the speeds that both bodies have at the contact, before and after."""
    total = np.zeros(IMPACTS)
    for body in "12":
        arm = np.hypot(
            at["contact_x"] - at[f"position_x_{body}"], at["contact_y"] - at[f"position_y_{body}"]
        )
        for end in ("", "_after"):
            total += np.hypot(at[f"velocity_x_{body}{end}"], at[f"velocity_y_{body}{end}"])
            total += arm * np.abs(at[f"spin_{body}{end}"])
    return total


def planar_energy(at: dict, end: str) -> np.ndarray:
    return sum(
        at[f"mass_{b}"] * (at[f"velocity_x_{b}{end}"] ** 2 + at[f"velocity_y_{b}{end}"] ** 2)
        + at[f"inertia_{b}"] * at[f"spin_{b}{end}"] ** 2
        for b in "12"
    ) / 2  # fmt: skip


@pytest.mark.parametrize("law", LAWS)
class TestRectangles:
    def test_every_one_is_an_impact_of_a_corner_on_an_edge(self, law):
        at = of_rectangles(law)
        assert np.all(where(at, "impact", "impact_stick", "impact_slip"))
        assert np.all(np.isin(at["face_body"], (1, 2)))
        assert np.all(np.isin(at["contact_corner"], (1, 2, 3, 4)))
        # the gap as placed: rounding of the positions
        assert np.all(np.abs(at["gap"]) <= 1e-14 * at["rectangle_contact"].size)
        if law != "frictionless":
            assert (
                min(where(at, "impact_stick").sum(), where(at, "impact_slip").sum()) > IMPACTS // 5
            )

    def test_momentum_is_kept(self, law):
        at = of_rectangles(law)
        linear, angular = np.zeros((2, IMPACTS)), np.zeros(IMPACTS)
        size, turning = np.zeros(IMPACTS), np.zeros(IMPACTS)
        for b in "12":
            m, x, y = at[f"mass_{b}"], at[f"position_x_{b}"], at[f"position_y_{b}"]
            for end, sign in (("", -1), ("_after", 1)):
                p_x, p_y = m * at[f"velocity_x_{b}{end}"], m * at[f"velocity_y_{b}{end}"]
                own = at[f"inertia_{b}"] * at[f"spin_{b}{end}"]
                linear += sign * np.array([p_x, p_y])
                angular += sign * (x * p_y - y * p_x + own)
                size += np.hypot(p_x, p_y)
                turning += np.hypot(x, y) * np.hypot(p_x, p_y) + np.abs(own)
        assert np.all(np.abs(linear) <= CLOSE * size)
        assert np.all(np.abs(angular) <= CLOSE * turning)
        for name in ("momentum_residual_x", "momentum_residual_y"):
            assert np.all(np.abs(at[name]) <= CLOSE * size)
        assert np.all(np.abs(at["angular_momentum_residual"]) <= CLOSE * turning)

    def test_friction_stays_in_its_cone_and_opposes_sliding(self, law):
        at = of_rectangles(law)
        L_N, L_T = at["impulse_normal"], at["impulse_tangential"]
        assert np.all(L_N > 0)
        if law == "frictionless":
            assert np.all(L_T == 0)
            return
        limit = at["friction"] * L_N
        assert np.all(np.abs(L_T) <= limit * (1 + CLOSE))
        slack = CLOSE * speed_scale(at)
        slides, sticks = where(at, "impact_slip"), where(at, "impact_stick")
        # moreau: sliding before, weighted by eps, and after together; in stick they cancel
        u = at["separation_tangential"]
        if law == "moreau":
            u = u + at["restitution"] * at["approach_tangential"]
        assert np.all(np.abs(u)[sticks] <= slack[sticks])
        if law == "moreau":
            assert np.all(np.abs(np.abs(L_T) - limit)[slides] <= CLOSE * limit[slides])
            assert np.all((u * L_T)[slides] <= (slack * np.abs(L_T))[slides])

    def test_the_bodies_separate_as_restitution_says(self, law):
        at = of_rectangles(law)
        u_N, after = at["approach_normal"], at["separation_normal"]
        slack = CLOSE * speed_scale(at)
        assert np.all(after >= -slack)
        if law != "pfeiffer_glocker":  # there eps is a ratio of impulses, tested below
            assert np.all(np.abs(after + at["restitution"] * u_N) <= slack)

    def test_energy_is_never_created(self, law):
        at = of_rectangles(law)
        before, after = at["energy_before"], planar_energy(at, "_after")
        assert np.all(np.abs(before - planar_energy(at, "")) <= CLOSE * before)
        assert np.all(np.abs(before - after - at["energy_lost"]) <= CLOSE * before)
        assert np.all(at["energy_lost"] >= -CLOSE * before)
        if law == "frictionless":
            eps, u_N = at["restitution"], at["approach_normal"]
            expected = (1 - eps**2) * u_N**2 / (2 * at["delassus_normal"])
            # the outputs of the velocities after round to the speeds at the contact
            slack = CLOSE * at["impulse_normal"] * speed_scale(at)
            assert np.all(np.abs(at["energy_lost"] - expected) <= slack)

    def test_swapping_the_bodies_changes_nothing(self, law):
        at = of_rectangles(law)
        other = swapped(evaluate("rectangle-pair-impact", law, swapped(rectangles())))
        self.same(at, {k.replace("_1_after", "#").replace("_2_after", "_1_after")
                        .replace("#", "_2_after"): v for k, v in other.items()})  # fmt: skip

    def test_mirroring_the_frame_changes_nothing(self, law):
        at = of_rectangles(law)
        flip = ("position_y", "angle", "velocity_y", "spin")
        other = evaluate("rectangle-pair-impact", law, mirrored(rectangles(), flip))
        for body in "12":
            for name in ("velocity_y", "spin"):
                other[f"{name}_{body}_after"] = -other[f"{name}_{body}_after"]
        self.same(at, {**other, "impulse_tangential": -other["impulse_tangential"]})

    def test_turning_and_moving_the_frame_changes_nothing(self, law):
        points, random = rectangles(), np.random.default_rng(5)
        turn = random.uniform(-np.pi, np.pi, IMPACTS)
        c, s = np.cos(turn), np.sin(turn)
        move = np.hypot(points["length_1"], points["length_2"])
        turned = dict(points)
        for b in "12":
            for name, shift in (("position", move), ("velocity", 0.3)):
                x, y = points[f"{name}_x_{b}"], points[f"{name}_y_{b}"]
                turned[f"{name}_x_{b}"] = c * x - s * y + shift
                turned[f"{name}_y_{b}"] = s * x + c * y - shift
            turned[f"angle_{b}"] = points[f"angle_{b}"] + turn
        other = evaluate("rectangle-pair-impact", law, turned)
        for b in "12":
            x, y = other[f"velocity_x_{b}_after"] - 0.3, other[f"velocity_y_{b}_after"] + 0.3
            other[f"velocity_x_{b}_after"] = c * x + s * y
            other[f"velocity_y_{b}_after"] = c * y - s * x
        self.same(of_rectangles(law), other)

    def same(self, at: dict, other: dict) -> None:
        """Assert that two evaluations agree in everything that does not depend on the frame.

        The velocities move with the normal, which a turned frame knows to a few ulp of an angle.
        """
        scale = speed_scale(at)
        size = at["rectangle_contact"].size
        for b in "12":
            for name in (f"velocity_x_{b}_after", f"velocity_y_{b}_after"):
                assert np.all(np.abs(at[name] - other[name]) <= 10 * CLOSE * scale), name
            error = np.abs(at[f"spin_{b}_after"] - other[f"spin_{b}_after"])
            arm = np.sqrt(at[f"inertia_{b}"] / at[f"mass_{b}"])
            assert np.all(error * arm <= 10 * CLOSE * scale)
        reduced = 1 / at["delassus_normal"]
        for name in ("impulse_normal", "impulse_tangential"):
            assert np.all(np.abs(at[name] - other[name]) <= 10 * CLOSE * scale * reduced), name
        assert np.all(np.abs(at["gap"] - other["gap"]) <= CLOSE * size)
        np.testing.assert_array_equal(at["regime"], other["regime"])


class TestPoisson:
    def test_the_expansion_has_eps_times_the_impulse_of_the_compression(self):
        """As the ratio with eps = 0, whose impulse is the compression alone."""
        at = of_rectangles("pfeiffer_glocker")
        names = {"G_NN": "delassus_normal", "G_NT": "delassus_coupling",
                 "G_TT": "delassus_tangential", "u_N": "approach_normal",
                 "u_T": "approach_tangential", "friction": "friction"}  # fmt: skip
        given = {short: at[name] for short, name in names.items()}
        compression = impact.pfeiffer_glocker(**given, restitution=np.zeros(IMPACTS)).normal
        ratio = at["impulse_normal"] / compression
        np.testing.assert_allclose(ratio, 1 + at["restitution"], rtol=CLOSE)


def test_one_solution_of_the_planar_law_passes_the_tests_of_its_cases():
    """Stick and both directions of sliding, each with its own acceptance, mu up to 10."""
    random = np.random.default_rng(53)
    a, b, mass = random.normal(size=(3, IMPACTS)), random.normal(size=(3, IMPACTS)), 0.1
    G_NN, G_NT, G_TT = (a * a).sum(0) + mass, (a * b).sum(0), (b * b).sum(0) + mass
    u_N, u_T = -random.uniform(0, 1, IMPACTS), random.normal(size=IMPACTS)
    mu = random.uniform(0, 10, IMPACTS)
    given = {"G_NN": G_NN, "G_NT": G_NT, "G_TT": G_TT, "u_N": u_N, "u_T": u_T, "friction": mu}
    found = impact.moreau(**given, restitution=np.zeros(IMPACTS))
    accepted = []
    determinant = G_NN * G_TT - G_NT**2
    L_N = (G_NT * u_T - G_TT * u_N) / determinant
    L_T = (G_NT * u_N - G_NN * u_T) / determinant
    accepted.append((np.abs(L_T) <= mu * L_N, L_N, L_T))
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
