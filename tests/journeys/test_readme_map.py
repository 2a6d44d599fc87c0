"""The map of the README at twenty points, and two closed forms of its speeds.

The speeds of `slip` and `hop_after_hop` are kept from the closed forms below, the others from a
program that follows a part in 30 digits of mpmath and shares no code with the package
(tests/data/README.md).
"""

from pathlib import Path

import numpy as np
import xarray

from newcomer import parts_of

README = Path(__file__).parents[2] / "README.md"
GRAVITY, FRICTION, TURNING = 9.80665, 0.4, 2 * np.pi * 50
KEPT = [  # amplitude [mm], beta [deg], regime, speed [mm/s]
    (0.07, 21, "stick_slip", 3.1845446281990046),
    (0.09, 28, "stick_slip", 6.78454964707532),
    (0.1, 37, "stick_slip", 9.400242410356011),
    (0.12, 52, "stick_slip", 12.264461834702953),
    (0.16, 25, "slip", 16.78648985943697),
    (0.2, 12, "slip", 10.925170081838282),
    (0.21, 26, "slip", 24.0013779960803),
    (0.3, 6, "slip", 8.50613541097785),
    (0.57, 9, "slip", 24.58647851751177),
    (0.7, 6, "slip", 20.216864553864855),
    (0.17, 36, "hopping", 24.008917724474216),
    (0.28, 30, "hopping", 37.76019623210373),
    (0.32, 38, "hopping", 62.69550404238733),
    (0.4, 36, "hopping", 96.67268826589945),
    (0.48, 34, "hopping", 123.20336359433416),
    (0.56, 33, "hopping", 145.87383216679453),
    (0.49, 42, "hop_after_hop", 108.91388218549702),
    (0.53, 44, "hop_after_hop", 101.55083351734287),
    (0.58, 37, "hop_after_hop", 130.13864099943794),
    (0.69, 32, "hop_after_hop", 156.93920609220416),
]


def two_sided_slip(drive: float, beta: float) -> float:
    """Return the speed [g/w] of a part that slides forwards and backwards and never sticks.

    It slides forwards for D = pi (1 + mu tan(beta)), about the phase at which
    2 c sin(m) sin(D/2) = pi mu: then both slides end at rest (theory 13.2).
    """
    along, normal = drive * np.cos(beta), drive * np.sin(beta)
    D = np.pi * (1 + FRICTION * normal / along)
    middle = np.pi - np.arcsin(np.pi * FRICTION / (2 * along * np.sin(D / 2)))

    def slide(way: int, start: float, D: float) -> float:
        swing = np.cos(start) * D - np.sin(start + D) + np.sin(start)
        return (along + way * FRICTION * normal) * swing - way * FRICTION * D**2 / 2

    way = slide(1, middle - D / 2, D) + slide(-1, middle + D / 2, 2 * np.pi - D)
    return way / (2 * np.pi)


def test_the_map_of_the_readme(vibrafeed, tmp_path):
    (study,) = (part for part in parts_of(README.read_text()) if part.title == "motion.toml")
    (tmp_path / "motion.toml").write_text(study.text)
    vibrafeed("run", "motion.toml")
    found = xarray.load_dataset(tmp_path / "motion.nc", decode_times=False)
    names = dict(zip(found.regime.flag_values, found.regime.flag_meanings.split(), strict=True))
    assert len(KEPT) == 20
    for amplitude, beta, regime, speed in KEPT:
        cell = found.sel(amplitude=amplitude / 1e3, beta=beta, method="nearest")
        assert names[int(cell.regime)] == regime
        np.testing.assert_allclose(1e3 * cell.conveying_velocity, speed, rtol=1e-11)
        angle = np.radians(beta)
        if regime == "slip":
            scaled = two_sided_slip(amplitude / 1e3 * TURNING**2 / GRAVITY, angle)
        elif regime == "hop_after_hop":  # each landing stops it: pi g cot(beta)/w (theory 13.8)
            scaled = np.pi / np.tan(angle)
        else:
            continue
        np.testing.assert_allclose(1e3 * scaled * GRAVITY / TURNING, speed, rtol=1e-13)
