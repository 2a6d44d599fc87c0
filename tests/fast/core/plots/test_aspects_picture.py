"""The picture of the aspects of a part from a file: its labels, and what lies in front."""

import numpy as np
import pytest
import trimesh

import vibrafeed
from layout import judge
from surfaces import as_data, box
from vibrafeed.core.plots.pictures import PlotError


def resting(part, **more):
    return vibrafeed.sweep(scene="resting-part", part=part, outputs=["thrown_share"], **more)


def texts(figure):
    return [text.get_text() for panel in figure.axes for text in panel.texts]


@pytest.mark.parametrize("look", [{}, {"dark": True}, {"small": True}], ids=str)
def test_each_aspect_has_its_shares_height_and_lane(look):
    figure = vibrafeed.plot(resting(box(30, 20, 10)), **look)
    judge(figure)
    assert texts(figure) == [
        "1: 65 to 86 %\n10 mm high, lane 20 mm",
        "2: 13 to 24 %\n20 mm high, lane 10 mm",
        "3: 1 to 11 %\n30 mm high, lane 10 mm",
    ]


def test_three_faces_of_a_box_are_seen():
    figure = vibrafeed.plot(resting(box(30, 20, 10)))
    (shapes,) = figure.axes[0].collections
    faces = {tuple(one) for one in np.round(shapes.get_facecolors(), 6) if one[3] > 0}
    assert len(faces) == 3


def test_a_fine_surface_is_shown_by_its_hull():
    ball = trimesh.creation.capsule(height=20, radius=5, count=[64, 64])
    found = resting(as_data(ball))
    assert len(texts(vibrafeed.plot(found, kind="aspects"))) == 1


def test_a_result_without_a_part_is_refused():
    other = vibrafeed.sweep(scene="resting-part", outputs=["let_down_share_flat"], length=[1, 2],
                            width=1, height=1)  # fmt: skip
    with pytest.raises(PlotError, match="not that of a part from a file"):
        vibrafeed.plot(other, kind="aspects")
