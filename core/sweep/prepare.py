"""From a study to a sweep that can be carried out."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

from core.errors import Problem, StudyError
from core.plan.plan import choose_scene
from core.plan.prepared import Chosen, Prepared, further_problems, plan_study
from core.plan.price import evaluation_seconds
from core.study.models import SweepStudy


class Sweep(Prepared):
    """A sweep that can be carried out."""

    study: SweepStudy

    @cached_property
    def seconds_a_cell(self) -> float:
        """As in `Prepared`."""
        return evaluation_seconds(self.plan, self.grid) / self.cells


def prepare(study: SweepStudy) -> Sweep:
    """Return the sweep of a study.

    Raises
    ------
    StudyError
        With every problem of scene, outputs and parameters.
    """
    plan, grid = plan_study(study, study.outputs, choose_scene(study.scene, study.variant))
    return Sweep(study, plan, grid).check_verification()


def further(content: Mapping[str, Any], known: StudyError) -> list[Problem]:
    """Return what a plan of unsound content would object to, as far as it can be told."""
    return further_problems(content, known, _chosen)


def _chosen(content: Mapping[str, Any]) -> Chosen:
    variant = content.get("variant")
    return choose_scene(content["scene"], variant if isinstance(variant, str) else None)
