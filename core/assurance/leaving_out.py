"""The cost of one output, measured: equations, dimensions, memory, coordinates and modules.

Leaving out is a matter of structure (a plan holds what its outputs pull, and nothing else); here it
is counted while studies run, not read off the plan.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tracemalloc
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import wraps
from pathlib import Path
from typing import Any

import numpy as np

from vibrafeed import core
from vibrafeed.core import kinds
from vibrafeed.core.catalogue import needed_parameters
from vibrafeed.core.dataset.markdown import markdown_table
from vibrafeed.core.dataset.table import CONVENTIONS, Table, TableVariable
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.plan.plan import scene_parameters
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.scenes import ALIASES, SCENES, Scene
from vibrafeed.core.watch import Watch

TYPICAL: dict[str, Any] = {
    "frequency": [40.0, 50.0, 60.0], "amplitude": [1e-4, 2e-4, 3e-4], "beta": [10.0, 20.0, 30.0],
    "alpha": 10.0, "gamma": 3.0, "delta": 2.0, "yaw": 5.0, "radius": 0.5, "gravity": 9.8,
    "friction": [0.3, 0.4, 0.5], "width": 0.008, "height": 0.0015, "length": 0.05,
    "diameter": 0.008, "mass": 0.01, "speed": 0.1, "distance": 2e-4, "time": 1e-3, "axis_yaw": 5.0,
    "spin_rate": 40.0, "yaw_rate": 2.0, "drilling_moment": 1e-4, "pitch": [10.0, 25.0, 40.0],
    "pitch_rate": 2.0, "centre_along": 0.01, "centre_height": 0.02, "velocity_along": 0.1,
    "velocity_upward": 0.0, "duration": 0.05, "drop_height": 0.002, "hold_down": 1.0,
    # two masses on leaf springs
    "moving_mass": 10.0, "base_mass": 30.0, "load_mass": [0.2, 0.5, 1.0], "moving_inertia": 0.25,
    "base_inertia": 0.9, "spring_radius": 0.15, "spring_angle": 20.0, "spring_count": 8.0,
    "spring_width": 0.04, "spring_thickness": 0.003, "spring_length": 0.1,
    "elastic_modulus": 206e9, "clamp_factor": 0.9, "allowable_stress": 250e6,
    "ring_down_frequency": 53.0, "damping_ratio": 0.02, "drive_force": 60.0, "air_gap": 0.003,
    "foot_stiffness": 4e4, "foot_damping": 100.0, "load_damping": 20.0, "force_harmonic": 0.25,
    "offset_along": 0.02, "offset_upward": 0.05, "spot_along": 0.1, "spot_upward": 0.03,
    "spring_density": 7850.0,
    # rows of parts
    "parts": 3.0, "row_velocity": 0.08, "inflow": 60.0, "lane_length": 0.5, "closed_time": 0.2,
    "open_time": 0.1, "part_width": 0.01, "bend_radius": 0.2, "bend_length": 0.2,
    "bend_friction": 0.3, "line_push": 1.0, "forward_acceleration": 2.0,
    "return_acceleration": 9.0, "row_mass": 0.1, "part_restitution": 0.2,
    "front_velocity": 0.06, "part_gap": 0.002,
    "part_mass_1": 0.01, "part_mass_2": 0.02, "part_friction_1": 0.3, "part_friction_2": 0.4,
    # parts that roll, and soft contacts
    "rolling_factor": 2.0, "rolling_resistance": 0.01, "impact_speed": 0.3,
    "restitution_speed": 0.1, "contact_modulus": 2e9, "contact_radius": 0.004,
    "lining_stiffness": 1e5, "contact_damping_ratio": 0.2,
    # parts that come to rest
    "small_diameter": 0.005, "centre_of_mass": 0.0006, "radius_of_gyration": 0.002, "sides": 6.0,
    # lines of devices; an order counts from 1
    "arrival_rate": 300.0, "lap_time": 20.0, "line_yield": 0.8, "line_purity": 0.9,
    "wanted_aspect": 1.0, "shank_diameter": 0.004, "device_order": 2.0,
    "drop_count_1": 129.0, "drop_count_2": 49.0, "drop_count_3": 22.0,
    **{
        f"{name}_{place}": value
        for place in range(1, 7)
        for name, value in (
            ("wiper_height", 0.1), ("ledge_width", 0.1), ("gap_length", 1e-4),
            ("rail_width", 0.006), ("outlet_capacity", 250.0), ("turned_share", 0.6),
            ("turn", 21.0),
        )
    },
    # two bodies that touch, nearly, and approach
    "position_x_1": 0.005, "position_y_1": 0.02097, "angle_1": 30.0, "velocity_x_1": 0.1,
    "velocity_y_1": -0.2, "spin_1": 3.0, "length_1": 0.05, "width_1": 0.008, "mass_1": 0.01,
    "position_x_2": 0.0, "position_y_2": 0.0, "angle_2": 0.0, "velocity_x_2": 0.0,
    "velocity_y_2": 0.1, "spin_2": -1.0, "length_2": 0.04, "width_2": 0.01, "mass_2": 0.02,
    "restitution": [0.0, 0.3, 0.5], "contact_tolerance": 0.1, "position_z_1": 0.0,
    "azimuth_1": 90.0, "elevation_1": 20.0, "velocity_z_1": -0.3, "spin_x_1": 1.0, "spin_y_1": 2.0,
    "spin_z_1": 3.0, "diameter_1": 0.02, "position_z_2": -0.0285, "azimuth_2": 20.0,
    "elevation_2": 0.0, "velocity_z_2": 0.2, "spin_x_2": -1.0, "spin_y_2": 2.0, "spin_z_2": 1.0,
    "diameter_2": 0.02,
}  # fmt: skip
"""A value, or three, of every parameter; together they make sense in every scene."""

SETTINGS: dict[str, dict[str, Any]] = {
    "events": {"max_periods": 50},
}
"""Settings of methods of motion, so that a count takes no long; other methods are not measured."""

CARRIED: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "planar": (("along", "normal"), ("floor",)),
    "on a plane": (("along", "across", "normal", "spin"), ("floor",)),
    "on a track": (("along", "from the wall", "normal"), ("floor", "wall")),
    "tumbling": (("along", "upward", "pitch"), ("corner 1 to 4",)),
}
"""Coordinates and contacts that a motion carries."""


@dataclass(frozen=True)
class Footprint:
    """The cost of one study of one output.

    Attributes
    ----------
    scene, kind, variant, output : str
        The study; `variant` is the method of a simulation.
    equations, of : int
        Equations run, and equations that the variant has.
    calls : int
        Calls of equations; more than `equations` where blocks are computed in turn.
    dimensions, axes : int
        Dimensions that the output keeps, and those of the grid.
    bytes : int
        Largest memory that was allocated at a time while it ran (tracemalloc) [B].
    coordinates, contacts : tuple of str
        What a motion carries; empty for closed forms.
    modules : int
        Modules of this project and of others imported in a fresh process; -1 if not measured.
    heavy : tuple of str
        Libraries among them that take long to load.
    """

    scene: str
    kind: str
    variant: str
    output: str
    equations: int
    of: int
    calls: int
    dimensions: int
    axes: int
    bytes: int
    coordinates: tuple[str, ...]
    contacts: tuple[str, ...]
    modules: int
    heavy: tuple[str, ...]


HEAVY = ("matplotlib", "netCDF4", "numba", "pandas", "pint", "scipy", "xarray")


def counted(prepared: Prepared) -> tuple[Prepared, Counter[str]]:
    """Return a study whose equations count their calls, and the counter of these calls.

    It shows by running a study that equations which its outputs do not need are left out. The
    counter has the calls by the quantity that an equation gives; a condition of a regime counts
    under the name of the regime in brackets.
    """
    calls: Counter[str] = Counter()

    def count(name: str, function: Any) -> Any:
        """Return an equation's function that counts its calls."""

        @wraps(function)  # the signature tells what it needs
        def calling(**arguments: Any) -> Any:
            """Call the equation's function and count the call."""
            calls[name] += 1
            return function(**arguments)

        return calling

    plan = prepared.plan
    equations = tuple(replace(e, function=count(e.gives, e.function)) for e in plan.equations)
    counted = {c: replace(c, function=count(f"[{c.regime}]", c.function)) for c in plan.conditions}
    verdicts = tuple(
        replace(verdict, conditions=tuple(counted[c] for c in verdict.conditions))
        for verdict in plan.verdicts
    )
    counting = replace(plan, equations=equations, verdicts=verdicts)
    return replace(prepared, plan=counting), calls


def _typical(scene: Scene, variant: str, *, ranged: bool) -> dict[str, Any]:
    """Return typical parameter values of a scene, as ranges if `ranged`."""
    values = {n: TYPICAL[n] for n in scene_parameters(scene, variant) if n in TYPICAL}
    return values if ranged else {n: v[1] if isinstance(v, list) else v for n, v in values.items()}


def study_of(scene: Scene, variant: str, output: str, *, ranged: bool = True) -> dict[str, Any]:
    """Return the content of a study of one output with exactly the parameters that it can use.

    Parameters
    ----------
    scene : Scene
        The scene of a sweep, or the system of a simulation.
    variant : str
        Variant of its equations, or method of simulation.
    output : str
        The only output.
    ranged : bool
        Whether the parameters of a sweep have three values where `TYPICAL` has them.
    """
    kind = "simulate" if scene.choice == "method" else "sweep"
    values = _typical(scene, variant, ranged=ranged and kind == "sweep")
    if kind == "simulate" and variant == "events":
        values.pop("alpha", None)
    content: dict[str, Any] = {
        "kind": kind, "scene": scene.name, scene.choice: variant, "outputs": [output],
        "parameters": values,
    }  # fmt: skip
    if kind == "simulate" and "motion" in scene.producers(variant):
        content |= SETTINGS[variant]
    try:
        prepare_content(content)
    except StudyError as error:
        unused = {p.place.removeprefix("parameters.") for p in error.problems}
        content["parameters"] = {n: v for n, v in values.items() if n not in unused}
    return content


def measure(scene: Scene, variant: str, output: str, *, modules: bool = False) -> Footprint:
    """Measure the cost of a study of one output: equations, calls, dimensions, memory and modules.

    The study is run twice: compilation by the first run does not count.

    Parameters
    ----------
    scene, variant : Scene, str
        The scene or system, and its variant or method.
    output : str
        The only output.
    modules : bool
        Whether to count the modules that a fresh process imports for it; this takes seconds.
    """
    content = study_of(scene, variant, output)
    prepared, calls = counted(prepare_content(content))
    kinds.tabulate(prepared)  # kernels are loaded, or compiled, before memory counts
    calls.clear()
    tracemalloc.start()
    try:
        table = kinds.tabulate(prepared)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    # Names in brackets are conditions of regimes. To the equations of the scene count aliases of
    # quantities that the study uses, such as a frequency for a circular frequency.
    run = {name for name in calls if not name.startswith("[")}
    known = {alias.gives for alias in ALIASES}
    coordinates, contacts = carried(scene, content["parameters"])
    imported, heavy = _imports(content) if modules else (-1, ())
    return Footprint(
        scene.name, content["kind"], variant, output, len(run),
        len(scene.variants[variant]) + len(run & known - set(scene.producers(variant))),
        sum(calls[name] for name in run), len(table.variables[output].dims),
        len(prepared.grid.axes), peak, coordinates, contacts, imported, heavy,
    )  # fmt: skip


def carried(scene: Scene, parameters: Mapping[str, Any]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the coordinates and the contacts that the simulated motion of a scene computes.

    Both are tuples of names, empty for a scene of formulas, which computes no motion. With them,
    the cost of a study is compared to the degrees of freedom that it needs.

    Parameters
    ----------
    scene : Scene
        The scene.
    parameters : mapping
        Parameters of the study by name. Without an azimuth `alpha` of the drive, nothing moves
        across the track, and the coordinate across is left out.
    """
    if scene.choice != "method":
        return (), ()
    if scene.name.endswith("isolated"):
        return CARRIED["tumbling"]
    if scene.name.endswith("track"):
        return CARRIED["on a track"]
    if parameters.get("alpha", 0.0) == 0.0:
        return CARRIED["planar"]
    coordinates, contacts = CARRIED["on a plane"]
    if scene.name.startswith("rectangle"):
        coordinates = tuple(name for name in coordinates if name != "spin")
    return coordinates, contacts


def _imports(content: Mapping[str, Any]) -> tuple[int, tuple[str, ...]]:
    """Return the number of modules that a study imports in a fresh process, and heavy libraries.

    `content` is the study. The libraries are those of `HEAVY`, such as scipy, that it imports.
    """
    code = (
        "import json, sys; before = set(sys.modules)\n"
        "from vibrafeed.core.intake import prepare_content\n"
        "from vibrafeed.core.kinds import tabulate\n"
        "tabulate(prepare_content(json.loads(sys.argv[1])))\n"
        "print(json.dumps(sorted(set(sys.modules) - before)))"
    )
    place = str(Path(core.__file__).parents[1])  # nothing of the folder that it is run from
    done = subprocess.run(
        [sys.executable, "-P", "-c", code, json.dumps(content)],
        env={**os.environ, "PYTHONPATH": place}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    imported = json.loads(done.stdout.splitlines()[-1])
    return len(imported), tuple(name for name in HEAVY if name in imported)


def measured_output(scene: Scene, variant: str) -> str:
    """Return the output of a variant that needs most parameters."""
    outputs = [name for name in scene.outputs(variant) if name != "regime"]
    return max(outputs, key=lambda name: len(needed_parameters(scene, variant, name)))


def footprints(*, modules: bool = True, watch: Watch | None = None) -> list[Footprint]:
    """Measure the cost of the least and the most expensive output of each scene and system.

    Expensive is the output that needs most parameters. Methods other than those of `SETTINGS` and
    variants other than the default are left out, and so is what `watch` stops.

    Parameters
    ----------
    modules : bool
        Whether imported modules are counted, for the most expensive outputs: the others import no
        more.
    watch : Watch, optional
        Progress, and when to stop.
    """
    watch = watch or Watch()
    rows: list[Footprint] = []
    each = 1 / sum(len(scene.variants) for scene in (*SCENES.values(), *SYSTEMS.values()))
    for scene in (*SCENES.values(), *SYSTEMS.values()):
        for variant in scene.variants:
            watch.advance(each)
            if watch.stopped():
                return rows
            if scene.choice == "method" and variant not in SETTINGS:
                continue  # single points, in seconds each
            if scene.choice != "method" and variant != scene.default_variant:
                continue
            dearest = measured_output(scene, variant)
            for output in dict.fromkeys((cheapest(scene, variant), dearest)):
                counts = modules and output == dearest
                rows.append(measure(scene, variant, output, modules=counts))
    return rows


def cheapest(scene: Scene, variant: str) -> str:
    """Return the output of a variant that needs fewest parameters."""
    outputs = [name for name in scene.outputs(variant) if name != "regime"]
    return min(outputs, key=lambda name: len(needed_parameters(scene, variant, name)))


def to_table(rows: Sequence[Footprint]) -> Table:
    """Return the costs of studies of one output as a table over the dimension `study`.

    The coordinate is the scene of each; texts and counts are variables, memory is in bytes.
    """
    labels = {
        "kind": "Kind of study", "variant": "Variant or method", "output": "The only output",
        "equations": "Equations run", "of": "Equations of the variant", "calls": "Calls",
        "dimensions": "Dimensions kept", "axes": "Axes of the grid",
        "bytes": "Most memory allocated at a time", "coordinates": "Coordinates carried",
        "contacts": "Contacts carried", "modules": "Modules imported", "heavy": "Heavy libraries",
    }  # fmt: skip
    variables = {}
    for name, label in labels.items():
        values = [getattr(row, name) for row in rows]
        is_number = isinstance(values[0], int) if values else False
        array = np.array(values) if is_number else np.array([_text(v) for v in values], object)
        units = {"units": "byte" if name == "bytes" else "1"} if is_number else {}
        variables[name] = TableVariable(("study",), array, {"long_name": label, **units})
    scenes = np.array([row.scene for row in rows], dtype=object)
    return Table(
        {"study": TableVariable(("study",), scenes, {"long_name": "Scene"})}, variables,
        {"Conventions": CONVENTIONS, "title": "What is left out"},
    )  # fmt: skip


def _text(value: Any) -> str:
    """Return a value as text."""
    return ", ".join(value) if isinstance(value, tuple) else str(value)


def to_markdown(rows: Sequence[Footprint]) -> str:
    """Return the costs of studies of one output as Markdown: a paragraph and a table."""
    about = (
        "What a study of one output takes, counted while it runs: for each scene the output that "
        "needs fewest parameters, and the one that needs most. Equations: those run, of those that "
        "the variant has. KiB: the most memory allocated at a time. Coordinates and contacts: what "
        "a motion carries. Modules: those that a fresh process imports, of this program and of "
        "others, for the second; and the heavy libraries among them."
    )
    columns = (
        "scene", "kind", "variant or method", "output", "equations", "KiB", "coordinates",
        "contacts", "modules", "heavy",
    )  # fmt: skip
    cells = [
        (
            row.scene, row.kind, row.variant, row.output, f"{row.equations} of {row.of}",
            f"{row.bytes / 1024:.1f}", _text(row.coordinates),
            _text(row.contacts), str(row.modules) if row.modules >= 0 else "", _text(row.heavy),
        )
        for row in rows
    ]  # fmt: skip
    return "\n".join([about, "", *markdown_table(columns, cells), ""])
