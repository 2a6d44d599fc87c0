"""The catalogue: what every scene takes and gives, for people and programs alike."""

from __future__ import annotations

from typing import Any

from vibrafeed.core.motion.systems import CONTACTS, SYSTEMS
from vibrafeed.core.plan.plan import find_scene, scene_parameters
from vibrafeed.core.quantities import QUANTITIES, REGIMES
from vibrafeed.core.quantities.drive import DRIVE
from vibrafeed.core.quantities.pictures import INKS, LEVELS, colour_of
from vibrafeed.core.scenes import SCENES, Equation, Scene
from vibrafeed.core.scenes.aliases import instead_of
from vibrafeed.core.scenes.graph import behind
from vibrafeed.core.study.units import read_number


def describe_all() -> list[dict[str, Any]]:
    """Return one line for each scene, as a list for menus of the command line and the web page.

    A line has name, title, section of the source, variants of the closed forms, and methods of
    simulation (none for scenes that cannot be simulated).
    """
    return [
        {
            "name": scene.name,
            "title": scene.title,
            "source": scene.source,
            "variants": list(scene.variants),
            "default_variant": scene.default_variant,
            "methods": list(SYSTEMS[scene.name].variants) if scene.name in SYSTEMS else [],
        }
        for scene in SCENES.values()
    ]


def describe(name: str, variant: str | None = None, *, method: str | None = None) -> dict[str, Any]:
    """Return the description of a scene: parameters, outputs, equations, regimes, validity.

    Parameters
    ----------
    name : str
        The scene, such as rectangle-on-plane.
    variant : str, optional
        Variant of the closed forms; by default the scene's own.
    method : str, optional
        A method of simulation: the description is then that of the scene's motion in time.

    Raises
    ------
    StudyError
        If there is no such scene, variant or method.
    """
    scene, chosen = find_scene(name, variant)
    line = next(line for line in describe_all() if line["name"] == name)
    if method is not None:
        scene, chosen = find_scene(name, method, SYSTEMS)
        line |= {"title": scene.title}
        if name in CONTACTS:
            line |= {"other_drives": _other_drives()}
    return {
        **line,
        scene.choice: chosen,
        "validity": scene.validity,
        "parameters": [
            _describe_parameter(scene, chosen, parameter)
            for parameter in scene_parameters(scene, chosen)
        ],
        "outputs": [
            _describe_output(scene, chosen, equation)
            for equation in scene.variants[chosen]
            if equation.gives in scene.outputs(chosen)
        ],
        "regimes": [
            {
                "name": regime,
                "value": REGIMES[regime].value,
                "description": REGIMES[regime].description,
                "valid": REGIMES[regime].valid,
                "colour": colour_of(regime),
                "ink": INKS[regime],
            }
            for regime in scene_regimes(scene, chosen)
        ],
    }


def _other_drives() -> list[dict[str, Any]]:
    kinds = {
        "harmonics": ("amplitude_", "phase_", "drive_factor"),
        "steps": ("acceleration_", "duration_", "drive_factor"),
    }
    return [
        {
            "kind": kind,
            "parameters": [n for n in DRIVE if n.startswith(stems)],
            "instead_of": ["amplitude", "alpha", "beta"],
        }
        for kind, stems in kinds.items()
    ]


def scene_regimes(scene: Scene, variant: str) -> tuple[str, ...]:
    """Return the regimes that a variant can report, by their value in files."""
    names = {condition.regime for condition in scene.conditions[variant]}
    names |= {condition.otherwise for condition in scene.conditions[variant]} - {""}
    return tuple(sorted(names | {"not_assessed"}, key=lambda name: REGIMES[name].value))


def needed_parameters(scene: Scene, variant: str, output: str) -> tuple[str, ...]:
    """Return the parameters that the equations of one output need, in the order of all quantities.

    `variant` is that of the scene's equations, or a method of simulation. What its regime needs
    besides is not among them.
    """
    met = behind((output,), scene.producers(variant).get)
    needed = {name for name, equation in met.items() if equation is None}
    return tuple(name for name in QUANTITIES if name in needed)


def asked_parameters(
    scene: Scene, variant: str, output: str, *, required: bool = False
) -> tuple[str, ...]:
    """Return the parameters that a study of one output may set, for the output and its regime.

    Parameters
    ----------
    scene, variant : Scene, str
        The scene, and the variant of its equations or method of simulation.
    output : str
        Name of the output.
    required : bool
        Whether only those are wanted that such a study has to give, as they have no default. A
        simulation always includes those of its status, as it follows the part in any case.
    """
    regimes = (one for one in scene.conditions[variant] if output in one.outputs)
    produced, defaults = scene.producers(variant), scene.defaults_of(variant)
    always = [name for name in ("motion_status",) if name in produced]
    wanted = (output, *always, *(name for condition in regimes for name in condition.inputs))
    # A default stands for a quantity that others use; who asks for it wants its equation.
    known = set(defaults) - {output} if required else set()
    met = behind(wanted, lambda name: None if name in known else produced.get(name))
    found = {name for name, equation in met.items() if equation is None} - known
    return tuple(name for name in QUANTITIES if name in found)


def _describe_parameter(scene: Scene, variant: str, name: str) -> dict[str, Any]:
    quantity = QUANTITIES[name]
    default = scene.defaults_of(variant).get(name)
    return {
        "name": name,
        "label": quantity.label,
        "symbol": quantity.symbol,
        "unit": quantity.unit,
        "description": quantity.description,
        "lower": None if quantity.lower == -float("inf") else quantity.lower,
        "lower_excluded": quantity.strict,
        "upper": None if quantity.upper == float("inf") else quantity.upper,
        "default": default,
        "instead_of": list(instead_of(name)),
        "examples": list(quantity.examples),
        "example": read_number(name, quantity, quantity.examples[0]) if quantity.examples else None,
    }


def _describe_output(scene: Scene, variant: str, equation: Equation) -> dict[str, Any]:
    quantity = QUANTITIES[equation.gives]
    level, begins = LEVELS.get(equation.gives, (None, ""))
    return {
        "name": equation.gives,
        "label": quantity.label,
        "symbol": quantity.symbol,
        "unit": quantity.unit,
        "description": quantity.description,
        "level": level,
        "begins": begins,
        "equation": equation.summary,
        "source": equation.source,
        "variant": scene.variant_of(variant, equation.gives),
        "parameters": list(needed_parameters(scene, variant, equation.gives)),
        "asks": list(asked_parameters(scene, variant, equation.gives)),
        "required": list(asked_parameters(scene, variant, equation.gives, required=True)),
        "regimes": [
            condition.regime
            for condition in scene.conditions[variant]
            if equation.gives in condition.outputs
        ],
    }
