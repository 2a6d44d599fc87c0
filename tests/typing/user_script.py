"""What a type checker says of a user's script: mypy reads it (pyproject.toml), nobody runs it.

Each `type: ignore` stands where a user is wrong; mypy tells of one that is not needed.
"""

from pathlib import Path

import numpy as np
import xarray

import vibrafeed as vf
from vibrafeed.parameters import LinearDriveUnit, RectangleOnPlane

motion = vf.simulate(
    "rectangle-on-track",
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
changed = vf.sweep(study, beta=(10, 20))
for source in ("study.toml", Path("study.toml"), {"scene": "rectangle-on-plane"}, None):
    vf.simulate(source, scene="rectangle-on-plane", title="again")
name = "rectangle-on-plane"  # not known to be one of the scenes
best = vf.optimise(
    scene=name,
    criterion={"kind": "maximise", "output": "acceleration_x"},
    variables={"beta": {"lower": 0, "upper": "60 deg"}},
    sensitivities=True,
)
rate: str = vf.QUANTITIES["conveying_velocity"].unit
unit: str = vf.scene("rectangle-on-plane", method="events").parameters["friction"]["unit"]
design: RectangleOnPlane = {"frequency": "50 Hz", "friction": [0.2, 0.3], "phase_along_2": 90}
design["amplitude"] = "0.2 mm"
vf.simulate("rectangle-on-plane", **design)

vf.simulate(3)  # type: ignore[arg-type]
vf.simulate(beta=[None])  # type: ignore[list-item]
vf.simulate(verify="ten")  # type: ignore[arg-type]
vf.simulate(amplitude_along_1=None)  # type: ignore[arg-type]
vf.simulate("rectangle-on-plane", frequncy=50)  # type: ignore[call-arg]
vf.sweep(max_periods=10)  # type: ignore[call-arg]
vf.plot(study)  # type: ignore[arg-type]
other: RectangleOnPlane = {"spring_count": 4, "radius": 0.1}  # type: ignore[typeddict-unknown-key]
unit_on_springs: LinearDriveUnit = {"spring_count": 4, "moving_mass": "12 kg"}
