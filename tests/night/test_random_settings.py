"""Studies of motion with settings at random, at their bounds and beyond, fail with our words only.

By night they are 5,000; `VIBRAFEED_FUZZ_CASES` says how many else.
"""

import time

import numpy as np

from night import count
from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.motion.systems import CONTACTS, SYSTEMS
from vibrafeed.core.watch import Watch

CASES = count(25, 5000, "VIBRAFEED_FUZZ_CASES")
# Bounds of the schema; floats are drawn evenly in their logarithm.
FLOATS = {"tolerance": (1e-13, 1.0)}
COUNTS = {"max_periods": (8, 100_000)}


def drawn(random, low, high):
    """Return a number between two bounds, or one of them, or one just beyond."""
    inside = float(np.exp(random.uniform(np.log(low), np.log(high))))
    return random.choice([inside, inside, inside, low, high, low / 2, high * 2])


def course(random):
    """Return what a study may ask of a course: steps, or times of any size."""
    latest = float(10.0 ** random.uniform(-6, 9))
    kinds = (int(random.integers(2, 50)), [latest], [0, latest / 2, latest], [0.0])
    return kinds[random.integers(len(kinds))]


def study(random):
    """Return the content of a study of any system, method and settings."""
    scene = str(random.choice([*SYSTEMS]))
    method = str(random.choice([*SYSTEMS[scene].variants]))
    parameters = {"friction": round(random.uniform(0, 1.2), 3)}
    content = {"kind": "simulate", "scene": scene, "method": method, "parameters": parameters}
    if scene in CONTACTS:
        parameters |= {
            "frequency": float(random.choice([1e-3, 20, 50, 1e4])),
            "amplitude": f"{10 ** random.uniform(-3, 1):.3g} mm",
            "beta": round(random.uniform(0, 90), 2),
            "restitution": float(random.choice([0, 0, 0.5, 0.9, 1])),
        }
        if scene == "rectangle-on-track":
            parameters["delta"] = 10
        for name in SYSTEMS[scene].variant_defaults[method]:
            if random.random() < 0.3:
                continue
            if name in FLOATS:
                content[name] = drawn(random, *FLOATS[name])
            else:
                low, high = COUNTS[name]
                content[name] = int(drawn(random, low, random.choice([12, 40, high])))
    else:
        parameters |= {"duration": "0.3 s", "length": "10 mm", "restitution": 0.3}
        parameters["height" if scene.startswith("rectangle") else "diameter"] = "4 mm"
        parameters["drop_height"] = f"{10 ** random.uniform(-2, 2):.3g} mm"
        content["outputs"] = ["final_pitch"]
    if random.random() < 0.3:
        content["trajectory"] = course(random)
    return content


def is_long(prepared):
    """Return whether a case would take longer than a search has for it."""
    settings = {**prepared.method.defaults, **prepared.study.settings()}
    periods, shown = settings.get("max_periods", 0), prepared.study.trajectory
    if isinstance(shown, tuple):
        periods += shown[-1] * prepared.grid.fixed.get("frequency", 1.0)
    return periods > (3 if prepared.method.name == "reference" else 330)


def test_random_settings_are_followed_or_refused():
    random = np.random.default_rng(17)
    ends = {"followed": 0, "refused": 0, "left": 0}
    for _ in range(CASES):
        content = study(random)
        try:
            prepared = prepare_content(content)
            if is_long(prepared):
                ends["left"] += 1
                continue
            tabulate(prepared, Watch(deadline=time.monotonic() + 5))
            ends["followed"] += 1
        except VibrafeedError:
            ends["refused"] += 1
        except Exception as error:
            raise AssertionError(f"{content} ends in {error!r}") from error
    assert min(ends["followed"], ends["refused"]) > 0.1 * CASES, ends
