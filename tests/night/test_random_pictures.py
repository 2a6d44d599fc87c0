"""Pictures of random studies: all can be read, and curves hold values of the output in the name."""

import numpy as np
import pytest

from layout import judge
from night import count
from random_studies import KINDS, random_study, shipped
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.plots.drawing import draw

STUDIES = count(4, 75, "VIBRAFEED_PICTURES")  # of a kind


@pytest.mark.parametrize("kind", KINDS)
def test_pictures_can_be_read_and_curves_are_those_of_the_result(kind):
    for seed in range(STUDIES):
        random = np.random.default_rng([seed, KINDS.index(kind)])
        content = random_study(random, kind, shipped(kind))
        content.pop("reduce", None)
        dataset = tabulate(prepare_content(content)).to_xarray()
        if all(one.size == 1 for one in dataset.data_vars.values()):
            continue  # no picture
        try:
            figure = draw(dataset, units="si")
            judge(figure)
            title = figure.get_suptitle().replace("\n", " ")
            drawn = [one for one in dataset.data_vars.values() if one.attrs["long_name"] == title]
            for line in figure.axes[0].lines if drawn else []:
                y = np.asarray(line.get_ydata(), dtype=float)
                if len(y) > 2 and len(y) in drawn[0].shape:  # no mark of a level
                    known = drawn[0].values.ravel()
                    near = np.isclose(y[np.isfinite(y)][:, None], known, rtol=1e-9)
                    assert near.any(axis=1).all()
        except Exception as error:
            raise AssertionError(f"seed {seed}: {content}") from error
