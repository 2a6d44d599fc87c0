"""Plans of scenes by their names."""

from collections.abc import Collection

from vibrafeed.core.plan.plan import Plan, find_scene, plan_scene


def make_plan(
    scene: str, variant: str | None, outputs: Collection[str], parameters: Collection[str]
) -> Plan:
    """Return the plan for outputs of a named scene; raise `StudyError` with every problem."""
    return plan_scene(*find_scene(scene, variant), outputs, parameters)
