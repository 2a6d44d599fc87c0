"""What is not asked for is not computed: calls are counted over all scenes, variants, outputs."""

from __future__ import annotations

import inspect
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from vibrafeed.core import kinds
from vibrafeed.core.assurance import leaving_out
from vibrafeed.core.assurance.leaving_out import (
    HEAVY,
    SETTINGS,
    cheapest,
    counted,
    measure,
    measured_output,
    study_of,
    to_markdown,
    to_table,
)
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.scenes import ALIASES, SCENES

CLOSED = [(scene, variant) for scene in SCENES.values() for variant in scene.variants]
# Motion itself costs seconds with the reference and regularised methods, and is counted alike.
MOVING = [(s, v) for s in SYSTEMS.values() for v in s.variants if v in SETTINGS]


def ids(value):
    return getattr(value, "name", value)


def expected_calls(scene, variant, outputs, parameters):
    """Return what has to run, worked out from the functions' arguments alone, by recursion.

    The outputs asked for, the conditions that concern one of them, and what these need: given
    values are taken, other ways of giving one come before the scene's equations, and a default
    stands unless it is spoken of.
    """

    def arguments(function):
        everything = inspect.signature(function).parameters.values()
        return [p.name for p in everything if p.default is inspect.Parameter.empty]

    scene = scene.fitted(parameters)
    givers = {e.gives: e.function for e in scene.variants[variant]}
    other = {a.gives: a.function for a in ALIASES if set(arguments(a.function)) <= set(parameters)}
    conditions = [c for c in scene.conditions[variant] if c.outputs & set(outputs)]
    run = Counter(f"[{c.regime}]" for c in conditions)

    def need(name):
        if name in parameters or run[name]:
            return
        function = other.get(name) or givers.get(name)
        if name in scene.defaults_of(variant) and name not in outputs and function is not None:
            spoken_of = set(arguments(function)) & set(parameters)
            function = function if spoken_of else None
        if function is not None:
            run[name] = 1
            for needed in arguments(function):
                need(needed)

    for name in outputs:
        if name != "regime":
            need(name)
    for condition in conditions:
        for name in arguments(condition.function):
            need(name)
    return +run


@pytest.mark.by_day(12)
@pytest.mark.parametrize(("scene", "variant"), CLOSED, ids=ids)
def test_every_single_output_runs_what_it_depends_on_once_and_nothing_else(scene, variant):
    for output in scene.outputs(variant):
        content = study_of(scene, variant, output, ranged=False)
        prepared, calls = counted(prepare_content(content))
        kinds.tabulate(prepared)
        assert calls == expected_calls(scene, variant, [output], content["parameters"]), output


def dependencies(scene, variant, output, parameters):
    """Return the given parameters from which an output is made, by recursion over arguments."""
    spoken = set(expected_calls(scene, variant, [output], parameters))
    givers = {e.gives: e.inputs for e in scene.variants[variant]}
    givers |= {a.gives: a.inputs for a in ALIASES if set(a.inputs) <= set(parameters)}

    def of(name):
        if name in parameters:
            return {name}
        needed = givers[name] if name in spoken else ()
        return set().union(*map(of, needed))

    return of(output)


@pytest.mark.by_day(12)
@pytest.mark.parametrize(("scene", "variant"), CLOSED, ids=ids)
def test_every_output_keeps_the_axes_that_it_depends_on_and_no_others(scene, variant):
    for output in scene.outputs(variant)[:-1]:
        content = study_of(scene, variant, output)
        given = content["parameters"]
        ranged = {name for name, value in given.items() if isinstance(value, list)}
        table = kinds.tabulate(prepare_content(content))
        expected = ranged & dependencies(scene, variant, output, given)
        assert set(table.variables[output].dims) == expected, output


@pytest.mark.by_day(9)
@pytest.mark.parametrize(("scene", "variant"), MOVING, ids=ids)
def test_a_motion_is_computed_once_whatever_is_asked_of_it(scene, variant):
    for output in scene.outputs(variant):
        content = study_of(scene, variant, output)
        prepared, calls = counted(prepare_content(content))
        kinds.tabulate(prepared)
        # How a value was found is never left out, nor how fast a ball runs down in its place.
        more = {"motion_status", "mean_acceleration"} & {*scene.outputs(variant)}
        asked = [output, *sorted(more - {output})]
        assert calls == expected_calls(scene, variant, asked, content["parameters"]), output
        assert calls["motion"] + calls["tumble"] == 1


def test_the_count_sees_what_is_not_needed():
    scene = SCENES["rectangle-on-plane"]
    content = study_of(scene, "physical", "throw_number", ranged=False)
    given = {**content["parameters"], "alpha": 5.0}
    prepared = prepare_content({**content, "outputs": ["throw_number", "drive_along"],
                                      "parameters": given})  # fmt: skip
    wasteful = replace(prepared, plan=replace(prepared.plan, outputs=("throw_number",)))
    running, calls = counted(wasteful)
    kinds.tabulate(running)
    assert calls["drive_along"] == 1
    assert calls != expected_calls(scene, "physical", ["throw_number"], given)


def test_memory_follows_the_output_and_not_the_grid():
    scene = SCENES["rectangle-on-plane"]
    little = measure(scene, "physical", "throw_number")
    much = measure(scene, "physical", "acceleration_x")
    assert (little.dimensions, much.dimensions) == (3, 4)
    axis = {"start": 0.1, "stop": 0.9, "num": 20_000}
    wide = study_of(scene, "physical", "acceleration_x")
    wide["outputs"] = ["throw_number", "acceleration_x"]
    wide["parameters"]["friction"] = axis
    table = kinds.tabulate(prepare_content(wide))
    assert table.variables["throw_number"].values.size == 27
    assert table.variables["acceleration_x"].values.size == 27 * 20_000
    assert much.bytes > little.bytes


@pytest.mark.parametrize(
    ("scene", "variant", "heavy"),
    [
        (SCENES["rectangle-on-track"], "physical", ()),
        (SCENES["cylinder-pair-impact"], "pfeiffer_glocker", ()),
        (SYSTEMS["rectangle-on-plane"], "events", ("numba",)),
    ],
    ids=ids,
)
def test_a_study_loads_what_it_needs(scene, variant, heavy):
    found = measure(scene, variant, cheapest(scene, variant), modules=True)
    assert set(found.heavy) - {"scipy"} == set(heavy)  # the compiler looks for scipy by itself
    assert found.modules > 0


def test_the_report_has_a_row_for_each(monkeypatch):
    monkeypatch.setattr(leaving_out, "SCENES", {"corner": SCENES["rectangle-isolated"]})
    monkeypatch.setattr(leaving_out, "SYSTEMS", {"plane": SYSTEMS["rectangle-on-plane"]})
    rows = leaving_out.footprints(modules=False)
    assert {(row.kind, row.variant) for row in rows} == {
        ("sweep", SCENES["rectangle-isolated"].default_variant),
        ("simulate", "events"),
    }
    for row in rows:
        assert 0 < row.equations <= row.of
        assert row.dimensions <= row.axes
        assert row.bytes > 0
    text = to_markdown(rows)
    assert text.count("\n| ") == 2 + len(rows)
    table = to_table(rows)
    assert np.array_equal(table.variables["equations"].values, [row.equations for row in rows])
    assert table.to_xarray().sizes == {"study": len(rows)}
    assert measured_output(SCENES["rectangle-on-plane"], "physical") in text or rows
    assert set(HEAVY) >= {"numba", "xarray"}
