"""The thesis's best angles of excitation, against their closed form."""

import numpy as np
import pytest
import xarray

STUDY = """
kind = "optimise"
scene = "rectangle-on-plane"
variant = "thesis"
method = "{method}"
floor_contact = {floor}

[criterion]
kind = "maximise"
output = "acceleration_x"

[parameters]
frequency = "60 Hz"
amplitude = ["0.1 mm", "0.2 mm", "0.4 mm"]
friction = [0.1, 0.3, 0.6]
gamma = "2 deg"
gravity = 9.81
"""


@pytest.mark.parametrize("floor", [True, False])
def test_the_best_angles_of_excitation(vibrafeed, tmp_path, floor):
    """From (3.11): alpha = 0, and beta = atan(mu), less where the part would leave the floor."""
    for method, tolerance in (("exact", 1e-12), ("search", 1e-9)):
        (tmp_path / f"{method}.toml").write_text(
            STUDY.format(method=method, floor=str(floor).lower())
        )
        vibrafeed("run", f"{method}.toml")
        best = xarray.load_dataset(tmp_path / f"{method}.nc", decode_times=False)
        peak, gamma = best.amplitude * (2 * np.pi * 60) ** 2, np.radians(2)
        lift_off = np.arcsin(np.minimum(1, 9.81 * np.cos(gamma) / peak))
        beta = np.arctan(best.friction)
        beta = np.minimum(beta, lift_off) if floor else beta + 0 * lift_off
        assert floor == bool((beta < np.arctan(best.friction)).any())
        drive = peak * (np.cos(beta) + best.friction * np.sin(beta))
        largest = drive - 9.81 * (np.sin(gamma) + best.friction * np.cos(gamma))

        order = best.objective.dims
        np.testing.assert_allclose(best.objective, largest.transpose(*order), rtol=tolerance)
        np.testing.assert_allclose(
            np.radians(best.best_beta), beta.transpose(*order), atol=np.sqrt(tolerance)
        )
        np.testing.assert_allclose(np.radians(best.best_alpha), 0, atol=np.sqrt(tolerance))
