"""Looks of regimes: every one has its own, and they are told apart."""

import itertools

import numpy as np
import pytest
from colorspacious import cspace_convert
from matplotlib.colors import to_rgb

from layout import contrast
from vibrafeed.core.catalogue import describe
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.plots.looks import LOOKS, ON_FILL
from vibrafeed.core.plots.style import Style
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.quantities.pictures import FILLS
from vibrafeed.core.scenes import SCENES


def seen(colours: list[str], sight: str) -> np.ndarray:
    """Return colours, seen without one of the three cones, in CAM02-UCS."""
    rgb = np.array([to_rgb(colour) for colour in colours])
    if sight != "full":
        space = {"name": "sRGB1+CVD", "cvd_type": sight, "severity": 100}
        rgb = np.clip(cspace_convert(rgb, space, "sRGB1"), 0, 1)
    return cspace_convert(rgb, "sRGB1", "CAM02-UCS")


@pytest.mark.parametrize("sight", ["full", "deuteranomaly", "protanomaly", "tritanomaly"])
def test_regimes_of_a_scene_are_told_apart_in_every_colour_vision(sight):
    assert LOOKS.keys() == REGIMES.keys()
    assert FILLS.keys() == {name for name, regime in REGIMES.items() if regime.valid}
    least = 99.0
    scenes = (*SCENES.values(), *SYSTEMS.values())
    for conditions in itertools.chain(*(scene.conditions.values() for scene in scenes)):
        names = {condition.regime for condition in conditions}
        names |= {condition.otherwise for condition in conditions if condition.otherwise}
        doubtful = [LOOKS[name][:2] for name in names if name not in FILLS]
        assert len(set(doubtful)) == len(doubtful)  # hatches
        places = seen([FILLS[name] for name in sorted(names) if name in FILLS], sight)
        pairs = itertools.combinations(places, 2)
        least = min([least, *(float(np.linalg.norm(a - b)) for a, b in pairs)])
    assert least > 12  # 1 is just noticed, beside each other


@pytest.mark.parametrize("dark", [False, True])
def test_text_is_read_on_its_background(dark):
    style = Style(dark=dark)
    for colour in (style.ink, style.quiet, style.accent):
        assert contrast(colour, style.ground) > 4.5
    for fill in FILLS.values():
        assert contrast(ON_FILL, fill) > 4.5
    for colour in (style.curve, style.other, *style.series, *style.series_over(7)):
        assert contrast(colour, style.ground) > (1.9 if colour in style.series_over(7) else 3)


def test_the_catalogue_tells_the_colours_of_pictures_and_marked_levels():
    scene = describe("rectangle-on-plane")
    found = {one["name"]: (one["colour"], one["ink"]) for one in scene["regimes"]}
    assert found["slip"] == (FILLS["slip"], LOOKS["slip"][1])
    assert found["flight"] == (LOOKS["flight"][1],) * 2  # its values do not hold: it has no fill
    levels = {one["name"]: (one["level"], one["begins"]) for one in scene["outputs"]}
    assert (levels["throw_number"], levels["acceleration_x"]) == ((1.0, "lift-off"), (None, ""))
