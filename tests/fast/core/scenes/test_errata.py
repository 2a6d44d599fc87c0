"""Errors of the source that the scene of the track shows; the list is in docs/thesis.md."""

import numpy as np
import pytest

from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.quantities import REGIMES

DRIVE = {
    "frequency": 60, "amplitude": "1 mm", "alpha": 0, "beta": 2, "delta": 10, "friction": 0.3,
    "gravity": 9.8, "radius": "0.8 m",
}  # fmt: skip
PART = {"width": "1.5 mm", "height": "10 mm", "length": "50 mm", "mass": "5 g"}


def track(variant: str, outputs: list[str], **parameters: object):
    content = {"kind": "sweep", "scene": "rectangle-on-track", "variant": variant}
    return run_study(parse_study({**content, "outputs": outputs, "parameters": DRIVE | parameters}))


def test_floor_force_from_moments_does_not_carry_the_weight():
    outputs = ["floor_acceleration", "drive_normal", "gravity_normal"]
    sizes = {name: PART[name] for name in ("width", "height")}
    physical = track("physical", [*outputs, "acceleration_x"])
    carried = physical["floor_acceleration"] + physical["drive_normal"]
    np.testing.assert_allclose(carried, physical["gravity_normal"], rtol=1e-14)
    for variant in ("thesis", "derived"):
        # Without lean, sideways drive and speed nothing is left on the floor.
        bare = track(variant, [*outputs, "z_residual"], **sizes, delta=0)
        assert float(bare["floor_acceleration"]) == 0
        left = bare["drive_normal"] - bare["gravity_normal"]
        np.testing.assert_allclose(bare["z_residual"], left, rtol=1e-14)
        assert float(left) < -4


def test_printed_wall_friction_is_outside_its_cone():
    # The wall presses in `derived`; its friction is mu along x and mu along z at once.
    sizes = {name: PART[name] for name in ("width", "height", "mass")}
    pressed = track("derived", ["wall_force", "wall_balance"], **sizes)
    assert float(pressed["wall_balance"]) > 0
    assert float(pressed["regime"]) == REGIMES["outside_cone"].value


@pytest.mark.parametrize("variant", ["thesis", "derived", "physical"])
@pytest.mark.parametrize("name", PART)
def test_no_dimension_of_the_part_enters_velocity(variant: str, name: str):
    with pytest.raises(VibrafeedError, match=name):
        track(variant, ["transport_velocity"], distance="0.15 mm", **{name: PART[name]})
