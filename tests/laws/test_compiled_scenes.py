"""The compiled way of a scene against numpy's: the same bits of all outputs that loops can give."""

import pytest

from benchmarks.evaluate import grid_of, plan_of, traceable
from fused_loops import check_same_bits
from night import NIGHT
from vibrafeed.core.plan import evaluate as door
from vibrafeed.core.plan import program
from vibrafeed.core.plan.evaluate import Fused
from vibrafeed.core.plan.trace import traced
from vibrafeed.core.scenes import SCENES

SHORT = {("soft-contact", "physical")}
"""Those whose outputs depend on so few parameters that no loop is worth while."""

BY_DAY = {
    ("rectangle-isolated", "thesis"), ("cylinder-isolated", "derived"),
    ("cylinder-pair-impact", "moreau"), ("cone-on-plane", "physical"),
    ("bowl-drive-unit", "measured"), ("row-on-plane", "bend"),
}  # fmt: skip
"""Those whose loops take the compiler 1 to 4 s; others, of up to 13 s, are for the night."""

EVERY = [(name, variant) for name, scene in SCENES.items() for variant in scene.variants]


@pytest.mark.parametrize(("name", "variant"), EVERY if NIGHT else sorted(BY_DAY))
def test_loops_give_the_bits_of_numpy(monkeypatch, name, variant):
    for module in (program, door):  # let loops take what numpy otherwise would because it is small
        monkeypatch.setattr(module, "FEW_CELLS", 200)
    for cached in (program.edge_of, program.program_of):
        cached.cache_clear()
    plan = plan_of(name, variant, tuple(traceable(name, variant)[True]))
    grid = grid_of(plan, 60_000, seed=1)
    assert Fused(plan, traced(plan, grid.along), grid).sources or (name, variant) in SHORT
    check_same_bits(plan, grid)
    for cached in (program.edge_of, program.program_of):
        cached.cache_clear()  # others are to be planned with the usual bounds
