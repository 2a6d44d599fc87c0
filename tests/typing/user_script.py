"""What a type checker says of a user's script: mypy reads it (pyproject.toml), nobody runs it.

Each `type: ignore` stands where a user is wrong; mypy tells of one that is not needed.
"""

from __future__ import annotations

import numpy as np
import xarray

import vibrafeed as vf

motion = vf.simulate(
    scene="rectangle-on-track",
    outputs=["conveying_velocity", "hop_height"],
    frequency="50 Hz",
    amplitude=["0.2 mm", "0.3 mm"],
    beta=np.linspace(5, 60, 56),
    gamma={"start": "0 deg", "stop": 4, "num": 5},
    friction=xarray.DataArray([0.2, 0.3]),
    hold_down=range(3),
    restitution=np.float64(0.1),
    acceleration_along_1=1,
    verify=3,
)
speed: xarray.DataArray = motion["conveying_velocity"]
study = vf.study(kind="sweep", scene="rectangle-on-plane", friction=0.3)
changed = vf.sweep(study, beta=(10, 20), precision="single")
name = "rectangle-on-plane"  # not known to be one of the scenes
best = vf.optimise(
    scene=name,
    criterion={"kind": "maximise", "output": "acceleration_x"},
    variables={"beta": {"lower": 0, "upper": "60 deg"}},
    sensitivities=True,
)
rate: str = vf.QUANTITIES["conveying_velocity"].unit

vf.simulate(scene=3)  # type: ignore[arg-type]
vf.simulate(friction={1, 2})  # type: ignore[arg-type]
vf.simulate(beta=[None])  # type: ignore[list-item]
vf.simulate(verify="ten")  # type: ignore[arg-type]
vf.simulate(amplitude_along_1=None)  # type: ignore[arg-type]
vf.simulate(frequncy=50)  # type: ignore[call-arg]
vf.sweep(outputs=5)  # type: ignore[arg-type]
vf.sweep(max_periods=10)  # type: ignore[call-arg]
vf.optimise(robust="best")  # type: ignore[arg-type]
vf.plot(study)  # type: ignore[arg-type]
