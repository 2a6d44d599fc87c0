"""The outputs that hold in every regime, and the rule by which a value counts."""

from __future__ import annotations

import xarray

from vibrafeed.core.scenes import EXACT, SCENES


def is_exact(dataset: xarray.Dataset, output: str) -> bool:
    """True if an output is valid in every regime, so that pictures of it shade none.

    This is so if no condition of the dataset's scene restricts the output.
    """
    if output in EXACT:
        return True
    name, variant = str(dataset.attrs.get("scene")), str(dataset.attrs.get("variant"))
    scene = SCENES.get(name)
    if scene is None or variant not in scene.conditions:
        return False
    doubtful = {found for condition in scene.conditions[variant] for found in condition.outputs}
    return output in scene.producers(variant) and output not in doubtful
