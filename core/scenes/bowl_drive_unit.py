"""A bowl feeder's drive unit: bowl and base on tilted leaf springs around their axis."""

from __future__ import annotations

from vibrafeed.core.mechanics import bowl_drive_unit
from vibrafeed.core.scenes.drive_units import DEFAULTS, LIMITS, MEASURED, SHARED, SPRINGS, tuning
from vibrafeed.core.scenes.scene import Equation, Scene

BOWL = (
    *SHARED,
    Equation("generalised_mass", bowl_drive_unit.bowl_mass_empty, "theory 15.3"),
    Equation("load_radius", bowl_drive_unit.load_radius, "theory 15.3"),
    Equation("loaded_inertia", bowl_drive_unit.loaded_inertia, "theory 15.3"),
    Equation("bowl_mass", bowl_drive_unit.bowl_mass, "theory 15.3"),
    Equation("natural_frequency", bowl_drive_unit.bowl_frequency, "theory 15.3"),
    Equation("stroke_response", bowl_drive_unit.bowl_response, "theory 15.3"),
    Equation("track_harmonic", bowl_drive_unit.bowl_harmonic, "theory 15.3"),
    Equation("bowl_turn", bowl_drive_unit.bowl_turn, "theory 15.3"),
    Equation("bowl_lift", bowl_drive_unit.bowl_lift, "theory 15.3"),
    Equation("track_amplitude", bowl_drive_unit.bowl_amplitude, "theory 15.3"),
    Equation("vibration_angle", bowl_drive_unit.bowl_angle, "theory 15.3"),
)
CONDITIONS = (*LIMITS, *tuning("bowl_turn", "bowl_lift"))

SCENE = Scene(
    name="bowl-drive-unit",
    title="Drive unit of a bowl feeder",
    source="",
    validity="Two rigid bodies that turn about one axis and lift along it, small harmonic motion "
    "in its steady state, the base free to move. Leaves bend, and do not twist: real ones are "
    "stiffer. The force acts along the stroke of the leaves. A load lies still on the track.",
    variants={"springs": (*BOWL, *SPRINGS), "measured": (*BOWL, *MEASURED)},
    default_variant="springs",
    conditions={"springs": CONDITIONS, "measured": CONDITIONS},
    defaults=DEFAULTS,
    constraints=(),
)
